#include "racecar_mcl/map_io.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "racecar_mcl/errors.h"

namespace racecar_mcl {
namespace {

namespace fs = std::filesystem;

// A description has a dozen lines. Anything longer is another file (most often the image itself),
// and parsing it as YAML could take very long.
constexpr std::uintmax_t kLongestDescription = 64 * 1024;

/// How a pixel becomes a cell.
enum class Mode { kTrinary, kScale, kRaw };

/// What the YAML says.
struct Description {
  fs::path image;
  double resolution = 0.0;  // m per cell
  Pose2 origin;
  bool negate = false;
  double occupied_threshold = 0.0;
  double free_threshold = 0.0;
  Mode mode = Mode::kTrinary;
};

/// Throws MapError unless the path names a file one can read to its end (no folder, pipe or
/// device).
void requireRegularFile(const fs::path& path, const std::string& what) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw MapError(what + " does not exist");
  if (!fs::is_regular_file(status)) throw MapError(what + " is not a regular file");
}

/// The YAML's keys, each read with an error that names the file, the line, the key and what belongs
/// there.
class DescriptionReader {
 public:
  explicit DescriptionReader(const fs::path& path) : path_(path) {
    requireRegularFile(path_, "map description '" + path_.string() + "'");
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(path_, error);
    if (!error && bytes > kLongestDescription) {
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

  /// Says that `key` holds something of the right type but of no use.
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
    // A long value would bury the message.
    std::string value = YAML::Dump(node);
    if (value.size() > 80) value = value.substr(0, 77) + "...";
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

Mode readMode(const DescriptionReader& yaml) {
  const std::string expected = "trinary, scale or raw";
  const std::string name = yaml.has("mode") ? yaml.text("mode", expected) : "trinary";
  if (name == "scale") return Mode::kScale;
  if (name == "raw") return Mode::kRaw;
  if (name != "trinary") yaml.reject("mode", expected);
  return Mode::kTrinary;
}

Description readDescription(const fs::path& path) {
  const DescriptionReader yaml(path);
  const std::string threshold = "a number in [0, 1]";
  const std::string resolution = "a positive number, metres per cell";

  Description description;
  description.image =
      path.parent_path() / yaml.text("image", "the image's path, relative to this file");
  description.resolution = yaml.number("resolution", resolution);
  const auto origin = yaml.numbers("origin", 3, "[x, y, yaw], finite, in metres and radians");
  description.origin = {origin[0], origin[1], origin[2]};
  description.negate = readNegate(yaml);
  description.occupied_threshold = yaml.number("occupied_thresh", threshold);
  description.free_threshold = yaml.number("free_thresh", threshold);
  description.mode = readMode(yaml);

  const auto outside = [](double value) { return value < 0.0 || value > 1.0; };
  // nav_msgs carries the resolution as a float, so it has to be one.
  using Float = std::numeric_limits<float>;
  if (!(description.resolution >= Float::min() && description.resolution <= Float::max())) {
    yaml.reject("resolution", resolution);
  }
  if (outside(description.occupied_threshold)) yaml.reject("occupied_thresh", threshold);
  if (outside(description.free_threshold)) yaml.reject("free_thresh", threshold);
  if (description.free_threshold >= description.occupied_threshold) {
    std::ostringstream expected;
    expected << "less than occupied_thresh, " << description.occupied_threshold;
    yaml.reject("free_thresh", expected.str());
  }
  return description;
}

/// The value that stands for white. OpenCV scales 8-bit ASCII PNM files to 255 itself, but leaves
/// the binary and the 16-bit ones as they are, whatever maximum their header gives.
double whiteOf(const fs::path& path, const cv::Mat& image) {
  const bool deep = image.depth() == CV_16U;
  const double full = deep ? 65535.0 : 255.0;
  std::ifstream file(path, std::ios::binary);
  char magic[2] = {};
  file.read(magic, 2);
  const bool binary = magic[1] == '5' || magic[1] == '6';
  const bool ascii = magic[1] == '2' || magic[1] == '3';
  if (magic[0] != 'P' || !(binary || (ascii && deep))) return full;

  // Width, height and maximum, between blanks and comments.
  int values[3] = {};
  for (int& value : values) {
    while ((file >> std::ws) && file.peek() == '#') {
      file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
    }
    file >> value;
  }
  return file && values[2] > 0 ? values[2] : full;
}

cv::Mat readImage(const fs::path& path) {
  const std::string name = "map image '" + path.string() + "'";
  requireRegularFile(path, name);
  cv::Mat image;
  try {
    image = cv::imread(path.string(), cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception& e) {
    throw MapError(name + " cannot be read: " + e.err);
  }
  if (image.empty()) {
    throw MapError(
        name + " is empty, cut off or of no known format; expected an image such as PGM or PNG");
  }
  if (image.depth() != CV_8U && image.depth() != CV_16U) {
    throw MapError(name + " does not hold whole numbers; expected 8 or 16 bits per channel");
  }
  return image;
}

/// A pixel's mean over its channels, 0 to 255, as a cell's value.
std::int8_t cellValue(double brightness, bool transparent, const Description& description) {
  const double value = description.negate ? 255.0 - brightness : brightness;
  if (description.mode == Mode::kRaw) {
    return value < 101.0 ? static_cast<std::int8_t>(value) : OccupancyGrid::kUnknown;
  }
  const double occupancy = (255.0 - value) / 255.0;
  if (occupancy > description.occupied_threshold) return OccupancyGrid::kOccupied;
  if (occupancy < description.free_threshold) return OccupancyGrid::kFree;
  if (description.mode == Mode::kTrinary || transparent) return OccupancyGrid::kUnknown;
  // Between the thresholds from 1 to 99: neither certainly free nor certainly occupied.
  const double ratio = (occupancy - description.free_threshold) /
                       (description.occupied_threshold - description.free_threshold);
  return static_cast<std::int8_t>(1.0 + 98.0 * ratio);
}

}  // namespace

OccupancyGrid loadMap(const std::string& yaml_path) {
  const Description description = readDescription(yaml_path);
  const cv::Mat image = readImage(description.image);

  // Alpha is the last channel of two or four. As in map_server, trinary averages it with the
  // colours.
  const int channels = image.channels();
  const bool has_alpha = channels == 2 || channels == 4;
  const int averaged = has_alpha && description.mode != Mode::kTrinary ? channels - 1 : channels;
  const double scale = 255.0 / whiteOf(description.image, image);

  std::vector<std::int8_t> cells;
  cells.reserve(image.total());
  cv::Mat pixels;
  for (int image_row = image.rows - 1; image_row >= 0; --image_row) {
    image.row(image_row).convertTo(pixels, CV_64F, scale);
    const double* pixel = pixels.ptr<double>();
    for (int column = 0; column < image.cols; ++column, pixel += channels) {
      const double sum = std::accumulate(pixel, pixel + averaged, 0.0);
      const bool transparent = has_alpha && pixel[channels - 1] == 0.0;
      cells.push_back(cellValue(std::min(sum / averaged, 255.0), transparent, description));
    }
  }
  return OccupancyGrid({image.cols, image.rows, description.resolution, description.origin},
                       std::move(cells));
}

}  // namespace racecar_mcl
