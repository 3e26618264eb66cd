// The texts and colours of the rviz panel, without Qt.
#pragma once

#include <diagnostic_msgs/DiagnosticStatus.h>

#include <optional>
#include <string>

namespace racecar_mcl {

struct PanelContent {
  static constexpr char kUnknown[] = "-";
  std::string state;   ///< "localized", "waiting for a map", ...
  std::string reason;  ///< of the state; may be empty
  std::string colour;  ///< background of the state, as "#rrggbb"; white text is legible on it
  std::string explained = kUnknown;  ///< share of the scan that agrees with the map
  std::string position_bound = kUnknown;
  std::string heading_bound = kUnknown;
  std::string sigma = kUnknown;  ///< standard deviations of position and heading
  std::string particles = kUnknown;
  std::string latency = kUnknown;  ///< from the arrival of a scan to its tf
};

/// From the newest messages of `pf/status` and of the localizer in `/diagnostics`; none if they
/// are missing or old. Before a start there are diagnostics only.
PanelContent panelContent(const std::optional<diagnostic_msgs::DiagnosticStatus>& status,
                          const std::optional<diagnostic_msgs::DiagnosticStatus>& diagnostics);

}  // namespace racecar_mcl
