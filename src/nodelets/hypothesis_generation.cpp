#include <optional>

#include <pluginlib/class_list_macros.hpp>
#include <rgbd_recognition/HypothesisGenerationConfig.h>

#include "features/active_features.h"
#include "features/feature_extractor.h"
#include "matching/hypothesis_generator.h"
#include "ros/frame_bundle.h"
#include "ros/hypothesis_shards.h"
#include "ros/made_ahead.h"
#include "ros/message_conversions.h"
#include "ros/reconfigurable.h"
#include "ros/stage_nodelet.h"
#include "rgbd_recognition/matching/scene_matches.h"
#include "rgbd_recognition/features/feature_parameters.h"

namespace recognition {
namespace {

constexpr const char* kStage = "hypothesis_generation";
constexpr const char* kShardTopic = "hypothesis_generation/shards";  // what the other shards find
constexpr int kMaxShards = 64;
const ros::WallDuration kPatience(3.0);
constexpr std::uint32_t kBegun = 0xffffffff;  // as the round of feedback: verification has got the frame
constexpr std::uint32_t kMaxRounds = 1000;    // of a frame; more is no feedback of ours

}  // namespace

/// Third stage, Sec. V: matches features and proposes objects with poses. Works on one frame until verification says it
/// is finished, round by round; of the frames that come meanwhile the newest waits.
///
/// The objects may be split over several such nodelets, the shards, on one or several machines. The first one
/// (~shard 0) stands in the pipeline: it hands each frame that it takes to the others, waits for what they find, and
/// passes all on together. The others take frames, rounds and parameters from where the first one does, whose name must
/// be hypothesis_generation.
class HypothesisGenerationNodelet : public StageNodelet {
 private:
  /// The objects that are searched for.
  struct Searched {
    Searched(const MatchingParameters& parameters, const ModelDatabase& objects, DescriptorType descriptor)
        : database(std::make_shared<const ModelDatabase>(objects)), generator(parameters, database, descriptor) {}

    std::shared_ptr<const ModelDatabase> database;
    HypothesisGenerator generator;
  };

  /// A frame in work.
  struct Work {
    FrameBundle bundle;
    std::uint64_t revision = 0;  // of the models
    std::shared_ptr<const Searched> searched;
    SceneFeatures features;  // a view of the bundle's message
    SceneMatches matches;
    int color_per_depth = 1;
    int round = 0;
    bool proposed = false;  // the first shard: the round's hypotheses are passed on
    double seconds = 0.0;
    bool begun = false;  // by verification
    ros::WallTime asked = ros::WallTime::now();
  };

  void configure() override {
    ros::NodeHandle& node = getPrivateNodeHandle();
    objects_.shards = static_cast<int>(numberInRange(node, "shards", 1, 1, kMaxShards));
    objects_.shard = static_cast<int>(numberInRange(node, "shard", 0, 0, objects_.shards - 1));
    objects_.names = parameterOr(node, "objects", objects_.names);
    shard_timeout_ = ros::WallDuration(numberInRange(node, "shard_timeout", 0.5, 0.01, 60.0));
    results_ = ShardResults(objects_.shards);
    openModels(MadeAhead<Searched>::preparation(searched_));
    parameters_.read(isFirst() ? node : ros::NodeHandle(getNodeHandle(), kStage), namesBesideTheCores(),
                     [this](const MatchingParameters& parameters) { build(parameters, descriptor_); });
  }

  void advertise() override {
    ros::NodeHandle& node = getPrivateNodeHandle();
    if (!isFirst()) {
      hypotheses_ = advertiseLazy<messages::HypothesisArray>(getNodeHandle(), kShardTopic);
      return;
    }
    parameters_.serve(node);
    output_.advertise([&](auto message, const char* topic) { return advertiseLazy<decltype(message)>(node, topic); },
                      true);
    hypotheses_ = advertiseLazy<messages::HypothesisArray>(node, "hypotheses");
  }

  static std::vector<std::string> namesBesideTheCores() {
    auto names = stageParameterNames();
    names.insert(names.end(), {"objects", "shard", "shard_timeout", "shards"});
    return names;
  }

  void startInputs() override {
    input_.subscribe(getNodeHandle(), isFirst() ? "feature_extraction" : kStage, true,
                     [this](const FrameBundle& bundle) { isFirst() ? onFrame(bundle) : start(bundle); });
    if (isFirst() && objects_.shards > 1)
      others_ = getNodeHandle().subscribe(kShardTopic, kMaxShards, &HypothesisGenerationNodelet::onOthers, this);
    feedback_ = getNodeHandle().subscribe("reprojection_verification/feedback", 2,
                                          &HypothesisGenerationNodelet::onFeedback, this);
  }

  void stopInputs() override {
    input_.unsubscribe();
    feedback_.shutdown();
    others_.shutdown();
    waiting_for_others_.stop();
    work_.reset();
    waiting_.reset();
  }

  bool isFirst() const { return objects_.shard == 0; }

  /// The index over the models' descriptors; throws if they lack this type.
  void build(const MatchingParameters& parameters, DescriptorType descriptor) {
    const auto make = [parameters, descriptor, objects = objects_](const std::shared_ptr<const ModelDatabase>& all) {
      return std::make_shared<const Searched>(parameters, objects.select(*all), descriptor);
    };
    bool changed = false;
    const auto database = models(&changed);
    searched_->setRecipe(make, database, make(database));
    descriptor_ = descriptor;
  }

  void onFrame(const FrameBundle& bundle) {
    // A slow verification is waited for, however long it takes; one that is gone answers nothing any more.
    // One that has not even begun after some seconds never got the frame: it connected while it was on its way.
    const bool is_missed = work_ && !work_->begun && ros::WallTime::now() - work_->asked > kPatience;
    if (work_ && feedback_.getNumPublishers() > 0 && !is_missed) {
      if (waiting_) monitor().dropped();
      waiting_ = bundle;
      return;
    }
    if (work_)
      reject(feedback_.getTopic(), is_missed ? "reprojection_verification did not get a frame; it is given up"
                                             : "reprojection_verification is gone; the frame that it had is given up");
    if (std::exchange(waiting_, std::nullopt)) monitor().dropped();
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
      const auto database = models(&changed);
      work->revision = modelsRevision();
      if (work->features.image.type != descriptor_) build(parameters_.current(), work->features.image.type);
      work->searched = searched_->get(database);
      if (isFirst()) output_.publish(bundle);
      work->matches = work->searched->generator.match(work->features);
      work_ = std::move(work);
      propose({}, {}, watch);
    } catch (const std::exception& error) {
      work_.reset();
      reject("feature_extraction", error.what());
    }
  }

  /// Objects of `candidates` that are searched for here; none of the candidates may be.
  std::vector<int> ownObjects(const std::vector<std::string>& candidates) const {
    std::vector<int> own;
    for (const std::string& name : candidates)
      if (const int object = work_->searched->database->find(name); object >= 0) own.push_back(object);
    return own;
  }

  /// One round; `candidates` empty: all objects.
  void propose(const std::vector<std::uint8_t>& active, const std::vector<std::string>& candidates,
               const Stopwatch& watch) {
    Work& work = *work_;
    results_.expect(work.bundle.header().stamp, work.round);
    const std::vector<int> objects = ownObjects(candidates);
    GenerationReport report;
    std::vector<Hypothesis> hypotheses;
    if (candidates.empty() || !objects.empty())
      hypotheses = work.searched->generator.generate(work.features, work.matches, active, objects, work.round, &report);
    const auto message = toMessage(hypotheses, work.round, *work.searched->database, work.bundle.header());
    if (work.round == 0) addMatches(work.matches, *work.searched->database, message.get());
    message->models = work.revision;
    message->cut_short = objectNames(report.objects_cut_short, *work.searched->database);
    message->shard = static_cast<std::uint32_t>(objects_.shard);
    work.seconds += watch.seconds();
    if (!isFirst()) return hypotheses_.publish(message);
    const auto late = [this](const ros::WallTimerEvent&) { onTimeout(); };
    if (objects_.shards > 1) waiting_for_others_ = getNodeHandle().createWallTimer(shard_timeout_, late, true);
    onOthers(message);
  }

  /// Passes the round's hypotheses on once all shards have given theirs.
  void onOthers(const messages::HypothesisArrayConstPtr& results) {
    results_.add(results);
    if (work_ && !work_->proposed && results_.missing().empty()) passOn();
  }

  void onTimeout() {
    if (!work_ || work_->proposed) return;
    std::string missing;
    for (const int shard : results_.missing()) missing += " " + std::to_string(shard);
    reject(kShardTopic, "no hypotheses in time from shard" + missing + "; the round goes on without");
    passOn();
  }

  void passOn() {
    waiting_for_others_.stop();
    work_->proposed = true;
    work_->asked = ros::WallTime::now();
    hypotheses_.publish(results_.merged());
  }

  void onFeedback(const messages::FeedbackConstPtr& feedback) {
    const Stopwatch watch;
    if (feedback->header.stamp.isZero()) return onVerificationBegins();
    if (work_ && feedback->header.stamp == work_->bundle.header().stamp && feedback->round == kBegun)
      work_->begun = true;
    if (!work_ || feedback->header.stamp != work_->bundle.header().stamp || feedback->round > kMaxRounds ||
        static_cast<int>(feedback->round) < work_->round)
      return;
    try {
      if (!feedback->finished) {
        const auto active = activeFeatures(work_->features, maskView(feedback->explained), work_->color_per_depth);
        work_->round = static_cast<int>(feedback->round) + 1;  // a late shard leaves out rounds
        work_->proposed = false;
        return propose(active, feedback->candidates, watch);
      }
      processed(work_->bundle.header(), work_->seconds, work_->round + 1);
    } catch (const std::exception& error) {
      reject(feedback_.getTopic(), error.what());
    }
    work_.reset();
    if (const auto next = std::exchange(waiting_, std::nullopt)) start(*next);
  }

  /// It begins, or begins anew, and knows nothing of the frame that was on its way to it.
  void onVerificationBegins() {
    if (!work_) return;
    monitor().dropped();
    work_.reset();
    if (const auto next = std::exchange(waiting_, std::nullopt)) start(*next);
  }

  Reconfigurable<rgbd_recognition::HypothesisGenerationConfig, MatchingParameters> parameters_;
  DescriptorType descriptor_ = FeatureParameters().descriptor;
  ShardObjects objects_;
  const std::shared_ptr<MadeAhead<Searched>> searched_ = std::make_shared<MadeAhead<Searched>>();
  ros::WallDuration shard_timeout_;
  FrameBundleInput input_;
  FrameBundleOutput output_;
  ros::Publisher hypotheses_;
  ros::Subscriber feedback_, others_;
  ShardResults results_;  // the first shard's: of all
  ros::WallTimer waiting_for_others_;
  std::unique_ptr<Work> work_;
  std::optional<FrameBundle> waiting_;
};

}  // namespace recognition

PLUGINLIB_EXPORT_CLASS(recognition::HypothesisGenerationNodelet, nodelet::Nodelet)
