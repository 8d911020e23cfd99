#include <boost/make_shared.hpp>
#include <pluginlib/class_list_macros.hpp>
#include <rgbd_recognition/SegmentationConfig.h>
#include <std_srvs/SetBool.h>

#include "ros/camera_input.h"
#include "ros/frame_bundle.h"
#include "ros/frame_pacer.h"
#include "ros/message_conversions.h"
#include "ros/reconfigurable.h"
#include "ros/scene_change.h"
#include "ros/segment_overlay.h"
#include "ros/stage_nodelet.h"
#include "segmentation/segmenter.h"
#include "tracking/segments_to_search.h"
#include "rgbd_recognition/tracking/tracking_parameters.h"
#include "rgbd_recognition/core/frame.h"
#include "core/frame_check.h"

namespace recognition {
namespace {

constexpr double kMaxInPipeline = 8;          // frames
constexpr double kAnswerPatience = 60.0;      // seconds without an answer after which frames no longer wait for one
constexpr std::uint32_t kFeedbackQueue = 20;  // of all rounds of the frames in the pipeline: no answer may be missed
constexpr const char* kEnabled = "enabled";
constexpr const char* kFrames = "frames_in_pipeline";
constexpr const char* kMaxRate = "max_rate";
constexpr const char* kRest = "rest";
constexpr double kMaxRest = 3600.0;       // seconds
constexpr double kMaxExplainedAge = 1.0;  // seconds since tracking told last, after which it counts as gone

/// The message itself if it has the colour image's stamp, else a copy that has: later stages join a frame by one stamp.
sensor_msgs::CameraInfoConstPtr withStamp(const sensor_msgs::CameraInfoConstPtr& info, const ros::Time& stamp) {
  if (info->header.stamp == stamp) return info;
  const auto copy = boost::make_shared<sensor_msgs::CameraInfo>(*info);
  copy->header.stamp = stamp;
  return copy;
}

}  // namespace

/// First stage, Sec. IV: pairs the camera's images and divides depth into smooth patches.
class SegmentationNodelet : public StageNodelet {
 private:
  void configure() override {
    ros::NodeHandle& node = getPrivateNodeHandle();
    begins_enabled_ = parameterOr(node, kEnabled, true);
    openModels();
    parameters_.read(node, namesBesideTheCores(),
                     [this](const SegmentationParameters& parameters) { build(parameters); });
    const double max_rate = numberInRange(node, kMaxRate, 0.0, 0.0, 1000.0);
    min_period_ = ros::WallDuration(max_rate > 0.0 ? 1.0 / max_rate : 0.0);
    scene_change_ = SceneChange(numberInRange(node, kRest, 0.0, 0.0, kMaxRest));
    pacer_ = FramePacer(static_cast<int>(numberInRange(node, kFrames, 1, 1, kMaxInPipeline)), kAnswerPatience);
    camera_ = std::make_unique<CameraInput>(
        node, [this](const FrameMessages& frame) { process(frame); },
        [this](const std::string& topics, const std::string& problem) { reject(topics, problem); },
        [this] { monitor().dropped(); });
  }

  void advertise() override {
    ros::NodeHandle& node = getPrivateNodeHandle();
    parameters_.serve(node);
    output_.advertise([&](auto message, const char* topic) { return advertiseLazy<decltype(message)>(node, topic); },
                      false);
    overlay_ = advertiseLazyImage(node, "overlay");
    enable(begins_enabled_);
    enable_ = node.advertiseService("enable", &SegmentationNodelet::onEnable, this);
  }

  static std::vector<std::string> namesBesideTheCores() {
    auto names = stageParameterNames();
    const auto& of_camera = CameraInput::parameterNames();
    names.insert(names.end(), of_camera.begin(), of_camera.end());
    names.insert(names.end(), {kEnabled, kFrames, kMaxRate, kRest});
    return names;
  }

  /// The gate of the pipeline; the parameter keeps its state for a nodelet that is started again.
  bool onEnable(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response) {
    scene_change_.reset();  // whoever asks wants the next frame, and all of it
    to_search_.reset();
    last_admitted_ = ros::WallTime();
    enable(request.data);
    getPrivateNodeHandle().setParam(kEnabled, enabled());
    response.success = 1;
    return true;
  }

  void startInputs() override {
    pacer_.reset();
    scene_change_.reset();
    to_search_ = SegmentsToSearch(searchPeriod());
    last_admitted_ = ros::WallTime();
    feedback_ = getNodeHandle().subscribe("reprojection_verification/feedback", kFeedbackQueue,
                                          &SegmentationNodelet::onFeedback, this);
    explained_input_ = getNodeHandle().subscribe("tracking/explained", 1, &SegmentationNodelet::onExplained, this);
    camera_->subscribe(getNodeHandle());
    inputs_timer_ =
        getNodeHandle().createWallTimer(ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) { reportInputs(); });
  }

  void stopInputs() override {
    inputs_timer_.stop();
    camera_->unsubscribe();
    feedback_.shutdown();
    explained_input_.shutdown();
    explained_.reset();
    for (const auto& [name, state] : camera_->report()) monitor().setValue(name, "not listened to");
  }

  void onFeedback(const messages::FeedbackConstPtr& feedback) {
    if (!feedback->finished) return;
    to_search_.searched(feedback->header.stamp.toSec(), feedback->in_full != 0);
    if (feedback->header.stamp.isZero()) return pacer_.reset();  // verification begins: what it had is lost
    pacer_.finished(feedback->header.stamp, ros::WallTime::now());
    monitor().setValue("frames lost in later stages", std::to_string(pacer_.lost()));
  }

  void onExplained(const sensor_msgs::ImageConstPtr& mask) {
    explained_ = mask;
    explained_arrived_ = ros::WallTime::now();
  }

  /// What tracks explain of the frame before this one, not copied; empty where nobody tracks: then all is searched.
  cv::Mat explainedByTracks(const ros::WallTime& now) {
    if (!explained_ || (now - explained_arrived_).toSec() > kMaxExplainedAge) return {};
    return maskView(*explained_);
  }

  double searchPeriod() const {
    const ros::NodeHandle node(getNodeHandle(), "tracking");
    return numberInRange(node, "search_period", TrackingParameters().search_period, 0.0, 86400.0);
  }

  void build(const SegmentationParameters& parameters) {
    bool changed = false;
    segmenter_ = std::make_unique<Segmenter>(parameters, extentLimits(*models(&changed)));
  }

  void reportInputs() {
    for (const auto& [name, state] : camera_->report()) monitor().setValue(name, state);
  }

  void process(const FrameMessages& messages) {
    const Stopwatch watch;
    const ros::WallTime now = ros::WallTime::now();
    if (feedback_.getNumPublishers() == 0) pacer_.reset();  // nobody answers
    if (now - last_admitted_ < min_period_ || !pacer_.admit(messages.color->header.stamp, now))
      return monitor().dropped();
    try {
      bool changed = false;
      models(&changed);
      if (changed) build(parameters_.current());
      const std_msgs::Header& header = messages.color->header;
      FrameBundle bundle;
      bundle.images = {colorWithThreeChannels(messages.color), messages.depth,
                       withStamp(messages.camera_info, header.stamp)};
      const RgbdFrame frame = frameView(bundle.images);
      requireFit(frame);
      if (changed) to_search_.reset();
      const cv::Mat explained = explainedByTracks(now);
      const double stamp = header.stamp.toSec();
      const bool is_new =
          scene_change_.isNew(frame, now) && (explained.empty() || to_search_.isWorthALook(stamp, frame, explained));
      if (!changed && !is_new) return rest(messages.color->header.stamp);
      scene_change_.worked(frame, now);
      last_admitted_ = now;
      Segmentation segmentation = segmenter_->segment(depthInMetres(frame.depth), frame.depthCamera());
      if (!explained.empty()) {
        segmentation = to_search_.select(stamp, frame, segmentation, explained);
        if (segmentation.patches.empty()) return rest(messages.color->header.stamp);
      }
      const auto segmented = toMessage(segmentation, header);
      segmented->arrived.fromNSec(messages.arrived.toNSec());
      segmented->depth_stamp = messages.depth->header.stamp;
      bundle.segmentation = segmented;
      processed(header, watch.seconds());
      output_.publish(bundle);
      if (overlay_.getNumSubscribers() > 0) overlay_.publish(imageMessage(segmentOverlay(frame, segmentation), header));
    } catch (const std::exception& error) {
      pacer_.withdraw(messages.color->header.stamp);
      reject(camera_->topics(), error.what());
    }
  }

  /// A frame that shows nothing new.
  void rest(const ros::Time& stamp) {
    pacer_.withdraw(stamp);
    monitor().dropped();
    monitor().setValue("frames without change", std::to_string(++unchanged_));
  }

  Reconfigurable<rgbd_recognition::SegmentationConfig, SegmentationParameters> parameters_;
  bool begins_enabled_ = true;
  std::unique_ptr<Segmenter> segmenter_;
  std::unique_ptr<CameraInput> camera_;
  FramePacer pacer_{1, kAnswerPatience};
  ros::WallDuration min_period_;
  ros::WallTime last_admitted_;
  SceneChange scene_change_;
  std::uint64_t unchanged_ = 0;
  SegmentsToSearch to_search_{TrackingParameters().search_period};
  ros::Subscriber feedback_, explained_input_;
  sensor_msgs::ImageConstPtr explained_;  // of tracking; null: it told nothing yet
  ros::WallTime explained_arrived_;
  ros::WallTimer inputs_timer_;
  ros::ServiceServer enable_;
  FrameBundleOutput output_;
  image_transport::Publisher overlay_;
};

}  // namespace recognition

PLUGINLIB_EXPORT_CLASS(recognition::SegmentationNodelet, nodelet::Nodelet)
