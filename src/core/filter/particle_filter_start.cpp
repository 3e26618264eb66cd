// Starts of the particle filter: around a pose, from poses on the whole map, from another set.
#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "filter/kernel_regularization.h"
#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/filter/particle_filter.h"

namespace racecar_mcl {
namespace {

/// The symmetric part of the covariance, with `sigma` squared for variances of zero.
Eigen::Matrix3d startCovariance(const PoseEstimate& start, double sigma) {
  Eigen::Matrix3d covariance = 0.5 * (start.covariance + start.covariance.transpose());
  for (int i = 0; i < 3; ++i) {
    if (covariance(i, i) == 0.0) {
      covariance.row(i).setZero();
      covariance.col(i).setZero();
      covariance(i, i) = sigma * sigma;
    }
  }
  return covariance;
}

}  // namespace

void ParticleFilter::initialize(const PoseEstimate& start) {
  if (!isFinite(start.base_in_map) || !start.covariance.allFinite()) {
    throw ParameterError("the start pose and its covariance must be finite");
  }
  const double coordinate = std::max(std::abs(start.base_in_map.x), std::abs(start.base_in_map.y));
  const double sigma = std::sqrt(std::max(0.0, start.covariance.cwiseAbs().maxCoeff()));
  if (coordinate > kMaxCoordinate || sigma > kMaxCoordinate) {
    std::ostringstream problem;
    problem << "the start pose lies " << coordinate << " m from the map's origin with a sigma of "
            << sigma << "; expected at most " << kMaxCoordinate;
    throw ParameterError(problem.str());
  }
  const Eigen::Matrix3d root = matrixSqrt(startCovariance(start, parameters_.initial_sigma));
  ParticleSet particles;
  particles.resize(parameters_.num_particles);
  particles.x.setConstant(start.base_in_map.x);
  particles.y.setConstant(start.base_in_map.y);
  particles.yaw.setConstant(start.base_in_map.yaw);
  jitter(root, random_, &particles);
  startFrom(std::move(particles), true);
}

const UpdateResult& ParticleFilter::startFrom(ParticleSet particles, bool converged) {
  particles_ = std::move(particles);
  particles_.log_weight.setConstant(-std::log(static_cast<double>(particles_.size())));
  regularization_updates_left_ = parameters_.regularization_updates;
  converged_updates_ = 0;
  converged_ = converged;
  resize_is_due_ = false;
  weightsOf(particles_, &weights_);
  result_ = UpdateResult{};
  summarizeSet(0);
  return result_;
}

const UpdateResult& ParticleFilter::initializeGlobally(const PoseSampler& sample) {
  return startFrom(sample(parameters_.max_particles, random_), false);
}

const UpdateResult& ParticleFilter::replaceSet(const ParticleSet& particles) {
  return startFrom(particles, true);
}

}  // namespace racecar_mcl
