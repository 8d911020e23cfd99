#include <optional>

#include <pluginlib/class_list_macros.hpp>
#include <rgbd_recognition/HypothesisGenerationConfig.h>

#include "rgbd_recognition/matching/hypothesis_generator.h"
#include "rgbd_recognition/recognizer.h"
#include "rgbd_recognition/ros/frame_bundle.h"
#include "rgbd_recognition/ros/made_ahead.h"
#include "rgbd_recognition/ros/message_conversions.h"
#include "rgbd_recognition/ros/reconfigurable.h"
#include "rgbd_recognition/ros/stage_nodelet.h"

namespace rgbd_recognition {

/// Third stage, Sec. V: matches features and proposes objects with poses. Works on one frame until verification says it
/// is finished, round by round; of the frames that come meanwhile the newest waits.
class HypothesisGenerationNodelet : public StageNodelet {
 private:
  /// A frame in work.
  struct Work {
    FrameBundle bundle;
    std::shared_ptr<const ModelDatabase> database;
    std::uint64_t revision = 0;  // of the database
    std::shared_ptr<const HypothesisGenerator> generator;
    SceneFeatures features;  // a view of the bundle's message
    SceneMatches matches;
    int color_per_depth = 1;
    int round = 0;
    double seconds = 0.0;
    ros::WallTime asked = ros::WallTime::now();  // when verification got the present round
  };

  void configure() override {
    ros::NodeHandle& node = getPrivateNodeHandle();
    openModels(MadeAhead<HypothesisGenerator>::preparation(generators_));
    parameters_.read(node, namesBesideTheCores(),
                     [this](const MatchingParameters& parameters) { build(parameters, descriptor_); });
    feedback_timeout_ = ros::WallDuration(numberInRange(node, "feedback_timeout", 2.0, 0.01, 60.0));
  }

  void advertise() override {
    ros::NodeHandle& node = getPrivateNodeHandle();
    parameters_.serve(node);
    output_.advertise([&](auto message, const char* topic) { return advertiseLazy<decltype(message)>(node, topic); },
                      true);
    hypotheses_ = advertiseLazy<messages::HypothesisArray>(node, "hypotheses");
  }

  static std::vector<std::string> namesBesideTheCores() {
    auto names = stageParameterNames();
    names.push_back("feedback_timeout");
    return names;
  }

  void startInputs() override {
    input_.subscribe(getNodeHandle(), "feature_extraction", true,
                     [this](const FrameBundle& bundle) { onFrame(bundle); });
    feedback_ = getNodeHandle().subscribe("reprojection_verification/feedback", 2,
                                          &HypothesisGenerationNodelet::onFeedback, this);
  }

  void stopInputs() override {
    input_.unsubscribe();
    feedback_.shutdown();
    work_.reset();
    waiting_.reset();
  }

  /// The index over all models' descriptors; throws if they lack this type.
  void build(const MatchingParameters& parameters, DescriptorType descriptor) {
    const auto make = [parameters, descriptor](const std::shared_ptr<const ModelDatabase>& database) {
      return std::make_shared<const HypothesisGenerator>(parameters, database, descriptor);
    };
    bool changed = false;
    const auto database = models(&changed);
    generators_->setRecipe(make, database, make(database));
    descriptor_ = descriptor;
  }

  void onFrame(const FrameBundle& bundle) {
    if (work_ && ros::WallTime::now() - work_->asked < feedback_timeout_) {
      if (waiting_) monitor().dropped();
      waiting_ = bundle;
      return;
    }
    if (work_) reject(feedback_.getTopic(), "no answer for a frame in time; it is given up");
    start(bundle);
  }

  void start(const FrameBundle& bundle) {
    const Stopwatch watch;
    try {
      auto work = std::make_unique<Work>();
      work->bundle = bundle;
      work->features = fromMessage(*bundle.features);
      work->color_per_depth = frameView(bundle.images).colorPerDepthPixel();
      bool changed = false;
      work->database = models(&changed);
      work->revision = modelsRevision();
      if (work->features.image.type != descriptor_) build(parameters_.current(), work->features.image.type);
      work->generator = generators_->get(work->database);
      work->matches = work->generator->match(work->features);
      output_.publish(bundle);
      propose(*work, {}, {}, watch);
      work_ = std::move(work);
    } catch (const std::exception& error) {
      work_.reset();
      reject("feature_extraction", error.what());
    }
  }

  void propose(Work& work, const std::vector<std::uint8_t>& active, const std::vector<int>& objects,
               const Stopwatch& watch) {
    GenerationReport report;
    const auto hypotheses = work.generator->generate(work.features, work.matches, active, objects, work.round, &report);
    const auto message = toMessage(hypotheses, work.round, *work.database, work.bundle.header());
    message->models = work.revision;
    message->cut_short = objectNames(report.objects_cut_short, *work.database);
    work.seconds += watch.seconds();
    work.asked = ros::WallTime::now();
    hypotheses_.publish(message);
  }

  void onFeedback(const messages::FeedbackConstPtr& feedback) {
    const Stopwatch watch;
    if (!work_ || feedback->header.stamp != work_->bundle.header().stamp ||
        static_cast<int>(feedback->round) != work_->round)
      return;
    try {
      if (!feedback->finished) {
        const auto active = activeFeatures(work_->features, maskView(feedback->explained), work_->color_per_depth);
        ++work_->round;
        return propose(*work_, active, objectIndices(feedback->candidates, *work_->database), watch);
      }
      processed(work_->bundle.header(), work_->seconds, work_->round + 1);
    } catch (const std::exception& error) {
      reject(feedback_.getTopic(), error.what());
    }
    work_.reset();
    if (const auto next = std::exchange(waiting_, std::nullopt)) start(*next);
  }

  Reconfigurable<HypothesisGenerationConfig, MatchingParameters> parameters_;
  DescriptorType descriptor_ = FeatureParameters().descriptor;
  const std::shared_ptr<MadeAhead<HypothesisGenerator>> generators_ = std::make_shared<MadeAhead<HypothesisGenerator>>();
  ros::WallDuration feedback_timeout_;
  FrameBundleInput input_;
  FrameBundleOutput output_;
  ros::Publisher hypotheses_;
  ros::Subscriber feedback_;
  std::unique_ptr<Work> work_;
  std::optional<FrameBundle> waiting_;
};

}  // namespace rgbd_recognition

PLUGINLIB_EXPORT_CLASS(rgbd_recognition::HypothesisGenerationNodelet, nodelet::Nodelet)
