// doc/parameters.md and config/default.yaml are what the table of parameters says; each constant of the core is in one
// of the page's two lists.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "ros/params.hpp"

namespace flight_corridor_ros {
namespace {

const std::string kSource = FLIGHT_CORRIDOR_SOURCE_DIR;
const std::string kConstants = "## Tuned constants\n";  // begins the part of the page that is written by hand

std::string fileText(const std::string& path) {
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

/// A value as in YAML.
std::string textOf(const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value); text && !text->empty()) return *text;
  if (const auto* list = std::get_if<std::vector<double>>(&value)) {
    std::string text;
    for (const double number : *list) text += (text.empty() ? "" : ", ") + textOf(number);
    return "[" + text + "]";
  }
  const std::string text = flight_corridor::describe(value);
  const bool looks_whole = std::holds_alternative<double>(value) && text.find_first_of(".e") == std::string::npos;
  return looks_whole ? text + ".0" : text;
}

/// What a parameter may be.
std::string ruleOf(const flight_corridor::Parameter& row) {
  const std::string words = flight_corridor::describe(row.rule);
  return !words.empty() ? words : std::holds_alternative<bool*>(row.field) ? "true or false" : "any";
}

std::string padded(std::string text) {
  text.resize(std::max(text.size() + 2, std::size_t{33}), ' ');
  return text;
}

/// config/default.yaml, and the tables of the page, as the table of parameters has them.
std::pair<std::string, std::string> printed() {
  static const char* const kTiers[] = {"configure", "tune", "internal"};
  std::string yaml =
      "# Every parameter with its default. Unknown keys and values of another type stop the node, which names the "
      "key.\n";
  std::string page;
  NodeConfig defaults;
  for (const flight_corridor::ParameterTable& table : tablesOf(defaults)) {
    yaml += "\n" + padded(table.name + ":") + "# " + table.meaning + "\n";
    page += "\n## " + table.name + "\n\n" + table.meaning +
            ".\n\n| key | default | unit | rule | tier | meaning |\n|---|---|---|---|---|---|\n";
    for (const flight_corridor::Parameter& row : table.rows) {
      const std::string value = textOf(flight_corridor::valuesOf({row}).at(row.key));
      const std::size_t unit = row.meaning[0] == '[' ? row.meaning.find("] ") : 0;  // its end
      yaml += padded("  " + row.key + ": " + value) + "# " + row.meaning + "\n";
      page += "| `" + row.key + "` | `" + value + "` | " + (unit ? row.meaning.substr(1, unit - 1) : "") + " | " +
              ruleOf(row) + " | " + kTiers[static_cast<int>(row.tier)] + " | " +
              row.meaning.substr(unit ? unit + 2 : 0) + " |\n";
    }
  }
  return {yaml, page};
}

/// A file of the repository is as printed; if not, what was printed lies beside the test's other files.
void expectFile(const std::string& path, const std::string& text) {
  const std::string copy = testing::TempDir() + path.substr(path.rfind('/') + 1);
  std::ofstream(copy) << text;
  EXPECT_TRUE(fileText(kSource + path) == text) << "To do: cp " << copy << " " << kSource + path;
}

TEST(ParametersPage, AndDefaultYamlAreAsTheTableHasThem) {
  const auto [yaml, tables] = printed();
  const std::string page = fileText(kSource + "/doc/parameters.md");
  const std::size_t first = page.find("\n## "), end = page.find(kConstants);
  ASSERT_TRUE(first != std::string::npos && end != std::string::npos);
  expectFile("/config/default.yaml", yaml);
  EXPECT_EQ(readYaml(kSource + "/config/default.yaml"), toValues(NodeConfig()));
  expectFile("/doc/parameters.md", page.substr(0, first) + tables + "\n" + page.substr(end));
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
  const std::string page = fileText(kSource + "/doc/parameters.md");
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
