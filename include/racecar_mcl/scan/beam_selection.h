// Selection of the beams of a scan that are used.
#pragma once

#include "racecar_mcl/scan/scan.h"

namespace racecar_mcl {

/// At most `count` valid beams, evenly spaced in the scan, within +-`field_of_view` / 2 (rad) of
/// the lidar's x axis. A beam is valid if its range is above zero (+inf included) and its bearing
/// and time are finite. A field of view of at least 2 pi includes all bearings. Throws
/// std::invalid_argument if the scan's arrays differ in length.
Scan selectBeams(const Scan& scan, int count, double field_of_view);

/// The same, with end points evenly spaced on the sides of a box around the lidar, `aspect` times
/// as long (along the car's x axis) as wide, like the walls of a corridor. Evenly spaced bearings
/// have most end points beside the car and few ahead of it. The beams are in the order of their
/// bearings, starting at the lidar's blind sector.
Scan selectBeamsBoxed(const Scan& scan, int count, double field_of_view, double aspect);

}  // namespace racecar_mcl
