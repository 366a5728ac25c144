#include "flight_corridor/parameter.hpp"

#include <algorithm>
#include <iomanip>
#include <sstream>

namespace flight_corridor {

namespace {

// By Field's index.
const char* const kTypes[] = {"a number", "an integer", "true or false", "a text", "a list of three numbers"};

/// Puts a value into its field.  @return false if it is of another type.
struct Put {
  const Value& value;

  template <typename T>
  bool operator()(T* field) const {
    const T* same = std::get_if<T>(&value);
    if (same) *field = *same;
    return same;
  }
  bool operator()(double* field) const {
    const int* integer = std::get_if<int>(&value);
    if (integer) *field = *integer;
    return integer || operator()<double>(field);
  }
  bool operator()(Eigen::Vector3d* field) const {
    const auto* list = std::get_if<std::vector<double>>(&value);
    const bool fits = list && list->size() == 3;
    if (fits) *field = Eigen::Map<const Eigen::Vector3d>(list->data());
    return fits;
  }
};

/// The value of a field.
struct Read {
  template <typename T>
  Value operator()(const T* field) const {
    return *field;
  }
  Value operator()(const Eigen::Vector3d* field) const {
    return std::vector<double>(field->data(), field->data() + field->size());
  }
};

struct Describe {
  std::string operator()(std::monostate) const { return "of a type that no parameter has"; }
  std::string operator()(const std::string& value) const { return "\"" + value + "\""; }
  std::string operator()(const std::vector<double>& value) const {
    return "a list of " + std::to_string(value.size()) + " numbers";
  }
  template <typename T>
  std::string operator()(T value) const {
    std::ostringstream text;
    text << std::boolalpha << std::setprecision(10) << value;
    return text.str();
  }
};

/// The numbers of a field; none if it holds none.
std::vector<double> numbersOf(const Field& field) {
  if (const auto* number = std::get_if<double*>(&field)) return {**number};
  if (const auto* integer = std::get_if<int*>(&field)) return {static_cast<double>(**integer)};
  const auto* vector = std::get_if<Eigen::Vector3d*>(&field);
  return vector ? std::vector<double>((*vector)->data(), (*vector)->data() + 3) : std::vector<double>();
}

bool contains(const Rule& rule, double value) {
  return (rule.may_be_least ? rule.least <= value : rule.least < value) &&
         (rule.may_be_most ? value <= rule.most : value < rule.most);
}

/// "" if every value will do.
std::string describeRange(const Rule& rule) {
  const std::string least = describe(rule.least), most = describe(rule.most);
  if (rule.least == -kInfinity && rule.most == kInfinity) return "";
  if (rule.least == -kInfinity && rule.may_be_most) return "up to " + most;
  if (rule.least == -kInfinity) return rule.most == 0.0 ? "negative" : "below " + most;
  if (rule.most == kInfinity && rule.least == 0.0) return rule.may_be_least ? "not negative" : "positive";
  if (rule.most == kInfinity) return rule.may_be_least ? least + " or more" : "above " + least;
  if (rule.may_be_least) return least + (rule.may_be_most ? " to " : " to below ") + most;
  return "above " + least + (rule.may_be_most ? ", up to " : ", below ") + most;
}

}  // namespace

std::string describe(const Value& value) { return std::visit(Describe{}, value); }

std::string describe(const Rule& rule) {
  std::string words = describeRange(rule);
  for (const auto& condition : rule.conditions) words += (words.empty() ? "" : "; ") + condition.second;
  return words;
}

Parameters parametersOf(const std::vector<ParameterTable>& tables) {
  Parameters all;
  for (const ParameterTable& table : tables) {
    for (const Parameter& row : table.rows) {
      all.push_back(row);
      all.back().key = table.name + "/" + row.key;
    }
  }
  return all;
}

Violations assign(const Values& values, const std::function<Parameters()>& makeTable) {
  Violations broken;
  const Parameters rows = makeTable();
  for (const auto& [key, value] : values) {
    const auto row = std::find_if(rows.begin(), rows.end(), [&key = key](const auto& row) { return row.key == key; });
    const bool is_known = row != rows.end();
    const std::string words = is_known ? std::string("expects ") + kTypes[row->field.index()] : "unknown key";
    if (!is_known || !std::visit(Put{value}, row->field))
      broken.push_back(key + ": " + words + " (" + describe(value) + ")");
  }
  const Violations rules = brokenRules(makeTable());
  broken.insert(broken.end(), rules.begin(), rules.end());
  return broken;
}

Values valuesOf(const Parameters& parameters) {
  Values values;
  for (const Parameter& parameter : parameters) values[parameter.key] = std::visit(Read{}, parameter.field);
  return values;
}

Violations brokenRules(const Parameters& parameters) {
  Violations broken;
  for (const auto& [key, field, rule, meaning, tier] : parameters) {
    const auto add = [&broken, &key = key](const std::string& words, const Value& value) {
      broken.push_back(key + ": " + words + " (" + describe(value) + ")");
    };
    const std::string range = describeRange(rule);
    for (const double number : numbersOf(field)) {
      if (!range.empty() && !contains(rule, number)) add(range, number);
    }
    for (const auto& [holds, words] : rule.conditions) {
      if (!holds) add(words, std::visit(Read{}, field));
    }
  }
  return broken;
}

}  // namespace flight_corridor
