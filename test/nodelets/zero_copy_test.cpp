// Camera and recognition in one manager, on a virtual Kinect: from the driver to verification no image is copied.
#include <algorithm>
#include <thread>

#include "nodelets/pipeline_fixture.h"

namespace recognition {
namespace {

/// Where the messages of a topic lie in memory, by stamp.
template <typename Message>
class Addresses {
 public:
  Addresses(ros::NodeHandle node, const std::string& topic) {
    const boost::function<void(const boost::shared_ptr<const Message>&)> arrived =
        [this](const boost::shared_ptr<const Message>& message) {
          const std::lock_guard<std::mutex> lock(mutex_);
          addresses_[message->header.stamp] = message.get();
        };
    subscriber_ = node.subscribe<Message>(topic, 100, arrived);
  }
  const void* at(const ros::Time& stamp) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = addresses_.find(stamp);
    return found == addresses_.end() ? nullptr : found->second;
  }
  std::vector<ros::Time> stamps() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::vector<ros::Time> all;
    for (const auto& [stamp, address] : addresses_) all.push_back(stamp);
    return all;
  }

 private:
  mutable std::mutex mutex_;
  std::map<ros::Time, const void*> addresses_;
  ros::Subscriber subscriber_;
};

TEST_F(PipelineTest, nothingIsCopiedFromTheDriverToVerification) {
  setParam("openni2_camera/device_id", std::string("virtual:" RGBD_TEST_DATA "/demo/test_primesense/000001"));
  setParam("models", trainedStore());
  ASSERT_TRUE(load("openni2_camera"));
  ASSERT_TRUE(loadAs("rectify_color", "image_proc/rectify",  // as in openni2.launch
                     {{ns_ + "/image_mono", ns_ + "/rgb/image_raw"},
                      {ns_ + "/image_rect", ns_ + "/rgb/image_rect_color"},
                      {ns_ + "/camera_info", ns_ + "/rgb/camera_info"}}));
  ASSERT_TRUE(load("segmentation"));
  for (const char* name : {"feature_extraction", "hypothesis_generation", "reprojection_verification"})
    ASSERT_TRUE(load(name)) << name;
  const Addresses<sensor_msgs::Image> color(node_, "rgb/image_raw"), depth(node_, "depth_registered/image_raw"),
      last_color(node_, "hypothesis_generation/color"), last_depth(node_, "hypothesis_generation/depth");
  const Addresses<sensor_msgs::CameraInfo> info(node_, "rgb/camera_info"),
      last_info(node_, "hypothesis_generation/camera_info");
  const Addresses<messages::DetectionArray> detections(node_, "detections");
  ros::Time answered;
  ASSERT_TRUE(waitFor([&] {
    for (const ros::Time& stamp : detections.stamps()) {
      if (color.at(stamp) && depth.at(stamp) && info.at(stamp) && last_color.at(stamp) && last_depth.at(stamp) &&
          last_info.at(stamp))
        answered = stamp;
    }
    return !answered.isZero();
  }));
  EXPECT_EQ(last_color.at(answered), color.at(answered));
  EXPECT_EQ(last_depth.at(answered), depth.at(answered));
  EXPECT_EQ(last_info.at(answered), info.at(answered));
}

TEST_F(PipelineTest, depthOfAnotherStampIsNotCopied) {
  loadPipeline();
  const Addresses<sensor_msgs::Image> last_depth(node_, "hypothesis_generation/depth");
  const Addresses<messages::DetectionArray> detections(node_, "detections");
  waitForCamera();
  const FrameMessages first = demoFrames().front();
  std::vector<FrameMessages> frames;  // the next one tells the synchroniser that nothing nearer comes
  ASSERT_TRUE(waitFor([&] {
    const ros::Duration since(0.1 * static_cast<double>(frames.size()));
    FrameMessages frame = withStamp(first, first.color->header.stamp + since);
    const auto later = boost::make_shared<sensor_msgs::Image>(*frame.depth);
    later->header.stamp += ros::Duration(0.003);
    frame.depth = later;
    frames.push_back(frame);
    publish(frame);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return !detections.stamps().empty();
  }));
  const ros::Time answered = detections.stamps().front();
  const auto found = std::find_if(frames.begin(), frames.end(),
                                  [&](const FrameMessages& f) { return f.color->header.stamp == answered; });
  ASSERT_NE(found, frames.end());
  EXPECT_EQ(last_depth.at(found->depth->header.stamp), found->depth.get());
}

}  // namespace
}  // namespace recognition

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "zero_copy_test");
  const ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
