// Check of a bag's records before rosbag reads them.
#pragma once

#include <stdexcept>
#include <string>

namespace racecar_mcl {

/// A bag with a damaged record.
struct BagStructureError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Checks lengths, numbers and offsets in a bag of format 2.0 (wiki.ros.org/Bags/Format/2.0), since
/// rosbag follows them without a check, even out of its buffers. Of compressed chunks only the
/// offsets are checked. Bags without an index and other files are left to rosbag. Throws
/// BagStructureError that names the damaged record's position.
void checkBagStructure(const std::string& path);

}  // namespace racecar_mcl
