// A car in front of a mapped wall.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "racecar_mcl/localizer/localization_map.h"
#include "racecar_mcl/scan/scan.h"
#include "support/ascii_map.h"

namespace racecar_mcl {

/// The car is 3 m in front of the near face of the wall at x = 11, behind which there is a room.
class WallAhead : public ::testing::Test {
 protected:
  /// Beams straight ahead, all of them `range` m long.
  static Scan beamsAhead(Eigen::Index count, float range) {
    Scan scan;
    scan.bearings = Eigen::ArrayXf::LinSpaced(count, -0.1f, 0.1f);
    scan.ranges = Eigen::ArrayXf::Constant(count, range);
    scan.seconds_after_stamp = Eigen::ArrayXf::Zero(count);
    return scan;
  }

  const Pose2 car_{8.0, 4.0, 0.0};
  std::shared_ptr<const LocalizationMap> map_ = makeLocalizationMap(asciiMap(R"(
      ####################
      #..........#.......#
      #..........#.......#
      #..........#.......#
      #..........#.......#
      #..........#.......#
      #..........#.......#
      ####################)"),
                                                                    SensorParameters{});
};

}  // namespace racecar_mcl
