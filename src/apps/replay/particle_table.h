// Particle sets of a replay as a table, for plots of one's own.
#pragma once

#include <optional>
#include <string>

#include "replay_run.h"

namespace racecar_mcl {

/// A row per particle: stamp of the scan, x, y, yaw, and its share of the whole weight, as the set
/// is after the scan was taken in.
class ParticleTable : public ReplayObserver {
 public:
  /// A set is taken when at least `period` seconds have passed since the last one; 0 = every scan.
  explicit ParticleTable(double period) : period_(period) {}

  void onScan(const Scan& scan, const ScanRow& row, const Localizer& localizer) override;
  void onMessage(const Localizer& /*localizer*/) override {}

  const std::string& csv() const { return text_; }

 private:
  double period_;
  std::optional<double> last_;  ///< s
  std::string text_ = "stamp,x,y,yaw,weight\n";
};

}  // namespace racecar_mcl
