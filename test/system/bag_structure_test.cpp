#include "offline/bag_structure.h"

#include <gtest/gtest.h>
#include <rosbag/view.h>

#include <cstring>
#include <filesystem>

#include "offline/bag_reader.h"
#include "support/program.h"
#include "support/room_folder.h"

namespace racecar_mcl {
namespace {

class BagStructure : public RoomFolder {
 protected:
  BagStructure() {
    RoomDrive drive;
    drive.seconds = 0.2;
    writeRoomBag(path("intact.bag"), drive);
    bytes_ = readWhole(path("intact.bag"));
  }

  /// The bag with these bytes from a position on.
  template <typename Value>
  std::string changedAt(std::size_t position, const Value& value) const {
    std::string bag = bytes_;
    if (position > bag.size() - sizeof(value)) throw std::logic_error("not in the bag");
    std::memcpy(&bag[position], &value, sizeof(value));
    return folder_.write("changed.bag", bag);
  }

  /// The position after the first occurrence of a text.
  std::size_t after(const std::string& text) const { return bytes_.find(text) + text.size(); }

  static std::string problemOf(const std::string& bag) {
    try {
      checkBagStructure(bag);
    } catch (const BagStructureError& error) {
      return error.what();
    }
    return "";
  }

  std::string bytes_;
};

TEST_F(BagStructure, IntactBagsPass) {
  EXPECT_EQ(problemOf(path("intact.bag")), "");
  for (const auto compression : {rosbag::compression::BZ2, rosbag::compression::LZ4}) {
    {
      const rosbag::Bag in(path("intact.bag"));
      rosbag::Bag out(path("packed.bag"), rosbag::bagmode::Write);
      out.setCompression(compression);
      for (const rosbag::MessageInstance& message : rosbag::View(in)) {
        out.write(message.getTopic(), message.getTime(), message);
      }
    }
    EXPECT_EQ(problemOf(path("packed.bag")), "");
  }
  { const rosbag::Bag empty(path("empty.bag"), rosbag::bagmode::Write); }
  EXPECT_EQ(problemOf(path("empty.bag")), "");
}

TEST_F(BagStructure, ManyChunksPass) {
  {
    rosbag::Bag out(path("many.bag"), rosbag::bagmode::Write);
    out.setChunkThreshold(2000);
    const rosbag::Bag in(path("intact.bag"));
    for (const rosbag::MessageInstance& message : rosbag::View(in)) {
      out.write(message.getTopic(), message.getTime(), message);
    }
  }
  EXPECT_EQ(problemOf(path("many.bag")), "");
}

TEST_F(BagStructure, WhatIsNoBagOrHasNoIndexIsLeftToRosbag) {
  EXPECT_EQ(problemOf(path("absent.bag")), "");
  EXPECT_EQ(problemOf(folder_.path().string()), "");
  EXPECT_EQ(problemOf(folder_.write("empty", "")), "");
  EXPECT_EQ(problemOf(folder_.write("other", "no bag")), "");
  EXPECT_EQ(problemOf(changedAt(after("index_pos="), std::uint64_t{0})), "");
}

TEST_F(BagStructure, DamagedRecordsAreFound) {
  const std::uint32_t huge = 0xfffffff0U;
  const auto expectProblem = [this](std::size_t position, const auto& value, const char* words) {
    const std::string problem = problemOf(changedAt(position, value));
    EXPECT_NE(problem.find(words), std::string::npos) << "'" << problem << "'; expected: " << words;
  };
  const std::size_t message = bytes_.find("op=\x02"), index = bytes_.find("op=\x04"),
                    connection = bytes_.rfind("op=\x07");
  expectProblem(after("size="), huge, "the size of a chunk differs");
  expectProblem(after("size=") + 4, huge, "a length is 4294967280");  // of the chunk
  expectProblem(message - 4, huge, "a length is 4294967280");         // of a field
  expectProblem(bytes_.find("time=", message) + 13, huge, "a length is 4294967280");  // of data
  expectProblem(bytes_.rfind("count=", index) + 6, std::uint32_t{7}, "bytes for 7 entries");
  expectProblem(bytes_.find("ver=", index) + 20, huge, "no message at 4294967280");
  expectProblem(after("index_pos="), std::uint64_t{4097}, "no record at 4097");
  expectProblem(after("chunk_pos="), std::uint64_t{4118}, "no chunk at 4118");
  expectProblem(bytes_.rfind("conn=", connection) + 5, huge, "is not described");
  expectProblem(bytes_.rfind("message_definition="), 'M', "'message_definition' is missing");
  expectProblem(bytes_.find("topic=", connection) + 5, '_', "a field has no name");
}

TEST_F(BagStructure, TheErrorNamesTheFileAndTheByte) {
  const std::string damaged = changedAt(after("chunk_pos="), std::uint64_t{4118});
  try {
    BagReader{{damaged}};
    FAIL() << "expected a BagError";
  } catch (const BagError& error) {
    const std::string what = error.what();
    for (const char* part : {"changed.bag: the bag is cut off or damaged", "the record at byte ",
                             "there is no chunk at 4118"}) {
      EXPECT_NE(what.find(part), std::string::npos) << what;
    }
  }
}

TEST_F(BagStructure, ABagMayLastLongerThanARosDuration) {
  // The time of the index's first message.
  const std::size_t entry = bytes_.find("ver=", bytes_.find("op=\x04")) + 12;
  const std::string bag = changedAt(entry, std::uint32_t{4000000000U});
  EXPECT_EQ(BagReader({bag}).requireScanFrame("/scan"), "laser");
  BagSpan late;
  late.start = 2.4e9;
  EXPECT_THROW(BagReader({bag}, late).requireScanFrame("/scan"), BagError);
}

}  // namespace
}  // namespace racecar_mcl
