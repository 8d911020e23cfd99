#include "tools/bag_source.h"

#include <cstdio>
#include <optional>
#include <stdexcept>

#include "bags/bag_reader.h"
#include "ros/object_tf.h"

namespace recognition {
namespace {

class BagSource : public FrameSource {
 public:
  BagSource(std::unique_ptr<BagReader> reader, std::optional<ObjectTf> tf)
      : reader_(std::move(reader)), tf_(std::move(tf)) {}

  int size() const override { return reader_->colorImages(); }

  bool next(NamedFrame& frame) override {
    if (!reader_->next(&current_)) {
      if (reader_->skipped() > 0)
        std::fprintf(stderr, "%d colour images without depth or camera info were skipped\n", reader_->skipped());
      return false;
    }
    char name[48];
    std::snprintf(name, sizeof name, "%lld.%09lld", static_cast<long long>(current_.stamp / 1000000000),
                  static_cast<long long>(current_.stamp % 1000000000));
    frame = {current_.frame, name, 0, number_++, 1e-9 * static_cast<double>(current_.stamp), std::nullopt};
    if (tf_) frame.camera_from_object = tf_->cameraFromObject(current_.frame_id, current_.stamp);
    return true;
  }

 private:
  std::unique_ptr<BagReader> reader_;
  std::optional<ObjectTf> tf_;
  RecordedFrame current_;  // keeps the pixels of the frame handed out
  int number_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> openBagSource(const std::string& file, const std::string& color_topic,
                                           const std::string& info_topic, const std::string& depth_topic,
                                           const std::string& object_frame) {
  std::unique_ptr<BagReader> reader;
  if (color_topic.empty())
    reader = std::make_unique<BagReader>(file);
  else if (info_topic.empty() || depth_topic.empty())
    throw std::runtime_error("a colour topic needs the topics of camera info and depth beside it");
  else
    reader = std::make_unique<BagReader>(file, FrameTopics{color_topic, info_topic, depth_topic});
  std::optional<ObjectTf> tf;
  if (!object_frame.empty()) tf.emplace(ObjectTf::ofBag(file, object_frame));
  return std::make_unique<BagSource>(std::move(reader), std::move(tf));
}

}  // namespace recognition
