#include "rgbd_recognition/core/parameters.h"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>
#include <stdexcept>

namespace recognition {
namespace {

[[noreturn]] void reject(const Parameter& p, const std::string& group, const std::string& value,
                         const std::string& why) {
  throw std::invalid_argument(group + "/" + p.name + " is '" + value + "': " + why);
}

std::string rangeText(const Parameter& p) {
  std::ostringstream text;
  text << "must be in [" << p.min << ", " << p.max << "]" << (p.unit.empty() ? "" : " ") << p.unit;
  return text.str();
}

std::string choicesText(const Parameter& p) {
  std::string text = "must be one of";
  for (const std::string& choice : p.choices) text += " " + choice;
  return text;
}

double parseNumber(const Parameter& p, const std::string& text, const std::string& group) {
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  double value = 0.0;
  if (!(in >> value) || !(in >> std::ws).eof()) reject(p, group, text, "not a number");
  return value;
}

void checkRange(const Parameter& p, double value, const std::string& group) {
  if (!std::isfinite(value) || value < p.min || value > p.max) reject(p, group, valueText(p), rangeText(p));
}

}  // namespace

Parameter boolParameter(const char* name, bool* value, const char* doc) { return {name, "", doc, value, 0.0, 1.0, {}}; }

Parameter intParameter(const char* name, const char* unit, int* value, int min, int max, const char* doc) {
  return {name, unit, doc, value, static_cast<double>(min), static_cast<double>(max), {}};
}

Parameter doubleParameter(const char* name, const char* unit, double* value, double min, double max, const char* doc) {
  return {name, unit, doc, value, min, max, {}};
}

std::string valueText(const Parameter& p) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  if (const auto* b = std::get_if<bool*>(&p.value)) text << (**b ? "true" : "false");
  if (const auto* i = std::get_if<int*>(&p.value)) text << **i;
  if (const auto* d = std::get_if<double*>(&p.value)) text << **d;
  if (const auto* c = std::get_if<ChoiceAccess>(&p.value)) text << p.choices.at(static_cast<size_t>(c->get()));
  return text.str();
}

void setFromText(const Parameter& p, const std::string& text, const std::string& group) {
  if (const auto* b = std::get_if<bool*>(&p.value)) {
    if (text != "true" && text != "false") reject(p, group, text, "must be true or false");
    **b = text == "true";
  } else if (const auto* i = std::get_if<int*>(&p.value)) {
    const double value = parseNumber(p, text, group);
    if (value != std::floor(value)) reject(p, group, text, "must be a whole number");
    if (value < p.min || value > p.max) reject(p, group, text, rangeText(p));
    **i = static_cast<int>(value);
  } else if (const auto* d = std::get_if<double*>(&p.value)) {
    const double value = parseNumber(p, text, group);
    if (!(value >= p.min && value <= p.max)) reject(p, group, text, rangeText(p));
    **d = value;
  } else {
    const auto found = std::find(p.choices.begin(), p.choices.end(), text);
    if (found == p.choices.end()) reject(p, group, text, choicesText(p));
    std::get<ChoiceAccess>(p.value).set(static_cast<int>(found - p.choices.begin()));
  }
}

void validateParameters(const ParameterList& parameters, const std::string& group) {
  for (const Parameter& p : parameters) {
    if (const auto* i = std::get_if<int*>(&p.value)) checkRange(p, **i, group);
    if (const auto* d = std::get_if<double*>(&p.value)) checkRange(p, **d, group);
  }
}

}  // namespace recognition
