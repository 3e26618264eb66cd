// Chains of parent frames in a tf buffer.
#pragma once

#include <tf2/buffer_core.h>

#include <algorithm>
#include <string>
#include <vector>

namespace racecar_mcl {

/// `frame` and its ancestors, up to but excluding the first of `roots`. Ends at a loop.
inline std::vector<std::string> ancestorsBelow(const std::vector<std::string>& roots,
                                               const tf2::BufferCore& buffer, std::string frame) {
  const auto isIn = [](const std::vector<std::string>& frames, const std::string& name) {
    return std::find(frames.begin(), frames.end(), name) != frames.end();
  };
  std::vector<std::string> chain;
  while (!isIn(roots, frame) && !isIn(chain, frame)) {
    chain.push_back(frame);
    std::string parent;
    if (!buffer._getParent(frame, ros::Time(0), parent)) break;
    frame = parent;
  }
  return chain;
}

}  // namespace racecar_mcl
