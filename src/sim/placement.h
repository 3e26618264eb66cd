// Where to put a car and things in its way.
#pragma once

#include <vector>

#include "sim/car.h"
#include "sim/world.h"

namespace racecar_mcl::sim {

/// A pose in known free space with `clearance` m all round the car. Throws MapError where none was
/// found.
Pose2 randomFreePose(const World& world, const CarParameters& car, Random& random,
                     double clearance = 0.1);

/// Up to `count` boxes, fewer where there is no room, that stand free: 0.15 to 0.4 m from the
/// nearest wall or what is unknown, as far from `keep_clear` and one another, and with as wide a
/// way past, as scattered obstacles.
std::vector<Obstacle> standBoxes(const World& world, int count, const Pose2& keep_clear,
                                 Random& random);

/// `count` unmapped discs and boxes beside the walls and what is unknown, of which `moving` walk 2
/// m to and fro along them. None comes within 3 m of `keep_clear` or of another, or within 1.2 m of
/// `others`, which stand already, and each leaves 1.4 m or more to pass, all along its walk. Throws
/// MapError where the world has no room for them.
std::vector<Obstacle> scatterObstacles(const World& world, int count, int moving,
                                       const Pose2& keep_clear, Random& random,
                                       const std::vector<Obstacle>& others = {});

}  // namespace racecar_mcl::sim
