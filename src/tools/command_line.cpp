#include "tools/command_line.hpp"

#include <cmath>
#include <exception>
#include <iostream>
#include <sstream>
#include <string>

namespace flight_corridor::tools {
namespace {

constexpr std::size_t kHelpColumn = 32;

std::string refuseOption(const std::string& value) {
  return value.rfind("--", 0) == 0 ? "needs a value ('" + value + "')" : "";
}

/// A misspelt option may be one that is missing as well: what is unknown says more.
std::string complaint(const CLI::App& app, const CLI::ParseError& error) {
  const std::string unknown = CLI::detail::join(app.remaining(), " ");
  const bool is_refused_value = error.get_name() == "ValidationError";
  return unknown.empty() || is_refused_value ? error.what() : "unexpected: " + unknown;
}

}  // namespace

CLI::Validator number(double minimum, double maximum) {
  const auto check = [=](const std::string& text) {
    double value = 0.0;
    std::ostringstream message;
    if (!CLI::detail::lexical_cast(text, value) || !std::isfinite(value)) {
      message << "'" << text << "' is not a finite number";
    } else if (value < minimum || value > maximum) {
      message << "must be at " << (value < minimum ? "least " : "most ") << (value < minimum ? minimum : maximum)
              << " (" << text << ")";
    }
    return message.str();
  };
  return CLI::Validator(check, "");
}

void answer(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) std::cout << line << "\n";
  throw CLI::Success();
}

int runTool(CLI::App& app, int argc, char** argv, const std::function<void()>& run) {
  for (CLI::Option* option : app.get_options()) {
    option->check(refuseOption);
    if (option->get_expected_max() == 1) option->capture_default_str();
  }
  app.set_help_flag("--help", "print this text");
  app.get_formatter()->column_width(kHelpColumn);
  try {
    app.parse(argc, argv);
    run();
    return 0;
  } catch (const CLI::Success& answer) {
    return app.exit(answer);
  } catch (const CLI::ParseError& error) {
    std::cerr << app.get_name() << ": " << complaint(app, error) << "\ntry: " << app.get_name() << " --help\n";
    return 2;
  } catch (const std::exception& error) {
    std::cerr << app.get_name() << ": " << error.what() << "\n";
    return 1;
  }
}

}  // namespace flight_corridor::tools
