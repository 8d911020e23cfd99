#include <algorithm>
#include <atomic>
#include <stdexcept>

#include <nodelet/nodelet.h>
#include <rgbd_recognition/DetectAction.h>
#include <pluginlib/class_list_macros.hpp>
#include <ros/callback_queue.h>
#include <ros/service.h>
#include <ros/spinner.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

#include "ros/messages.h"
#include "ros/absolute_path.h"
#include "ros/action_goals.h"
#include "ros/model_source.h"
#include "ros/parameters.h"

namespace recognition {
namespace {

constexpr double kTimeout = 10.0;  // seconds
constexpr double kMaxTimeout = 600.0;
constexpr const char* kGate = "segmentation/enable";
constexpr const char* kGateState = "segmentation/enabled";
constexpr double kFeedbackPeriod = 1.0;  // seconds, where nothing changes
constexpr const char* kFirstStage = "segmentation";
// Its work on a frame ends with verification's answer, so it reports after the last stage.
constexpr const char* kLateStage = "hypothesis_generation";
constexpr const char* kStagesWithModels[] = {"segmentation", "hypothesis_generation", "reprojection_verification"};

}  // namespace

/// Recognition on demand: one frame when asked (`detect`, as a service and as an action), or `start` and `stop`;
/// `reload` of all stages' models. Calls and goals wait for other nodelets, so they have a thread of their own: in a
/// manager's thread they would hold up what they wait for.
class OnDemandNodelet : public nodelet::Nodelet {
 public:
  ~OnDemandNodelet() override {
    unloaded_ = true;
    for (ros::ServiceServer* service : {&detect_, &start_, &stop_, &reload_}) service->shutdown();
    thread_.stop();
  }

 private:
  using Run = ActionRun<messages::DetectAction>;

  /// Ended by wish, not by a fault.
  class Cancelled : public std::runtime_error {
   public:
    Cancelled() : std::runtime_error("cancelled") {}
  };

  void onInit() override {
    ros::NodeHandle node(getNodeHandle());
    node.setCallbackQueue(&calls_);
    thread_.start();
    detect_ = node.advertiseService("detect", &OnDemandNodelet::detect, this);
    start_ = node.advertiseService("start", &OnDemandNodelet::start, this);
    stop_ = node.advertiseService("stop", &OnDemandNodelet::stop, this);
    reload_ = node.advertiseService("reload", &OnDemandNodelet::reload, this);
    detect_goals_.serve(getNodeHandle(), "detect", &calls_,
                        [this](Run& run, messages::DetectResult* result) { answer(run.goal(), &run, result); });
  }

  bool detect(messages::Detect::Request& request, messages::Detect::Response& response) {
    answer(request, nullptr, &response);
    return true;
  }

  /// The service's answer or the action's result, for its request or goal; `run` is null for the service.
  template <typename Request, typename Response>
  void answer(const Request& request, Run* run, Response* response) {
    try {
      requireModels(request.objects);
      const double timeout = request.timeout == 0.0 ? kTimeout : request.timeout;
      if (!(timeout > 0.0 && timeout <= kMaxTimeout))
        throw std::invalid_argument("timeout " + std::to_string(timeout) + ": must be in (0, 600] seconds");
      const auto found = nextAnswer(timeout, run);
      response->result.header = found->header;
      response->result.arrived = found->arrived;
      for (const messages::Detection& detection : found->detections)
        if (request.objects.empty() || isIn(request.objects, detection.object))
          response->result.detections.push_back(detection);
      response->result.left_out = found->left_out;
      response->success = 1;
    } catch (const std::exception& error) {
      response->message = error.what();
    }
  }

  static bool isIn(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  }

  /// Throws std::exception that says why if there are no models to recognise, or not all that are asked for.
  void requireModels(const std::vector<std::string>& objects) {
    std::string key;
    if (!getPrivateNodeHandle().searchParam("models", key)) throw std::invalid_argument("models is not set");
    const auto source = ModelSource::open(absolutePath(requiredString(getPrivateNodeHandle(), key)));
    source->reload();  // what was trained a moment ago counts
    const auto loaded = source->current();
    if (loaded->database->objects.empty())
      throw std::runtime_error(source->directory() + " holds no models that can be loaded: train some" +
                               whyNot(*loaded));
    for (const std::string& object : objects)
      if (loaded->database->find(object) < 0)
        throw std::invalid_argument(source->directory() + " has no model named '" + object + "'" + whyNot(*loaded));
  }

  static std::string whyNot(const LoadedModels& loaded) {
    std::string text;
    for (const std::string& error : loaded.errors) text += "; skipped: " + error;
    return text;
  }

  /// What a goal's client is told while it waits: which stages its frame has passed.
  class Wait {
   public:
    Wait(Run* run, ros::NodeHandle& node) : run_(run) {
      if (!run_) return;
      feedback_.stage = "waiting";
      const boost::function<void(const messages::StageTimingConstPtr&)> passed =
          [this](const messages::StageTimingConstPtr& timing) { onTiming(*timing); };
      timing_ = node.subscribe("timing", 20, passed);
      tell();
    }

    /// To be called now and then. Throws Cancelled.
    void look() {
      if (!run_) return;
      if (run_->cancelled()) throw Cancelled();
      if ((ros::WallTime::now() - told_).toSec() >= kFeedbackPeriod) tell();
    }

   private:
    void onTiming(const messages::StageTiming& timing) {
      if (timing.stage == kLateStage) return;
      if (timing.stage == kFirstStage) ++feedback_.frames;
      if (feedback_.frames == 0) return;  // of a frame from before
      feedback_.stage = timing.stage;
      tell();
    }

    void tell() {
      told_ = ros::WallTime::now();
      feedback_.seconds = (told_ - begun_).toSec();
      run_->tell(feedback_);
    }

    Run* const run_;
    const ros::WallTime begun_ = ros::WallTime::now();
    ros::WallTime told_;
    messages::DetectFeedback feedback_;
    ros::Subscriber timing_;
  };

  /// The answer to the first frame that arrives from now on; further calls wait for this one. By arrival and not by
  /// stamp, as a camera's clock, or a recording's, need not be this machine's.
  messages::DetectionArrayConstPtr nextAnswer(double timeout, Run* run) {
    ros::CallbackQueue queue;
    ros::NodeHandle node(getNodeHandle());
    node.setCallbackQueue(&queue);
    const ros::WallTime asked = ros::WallTime::now();
    messages::DetectionArrayConstPtr answer;
    const boost::function<void(const messages::DetectionArrayConstPtr&)> arrived =
        [&](const messages::DetectionArrayConstPtr& array) {
          if (!answer && array->arrived.toNSec() >= asked.toNSec()) answer = array;
        };
    Wait wait(run, node);
    const ros::Subscriber subscriber = node.subscribe("detections", 1, arrived);
    const OpenGate gate(*this);
    const ros::WallTime end = asked + ros::WallDuration(timeout);
    while (!answer && ros::ok() && !unloaded_ && ros::WallTime::now() < end) {
      queue.callAvailable(ros::WallDuration(0.05));
      wait.look();
    }
    if (!answer)
      throw std::runtime_error("no frame was answered within " + std::to_string(timeout) +
                               " s; `rosrun rgbd_recognition doctor` looks for the reason");
    return answer;
  }

  /// Opens the gate, also where it is open, as the next frame counts although it may show nothing new. At the end of
  /// the scope it is as it was.
  class OpenGate {
   public:
    explicit OpenGate(OnDemandNodelet& nodelet)
        : nodelet_(nodelet), stopped_(!nodelet.getNodeHandle().param(kGateState, true)) {
      nodelet_.setGate(true);
    }
    ~OpenGate() {
      try {
        if (stopped_) nodelet_.setGate(false);
      } catch (const std::exception& error) {
        ROS_ERROR_NAMED(nodelet_.getName(), "recognition goes on, although it was stopped: %s", error.what());
      }
    }

   private:
    OnDemandNodelet& nodelet_;
    const bool stopped_;
  };

  void setGate(bool open) {
    std_srvs::SetBool change;
    change.request.data = open ? 1 : 0;
    const std::string name = getNodeHandle().resolveName(kGate);
    if (!ros::service::call(name, change)) throw std::runtime_error(name + " does not answer: is the nodelet loaded?");
  }

  bool start(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) { return change(true, &response); }
  bool stop(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) { return change(false, &response); }

  bool change(bool open, std_srvs::Trigger::Response* response) {
    try {
      setGate(open);
      response->success = 1;
      response->message = open ? "recognises every frame that somebody listens to" : "stopped";
    } catch (const std::exception& error) {
      response->message = error.what();
    }
    return true;
  }

  bool reload(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    response.success = 1;
    for (const char* stage : kStagesWithModels) {
      const std::string name = getNodeHandle().resolveName(stage) + "/reload";
      std_srvs::Trigger trigger;
      const bool called = ros::service::call(name, trigger);
      if (!called || !trigger.response.success) response.success = 0;
      response.message += std::string(response.message.empty() ? "" : "; ") + stage + ": " +
                          (called ? trigger.response.message : name + " does not answer");
    }
    return true;
  }

  std::atomic<bool> unloaded_{false};
  ActionGoals<messages::DetectAction> detect_goals_;  // ends after the thread below
  ros::CallbackQueue calls_;
  ros::AsyncSpinner thread_{1, &calls_};
  ros::ServiceServer detect_, start_, stop_, reload_;
};

}  // namespace recognition

PLUGINLIB_EXPORT_CLASS(recognition::OnDemandNodelet, nodelet::Nodelet)
