#include "tools/frame_source.h"

#include <algorithm>
#include <stdexcept>

#include "core/frame_check.h"
#include "evaluation/frame_files.h"

namespace recognition {
namespace {

/// Says of which frame it is that nothing can be found in.
void requireFitOf(const NamedFrame& frame) {
  const std::string problem = frameProblem(frame.frame);
  if (!problem.empty()) throw std::runtime_error(frame.name + ": " + problem);
}

class BopSource : public FrameSource {
 public:
  BopSource(const std::string& split_directory, const BopSplitOptions& options, std::optional<int> object_id)
      : split_(openBopSplit(split_directory, options)), object_id_(object_id) {}
  int size() const override { return static_cast<int>(split_.frames.size()); }
  bool next(NamedFrame& frame) override {
    if (index_ == split_.frames.size()) return false;
    const BopFrame& source = split_.frames[index_++];
    frame = {loadBopFrame(source), source.name(), source.scene, source.frame, 0.0, std::nullopt};
    requireFitOf(frame);
    if (object_id_) frame.camera_from_object = poseIn(source, *object_id_);
    return true;
  }
  std::string remarks() const override { return remarksOn(split_); }

 private:
  static Pose poseIn(const BopFrame& frame, int object_id) {
    const auto found = std::find_if(frame.ground_truth.begin(), frame.ground_truth.end(),
                                    [&](const GroundTruth& object) { return object.object_id == object_id; });
    if (found == frame.ground_truth.end())
      throw std::runtime_error("frame " + frame.name() + " has no pose of object " + std::to_string(object_id));
    return found->camera_from_object;
  }

  const BopSplit split_;
  std::optional<int> object_id_;
  size_t index_ = 0;
};

class FileSource : public FrameSource {
 public:
  FileSource(std::string color, std::string depth, std::string camera)
      : color_(std::move(color)), depth_(std::move(depth)), camera_(std::move(camera)) {}
  int size() const override { return 1; }
  bool next(NamedFrame& frame) override {
    if (done_) return false;
    done_ = true;
    frame = {loadFrameFiles(color_, depth_, camera_), color_, 0, 0, 0.0, std::nullopt};
    was_distorted_ = isDistorted(color_, camera_);
    requireFitOf(frame);
    return true;
  }
  std::string remarks() const override {
    return was_distorted_ ? "the distortion that " + camera_ + " gives was undone in colour and depth" : "";
  }

 private:
  std::string color_, depth_, camera_;
  bool done_ = false, was_distorted_ = false;
};

}  // namespace

std::string remarksOn(const BopSplit& split) {
  std::string text;
  if (!split.targets_file.empty())
    text = "only the " + std::to_string(split.frames.size()) + " frames of " + split.targets_file +
           " were taken (--all-frames takes all)";
  if (!split.missing.empty())
    text += (text.empty() ? "" : "; ") + std::string("left out, as files are missing: ") +
            std::to_string(split.missing.size()) + " (" + describeMissing(split) + ")";
  return text;
}

std::unique_ptr<FrameSource> openBopSource(const std::string& split_directory, const BopSplitOptions& options,
                                           std::optional<int> object_id) {
  return std::make_unique<BopSource>(split_directory, options, object_id);
}

std::unique_ptr<FrameSource> openFileSource(const std::string& color, const std::string& depth,
                                            const std::string& camera) {
  return std::make_unique<FileSource>(color, depth, camera);
}

}  // namespace recognition
