#include "bag_source.h"

#include <cstdio>
#include <stdexcept>

#include "rgbd_recognition/ros/bag_reader.h"

namespace rgbd_recognition {
namespace {

class BagSource : public FrameSource {
 public:
  explicit BagSource(std::unique_ptr<BagReader> reader) : reader_(std::move(reader)) {}

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
    frame = {current_.frame, name, 0, number_++, 1e-9 * static_cast<double>(current_.stamp)};
    return true;
  }

 private:
  std::unique_ptr<BagReader> reader_;
  RecordedFrame current_;  // keeps the pixels of the frame handed out
  int number_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> openBagSource(const std::string& file, const std::string& color_topic,
                                           const std::string& info_topic, const std::string& depth_topic) {
  if (color_topic.empty()) return std::make_unique<BagSource>(std::make_unique<BagReader>(file));
  if (info_topic.empty() || depth_topic.empty())
    throw std::runtime_error("a colour topic needs the topics of camera info and depth beside it");
  return std::make_unique<BagSource>(
      std::make_unique<BagReader>(file, FrameTopics{color_topic, info_topic, depth_topic}));
}

}  // namespace rgbd_recognition
