// Poses over time, and the TUM files they are kept in.
#pragma once

#include <cstdint>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "racecar_mcl/pose.h"

namespace racecar_mcl {

/// Time in ns since the epoch: a double in seconds tells Unix times apart to 0.2 us only.
using Nanoseconds = std::int64_t;

inline double toSeconds(Nanoseconds duration) { return 1e-9 * static_cast<double>(duration); }

struct StampedPose {
  Nanoseconds stamp = 0;
  Pose2 pose;
};

/// In order of stamps, each stamp once.
using Trajectory = std::vector<StampedPose>;

/// A trajectory file that cannot be read or used; says which, the line, and what was expected.
struct TrajectoryError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Seconds with nine digits behind the point.
std::string formatStamp(Nanoseconds stamp);

/// "[first, last]" in seconds, of a trajectory that is not empty.
std::string spanOf(const Trajectory& trajectory);

/// Sorts by stamp and keeps the first of those with the same.
Trajectory inOrder(std::vector<StampedPose> poses);

/// Reads lines of `t x y z qx qy qz qw`; lines that are empty or start with # are skipped. Throws
/// TrajectoryError.
Trajectory readTum(const std::string& path);

/// Stamps to the ns, so that they compare equal to those of the messages.
void writeTum(const Trajectory& trajectory, std::ostream& out);

/// The pose at a time: a pose of that very stamp, else interpolated between the two about it
/// (straight in position, the short way round in yaw). None outside the trajectory and inside a gap
/// longer than `max_gap` seconds.
std::optional<Pose2> poseAt(const Trajectory& trajectory, Nanoseconds stamp, double max_gap);

}  // namespace racecar_mcl
