#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

namespace recognition {

/// A named choice, stored in the owning struct as an enum; index into `Parameter::choices`.
struct ChoiceAccess {
  std::function<int()> get;
  std::function<void(int)> set;
};

/// One field of a parameter struct, with all that a reader, a checker, or a table in the docs needs. The struct's own
/// initialiser is the only place that holds the default.
struct Parameter {
  std::string name;  ///< as in the yaml and the .cfg: snake_case
  std::string unit;  ///< SI unit, "px", "deg", or "" for a plain number
  std::string doc;   ///< one line
  std::variant<bool*, int*, double*, ChoiceAccess> value;
  double min = 0.0;  ///< for int and double, inclusive
  double max = 0.0;
  std::vector<std::string> choices;  ///< for ChoiceAccess
};

using ParameterList = std::vector<Parameter>;

/// Makers, so that a struct's list reads as a table.
Parameter boolParameter(const char* name, bool* value, const char* doc);
Parameter intParameter(const char* name, const char* unit, int* value, int min, int max, const char* doc);
Parameter doubleParameter(const char* name, const char* unit, double* value, double min, double max, const char* doc);
template <typename Enum>
Parameter choiceParameter(const char* name, Enum* value, std::vector<std::string> choices, const char* doc) {
  ChoiceAccess access{[value] { return static_cast<int>(*value); }, [value](int i) { *value = static_cast<Enum>(i); }};
  return {name, "", doc, std::move(access), 0.0, 0.0, std::move(choices)};
}

/// Value as it would stand in a yaml file.
std::string valueText(const Parameter& parameter);

/// Sets one value from its text; throws std::invalid_argument that names group, field, value and what is allowed.
void setFromText(const Parameter& parameter, const std::string& text, const std::string& group);

/// Throws std::invalid_argument that names group, field, value and range of the first field out of range.
void validateParameters(const ParameterList& parameters, const std::string& group);

}  // namespace recognition
