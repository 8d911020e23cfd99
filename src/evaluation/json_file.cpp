#include "evaluation/json_file.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace recognition {
namespace {

// False if something in it is no number.
bool flatten(const nlohmann::json& value, std::vector<double>* numbers) {
  if (value.is_number()) {
    numbers->push_back(value.get<double>());
    return true;
  }
  return value.is_array() &&
         std::all_of(value.begin(), value.end(), [&](const nlohmann::json& part) { return flatten(part, numbers); });
}

}  // namespace

nlohmann::json readJsonFile(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file + ": cannot be read");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
    throw std::runtime_error(file + ": is no valid JSON in line " +
                             std::to_string(1 + std::count(text.begin(), end, '\n')));
  } catch (const nlohmann::json::exception&) {
    throw std::runtime_error(file + ": is no valid JSON");
  }
}

const nlohmann::json& memberOf(const nlohmann::json& entry, const std::string& key) {
  if (!entry.is_object() || !entry.contains(key)) throw std::runtime_error("has no " + key);
  return entry.at(key);
}

double numberOf(const nlohmann::json& entry, const std::string& key) {
  const nlohmann::json& value = memberOf(entry, key);
  if (!value.is_number()) throw std::runtime_error(key + " is no number");
  return value.get<double>();
}

std::vector<double> numbersOf(const nlohmann::json& entry, const std::string& key) {
  std::vector<double> numbers;
  if (!flatten(memberOf(entry, key), &numbers)) throw std::runtime_error(key + " holds what is no number");
  return numbers;
}

std::vector<double> numbersOf(const nlohmann::json& entry, const std::string& key, size_t count) {
  const std::vector<double> numbers = numbersOf(entry, key);
  if (numbers.size() != count)
    throw std::runtime_error(key + " has " + std::to_string(numbers.size()) + " numbers, not " + std::to_string(count));
  return numbers;
}

}  // namespace recognition
