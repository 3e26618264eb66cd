#include "sim/gyro.h"

#include <gtest/gtest.h>

#include <vector>

#include "racecar_mcl/common/errors.h"

namespace racecar_mcl::sim {
namespace {

/// A car that begins to turn by 1 rad/s at 1 s.
std::vector<GyroSample> measure(GyroParameters parameters) {
  parameters.enabled = true;
  Gyro gyro(parameters, 1, 0.0);
  std::vector<GyroSample> samples;
  for (int tick = 0; tick < 2000; ++tick) {
    const double begin = tick * 1e-3;
    const Arc arc{begin, begin + 1e-3, {}, {1.0, 0.0, begin < 1.0 - 1e-9 ? 0.0 : 1.0}};
    if (const auto sample = gyro.measure(arc)) samples.push_back(*sample);
  }
  return samples;
}

GyroParameters ideal() {
  GyroParameters parameters;
  parameters.noise = parameters.bias = parameters.scale_error = 0.0;
  return parameters;
}

double firstTurn(const std::vector<GyroSample>& samples) {
  for (const GyroSample& sample : samples) {
    if (sample.yaw_rate > 0.5) return sample.stamp;
  }
  return -1.0;
}

TEST(Gyro, MeasuresTheTurnRate) {
  const std::vector<GyroSample> samples = measure(ideal());
  EXPECT_EQ(samples.size(), 200u);
  EXPECT_EQ(samples.front().yaw_rate, 0.0);
  EXPECT_EQ(samples.back().yaw_rate, 1.0);
  EXPECT_NEAR(firstTurn(samples), 1.0, 1e-9);
}

TEST(Gyro, HasItsErrors) {
  GyroParameters parameters = ideal();
  parameters.scale_error = 0.1;
  parameters.bias = 0.02;
  parameters.delay = 0.05;
  std::vector<GyroSample> samples = measure(parameters);
  EXPECT_NEAR(samples.front().yaw_rate, 0.02, 1e-12);
  EXPECT_NEAR(samples.back().yaw_rate, 1.12, 1e-12);
  EXPECT_NEAR(firstTurn(samples), 1.05, 1e-9);
  parameters.in_degrees = true;
  EXPECT_NEAR(measure(parameters).back().yaw_rate, 1.12 * 180.0 / kPi, 1e-9);
  parameters.noise = 0.1;
  EXPECT_NE(measure(parameters)[0].yaw_rate, measure(parameters)[1].yaw_rate);
}

TEST(Gyro, IsSilentIfDisabled) {
  Gyro gyro({}, 1, 0.0);
  EXPECT_FALSE(gyro.measure({0.0, 1e-3, {}, {}}));
}

TEST(Gyro, RejectsWrongParameters) {
  GyroParameters parameters;
  parameters.rate = 0.0;
  EXPECT_THROW(parameters.validate(), ParameterError);
  parameters = {};
  parameters.delay = -0.1;
  EXPECT_THROW(parameters.validate(), ParameterError);
}

}  // namespace
}  // namespace racecar_mcl::sim
