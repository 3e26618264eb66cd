// Input of the fuzz targets.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include "support/temporary_directory.h"

namespace racecar_mcl {

/// Numbers from the bytes of an input; zeros after its end.
class FuzzInput {
 public:
  FuzzInput(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  bool empty() const { return size_ == 0; }

  template <typename Number>
  Number take() {
    Number number{};
    const std::size_t bytes = std::min(size_, sizeof(Number));
    std::memcpy(&number, data_, bytes);
    data_ += bytes;
    size_ -= bytes;
    return number;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

/// A file of this process with the given content; returns its path.
inline std::string writeFuzzFile(const std::string& name, const std::string& content) {
  static const TemporaryDirectory folder;
  return folder.write(name, content);
}

}  // namespace racecar_mcl
