#include "racecar_mcl/lidar_odometry.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace racecar_mcl {
namespace {

constexpr std::size_t kKeyframes = 12;
constexpr double kSpacing = 0.7;          // m driven between two keyframes
constexpr double kMetresPerRadian = 1.0;  // a turn makes a keyframe as well
constexpr double kResolution = 0.05;      // m, of the local map
constexpr double kReach = 20.0;           // m, farther ends are left out of it
constexpr double kMargin = 0.5;           // m, around it
// How well a keyframe's own pose is known to itself: m, m, rad.
const Eigen::Vector3d kKeyframeSigma(0.005, 0.005, 0.002);

ParticleFilterParameters trackingOnly(ParticleFilterParameters parameters) {
  parameters.global_particles = parameters.num_particles;
  parameters.estimate = EstimateFrom::kMean;
  parameters.settling_updates = 0;
  return parameters;
}

/// The nearest positive semidefinite matrix.
Eigen::Matrix3d positivePart(const Eigen::Matrix3d& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> parts(0.5 * (matrix + matrix.transpose()));
  return parts.eigenvectors() * parts.eigenvalues().cwiseMax(0.0).asDiagonal() *
         parts.eigenvectors().transpose();
}

}  // namespace

LidarOdometry::LidarOdometry(const ParticleFilterParameters& filter,
                             const MotionModelParameters& motion,
                             const LikelihoodFieldParameters& field, std::uint64_t seed)
    : filter_(trackingOnly(filter), motion, seed), field_parameters_(field) {}

void LidarOdometry::reset() {
  keyframes_.clear();
  field_.reset();
}

void LidarOdometry::remember(const Scan& beams, const Pose2& base_in_map) {
  if (field_) reset();  // its frame has drifted from the map's
  since_keyframe_ += distance(base_, base_in_map) +
                     kMetresPerRadian * std::abs(wrapAngle(base_.yaw - base_in_map.yaw));
  base_ = base_in_map;
  if (keyframes_.empty() || since_keyframe_ >= kSpacing) addKeyframe(beams, base_in_map);
}

void LidarOdometry::addKeyframe(const Scan& beams, const Pose2& base) {
  const Pose2 lidar = compose(base, beams.laser_in_base);
  Keyframe keyframe{base, Eigen::Matrix2Xd(2, beams.size())};
  Eigen::Index count = 0;
  for (Eigen::Index k = 0; k < beams.size(); ++k) {
    if (!(static_cast<double>(beams.ranges[k]) < kReach)) continue;
    const double bearing = lidar.yaw + static_cast<double>(beams.bearings[k]);
    const double range = static_cast<double>(beams.ranges[k]);
    keyframe.ends.col(count++) << lidar.x + range * std::cos(bearing),
        lidar.y + range * std::sin(bearing);
  }
  keyframe.ends.conservativeResize(2, count);
  keyframes_.push_back(std::move(keyframe));
  if (keyframes_.size() > kKeyframes) keyframes_.pop_front();
  since_keyframe_ = 0.0;
}

void LidarOdometry::buildField() {
  // As far as there are end points, but no farther from the newest keyframe than is worth matching.
  const Pose2& middle = keyframes_.back().base;
  const Eigen::Array2d centre(middle.x, middle.y);
  Eigen::Array2d low = centre, high = centre;
  for (const Keyframe& keyframe : keyframes_) {
    if (keyframe.ends.cols() == 0) continue;
    low = low.min(keyframe.ends.rowwise().minCoeff().array());
    high = high.max(keyframe.ends.rowwise().maxCoeff().array());
  }
  // To whole cells: an end point lies in the same cell whenever the field is built anew.
  low = ((low.max(centre - kReach) - kMargin) / kResolution).floor() * kResolution;
  high = high.min(centre + kReach) + kMargin;
  GridGeometry geometry;
  geometry.resolution = kResolution;
  geometry.width = static_cast<int>(std::ceil((high.x() - low.x()) / kResolution));
  geometry.height = static_cast<int>(std::ceil((high.y() - low.y()) / kResolution));
  geometry.origin = {low.x(), low.y(), 0.0};
  const std::size_t size =
      static_cast<std::size_t>(geometry.width) * static_cast<std::size_t>(geometry.height);
  Surfaces surfaces{std::vector<std::uint8_t>(size, 0), std::vector<std::uint8_t>(size, 0)};
  for (const Keyframe& keyframe : keyframes_) {
    for (Eigen::Index k = 0; k < keyframe.ends.cols(); ++k) {
      const Cell cell = cellAt(geometry, keyframe.ends.col(k));
      if (!contains(geometry, cell)) continue;
      surfaces
          .visible[static_cast<std::size_t>(cell.row) * static_cast<std::size_t>(geometry.width) +
                   static_cast<std::size_t>(cell.column)] = 1;
    }
  }
  field_.emplace(geometry, surfaces, field_parameters_);
}

void LidarOdometry::restart(const Pose2& base) {
  PoseEstimate start{base, Eigen::Matrix3d::Zero()};
  start.covariance.diagonal() = kKeyframeSigma.cwiseAbs2();
  filter_.initialize(start);
  reported_ = start.covariance;
}

Motion LidarOdometry::refine(const Motion& motion, const Scan& beams) {
  if (!field_) {
    if (keyframes_.empty()) {
      addKeyframe(beams, Pose2{});
      base_ = Pose2{};
      buildField();
      restart(base_);
      return motion;
    }
    buildField();
    restart(base_);
  }
  filter_.predict(motion);
  const UpdateResult& update = filter_.update(*field_, beams);
  const Pose2 before = base_;
  base_ = update.estimate.base_in_map;
  Motion refined = motion;
  refined.delta = between(before, base_);
  since_keyframe_ += distance(before, base_) + kMetresPerRadian * std::abs(refined.delta.yaw);
  // Of the error of a match only what is new since the scan before goes with this motion.
  const Eigen::Matrix3d added = positivePart(update.estimate.covariance - reported_);
  reported_ += added;
  const double c = std::cos(before.yaw), s = std::sin(before.yaw);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() << c, s, -s, c;
  refined.covariance = turn * added * turn.transpose();
  if (since_keyframe_ >= kSpacing) {
    addKeyframe(beams, base_);
    buildField();
    restart(base_);
  }
  return refined;
}

}  // namespace racecar_mcl
