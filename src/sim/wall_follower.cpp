#include "sim/wall_follower.h"

#include <algorithm>

#include "racecar_mcl/common/validation.h"
#include "sim/infinity.h"

namespace racecar_mcl::sim {
namespace {

using Points = std::vector<Eigen::Vector2d>;

constexpr double kStep = 0.12;     // m, of the predicted path
constexpr double kSpacing = 0.04;  // m, between used points
constexpr double kMinGap = 0.15;   // m, between neighbouring points of different objects
constexpr double kMaxRange = 4.0;  // m
constexpr double kSoftness = 0.3;  // m, decay length of point weights beyond the nearest point
constexpr double kMaxApproachAngle = 0.7;  // rad, between path and wall
constexpr double kForwardSector = 0.4;     // rad, half width of the forward sector
constexpr double kMinClearPath = 2.0;      // m; shorter clear paths trigger swerves
constexpr double kMinClearance = 0.03;     // m

/// Distance (m) to the nearest point on one side, and the angle (rad) by which the car heads away
/// from that wall.
struct WallAhead {
  double distance = kInfinity;
  double angle = 0.0;
};

Points pointsInBase(const LidarScan& sweep) {
  Points points;
  for (std::size_t i = 0; i < sweep.ranges.size(); ++i) {
    const auto range = static_cast<double>(sweep.ranges[i]);
    if (!std::isfinite(range)) continue;
    const double bearing = sweep.angle_min + static_cast<double>(i) * sweep.angle_increment;
    const Pose2 point =
        compose(sweep.laser_in_base, {range * std::cos(bearing), range * std::sin(bearing), 0.0});
    const Eigen::Vector2d position(point.x, point.y);
    if (points.empty() || (position - points.back()).norm() >= kSpacing) points.push_back(position);
  }
  return points;
}

/// Fills gaps that are too narrow for the car, such as between a column and a wall, with points;
/// otherwise the control law would steer to their middle.
void closeGaps(Points& points, double width) {
  const std::size_t count = points.size();
  for (std::size_t i = 0; i + 1 < count; ++i) {
    if ((points[i + 1] - points[i]).norm() < kMinGap) continue;
    // The nearer side of a range jump is an edge; the gap is to points on the other side.
    const bool edge_first = points[i].norm() < points[i + 1].norm();
    const Eigen::Vector2d edge = edge_first ? points[i] : points[i + 1];
    const std::size_t begin = edge_first ? i + 1 : 0;
    const std::size_t end = edge_first ? count : i + 1;
    const auto nearer = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
      return (a - edge).squaredNorm() < (b - edge).squaredNorm();
    };
    const auto offset = [&](std::size_t k) {
      return points.begin() + static_cast<std::ptrdiff_t>(k);
    };
    const Eigen::Vector2d across = *std::min_element(offset(begin), offset(end), nearer) - edge;
    const double gap = across.norm();
    if (gap >= width) continue;
    for (double way = kSpacing; way < gap; way += kSpacing) {
      points.push_back(edge + across * (way / gap));
    }
  }
}

/// The wall on one side (+1 left, -1 right) from `viewpoint`: in the sector from the direction (1,
/// `front`), with y towards that side, to 150 degrees.
WallAhead findWall(const Points& points, const Pose2& viewpoint, double side, double front,
                   Points& seen) {
  const double c = std::cos(viewpoint.yaw);
  const double s = std::sin(viewpoint.yaw);
  const double behind = std::tan(60.0 * kPi / 180.0);
  seen.clear();
  double nearest = kInfinity;
  for (const Eigen::Vector2d& point : points) {
    const double dx = point.x() - viewpoint.x;
    const double dy = point.y() - viewpoint.y;
    const double squared = dx * dx + dy * dy;
    if (squared > kMaxRange * kMaxRange) continue;
    const double x = c * dx + s * dy;
    const double out = side * (c * dy - s * dx);
    if (x >= 0.0 ? out < front * x : out < -x / behind) continue;
    seen.emplace_back(x, out);
    nearest = std::min(nearest, squared);
  }
  if (seen.empty()) return {};

  nearest = std::sqrt(nearest);
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point : seen) {
    const double range = point.norm();
    if (range > nearest + 5.0 * kSoftness || range == 0.0) continue;
    mean += std::exp((nearest - range) / kSoftness) / range * point;
  }
  // A mean direction of 90 degrees is parallel to the wall; less means heading towards it.
  return {nearest, std::atan2(mean.y(), mean.x()) - kPi / 2.0};
}

/// Distance from the car's outline, a stadium shape, to the nearest point.
double clearance(const Points& points, const Pose2& base, const CarParameters& car) {
  const double c = std::cos(base.yaw);
  const double s = std::sin(base.yaw);
  const double half = car.width / 2.0;
  const double front = std::max(car.length_ahead - half, 0.0);
  const double rear = std::min(half - car.length_behind, front);
  double nearest = kInfinity;
  for (const Eigen::Vector2d& point : points) {
    const double dx = point.x() - base.x;
    const double dy = point.y() - base.y;
    const double x = c * dx + s * dy;
    const double beyond = x - std::clamp(x, rear, front);
    const double y = c * dy - s * dx;
    nearest = std::min(nearest, beyond * beyond + y * y);
  }
  return std::sqrt(nearest) - half;
}

double curvatureLimit(const CarParameters& car) {
  return std::tan(car.max_steering) / car.wheelbase;
}

double curvatureAt(const Points& points, const Pose2& base, double speed,
                   const WallFollowerParameters& p, Points& scratch) {
  const double length = std::clamp(0.25 * speed, 0.55, 1.4);
  const Pose2 viewpoint = compose(base, {0.3 + 0.12 * speed, 0.0, 0.0});
  const double side = p.side == Side::kLeft ? 1.0 : -1.0;
  // The forward sector belongs to the followed wall: at an inner corner the car turns away from it.
  const WallAhead wall = findWall(points, viewpoint, side, -std::tan(kForwardSector), scratch);
  const WallAhead opposite = findWall(points, viewpoint, -side, std::tan(kForwardSector), scratch);
  if (!std::isfinite(wall.distance)) return 0.0;
  const double target = std::min(p.wall_distance, (wall.distance + opposite.distance) / 2.0);
  const double approach =
      std::clamp((wall.distance - target) / (2.0 * length), -kMaxApproachAngle, kMaxApproachAngle);
  const double weight = 1.0 / (1.0 + std::exp((wall.distance - opposite.distance) / kSoftness));
  const double angle = weight * wall.angle - (1.0 - weight) * opposite.angle;
  const double limit = curvatureLimit(p.car);
  return side * std::clamp(2.0 / length * (approach + angle), -limit, limit);
}

/// The predicted path.
struct PathPrediction {
  double curvature = 0.0;       // 1/m, initial
  double clear_distance = 0.0;  // m with the full margin
  double free_distance = 0.0;   // m without collision
  double speed = 0.0;           // m/s, current limit

  bool isBetterThan(const PathPrediction& other) const {
    return clear_distance + free_distance > other.clear_distance + other.free_distance + kStep;
  }
};

/// Simulates the control law on the sweep's points, with `swerve` (1/m) added to the curvature over
/// the first `swerve_length` m.
PathPrediction predictPath(const Points& points, double speed, double swerve, double swerve_length,
                           const WallFollowerParameters& p) {
  const double horizon = std::max(2.0, speed * speed / (2.0 * p.max_braking) + 1.5);
  const double limit = curvatureLimit(p.car);
  // v^2 <= v(s)^2 + 2 a s for all distances s ahead.
  const auto limitBy = [&](double there_squared, double way) {
    return std::sqrt(there_squared + 2.0 * p.max_braking * std::max(way, 0.0));
  };
  PathPrediction prediction{0.0, horizon, horizon, std::min(p.speed, limitBy(0.0, horizon))};
  Points scratch;
  Pose2 base;
  for (double way = 0.0; way < horizon; way += kStep) {
    const double curvature = std::clamp(
        curvatureAt(points, base, speed, p, scratch) + (way < swerve_length ? swerve : 0.0), -limit,
        limit);
    if (way == 0.0) prediction.curvature = curvature;
    const double room = clearance(points, base, p.car);
    if (room < p.margin && way < prediction.clear_distance) {
      prediction.clear_distance = way;
      prediction.speed = std::min(prediction.speed, limitBy(p.min_speed * p.min_speed, way));
    }
    if (room < kMinClearance) {
      prediction.free_distance = way;
      prediction.speed = std::min(prediction.speed, limitBy(0.0, way - kStep));
      break;
    }
    prediction.speed =
        std::min(prediction.speed,
                 limitBy(p.max_lateral_acceleration / std::max(std::abs(curvature), 1e-3), way));
    base = compose(base, integrate({1.0, 0.0, curvature}, kStep));
  }
  return prediction;
}

}  // namespace

void WallFollowerParameters::validate() const {
  requirePositive("wall_distance", wall_distance, "m");
  requirePositive("speed", speed, "m/s");
  requirePositive("min_speed", min_speed, "m/s");
  requirePositive("max_lateral_acceleration", max_lateral_acceleration, "m/s^2");
  requirePositive("max_braking", max_braking, "m/s^2");
  requireNotNegative("margin", margin, "m");
  car.validate();
}

WallFollower::WallFollower(const WallFollowerParameters& parameters) : parameters_(parameters) {
  parameters_.validate();
}

void WallFollower::setParameters(const WallFollowerParameters& parameters) {
  parameters.validate();
  parameters_ = parameters;
}

Command WallFollower::follow(const LidarScan& sweep, double speed) const {
  const WallFollowerParameters& p = parameters_;
  Points points = pointsInBase(sweep);
  closeGaps(points, p.car.width + 2.0 * p.margin);
  const PathPrediction law = predictPath(points, std::abs(speed), 0.0, 0.0, p);
  PathPrediction best = law;
  if (law.clear_distance < kMinClearPath) {
    for (const double way : {0.7, 1.4}) {
      for (const double swerve : {0.4, -0.4, 0.8, -0.8, 2.0, -2.0}) {
        const PathPrediction other = predictPath(points, std::abs(speed), swerve, way, p);
        if (other.isBetterThan(best)) best = other;
      }
    }
  }
  const double steering = std::atan(best.curvature * p.car.wheelbase);
  // Blocked: back off, turning in the same direction as ahead.
  if (best.free_distance < kStep) return {-std::min(p.min_speed, p.speed), -steering};
  return {std::max(best.speed, std::min(p.min_speed, p.speed)), steering};
}

}  // namespace racecar_mcl::sim
