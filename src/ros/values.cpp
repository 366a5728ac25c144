#include "ros/values.hpp"

#include <XmlRpcValue.h>
#include <yaml-cpp/yaml.h>

#include <ios>
#include <stdexcept>

namespace flight_corridor_ros {

namespace {

constexpr int kLevels = 3;  // of maps: a key has two, and one that has more shall be named

template <typename T>
bool convert(const YAML::Node& node, Value& value) {
  T converted;
  if (!YAML::convert<T>::decode(node, converted)) return false;
  value = converted;
  return true;
}

Value toValue(const YAML::Node& node) {
  Value value;
  if (node.IsSequence()) {
    convert<std::vector<double>>(node, value);
  } else if (node.IsScalar()) {
    const bool quoted = node.Tag() == "!";  // "5" is a text, 5 a number
    if (quoted || !(convert<bool>(node, value) || convert<int>(node, value) || convert<double>(node, value))) {
      value = node.Scalar();
    }
  }
  return value;
}

Value toValue(XmlRpc::XmlRpcValue& node);

/// Numbers of a list; monostate if it holds anything else.
Value toList(XmlRpc::XmlRpcValue& node) {
  std::vector<double> numbers;
  for (int i = 0; i < node.size(); ++i) {
    const Value value = toValue(node[i]);
    const int* integer = std::get_if<int>(&value);
    const double* real = std::get_if<double>(&value);
    if (!integer && !real) return std::monostate();
    numbers.push_back(integer ? *integer : *real);
  }
  return numbers;
}

Value toValue(XmlRpc::XmlRpcValue& node) {
  switch (node.getType()) {
    case XmlRpc::XmlRpcValue::TypeBoolean:
      return static_cast<bool>(node);
    case XmlRpc::XmlRpcValue::TypeInt:
      return static_cast<int>(node);
    case XmlRpc::XmlRpcValue::TypeDouble:
      return static_cast<double>(node);
    case XmlRpc::XmlRpcValue::TypeString:
      return static_cast<std::string>(node);
    case XmlRpc::XmlRpcValue::TypeArray:
      return toList(node);
    default:
      return std::monostate();
  }
}

std::string joined(const std::string& prefix, const std::string& name) {
  return prefix.empty() ? name : prefix + "/" + name;
}

/// @param levels below which maps are not looked into: with YAML's aliases they need not end.
void flatten(const YAML::Node& node, const std::string& key, int levels, Values& values) {
  if (!node.IsMap() || levels == 0) {
    values[key] = toValue(node);
    return;
  }
  for (const auto& child : node) flatten(child.second, joined(key, child.first.as<std::string>()), levels - 1, values);
}

void flatten(XmlRpc::XmlRpcValue& node, const std::string& key, Values& values) {
  if (node.getType() != XmlRpc::XmlRpcValue::TypeStruct) {
    values[key] = toValue(node);
    return;
  }
  for (auto& child : node) flatten(child.second, joined(key, child.first), values);
}

template <typename T>
void write(const ros::NodeHandle& private_node, const std::string& key, const T& value) {
  private_node.setParam(key, value);
}
void write(const ros::NodeHandle&, const std::string&, std::monostate) {}

}  // namespace

Values readYaml(const std::string& path) try {
  const YAML::Node file = YAML::LoadFile(path);
  if (!file.IsMap()) throw std::invalid_argument(path + ": not a map of parameters");
  Values values;
  flatten(file, "", kLevels, values);
  return values;
} catch (const YAML::BadFile&) {
  throw std::invalid_argument(path + ": cannot be read");
} catch (const std::ios_base::failure&) {  // a directory
  throw std::invalid_argument(path + ": cannot be read");
} catch (const YAML::Exception& error) {
  throw std::invalid_argument(path + ": " + error.what());
}

Values readParameters(const ros::NodeHandle& private_node) {
  Values values;
  XmlRpc::XmlRpcValue tree;
  if (private_node.getParam(private_node.getNamespace(), tree)) flatten(tree, "", values);
  return values;
}

void writeParameters(const ros::NodeHandle& private_node, const Values& values) {
  for (const auto& [key, value] : values) {
    std::visit([&, &key = key](const auto& plain) { write(private_node, key, plain); }, value);
  }
}

void setParameter(Values& values, const std::string& key_and_value) try {
  const std::size_t split = key_and_value.find('=');
  if (split == 0 || split == std::string::npos) throw std::invalid_argument(key_and_value + ": expects key=value");
  const std::string text = key_and_value.substr(split + 1);
  values[key_and_value.substr(0, split)] = text.empty() ? Value(text) : toValue(YAML::Load(text));
} catch (const YAML::Exception& error) {
  throw std::invalid_argument(key_and_value + ": " + error.what());
}

}  // namespace flight_corridor_ros
