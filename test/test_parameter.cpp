#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "flight_corridor/config.hpp"
#include "flight_corridor/parameter.hpp"

namespace flight_corridor {
namespace {

Violations brokenBy(double value, const Rule& rule) { return brokenRules({{"key", &value, rule}}); }

TEST(Parameter, RangesAreNamedByTheirWords) {
  const std::vector<std::pair<Rule, std::string>> ranges{
      {Rule(), ""},
      {from(0), "not negative"},
      {above(0), "positive"},
      {below(0), "negative"},
      {from(1), "1 or more"},
      {above(1), "above 1"},
      {below(1), "below 1"},
      {Rule().upTo(1), "up to 1"},
      {from(0.1).upTo(3600), "0.1 to 3600"},
      {from(-10).below(0), "-10 to below 0"},
      {above(0).upTo(20), "above 0, up to 20"},
      {above(0).below(1), "above 0, below 1"},
      {from(0).where(false, "finite").where(true, "even"), "not negative; finite; even"}};
  for (const auto& [rule, words] : ranges) EXPECT_EQ(describe(rule), words);
}

TEST(Parameter, BrokenRulesTellKeyRuleAndValue) {
  EXPECT_EQ(brokenBy(-0.5, from(0).where(false, "whole").where(true, "even")),
            (Violations{"key: not negative (-0.5)", "key: whole (-0.5)"}));
  Eigen::Vector3d list(1.0, 11.0, kNaN);
  EXPECT_EQ(brokenRules({{"key", &list, from(-10).upTo(10)}}),
            (Violations{"key: -10 to 10 (11)", "key: -10 to 10 (nan)"}));
  std::string text = "mps";
  EXPECT_EQ(brokenRules({{"key", &text, Rule().where(false, "m or cm")}}), Violations{"key: m or cm (\"mps\")"});
}

TEST(Parameter, EveryRangeOfTheTableEndsWhereItSays) {
  Config config;
  for (const Parameter& row : parametersOf(tablesOf(config))) {
    Rule range = row.rule;
    range.conditions.clear();
    for (const double end : {range.least, range.most}) {
      if (std::isinf(end)) continue;
      const double inwards = end == range.least ? kInfinity : -kInfinity;
      EXPECT_EQ(brokenBy(end, range).empty(), end == range.least ? range.may_be_least : range.may_be_most) << row.key;
      EXPECT_TRUE(brokenBy(std::nextafter(end, inwards), range).empty()) << row.key;
      EXPECT_FALSE(brokenBy(std::nextafter(end, -inwards), range).empty()) << row.key;
    }
  }
}

TEST(Parameter, NoNumberOfTheTableMayBeNaN) {
  Config config;
  for (const Parameter& row : parametersOf(tablesOf(config))) {
    if (!std::holds_alternative<double*>(row.field)) continue;
    const double before = std::exchange(*std::get<double*>(row.field), kNaN);
    const Violations broken = check(config);
    const auto names = [&row](const std::string& rule) { return rule.rfind(row.key + ": ", 0) == 0; };
    EXPECT_TRUE(std::any_of(broken.begin(), broken.end(), names)) << row.key;
    *std::get<double*>(row.field) = before;
  }
}

}  // namespace
}  // namespace flight_corridor
