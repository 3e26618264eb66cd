#include "sim/lidar.h"

#include <algorithm>
#include <limits>

#include "racecar_mcl/common/validation.h"

namespace racecar_mcl::sim {
namespace {

constexpr float kNoReturn = std::numeric_limits<float>::infinity();

}  // namespace

void LidarParameters::validate() const {
  requirePositiveUpTo("lidar rate", rate, 200.0, "Hz");
  requireWithin("lidar beams", beams, 2, 100000);
  require(field_of_view > 0.0 && field_of_view <= 2.0 * kPi, "lidar field_of_view", field_of_view,
          "positive and at most 2 pi", "rad");
  require(sweep_time >= 0.0 && sweep_time < 1.0 / rate, "lidar sweep_time", sweep_time,
          "at least 0 and less than the time between sweeps", "s");
  requireNotNegative("lidar range_noise", range_noise, "m");
  requireFinite("lidar range_bias", range_bias, "m");
  requireShare("lidar missing_rate", missing_rate);
  requireShare("lidar dropout_rate", dropout_rate);
  requireNotNegative("lidar range_min", range_min, "m");
  require(std::isfinite(range_max) && range_max > range_min, "lidar range_max", range_max,
          "finite and above range_min", "m");
  requireFinite("laser_in_base x", laser_in_base.x, "m");
  requireFinite("laser_in_base y", laser_in_base.y, "m");
  requireFinite("laser_in_base yaw", laser_in_base.yaw, "rad");
  requireShare("glass share", glass.share);
  requirePositive("glass patch", glass.patch, "m");
}

Scan toScan(const LidarScan& sweep) {
  Scan scan;
  scan.stamp = sweep.stamp;
  scan.lidar = sweep.lidar;
  scan.laser_in_base = sweep.laser_in_base;
  const auto size = static_cast<Eigen::Index>(sweep.ranges.size());
  scan.bearings.resize(size);
  scan.ranges.resize(size);
  scan.seconds_after_stamp.resize(size);
  Eigen::Index valid = 0;
  for (std::size_t i = 0; i < sweep.ranges.size(); ++i) {
    if (sweep.ranges[i] < 0.0f) continue;
    const auto beam = static_cast<double>(i);
    scan.bearings[valid] = static_cast<float>(sweep.angle_min + beam * sweep.angle_increment);
    scan.ranges[valid] = sweep.ranges[i];
    scan.seconds_after_stamp[valid] = static_cast<float>(beam * sweep.time_increment);
    ++valid;
  }
  scan.bearings.conservativeResize(valid);
  scan.ranges.conservativeResize(valid);
  scan.seconds_after_stamp.conservativeResize(valid);
  return scan;
}

Lidar::Lidar(const LidarParameters& parameters, std::uint64_t seed, double start)
    : parameters_(parameters), random_(seed), sweeps_(parameters.rate, start) {}

std::optional<LidarScan> Lidar::measure(const Arc& arc, const World& world,
                                        const std::vector<Obstacle>& obstacles) {
  if (!sweeping_) {
    if (sweeps_.next() >= arc.end) return std::nullopt;
    beginSweep();
  }
  const auto beams = static_cast<std::size_t>(current_.beams);
  while (sweep_.ranges.size() < beams) {
    const auto beam = static_cast<double>(sweep_.ranges.size());
    const double time = sweep_.stamp + beam * sweep_.time_increment;
    if (time >= arc.end) return std::nullopt;
    const Pose2 laser_in_map = compose(arc.at(time), current_.laser_in_base);
    const double turned = beam * sweep_.angle_increment;
    const double bearing =
        sweep_.angle_min + (current_.clockwise ? current_.field_of_view - turned : turned);
    sweep_.ranges.push_back(measureBeam(laser_in_map, bearing, time, world, obstacles));
    sweep_.arrival = time;
  }
  sweeping_ = false;
  if (current_.clockwise) {
    std::reverse(sweep_.ranges.begin(), sweep_.ranges.end());
    sweep_.stamp = sweep_.arrival;
  }
  if (random_.uniform() < current_.dropout_rate) return std::nullopt;
  return std::move(sweep_);
}

void Lidar::beginSweep() {
  current_ = parameters_;
  sweeping_ = true;
  sweep_ = LidarScan{};
  sweep_.stamp = sweeps_.next();
  sweeps_.setRate(current_.rate);
  sweeps_.advance();
  sweep_.angle_min = -current_.field_of_view / 2.0;
  sweep_.angle_increment = current_.field_of_view / (current_.beams - 1);
  sweep_.time_increment = current_.instant ? 0.0 : current_.sweep_time / (current_.beams - 1);
  sweep_.scan_time = 1.0 / current_.rate;
  sweep_.range_min = current_.range_min;
  sweep_.range_max = current_.range_max;
  sweep_.laser_in_base = current_.laser_in_base;
  sweep_.ranges.reserve(static_cast<std::size_t>(current_.beams));
}

float Lidar::measureBeam(const Pose2& laser_in_map, double bearing, double time, const World& world,
                         const std::vector<Obstacle>& obstacles) {
  // Both numbers are drawn for every beam, so that parameters do not affect each other's noise.
  const double noise = current_.range_noise * random_.gaussian();
  const bool missing = random_.uniform() < current_.missing_rate;

  const double yaw = laser_in_map.yaw + bearing;
  const Eigen::Vector2d origin(laser_in_map.x, laser_in_map.y);
  const Hit hit = world.cast(origin, yaw, current_.range_max, obstacles, time, current_.ends);
  if (missing || !std::isfinite(hit.range)) return kNoReturn;
  if (hit.on_wall && current_.glass.share > 0.0) {
    const Eigen::Vector2d point =
        origin + hit.range * Eigen::Vector2d(std::cos(yaw), std::sin(yaw));
    if (World::isGlass(current_.glass, point)) return kNoReturn;
  }
  const double range = hit.range + current_.range_bias + noise;
  if (range > current_.range_max) return kNoReturn;
  return range < current_.range_min ? -kNoReturn : static_cast<float>(range);
}

}  // namespace racecar_mcl::sim
