#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <nodelet/loader.h>
#include <ros/ros.h>

#include "rgbd_recognition/model/object_model.h"
#include "ros/image_conversions.h"
#include "ros/messages.h"

namespace recognition {

/// Names of two of the demo's objects, trained for these tests.
extern const char* const kFirstObject;
extern const char* const kSecondObject;

/// A store with the two objects, trained once a process; removed at the end.
const std::string& trainedStore();
/// A new empty folder, removed at the end.
std::string emptyFolder();

/// The frames of the demo's recording as messages.
std::vector<FrameMessages> demoFrames();
FrameMessages withStamp(const FrameMessages& frame, const ros::Time& stamp);

/// Waits until `condition` holds; false if it does not within `seconds`.
bool waitFor(const std::function<bool()>& condition, double seconds = 60.0);

/// Messages of a topic as they came.
template <typename Message>
class Recorder {
 public:
  Recorder(ros::NodeHandle node, const std::string& topic) {
    const boost::function<void(const boost::shared_ptr<const Message>&)> arrived =
        [this](const boost::shared_ptr<const Message>& message) {
          const std::lock_guard<std::mutex> lock(mutex_);
          messages_.push_back(message);
        };
    subscriber_ = node.subscribe<Message>(topic, 100, arrived);
  }

  bool connected() const { return subscriber_.getNumPublishers() > 0; }
  size_t count() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return messages_.size();
  }
  /// Of all messages, in the order of their arrival.
  std::vector<ros::Time> stamps() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::vector<ros::Time> stamps;
    for (const auto& message : messages_) stamps.push_back(message->header.stamp);
    return stamps;
  }
  /// The message of that stamp, or null.
  boost::shared_ptr<const Message> at(const ros::Time& stamp) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const auto& message : messages_)
      if (message->header.stamp == stamp) return message;
    return nullptr;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<boost::shared_ptr<const Message>> messages_;
  ros::Subscriber subscriber_;
};

/// A camera that takes the demo's first frame over and over until the end of the scope. Its clock may be behind ours.
class RunningCamera {
 public:
  explicit RunningCamera(const std::function<void(const FrameMessages&)>& publish, double seconds_behind = 0.0)
      : thread_([this, publish, seconds_behind] {
          const FrameMessages frame = demoFrames().front();
          while (!done_) {
            publish(withStamp(frame, ros::Time::now() - ros::Duration(seconds_behind)));
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
          }
        }) {}
  ~RunningCamera() {
    done_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> done_{false};
  std::thread thread_;
};

/// Nodelets in this process, in a namespace of their own for each test, with a camera that the test is.
class PipelineTest : public ::testing::Test {
 protected:
  PipelineTest();
  ~PipelineTest() override;

  /// Loads a nodelet by its plain name; false if it refuses.
  bool load(const std::string& name, const std::map<std::string, std::string>& remappings = {});
  /// Under another name than its own; `type` may name another package's: "image_proc/rectify".
  bool loadAs(const std::string& name, const std::string& type,
              const std::map<std::string, std::string>& remappings = {});
  void loadPipeline();

  template <typename T>
  void setParam(const std::string& name, const T& value) {
    ros::param::set(ns_ + "/" + name, value);
  }

  /// Waits until the first stage listens to the camera.
  void waitForCamera();
  /// Publishes what is not null.
  void publish(const FrameMessages& frame);
  /// Publishes the frame and waits for its detections.
  messages::DetectionArrayConstPtr detect(const FrameMessages& frame);

  /// Waits until a nodelet's diagnostics hold `text` in their summary or a value.
  bool diagnosed(const std::string& nodelet, const std::string& text, double seconds = 20.0);

  /// The largest value of a number in a nodelet's diagnostics so far.
  double largestDiagnosed(const std::string& nodelet, const std::string& key);

  std::string ns_;
  ros::NodeHandle node_;
  ros::Publisher color_, depth_, camera_info_;

 private:
  void onDiagnostics(const diagnostic_msgs::DiagnosticArrayConstPtr& array);

  ros::AsyncSpinner spinner_{2};
  std::unique_ptr<nodelet::Loader> loader_;
  ros::Subscriber diagnostics_;
  std::mutex mutex_;                                   // guards told_
  std::map<std::string, std::set<std::string>> told_;  // by nodelet
  std::unique_ptr<Recorder<messages::DetectionArray>> detections_;
};

}  // namespace recognition
