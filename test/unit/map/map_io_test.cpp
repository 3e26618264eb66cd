#include "racecar_mcl/map/map_io.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "racecar_mcl/common/errors.h"
#include "support/ascii_map.h"
#include "support/temporary_directory.h"

namespace racecar_mcl {
namespace {

using Cells = std::vector<std::int8_t>;

const std::string kDescription =
    "image: map.pgm\nresolution: 0.1\norigin: [-1.5, 2.0, 0.0]\nnegate: 0\n"
    "occupied_thresh: 0.65\nfree_thresh: 0.196\n";

/// A valid description with one value replaced; an empty value removes the line.
std::string descriptionWith(const std::string& key, const std::string& value) {
  const std::size_t begin = kDescription.find(key + ":");
  const std::size_t end = kDescription.find('\n', begin) + 1;
  const std::string line = value.empty() ? "" : key + ": " + value + "\n";
  return kDescription.substr(0, begin) + line + kDescription.substr(end);
}

/// A binary PGM, highest row first.
std::string pgm(int width, int height, const std::vector<int>& pixels, int white = 255) {
  return "P5\n# drawn by a test\n" + std::to_string(width) + " " + std::to_string(height) + "\n" +
         std::to_string(white) + "\n" + std::string(pixels.begin(), pixels.end());
}

class MapIo : public ::testing::Test {
 protected:
  MapIo() {
    // White is free, black is a wall, 205 is the unknown of mapping programs.
    directory_.write("map.pgm", pgm(3, 2, {255, 255, 205, 0, 255, 255}));
  }

  void writeImage(const std::string& name, const cv::Mat& image) const {
    ASSERT_TRUE(cv::imwrite((directory_.path() / name).string(), image));
  }

  OccupancyGrid load(const std::string& description) const {
    return loadMap(directory_.write("map.yaml", description));
  }

  /// The message of the error thrown by loading.
  std::string errorOf(const std::string& description) const {
    try {
      load(description);
    } catch (const MapError& e) {
      return e.what();
    }
    ADD_FAILURE() << "no MapError for\n" << description;
    return "";
  }

  void expectError(const std::string& description, const std::vector<std::string>& parts) const {
    const std::string message = errorOf(description);
    for (const std::string& part : parts) {
      EXPECT_NE(message.find(part), std::string::npos) << "'" << part << "' not in: " << message;
    }
  }

  TemporaryDirectory directory_;
};

TEST_F(MapIo, ReadsATenCentimetrePgm) {
  const OccupancyGrid grid = load(kDescription);
  EXPECT_EQ(grid.geometry().width, 3);
  EXPECT_EQ(grid.geometry().height, 2);
  EXPECT_EQ(grid.geometry().resolution, 0.1);
  EXPECT_EQ(grid.geometry().origin.x, -1.5);
  EXPECT_EQ(grid.geometry().origin.y, 2.0);
  EXPECT_EQ(grid.geometry().origin.yaw, 0.0);
  EXPECT_EQ(toAscii(grid), "..?\n#..\n");
}

TEST_F(MapIo, ReadsThePgmAsPngAlike) {
  writeImage("map.png", cv::imread((directory_.path() / "map.pgm").string(), cv::IMREAD_UNCHANGED));
  EXPECT_EQ(load(descriptionWith("image", "map.png")).cells(), load(kDescription).cells());
}

TEST_F(MapIo, KeepsTheOriginsYaw) {
  const GridGeometry geometry = load(descriptionWith("origin", "[5, -2, 3.14]")).geometry();
  EXPECT_EQ(geometry.origin.yaw, 3.14);
  // The lower left pixel's centre, half a turn about the origin.
  EXPECT_NEAR(cellCentre(geometry, {0, 0}).x(), 4.95, 1e-3);
  EXPECT_NEAR(cellCentre(geometry, {0, 0}).y(), -2.05, 1e-3);
}

TEST_F(MapIo, TakesTheImagePathRelativeToTheDescription) {
  directory_.write("images/map.pgm", pgm(1, 1, {255}));
  directory_.write("maps/map.yaml", descriptionWith("image", "../images/map.pgm"));
  EXPECT_EQ(loadMap((directory_.path() / "maps/map.yaml").string()).cells(), Cells({0}));
  const std::string absolute = (directory_.path() / "images/map.pgm").string();
  EXPECT_EQ(load(descriptionWith("image", absolute)).cells(), Cells({0}));
}

TEST_F(MapIo, AppliesTheThresholdsAsMapServerDoes) {
  // p = (255 - v) / 255: 0.647 and 0.651 about 0.65, then 0.1961 and 0.192 about 0.196.
  directory_.write("map.pgm", pgm(4, 1, {90, 89, 205, 206}));
  EXPECT_EQ(load(kDescription).cells(), Cells({-1, 100, -1, 0}));
  // A value equal to a threshold is unknown: 204 is exactly 0.2.
  directory_.write("map.pgm", pgm(1, 1, {204}));
  EXPECT_EQ(load(descriptionWith("free_thresh", "0.2")).cells(), Cells({-1}));
}

TEST_F(MapIo, NegateInvertsBlackAndWhite) {
  directory_.write("map.pgm", pgm(3, 1, {0, 255, 128}));
  EXPECT_EQ(load(descriptionWith("negate", "1")).cells(), Cells({0, 100, -1}));
  EXPECT_EQ(load(descriptionWith("negate", "true")).cells(), Cells({0, 100, -1}));
  EXPECT_EQ(load(descriptionWith("negate", "false")).cells(), Cells({100, 0, -1}));
}

TEST_F(MapIo, ScaleModeKeepsValuesBetweenTheThresholds) {
  directory_.write("map.pgm", pgm(5, 1, {0, 255, 128, 90, 205}));
  // 1 + 98 (p - 0.196) / (0.65 - 0.196), truncated to an integer.
  EXPECT_EQ(load(kDescription + "mode: scale\n").cells(), Cells({100, 0, 66, 98, 1}));
}

TEST_F(MapIo, RawModeKeepsTheValues) {
  directory_.write("map.pgm", pgm(5, 1, {0, 42, 100, 101, 255}));
  EXPECT_EQ(load(kDescription + "mode: raw\n").cells(), Cells({0, 42, 100, -1, -1}));
  EXPECT_EQ(load(descriptionWith("negate", "1") + "mode: raw\n").cells(),
            Cells({-1, -1, -1, -1, 0}));
}

TEST_F(MapIo, AveragesColours) {
  // Means of 100 and 50: p = 0.608 and 0.804.
  cv::Mat image(1, 2, CV_8UC3);
  image.at<cv::Vec3b>(0, 0) = {0, 100, 200};
  image.at<cv::Vec3b>(0, 1) = {150, 0, 0};
  writeImage("map.png", image);
  EXPECT_EQ(load(descriptionWith("image", "map.png")).cells(), Cells({-1, 100}));
}

TEST_F(MapIo, TransparencyMeansUnknownInScaleModeAndIsAveragedInTrinary) {
  // Opaque grey, transparent grey, transparent black.
  cv::Mat image(1, 3, CV_8UC4);
  image.at<cv::Vec4b>(0, 0) = {128, 128, 128, 255};
  image.at<cv::Vec4b>(0, 1) = {128, 128, 128, 0};
  image.at<cv::Vec4b>(0, 2) = {0, 0, 0, 0};
  writeImage("map.png", image);
  const std::string description = descriptionWith("image", "map.png");
  EXPECT_EQ(load(description + "mode: scale\n").cells(), Cells({66, -1, 100}));
  EXPECT_EQ(load(description + "mode: trinary\n").cells(), Cells({-1, -1, 100}));
  EXPECT_EQ(load(description + "mode: raw\n").cells(), Cells({-1, -1, 0}));
}

TEST_F(MapIo, ScalesDeepAndDarkImagesToTheirWhite) {
  cv::Mat deep(1, 3, CV_16UC1);
  deep.at<std::uint16_t>(0, 0) = 0;
  deep.at<std::uint16_t>(0, 1) = 205 * 257;
  deep.at<std::uint16_t>(0, 2) = 65535;
  writeImage("map.png", deep);
  EXPECT_EQ(load(descriptionWith("image", "map.png")).cells(), Cells({100, -1, 0}));
  directory_.write("map.pgm", pgm(3, 1, {0, 50, 100}, 100));
  EXPECT_EQ(load(kDescription).cells(), Cells({100, -1, 0}));
  directory_.write("map.pgm", "P2\n3 1\n100\n0 50 100\n");
  EXPECT_EQ(load(kDescription).cells(), Cells({100, -1, 0}));
  directory_.write("map.pgm", "P2\n3 1\n1000\n0 500 1000\n");
  EXPECT_EQ(load(kDescription).cells(), Cells({100, -1, 0}));
}

TEST_F(MapIo, ReadsAMapWithoutAFreeCell) {
  directory_.write("map.pgm", pgm(2, 1, {0, 205}));
  EXPECT_FALSE(hasFreeCell(load(kDescription)));
}

TEST_F(MapIo, NamesAMissingDescription) {
  const std::string path = (directory_.path() / "nowhere.yaml").string();
  try {
    loadMap(path);
    FAIL();
  } catch (const MapError& e) {
    EXPECT_EQ(std::string(e.what()), "map description '" + path + "' does not exist");
  }
  EXPECT_THROW(loadMap(directory_.path().string()), MapError);
  EXPECT_THROW(loadMap("/dev/zero"), MapError);
  EXPECT_THROW(loadMap(""), MapError);
}

TEST_F(MapIo, NamesTheLineOfBrokenYaml) {
  expectError("image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0\nnegate: 0\n",
              {"map.yaml', line 4, is not valid YAML"});
  expectError("", {"map.yaml", "no 'key: value' pairs"});
  expectError("- image\n- resolution\n", {"line 1,", "no 'key: value' pairs"});
  expectError("just words\n", {"no 'key: value' pairs"});
  expectError(std::string("\x00\xff\xfe\x01", 4), {"map.yaml"});
  expectError(std::string(300, '['), {"map.yaml"});
}

TEST_F(MapIo, RejectsAnImageGivenAsDescription) {
  const std::string image =
      directory_.write("big.pgm", pgm(500, 500, std::vector<int>(250000, 255)));
  try {
    loadMap(image);
    FAIL();
  } catch (const MapError& e) {
    EXPECT_NE(std::string(e.what()).find("expected a short YAML file"), std::string::npos);
  }
  EXPECT_THROW(loadMap((directory_.path() / "map.pgm").string()), MapError);
}

TEST_F(MapIo, NamesEveryMissingKey) {
  for (const std::string key :
       {"image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh"}) {
    expectError(descriptionWith(key, ""), {"map.yaml", "lacks the key '" + key + "'; expected"});
  }
}

struct BadValue {
  std::string key;
  std::string value;
};

TEST_F(MapIo, NamesKeyLineAndExpectationOfABadValue) {
  const std::vector<BadValue> bad_values = {{"resolution", "0"},
                                            {"resolution", "0.0"},
                                            {"resolution", "-0.05"},
                                            {"resolution", "1e400"},
                                            {"resolution", "1e300"},
                                            {"resolution", "1e-300"},
                                            {"resolution", ".nan"},
                                            {"resolution", ".inf"},
                                            {"resolution", "0,05"},
                                            {"resolution", "five"},
                                            {"resolution", "[0.05]"},
                                            {"resolution", "~"},
                                            {"origin", "0"},
                                            {"origin", "[0, 0]"},
                                            {"origin", "[0, 0, 0, 1]"},
                                            {"origin", "[0, .nan, 0]"},
                                            {"origin", "[.inf, 0, 0]"},
                                            {"origin", "[0, 0, north]"},
                                            {"origin", "[0, 0, [0]]"},
                                            {"origin", "[0, 0, 1e999]"},
                                            {"origin", "[1e308, 0, 0]"},
                                            {"origin", "[0, -1e8, 0]"},
                                            {"origin", "[0, 0, 180]"},
                                            {"resolution", "1e5"},
                                            {"negate", "2"},
                                            {"negate", "-1"},
                                            {"negate", "99999999999999999999999"},
                                            {"negate", "{}"},
                                            {"occupied_thresh", "1.1"},
                                            {"occupied_thresh", "65"},
                                            {"occupied_thresh", "high"},
                                            {"free_thresh", "-0.1"},
                                            {"free_thresh", ".nan"},
                                            {"free_thresh", "0.9"},
                                            {"image", "''"},
                                            {"image", "[map.pgm]"}};
  for (const BadValue& bad : bad_values) {
    SCOPED_TRACE(bad.key + ": " + bad.value);
    expectError(descriptionWith(bad.key, bad.value),
                {"map.yaml', line ", "'" + bad.key + ": ", "; expected "});
  }
  EXPECT_NO_THROW(load(descriptionWith("free_thresh", "0.65"))) << "equal thresholds";
  EXPECT_NO_THROW(load(descriptionWith("free_thresh", "0.65") + "mode: scale\n"));
  expectError(kDescription + "mode: quaternary\n",
              {"line 7,", "'mode: quaternary'; expected trinary, scale or raw"});
  expectError(kDescription + "mode: [raw]\n", {"line 7,", "expected trinary, scale or raw"});
  expectError(descriptionWith("resolution", std::string(5000, '9') + "x"), {"999..."});
}

TEST_F(MapIo, NamesAnImageThatIsMissingOrUnreadable) {
  expectError(descriptionWith("image", "nowhere.pgm"),
              {"map image", "nowhere.pgm' does not exist"});
  directory_.write("folder/file", "");
  expectError(descriptionWith("image", "folder"), {"folder' is not a regular file"});
  directory_.write("empty.png", "");
  expectError(descriptionWith("image", "empty.png"),
              {"empty.png' is empty, truncated or of an unknown"});
  directory_.write("words.png", "this is no image");
  expectError(descriptionWith("image", "words.png"), {"words.png"});
  directory_.write("map.pgm", pgm(3, 2, {255, 255}));
  expectError(kDescription, {"map.pgm' is empty, truncated"});
  directory_.write("map.pgm", pgm(0, 2, {}));
  expectError(kDescription, {"map.pgm"});
  directory_.write("map.pgm", pgm(60000, 60000, {}));
  expectError(kDescription, {"map.pgm' cannot be read"});
  cv::Mat floats(1, 1, CV_32FC1, cv::Scalar(0.5));
  writeImage("map.tiff", floats);
  expectError(descriptionWith("image", "map.tiff"), {"map.tiff' does not hold whole numbers"});
}

}  // namespace
}  // namespace racecar_mcl
