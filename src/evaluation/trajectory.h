// Trajectories, and TUM files.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "racecar_mcl/geometry/pose2.h"

namespace racecar_mcl {

/// Time in ns since the epoch; a double in seconds resolves Unix time to 0.2 us only.
using Nanoseconds = std::int64_t;

inline double toSeconds(Nanoseconds duration) { return 1e-9 * static_cast<double>(duration); }
inline Nanoseconds toNanoseconds(double seconds) {
  return static_cast<Nanoseconds>(std::llround(seconds * 1e9));
}

struct StampedPose {
  Nanoseconds stamp = 0;
  Pose2 pose;
};

/// In order of unique stamps.
using Trajectory = std::vector<StampedPose>;

/// An invalid trajectory file; names the file, the line and the expected format.
struct TrajectoryError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Seconds with nine decimals.
std::string formatStamp(Nanoseconds stamp);

/// "[first, last]" in seconds; the trajectory must not be empty.
std::string spanOf(const Trajectory& trajectory);

/// Sorts by stamp and keeps the first pose of each stamp.
Trajectory inOrder(std::vector<StampedPose> poses);

/// Reads lines of `t x y z qx qy qz qw`; skips empty lines and lines that start with #. Throws
/// TrajectoryError.
Trajectory readTum(const std::string& path);

/// A line of a TUM file. Stamps have ns precision, so that they equal those of the messages.
std::string tumLine(const StampedPose& pose);
void writeTum(const Trajectory& trajectory, std::ostream& out);

/// The pose at a stamp, linearly interpolated between its neighbours. None outside the trajectory
/// and inside gaps longer than `max_gap` seconds.
std::optional<Pose2> poseAt(const Trajectory& trajectory, Nanoseconds stamp, double max_gap);

}  // namespace racecar_mcl
