#include "sim/recorded_drive.h"

#include <iterator>

#include "racecar_mcl/common/errors.h"
#include "sim/lap_counter.h"

namespace racecar_mcl::sim {
namespace {

constexpr double kMaxLapTime = 120.0;  // s

}  // namespace

std::vector<Event> recordDrive(const std::shared_ptr<const World>& world,
                               const SimulatorParameters& simulator,
                               const WallFollowerParameters& follower, const Pose2& start_in_map,
                               double seconds, std::uint64_t seed) {
  Simulator car(world, simulator, start_in_map, seed);
  Driver driver(follower);
  std::vector<Event> drive;
  while (car.time() < seconds - kControlPeriod / 2.0) {
    const Command command = driver.drive(car.look(), car.truth().twist.vx, car.collided());
    std::vector<Event> events = car.advance(kControlPeriod, command);
    drive.insert(drive.end(), std::make_move_iterator(events.begin()),
                 std::make_move_iterator(events.end()));
  }
  return drive;
}

Path recordLap(const std::shared_ptr<const World>& world, const Pose2& start_in_map) {
  SimulatorParameters parameters;
  parameters.lidar.beams = 2;  // the driver uses Simulator::look
  Simulator car(world, parameters, start_in_map, 0);
  Driver driver({});
  LapCounter counter(start_in_map);
  Path lap;
  while (car.time() < kMaxLapTime) {
    const Pose2 base_in_map = car.truth().base_in_map;
    counter.update(base_in_map);
    if (counter.laps() > 0) return lap;
    lap.emplace_back(base_in_map.x, base_in_map.y);
    car.advance(kControlPeriod, driver.drive(car.look(), car.truth().twist.vx, car.collided()));
  }
  throw MapError(
      "the wall follower completed no lap from the start pose; expected a closed course");
}

}  // namespace racecar_mcl::sim
