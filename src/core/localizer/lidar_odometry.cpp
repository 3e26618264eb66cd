#include "racecar_mcl/localizer/lidar_odometry.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace racecar_mcl {
namespace {

// Keyframes (docs/maths.md): more of them were not more accurate (docs/decisions.md).
constexpr std::ptrdiff_t kMaxKeyframes = 12;  // of each lidar
constexpr double kKeyframeDistance = 0.7;     // m driven between two keyframes
constexpr double kNever = std::numeric_limits<double>::infinity();  // m, before the first one
constexpr double kMetresPerRadian = 1.0;  // m/rad, driving distance equivalent to a turn
// Local map.
constexpr double kResolution = 0.05;  // m per cell
constexpr double kMaxRange = 20.0;    // m, of the end points, and from the newest keyframe
constexpr double kMargin = 0.5;       // m, around the end points
// Standard deviation of the pose relative to a new keyframe: m, m, rad.
const Eigen::Vector3d kKeyframeSigma(0.005, 0.005, 0.002);

ParticleFilterParameters trackingOnly(ParticleFilterParameters parameters) {
  parameters.max_particles = parameters.num_particles;
  parameters.estimate = EstimateFrom::kMean;
  parameters.regularization_updates = 0;
  return parameters;
}

/// Matches pull toward standing still along a corridor without features, where the ends of the
/// beams are the same from every place: the more, the larger the noise is.
MotionModelParameters withoutSlip(MotionModelParameters parameters) {
  parameters.slip_noise_from_speed = 0.0;
  return parameters;
}

/// The factor of slip on the standard deviation along the car.
double slipFactor(const MotionModelParameters& parameters, const Motion& motion) {
  const double without = motionCovariance(withoutSlip(parameters), motion)(0, 0);
  return without > 0.0 ? std::sqrt(motionCovariance(parameters, motion)(0, 0) / without) : 1.0;
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
    : filter_(trackingOnly(filter), withoutSlip(motion), seed),
      motion_parameters_(motion),
      field_parameters_(field),
      num_threads_(filter.num_threads) {
  reset();
}

void LidarOdometry::setParameters(const ParticleFilterParameters& filter,
                                  const MotionModelParameters& motion,
                                  const LikelihoodFieldParameters& field) {
  filter_.setParameters(trackingOnly(filter), withoutSlip(motion));
  motion_parameters_ = motion;
  field_parameters_ = field;
  num_threads_ = filter.num_threads;
}

void LidarOdometry::reset() {
  keyframes_.clear();
  field_.reset();
  since_keyframe_.fill(kNever);
}

void LidarOdometry::remember(const Scan& beams, const Pose2& base_in_map) {
  if (field_) reset();  // its frame has drifted from the map's
  addTravelled(distance(base_, base_in_map) +
               kMetresPerRadian * std::abs(wrapAngle(base_.yaw - base_in_map.yaw)));
  base_ = base_in_map;
  if (sinceKeyframe(beams) >= kKeyframeDistance) addKeyframe(beams, base_in_map);
}

void LidarOdometry::addTravelled(double travelled) {
  for (double& since_keyframe : since_keyframe_) since_keyframe += travelled;
}

double& LidarOdometry::sinceKeyframe(const Scan& beams) {
  return since_keyframe_.at(static_cast<std::size_t>(beams.lidar));
}

void LidarOdometry::addKeyframe(const Scan& beams, const Pose2& base) {
  Keyframe keyframe{beams.lidar, base, endPoints(compose(base, beams.laser_in_base), beams)};
  Eigen::Index count = 0;
  for (Eigen::Index k = 0; k < beams.size(); ++k) {
    if (static_cast<double>(beams.ranges[k]) < kMaxRange) {
      keyframe.ends.col(count++) = keyframe.ends.col(k);
    }
  }
  keyframe.ends.conservativeResize(2, count);
  keyframes_.push_back(std::move(keyframe));
  const auto is_same_lidar = [&](const Keyframe& other) { return other.lidar == beams.lidar; };
  if (std::count_if(keyframes_.begin(), keyframes_.end(), is_same_lidar) > kMaxKeyframes) {
    keyframes_.erase(std::find_if(keyframes_.begin(), keyframes_.end(), is_same_lidar));
  }
  sinceKeyframe(beams) = 0.0;
}

void LidarOdometry::buildField() {
  // The bounding box of the end points, limited to kMaxRange around the newest keyframe.
  const Pose2& newest = keyframes_.back().base;
  const Eigen::Array2d centre(newest.x, newest.y);
  Eigen::Array2d low = centre, high = centre;
  for (const Keyframe& keyframe : keyframes_) {
    if (keyframe.ends.cols() == 0) continue;
    low = low.min(keyframe.ends.rowwise().minCoeff().array());
    high = high.max(keyframe.ends.rowwise().maxCoeff().array());
  }
  // Aligned to whole cells, so that an end point stays in its cell when the field is rebuilt.
  low = ((low.max(centre - kMaxRange) - kMargin) / kResolution).floor() * kResolution;
  high = high.min(centre + kMaxRange) + kMargin;
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
      if (contains(geometry, cell)) surfaces.visible[CellIndex(geometry)(cell)] = 1;
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
  LikelihoodFieldModel model(*field_, num_threads_);
  const UpdateResult& update = filter_.update(beams, &model);
  const Pose2 before = base_;
  base_ = update.estimate.base_in_map;
  Motion refined = motion;
  refined.delta = between(before, base_);
  addTravelled(distance(before, base_) + kMetresPerRadian * std::abs(refined.delta.yaw));
  // Errors of successive matches are correlated: this motion gets the increase of the covariance.
  const Eigen::Matrix3d added = positivePart(update.estimate.covariance - reported_);
  reported_ += added;
  const double c = std::cos(before.yaw), s = std::sin(before.yaw);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() << c, s, -s, c;
  // What the match does not observe has the noise of slip as well.
  const Eigen::Vector3d scale(slipFactor(motion_parameters_, motion), 1.0, 1.0);
  refined.covariance = scale.asDiagonal() * (turn * added * turn.transpose()) * scale.asDiagonal();
  if (sinceKeyframe(beams) >= kKeyframeDistance) {
    addKeyframe(beams, base_);
    buildField();
    restart(base_);
  }
  return refined;
}

}  // namespace racecar_mcl
