#include "offline/bag_structure.h"

#include <algorithm>
#include <boost/interprocess/exceptions.hpp>
#include <boost/interprocess/file_mapping.hpp>
#include <boost/interprocess/mapped_region.hpp>
#include <cstdint>
#include <cstring>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

namespace racecar_mcl {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
constexpr std::size_t kIndexEntry = 12;     // bytes: time and offset of a message
constexpr std::size_t kChunkInfoEntry = 8;  // bytes: connection and number of its messages

enum Operation : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7
};

void require(bool condition, const std::string& problem) {
  if (!condition) throw BagStructureError(problem);
}

template <typename Number>
Number numberIn(std::string_view bytes) {
  Number number;
  require(bytes.size() == sizeof(number), "a number has " + std::to_string(bytes.size()) +
                                              " bytes; expected " + std::to_string(sizeof(number)));
  std::memcpy(&number, bytes.data(), sizeof(number));
  return number;
}

/// Reads bytes from the front on.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  bool atEnd() const { return position_ == bytes_.size(); }
  std::size_t position() const { return position_; }

  std::string_view take(std::size_t size) {
    const std::size_t rest = bytes_.size() - position_;
    require(size <= rest, "a length is " + std::to_string(size) + ", but only " +
                              std::to_string(rest) + " bytes follow");
    const std::string_view taken = bytes_.substr(position_, size);
    position_ += size;
    return taken;
  }

  /// Bytes after their length.
  std::string_view takeBlock() {
    return take(numberIn<std::uint32_t>(take(sizeof(std::uint32_t))));
  }

 private:
  std::string_view bytes_;
  std::size_t position_ = 0;
};

/// Named fields.
class Header {
 public:
  explicit Header(std::string_view bytes) {
    for (Reader in(bytes); !in.atEnd();) {
      const std::string_view field = in.takeBlock();
      const std::size_t end = field.find('=');
      require(end != std::string_view::npos, "a field has no name");
      fields_.emplace_back(field.substr(0, end), field.substr(end + 1));
    }
  }

  std::string_view text(std::string_view name) const {
    for (const auto& [field, value] : fields_) {
      if (field == name) return value;
    }
    throw BagStructureError("the field '" + std::string(name) + "' is missing");
  }

  template <typename Number>
  Number number(std::string_view name) const {
    return numberIn<Number>(text(name));
  }

 private:
  std::vector<std::pair<std::string_view, std::string_view>> fields_;
};

struct Record {
  explicit Record(Reader* in) : header(in->takeBlock()), data(in->takeBlock()) {}

  std::uint8_t operation() const { return header.number<std::uint8_t>("op"); }

  Header header;
  std::string_view data;
};

std::uint32_t checkConnection(const Record& record) {
  record.header.text("topic");
  const Header description(record.data);
  for (const char* field : {"type", "md5sum", "message_definition"}) description.text(field);
  return record.header.number<std::uint32_t>("conn");
}

/// The records of a bag, in the order of the file.
class BagCheck {
 public:
  /// Whether the next record is to be read.
  bool add(const Record& record, std::uint64_t position) {
    const Header& header = record.header;
    switch (record.operation()) {
      case kBagHeader:
        index_position_ = header.number<std::uint64_t>("index_pos");
        header.number<std::uint32_t>("conn_count");
        header.number<std::uint32_t>("chunk_count");
        return index_position_ != 0;  // else there is no index
      case kChunk:
        chunks_.push_back(position);
        addChunk(record);
        break;
      case kIndex:
        addIndex(record);
        break;
      case kChunkInfo:
        addChunkInfo(record);
        break;
      case kConnection:
        connections_.insert(checkConnection(record));
        break;
      default:
        break;
    }
    if (position == index_position_) index_found_ = true;
    return true;
  }

  /// `end`: of the file, where the index of an empty bag begins.
  void finish(std::uint64_t end) const {
    require(index_found_ || index_position_ == end, "there is no record at " +
                                                        std::to_string(index_position_) +
                                                        ", where the index should begin");
    for (const std::uint32_t used : used_connections_) {
      require(connections_.count(used) != 0,
              "the connection " + std::to_string(used) + " is not described");
    }
  }

 private:
  void addChunk(const Record& record) {
    chunk_size_ = record.header.number<std::uint32_t>("size");
    is_compressed_ = record.header.text("compression") != "none";
    messages_.clear();
    if (is_compressed_) return;
    require(record.data.size() == chunk_size_, "the size of a chunk differs from its length");
    for (Reader in(record.data); !in.atEnd();) {
      const auto offset = static_cast<std::uint32_t>(in.position());
      const Record inner(&in);
      if (inner.operation() == kConnection) checkConnection(inner);
      if (inner.operation() == kMessage) messages_.push_back(offset);
    }
  }

  /// Index of the messages of one connection in the last chunk.
  void addIndex(const Record& record) {
    used_connections_.insert(record.header.number<std::uint32_t>("conn"));
    requireEntries(record, kIndexEntry);
    for (Reader in(record.data); !in.atEnd();) {
      in.take(kIndexEntry - sizeof(std::uint32_t));
      const auto offset = numberIn<std::uint32_t>(in.take(sizeof(std::uint32_t)));
      const bool found = is_compressed_
                             ? offset < chunk_size_
                             : std::binary_search(messages_.begin(), messages_.end(), offset);
      require(found, "the chunk has no message at " + std::to_string(offset));
    }
  }

  void addChunkInfo(const Record& record) {
    const auto chunk = record.header.number<std::uint64_t>("chunk_pos");
    require(std::binary_search(chunks_.begin(), chunks_.end(), chunk),
            "there is no chunk at " + std::to_string(chunk));
    record.header.number<std::uint64_t>("start_time");
    record.header.number<std::uint64_t>("end_time");
    requireEntries(record, kChunkInfoEntry);
  }

  static void requireEntries(const Record& record, std::size_t size) {
    record.header.number<std::uint32_t>("ver");
    const auto count = record.header.number<std::uint32_t>("count");
    require(record.data.size() == size * count,
            "an index has " + std::to_string(record.data.size()) + " bytes for " +
                std::to_string(count) + " entries");
  }

  std::uint64_t index_position_ = 0;
  bool index_found_ = false;
  std::vector<std::uint64_t> chunks_;  ///< positions
  std::set<std::uint32_t> connections_, used_connections_;
  // Of the last chunk:
  bool is_compressed_ = false;
  std::uint32_t chunk_size_ = 0;         ///< bytes, not compressed
  std::vector<std::uint32_t> messages_;  ///< offsets
};

void checkRecords(std::string_view file) {
  Reader in(file);
  in.take(kMagic.size());
  BagCheck check;
  while (!in.atEnd()) {
    const std::size_t position = in.position();
    try {
      if (!check.add(Record(&in), position)) return;
    } catch (const BagStructureError& problem) {
      throw BagStructureError("the record at byte " + std::to_string(position) +
                              " is damaged: " + problem.what());
    }
  }
  check.finish(file.size());
}

}  // namespace

void checkBagStructure(const std::string& path) {
  namespace ipc = boost::interprocess;
  ipc::mapped_region region;
  try {
    const ipc::file_mapping file(path.c_str(), ipc::read_only);
    region = ipc::mapped_region(file, ipc::read_only);
  } catch (const ipc::interprocess_exception&) {
    return;  // absent, empty or no regular file: rosbag says which
  }
  const std::string_view file(static_cast<const char*>(region.get_address()), region.get_size());
  if (file.substr(0, kMagic.size()) == kMagic) checkRecords(file);
}

}  // namespace racecar_mcl
