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

  /// The position after the nth occurrence of a text.
  std::size_t after(const std::string& text, int n = 1) const {
    std::size_t position = 0;
    for (int i = 0; i < n && position != std::string::npos; ++i) {
      position = bytes_.find(text, position) + text.size();
    }
    return position;
  }

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
  const std::string header_of_message = std::string("\x04\0\0\0op=\x02", 8);
  const std::string of_index = std::string("\x04\0\0\0op=\x04", 8);
  const std::string of_chunk_info = std::string("\x04\0\0\0op=\x06", 8);
  ASSERT_NE(bytes_.find(header_of_message), std::string::npos);
  // Length of a field, of a message's header and of the chunk's data.
  EXPECT_NE(problemOf(changedAt(after("#ROSBAG V2.0\n") + 4, huge)), "");
  EXPECT_NE(problemOf(changedAt(after(header_of_message) - 8, huge)), "");
  EXPECT_NE(problemOf(changedAt(after("size=") - 9 - 24, huge)), "");
  // Numbers of entries, and offsets in the index.
  EXPECT_NE(problemOf(changedAt(after("count=", 3), huge)), "");
  EXPECT_NE(problemOf(changedAt(after(of_index) + 40, huge)), "");
  EXPECT_NE(problemOf(changedAt(after("index_pos="), std::uint64_t{4097})), "");
  EXPECT_NE(problemOf(changedAt(after("chunk_pos="), std::uint64_t{4118})), "");
  // A connection's number and the name of a field.
  const std::size_t described = bytes_.rfind("conn=", bytes_.rfind("op=\x07"));
  EXPECT_NE(problemOf(changedAt(described + 5, huge)), "");
  EXPECT_NE(problemOf(changedAt(bytes_.rfind("message_definition="), 'M')), "");
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
  const std::string of_index = std::string("op=\x04", 4);
  const std::size_t entry = bytes_.find("ver=", after(of_index)) + 8 + 4;
  const std::string bag = changedAt(entry, std::uint32_t{4000000000U});
  EXPECT_EQ(BagReader({bag}).requireScanFrame("/scan"), "laser");
  BagSpan late;
  late.start = 2.4e9;
  EXPECT_THROW(BagReader({bag}, late).requireScanFrame("/scan"), BagError);
}

}  // namespace
}  // namespace racecar_mcl
