// Generates the rays of a march.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "raycasting/beam_directions.h"
#include "raycasting/ray_slots.h"

namespace racecar_mcl {

/// Generates the rays of a march, pose by pose, for a block of bearings.
class RayGenerator {
 public:
  RayGenerator(const MarchTask& task, const MarchFrame& frame, const BeamDirections<float>& beams)
      : task_(task), frame_(frame), beams_(beams), next_beam_(static_cast<int>(beams.size)) {}

  /// Whether all poses so far are inside the map.
  bool allInMap() const { return all_in_map_; }

  /// Puts the next ray into slot i; false if there is none.
  RACECAR_MCL_INLINE bool next(RaySlots& s, int i) {
    if (next_beam_ == static_cast<int>(beams_.size) && !nextPose()) return false;
    const int k = next_beam_++;
    s.ox[i] = ox_;
    s.oy[i] = oy_;
    s.dx[i] = dx_[k];
    s.dy[i] = dy_[k];
    s.ix[i] = ix_[k];
    s.iy[i] = iy_[k];
    s.corner[i] = corner_;
    s.range[i] = ranges_ + beams_.index[k];
    s.t[i] = 0.0F;
    s.clearance[i] = clearance_;
    return true;
  }

 private:
  RACECAR_MCL_INLINE bool nextPose() {
    PoseInCells pose;
    while (true) {
      if (selected_ == task_.selection.count) return false;
      pose_ = task_.selection[selected_++];
      pose = task_.grid.toCells(task_.lidar_in_map.pose(pose_));
      if (task_.grid.contains(pose.position) && std::isfinite(pose.cos_yaw)) break;
      all_in_map_ = false;
    }

    const int column = static_cast<int>(pose.position.x());
    const int row = static_cast<int>(pose.position.y());
    const auto reach = static_cast<float>(frame_.reach);
    // Rounding must not move the pose into the next cell.
    ox_ = std::min(reach + static_cast<float>(pose.position.x() - column),
                   reach + 1.0F - frame_.margin);
    oy_ =
        std::min(reach + static_cast<float>(pose.position.y() - row), reach + 1.0F - frame_.margin);
    corner_ = (row - frame_.reach) * frame_.row + column - frame_.reach;

    clearance_ = frame_.field[corner_ + frame_.reach * (frame_.row + 1)];
    ranges_ = task_.ranges.col(pose_).data();

    const auto c = static_cast<float>(pose.cos_yaw);
    const auto s = static_cast<float>(pose.sin_yaw);
    const int count = static_cast<int>(beams_.size);
    for (int k = 0; k < count; ++k) {
      constexpr float kMinDirection = 1e-12F;  // so that 1 / direction is finite
      const float dx = c * beams_.cosine[k] - s * beams_.sine[k];
      const float dy = s * beams_.cosine[k] + c * beams_.sine[k];
      dx_[k] = std::fabs(dx) < kMinDirection ? kMinDirection : dx;
      dy_[k] = std::fabs(dy) < kMinDirection ? kMinDirection : dy;
      ix_[k] = 1.0F / dx_[k];
      iy_[k] = 1.0F / dy_[k];
    }
    next_beam_ = 0;
    return true;
  }

  const MarchTask& task_;
  const MarchFrame& frame_;
  const BeamDirections<float>& beams_;
  Eigen::Index selected_ = 0;
  Eigen::Index pose_ = 0;
  int next_beam_;
  float ox_ = 0.0F;
  float oy_ = 0.0F;
  int corner_ = 0;
  int clearance_ = 0;
  float* ranges_ = nullptr;
  bool all_in_map_ = true;
  alignas(64) std::array<float, kBlockSize> dx_, dy_, ix_, iy_;
};

}  // namespace racecar_mcl
