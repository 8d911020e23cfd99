#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/features2d.hpp>

#include "features/lifting.h"
#include "rgbd_recognition/training/recorded_object.h"
#include "training/turntable.h"
#include "features/feature_extractor.h"
#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/features/feature_parameters.h"

namespace recognition {
namespace {

// Features of a view whose most similar one of the model is where they are.
int countRecognised(const ObjectModel& model, const RgbdFrame& frame, const Pose& camera_from_model) {
  const auto extractor = makeFeatureExtractor(FeatureParameters());
  const SceneFeatures scene = liftFeatures(extractor->extract(toGray(frame.color, frame.color_order), cv::Mat()),
                                           frame.depth, frame.depthCamera(), 1);
  const ModelFeatures& features = model.features.at(scene.image.type);
  std::vector<cv::DMatch> matches;
  cv::BFMatcher(cv::NORM_L2).match(scene.image.descriptors, unitDescriptors(features.descriptors), matches);
  return static_cast<int>(std::count_if(matches.begin(), matches.end(), [&](const cv::DMatch& match) {
    const Eigen::Vector3d place =
        camera_from_model * features.positions[static_cast<size_t>(match.trainIdx)].cast<double>();
    return (place - scene.points[static_cast<size_t>(match.queryIdx)].cast<double>()).norm() < 0.01;
  }));
}

TEST(RecordedFeatures, AreLearntAsFromFartherAway) {
  const Pose place(Eigen::Translation3d(0.02, -0.01, 0.07));
  const Turntable turntable(charuco(), boxMesh({0.1f, 0.06f, 0.14f}, blobTexture(768, 5)), place);
  const std::vector<RgbdFrame> frames = recordTurn(turntable, 24);
  const Pose camera_from_board = orbitPose(100.0, 40.0, 1.8, {0, 0, 0.05});
  const RgbdFrame far = turntable.view(camera_from_board, 99);
  int recognised[2];
  for (const int distances : {1, 3}) {
    RecordingParameters parameters;
    parameters.distances = distances;
    RecordedObject object(parameters, FeatureParameters(), charuco());
    for (const RgbdFrame& frame : frames) object.add({frame, std::nullopt, {}});
    const ObjectModel model = object.build("box", {FeatureParameters().descriptor}).model;
    recognised[distances / 2] = countRecognised(model, far, camera_from_board * Eigen::Translation3d(0.02, -0.01, 0.0));
  }
  EXPECT_GT(recognised[0], 10);
  EXPECT_GT(recognised[1], recognised[0]);
}

}  // namespace
}  // namespace recognition
