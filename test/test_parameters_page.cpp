// doc/parameters.md is what the code, and the comments of config/default.yaml, say; each constant of the core is in one
// of its two lists.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "ros/params.hpp"

namespace flight_corridor_ros {
namespace {

const std::string kSource = FLIGHT_CORRIDOR_SOURCE_DIR;
const std::string kConstants = "## Tuned constants\n";  // begins the part of the page that is written by hand

std::string textOf(const std::string& path) {
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

std::vector<std::string> linesOf(const std::string& path) {
  std::ifstream file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

/// What the checks demand of a parameter, joined by "; ": from the complaints about values that no rule allows.
std::string rulesOf(const std::string& key, const Value& value) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<Value> impossible;
  if (std::holds_alternative<double>(value)) impossible = {kNone};
  if (std::holds_alternative<int>(value)) {
    impossible = {std::numeric_limits<int>::min(), std::numeric_limits<int>::max()};
  }
  if (std::holds_alternative<bool>(value)) impossible = {std::string()};
  if (std::holds_alternative<std::string>(value)) impossible = {std::string(), std::string("/")};
  if (std::holds_alternative<std::vector<double>>(value)) impossible = {std::vector<double>(3, kNone)};
  std::string rules;
  for (const Value& candidate : impossible) {
    try {
      makeConfig({{key, candidate}});
    } catch (const std::invalid_argument& error) {
      std::istringstream complaint(error.what());
      for (std::string line; std::getline(complaint, line);) {
        const std::string begin = "  " + key + ": ";
        if (line.rfind(begin, 0) != 0) continue;
        const std::string rule = line.substr(begin.size(), line.rfind(" (") - begin.size());
        if (rules.find(rule) == std::string::npos) rules += (rules.empty() ? "" : "; ") + rule;
      }
    }
  }
  return rules.empty() ? "any" : std::regex_replace(rules, std::regex("^expects "), "");
}

/// The tables: key, default, unit and meaning from config/default.yaml, rules from the code.
std::string tables() {
  const std::regex section("(\\w+):\\s*(?:# (.*))?"),
      parameter("  (\\w+): (\"[^\"]*\"|\\[[^\\]]*\\]|\\S+) *(?:# (.*))?");
  const std::regex unit_and_meaning("\\[([^\\]]*)\\] ?(.*)");
  const Values defaults = toValues(NodeConfig());
  std::string text, name;
  for (const std::string& line : linesOf(kSource + "/config/default.yaml")) {
    std::smatch part;
    if (std::regex_match(line, part, section)) {
      name = part[1];
      text += "\n## " + name + "\n\n" + part[2].str() +
              ".\n\n| key | default | unit | rule | meaning |\n|---|---|---|---|---|\n";
    } else if (std::regex_match(line, part, parameter)) {
      const std::string key = name + "/" + part[1].str(), comment = part[3];
      std::smatch words;
      const bool has_unit = std::regex_match(comment, words, unit_and_meaning);
      const std::string unit = has_unit ? words[1].str() : "", meaning = has_unit ? words[2].str() : comment;
      EXPECT_FALSE(meaning.empty()) << key << " has no meaning in config/default.yaml";
      text += "| `" + part[1].str() + "` | `" + part[2].str() + "` | " + unit + " | " + rulesOf(key, defaults.at(key)) +
              " | " + meaning + " |\n";
    }
  }
  return text;
}

TEST(ParametersPage, HoldsEveryParameterAsTheCodeHasIt) {
  const std::string page = textOf(kSource + "/doc/parameters.md");
  const std::size_t first = page.find("\n## "), end = page.find(kConstants);
  ASSERT_TRUE(first != std::string::npos && end != std::string::npos);
  const std::string printed = page.substr(0, first) + tables() + "\n" + page.substr(end);
  const std::string path = testing::TempDir() + "parameters.md";
  std::ofstream(path) << printed;
  EXPECT_TRUE(page == printed) << "The page as the code has it is in " << path << ": copy it to doc/parameters.md.";
}

/// Adds constants of a folder's headers or sources, at the scope of the namespace or of a class, as "file: name".
void collectConstants(const std::string& folder, std::set<std::string>& constants) {
  const std::regex declaration("(?:  static )?constexpr ([^;]*).*"), constant("(k[A-Z]\\w*)(?:\\[\\])? =(?!=)");
  for (const auto& file : std::filesystem::directory_iterator(kSource + folder)) {
    if (!file.is_regular_file()) continue;
    for (const std::string& line : linesOf(file.path())) {
      std::smatch part;
      if (!std::regex_match(line, part, declaration)) continue;
      const std::string all = part[1];
      for (std::sregex_iterator one(all.begin(), all.end(), constant), end; one != end; ++one) {
        constants.insert(file.path().stem().string() + ": " + (*one)[1].str());
      }
    }
  }
}

/// What a paragraph of the page lists, "Begin: file (kName, kName), file (kName).", as "file: name".
std::multiset<std::string> listed(const std::string& page, const std::string& begin) {
  const std::size_t first = page.find("\n" + begin);
  EXPECT_NE(first, std::string::npos) << begin;
  const std::string list = first == std::string::npos ? "" : page.substr(first, page.find("\n\n", first) - first);
  const std::regex file("([\\w-]+)\\s\\(([^)]*)\\)"), name("k\\w+");
  std::multiset<std::string> found;
  for (std::sregex_iterator one(list.begin(), list.end(), file), end; one != end; ++one) {
    const std::string names = (*one)[2];
    for (std::sregex_iterator word(names.begin(), names.end(), name); word != end; ++word) {
      found.insert((*one)[1].str() + ": " + word->str());
    }
  }
  return found;
}

TEST(ParametersPage, NamesEveryConstantOfTheCore) {
  std::set<std::string> constants;
  for (const char* module : {"", "/stereo", "/range", "/motion", "/map", "/corridor", "/geometry"}) {
    collectConstants(std::string("/include/flight_corridor") + module, constants);
    collectConstants(std::string("/src") + module, constants);
  }
  const std::string page = textOf(kSource + "/doc/parameters.md");
  std::multiset<std::string> named = listed(page, "Tuned on frames: ");
  const std::multiset<std::string> plain = listed(page, "Not tuned: ");
  std::cout << named.size() << " constants tuned on frames, " << plain.size() << " not\n";
  named.insert(plain.begin(), plain.end());
  for (const std::string& name : constants) EXPECT_TRUE(named.count(name)) << name << " is new: put it into a list";
  for (const std::string& name : named) {
    EXPECT_TRUE(constants.count(name)) << name << " is no constant";
    EXPECT_EQ(named.count(name), 1u) << name << " stands twice";
  }
}

}  // namespace
}  // namespace flight_corridor_ros
