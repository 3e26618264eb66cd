// Messages to a localizer in a small room. Its pose must stay finite.
#include "fuzz_input.h"
#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/localizer/localizer.h"

namespace racecar_mcl {
namespace {

constexpr int kWidth = 40, kHeight = 30;  // cells of 0.1 m

OccupancyGrid room() {
  std::vector<std::int8_t> cells(kWidth * kHeight, OccupancyGrid::kFree);
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      const bool is_wall = row == 0 || row == kHeight - 1 || column == 0 || column == kWidth - 1 ||
                           (row > 20 && column > 30);
      if (is_wall)
        cells[static_cast<std::size_t>(row * kWidth + column)] = OccupancyGrid::kOccupied;
    }
  }
  return {{kWidth, kHeight, 0.1, {}}, std::move(cells)};
}

LocalizerParameters fewParticles() {
  LocalizerParameters parameters;
  parameters.filter.num_particles = 20;
  parameters.filter.max_particles = 100;
  parameters.scan.num_beams_per_particle = 20;
  parameters.sensor.search.search_poses = 100000;
  return parameters;
}

Pose2 takePose(FuzzInput* input) {
  return {input->take<double>(), input->take<double>(), input->take<double>()};
}

/// A stamp: the next of a regular sensor, that with an error, or any number.
double takeStamp(FuzzInput* input, double* newest) {
  const auto kind = input->take<std::uint8_t>();
  if (kind % 4 == 3) return input->take<double>();
  *newest += 0.02;
  return kind % 4 == 2 ? *newest + input->take<float>() : *newest;
}

Scan takeScan(FuzzInput* input, double* newest) {
  Scan scan;
  scan.stamp = takeStamp(input, newest);
  if (input->take<std::uint8_t>() % 4 == 3) scan.laser_in_base = takePose(input);
  const Eigen::Index beams = input->take<std::uint8_t>() % 64;
  scan.bearings.resize(beams);
  scan.ranges.resize(beams);
  scan.seconds_after_stamp = Eigen::ArrayXf::Zero(beams);
  for (Eigen::Index i = 0; i < beams; ++i) {
    scan.bearings[i] = 0.1f * static_cast<float>(i) - 3.0f;
    scan.ranges[i] = 0.01f * static_cast<float>(input->take<std::uint8_t>());
    if (scan.ranges[i] == 0.0f) scan.ranges[i] = input->take<float>();
  }
  return scan;
}

void requireFinite(const Localizer& localizer) {
  const auto estimate = localizer.estimateAt(localizer.newestStamp().value_or(0.0));
  if (!estimate) return;
  if (!isFinite(estimate->base_in_map) || !estimate->covariance.allFinite()) {
    throw std::logic_error("the estimate is not finite");
  }
}

}  // namespace
}  // namespace racecar_mcl

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace racecar_mcl;
  static const LocalizerParameters parameters = fewParticles();
  static const auto map = makeLocalizationMap(room(), parameters);
  FuzzInput input(data, size);
  Localizer localizer(parameters, 1);
  localizer.setMap(map);
  localizer.initialize({{2.0, 1.5, 0.0}, Eigen::Matrix3d::Zero()});
  double newest = 100.0;
  while (!input.empty()) {
    switch (input.take<std::uint8_t>() % 4) {
      case 0:
        localizer.addOdometry({takeStamp(&input, &newest),
                               {input.take<double>(), input.take<double>(), input.take<double>()},
                               {}});
        break;
      case 1:
        localizer.update(takeScan(&input, &newest));
        break;
      case 2:
        localizer.addOdometry({takeStamp(&input, &newest), {1.0, 0.0, 0.1}, {}});
        break;
      default:
        try {
          localizer.initialize({takePose(&input), Eigen::Matrix3d::Identity() * 0.01},
                               takeStamp(&input, &newest));
        } catch (const ParameterError&) {
          // A pose outside the map.
        }
    }
    requireFinite(localizer);
  }
  return 0;
}
