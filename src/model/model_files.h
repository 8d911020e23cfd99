#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "rgbd_recognition/model/object_model.h"

namespace recognition {

/// A stored model: file name -> bytes.
using ModelFiles = std::map<std::string, std::string>;

constexpr const char* kDescriptionFile = "model.yaml";

/// Throws std::invalid_argument for a model that decodeModel would refuse.
ModelFiles encodeModel(const ObjectModel& model);

/// `read` gives the bytes of a file by its name, or throws. Only features of `types` are read (empty: all). Throws
/// std::runtime_error with file and reason for anything damaged, implausible, or of a newer format.
ObjectModel decodeModel(const std::function<std::string(const std::string& file)>& read,
                        const std::vector<DescriptorType>& types);

}  // namespace recognition
