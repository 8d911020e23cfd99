#include <algorithm>
#include <future>
#include <iterator>
#include <optional>

#include <boost/make_shared.hpp>
#include <pluginlib/class_list_macros.hpp>
#include <rgbd_recognition/ReprojectionVerificationConfig.h>

#include "rgbd_recognition/annotation.h"
#include "ros/detection_output.h"
#include "ros/frame_names.h"
#include "ros/object_shape.h"
#include "ros/shared_models.h"
#include "ros/standard_outputs.h"
#include "ros/frame_budget.h"
#include "ros/frame_bundle.h"
#include "ros/made_ahead.h"
#include "ros/message_conversions.h"
#include "ros/parameters.h"
#include "ros/reconfigurable.h"
#include "ros/stage_nodelet.h"
#include "ros/target_frame.h"
#include "ros/why_picture.h"
#include "search/frame_search.h"
#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/matching/scene_matches.h"
#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"

namespace recognition {

/// Last stage, Sec. VI: tests hypotheses by reprojection, asks for further rounds, publishes what was found.
class ReprojectionVerificationNodelet : public StageNodelet {
 private:
  /// A frame in work: the views below point into the messages of the bundle and into each other.
  struct Work {
    Work(const FrameBundle& frame_bundle, const std::shared_ptr<const ModelDatabase>& models,
         const std::shared_ptr<const PreparedModels>& prepared_models)
        : bundle(frame_bundle),
          database(models),
          frame(frameView(bundle.images)),
          segmentation(fromMessage(*bundle.segmentation)),
          features(fromMessage(*bundle.features)),
          prepared(prepared_models),
          scene(SceneView::make(frame, depthInMetres(frame.depth), segmentation, features)) {}

    const FrameBundle bundle;
    const std::shared_ptr<const ModelDatabase> database;
    const RgbdFrame frame;
    const Segmentation segmentation;
    const SceneFeatures features;
    const std::shared_ptr<const PreparedModels> prepared;
    const SceneView scene;
    std::unique_ptr<FrameSearch> search;  // from the first hypotheses on
    std::vector<VerifiedHypothesis> tested;
    std::vector<std::string> left_out;  // by the budget, in words
    double seconds = 0.0;
  };

  void configure() override {
    ros::NodeHandle& node = getPrivateNodeHandle();
    prepared_models_->setRecipe(sharedPreparedModels);
    const auto prepare = MadeAhead<PreparedModels>::preparation(prepared_models_);
    openModels(prepare);
    bool changed = false;
    preparing_ = std::async(std::launch::async, prepare, models(&changed));  // while the camera starts
    parameters_.read(node, namesBesideTheCores(),
                     [](const VerificationParameters&) {});  // each frame takes the current ones
    budget_ = FrameBudget(1e-3 * numberInRange(node, "budget_ms", 0.0, 0.0, 60000.0));
    target_ = std::make_unique<TargetFrame>(parameterOr(node, "target_frame", std::string()));
    publishes_tf_ = parameterOr(node, "publish_tf", true);
    tf_prefix_ = plainFrame(parameterOr(node, "tf_prefix", std::string()));
  }

  static std::vector<std::string> namesBesideTheCores() {
    auto names = stageParameterNames();
    names.insert(names.end(), {"budget_ms", "target_frame", "publish_tf", "tf_prefix"});
    return names;
  }

  void advertise() override {
    ros::NodeHandle& node = getNodeHandle();
    parameters_.serve(getPrivateNodeHandle());
    detections_ = advertiseLazy<messages::DetectionArray>(node, "detections");
    hypotheses_ = advertiseLazy<messages::DetectionArray>(node, "hypotheses");
    markers_ = advertiseLazy<visualization_msgs::MarkerArray>(node, "markers");
    rejected_ = advertiseLazy<visualization_msgs::MarkerArray>(node, "rejected_markers");
    annotated_ = advertiseLazyImage(node, "annotated");
    why_ = advertiseLazyImage(node, "why");
    if (publishes_tf_) tf_ = advertiseLazy<tf2_msgs::TFMessage>(node, "/tf");
    standard_.advertise([&](auto message, const char* topic) { return advertiseLazy<decltype(message)>(node, topic); });
    // Whoever connects is told that it begins: a frame that an earlier one had is lost.
    const ros::SubscriberStatusCallback tell = [](const ros::SingleSubscriberPublisher& subscriber) {
      subscriber.publish(beginning());
    };
    feedback_ = getPrivateNodeHandle().advertise<messages::Feedback>("feedback", 2, tell);
  }

  /// Feedback that belongs to no frame: none of those before it will be answered.
  static messages::Feedback beginning() {
    messages::Feedback begins;
    begins.finished = 1;
    return begins;
  }

  void startInputs() override {
    // A frame that was on its way when the last listener left is lost, and the stages before may still wait for it.
    feedback_.publish(beginning());
    input_.subscribe(getNodeHandle(), "hypothesis_generation", true,
                     [this](const FrameBundle& bundle) { onFrame(bundle); });
    timing_ = getNodeHandle().subscribe("timing", 10, &ReprojectionVerificationNodelet::onTiming, this);
    proposals_ = getNodeHandle().subscribe("hypothesis_generation/hypotheses", 2,
                                           &ReprojectionVerificationNodelet::onHypotheses, this);
  }

  void stopInputs() override {
    input_.unsubscribe();
    proposals_.shutdown();
    timing_.shutdown();
    work_.reset();
    early_.reset();
  }

  void onTiming(const messages::StageTimingConstPtr& timing) {
    if (timing->stage == "segmentation" || timing->stage == "feature_extraction")
      budget_.spentEarlier(timing->header.stamp, timing->seconds, ros::WallTime::now());
  }

  void onFrame(const FrameBundle& bundle) {
    const Stopwatch watch;
    budget_.begin(bundle.header().stamp, ros::WallTime::now());
    if (work_) monitor().dropped();
    work_.reset();
    try {
      bool changed = false;
      const auto database = models(&changed);
      if (changed) marker_maker_ = {};
      begin(bundle, database);
      work_->seconds = watch.seconds();
    } catch (const std::exception& error) {
      return giveUp(bundle.header(), 0, error.what());
    }
    if (const auto early = std::exchange(early_, nullptr)) onHypotheses(early);
  }

  void begin(const FrameBundle& bundle, const std::shared_ptr<const ModelDatabase>& database) {
    work_ = std::make_unique<Work>(bundle, database, prepared_models_->get(database));
  }

  void onHypotheses(const messages::HypothesisArrayConstPtr& message) {
    const Stopwatch watch;
    if (!work_ || message->header.stamp != work_->bundle.header().stamp) {
      early_ = message;  // over a network they may overtake the frame's images
      return;
    }
    const int round = static_cast<int>(message->round);
    tellThatItBegins(message->header);
    try {
      if (const auto database = modelsAt(message->models); database != work_->database && round == 0)
        begin(FrameBundle(work_->bundle), database);  // the store changed between the stages
      RoundOutcome outcome = verify(*message, round);
      work_->seconds += watch.seconds();
      answer(outcome, round);
      std::move(outcome.hypotheses.begin(), outcome.hypotheses.end(), std::back_inserter(work_->tested));
      if (!outcome.finished) return;
      processed(work_->bundle.header(), work_->seconds, round + 1);
      publish(*work_);
    } catch (const std::exception& error) {
      giveUp(message->header, round, error.what());
    }
    work_.reset();
  }

  /// As much of the round as the frame's time budget allows, which the first round turns into work.
  RoundOutcome verify(const messages::HypothesisArray& message, int round) {
    const Stopwatch watch;
    if (!work_->search)
      work_->search = std::make_unique<FrameSearch>(parameters_.current(), matchingLimits(), work_->prepared,
                                                    work_->scene, budget_.workLeft(ros::WallTime::now()));
    for (const std::string& object : message.cut_short)
      work_->left_out.push_back("part of the search for " + object + " in round " + std::to_string(round));
    const auto hypotheses = fromMessage(message, *work_->database, work_->features);
    SceneMatches matches;
    if (!message.matches.empty()) matches = matchesFromMessage(message, *work_->database, work_->features);
    const double before = work_->search->report().work_ms;
    RoundOutcome outcome = work_->search->run(hypotheses, round, message.matches.empty() ? nullptr : &matches);
    budget_.measured(work_->search->report().work_ms - before, watch.seconds());
    if (!outcome.finished && budget_.exceeded(ros::WallTime::now())) {
      outcome.finished = true;
      work_->left_out.push_back("rounds after " + std::to_string(round));
    }
    if (outcome.finished)
      for (const std::string& what : work_->search->report().left_out) work_->left_out.push_back(what);
    return outcome;
  }

  /// As the stage before has them: limits that the two share are its parameters.
  MatchingLimits matchingLimits() const {
    const ros::NodeHandle node(getNodeHandle(), "hypothesis_generation");
    MatchingLimits limits;
    for (const auto& [name, value] :
         std::initializer_list<std::pair<const char*, double*>>{{"delta_d", &limits.delta_d},
                                                                {"size_tolerance", &limits.size_tolerance},
                                                                {"max_view_angle", &limits.max_view_angle},
                                                                {"support_radius", &limits.support_radius},
                                                                {"max_rotation", &limits.max_rotation}})
      node.getParamCached(name, *value);
    return limits;
  }

  void answer(const RoundOutcome& outcome, int round) {
    const auto feedback = boost::make_shared<messages::Feedback>();
    feedback->header = work_->bundle.header();
    feedback->round = static_cast<std::uint32_t>(round);
    feedback->finished = outcome.finished;
    // Without a time budget the same limits would leave out the same again.
    feedback->in_full = outcome.finished && (!budget_.isLimited() || work_->left_out.empty());
    if (!outcome.finished) {
      feedback->candidates = objectNames(outcome.candidates, *work_->database);
      fillImage(outcome.explained, feedback->header, &feedback->explained);
    }
    feedback_.publish(feedback);
  }

  /// So that nobody takes a slow answer for none.
  void tellThatItBegins(const std_msgs::Header& header) {
    const auto feedback = boost::make_shared<messages::Feedback>();
    feedback->header = header;
    feedback->round = 0xffffffff;  // as hypothesis_generation knows it
    feedback_.publish(feedback);
  }

  void giveUp(const std_msgs::Header& header, int round, const std::string& problem) {
    reject("hypothesis_generation", problem);
    const auto feedback = boost::make_shared<messages::Feedback>();
    feedback->header = header;
    feedback->round = static_cast<std::uint32_t>(round);
    feedback->finished = 1;
    feedback_.publish(feedback);
  }

  void publish(const Work& work) {
    const std_msgs::Header& header = work.bundle.header();
    const auto found = work.search->detections();
    if (budget_.exceeded(ros::WallTime::now())) monitor().overran(joined(work.left_out));
    if (annotated_.getNumSubscribers() > 0) annotated_.publish(imageMessage(annotated(work, found), header));
    if (why_.getNumSubscribers() > 0) why_.publish(imageMessage(why(work, found), header));
    try {
      publish(work, found, target_->targetFromCamera(header));
    } catch (const std::runtime_error& error) {
      reject("tf", error.what());  // better no result than one in another frame than was asked for
    }
  }

  void publish(const Work& work, const std::vector<VerifiedHypothesis>& found, const Pose& target_from_camera) {
    const std_msgs::Header& header = work.bundle.header();
    const auto messageOf = [&](const std::vector<VerifiedHypothesis>& hypotheses) {
      const auto message = toMessage(hypotheses, *work.database, header);
      message->arrived = work.bundle.segmentation->arrived;
      shapes_.fillIn(*work.database, message.get());
      if (!target_->isCamera(header)) changeFrame(target_from_camera, target_->nameFor(header), message.get());
      message->left_out = work.left_out;
      return message;
    };
    const auto detections = messageOf(found);
    if (publishes_tf_) nameFrames(tf_prefix_, detections.get());
    detections_.publish(detections);
    standard_.publish(*detections, *work.database);
    if (publishes_tf_ && !detections->detections.empty()) tf_.publish(transformsOf(*detections));
    const LabelView view = target_->isCamera(header) ? LabelView::ofCamera(work.frame.color_camera) : LabelView();
    if (markers_.getNumSubscribers() > 0) markers_.publish(marker_maker_.make(*detections, *work.database, view));
    if (hypotheses_.getNumSubscribers() + rejected_.getNumSubscribers() == 0) return;
    const auto tested = messageOf(work.tested);
    hypotheses_.publish(tested);
    if (rejected_.getNumSubscribers() > 0) rejected_.publish(marker_maker_.makeRejected(*tested, *work.database, view));
  }

  static std::string joined(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += (text.empty() ? "" : "; ") + line;
    return text;
  }

  static cv::Mat why(const Work& work, const std::vector<VerifiedHypothesis>& found) {
    return whyPicture({work.frame, work.segmentation, work.features, work.tested, found, *work.database});
  }

  static cv::Mat annotated(const Work& work, const std::vector<VerifiedHypothesis>& found) {
    cv::Mat bgr = bgrCopy(work.frame);
    std::vector<Annotation> annotations;
    for (const VerifiedHypothesis& detection : found) {
      const int object = detection.hypothesis.object;
      annotations.push_back(
          {object, detection.camera_from_object,
           nameWithConfidence(work.database->objects[static_cast<size_t>(object)]->name, detection.confidence)});
    }
    drawAnnotations(bgr, annotations, *work.database, work.frame.color_camera);
    return bgr;
  }

  Reconfigurable<rgbd_recognition::ReprojectionVerificationConfig, VerificationParameters> parameters_;
  FrameBundleInput input_;
  ros::Subscriber proposals_, timing_;
  FrameBudget budget_;
  std::unique_ptr<TargetFrame> target_;
  ros::Publisher detections_, hypotheses_, markers_, rejected_, tf_, feedback_;
  image_transport::Publisher annotated_, why_;
  bool publishes_tf_ = true;
  std::string tf_prefix_;
  StandardOutputs standard_;
  ObjectShapes shapes_;
  MarkerMaker marker_maker_;
  const std::shared_ptr<MadeAhead<PreparedModels>> prepared_models_ = std::make_shared<MadeAhead<PreparedModels>>();
  std::future<void> preparing_;
  std::unique_ptr<Work> work_;
  messages::HypothesisArrayConstPtr early_;  // for a frame that has not arrived yet
};

}  // namespace recognition

PLUGINLIB_EXPORT_CLASS(recognition::ReprojectionVerificationNodelet, nodelet::Nodelet)
