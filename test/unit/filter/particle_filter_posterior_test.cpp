// The filter compared with the numerically integrated posterior.
#include <gtest/gtest.h>

#include <cmath>

#include "racecar_mcl/filter/particle_filter.h"
#include "support/particle_filter_fixture.h"

namespace racecar_mcl {
namespace {

/// A posterior by numerical integration: a weight for every pose of a regular grid.
class GridPosterior {
 public:
  /// A Gaussian prior about `centre`, on (2 n + 1) values per axis out to four sigmas. An axis with
  /// sigma 0 has one value.
  GridPosterior(const Pose2& centre, const Eigen::Vector3d& sigma, int n, double reach = 4.0) {
    for (int axis = 0; axis < 3; ++axis) {
      count_[axis] = sigma[axis] > 0.0 ? 2 * n + 1 : 1;
      step_[axis] = reach * sigma[axis] / n;
    }
    const double middle[] = {centre.x, centre.y, centre.yaw};
    const auto value = [&](int axis, int index) {
      return middle[axis] + step_[axis] * (index - (count_[axis] - 1) / 2);
    };
    set_.resize(static_cast<Eigen::Index>(count_[0]) * count_[1] * count_[2]);
    Eigen::Index i = 0;
    for (int yaw = 0; yaw < count_[2]; ++yaw) {
      for (int y = 0; y < count_[1]; ++y) {
        for (int x = 0; x < count_[0]; ++x, ++i) {
          set_.setPose(i, {value(0, x), value(1, y), value(2, yaw)});
          double squares = 0.0;
          const int index[] = {x, y, yaw};
          for (int axis = 0; axis < 3; ++axis) {
            if (sigma[axis] == 0.0) continue;
            squares += std::pow((value(axis, index[axis]) - middle[axis]) / sigma[axis], 2);
          }
          set_.log_weight[i] = -0.5 * squares;
        }
      }
    }
    normalizeLogWeights(&set_.log_weight);
  }

  /// Bayes' rule at every grid pose.
  void update(SensorModel* model, const Scan& scan) {
    ParticleSet lidars = set_;
    for (Eigen::Index i = 0; i < set_.size(); ++i) {
      lidars.setPose(i, compose(set_.pose(i), scan.laser_in_base));
    }
    Eigen::ArrayXd log_likelihoods(set_.size());
    model->logLikelihoods(lidars.poses(), scan, log_likelihoods);
    set_.log_weight += log_likelihoods;
    normalizeLogWeights(&set_.log_weight);
  }

  /// Moves all poses equally, which is exact for a single yaw, then convolves with a Gaussian.
  void predict(const Pose2& delta, double position_sigma) {
    for (Eigen::Index i = 0; i < set_.size(); ++i) {
      set_.setPose(i, compose(set_.pose(i), delta));
    }
    const Eigen::Map<Eigen::MatrixXd> weights(set_.log_weight.data(), count_[0], count_[1]);
    const Eigen::MatrixXd blurred = kernel(0, position_sigma) * weights.array().exp().matrix() *
                                    kernel(1, position_sigma).transpose();
    set_.log_weight = Eigen::Map<const Eigen::ArrayXd>(blurred.data(), blurred.size()).log();
    normalizeLogWeights(&set_.log_weight);
  }

  PoseEstimate estimate() const { return weightedMean(set_); }

 private:
  Eigen::MatrixXd kernel(int axis, double sigma) const {
    Eigen::MatrixXd matrix(count_[axis], count_[axis]);
    for (int i = 0; i < count_[axis]; ++i) {
      for (int j = 0; j < count_[axis]; ++j) {
        matrix(i, j) = std::exp(-0.5 * std::pow((i - j) * step_[axis] / sigma, 2));
      }
    }
    return matrix;
  }

  int count_[3];
  double step_[3];
  ParticleSet set_;
};

/// Compares estimates: means within a fraction of the standard deviation, standard deviations by
/// ratio.
void expectAgrees(const PoseEstimate& measured, const PoseEstimate& expected, double tolerance) {
  const Eigen::Vector3d off(measured.base_in_map.x - expected.base_in_map.x,
                            measured.base_in_map.y - expected.base_in_map.y,
                            wrapAngle(measured.base_in_map.yaw - expected.base_in_map.yaw));
  for (int i = 0; i < 3; ++i) {
    const double spread = std::sqrt(expected.covariance(i, i));
    EXPECT_NEAR(off[i], 0.0, tolerance * spread + 1e-4) << "mean " << i;
    EXPECT_NEAR(std::sqrt(measured.covariance(i, i)), spread, tolerance * spread + 1e-4)
        << "spread " << i;
  }
}

class OneScan : public testing::TestWithParam<SensorModelType> {};

TEST_P(OneScan, GivesTheIntegratedPosterior) {
  SensorParameters parameters = sensor(beamModel());
  parameters.sensor_model = GetParam();
  parameters.field = {0.2, 0.1, 30.0, 1.0, 0.5};
  MapUser map = roomWith(parameters);
  const Scan scan = scanFrom(map.map(), kTruth);
  const Pose2 guess{kTruth.x + 0.1, kTruth.y - 0.05, kTruth.yaw - 0.08};
  const Eigen::Vector3d sigma(0.15, 0.12, 0.15);
  GridPosterior posterior(guess, sigma, 20);
  posterior.update(map.model(), scan);

  ParticleFilter filter(sized(40000, 0.0), {}, 41);
  filter.initialize(startAt(guess, sigma));
  const UpdateResult result = filter.update(scan, map.model());
  expectAgrees(result.estimate, posterior.estimate(), 0.04);
  // The scan is informative.
  EXPECT_LT(posterior.estimate().covariance(0, 0), 0.6 * sigma[0] * sigma[0]);
  EXPECT_LT(posterior.estimate().covariance(2, 2), 0.6 * sigma[2] * sigma[2]);
}

INSTANTIATE_TEST_SUITE_P(SensorModels, OneScan,
                         testing::Values(SensorModelType::kBeam,
                                         SensorModelType::kLikelihoodField));

struct Resampled {
  double threshold;
  ResamplingMethod method;
};

class FilteredDrive : public testing::TestWithParam<Resampled> {};

TEST_P(FilteredDrive, GivesTheIntegratedPosterior) {
  MapUser map = room();
  const Pose2 delta{0.25, 0.05, 0.3};
  const double noise = 0.04;
  const Pose2 guess{kTruth.x - 0.08, kTruth.y + 0.1, kTruth.yaw};
  const Eigen::Vector3d sigma(0.2, 0.2, 0.0);
  GridPosterior posterior(guess, sigma, 60);
  ParticleFilterParameters parameters = sized(20000, GetParam().threshold);
  parameters.resampling = GetParam().method;
  ParticleFilter filter(parameters, constantNoise(noise), 42);
  filter.initialize(startAt(guess, {0.2, 0.2, 1e-6}));

  Pose2 truth = kTruth;
  for (int step = 0; step < 3; ++step) {
    const Scan scan = scanFrom(map.map(), truth);
    posterior.update(map.model(), scan);
    const UpdateResult result = filter.update(scan, map.model());
    EXPECT_EQ(result.resampled, result.effective_sample_size <= GetParam().threshold * 20000);
    expectAgrees(result.estimate, posterior.estimate(), 0.06);
    truth = compose(truth, delta);
    posterior.predict(delta, noise);
    filter.predict({delta, std::hypot(delta.x, delta.y), delta.yaw, 0.1, 1.0});
    expectAgrees(filter.estimate(), posterior.estimate(), 0.06);
  }
}

INSTANTIATE_TEST_SUITE_P(Resampling, FilteredDrive,
                         testing::Values(Resampled{0.0, ResamplingMethod::kSystematic},
                                         Resampled{0.5, ResamplingMethod::kSystematic},
                                         Resampled{1.0, ResamplingMethod::kSystematic},
                                         Resampled{1.0, ResamplingMethod::kMultinomial}));

}  // namespace
}  // namespace racecar_mcl
