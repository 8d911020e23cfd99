#pragma once

#include <stdexcept>
#include <string>

namespace recognition {

/// What an action says that throws an `Error`; empty if it throws nothing.
template <typename Error = std::invalid_argument, typename Action>
std::string refusal(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace recognition
