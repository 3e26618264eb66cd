#include "map_description.h"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <vector>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/common/printable.h"

namespace racecar_mcl {
namespace {

namespace fs = std::filesystem;

// Descriptions have about ten lines. Longer files are something else (most often the image itself),
// and parsing them as YAML could take very long.
constexpr std::uintmax_t kMaxDescriptionBytes = 64 * 1024;

/// Reads the keys of the YAML file. Errors state the file, the line, the key and the expected
/// value.
class DescriptionReader {
 public:
  explicit DescriptionReader(const fs::path& path) : path_(path) {
    requireRegularFile(path_, "map description '" + path_.string() + "'");
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(path_, error);
    if (!error && bytes > kMaxDescriptionBytes) {
      throw MapError("map description '" + path_.string() + "' has " + std::to_string(bytes) +
                     " bytes; expected a short YAML file that names the image");
    }
    std::ifstream file(path_);
    if (!file) throw MapError("map description '" + path_.string() + "' cannot be opened");
    try {
      root_ = YAML::Load(file);
    } catch (const YAML::Exception& e) {
      fail(e.mark, "is not valid YAML: " + e.msg);
    }
    if (!root_.IsMap()) {
      fail(root_.Mark(),
           "holds no 'key: value' pairs; expected image, resolution, origin, negate, "
           "occupied_thresh and free_thresh");
    }
  }

  bool has(const std::string& key) const { return static_cast<bool>(root_[key]); }

  std::string text(const std::string& key, const std::string& expected) const {
    const YAML::Node node = require(key, expected);
    if (!node.IsScalar() || node.Scalar().empty()) failAt(key, node, expected);
    return node.Scalar();
  }

  double number(const std::string& key, const std::string& expected) const {
    return toNumber(key, require(key, expected), expected);
  }

  std::vector<double> numbers(const std::string& key, std::size_t count,
                              const std::string& expected) const {
    const YAML::Node node = require(key, expected);
    if (!node.IsSequence() || node.size() != count) failAt(key, node, expected);
    std::vector<double> values;
    for (const YAML::Node& item : node) values.push_back(toNumber(key, item, expected));
    return values;
  }

  /// Throws MapError: the value of `key` has the right type but is invalid.
  [[noreturn]] void reject(const std::string& key, const std::string& expected) const {
    failAt(key, root_[key], expected);
  }

 private:
  YAML::Node require(const std::string& key, const std::string& expected) const {
    const YAML::Node node = root_[key];
    if (!node) {
      fail(YAML::Mark::null_mark(), "lacks the key '" + key + "'; expected " + expected);
    }
    return node;
  }

  double toNumber(const std::string& key, const YAML::Node& node,
                  const std::string& expected) const {
    double value = 0.0;
    if (!YAML::convert<double>::decode(node, value) || !std::isfinite(value)) {
      failAt(key, root_[key], expected);
    }
    return value;
  }

  [[noreturn]] void failAt(const std::string& key, const YAML::Node& node,
                           const std::string& expected) const {
    const std::string value = printable(YAML::Dump(node));
    fail(node.Mark(), "has '" + key + ": " + value + "'; expected " + expected);
  }

  [[noreturn]] void fail(const YAML::Mark& mark, const std::string& problem) const {
    const std::string line = mark.is_null() ? "" : ", line " + std::to_string(mark.line + 1) + ",";
    throw MapError("map description '" + path_.string() + "'" + line + " " + problem);
  }

  fs::path path_;
  YAML::Node root_;
};

bool readNegate(const DescriptionReader& yaml) {
  const std::string value = yaml.text("negate", "0 or 1");
  if (value == "1" || value == "true") return true;
  if (value != "0" && value != "false") yaml.reject("negate", "0 or 1");
  return false;
}

MapDescription::Mode readMode(const DescriptionReader& yaml) {
  const std::string expected = "trinary, scale or raw";
  const std::string name = yaml.has("mode") ? yaml.text("mode", expected) : "trinary";
  if (name == "scale") return MapDescription::Mode::kScale;
  if (name == "raw") return MapDescription::Mode::kRaw;
  if (name != "trinary") yaml.reject("mode", expected);
  return MapDescription::Mode::kTrinary;
}

}  // namespace

void requireRegularFile(const fs::path& path, const std::string& what) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw MapError(what + " does not exist");
  if (!fs::is_regular_file(status)) throw MapError(what + " is not a regular file");
}

MapDescription readMapDescription(const fs::path& path) {
  const DescriptionReader yaml(path);
  const std::string threshold = "a number in [0, 1]";
  const std::string resolution = "metres per cell, from 0.0001 to 1000";
  const std::string position = "[x, y, yaw], finite, in metres (up to 1e7) and radians (up to 13)";

  MapDescription description;
  description.image =
      path.parent_path() / yaml.text("image", "the image's path, relative to this file");
  description.resolution = yaml.number("resolution", resolution);
  const auto origin = yaml.numbers("origin", 3, position);
  description.origin = {origin[0], origin[1], origin[2]};
  description.negate = readNegate(yaml);
  description.occupied_threshold = yaml.number("occupied_thresh", threshold);
  description.free_threshold = yaml.number("free_thresh", threshold);
  description.mode = readMode(yaml);

  const auto outside = [](double value) { return value < 0.0 || value > 1.0; };
  if (!(description.resolution >= kMinCellSize && description.resolution <= kMaxCellSize)) {
    yaml.reject("resolution", resolution);
  }
  if (!isWithin(description.origin, kMaxCoordinate) ||
      !isWithin(description.origin.yaw, kMaxInputAngle)) {
    yaml.reject("origin", position);
  }
  if (outside(description.occupied_threshold)) yaml.reject("occupied_thresh", threshold);
  if (outside(description.free_threshold)) yaml.reject("free_thresh", threshold);
  if (description.free_threshold > description.occupied_threshold) {
    std::ostringstream expected;
    expected << "at most occupied_thresh, " << description.occupied_threshold;
    yaml.reject("free_thresh", expected.str());
  }
  return description;
}

}  // namespace racecar_mcl
