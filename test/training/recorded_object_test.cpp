#include "rgbd_recognition/training/recorded_object.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "model/temporary_directory.h"
#include "meshes/surface_sampling.h"
#include "training/model_extension.h"
#include "rgbd_recognition/training/object_trainer.h"
#include "training/training_pictures.h"
#include "training/turntable.h"
#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/features/feature_parameters.h"

namespace recognition {
namespace {

using testing::Contains;
using testing::HasSubstr;

const Eigen::Vector3f kSize(0.1f, 0.06f, 0.14f);
const Pose kPlace = Pose(Eigen::Translation3d(0.02, -0.01, 0.07)) * Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ());

double rmsFromBox(const std::vector<SurfacePoint>& cloud, const Pose& box_from_model) {
  double sum = 0.0;
  for (const SurfacePoint& point : cloud)
    sum += std::pow(distanceToBox((box_from_model * point.position.cast<double>()).cast<float>(), kSize), 2);
  return std::sqrt(sum / static_cast<double>(cloud.size()));
}

class Recording : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const Turntable turntable(charuco(), boxMesh(kSize, blobTexture(768, 5)), kPlace);
    frames_ = new std::vector<RgbdFrame>(recordTurn(turntable, 24));
  }
  static void TearDownTestSuite() { delete frames_; }
  static std::vector<RgbdFrame>* frames_;
};
std::vector<RgbdFrame>* Recording::frames_ = nullptr;

TEST_F(Recording, MakesAModelOfTheObjectOnTheBoard) {
  RecordedObject object({}, FeatureParameters(), charuco());
  for (const RgbdFrame& frame : *frames_) EXPECT_EQ(object.add({frame, std::nullopt, {}}), "");
  const RecordedObject::Result result = object.build("box", {DescriptorType::kSift});
  EXPECT_EQ(result.report.views_used, 24);
  EXPECT_LT(result.report.board_rms, 0.7);
  EXPECT_LT(result.report.residual, 0.002);
  // Origin: on the board, under the box's middle; orientation: the board's.
  const Pose box_from_model = kPlace.inverse() * Eigen::Translation3d(0.02, -0.01, 0.0);
  EXPECT_LT(rmsFromBox(result.model.cloud, box_from_model), 0.003);
  const ModelFeatures& features = result.model.features.at(DescriptorType::kSift);
  EXPECT_GT(features.count(), 300);
  double mean = 0.0;
  for (const Eigen::Vector3f& p : features.positions)
    mean += distanceToBox((box_from_model * p.cast<double>()).cast<float>(), kSize) / features.count();
  EXPECT_LT(mean, 0.003);
  EXPECT_GE(features.views.front(), 3);
}

// What the camera can see of the box (all but its bottom) is there; Sigma is that of the whole box.
TEST_F(Recording, CoversTheSurface) {
  RecordedObject object({}, FeatureParameters(), charuco());
  for (const RgbdFrame& frame : *frames_) object.add({frame, std::nullopt, {}});
  const ObjectModel model = object.build("box", {}).model;
  const Pose model_from_box = (kPlace.inverse() * Eigen::Translation3d(0.02, -0.01, 0.0)).inverse();
  const std::vector<SurfacePoint> whole =
      sampleSurface(boxMesh(kSize, cv::Mat(8, 8, CV_8UC3, cv::Scalar())), 0.003, 30000);
  std::vector<SurfacePoint> visible;
  for (const SurfacePoint& point : whole)
    if (point.position.z() > -0.5f * kSize.z() + 0.01f) visible.push_back(point);
  int covered = 0;
  for (const SurfacePoint& point : visible) {
    const Eigen::Vector3f p = (model_from_box * point.position.cast<double>()).cast<float>();
    covered += std::any_of(model.cloud.begin(), model.cloud.end(),
                           [&](const SurfacePoint& q) { return (q.position - p).norm() < 0.005f; });
  }
  EXPECT_GT(covered, 0.95 * static_cast<double>(visible.size()));
  const Extents expected = computeExtents(whole);
  EXPECT_NEAR(model.extents.sigma_max, expected.sigma_max, 0.03 * expected.sigma_max);
  EXPECT_NEAR(model.extents.sigma_min, expected.sigma_min, 0.03 * expected.sigma_min);
  EXPECT_NEAR(model.extents.sigma_d, expected.sigma_d, 0.03 * expected.sigma_d);
}

TEST_F(Recording, RefusesViewsWithReasons) {
  RecordingParameters parameters;
  parameters.max_views = 2;
  RecordedObject object(parameters, FeatureParameters(), charuco());
  RgbdFrame black = (*frames_)[0];
  black.color = cv::Mat(black.color.size(), CV_8UC3, cv::Scalar());
  EXPECT_THAT(object.add({black, std::nullopt, {}}), HasSubstr("board"));
  EXPECT_EQ(object.add({(*frames_)[0], std::nullopt, {}}), "");
  EXPECT_THAT(object.add({(*frames_)[0], std::nullopt, {}}), HasSubstr("too near"));
  RgbdFrame no_depth = (*frames_)[1];
  no_depth.depth = cv::Mat();
  EXPECT_NE(object.add({no_depth, std::nullopt, {}}), "");
  EXPECT_THAT(object.add({(*frames_)[1], std::nullopt, cv::Mat(3, 3, CV_8UC1)}), HasSubstr("mask"));
  EXPECT_EQ(object.add({(*frames_)[8], std::nullopt, {}}), "");
  EXPECT_THAT(object.add({(*frames_)[16], std::nullopt, {}}), HasSubstr("enough"));
  EXPECT_EQ(object.views(), 2);
}

// Of too few views it must not say that the object is too large.
TEST_F(Recording, SaysFirstThatViewsAreMissing) {
  RecordingParameters parameters;
  parameters.max_radius = 0.03;  // the object reaches beyond
  const auto problemOf = [&](size_t step) -> std::string {
    RecordedObject object(parameters, FeatureParameters(), charuco());
    for (size_t i = 0; i < frames_->size(); i += step) object.add({(*frames_)[i], std::nullopt, {}});
    try {
      object.build("box", {});
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(problemOf(1), testing::StartsWith("box: what stands on the board reaches beyond"));
  EXPECT_THAT(problemOf(6), testing::StartsWith("box: 4 views overlap too little: 8 more are needed, 2 between "));
}

TEST_F(Recording, PosesMayBeGivenInsteadOfABoard) {
  RecordedObject object({}, FeatureParameters(), std::nullopt);
  for (size_t i = 0; i < frames_->size(); ++i)
    EXPECT_EQ(object.add({(*frames_)[i], orbitPose(15.0 * static_cast<double>(i), 40.0, 0.7, {0, 0, 0.05}), {}}), "");
  EXPECT_GT(object.build("box", {DescriptorType::kSift}).model.features.at(DescriptorType::kSift).count(), 300);
}

TEST_F(Recording, TheModelMayHaveAnyFrame) {
  RecordedObject object({}, FeatureParameters(), charuco(), kPlace);
  for (const RgbdFrame& frame : *frames_) object.add({frame, std::nullopt, {}});
  const ObjectModel model = object.build("box", {DescriptorType::kSift}).model;
  EXPECT_LT(rmsFromBox(model.cloud, Pose::Identity()), 0.003);
  const ModelFeatures& features = model.features.at(DescriptorType::kSift);
  double mean = 0.0;
  int seen = 0, outward = 0;  // on a face, by its own normal: the cloud has gaps, and edges have two faces
  for (size_t i = 0; i < features.positions.size(); ++i) {
    mean += distanceToBox(features.positions[i], kSize) / features.count();
    EXPECT_NEAR(features.orientations[i].dot(features.view_directions[i]), 0.0f, 0.05f);
    const Eigen::Vector3f inside = 0.5f * kSize - features.positions[i].cwiseAbs();
    int axis = 0;
    inside.minCoeff(&axis);
    if ((inside.array() < 0.008f).count() > 1) continue;  // beside an edge
    ++seen;
    outward += features.view_directions[i][axis] * features.positions[i][axis] > 0.0f ? 1 : 0;
  }
  EXPECT_LT(mean, 0.003);
  EXPECT_GT(seen, 500);
  EXPECT_GT(outward, 0.98 * seen);
}

TEST_F(Recording, AnotherFrameTurnsEachPartOfTheModel) {
  const auto modelIn = [](const std::optional<Pose>& frame) {
    RecordedObject object({}, FeatureParameters(), charuco(), frame);
    for (const RgbdFrame& view : *frames_) object.add({view, std::nullopt, {}});
    return object.build("box", {DescriptorType::kSift}).model;
  };
  const ObjectModel plain = modelIn(std::nullopt), framed = modelIn(kPlace);
  const Eigen::Matrix3f turn = kPlace.linear().transpose().cast<float>();  // the board's orientation to the frame's
  ASSERT_EQ(framed.cloud.size(), plain.cloud.size());
  const Eigen::Vector3f shift = framed.cloud[0].position - turn * plain.cloud[0].position;
  for (size_t i = 0; i < plain.cloud.size(); ++i) {
    EXPECT_LT((framed.cloud[i].position - turn * plain.cloud[i].position - shift).norm(), 1e-5f);
    EXPECT_LT((framed.cloud[i].normal - turn * plain.cloud[i].normal).norm(), 1e-5f);
  }
  ASSERT_EQ(plain.rest_planes.size(), 1u);
  ASSERT_EQ(framed.rest_planes.size(), 1u);
  for (const float height : {0.0f, 0.1f}) {
    const Eigen::Vector3f on_board(0.02f, 0.03f, height);
    EXPECT_NEAR(plain.rest_planes[0].heightOf(on_board), height, 0.0005f);
    EXPECT_NEAR(framed.rest_planes[0].heightOf((kPlace.inverse() * on_board.cast<double>()).cast<float>()), height,
                0.0005f);
  }
  const ModelFeatures& before = plain.features.at(DescriptorType::kSift);
  const ModelFeatures& after = framed.features.at(DescriptorType::kSift);
  ASSERT_EQ(after.count(), before.count());
  for (size_t i = 0; i < before.positions.size(); ++i) {
    EXPECT_LT((after.positions[i] - turn * before.positions[i] - shift).norm(), 1e-5f);
    EXPECT_LT((after.view_directions[i] - turn * before.view_directions[i]).norm(), 1e-5f);
    EXPECT_LT((after.orientations[i] - turn * before.orientations[i]).norm(), 1e-5f);
  }
}

// A camera that measures all a little too far sees object and board lower.
TEST_F(Recording, ItStandsWhereDepthSeesTheBoard) {
  RecordedObject object({}, FeatureParameters(), charuco());
  for (RgbdFrame frame : *frames_) {
    frame.depth = cv::Mat(frame.depth * 1.01).clone();
    object.add({frame, std::nullopt, {}});
  }
  const ObjectModel model = object.build("box", {}).model;
  EXPECT_NEAR(model.rest_planes.at(0).offset, -0.01 * 0.7 * std::sin(40.0 * CV_PI / 180.0), 0.001);
}

TEST_F(Recording, GivenPosesThatAreWrongAreNoticed) {
  RecordedObject object({}, FeatureParameters(), std::nullopt);
  for (size_t i = 0; i < frames_->size(); ++i) {
    const Eigen::Vector3d shift(i % 2 ? 0.03 : 0.0, 0.0, 0.0);
    object.add({(*frames_)[i],
                orbitPose(15.0 * static_cast<double>(i), 40.0, 0.7, {0, 0, 0.05}) * Eigen::Translation3d(shift),
                {}});
  }
  EXPECT_THAT(reasonAgainst(object), HasSubstr("poses"));
}

TEST_F(Recording, OneLabelledViewMakesAPartialModel) {
  RecordedObject object({}, FeatureParameters(), std::nullopt);
  const RgbdFrame& frame = frames_->front();
  EXPECT_NE(object.add({frame, std::nullopt, {}}), "");  // neither pose nor mask
  cv::Mat mask(frame.depth.size(), CV_8UC1, cv::Scalar(0));
  const Pose board_from_camera = orbitPose(0.0, 40.0, 0.7, {0, 0, 0.05}).inverse();
  for (int v = 0; v < mask.rows; ++v)
    for (int u = 0; u < mask.cols; ++u) {
      const float z = frame.depth.at<float>(v, u);
      if (z > 0.0f && (board_from_camera * frame.color_camera.unproject(u, v, z)).z() > 0.01)
        mask.at<uchar>(v, u) = 255;
    }
  EXPECT_EQ(object.add({frame, std::nullopt, mask}), "");
  const RecordedObject::Result result = object.build("part", {DescriptorType::kSift});
  EXPECT_GT(result.model.cloud.size(), 500u);
  EXPECT_GT(result.model.features.at(DescriptorType::kSift).count(), 50);
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  for (const SurfacePoint& point : result.model.cloud)
    mean += point.position / static_cast<float>(result.model.cloud.size());
  EXPECT_LT(mean.norm(), 0.03f);
  EXPECT_THAT(result.report.warnings, Contains(HasSubstr("partial")));
  EXPECT_TRUE(result.model.rest_planes.empty());
}

class OnBoard : public testing::TestWithParam<const char*> {};

TEST_P(OnBoard, ARecordingMakesAModel) {
  const FiducialBoard board = shippedBoard(GetParam());
  RecordedObject object({}, FeatureParameters(), board);
  for (const RgbdFrame& frame : recordTurn(Turntable(board, boxMesh(kSize, blobTexture(768, 5)), kPlace), 24))
    object.add({frame, std::nullopt, {}});
  EXPECT_GE(object.views(), 12);
  const RecordedObject::Result result = object.build("box", {DescriptorType::kSift});
  EXPECT_LT(result.report.residual, 0.002);
  const Pose box_from_model = kPlace.inverse() * Eigen::Translation3d(0.02, -0.01, 0.0);
  EXPECT_LT(rmsFromBox(result.model.cloud, box_from_model), 0.004);
  EXPECT_GT(result.model.features.at(DescriptorType::kSift).count(), 200);
}

INSTANTIATE_TEST_SUITE_P(Boards, OnBoard, testing::Values("aruco", "two_checkerboards"));

TEST(RecordedObject, BoardOfAnotherSizeIsNoticedByDepth) {
  const Turntable turntable(charuco(), boxMesh(kSize, blobTexture(512, 5)), kPlace, 1.1);
  RecordedObject object({}, FeatureParameters(), charuco());
  for (const RgbdFrame& frame : recordTurn(turntable, 3)) object.add({frame, std::nullopt, {}});
  EXPECT_THAT(reasonAgainst(object), HasSubstr("true size"));
}

// The first half of the turn makes a model, the second one, of the same box laid on its side, adds to it.
TEST_F(Recording, ViewsOfTheBoxLaidOnItsSideExtendTheModel) {
  const Pose laid = Pose(Eigen::Translation3d(0.0, 0.0, 0.03)) * Eigen::AngleAxisd(CV_PI / 2, Eigen::Vector3d::UnitX());
  const Turntable turntable(charuco(), boxMesh(kSize, blobTexture(768, 5)), laid);
  RecordedObject standing({}, FeatureParameters(), charuco()), lying({}, FeatureParameters(), charuco());
  for (const RgbdFrame& frame : *frames_) standing.add({frame, std::nullopt, {}});
  for (const RgbdFrame& frame : recordTurn(turntable, 24)) lying.add({frame, std::nullopt, {}});
  const ObjectModel model = standing.build("box", {DescriptorType::kSift}).model;
  const ObjectModel extended = extendModel(model, lying.build("box", {DescriptorType::kSift}).model, {});
  EXPECT_GT(extended.cloud.size(), model.cloud.size());
  const Pose box_from_model = kPlace.inverse() * Eigen::Translation3d(0.02, -0.01, 0.0);
  EXPECT_LT(rmsFromBox(extended.cloud, box_from_model), 0.003);
  int below = 0;
  for (const SurfacePoint& point : extended.cloud) {
    const Eigen::Vector3f p = (box_from_model * point.position.cast<double>()).cast<float>();
    below += p.z() < -0.5f * kSize.z() + 0.004f && p.head<2>().cwiseAbs().maxCoeff() < 0.025f;
  }
  EXPECT_GT(below, 100) << "points of the box's bottom, which stood on the board at first";
}

TEST_F(Recording, ViewsOfTheSameSideAreNotTakenForTheUnderside) {
  const TemporaryDirectory directory;
  TrainingSettings settings;
  settings.types = {DescriptorType::kSift};
  ObjectTrainer trainer(directory / "store", settings);
  TrainingListener listener;
  TrainingTask task;
  task.name = "box";
  TrainingOutcome outcomes[2];
  for (TrainingOutcome& outcome : outcomes) {
    size_t next = 0;
    outcome = trainer.trainFromViews(
        task, charuco(),
        [&next](RecordedView* view) {
          if (next < frames_->size()) *view = {(*frames_)[next], std::nullopt, {}};
          return next++ < frames_->size();
        },
        listener);
    task.existing = ExistingModel::kExtend;
  }
  EXPECT_THAT(outcomes[1].report.warnings, Contains(HasSubstr("stood on")));
  // Sigma still has what is not seen.
  EXPECT_NEAR(outcomes[1].model.extents.sigma_min, outcomes[0].model.extents.sigma_min, 1e-6);
}

TEST_F(Recording, ViewsOfAnotherObjectDoNotExtendTheModel) {
  const Turntable turntable(charuco(), boxMesh(kSize, blobTexture(768, 99)), kPlace);
  RecordedObject first({}, FeatureParameters(), charuco()), second({}, FeatureParameters(), charuco());
  for (const RgbdFrame& frame : *frames_) first.add({frame, std::nullopt, {}});
  for (const RgbdFrame& frame : recordTurn(turntable, 6)) second.add({frame, std::nullopt, {}});
  EXPECT_THROW(extendModel(first.build("box", {DescriptorType::kSift}).model,
                           second.build("box", {DescriptorType::kSift}).model, {}),
               std::runtime_error);
}

TEST_F(Recording, TellsHowFarItIsAndCanBeCancelled) {
  RecordedObject object({}, FeatureParameters(), charuco());
  for (const RgbdFrame& frame : *frames_) object.add({frame, std::nullopt, {}});
  std::vector<std::string> stages;
  const auto listen = [&stages](const std::string& stage, double done) {
    EXPECT_GE(done, 0.0);
    EXPECT_LE(done, 1.0);
    if (stages.empty() || stages.back() != stage) stages.push_back(stage);
    if (stage == "fusion") throw TrainingCancelled();
  };
  EXPECT_THROW(object.build("box", {}, listen), TrainingCancelled);
  EXPECT_EQ(stages, (std::vector<std::string>{"alignment", "fusion"}));
}

TEST_F(Recording, PicturesShowTheObjectAndWhatIsCovered) {
  RecordedObject object({}, FeatureParameters(), charuco());
  const RgbdFrame& frame = frames_->front();
  EXPECT_EQ(object.add({frame, std::nullopt, {}}), "");
  ASSERT_TRUE(object.lastPose());
  const cv::Mat mask = cutOutObject({frame, object.lastPose(), {}}, {});
  ASSERT_EQ(mask.size(), frame.depth.size());
  const Eigen::Vector2d middle = frame.color_camera.project(*object.lastPose() * Eigen::Vector3d(0.02, -0.01, 0.07));
  EXPECT_EQ(mask.at<uchar>(cvRound(middle.y()), cvRound(middle.x())), 255);
  EXPECT_EQ(cv::countNonZero(cutOutObject({frame, std::nullopt, {}}, {})), 0);
  const cv::Mat drawn = drawTrainingView(frame, object.lastPose(), mask, "1 view");
  EXPECT_EQ(drawn.size(), frame.color.size());
  EXPECT_LT(cv::mean(drawn, mask.empty() ? mask : 255 - mask)[0], cv::mean(frame.color, 255 - mask)[0]);
  EXPECT_GT(object.roughCloud().size(), 300u);

  const auto green = [](const cv::Mat& picture) {
    cv::Mat is_green;
    cv::inRange(picture, cv::Scalar(70, 150, 50), cv::Scalar(90, 170, 70), is_green);
    return cv::countNonZero(is_green);
  };
  EXPECT_EQ(green(drawCoverage({}, std::nullopt)), 0);
  const int one = green(drawCoverage(object.viewDirections(), object.viewDirections().front()));
  EXPECT_GT(one, 1000);
  object.add({(*frames_)[12], std::nullopt, {}});
  EXPECT_GT(green(drawCoverage(object.viewDirections(), std::nullopt)), 1.5 * one);
}

TEST(RecordedObject, ObjectThatMovesOnTheBoardIsNoticed) {
  const TexturedMesh box = boxMesh(kSize, blobTexture(512, 5));
  const Pose pushed = Pose(Eigen::Translation3d(0.03, 0.01, 0.0)) * kPlace;
  const Turntable before(charuco(), box, kPlace), after(charuco(), box, pushed);
  RecordedObject object({}, FeatureParameters(), charuco());
  for (int i = 0; i < 24; ++i) object.add({viewOfTurn(i < 12 ? before : after, i, 24), std::nullopt, {}});
  EXPECT_THAT(reasonAgainst(object), HasSubstr("move"));
}

TEST(RecordedObject, DepthThatIsNotRegisteredIsNoticed) {
  const TexturedMesh box = boxMesh(kSize, blobTexture(512, 5));
  const Turntable color(charuco(), box, kPlace);
  Turntable depth(charuco(), box, kPlace);
  depth.camera.fx = depth.camera.fy = 580.0;  // a Kinect's infrared camera, 25 mm beside the other
  RecordedObject object({}, FeatureParameters(), charuco());
  for (int i = 0; i < 6; ++i) {
    const Pose camera_from_board = orbitPose(60.0 * i, 40.0, 0.7, {0, 0, 0.05});
    RgbdFrame frame = color.view(camera_from_board, 1);
    frame.depth = depth.view(Pose(Eigen::Translation3d(0.025, 0, 0)) * camera_from_board, 2).depth;
    object.add({frame, std::nullopt, {}});
  }
  EXPECT_THAT(reasonAgainst(object), HasSubstr("registered"));
}

TEST(RecordedObject, ObjectLargerThanTheBoardIsRefused) {
  const Turntable turntable(charuco(), boxMesh({0.62f, 0.1f, 0.1f}, blobTexture(512, 5)),
                            Pose(Eigen::Translation3d(0, 0.15, 0.05)));
  RecordedObject object({}, FeatureParameters(), charuco());
  for (int i = 0; i < 6; ++i)
    object.add({turntable.view(orbitPose(60.0 * i, 60.0, 1.1, {0, 0, 0}), 1), std::nullopt, {}});
  EXPECT_THAT(reasonAgainst(object), HasSubstr("larger than the board"));
}

TEST(RecordedObject, EmptyBoardAndNoViews) {
  TexturedMesh away = boxMesh({0.01f, 0.01f, 0.01f}, cv::Mat(8, 8, CV_8UC3, cv::Scalar()));
  const Turntable turntable(charuco(), away, Pose(Eigen::Translation3d(0, 0, -0.2)));
  RecordedObject object({}, FeatureParameters(), charuco());
  EXPECT_THROW(object.build("nothing", {}), std::runtime_error);
  for (const RgbdFrame& frame : recordTurn(turntable, 2)) object.add({frame, std::nullopt, {}});
  EXPECT_THAT(reasonAgainst(object), HasSubstr("nothing stands"));
}

}  // namespace
}  // namespace recognition
