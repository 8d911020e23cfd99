#include "frame_source.h"

#include "rgbd_recognition/evaluation/bop_dataset.h"

namespace rgbd_recognition {
namespace {

class BopSource : public FrameSource {
 public:
  explicit BopSource(const std::string& split_directory) : frames_(readBopSplit(split_directory)) {}
  int size() const override { return static_cast<int>(frames_.size()); }
  bool next(NamedFrame& frame) override {
    if (index_ == frames_.size()) return false;
    const BopFrame& source = frames_[index_++];
    frame = {loadBopFrame(source), source.name(), source.scene, source.frame, 0.0};
    return true;
  }

 private:
  std::vector<BopFrame> frames_;
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
    frame = {loadFrameFiles(color_, depth_, camera_), color_, 0, 0, 0.0};
    return true;
  }

 private:
  std::string color_, depth_, camera_;
  bool done_ = false;
};

}  // namespace

std::unique_ptr<FrameSource> openBopSource(const std::string& split_directory) {
  return std::make_unique<BopSource>(split_directory);
}

std::unique_ptr<FrameSource> openFileSource(const std::string& color, const std::string& depth, const std::string& camera) {
  return std::make_unique<FileSource>(color, depth, camera);
}

}  // namespace rgbd_recognition
