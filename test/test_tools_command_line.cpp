#include <gtest/gtest.h>

#include "tools/command_line.hpp"

namespace flight_corridor::tools {
namespace {

class CommandLineTest : public testing::Test {
 protected:
  CommandLineTest() : options("tool", "Does something.") {
    options.required("in", "FILE", "what to read")
        .optional("rate", "HZ", "how often", "10")
        .repeatable("set", "key=value", "overrides")
        .flag("quiet", "say nothing");
  }

  std::string usageError(const std::vector<std::string>& arguments) {
    try {
      options.parse(arguments);
      options.checkRequired();
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  }

  int exitCode(std::vector<std::string> arguments, const std::function<int()>& run) {
    arguments.insert(arguments.begin(), "tool");
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    return runTool(options, static_cast<int>(argv.size()), argv.data(), run);
  }

  CommandLine options;
};

TEST_F(CommandLineTest, TakesValuesAsNextWordAndAfterEquals) {
  options.parse({"--in", "a.bag", "--rate=2.5", "--set", "a/b=1", "--set=c/d=x", "--quiet"});
  EXPECT_EQ(options.text("in"), "a.bag");
  EXPECT_EQ(options.number("rate", 0.0), 2.5);
  EXPECT_EQ(options.all("set"), (std::vector<std::string>{"a/b=1", "c/d=x"}));
  EXPECT_TRUE(options.given("quiet"));
}

TEST_F(CommandLineTest, AcceptsNegativeNumbersAsValues) {
  options.parse({"--in", "a", "--rate", "-2"});
  EXPECT_EQ(options.number("rate", -10.0), -2.0);
}

TEST_F(CommandLineTest, FallsBackWhereAnOptionIsLeftOut) {
  options.parse({"--in", "a"});
  EXPECT_EQ(options.integer("rate", 1), 10);
  EXPECT_FALSE(options.given("rate"));
  EXPECT_FALSE(options.given("quiet"));
}

TEST_F(CommandLineTest, NamesWhatIsWrong) {
  EXPECT_EQ(usageError({"--in", "a", "--colour", "red"}), "unknown option --colour");
  EXPECT_EQ(usageError({"a.bag"}), "unexpected argument 'a.bag'");
}

TEST_F(CommandLineTest, NamesAMissingValue) { EXPECT_EQ(usageError({"--in", "--quiet"}), "--in needs a value: FILE"); }

TEST_F(CommandLineTest, NamesARepeatedOption) {
  EXPECT_EQ(usageError({"--in", "a", "--in", "b"}), "--in is given twice");
}

TEST_F(CommandLineTest, NamesAMissingRequiredOption) { EXPECT_EQ(usageError({"--quiet"}), "missing: --in FILE"); }

TEST_F(CommandLineTest, NamesAValueThatIsNoNumberOrTooSmall) {
  options.parse({"--in", "a", "--rate", "fast"});
  EXPECT_THROW(options.number("rate", 0.0), UsageError);
  EXPECT_THROW(options.integer("rate", 0), UsageError);
  CommandLine other("tool", "");
  other.optional("rate", "HZ", "", "0").optional("nan", "HZ", "", "nan");
  EXPECT_THROW(other.number("rate", 0.1), UsageError);
  EXPECT_THROW(other.number("nan", 0.1), UsageError);
}

TEST_F(CommandLineTest, NamesTheLimitThatAValueBreaks) {
  options.parse({"--in", "a", "--rate", "300"});
  EXPECT_EQ(options.number("rate", 1.0), 300.0);
  EXPECT_EQ(options.number("rate", 1.0, 300.0), 300.0);
  const auto complaint = [&](double minimum, double maximum) {
    try {
      options.number("rate", minimum, maximum);
    } catch (const UsageError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(complaint(1.0, 200.0), "--rate: must be at most 200 (300)");
  EXPECT_EQ(complaint(400.0, 500.0), "--rate: must be at least 400 (300)");
}

TEST_F(CommandLineTest, ExitsWithTwoForUsageOneForFailureZeroForHelp) {
  const auto fail = []() -> int { throw std::runtime_error("a.bag: cannot be read"); };
  EXPECT_EQ(exitCode({"--in", "a"}, [] { return 0; }), 0);
  CommandLine usage("tool", "");
  EXPECT_EQ(exitCode({"--nonsense"}, fail), 2);
}

TEST_F(CommandLineTest, ExitsWithOneWhenTheWorkFails) {
  EXPECT_EQ(exitCode({"--in", "a"}, []() -> int { throw std::runtime_error("a: cannot be read"); }), 1);
}

TEST_F(CommandLineTest, AnswersHelpWithoutRequiredOptionsAndWithoutWorking) {
  testing::internal::CaptureStdout();
  EXPECT_EQ(exitCode({"--help"}, []() -> int { throw std::runtime_error("worked"); }), 0);
  const std::string help = testing::internal::GetCapturedStdout();
  EXPECT_NE(help.find("usage: tool --in FILE [options]"), std::string::npos) << help;
  EXPECT_NE(help.find("--rate HZ"), std::string::npos) << help;
}

}  // namespace
}  // namespace flight_corridor::tools
