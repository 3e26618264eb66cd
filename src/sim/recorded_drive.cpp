#include "sim/recorded_drive.h"

#include <iterator>

namespace racecar_mcl::sim {
namespace {

constexpr double kDriverPeriod = 0.02;  // s, control period

}  // namespace

std::vector<Event> recordDrive(const std::shared_ptr<const World>& world,
                               const SimulatorParameters& simulator,
                               const WallFollowerParameters& follower, const Pose2& start_in_map,
                               double seconds, std::uint64_t seed) {
  Simulator car(world, simulator, start_in_map, seed);
  Driver driver(follower);
  std::vector<Event> drive;
  while (car.time() < seconds - kDriverPeriod / 2.0) {
    const Command command = driver.drive(car.look(), car.truth().twist.vx, car.collided());
    std::vector<Event> events = car.advance(kDriverPeriod, command);
    drive.insert(drive.end(), std::make_move_iterator(events.begin()),
                 std::make_move_iterator(events.end()));
  }
  return drive;
}

}  // namespace racecar_mcl::sim
