#pragma once

#include <functional>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace flight_corridor::tools {

/// A wrong command line: unknown, missing or malformed options.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Long options of one program, declared once: parsing, errors and --help come from the declarations.
/// Names are written without the leading "--"; a value follows its option as the next word or after "=".
class CommandLine {
 public:
  CommandLine(std::string tool, std::string summary);
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  CommandLine& required(const std::string& name, const std::string& value_name, const std::string& help);
  /// An option that may be left out; text() then gives the fallback.
  CommandLine& optional(const std::string& name, const std::string& value_name, const std::string& help,
                        const std::string& fallback = "");
  /// An option that may be given many times; see all().
  CommandLine& repeatable(const std::string& name, const std::string& value_name, const std::string& help);
  CommandLine& flag(const std::string& name, const std::string& help);
  /// A flag that asks for a text instead of work, as --help does.
  CommandLine& question(const std::string& name, const std::string& help, std::function<std::string()> answer);
  /// Lines shown under the options in help().
  CommandLine& notes(const std::string& text);

  /// @throws UsageError naming the option that is unknown, repeated, or without its value.
  void parse(const std::vector<std::string>& arguments);
  /// @throws UsageError naming every required option that was not given.
  void checkRequired() const;
  /// The answers to the questions that were asked.
  std::string answers() const;

  bool given(const std::string& name) const;
  /// The value given, else the fallback.
  std::string text(const std::string& name) const;
  const std::vector<std::string>& all(const std::string& name) const;
  /// @throws UsageError naming the option when its value is not a number from minimum to maximum.
  double number(const std::string& name, double minimum,
                double maximum = std::numeric_limits<double>::infinity()) const;
  long integer(const std::string& name, long minimum) const;

  const std::string& tool() const { return tool_; }
  std::string help() const;

 private:
  struct Option {
    enum class Kind { Required, Optional, Repeatable, Flag } kind;
    std::string value_name, help, fallback;
    std::function<std::string()> answer;
    std::vector<std::string> values;
  };
  CommandLine& declare(const std::string& name, Option option);
  const Option& option(const std::string& name) const;

  std::string tool_, summary_, notes_;
  std::vector<std::string> order_;
  std::map<std::string, Option> options_;
};

/// A program's main: parses, answers questions or runs, and turns exceptions into "tool: message" on stderr.
/// @return exit code: what `run` returns; 2 for a wrong command line, 1 for any other failure.
int runTool(CommandLine& options, int argc, char** argv, const std::function<int()>& run);

}  // namespace flight_corridor::tools
