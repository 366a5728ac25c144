#include "ros/fields.hpp"

namespace flight_corridor_ros {

namespace {

/// Puts a value into its field.  @return the type that the field wants; "" when the value has it.
struct Assign {
  const Value& value;

  std::string operator()(double* field) const {
    if (const int* integer = std::get_if<int>(&value)) return *field = *integer, "";
    return exactly(field, "a number");
  }
  std::string operator()(int* field) const { return exactly(field, "an integer"); }
  std::string operator()(bool* field) const { return exactly(field, "true or false"); }
  std::string operator()(std::string* field) const { return exactly(field, "a text"); }
  std::string operator()(Eigen::Vector3d* field) const {
    const auto* list = std::get_if<std::vector<double>>(&value);
    if (!list || list->size() != 3) return "a list of three numbers";
    *field = Eigen::Vector3d((*list)[0], (*list)[1], (*list)[2]);
    return "";
  }

 private:
  template <typename T>
  std::string exactly(T* field, const char* wanted) const {
    const T* same = std::get_if<T>(&value);
    if (!same) return wanted;
    *field = *same;
    return "";
  }
};

/// The value of a field.
struct Read {
  template <typename T>
  Value operator()(const T* field) const {
    return *field;
  }
  Value operator()(const Eigen::Vector3d* field) const {
    return std::vector<double>{field->x(), field->y(), field->z()};
  }
};

}  // namespace

flight_corridor::Violations assign(const Values& values, const Fields& fields) {
  flight_corridor::Violations broken;
  for (const auto& [key, value] : values) {
    const auto found = fields.find(key);
    const std::string wanted = found == fields.end() ? "" : std::visit(Assign{value}, found->second);
    if (found == fields.end()) broken.push_back(key + ": unknown key (" + describe(value) + ")");
    if (!wanted.empty()) broken.push_back(key + ": expects " + wanted + " (" + describe(value) + ")");
  }
  return broken;
}

Values valuesOf(const Fields& fields) {
  Values values;
  for (const auto& [key, field] : fields) values[key] = std::visit(Read{}, field);
  return values;
}

}  // namespace flight_corridor_ros
