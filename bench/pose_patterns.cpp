#include "pose_patterns.h"

#include <algorithm>
#include <cmath>

#include "racecar_mcl/common/random.h"
#include "racecar_mcl/map/cell_runs.h"

namespace racecar_mcl::bench {

void Poses::add(const Pose2& pose) {
  x.push_back(pose.x);
  y.push_back(pose.y);
  yaw.push_back(pose.yaw);
}

Poses scatteredPoses(const OccupancyGrid& grid, int count, std::uint64_t seed) {
  Random random(seed);
  const CellRuns cells = freeCells(grid);
  Poses poses;
  for (int i = 0; i < count; ++i) {
    const Cell cell = cells[random.index(cells.size())];
    const Eigen::Vector2d point =
        gridToWorld(grid.geometry(), {cell.column + random.uniform(), cell.row + random.uniform()});
    poses.add({point.x(), point.y(), random.uniform(-kPi, kPi)});
  }
  return poses;
}

Poses cloud(const Pose2& centre, int count, double sigma, double sigma_yaw, std::uint64_t seed) {
  Random random(seed);
  Poses poses;
  for (int i = 0; i < count; ++i) {
    const double x = centre.x + sigma * random.gaussian();
    const double y = centre.y + sigma * random.gaussian();
    poses.add({x, y, centre.yaw + sigma_yaw * random.gaussian()});
  }
  return poses;
}

Pose2 roomyPose(const OccupancyGrid& grid, std::uint64_t seed) {
  Random random(seed);
  const CellRuns cells = freeCells(grid);
  const int room = static_cast<int>(std::ceil(0.5 / grid.geometry().resolution));
  while (true) {
    const Cell cell = cells[random.index(cells.size())];
    bool free = true;
    for (int i = -room; i <= room && free; ++i) {
      for (int j = -room; j <= room && free; ++j) {
        free = grid.isFree({cell.column + i, cell.row + j});
      }
    }
    if (!free) continue;
    const Eigen::Vector2d point = cellCentre(grid.geometry(), cell);
    return {point.x(), point.y(), random.uniform(-kPi, kPi)};
  }
}

std::vector<Pose2> basementDrive(const OccupancyGrid& basement, double seconds) {
  const Eigen::Vector2d corners[] = {{125, 125}, {1600, 125}, {1600, 455},  {505, 455},
                                     {505, 805}, {1265, 805}, {1265, 1175}, {125, 1175}};
  constexpr double kStep = 3.0 / 40.0;  // m per scan
  constexpr double kTurn = 2.0 / 40.0;  // rad per scan, maximum
  std::vector<Pose2> drive;
  Eigen::Vector2d position = corners[0];
  double yaw = basement.geometry().origin.yaw;
  std::size_t next = 1;
  while (static_cast<double>(drive.size()) < seconds * 40.0) {
    const Eigen::Vector2d ahead = corners[next] - position;
    const double step = kStep / basement.geometry().resolution;
    if (ahead.norm() <= step) {
      position = corners[next];
      next = (next + 1) % std::size(corners);
    } else {
      position += ahead.normalized() * step;
    }
    const double wanted = std::atan2(ahead.y(), ahead.x()) + basement.geometry().origin.yaw;
    yaw += std::clamp(wrapAngle(wanted - yaw), -kTurn, kTurn);
    const Eigen::Vector2d point = gridToWorld(basement.geometry(), position);
    drive.push_back({point.x(), point.y(), yaw});
  }
  return drive;
}

}  // namespace racecar_mcl::bench
