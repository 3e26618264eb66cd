// Records the particle sets of a replay as CSV.
#pragma once

#include <optional>
#include <string>

#include "offline/offline_driver.h"

namespace racecar_mcl {

/// One row per particle after each update: scan stamp, x, y, yaw, normalised weight.
class ParticleRecorder : public ReplayObserver {
 public:
  /// `period`: minimum interval between recorded sets, s; 0 = every scan.
  explicit ParticleRecorder(double period) : period_(period) {}

  void onScan(const Scan& scan, const ScanRow& row, const Localizer& localizer) override;
  void onMessage(const Localizer& /*localizer*/) override {}

  const std::string& csv() const { return text_; }

 private:
  double period_;
  std::optional<double> last_;  ///< s
  std::string text_ = "stamp,x,y,yaw,weight\n";
};

}  // namespace racecar_mcl
