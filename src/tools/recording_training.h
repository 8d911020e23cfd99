#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/frame_source.h"
#include "rgbd_recognition/training/object_trainer.h"

namespace recognition {

/// Recordings of objects.
struct RecordingOptions {
  std::string bag, bags, color_topic, info_topic, depth_topic;
  double max_interval = 0.02;              ///< between a bag's colour images and their depth, seconds
  std::string frames;                      ///< BOP split directory
  std::string color, depth, camera, mask;  ///< one labelled view
  std::string board, board_from_object;    ///< yaml files
  std::string object_frame;                ///< of tf, without a board
  std::optional<int> object_id;            ///< of the ground truth, without a board
  std::vector<double> stands_at;           ///< x y z in the object's frame, metres

  bool given() const { return !bag.empty() || !bags.empty() || !frames.empty() || !color.empty(); }
};

/// Options and their documentation; all but --bags need `name`.
void addRecordingOptions(CLI::App& app, RecordingOptions& options, CLI::Option* name);

/// The recordings: object name -> file or directory; `name` where there is one only. Throws std::runtime_error.
std::vector<std::pair<std::string, std::string>> listRecordings(const RecordingOptions& options,
                                                                const std::string& name);

/// One recording's frames, and the board under the object. Throw std::runtime_error or std::invalid_argument.
std::unique_ptr<FrameSource> openRecording(const RecordingOptions& options, const std::string& file);
std::optional<FiducialBoard> readBoard(const RecordingOptions& options);
/// The frame that the model is to have, if the options say so; see RecordedObject. Throws as the others.
std::optional<Pose> readWorldFromObject(const RecordingOptions& options);
/// The frames as views for training; `source` must outlive it.
ViewSource viewsOf(FrameSource& source, const RecordingOptions& options);

}  // namespace recognition
