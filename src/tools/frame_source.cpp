#include "tools/frame_source.h"

#include <algorithm>
#include <stdexcept>

#include "rgbd_recognition/evaluation/bop_dataset.h"

namespace recognition {
namespace {

class BopSource : public FrameSource {
 public:
  BopSource(const std::string& split_directory, std::optional<int> object_id)
      : frames_(readBopSplit(split_directory)), object_id_(object_id) {}
  int size() const override { return static_cast<int>(frames_.size()); }
  bool next(NamedFrame& frame) override {
    if (index_ == frames_.size()) return false;
    const BopFrame& source = frames_[index_++];
    frame = {loadBopFrame(source), source.name(), source.scene, source.frame, 0.0, std::nullopt};
    if (object_id_) frame.camera_from_object = poseIn(source, *object_id_);
    return true;
  }

 private:
  static Pose poseIn(const BopFrame& frame, int object_id) {
    const auto found = std::find_if(frame.ground_truth.begin(), frame.ground_truth.end(),
                                    [&](const GroundTruth& object) { return object.object_id == object_id; });
    if (found == frame.ground_truth.end())
      throw std::runtime_error("frame " + frame.name() + " has no pose of object " + std::to_string(object_id));
    return found->camera_from_object;
  }

  std::vector<BopFrame> frames_;
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
    return true;
  }

 private:
  std::string color_, depth_, camera_;
  bool done_ = false;
};

}  // namespace

std::unique_ptr<FrameSource> openBopSource(const std::string& split_directory, std::optional<int> object_id) {
  return std::make_unique<BopSource>(split_directory, object_id);
}

std::unique_ptr<FrameSource> openFileSource(const std::string& color, const std::string& depth,
                                            const std::string& camera) {
  return std::make_unique<FileSource>(color, depth, camera);
}

}  // namespace recognition
