#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tools/progress.hpp"

namespace flight_corridor::tools {
namespace {

TEST(Progress, PrintsALineForEveryTenPercentWithoutATerminal) {
  testing::internal::CaptureStderr();
  Progress progress("work", 40);
  for (int i = 0; i < 40; ++i) progress.advance();
  const std::string text = testing::internal::GetCapturedStderr();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 10) << text;
  EXPECT_NE(text.find("work: 100 %  40/40"), std::string::npos) << text;
}

}  // namespace
}  // namespace flight_corridor::tools
