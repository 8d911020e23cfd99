#pragma once

#include <functional>
#include <stdexcept>
#include <string>

namespace recognition {

/// Told how far a training is: what it does, and the share done, 0 to 1. May throw TrainingCancelled to end it.
using TrainingProgress = std::function<void(const std::string& stage, double done)>;

/// A training that was ended by wish, not by a fault.
class TrainingCancelled : public std::runtime_error {
 public:
  TrainingCancelled() : std::runtime_error("cancelled") {}
};

}  // namespace recognition
