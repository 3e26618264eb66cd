#include "ros/rviz_panel/panel_content.h"

#include <iomanip>
#include <map>
#include <sstream>

#include "racecar_mcl/geometry/pose2.h"

namespace racecar_mcl {
namespace {

using Status = diagnostic_msgs::DiagnosticStatus;

constexpr char kNoColour[] = "#606060";

std::string valueOf(const Status& status, const std::string& key) {
  for (const auto& pair : status.values) {
    if (pair.key == key) return pair.value;
  }
  return "";
}

/// None also if it is infinite or NaN. Streams ignore the locale of C, which Qt sets.
std::optional<double> numberOf(const Status& status, const std::string& key) {
  std::istringstream text(valueOf(status, key));
  double value = 0.0;
  if (!(text >> value)) return std::nullopt;
  return value;
}

std::string formatted(double value, int decimals) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(decimals) << value;
  return text.str();
}

std::string degrees(double radians) { return formatted(radians * 180.0 / kPi, 1) + "°"; }

std::string colourOf(const Status& status) {
  static const std::map<int, std::string> kColours = {
      {Status::OK, "#1b7f3b"}, {Status::WARN, "#a85f00"}, {Status::ERROR, "#c01c28"}};
  const auto found = kColours.find(status.level);
  return found == kColours.end() ? kNoColour : found->second;
}

std::string explainedText(const Status& status) {
  const auto share = numberOf(status, "inlier ratio (%)");
  const auto usual = numberOf(status, "baseline inlier ratio (%)");
  if (!share) return PanelContent::kUnknown;
  const std::string text = formatted(*share, 0) + " %";
  return usual ? text + ", usually " + formatted(*usual, 0) + " %" : text;
}

std::string positionBoundText(const Status& status) {
  const auto along = numberOf(status, "protection level along (m)");
  const auto across = numberOf(status, "protection level across (m)");
  if (!along || !across) return PanelContent::kUnknown;
  return formatted(*along, 2) + " m along, " + formatted(*across, 2) + " m across";
}

std::string headingBoundText(const Status& status) {
  const auto heading = numberOf(status, "protection level heading (rad)");
  return heading ? degrees(*heading) : PanelContent::kUnknown;
}

std::string sigmaText(const Status& diagnostics) {
  const auto position = numberOf(diagnostics, "position sigma (m)");
  const auto yaw = numberOf(diagnostics, "yaw sigma (rad)");
  if (!position || !yaw) return PanelContent::kUnknown;
  return formatted(*position, 3) + " m, " + degrees(*yaw);
}

std::string latencyText(const Status& diagnostics) {
  const auto median = numberOf(diagnostics, "scan to tf p50 (ms)");
  const auto high = numberOf(diagnostics, "scan to tf p99 (ms)");
  if (!median || !high) return PanelContent::kUnknown;
  return formatted(*median, 1) + " ms, 99 %: " + formatted(*high, 1) + " ms";
}

}  // namespace

PanelContent panelContent(const std::optional<Status>& status,
                          const std::optional<Status>& diagnostics) {
  PanelContent content;
  if (status) {
    content.state = status->message;
    content.reason = valueOf(*status, "reason");
    content.colour = colourOf(*status);
  } else if (diagnostics) {
    content.state = diagnostics->message;
    content.reason = valueOf(*diagnostics, "last problem");
    content.colour = colourOf(*diagnostics);
  } else {
    content.state = "no localizer";
    content.reason = "no message on pf/status and /diagnostics";
    content.colour = kNoColour;
  }
  if (!status) return content;  // before a start the other numbers are zeros
  content.explained = explainedText(*status);
  content.position_bound = positionBoundText(*status);
  content.heading_bound = headingBoundText(*status);
  if (!diagnostics) return content;
  content.sigma = sigmaText(*diagnostics);
  const std::string particles = valueOf(*diagnostics, "particles");
  if (!particles.empty()) content.particles = particles;
  content.latency = latencyText(*diagnostics);
  return content;
}

}  // namespace racecar_mcl
