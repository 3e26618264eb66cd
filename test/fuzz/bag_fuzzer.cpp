// A replay of a bag with changed bytes. Expected: finite poses, or an error that names the bag.
#include "fuzz_input.h"
#include "offline/offline_driver.h"
#include "racecar_mcl/map/map_io.h"
#include "support/program.h"
#include "support/room_bag.h"

namespace racecar_mcl {
namespace {

std::string intactBag() {
  RoomDrive drive;
  drive.seconds = 0.5;
  const std::string path = writeFuzzFile("intact.bag", "");
  writeRoomBag(path, drive);
  return readWhole(path);
}

/// Overwrites 1, 4 or 8 bytes, or cuts the bag off.
void damage(FuzzInput* input, std::string* bag) {
  const auto kind = input->take<std::uint8_t>();
  const std::size_t at = input->take<std::uint32_t>() % (bag->size() + 1);
  const auto overwrite = [&](const auto value) {
    if (at + sizeof value <= bag->size()) std::memcpy(&(*bag)[at], &value, sizeof value);
  };
  switch (kind % 8) {
    case 0:
      bag->resize(at);
      break;
    case 1:
    case 2:
      overwrite(input->take<std::uint8_t>());
      break;
    case 3:
    case 4:
      overwrite(input->take<double>());
      break;
    default:
      overwrite(input->take<std::uint32_t>());
  }
}

void requireFinite(const Trajectory& trajectory) {
  for (const StampedPose& pose : trajectory) {
    if (!isFinite(pose.pose)) throw std::logic_error("a pose is not finite");
  }
}

LocalizerParameters fewParticles() {
  LocalizerParameters parameters;
  parameters.filter.num_particles = 20;
  parameters.scan.num_beams_per_particle = 20;
  return parameters;
}

OccupancyGrid room() {
  writeFuzzFile("room.pgm", roomPgm());
  return loadMap(writeFuzzFile("room.yaml", roomYaml()));
}

/// As the program `replay` does.
void replay(const std::string& path) {
  static const LocalizerParameters parameters = fewParticles();
  static const auto map = makeLocalizationMap(room(), parameters);
  const BagReader bags({path});
  ReplayInput input;
  input.scan_topics = {"/scan"};
  input.odometry_topic = "/vesc/odom";
  bags.requireTopic(input.scan_topics.front(), "sensor_msgs/LaserScan", "--scan-topic");
  bags.requireTopic(input.odometry_topic, "nav_msgs/Odometry", "--odom-topic");
  bags.lidarExtrinsics("/scan", "base_link");
  input.extrinsics_of = [&](const std::string& frame) {
    return bags.extrinsicsOf(frame, "base_link");
  };
  requireFinite(bags.readPoses("/ground_truth/odom"));
  Localizer localizer(parameters, 1);
  localizer.setMap(map);
  localizer.initialize({poseInRoom(0.0), Eigen::Matrix3d::Zero()});
  requireFinite(runReplay(bags, input, &localizer, [] {}).trajectory);
}

}  // namespace
}  // namespace racecar_mcl

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace racecar_mcl;
  static const std::string intact = intactBag();
  std::string bag = intact;
  FuzzInput input(data, size);
  while (!input.empty()) damage(&input, &bag);
  try {
    replay(writeFuzzFile("drive.bag", bag));
  } catch (const BagError&) {
    // The only error a bag may cause.
  }
  return 0;
}
