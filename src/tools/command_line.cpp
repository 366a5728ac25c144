#include "tools/command_line.hpp"

#include <unistd.h>

#include <charconv>
#include <cmath>
#include <exception>
#include <filesystem>
#include <iostream>
#include <sstream>
#include <string>

namespace flight_corridor::tools {
namespace {

constexpr std::size_t kHelpColumn = 32;

std::string refuseOption(const std::string& value) {
  return value.rfind("--", 0) == 0 ? "needs a value ('" + value + "')" : "";
}

std::string missingOptions(const CLI::App& app) {
  std::vector<std::string> missing;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_required() && option->count() == 0) missing.push_back(option->get_name());
  }
  return CLI::detail::join(missing, ", ") + (missing.size() == 1 ? " is required" : " are required");
}

/// A misspelt option may be one that is missing as well: what is unknown says more.
std::string complaint(const CLI::App& app, const CLI::ParseError& error) {
  const std::string unknown = CLI::detail::join(app.remaining(), " ");
  const bool is_refused_value = error.get_name() == "ValidationError";
  if (!unknown.empty() && !is_refused_value) return "unexpected: " + unknown;
  return error.get_name() == "RequiredError" ? missingOptions(app) : error.what();
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

CLI::Validator wholeNumber(std::uint64_t minimum, std::uint64_t maximum) {
  const auto check = [=](const std::string& text) -> std::string {
    const bool is_negative = text.rfind('-', 0) == 0;
    const std::string digits = text.substr(is_negative ? 1 : 0);
    if (digits.empty() || digits.find_first_not_of("0123456789") != std::string::npos) {
      return "'" + text + "' is not a whole number";
    }
    if (digits.size() > 1 && digits.front() == '0') return "'" + text + "' begins with 0: write it without";
    std::uint64_t value = 0;
    const bool is_larger =
        std::from_chars(digits.data(), digits.data() + digits.size(), value).ec == std::errc::result_out_of_range;
    if (is_negative || (!is_larger && value < minimum)) {
      return "must be at least " + std::to_string(minimum) + " (" + text + ")";
    }
    return is_larger || value > maximum ? "must be at most " + std::to_string(maximum) + " (" + text + ")" : "";
  };
  return CLI::Validator(check, "");
}

CLI::Validator outputFile() {
  const auto check = [](const std::string& path) -> std::string {
    namespace fs = std::filesystem;
    std::error_code cannot_be_read;
    if (path.empty() || fs::is_directory(path, cannot_be_read)) return "'" + path + "' is no file's name";
    const fs::path parent = fs::path(path).parent_path(), folder = parent.empty() ? "." : parent;
    if (!fs::is_directory(folder, cannot_be_read)) return path + ": there is no folder " + folder.string();
    const bool exists = fs::exists(path, cannot_be_read);
    const bool is_writable = access((exists ? fs::path(path) : folder).c_str(), W_OK) == 0;
    return is_writable ? "" : path + ": cannot be written";
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
