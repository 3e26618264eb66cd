// Comparison of poses; yaw modulo a full turn.
#pragma once

#include <gtest/gtest.h>

#include "racecar_mcl/geometry/pose2.h"

namespace racecar_mcl {

inline void expectNear(const Pose2& a, const Pose2& b, double metres, double radians) {
  EXPECT_NEAR(a.x, b.x, metres);
  EXPECT_NEAR(a.y, b.y, metres);
  EXPECT_NEAR(wrapAngle(a.yaw - b.yaw), 0.0, radians);
}

/// `tolerance`: m and rad.
inline void expectNear(const Pose2& a, const Pose2& b, double tolerance = 1e-9) {
  expectNear(a, b, tolerance, tolerance);
}

}  // namespace racecar_mcl
