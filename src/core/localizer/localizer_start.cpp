// Construction, maps and starts of the localizer.
#include <sstream>
#include <utility>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/localizer/localizer.h"

namespace racecar_mcl {
namespace {

/// Throws ParameterError if a finite pose is outside the map.
void requireOnMap(const LocalizationMap& map, const Pose2& pose) {
  const GridGeometry& geometry = map.grid.geometry();
  if (!isFinite(pose) || contains(geometry, cellAt(geometry, {pose.x, pose.y}))) return;
  std::ostringstream problem;
  problem << "the start pose (" << pose.x << ", " << pose.y << ") lies outside the map of "
          << geometry.width * geometry.resolution << " x " << geometry.height * geometry.resolution
          << " m with its corner at (" << geometry.origin.x << ", " << geometry.origin.y << ")";
  throw ParameterError(problem.str());
}

}  // namespace

Localizer::Localizer(const LocalizerParameters& parameters, std::uint64_t seed)
    : parameters_((validate(parameters), parameters)),
      extrapolator_(parameters.odometry, parameters.motion),
      preprocessor_(parameters.scan),
      filter_(parameters.filter, parameters.motion, seed),
      lidar_odometry_(parameters.filter, parameters.motion, sensorParameters(parameters).field,
                      seed + 2),
      calibration_(parameters.calibration),
      lidars_(1, {parameters.range_bias, parameters.scan_direction}),
      verifier_(parameters.filter, parameters.motion, seed + 1),
      monitor_(parameters.monitor, parameters.protection) {}

LidarState& Localizer::lidarAt(int index) {
  const auto size = static_cast<std::size_t>(index) + 1;
  if (size > lidars_.size()) {
    lidars_.resize(size, {parameters_.range_bias, parameters_.scan_direction});
  }
  return lidars_[size - 1];
}

void Localizer::initialize(const PoseEstimate& start, double stamp) {
  initialize(extrapolator_.moveToNewest(start, stamp));
}

void Localizer::setMap(std::shared_ptr<const LocalizationMap> map) {
  sensor_model_ =
      makeSensorModel(*map, sensorParameters(parameters_), parameters_.filter.num_threads);
  map_ = std::move(map);
}

void Localizer::setParameters(const LocalizerParameters& parameters,
                              std::shared_ptr<const LocalizationMap> map) {
  validate(parameters);
  const SensorParameters sensor = sensorParameters(parameters);
  std::unique_ptr<SensorModel> model;
  if (map) model = makeSensorModel(*map, sensor, parameters.filter.num_threads);
  // Nothing below throws.
  sensor_model_ = std::move(model);
  map_ = std::move(map);
  extrapolator_.setParameters(parameters.odometry, parameters.motion);
  preprocessor_ = ScanPreprocessor(parameters.scan);
  filter_.setParameters(parameters.filter, parameters.motion);
  lidar_odometry_.setParameters(parameters.filter, parameters.motion, sensor.field);
  calibration_.setParameters(parameters.calibration);
  for (LidarState& lidar : lidars_) {
    lidar.range_bias.setParameters(parameters.range_bias);
    lidar.direction.setSource(parameters.scan_direction);
  }
  verifier_.setParameters(parameters.filter, parameters.motion);
  monitor_.setParameters(parameters.monitor, parameters.protection);
  parameters_ = parameters;
}

void Localizer::initialize(const PoseEstimate& start) {
  if (map_) requireOnMap(*map_, start.base_in_map);
  filter_.initialize(start);
  global_start_pending_ = false;
  restartTracking();
}

bool Localizer::initializeGlobally() {
  if (!map_) return false;
  filter_.initializeGlobally(
      [this](Eigen::Index count, Random& random) { return sampleFreeSpace(*map_, count, random); });
  global_start_pending_ = parameters_.relocalization != Relocalization::kOff;
  restartTracking();
  return true;
}

void Localizer::restartTracking() {
  calibration_.restart();
  extrapolator_.reset(filter_.estimate(), calibration_);
  scans_since_stop_ = 0;
  monitor_.reset();
  noise_adaptation_.reset();
  slip_compensation_.reset();
  for (LidarState& lidar : lidars_) lidar.direction.reset();
  recovery_.reset();
  verifier_.stop();
  lidar_odometry_.reset();
}

void Localizer::initializeFromScan(Step* step, UpdateResult* update) {
  const Scan& scan = step->scan.beams;
  *update = filter_.initializeGlobally([&](Eigen::Index count, Random& random) {
    return map_->matcher.candidates(scan, count, random);
  });
  update->beams = static_cast<int>(scan.size());
  step->jumped = true;
  global_start_pending_ = false;
}

void Localizer::recoverFromError() {
  ++counters_.scans_failed;
  // A place that is not confirmed yet is searched again.
  if (!filter_.converged() || verifier_.confirming()) {
    initializeGlobally();
    return;
  }
  verifier_.stop();
  lidar_odometry_.reset();
  scans_since_stop_ = 0;
  filter_.initialize(*extrapolator_.lastEstimate());
}

}  // namespace racecar_mcl
