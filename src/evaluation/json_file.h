#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace recognition {

/// A JSON file. Throws std::runtime_error that names the file: unreadable, or no JSON (with the line).
nlohmann::json readJsonFile(const std::string& file);

/// An entry's value; throw std::runtime_error that names the key: missing, or of another kind.
const nlohmann::json& memberOf(const nlohmann::json& entry, const std::string& key);
double numberOf(const nlohmann::json& entry, const std::string& key);
/// `count` numbers, in one list or in lists of lists.
std::vector<double> numbersOf(const nlohmann::json& entry, const std::string& key, size_t count);
/// The same of any length.
std::vector<double> numbersOf(const nlohmann::json& entry, const std::string& key);

}  // namespace recognition
