#pragma once

#include <memory>
#include <optional>
#include <string>

#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/evaluation/bop_dataset.h"

namespace recognition {

/// A frame with what names it.
struct NamedFrame {
  RgbdFrame frame;
  std::string name;                        ///< for people, e.g. "000001/000000"
  int run = 0;                             ///< scene
  int number = 0;                          ///< frame
  double stamp = 0.0;                      ///< seconds
  std::optional<Pose> camera_from_object;  ///< of the object that the source was asked for
};

/// Frames one after the other from wherever they are.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual int size() const = 0;  ///< frames in all; 0 where it is not known beforehand
  /// False at the end. Throws std::runtime_error for a frame that cannot be read, or is not fit to be searched; the
  /// next call goes on after it.
  virtual bool next(NamedFrame& frame) = 0;
  /// After the end: what was left out or changed, and why; "" if nothing was.
  virtual std::string remarks() const { return ""; }
};

/// What of a split is left out, for people; "" if nothing is.
std::string remarksOn(const BopSplit& split);

/// With `object_id`, frames have that object's true pose; those without it throw.
std::unique_ptr<FrameSource> openBopSource(const std::string& split_directory, const BopSplitOptions& options = {},
                                           std::optional<int> object_id = std::nullopt);
std::unique_ptr<FrameSource> openFileSource(const std::string& color, const std::string& depth,
                                            const std::string& camera);

}  // namespace recognition
