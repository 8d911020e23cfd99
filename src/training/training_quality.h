#pragma once

#include <string>
#include <vector>

#include "rgbd_recognition/training/recorded_object.h"

namespace recognition {

/// Whether a view is within 20 degrees of the direction.
bool isCovered(const Eigen::Vector3f& direction, const std::vector<Eigen::Vector3f>& view_directions);

/// Share of the upper half of all directions that lies within 20 degrees of a view's.
double coverageOf(const std::vector<Eigen::Vector3f>& view_directions);

/// What a user should know about a model: what was not seen, what it will be bad at.
std::vector<std::string> findWarnings(const ObjectModel& model, const TrainingReport& report,
                                      const std::vector<Eigen::Vector3f>& view_directions);

}  // namespace recognition
