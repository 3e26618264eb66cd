#include "racecar_mcl/map/map_io.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <utility>
#include <vector>

#include "map_description.h"
#include "racecar_mcl/common/errors.h"

namespace racecar_mcl {
namespace {

namespace fs = std::filesystem;

/// The value of white. OpenCV scales 8-bit ASCII PNM files to 255 itself, but does not apply the
/// maximum in the header of binary and 16-bit ones.
double whiteOf(const fs::path& path, const cv::Mat& image) {
  const bool deep = image.depth() == CV_16U;
  const double full = deep ? 65535.0 : 255.0;
  std::ifstream file(path, std::ios::binary);
  char magic[2] = {};
  file.read(magic, 2);
  const bool binary = magic[1] == '5' || magic[1] == '6';
  const bool ascii = magic[1] == '2' || magic[1] == '3';
  if (magic[0] != 'P' || !(binary || (ascii && deep))) return full;

  // Width, height and maximum, separated by white space and comments.
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
        name +
        " is empty, truncated or of an unknown format; expected an image such as PGM or PNG");
  }
  if (image.depth() != CV_8U && image.depth() != CV_16U) {
    throw MapError(name + " does not hold whole numbers; expected 8 or 16 bits per channel");
  }
  return image;
}

/// The cell value of a pixel's mean over its channels (0 to 255), as in map_server.
std::int8_t cellValue(double brightness, bool transparent, const MapDescription& description) {
  const double value = description.negate ? 255.0 - brightness : brightness;
  if (description.mode == MapDescription::Mode::kRaw) {
    return value < 101.0 ? static_cast<std::int8_t>(value) : OccupancyGrid::kUnknown;
  }
  const double occupancy = (255.0 - value) / 255.0;
  if (occupancy > description.occupied_threshold) return OccupancyGrid::kOccupied;
  if (occupancy < description.free_threshold) return OccupancyGrid::kFree;
  if (description.mode == MapDescription::Mode::kTrinary || transparent)
    return OccupancyGrid::kUnknown;
  if (description.free_threshold == description.occupied_threshold) return OccupancyGrid::kUnknown;
  // Linear between the thresholds, from 1 to 99.
  const double ratio = (occupancy - description.free_threshold) /
                       (description.occupied_threshold - description.free_threshold);
  return static_cast<std::int8_t>(1.0 + 98.0 * ratio);
}

}  // namespace

std::vector<std::string> mapFiles(const std::string& yaml_path) {
  try {
    return {yaml_path, readMapDescription(yaml_path).image.string()};
  } catch (const MapError&) {
    return {yaml_path};
  }
}

OccupancyGrid loadMap(const std::string& yaml_path) {
  const MapDescription description = readMapDescription(yaml_path);
  const cv::Mat image = readImage(description.image);

  // Alpha is the last channel of two or four. As in map_server, trinary averages it with the
  // colours.
  const int channels = image.channels();
  const bool has_alpha = channels == 2 || channels == 4;
  const int averaged =
      has_alpha && description.mode != MapDescription::Mode::kTrinary ? channels - 1 : channels;
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
