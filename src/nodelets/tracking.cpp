#include <boost/make_shared.hpp>
#include <pluginlib/class_list_macros.hpp>
#include <tf2_ros/transform_listener.h>

#include "alignment/prepared_model.h"
#include "rgbd_recognition/annotation.h"
#include "ros/message_conversions.h"
#include "ros/camera_input.h"
#include "ros/detection_output.h"
#include "ros/frame_names.h"
#include "ros/made_ahead.h"
#include "ros/object_shape.h"
#include "ros/parameters.h"
#include "ros/shared_models.h"
#include "ros/stage_nodelet.h"
#include "ros/standard_outputs.h"
#include "ros/target_frame.h"
#include "ros/track_messages.h"
#include "tracking/object_tracker.h"

namespace recognition {
namespace {

constexpr const char* kVerification = "reprojection_verification";
constexpr double kTfPatience = 0.05;       // s: how late tf may be
constexpr std::uint32_t kResultQueue = 4;  // detections of earlier frames, which come in order

}  // namespace

/// Beside the pipeline: answers each frame of the camera with the tracks of what was detected, while the stages work on
/// an earlier frame; what they find there is brought to the present frame.
///
/// Threads: CameraInput pairs images in a thread of its own and hands over the newest frame (older ones are counted as
/// dropped); tf is heard in the threads of its listeners. All else, frames and the stages' detections, comes one after
/// another in this nodelet's single-threaded queue, so that the tracker needs no lock; the stages have queues of their
/// own, which other threads of the manager serve. Images are shared with the stages and never changed; copies are made only
/// of colour without three channels, and by CameraInput of raw colour with distortion.
class TrackingNodelet : public StageNodelet {
 private:
  void configure() override {
    ros::NodeHandle& node = getPrivateNodeHandle();
    readParameters(node, parameters_.list(), namesBesideTheCores());
    parameters_.validate();
    fixed_frame_ = plainFrame(parameterOr(node, "fixed_frame", std::string()));
    target_ = std::make_unique<TargetFrame>(parameterOr(node, "target_frame", std::string()));
    publishes_tf_ = parameterOr(node, "publish_tf", true);
    tf_prefix_ = plainFrame(parameterOr(node, "tf_prefix", std::string()));
    prepared_models_->setRecipe(sharedPreparedModels);
    openModels(MadeAhead<PreparedModels>::preparation(prepared_models_));
    bool changed = false;
    tracker_ = std::make_unique<ObjectTracker>(parameters_, verification(), prepared_models_->get(models(&changed)));
    camera_ = std::make_unique<CameraInput>(
        node, [this](const FrameMessages& frame) { onFrame(frame); },
        [this](const std::string& topics, const std::string& problem) { reject(topics, problem); },
        [this] { monitor().dropped(); });
  }

  static std::vector<std::string> namesBesideTheCores() {
    auto names = stageParameterNames();
    const auto& of_camera = CameraInput::parameterNames();
    names.insert(names.end(), of_camera.begin(), of_camera.end());
    names.insert(names.end(), {"fixed_frame", "publish_tf", "target_frame", "tf_prefix"});
    return names;
  }

  /// As the last stage has it: a track is tested as a detection is. What it reads beside is its own business.
  VerificationParameters verification() const {
    VerificationParameters parameters;
    const ros::NodeHandle node(getNodeHandle(), kVerification);
    ParameterList list = parameters.list();
    for (const Parameter& parameter : list)
      if (node.hasParam(parameter.name)) {
        const auto number = std::get_if<double*>(&parameter.value);
        if (number) **number = numberInRange(node, parameter.name, **number, parameter.min, parameter.max);
      }
    return parameters;
  }

  void advertise() override {
    ros::NodeHandle& node = getNodeHandle();
    tracks_ = advertiseLazy<messages::TrackArray>(node, "tracks");
    detections_ = advertiseLazy<messages::DetectionArray>(node, "detections");
    markers_ = advertiseLazy<visualization_msgs::MarkerArray>(node, "markers");
    annotated_ = advertiseLazyImage(node, "annotated");
    if (publishes_tf_) tf_ = advertiseLazy<tf2_msgs::TFMessage>(node, "/tf");
    standard_.advertise([&](auto message, const char* topic) { return advertiseLazy<decltype(message)>(node, topic); });
    // Not lazy: the first stage listens to it for as long as it works, which alone is no reason to track.
    explained_ = getPrivateNodeHandle().advertise<sensor_msgs::Image>("explained", 1);
  }

  void startInputs() override {
    if (!fixed_frame_.empty()) listener_ = std::make_unique<tf2_ros::TransformListener>(buffer_);
    results_ = getNodeHandle().subscribe(std::string(kVerification) + "/detections", kResultQueue,
                                         &TrackingNodelet::onDetections, this);
    camera_->subscribe(getNodeHandle());
  }

  void stopInputs() override {
    camera_->unsubscribe();
    results_.shutdown();
    listener_.reset();
  }

  /// What the stages found in an earlier frame: the next frame takes it.
  void onDetections(const messages::DetectionArrayConstPtr& message) {
    if (camera_frame_.empty()) return;  // no frame came yet that could be followed
    try {
      updateModels();
      messages::DetectionArray detections = *message;
      if (plainFrame(message->header.frame_id) != camera_frame_)
        changeFrame(cameraFrom(message->header), camera_frame_, &detections);
      tracker_->add(message->header.stamp.toSec(), detectionsFromMessage(detections, *database_));
    } catch (const std::exception& error) {
      reject(results_.getTopic(), error.what());
    }
  }

  /// camera_from_header, of results in the target frame. Throws std::runtime_error for another frame, or without tf.
  Pose cameraFrom(const std_msgs::Header& header) const {
    std_msgs::Header of_camera = header;
    of_camera.frame_id = camera_frame_;
    if (target_->nameFor(of_camera) != plainFrame(header.frame_id))
      throw std::runtime_error("detections come in '" + header.frame_id + "', neither the camera's frame '" +
                               camera_frame_ + "' nor target_frame");
    return target_->targetFromCamera(of_camera).inverse();
  }

  void updateModels() {
    bool changed = false;
    const auto database = models(&changed);
    if (database == database_) return;
    if (database_) tracker_->setModels(prepared_models_->get(database));
    database_ = database;
    marker_maker_ = {};
  }

  void onFrame(const FrameMessages& messages) {
    const Stopwatch watch;
    try {
      updateModels();
      FrameMessages images = messages;
      images.color = colorWithThreeChannels(messages.color);
      const std_msgs::Header& header = images.color->header;
      const RgbdFrame frame = frameView(images);
      camera_frame_ = plainFrame(header.frame_id);
      const Pose fixed_from_camera = fixedFromCamera(header);
      const TrackingOutcome outcome = tracker_->follow(header.stamp.toSec(), frame, fixed_from_camera);
      if (outcome.ignored) return monitor().dropped();
      if (outcome.restarted) NODELET_WARN("time went backwards: all tracks are given up");
      publish(outcome, messages, frame, fixed_from_camera);
      processed(header, watch.seconds());
      monitor().setValue("tracks", std::to_string(outcome.tracks.size()));
      monitor().setValue("detections that no frame showed any more", std::to_string(tracker_->dropped()));
    } catch (const std::exception& error) {
      reject(camera_->topics(), error.what());
    }
  }

  /// Throws tf2::TransformException: unknown frame, or no transform for that time.
  Pose fixedFromCamera(const std_msgs::Header& header) const {
    if (fixed_frame_.empty()) return Pose::Identity();
    return poseFromMessage(
        buffer_.lookupTransform(fixed_frame_, plainFrame(header.frame_id), header.stamp, ros::Duration(kTfPatience))
            .transform);
  }

  void publish(const TrackingOutcome& outcome, const FrameMessages& messages, const RgbdFrame& frame,
               const Pose& fixed_from_camera) {
    const std_msgs::Header& header = messages.color->header;
    const auto detections = detectionsOf(outcome, fixed_from_camera.inverse(), header);
    detections->arrived.fromNSec(messages.arrived.toNSec());
    shapes_.fillIn(*database_, detections.get());
    if (annotated_.getNumSubscribers() > 0) annotated_.publish(imageMessage(annotated(frame, *detections), header));
    if (!target_->isCamera(header))
      changeFrame(target_->targetFromCamera(header), target_->nameFor(header), detections.get());
    if (publishes_tf_) nameFrames(tf_prefix_, detections.get());
    if (publishes_tf_ && !detections->detections.empty()) tf_.publish(transformsOf(*detections));
    detections_.publish(detections);
    if (tracks_.getNumSubscribers() > 0) tracks_.publish(tracksOf(outcome, header));
    if (explained_.getNumSubscribers() > 0) explained_.publish(imageMessage(tracker_->explained(), header));
    standard_.publish(*detections, *database_);
    const LabelView view = target_->isCamera(header) ? LabelView::ofCamera(frame.color_camera) : LabelView();
    if (markers_.getNumSubscribers() > 0) markers_.publish(marker_maker_.make(*detections, *database_, view));
  }

  messages::TrackArrayPtr tracksOf(const TrackingOutcome& outcome, const std_msgs::Header& header) const {
    const auto message = boost::make_shared<messages::TrackArray>();
    message->header = header;
    if (!fixed_frame_.empty()) message->header.frame_id = fixed_frame_;
    const auto put = [&](const std::vector<Track>& tracks, std::vector<messages::Track>* into) {
      for (const Track& track : tracks) into->push_back(toMessage(track, publishes_tf_, tf_prefix_));
    };
    put(outcome.tracks, &message->tracks);
    put(outcome.found, &message->found);
    put(outcome.lost, &message->lost);
    return message;
  }

  /// Poses in the camera's frame.
  cv::Mat annotated(const RgbdFrame& frame, const messages::DetectionArray& detections) const {
    cv::Mat bgr = bgrCopy(frame);
    std::vector<Annotation> annotations;
    for (const messages::Detection& detection : detections.detections)
      annotations.push_back({database_->find(detection.object), poseFromMessage(detection.pose.pose),
                             nameWithConfidence(detection.object, detection.confidence)});
    drawAnnotations(bgr, annotations, *database_, frame.color_camera);
    return bgr;
  }

  TrackingParameters parameters_;
  std::unique_ptr<ObjectTracker> tracker_;
  std::shared_ptr<const ModelDatabase> database_;  // of the tracker; null before the first frame
  const std::shared_ptr<MadeAhead<PreparedModels>> prepared_models_ = std::make_shared<MadeAhead<PreparedModels>>();
  std::unique_ptr<CameraInput> camera_;
  ros::Subscriber results_;
  std::string camera_frame_;  // of the last image
  std::string fixed_frame_, tf_prefix_;
  std::unique_ptr<TargetFrame> target_;
  bool publishes_tf_ = true;
  tf2_ros::Buffer buffer_;
  std::unique_ptr<tf2_ros::TransformListener> listener_;
  ros::Publisher tracks_, detections_, markers_, tf_, explained_;
  image_transport::Publisher annotated_;
  StandardOutputs standard_;
  ObjectShapes shapes_;
  MarkerMaker marker_maker_;
};

}  // namespace recognition

PLUGINLIB_EXPORT_CLASS(recognition::TrackingNodelet, nodelet::Nodelet)
