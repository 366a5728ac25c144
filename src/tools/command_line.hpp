#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace flight_corridor::tools {

/// A check that takes a finite number from minimum to maximum, and names the limit that another one breaks. CLI::Range
/// takes NaN.
CLI::Validator number(double minimum = std::numeric_limits<double>::lowest(),
                      double maximum = std::numeric_limits<double>::max());

/// A check that takes a whole number from minimum to maximum, in decimal digits: CLI11 would read a leading 0 as octal.
CLI::Validator wholeNumber(std::uint64_t minimum, std::uint64_t maximum);

/// A check that takes the path of a file to be written: its folder exists and may be written to.
CLI::Validator outputFile();

/// What a flag does that asks instead of working, as --help: prints the lines.
/// @throws CLI::Success always, so that nothing else is done.
[[noreturn]] void answer(const std::vector<std::string>& lines);

/// A program's main: parses and runs, and turns exceptions into "tool: message" on stderr. --help shows the defaults.
/// A value that begins with "--" is refused: it is the next option, and the value is missing. All missing options are
/// named at once.
/// @return exit code: 0 when `run` returns or a question is answered; 2 for a wrong command line, also where `run`
/// throws a CLI::ParseError; 1 for any other failure.
int runTool(CLI::App& app, int argc, char** argv, const std::function<void()>& run);

}  // namespace flight_corridor::tools
