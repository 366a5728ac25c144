#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/temporary_folder.hpp"
#include "tools/command_line.hpp"

namespace flight_corridor::tools {
namespace {

class CommandLineTest : public testing::Test {
 protected:
  CommandLineTest() {
    app.add_option("--in", in, "what to read")->type_name("FILE")->required();
    app.add_option("--rate", rate_hz, "how often")->type_name("HZ")->check(number(-2.0, 200.0));
    app.add_option("--offset", offset_px, "how much")->type_name("PX")->check(number());
    app.add_option("--set", overrides, "overrides")->type_name("key=value")->allow_extra_args(false);
    app.add_flag("--quiet", is_quiet, "say nothing");
    app.add_flag_callback(
        "--list",
        [] {
          answer({"one", "two"});
        },
        "say what there is");
  }

  int run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "/usr/bin/tool");
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code = runTool(app, static_cast<int>(argv.size()), argv.data(), work);
    out = testing::internal::GetCapturedStdout();
    error = testing::internal::GetCapturedStderr();
    return code;
  }

  std::string usageError(const std::vector<std::string>& arguments) {
    const std::string hint = "\ntry: tool --help\n";
    EXPECT_EQ(run(arguments), 2);
    EXPECT_NE(error.find(hint), std::string::npos) << error;
    return error.substr(0, error.find(hint));
  }

  CLI::App app{"Does something.", "tool"};
  std::string in, out, error;
  double rate_hz = 10.0;
  std::optional<double> offset_px;
  std::vector<std::string> overrides;
  bool is_quiet = false;
  std::function<void()> work = [] {};
};

TEST_F(CommandLineTest, TakesValuesAsNextWordAndAfterEquals) {
  EXPECT_EQ(run({"--in", "a.bag", "--rate=2.5", "--set", "a/b=1,2", "--set=c/d=[3, 4]", "--quiet"}), 0);
  EXPECT_EQ(in, "a.bag");
  EXPECT_EQ(rate_hz, 2.5);
  EXPECT_EQ(overrides, (std::vector<std::string>{"a/b=1,2", "c/d=[3, 4]"}));
  EXPECT_TRUE(is_quiet);
  EXPECT_FALSE(offset_px);
}

TEST_F(CommandLineTest, TakesNegativeNumbersAsValues) {
  EXPECT_EQ(run({"--in", "a", "--rate", "-2", "--offset", "-0.5"}), 0);
  EXPECT_EQ(rate_hz, -2.0);
  EXPECT_EQ(offset_px, -0.5);
}

TEST_F(CommandLineTest, NamesWhatIsUnknownAlsoWhereARequiredOptionIsMissing) {
  EXPECT_EQ(usageError({"--in", "a", "--colour", "red"}), "tool: unexpected: --colour red");
  EXPECT_EQ(usageError({"a.bag"}), "tool: unexpected: a.bag");
  EXPECT_EQ(usageError({"--in", "a", "--set", "b=1", "c=2"}), "tool: unexpected: c=2");
}

TEST_F(CommandLineTest, AnOptionIsNoValueOfTheOneBeforeIt) {
  EXPECT_EQ(usageError({"--in", "--quiet"}), "tool: --in: needs a value ('--quiet')");
  EXPECT_EQ(usageError({"--in", "a", "--set", "--quiet", "b"}), "tool: --set: needs a value ('--quiet')");
  EXPECT_EQ(usageError({"--in="}), "tool: --in: 1 required FILE missing");
}

TEST_F(CommandLineTest, RefusesARepeatedOptionAndAMissingOne) {
  EXPECT_NE(usageError({"--in", "a", "--in", "b"}).find("--in"), std::string::npos) << error;
  EXPECT_EQ(usageError({"--quiet"}), "tool: --in is required");
}

TEST_F(CommandLineTest, NamesAllMissingOptionsAtOnce) {
  app.add_option("--out", in, "what to write")->required();
  app.add_option("--truth", in, "what else to write")->required();
  EXPECT_EQ(usageError({}), "tool: --in, --out, --truth are required");
  EXPECT_EQ(usageError({"--out", "a"}), "tool: --in, --truth are required");
  EXPECT_EQ(usageError({"--out", "a", "--truth", "b"}), "tool: --in is required");
}

TEST_F(CommandLineTest, TakesWholeNumbersInDecimalDigitsAlone) {
  constexpr std::uint64_t kLargest = std::numeric_limits<std::uint64_t>::max();  // 18446744073709551615
  std::uint64_t seed = 1;
  int threads = 1;
  app.add_option("--seed", seed, "varies")->check(wholeNumber(0, kLargest));
  app.add_option("--threads", threads, "how many")->check(wholeNumber(1, 8));
  EXPECT_EQ(run({"--in", "a", "--seed", "18446744073709551615", "--threads", "8"}), 0);
  EXPECT_EQ(seed, kLargest);
  EXPECT_EQ(run({"--in", "a", "--seed", "0"}), 0);
  EXPECT_EQ(seed, 0u);
  const auto complaint = [this](const std::string& option, const std::string& text) {
    return usageError({"--in", "a", option, text});
  };
  for (const std::string text : {"18446744073709551616", "99999999999999999999999999"}) {
    EXPECT_EQ(complaint("--seed", text), "tool: --seed: must be at most 18446744073709551615 (" + text + ")");
  }
  EXPECT_EQ(complaint("--seed", "-1"), "tool: --seed: must be at least 0 (-1)");
  EXPECT_EQ(complaint("--threads", "0"), "tool: --threads: must be at least 1 (0)");
  EXPECT_EQ(complaint("--threads", "9"), "tool: --threads: must be at most 8 (9)");
  EXPECT_EQ(complaint("--seed", "010"), "tool: --seed: '010' begins with 0: write it without");
  for (const std::string text : {"0x10", "1e3", "1.5", "ten", "", "+1", " 1", "1 ", "-"}) {
    EXPECT_EQ(complaint("--seed", text), "tool: --seed: '" + text + "' is not a whole number");
  }
}

TEST_F(CommandLineTest, RefusesAFileToBeWrittenThatCannotBeBeforeTheWork) {
  const test_support::TemporaryFolder folder;
  std::string table;
  app.add_option("--csv", table, "what to write")->check(outputFile());
  work = [] { throw std::runtime_error("worked"); };
  const std::string missing = folder.path("missing/flight.csv");
  EXPECT_EQ(usageError({"--in", "a", "--csv", missing}),
            "tool: --csv: " + missing + ": there is no folder " + folder.path("missing"));
  EXPECT_EQ(usageError({"--in", "a", "--csv", folder.path("")}),
            "tool: --csv: '" + folder.path("") + "' is no file's name");
  EXPECT_EQ(usageError({"--in", "a", "--csv", ""}), "tool: --csv: '' is no file's name");
  work = [] {};
  for (const std::string& path : {folder.path("flight.csv"), std::string("flight.csv")}) {
    EXPECT_EQ(run({"--in", "a", "--csv", path}), 0) << error;
    EXPECT_EQ(table, path);
  }
}

TEST_F(CommandLineTest, NamesTheLimitThatANumberBreaks) {
  EXPECT_EQ(run({"--in", "a", "--rate", "200"}), 0);
  EXPECT_EQ(usageError({"--in", "a", "--rate", "300"}), "tool: --rate: must be at most 200 (300)");
  EXPECT_EQ(usageError({"--in", "a", "--rate", "-3"}), "tool: --rate: must be at least -2 (-3)");
}

TEST_F(CommandLineTest, RefusesWhatIsNoFiniteNumber) {
  for (const std::string text : {"nan", "inf", "-inf", "1e999", "fast", "1 2", "2x", ""}) {
    EXPECT_EQ(usageError({"--in", "a", "--rate", text}), "tool: --rate: '" + text + "' is not a finite number");
    EXPECT_EQ(usageError({"--in", "a", "--offset", text}), "tool: --offset: '" + text + "' is not a finite number");
  }
}

TEST_F(CommandLineTest, ExitsWithOneWhenTheWorkFailsAndWithTwoWhereItFindsTheCommandLineWrong) {
  work = [] { throw std::runtime_error("a: cannot be read"); };
  EXPECT_EQ(run({"--in", "a"}), 1);
  EXPECT_EQ(error, "tool: a: cannot be read\n");
  work = [] { throw CLI::ValidationError("a: is no map"); };
  EXPECT_EQ(usageError({"--in", "a"}), "tool: a: is no map");
}

TEST_F(CommandLineTest, AnswersQuestionsWithoutRequiredOptionsAndWithoutWorking) {
  work = [] { throw std::runtime_error("worked"); };
  EXPECT_EQ(run({"--list"}), 0);
  EXPECT_EQ(out, "one\ntwo\n");
  EXPECT_EQ(run({"--help"}), 0);
  EXPECT_NE(out.find("Usage: tool"), std::string::npos) << out;
  EXPECT_NE(out.find("--rate HZ=10 "), std::string::npos) << out;
  EXPECT_EQ(error, "");
}

}  // namespace
}  // namespace flight_corridor::tools
