// A folder for programs to work in, with the map of the room that room_bag.h drives through.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "support/room_bag.h"
#include "support/temporary_directory.h"

namespace racecar_mcl {

class RoomFolder : public testing::Test {
 protected:
  RoomFolder() {
    folder_.write("room.pgm", roomPgm());
    map_ = folder_.write("room.yaml", roomYaml());
  }

  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  TemporaryDirectory folder_;
  std::string map_;
};

}  // namespace racecar_mcl
