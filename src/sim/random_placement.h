// Random placement of the car and of obstacles.
#pragma once

#include <vector>

#include "sim/car.h"
#include "sim/world.h"

namespace racecar_mcl::sim {

/// Number of random places that are tried before a placement is given up.
constexpr int kPlacementAttempts = 20000;

/// A pose in free space with `clearance` m around the car. Throws MapError if none was found.
Pose2 randomFreePose(const World& world, const CarParameters& car, Random& random,
                     double clearance = 0.1);

/// Up to `count` isolated boxes, as far as there is room: 0.15 to 0.4 m from the nearest wall or
/// unknown cell, with the spacing and passage width of scatterObstacles.
std::vector<Obstacle> placeBoxes(const World& world, int count, const Pose2& keep_clear,
                                 Random& random);

/// `count` discs and boxes next to walls or unknown cells, of which `moving` move 2 m back and
/// forth along them. They keep 3 m from `keep_clear` and each other, 1.2 m from the existing
/// `others`, and leave a passage of at least 1.4 m along their paths. Throws MapError if there is
/// no room.
std::vector<Obstacle> scatterObstacles(const World& world, int count, int moving,
                                       const Pose2& keep_clear, Random& random,
                                       const std::vector<Obstacle>& others = {});

}  // namespace racecar_mcl::sim
