#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// A parameter's value, typed as in YAML; monostate: a type that no parameter has.
using Value = std::variant<std::monostate, bool, int, double, std::string, std::vector<double>>;
/// Values by key, "section/name".
using Values = std::map<std::string, Value>;
/// Where a parameter's value goes.
using Field = std::variant<double*, int*, bool*, std::string*, Eigen::Vector3d*>;

/// What a value must be: a number of a range, which NaN is not (each number of a vector), and whatever else must hold.
struct Rule {
  double least = -kInfinity, most = kInfinity;
  bool may_be_least = true, may_be_most = true;
  std::vector<std::pair<bool, std::string>> conditions = {};  ///< Whether one holds, and what it is.
  std::optional<std::pair<double, double>> slider = {};       ///< Of a parameter that may change in flight.

  Rule& upTo(double limit) { return most = limit, *this; }
  Rule& below(double limit) { return may_be_most = false, upTo(limit); }
  Rule& where(bool holds, const std::string& words) { return conditions.emplace_back(holds, words), *this; }
  Rule& inFlight(double from, double to) { return slider.emplace(from, to), *this; }
};
inline Rule from(double least) { return {least}; }
inline Rule above(double least) { return {least, kInfinity, false}; }
inline Rule below(double most) { return Rule().below(most); }

/// A rule in words: "above 0, up to 20"; "" if any value will do.
std::string describe(const Rule& rule);
/// A value as text, for messages.
std::string describe(const Value& value);

/// Who sets a parameter.
enum class Tier {
  Configure,  ///< Everybody: it describes the UAV, its sensors or its software.
  Tune,       ///< Who wants other trade-offs.
  Internal    ///< Nobody needs to.
};

/// One row of a table of parameters, made for one configuration: its rule's conditions are of the values at that time.
struct Parameter {
  std::string key;
  Field field;
  Rule rule = {};
  std::string meaning = "";  ///< With the unit: "[m] edge of a cell".
  Tier tier = Tier::Internal;
};
using Parameters = std::vector<Parameter>;

/// The table of one configuration struct.
struct ParameterTable {
  std::string name, meaning;
  Parameters rows;  ///< Keys without the table's name.
};
/// The rows of all tables, keys as "name/key".
Parameters parametersOf(const std::vector<ParameterTable>& tables);

/// Puts values into the fields of a table. An int is accepted where a double is expected, not the reverse.
/// @param makeTable is called before and after: a row's rule is of the values at that time.
/// @return every unknown key and wrong type, with key and value, whose fields are unchanged, and every broken rule.
Violations assign(const Values& values, const std::function<Parameters()>& makeTable);
/// The values that the fields have.
Values valuesOf(const Parameters& parameters);
/// Every broken rule, with key, rule and value.
Violations brokenRules(const Parameters& parameters);

}  // namespace flight_corridor
