// Runs a fuzz target over its corpus, without libFuzzer.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>

#include "support/program.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace racecar_mcl {
namespace {

TEST(FuzzCorpus, CausesNoErrorButThatOfItsReader) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(FUZZ_CORPUS)) {
    SCOPED_TRACE(entry.path());
    const std::string content = readWhole(entry.path().string());
    const auto* data = reinterpret_cast<const std::uint8_t*>(content.data());
    // All beginnings, too: files are often cut off.
    const std::size_t step = 1 + content.size() / 64;
    for (std::size_t size = 0; size < content.size(); size += step) {
      ASSERT_NO_THROW(LLVMFuzzerTestOneInput(data, size)) << "the first " << size << " bytes";
    }
    ASSERT_NO_THROW(LLVMFuzzerTestOneInput(data, content.size()));
    ++files;
  }
  EXPECT_GT(files, 0);
}

}  // namespace
}  // namespace racecar_mcl
