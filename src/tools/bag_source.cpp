#include "tools/bag_source.h"

#include <cstdio>
#include <optional>
#include <stdexcept>

#include "bags/bag_reader.h"
#include "core/frame_check.h"
#include "ros/object_tf.h"

namespace recognition {
namespace {

class BagSource : public FrameSource {
 public:
  BagSource(std::unique_ptr<BagReader> reader, std::optional<ObjectTf> tf)
      : reader_(std::move(reader)), tf_(std::move(tf)) {}

  int size() const override { return reader_->colorImages(); }

  bool next(NamedFrame& frame) override {
    if (!reader_->next(&current_)) return false;
    char name[48];
    std::snprintf(name, sizeof name, "%lld.%09lld", static_cast<long long>(current_.stamp / 1000000000),
                  static_cast<long long>(current_.stamp % 1000000000));
    frame = {current_.frame, name, 0, number_++, 1e-9 * static_cast<double>(current_.stamp), std::nullopt};
    const std::string problem = frameProblem(frame.frame);
    if (!problem.empty()) throw std::runtime_error("frame at " + frame.name + " s: " + problem);
    if (tf_) frame.camera_from_object = tf_->cameraFromObject(current_.frame_id, current_.stamp);
    return true;
  }

  std::string remarks() const override { return reader_->remarks(); }

 private:
  std::unique_ptr<BagReader> reader_;
  std::optional<ObjectTf> tf_;
  RecordedFrame current_;  // keeps the pixels of the frame handed out
  int number_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> openBagSource(const std::string& file, const BagTopics& topics,
                                           const std::string& object_frame) {
  std::unique_ptr<BagReader> reader;
  if (topics.color.empty())
    reader = std::make_unique<BagReader>(file, topics.max_interval);
  else if (topics.camera_info.empty() || topics.depth.empty())
    throw std::runtime_error("a colour topic needs the topics of camera info and depth beside it");
  else
    reader = std::make_unique<BagReader>(file, FrameTopics{topics.color, topics.camera_info, topics.depth},
                                         topics.max_interval);
  std::optional<ObjectTf> tf;
  if (!object_frame.empty()) tf.emplace(ObjectTf::ofBag(file, object_frame));
  return std::make_unique<BagSource>(std::move(reader), std::move(tf));
}

}  // namespace recognition
