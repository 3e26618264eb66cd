#include "racecar_mcl/common/parameter_text.h"

#include <gtest/gtest.h>

namespace racecar_mcl {
namespace {

TEST(ParameterText, AListIsWordsSeparatedBySpaces) {
  std::vector<std::string> names{"old"};
  parseParameter("scan_topics", "  front  /rear ", &names);
  EXPECT_EQ(names, (std::vector<std::string>{"front", "/rear"}));
  EXPECT_EQ(parameterText(names), "front /rear");
  parseParameter("scan_topics", "", &names);
  EXPECT_TRUE(names.empty());
  EXPECT_EQ(parameterText(names), "");
}

}  // namespace
}  // namespace racecar_mcl
