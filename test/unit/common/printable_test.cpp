#include "racecar_mcl/common/printable.h"

#include <gtest/gtest.h>

namespace racecar_mcl {
namespace {

TEST(Printable, KeepsOrdinaryNames) {
  EXPECT_EQ(printable("base_link"), "base_link");
  EXPECT_EQ(printable(""), "");
  EXPECT_EQ(printable(std::string(64, 'x')), std::string(64, 'x'));
}

TEST(Printable, EscapesWhatCouldForgeALine) {
  EXPECT_EQ(printable("laser\n[ERROR] fire"), "laser\\n[ERROR] fire");
  EXPECT_EQ(printable("a\tb\r\x1b[31m\x7f"), "a\\tb\\x0d\\x1b[31m\\x7f");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printable("\xc2\x9b"), "\\xc2\\x9b");
}

TEST(Printable, CutsLongTexts) {
  EXPECT_EQ(printable(std::string(1000000, 'x')), std::string(64, 'x') + "...");
  EXPECT_EQ(printable(std::string(1000000, '\n'), 4), "\\n\\n...");
}

TEST(WithoutControlCharacters, KeepsLengthAndUtf8) {
  EXPECT_EQ(withoutControlCharacters("Stra\xc3\x9f"
                                     "e\n"),
            "Stra\xc3\x9f"
            "e\\n");
  EXPECT_EQ(withoutControlCharacters(std::string(1000, 'x')), std::string(1000, 'x'));
}

}  // namespace
}  // namespace racecar_mcl
