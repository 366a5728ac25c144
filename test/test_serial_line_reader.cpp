#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "serial/line_reader.hpp"

namespace flight_corridor::serial {
namespace {

std::vector<std::string> linesOf(LineReader& reader, const std::string& stream) {
  std::vector<std::string> lines;
  double arrival_s = 0.0;
  for (const char byte : stream) {
    if (const auto line = reader.add(static_cast<std::uint8_t>(byte), arrival_s += 1.0)) lines.push_back(line->text);
  }
  return lines;
}

using Lines = std::vector<std::string>;

TEST(LineReader, WhatCameBeforeTheFirstNewlineIsNoLine) {
  LineReader reader;
  EXPECT_EQ(linesOf(reader, "2.34\n5.67\n"), Lines{"5.67"});
  EXPECT_EQ(reader.skipped(), 5u);
}

TEST(LineReader, BothKindsOfLineEndsAreTakenOff) {
  LineReader reader;
  EXPECT_EQ(linesOf(reader, "\na\r\nb\n\r\n\n"), (Lines{"a", "b", "", ""}));
}

TEST(LineReader, ALineHasTheStampAndTheLengthOfAllItsBytes) {
  LineReader reader;
  linesOf(reader, "\n");
  reader.add('a', 7.0);
  reader.add('\r', 8.0);
  EXPECT_EQ(reader.held(), 2u);
  const auto line = reader.add('\n', 9.0);
  ASSERT_TRUE(line);
  EXPECT_EQ(line->stamp_s, 7.0);
  EXPECT_EQ(line->bytes, 3u);
  EXPECT_EQ(reader.held(), 0u);
}

TEST(LineReader, ALineWithoutEndTakesNoMemory) {
  LineReader reader;
  linesOf(reader, "\n");
  for (int i = 0; i < 1000000; ++i) {
    EXPECT_FALSE(reader.add('1', 0.0));
    ASSERT_LE(reader.held(), LineReader::kLongest);
  }
  EXPECT_EQ(linesOf(reader, "22\n3.00\n"), Lines{"3.00"});
  EXPECT_EQ(reader.skipped(), 1000004u);  // with the first newline and the last of the long line
}

TEST(LineReader, TheLongestLineIsOne) {
  LineReader reader;
  const std::string longest(LineReader::kLongest, 'x');
  EXPECT_EQ(linesOf(reader, "\n" + longest + "\n" + longest + "x\ny\n"), (Lines{longest, "y"}));
}

}  // namespace
}  // namespace flight_corridor::serial
