#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "rgbd_recognition/training/recorded_object.h"

namespace rgbd_recognition {

/// A recording of one object, and how a model is made from it.
struct RecordingOptions {
  std::string bag, color_topic, info_topic, depth_topic;
  std::string frames;                      ///< BOP split directory
  std::string color, depth, camera, mask;  ///< one labelled view
  std::string board;
  RecordingParameters parameters;

  bool given() const { return !bag.empty() || !frames.empty() || !color.empty(); }
  /// File or directory of the recording.
  const std::string& source() const { return !bag.empty() ? bag : !frames.empty() ? frames : color; }
};

/// Options and their documentation; all need `name`.
void addRecordingOptions(CLI::App& app, RecordingOptions& options, CLI::Option* name);

/// Throws std::runtime_error with the reason if no model can be made.
RecordedObject::Result trainFromRecording(const RecordingOptions& options, const std::string& name,
                                          const FeatureParameters& features, const std::vector<DescriptorType>& types);

}  // namespace rgbd_recognition
