// The nodelets against the Recognizer, and what only they do: passing pointers, laziness, reloading, reconfiguring.
#include <algorithm>

#include <dynamic_reconfigure/Reconfigure.h>
#include <gmock/gmock.h>
#include <opencv2/imgproc.hpp>
#include <std_srvs/Trigger.h>

#include "nodelets/pipeline_fixture.h"
#include "rgbd_recognition/model/model_store.h"
#include "rgbd_recognition/recognizer.h"
#include "ros/message_conversions.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition {
namespace {

void expectSame(const messages::Detection& is, const VerifiedHypothesis& should, const ModelDatabase& database) {
  EXPECT_EQ(is.object, database.objects[static_cast<size_t>(should.hypothesis.object)]->name);
  EXPECT_EQ(is.accepted != 0, should.accepted());
  EXPECT_EQ(is.source, sourceName(should.hypothesis.source));
  EXPECT_EQ(is.consensus, should.hypothesis.consensus.size());
  EXPECT_EQ(static_cast<int>(is.round), should.hypothesis.round);
  const Pose pose = poseFromMessage(is.pose.pose);
  EXPECT_LT(translationDistance(pose, should.camera_from_object), 1e-6);
  EXPECT_LT(rotationDistance(pose, should.camera_from_object), 1e-5);
  EXPECT_NEAR(is.total, should.scores.total, 1e-6);
  EXPECT_NEAR(is.confidence, should.confidence, 1e-6);
}

void expectSame(const messages::DetectionArray& is, const std::vector<VerifiedHypothesis>& should,
                const ModelDatabase& database) {
  ASSERT_EQ(is.detections.size(), should.size());
  for (size_t i = 0; i < should.size(); ++i) expectSame(is.detections[i], should[i], database);
}

TEST_F(PipelineTest, findsWhatTheRecognizerFinds) {
  loadPipeline();
  Recorder<messages::DetectionArray> hypotheses(node_, "hypotheses");
  Recorder<messages::StageTiming> timing(node_, "timing");
  waitForCamera();
  Recognizer recognizer(RecognizerParameters(), ModelStore(trainedStore()).loadAll().database);
  size_t found = 0;
  for (const FrameMessages& frame : demoFrames()) {
    const RecognitionResult result = recognizer.recognize(frameView(frame));
    const auto detections = detect(frame);
    ASSERT_TRUE(detections);
    EXPECT_EQ(detections->header.frame_id, frame.color->header.frame_id);
    expectSame(*detections, result.detections, recognizer.database());
    ASSERT_TRUE(waitFor([&] { return hypotheses.at(frame.color->header.stamp) != nullptr; }));
    expectSame(*hypotheses.at(frame.color->header.stamp), result.hypotheses, recognizer.database());
    found += result.detections.size();
    EXPECT_EQ(result.rounds, 1) << "with the confidence nothing flows back";
  }
  EXPECT_GE(found, 3u) << "of six: too few for this test to mean much";
}

int comparedIn(const RecognitionResult& result) {
  return static_cast<int>(std::count_if(result.hypotheses.begin(), result.hypotheses.end(),
                                        [](const VerifiedHypothesis& h) { return h.level == TestLevel::kCompared; }));
}

TEST_F(PipelineTest, answersEveryFrameThatItTookWhereVerificationCostsTenTimesAsMuch) {
  RecognizerParameters slow;
  slow.reprojection_verification.exhaustive = true;
  slow.reprojection_verification.correspondence_proposals = slow.reprojection_verification.resting_proposals = 200;
  setParam("reprojection_verification/exhaustive", true);
  setParam("reprojection_verification/correspondence_proposals",
           slow.reprojection_verification.correspondence_proposals);
  setParam("reprojection_verification/resting_proposals", slow.reprojection_verification.resting_proposals);
  loadPipeline();
  Recorder<sensor_msgs::Image> taken(node_, "segmentation/depth");
  Recorder<messages::DetectionArray> answers(node_, "detections");
  waitForCamera();
  ASSERT_TRUE(waitFor([&] { return taken.connected() && answers.connected(); }));

  const FrameMessages frame = demoFrames().front();
  const auto database = ModelStore(trainedStore()).loadAll().database;
  const RecognitionResult should = Recognizer(slow, database).recognize(frameView(frame));
  ASSERT_GE(comparedIn(should),
            10 * comparedIn(Recognizer(RecognizerParameters(), database).recognize(frameView(frame))));

  // Before the first answer every frame goes on: later stages may not run at all.
  ASSERT_TRUE(detect(withStamp(frame, frame.color->header.stamp - ros::Duration(1.0))));
  const size_t before = taken.count();
  constexpr int kFrames = 60;
  ros::Rate camera(30.0);
  for (int i = 0; i < kFrames; ++i, camera.sleep())
    publish(withStamp(frame, frame.color->header.stamp + ros::Duration(i / 30.0)));
  ASSERT_TRUE(waitFor([&] { return taken.count() > before && answers.count() >= taken.count(); }));
  EXPECT_LT(taken.count(), static_cast<size_t>(kFrames)) << "fast enough for a camera: this test means nothing";
  for (const ros::Time& stamp : taken.stamps()) {
    ASSERT_TRUE(answers.at(stamp)) << "no answer to the frame of " << stamp;
    expectSame(*answers.at(stamp), should.detections, *database);
  }
}

TEST_F(PipelineTest, handsOnTheCamerasImagesFromFirstToLastStage) {
  loadPipeline();
  Recorder<sensor_msgs::Image> first(node_, "segmentation/color"), last(node_, "hypothesis_generation/color");
  Recorder<sensor_msgs::Image> first_depth(node_, "segmentation/depth"),
      last_depth(node_, "hypothesis_generation/depth");
  waitForCamera();
  const FrameMessages frame = demoFrames().front();
  const ros::Time stamp = frame.color->header.stamp;
  ASSERT_TRUE(detect(frame));
  ASSERT_TRUE(
      waitFor([&] { return first.at(stamp) && last.at(stamp) && first_depth.at(stamp) && last_depth.at(stamp); }));
  EXPECT_EQ(first.at(stamp)->data.data(), frame.color->data.data());
  EXPECT_EQ(last.at(stamp)->data.data(), frame.color->data.data());
  EXPECT_EQ(first_depth.at(stamp)->data.data(), frame.depth->data.data());
  EXPECT_EQ(last_depth.at(stamp)->data.data(), frame.depth->data.data());
}

/// What a camera of half the resolution sees of it.
FrameMessages halfAsLarge(const FrameMessages& frame, const ros::Time& stamp) {
  const FrameMessages later = withStamp(frame, stamp);
  const RgbdFrame view = frameView(later);
  cv::Mat color, depth;
  cv::resize(view.color, color, cv::Size(), 0.5, 0.5, cv::INTER_AREA);
  cv::resize(view.depth, depth, cv::Size(), 0.5, 0.5, cv::INTER_NEAREST);
  const auto color_message = imageMessage(color, later.color->header);
  color_message->encoding = later.color->encoding;
  const auto info = boost::make_shared<sensor_msgs::CameraInfo>(*later.camera_info);
  info->width /= 2, info->height /= 2;
  for (const size_t i : {0, 5}) info->P[i] *= 0.5;
  for (const size_t i : {2, 6}) info->P[i] = 0.5 * (info->P[i] + 0.5) - 0.5;
  return {color_message, imageMessage(depth, later.depth->header), info};
}

/// Whether each of `some` is among `all`, within `metres`.
void expectAmong(const messages::DetectionArray& some, const messages::DetectionArray& all, double metres) {
  for (const messages::Detection& detection : some.detections) {
    const auto is_same = [&](const messages::Detection& other) {
      return other.object == detection.object &&
             translationDistance(poseFromMessage(other.pose.pose), poseFromMessage(detection.pose.pose)) < metres;
    };
    EXPECT_TRUE(std::any_of(all.detections.begin(), all.detections.end(), is_same)) << detection.object;
  }
}

TEST_F(PipelineTest, goesOnWithACameraThatChangesItsModeWhileRunning) {
  loadPipeline();
  waitForCamera();
  const FrameMessages frame = demoFrames().front();
  const auto first = detect(frame);
  const auto half = detect(halfAsLarge(frame, frame.color->header.stamp + ros::Duration(1.0)));
  const auto last = detect(withStamp(frame, frame.color->header.stamp + ros::Duration(2.0)));
  ASSERT_TRUE(first && half && last);
  EXPECT_FALSE(first->detections.empty());
  expectAmong(*half, *first, 0.02);  // with a quarter of the pixels fewer may be found
  expectAmong(*last, *first, 1e-9);
  EXPECT_EQ(last->detections.size(), first->detections.size());
}

TEST_F(PipelineTest, pairsDepthOfAnotherStampWithinTheInterval) {
  setParam("segmentation/max_interval", 0.02);
  loadPipeline();
  const Recorder<messages::DetectionArray> detections(node_, "detections");
  waitForCamera();
  const FrameMessages frame = demoFrames().front();
  ros::Time stamp(100.0);
  const auto answered = [&] {  // pairs are certain once a later depth shows that nothing nearer comes
    FrameMessages next = withStamp(frame, stamp);
    next.depth = withStamp(frame, stamp + ros::Duration(0.01)).depth;
    publish(next);
    stamp += ros::Duration(1.0);
    return waitFor([&] { return detections.count() > 0; }, 0.1);
  };
  EXPECT_TRUE(waitFor(answered));
}

TEST_F(PipelineTest, dropsFramesOfAFastCameraInTheOpenAndQueuesNone) {
  constexpr size_t kMin = 360;  // frames
#ifdef RGBD_TEST_SANITIZED      // until one is answered
  constexpr size_t kMax = 3600;
  constexpr double kPatience = 60.0;
#else
  constexpr size_t kMax = kMin;
  constexpr double kPatience = 10.0;
#endif
  constexpr size_t kMaxInPipeline = 2;  // one that is admitted and one that waits
  const ros::WallDuration kPeriod(1.0 / 60.0);
  loadPipeline();
  const Recorder<messages::DetectionArray> detections(node_, "detections");
  waitForCamera();
  const FrameMessages frame = demoFrames().front();
  ASSERT_TRUE(detect(frame));
  const size_t before = detections.count();
  ros::WallTime next = ros::WallTime::now();
  size_t frames = 0;
  for (; frames < kMin || (frames < kMax && detections.count() == before); ++frames) {
    publish(withStamp(frame, ros::Time(1000.0 + static_cast<double>(frames) / 60.0)));
    next += kPeriod;
    ros::WallTime::sleepUntil(next);
  }
  const size_t during = detections.count() - before;
  EXPECT_GE(during, 1u);
  EXPECT_LE(during, frames / 2) << "faster than the camera: nothing was tested";
  EXPECT_FALSE(waitFor([&] { return detections.count() - before > during + kMaxInPipeline; }, 5.0))
      << "frames had queued up";
  const auto accountedFor = [&] {
    return static_cast<double>(detections.count()) + largestDiagnosed("segmentation", "frames dropped") +
           largestDiagnosed("segmentation", "frames lost in later stages");
  };
  EXPECT_TRUE(waitFor([&] { return accountedFor() == static_cast<double>(frames + 1); }, kPatience))
      << accountedFor() << " of " << frames + 1 << " frames are answered, dropped or lost";
  RecordProperty("frames_answered", static_cast<int>(detections.count()));
  RecordProperty("frames_dropped", static_cast<int>(largestDiagnosed("segmentation", "frames dropped")));
  RecordProperty("frames_lost", static_cast<int>(largestDiagnosed("segmentation", "frames lost in later stages")));
}

TEST_F(PipelineTest, worksOnlyWhileSomebodyListens) {
  setParam("models", trainedStore());
  for (const char* name : {"segmentation", "feature_extraction", "hypothesis_generation", "reprojection_verification"})
    ASSERT_TRUE(load(name));
  EXPECT_EQ(color_.getNumSubscribers(), 0u);
  const auto expectWorkFor = [this](auto message, const std::string& output) {
    SCOPED_TRACE(output);
    {
      const Recorder<decltype(message)> listener(node_, output);
      EXPECT_TRUE(waitFor([this] { return color_.getNumSubscribers() == 1; }));
    }
    EXPECT_TRUE(waitFor([this] { return color_.getNumSubscribers() == 0; }));
  };
  expectWorkFor(messages::DetectionArray(), "detections");
  expectWorkFor(sensor_msgs::Image(), "segmentation/overlay");
  expectWorkFor(sensor_msgs::Image(), "annotated");
  expectWorkFor(messages::SceneFeatures(), "feature_extraction/features");
}

TEST_F(PipelineTest, answersEveryFrameOfARecordingThatBeginsAgain) {
  loadPipeline();
  waitForCamera();
  const FrameMessages frame = demoFrames().front();
  for (const double time : {100.0, 101.0, 50.0, 51.0}) EXPECT_TRUE(detect(withStamp(frame, ros::Time(time)))) << time;
}

std::set<std::string> objectsIn(const messages::DetectionArrayConstPtr& detections) {
  std::set<std::string> names;
  if (detections)
    for (const auto& detection : detections->detections) names.insert(detection.object);
  return names;
}

TEST_F(PipelineTest, takesUpNewChangedAndRemovedModelsWithoutMissingAFrame) {
  const std::string folder = emptyFolder();
  const ModelStore from(trainedStore()), to(folder);
  to.save(from.load(kSecondObject));
  setParam("models", folder);
  for (const char* name : {"segmentation", "feature_extraction", "hypothesis_generation", "reprojection_verification"})
    setParam(std::string(name) + "/models", folder);
  loadPipeline();
  waitForCamera();
  const FrameMessages frame = demoFrames().front();
  double time = 100.0;
  // Frames come on and on; each must be answered, and in the end as the store says.
  const auto untilFound = [&](bool first, bool second) {
    for (int i = 0; i < 40; ++i) {
      const auto detections = detect(withStamp(frame, ros::Time(time += 1.0)));
      EXPECT_TRUE(detections) << "a frame was missed";
      const auto objects = objectsIn(detections);
      if (objects.count(kFirstObject) == size_t(first) && objects.count(kSecondObject) == size_t(second)) return true;
    }
    return false;
  };
  EXPECT_TRUE(untilFound(false, true));
  to.save(from.load(kFirstObject));
  EXPECT_TRUE(untilFound(true, true));
  to.remove(kSecondObject);
  EXPECT_TRUE(untilFound(true, false));
  ObjectModel featureless = from.load(kFirstObject);
  for (auto& [type, features] : featureless.features) {  // a model that cannot be found takes the place of the good one
    features.descriptors = features.descriptors.rowRange(0, 1).clone();
    features.positions.resize(1), features.view_directions.resize(1), features.sizes.resize(1);
    features.views.resize(1), features.orientations.resize(std::min<size_t>(1, features.orientations.size()));
  }
  for (SurfacePoint& point : featureless.cloud) point.rgb = cv::Vec3b(128, 128, 128);
  to.save(featureless);
  EXPECT_TRUE(untilFound(false, false));
  to.save(from.load(kFirstObject));
  EXPECT_TRUE(untilFound(true, false));
}

TEST_F(PipelineTest, findsNewModelsAfterReload) {
  const std::string folder = emptyFolder();
  const ModelStore from(trainedStore()), to(folder);
  to.save(from.load(kSecondObject));
  setParam("segmentation/models", folder);
  setParam("hypothesis_generation/models", folder);
  setParam("reprojection_verification/models", folder);
  loadPipeline();
  waitForCamera();
  const FrameMessages frame = demoFrames().front();
  EXPECT_THAT(objectsIn(detect(frame)), ::testing::Not(::testing::Contains(kFirstObject)));
  to.save(from.load(kFirstObject));
  std_srvs::Trigger reload;
  ASSERT_TRUE(ros::service::call(ns_ + "/hypothesis_generation/reload", reload));
  EXPECT_TRUE(reload.response.success);
  EXPECT_THAT(objectsIn(detect(withStamp(frame, ros::Time(2e9)))), ::testing::Contains(kFirstObject));
}

TEST_F(PipelineTest, takesNewParametersAndKeepsTheLastGoodOnes) {
  setParam("models", trainedStore());
  ASSERT_TRUE(load("reprojection_verification"));
  const auto ask = [this](double value) {
    dynamic_reconfigure::Reconfigure change;
    change.request.config.doubles.resize(1);
    change.request.config.doubles[0].name = "min_confidence";
    change.request.config.doubles[0].value = value;
    EXPECT_TRUE(ros::service::call(ns_ + "/reprojection_verification/set_parameters", change));
    for (const auto& item : change.response.config.doubles)
      if (item.name == "min_confidence") return item.value;
    return -1.0;
  };
  EXPECT_EQ(ask(0.25), 0.25);
  EXPECT_EQ(ask(7.0), 0.25) << "what is out of range is refused";
  double kept = 0.0;
  EXPECT_TRUE(ros::param::get(ns_ + "/reprojection_verification/min_confidence", kept));
  EXPECT_EQ(kept, 0.25);
}

}  // namespace
}  // namespace recognition

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "pipeline_test");
  const ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
