#include "tools/command_line.hpp"

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <limits>
#include <sstream>
#include <utility>

namespace flight_corridor::tools {
namespace {

double parseNumber(const std::string& name, const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value)) {
    throw UsageError("--" + name + ": '" + text + "' is no finite number");
  }
  return value;
}

long parseInteger(const std::string& name, const std::string& text) {
  char* end = nullptr;
  errno = 0;
  const long value = std::strtol(text.c_str(), &end, 10);
  if (text.empty() || *end != '\0' || errno == ERANGE) throw UsageError("--" + name + ": '" + text + "' is no integer");
  return value;
}

template <typename Number>
Number within(const std::string& name, Number value, Number minimum, Number maximum) {
  if (minimum <= value && value <= maximum) return value;
  std::ostringstream message;
  message << "--" << name << ": must be at " << (value > maximum ? "most " : "least ")
          << (value > maximum ? maximum : minimum) << " (" << value << ")";
  throw UsageError(message.str());
}

}  // namespace

CommandLine::CommandLine(std::string tool, std::string summary) : tool_(std::move(tool)), summary_(std::move(summary)) {
  question("help", "print this text", [this] { return help(); });
}

CommandLine& CommandLine::declare(const std::string& name, Option option) {
  if (!options_.emplace(name, std::move(option)).second) throw std::logic_error("option --" + name + " declared twice");
  order_.push_back(name);
  return *this;
}

CommandLine& CommandLine::required(const std::string& name, const std::string& value_name, const std::string& help) {
  return declare(name, {Option::Kind::Required, value_name, help, "", nullptr, {}});
}

CommandLine& CommandLine::optional(const std::string& name, const std::string& value_name, const std::string& help,
                                   const std::string& fallback) {
  return declare(name, {Option::Kind::Optional, value_name, help, fallback, nullptr, {}});
}

CommandLine& CommandLine::repeatable(const std::string& name, const std::string& value_name, const std::string& help) {
  return declare(name, {Option::Kind::Repeatable, value_name, help, "", nullptr, {}});
}

CommandLine& CommandLine::flag(const std::string& name, const std::string& help) {
  return declare(name, {Option::Kind::Flag, "", help, "", nullptr, {}});
}

CommandLine& CommandLine::question(const std::string& name, const std::string& help,
                                   std::function<std::string()> answer) {
  return declare(name, {Option::Kind::Flag, "", help, "", std::move(answer), {}});
}

CommandLine& CommandLine::notes(const std::string& text) {
  notes_ = text;
  return *this;
}

void CommandLine::parse(const std::vector<std::string>& arguments) {
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& word = arguments[i];
    if (word.rfind("--", 0) != 0) throw UsageError("unexpected argument '" + word + "'");
    const std::size_t equals = word.find('=');
    const std::string name = word.substr(2, equals == std::string::npos ? equals : equals - 2);
    const auto found = options_.find(name);
    if (found == options_.end()) throw UsageError("unknown option --" + name);
    Option& option = found->second;
    if (option.kind != Option::Kind::Repeatable && !option.values.empty()) {
      throw UsageError("--" + name + " is given twice");
    }
    if (option.kind == Option::Kind::Flag) {
      if (equals != std::string::npos) throw UsageError("--" + name + " takes no value");
      option.values.emplace_back();
    } else if (equals != std::string::npos) {
      option.values.push_back(word.substr(equals + 1));
    } else if (i + 1 < arguments.size() && arguments[i + 1].rfind("--", 0) != 0) {
      option.values.push_back(arguments[++i]);
    } else {
      throw UsageError("--" + name + " needs a value: " + option.value_name);
    }
  }
}

void CommandLine::checkRequired() const {
  std::string missing;
  for (const std::string& name : order_) {
    const Option& o = option(name);
    if (o.kind == Option::Kind::Required && o.values.empty()) missing += " --" + name + " " + o.value_name;
  }
  if (!missing.empty()) throw UsageError("missing:" + missing);
}

std::string CommandLine::answers() const {
  std::string text;
  for (const std::string& name : order_) {
    if (option(name).answer && given(name)) text += option(name).answer();
  }
  return text;
}

const CommandLine::Option& CommandLine::option(const std::string& name) const { return options_.at(name); }

bool CommandLine::given(const std::string& name) const { return !option(name).values.empty(); }

std::string CommandLine::text(const std::string& name) const {
  return given(name) ? option(name).values.front() : option(name).fallback;
}

const std::vector<std::string>& CommandLine::all(const std::string& name) const { return option(name).values; }

double CommandLine::number(const std::string& name, double minimum, double maximum) const {
  return within(name, parseNumber(name, text(name)), minimum, maximum);
}

long CommandLine::integer(const std::string& name, long minimum) const {
  return within(name, parseInteger(name, text(name)), minimum, std::numeric_limits<long>::max());
}

std::string CommandLine::help() const {
  std::string usage = "usage: " + tool_, list;
  for (const std::string& name : order_) {
    const Option& o = option(name);
    const std::string shown = "--" + name + (o.value_name.empty() ? "" : " " + o.value_name);
    if (o.kind == Option::Kind::Required) usage += " " + shown;
    const std::string fallback = o.fallback.empty() ? "" : " [" + o.fallback + "]";
    const std::string many = o.kind == Option::Kind::Repeatable ? " (may be repeated)" : "";
    list +=
        "  " + shown + std::string(shown.size() < 28 ? 28 - shown.size() : 1, ' ') + o.help + fallback + many + "\n";
  }
  return usage + " [options]\n\n" + summary_ + "\n\n" + list + (notes_.empty() ? "" : "\n" + notes_ + "\n");
}

int runTool(CommandLine& options, int argc, char** argv, const std::function<int()>& run) {
  try {
    options.parse({argv + 1, argv + argc});
    const std::string answers = options.answers();
    if (!answers.empty()) {
      std::cout << answers;
      return 0;
    }
    options.checkRequired();
    return run();
  } catch (const UsageError& error) {
    std::cerr << options.tool() << ": " << error.what() << "\ntry: " << options.tool() << " --help\n";
    return 2;
  } catch (const std::exception& error) {
    std::cerr << options.tool() << ": " << error.what() << "\n";
    return 1;
  }
}

}  // namespace flight_corridor::tools
