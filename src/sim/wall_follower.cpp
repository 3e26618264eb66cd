#include "sim/wall_follower.h"

#include <algorithm>
#include <limits>

#include "racecar_mcl/require.h"

namespace racecar_mcl::sim {
namespace {

using Points = std::vector<Eigen::Vector2d>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kStep = 0.12;     // m, of the foretold path
constexpr double kSpacing = 0.04;  // m, between the sweep's points looked at
constexpr double kJump = 0.15;     // m, between neighbouring points of different things
constexpr double kSight = 4.0;     // m, farther walls do not count
constexpr double kSoftness =
    0.3;  // m, points this much farther than the nearest count 1/e for the angle
constexpr double kSteepest =
    0.7;  // rad, at most between the path and the wall on the way to the target
constexpr double kFront = 0.4;     // rad, to either side, is straight ahead
constexpr double kClearWay = 2.0;  // m, a path that is clear for less is worth a swerve
constexpr double kTouch = 0.03;    // m, so close to something is too close

/// The nearest point on one side: how far, and the angle by which the car heads away from that wall
/// (rad).
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

/// Closes every gap too narrow for the car, as between a column and the wall behind it, with points
/// across it: a law that looks for the middle of a passage would drive into it.
void closeGaps(Points& points, double width) {
  const std::size_t count = points.size();
  for (std::size_t i = 0; i + 1 < count; ++i) {
    if ((points[i + 1] - points[i]).norm() < kJump) continue;
    // The nearer side of a jump is an edge; what it may form a gap with lies beyond the other side.
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

/// The wall on one side (+1 left, -1 right) as seen from `viewpoint`: from the direction (1,
/// `front`), where y counts to that side, to 150 degrees from straight ahead.
WallAhead lookAt(const Points& points, const Pose2& viewpoint, double side, double front,
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
    if (squared > kSight * kSight) continue;
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
  // Straight to the side is parallel to the wall; ahead of that means heading into it.
  return {nearest, std::atan2(mean.y(), mean.x()) - kPi / 2.0};
}

/// Distance from the car's side to the nearest point, the car taken as a strip with round ends.
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
  // What lies straight ahead is the followed wall's affair: at an inner corner the car turns away
  // from it.
  const WallAhead wall = lookAt(points, viewpoint, side, -std::tan(kFront), scratch);
  const WallAhead opposite = lookAt(points, viewpoint, -side, std::tan(kFront), scratch);
  if (!std::isfinite(wall.distance)) return 0.0;
  const double target = std::min(p.wall_distance, (wall.distance + opposite.distance) / 2.0);
  const double approach =
      std::clamp((wall.distance - target) / (2.0 * length), -kSteepest, kSteepest);
  const double weight = 1.0 / (1.0 + std::exp((wall.distance - opposite.distance) / kSoftness));
  const double angle = weight * wall.angle - (1.0 - weight) * opposite.angle;
  const double limit = curvatureLimit(p.car);
  return side * std::clamp(2.0 / length * (approach + angle), -limit, limit);
}

/// The path foretold.
struct Outlook {
  double curvature = 0.0;  // 1/m, to begin with
  double clear_way = 0.0;  // m, as far as everything stays a margin away
  double free_way = 0.0;   // m, as far as the car gets at all
  double speed = 0.0;      // m/s, at most, now

  bool isBetterThan(const Outlook& other) const {
    return clear_way + free_way > other.clear_way + other.free_way + kStep;
  }
};

/// Drives the law ahead on the sweep's points, `swerve` (1/m) added to its curvature over the first
/// `swerve_way`.
Outlook foresee(const Points& points, double speed, double swerve, double swerve_way,
                const WallFollowerParameters& p) {
  const double horizon = std::max(2.0, speed * speed / (2.0 * p.max_braking) + 1.5);
  const double limit = curvatureLimit(p.car);
  // v^2 <= v_there^2 + 2 a s for every place s ahead.
  const auto limitBy = [&](double there_squared, double way) {
    return std::sqrt(there_squared + 2.0 * p.max_braking * std::max(way, 0.0));
  };
  Outlook outlook{0.0, horizon, horizon, std::min(p.speed, limitBy(0.0, horizon))};
  Points scratch;
  Pose2 base;
  for (double way = 0.0; way < horizon; way += kStep) {
    const double curvature =
        std::clamp(curvatureAt(points, base, speed, p, scratch) + (way < swerve_way ? swerve : 0.0),
                   -limit, limit);
    if (way == 0.0) outlook.curvature = curvature;
    const double room = clearance(points, base, p.car);
    if (room < p.margin && way < outlook.clear_way) {
      outlook.clear_way = way;
      outlook.speed = std::min(outlook.speed, limitBy(p.min_speed * p.min_speed, way));
    }
    if (room < kTouch) {
      outlook.free_way = way;
      outlook.speed = std::min(outlook.speed, limitBy(0.0, way - kStep));
      break;
    }
    outlook.speed =
        std::min(outlook.speed,
                 limitBy(p.max_lateral_acceleration / std::max(std::abs(curvature), 1e-3), way));
    base = compose(base, integrate({1.0, 0.0, curvature}, kStep));
  }
  return outlook;
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
  const Outlook law = foresee(points, std::abs(speed), 0.0, 0.0, p);
  Outlook best = law;
  if (law.clear_way < kClearWay) {
    for (const double way : {0.7, 1.4}) {
      for (const double swerve : {0.4, -0.4, 0.8, -0.8, 2.0, -2.0}) {
        const Outlook other = foresee(points, std::abs(speed), swerve, way, p);
        if (other.isBetterThan(best)) best = other;
      }
    }
  }
  const double steering = std::atan(best.curvature * p.car.wheelbase);
  // Right before something: back off, the front turning the same way as it would ahead.
  if (best.free_way < kStep) return {-std::min(p.min_speed, p.speed), -steering};
  return {std::max(best.speed, std::min(p.min_speed, p.speed)), steering};
}

}  // namespace racecar_mcl::sim
