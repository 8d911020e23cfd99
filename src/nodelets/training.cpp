#include <rgbd_recognition/TrainObjectAction.h>
#include <ros/callback_queue.h>
#include <ros/spinner.h>
#include <std_srvs/Trigger.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <pluginlib/class_list_macros.hpp>

#include "ros/absolute_path.h"
#include "ros/action_goals.h"
#include "ros/camera_input.h"
#include "ros/parameters.h"
#include "ros/same_fields.h"
#include "ros/stage_nodelet.h"
#include "ros/training_frames.h"
#include "ros/training_session.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition {
namespace {

using messages::TrainObjectRequest;
using messages::TrainObjectResponse;

constexpr double kLiveSeconds = 120.0;  // of a live training that names no limit
constexpr double kFrameTimeout = 10.0;  // seconds without a frame, or a pose by tf, that end a live training
const ros::WallDuration kWatchInterval(0.1);
const ros::WallDuration kPreviewInterval(0.2);

}  // namespace

/// Trains objects on request and keeps the model store.
///
/// Threads: a training takes as long as it takes, so ~train_object, service and action, has a queue and two threads of
/// its own, one that trains and one that refuses what else is asked meanwhile; ~cancel, goals as they arrive and all
/// others stay in the nodelet's queue, as does the camera, which hands its newest frame over. Recognition notices a new
/// model by itself (see ModelSource).
class TrainingNodelet : public StageNodelet {
 public:
  ~TrainingNodelet() override {
    work_ = Work::kLeaving;
    frames_.close();
    services_.clear();  // waits for a training in work
    if (spinner_) spinner_->stop();
  }

 private:
  /// One value, so that a cancel meets the training that it was meant for, or none.
  enum class Work { kIdle, kTraining, kCancelled, kLeaving };  // kLeaving: the nodelet is being unloaded

  using Run = ActionRun<messages::TrainObjectAction>;

  bool cancelled() const {
    const Work now = work_;
    return now == Work::kCancelled || now == Work::kLeaving;
  }

  void configure() override {
    ros::NodeHandle& node = getPrivateNodeHandle();
    std::string key;
    if (!node.searchParam("models", key))
      throw std::invalid_argument(node.resolveName("models") + " is not set: it names the folder of trained models");
    store_ = absolutePath(requiredString(node, key));
    folder_ = parameterOr(node, "folder", std::string());
    std::filesystem::create_directories(store_);
    boards_ = parameterOr(node, "boards", std::string());
    board_ = parameterOr(node, "board", std::string("charuco"));
    outputs_.board_frame = parameterOr(node, "board_frame", std::string("training_board"));
    live_source_ = getNodeHandle().resolveName("rgb/image_rect_color");
    const ros::NodeHandle parameters(node, "parameters");
    readParameters(ros::NodeHandle(parameters, "feature_extraction"), settings_.features.list(), stageParameterNames());
    readParameters(ros::NodeHandle(parameters, "recording"), settings_.recording.list(), {});
    readParameters(ros::NodeHandle(parameters, "meshes"), settings_.meshes.list(), {});
    ObjectTrainer(store_, settings_);  // checks the parameters, and that the store can be written
    camera_ = std::make_unique<CameraInput>(
        node, [this](const FrameMessages& frame) { onFrame(frame); },
        [this](const std::string& topics, const std::string& problem) { onCameraProblem(topics, problem); },
        [this] { monitor().dropped(); });
  }

  void advertise() override {
    ros::NodeHandle& node = getPrivateNodeHandle();
    outputs_.view = advertiseLazyImage(node, "view");
    outputs_.live_cloud = advertiseLazy<sensor_msgs::PointCloud2>(node, "live_cloud");
    outputs_.coverage = image_transport::ImageTransport(node).advertise("coverage", 1, true);
    outputs_.cloud = node.advertise<sensor_msgs::PointCloud2>("cloud", 1, true);
    outputs_.object = node.advertise<sensor_msgs::PointCloud2>("object", 1, true);
    outputs_.object_markers = node.advertise<visualization_msgs::MarkerArray>("object_markers", 1, true);
    outputs_.progress = node.advertise<messages::TrainingProgress>("progress", 100, true);
    outputs_.tf = node.advertise<tf2_msgs::TFMessage>("/tf", 10);
    services_ = {node.advertiseService("list_objects", &TrainingNodelet::listObjects, this),
                 node.advertiseService("remove_object", &TrainingNodelet::removeObject, this),
                 node.advertiseService("rename_object", &TrainingNodelet::renameObject, this),
                 node.advertiseService("get_object", &TrainingNodelet::getObject, this),
                 node.advertiseService("cancel", &TrainingNodelet::cancel, this)};
    training_node_ = node;
    training_node_.setCallbackQueue(&training_queue_);
    bool (TrainingNodelet::*const train_object)(TrainObjectRequest&, TrainObjectResponse&) =
        &TrainingNodelet::trainObject;
    services_.push_back(training_node_.advertiseService("train_object", train_object, this));
    goals_.serve(node, "train_object", &training_queue_,
                 [this](Run& run, messages::TrainObjectResult* result) { trainObject(run, result); });
    spinner_ = std::make_unique<ros::AsyncSpinner>(2, &training_queue_);
    spinner_->start();
    camera_timer_ =
        getNodeHandle().createWallTimer(kWatchInterval, [this](const ros::WallTimerEvent&) { useCamera(); });
  }

  // The camera is subscribed to while somebody looks or a live training is in work: in the nodelet's own queue only.
  void startInputs() override { watched_ = true; }
  void stopInputs() override { watched_ = false; }

  void useCamera() {
    outputs_.showWaiting();
    const bool wanted = watched_ || frames_.isOpen();
    if (wanted == subscribed_) return;
    subscribed_ = wanted;
    wanted ? camera_->subscribe(getNodeHandle()) : camera_->unsubscribe();
  }

  void onCameraProblem(const std::string& topics, const std::string& problem) {
    reject(topics, problem);
    const std::lock_guard<std::mutex> lock(problem_mutex_);
    camera_problem_ = topics + ": " + problem;
  }

  void onFrame(const FrameMessages& messages) {
    const Stopwatch watch;
    frames_.offer(messages);
    if (work_ != Work::kIdle) return;  // which shows what it takes
    const ros::WallTime now = ros::WallTime::now();
    if (!outputs_.viewWanted() || now - previewed_ < kPreviewInterval) return;
    previewed_ = now;
    try {
      const FrameMessages frame{colorWithThreeChannels(messages.color), messages.depth, messages.camera_info};
      preview({frameView(frame), std::nullopt, {}}, messages.color->header);
      processed(messages.color->header, watch.seconds());
    } catch (const std::exception& error) {
      reject(camera_->topics(), error.what());
    }
  }

  // Shows whether the board is seen and what stands on it, before a training.
  void preview(RecordedView view, const std_msgs::Header& header) {
    const cv::Mat gray = toGray(view.frame.color, view.frame.color_order);
    const auto board = detectBoard(boardNamed(""), gray, view.frame.color_camera);
    if (board) view.camera_from_world = board->camera_from_board;
    outputs_.showView(view, settings_.recording, header, board ? "board seen" : "no board seen");
  }

  FiducialBoard boardNamed(const std::string& asked) const {
    const std::string& name = asked.empty() ? board_ : asked;
    const auto ends_in = [&](const std::string& end) {
      return name.size() > end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
    };
    if (name.find('/') != std::string::npos || ends_in(".yaml")) return FiducialBoard::fromYaml(inFolder(name));
    requireObjectName(name);
    if (boards_.empty())
      throw std::invalid_argument("board '" + name + "' is no path, and ~boards, their folder, is not set");
    return FiducialBoard::fromYaml(boards_ + "/" + name + ".yaml");
  }

  /// A path that was asked for, as ours.
  std::string inFolder(const std::string& path) const { return absolutePath(path, folder_); }

  bool trainObject(TrainObjectRequest& request, TrainObjectResponse& response) {
    response = trained(request, nullptr);
    return true;
  }

  void trainObject(Run& run, messages::TrainObjectResult* result) {
    *result = withFieldsOf<messages::TrainObjectResult>(trained(withFieldsOf<TrainObjectRequest>(run.goal()), &run));
  }

  /// The service's answer; `run` is the action's goal, null for the service.
  TrainObjectResponse trained(TrainObjectRequest request, Run* run) {
    TrainObjectResponse response;
    request.file = inFolder(request.file);
    Work idle = Work::kIdle;
    if (!work_.compare_exchange_strong(idle, Work::kTraining)) {
      response.message = "another training is in work; ~cancel ends it";
      return response;
    }
    if (run) run->whenCancelled([this] { cancelTraining(); });
    try {
      const TrainingTask task =
          taskFromMessage(request, live_source_ + " at " + std::to_string(ros::WallTime::now().toSec()));
      TrainingSession session(
          task.name, settings_.recording, outputs_, [this] { return cancelled(); }, listenerOf(run));
      train(request, task, session, response);
    } catch (const std::exception& error) {
      response.message = error.what();
    }
    if (run) run->whenCancelled(nullptr);  // before another training can begin
    frames_.close();
    if (!response.success) NODELET_ERROR("not trained: %s", response.message.c_str());
    for (Work now : {Work::kTraining, Work::kCancelled}) work_.compare_exchange_strong(now, Work::kIdle);
    return response;
  }

  static TrainingSession::Listener listenerOf(Run* run) {
    if (!run) return nullptr;
    return [run](const messages::TrainingProgress& progress) {
      messages::TrainObjectFeedback feedback;
      feedback.progress = progress;
      run->tell(feedback);
    };
  }

  void train(const TrainObjectRequest& request, const TrainingTask& task, TrainingSession& session,
             TrainObjectResponse& response) {
    try {
      ObjectTrainer trainer(store_, settings_);
      TrainingOutcome outcome;
      if (request.source == TrainObjectRequest::MESH)
        outcome = trainer.trainFromMesh(task, request.file, request.unit > 0.0 ? request.unit : 1.0, session,
                                        meshOptionsOf(request));
      else
        outcome = trainer.trainFromViews(task, boardOf(request), viewsOf(request, session), session);
      fillResponse(outcome, &response);
      outputs_.showModel(outcome.model, session.header());
      session.tell("done", 1.0, response.message);
    } catch (const std::exception& error) {
      session.tell("failed", 0.0, error.what());
      throw;
    }
  }

  std::optional<FiducialBoard> boardOf(const TrainObjectRequest& request) const {
    if (!request.object_frame.empty()) return std::nullopt;
    return boardNamed(request.board);
  }

  ViewSource viewsOf(const TrainObjectRequest& request, TrainingSession& session) {
    return request.source == TrainObjectRequest::BAG ? bagViews(request, session) : liveViews(request, session);
  }

  static ViewSource bagViews(const TrainObjectRequest& request, TrainingSession& session) {
    const auto bag = std::make_shared<BagViews>(request);
    session.setShare([bag](std::uint32_t) { return bag->done(); });
    return [bag, &session](RecordedView* view) {
      const bool more = bag->next(view);
      session.setHeader(bag->header());
      return more;
    };
  }

  ViewSource liveViews(const TrainObjectRequest& request, TrainingSession& session) {
    std::shared_ptr<const TfPoses> poses;
    if (!request.object_frame.empty()) poses = std::make_shared<TfPoses>(request);
    frames_.open();
    if (cancelled()) throw TrainingCancelled();  // before it, with nothing to close
    const ros::WallTime start = ros::WallTime::now();
    const ros::WallTime end = start + ros::WallDuration(request.seconds > 0.0 ? request.seconds : kLiveSeconds);
    const auto current = std::make_shared<FrameMessages>();
    session.setShare([request](std::uint32_t used) { return request.views > 0 ? double(used) / request.views : 0.0; });
    session.tell("waiting", 0.0, "for frames of " + live_source_);
    return [this, request, start, end, current, poses, &session](RecordedView* view) {
      const double left = (end - ros::WallTime::now()).toSec();
      if (left <= 0.0 || (request.views > 0 && session.used() >= request.views)) return false;
      const auto frame = frames_.take(std::min(left, kFrameTimeout));
      if (cancelled()) throw TrainingCancelled();
      if (!frame) {
        if (session.used() == 0) throw std::invalid_argument("no frame came: " + cameraProblem());
        return false;
      }
      session.setHeader(frame->color->header);
      try {
        *current = {colorWithThreeChannels(frame->color), frame->depth, frame->camera_info};
        *view = {frameView(*current), std::nullopt, {}};
        if (poses) view->camera_from_world = poses->cameraFromWorld(frame->color->header);
      } catch (const std::exception& error) {  // this frame only, unless none is better
        if (session.used() == 0 && (ros::WallTime::now() - start).toSec() > kFrameTimeout)
          throw std::invalid_argument(error.what());
        session.tell("views", 0.0, error.what());
        throw std::runtime_error(error.what());
      }
      return true;
    };
  }

  std::string cameraProblem() {
    const std::lock_guard<std::mutex> lock(problem_mutex_);
    return camera_problem_.empty() ? live_source_ : camera_problem_;
  }

  bool listObjects(messages::ListObjectsRequest&, messages::ListObjectsResponse& response) {
    const ModelStore store(store_);
    for (const std::string& name : store.names()) {
      try {
        response.objects.push_back(summaryOf(store.load(name)));
      } catch (const std::exception& error) {
        response.objects.emplace_back();
        response.objects.back().name = name;
        response.objects.back().problem = error.what();
      }
    }
    return true;
  }

  /// What changes the store: does it and says how it went.
  template <typename Response, typename Work>
  bool answer(Response& response, const Work& work) {
    try {
      response.message = work();
      response.success = 1;
    } catch (const std::exception& error) {
      response.message = error.what();
    }
    return true;
  }

  bool removeObject(messages::RemoveObjectRequest& request, messages::RemoveObjectResponse& response) {
    return answer(response, [&] {
      ModelStore(store_).remove(request.name);
      return request.name + " is removed";
    });
  }

  bool renameObject(messages::RenameObjectRequest& request, messages::RenameObjectResponse& response) {
    return answer(response, [&] {
      ModelStore(store_).rename(request.name, request.new_name);
      return request.name + " is now " + request.new_name;
    });
  }

  bool getObject(messages::GetObjectRequest& request, messages::GetObjectResponse& response) {
    return answer(response, [&] {
      const ObjectModel model = ModelStore(store_).load(request.name);
      std_msgs::Header header;
      header.stamp = ros::Time::now();
      outputs_.showModel(model, header);
      header.frame_id = model.name;
      response.cloud = cloudMessage(model.cloud, header);
      response.summary = summaryOf(model);
      return describe(model);
    });
  }

  bool cancel(std_srvs::TriggerRequest&, std_srvs::TriggerResponse& response) {
    response.success = cancelTraining();
    response.message = response.success ? "the training ends as soon as it can" : "no training is in work";
    return true;
  }

  /// False if there is none.
  bool cancelTraining() {
    Work training = Work::kTraining;
    const bool found = work_.compare_exchange_strong(training, Work::kCancelled) || training == Work::kCancelled;
    if (found) frames_.close();
    return found;
  }

  std::string store_, boards_, board_;
  std::string folder_;       // that relative paths are below
  std::string live_source_;  // topics
  TrainingSettings settings_;
  std::unique_ptr<CameraInput> camera_;
  ros::WallTimer camera_timer_;
  std::atomic<bool> watched_{false};
  bool subscribed_ = false;
  ros::WallTime previewed_;
  std::mutex problem_mutex_;  // guards camera_problem_
  std::string camera_problem_;

  std::atomic<Work> work_{Work::kIdle};
  LatestFrame frames_;  // from the nodelet's queue to the training
  TrainingOutputs outputs_;
  ActionGoals<messages::TrainObjectAction> goals_;
  ros::CallbackQueue training_queue_;
  ros::NodeHandle training_node_;
  std::unique_ptr<ros::AsyncSpinner> spinner_;
  std::vector<ros::ServiceServer> services_;
};

}  // namespace recognition

PLUGINLIB_EXPORT_CLASS(recognition::TrainingNodelet, nodelet::Nodelet)
