// A trajectory, a TUM file.
#include "evaluation/trajectory.h"
#include "fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace racecar_mcl;
  try {
    const Trajectory trajectory =
        readTum(writeFuzzFile("trajectory.tum", std::string(data, data + size)));
    for (const StampedPose& pose : trajectory) {
      if (!isFinite(pose.pose)) throw std::logic_error("a pose is not finite");
    }
    if (!poseAt(trajectory, trajectory.front().stamp, 1.0)) {
      throw std::logic_error("no pose at the first stamp");
    }
  } catch (const TrajectoryError&) {
    // The only error a file may cause.
  }
  return 0;
}
