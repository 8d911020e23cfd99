#pragma once

#include <memory>
#include <random>
#include <string>
#include <vector>

#include "rgbd_recognition/features/feature_types.h"
#include "rgbd_recognition/matching/hypothesis.h"
#include "rgbd_recognition/model/object_model.h"

namespace recognition::synthetic {

/// Random unit-length descriptors.
inline cv::Mat randomDescriptors(int count, int length, std::mt19937& random) {
  std::normal_distribution<float> normal;
  cv::Mat descriptors(count, length, CV_32FC1);
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < length; ++k) descriptors.at<float>(i, k) = normal(random);
    descriptors.row(i) /= cv::norm(descriptors.row(i));
  }
  return descriptors;
}

/// The descriptors moved by about `distance`, unit length again.
inline cv::Mat perturbed(const cv::Mat& descriptors, double distance, std::mt19937& random) {
  cv::Mat moved = descriptors + distance * randomDescriptors(descriptors.rows, descriptors.cols, random);
  for (int i = 0; i < moved.rows; ++i) moved.row(i) /= cv::norm(moved.row(i));
  return moved;
}

inline Eigen::Vector3f randomPoint(double half_size, std::mt19937& random) {
  std::uniform_real_distribution<float> uniform(static_cast<float>(-half_size), static_cast<float>(half_size));
  return {uniform(random), uniform(random), uniform(random)};
}

inline Pose randomPose(std::mt19937& random) {
  const Eigen::Vector3f axis = randomPoint(1.0, random), shift = randomPoint(0.3, random);
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(3.0 * axis.norm(), axis.cast<double>().normalized()).toRotationMatrix();
  pose.translation() = shift.cast<double>() + Eigen::Vector3d(0.0, 0.0, 1.0);
  return pose;
}

/// A model with features at random places of a cube of 0.2 m.
inline std::shared_ptr<ObjectModel> randomModel(const std::string& name, int features, std::mt19937& random) {
  auto model = std::make_shared<ObjectModel>();
  model->name = name;
  ModelFeatures& of_type = model->features[DescriptorType::kSurf128];
  of_type.descriptors = randomDescriptors(features, 128, random);
  for (int i = 0; i < features; ++i) of_type.positions.push_back(randomPoint(0.1, random));
  return model;
}

inline ModelDatabase randomDatabase(int objects, int features, std::mt19937& random) {
  ModelDatabase database;
  for (int i = 0; i < objects; ++i)
    database.objects.push_back(randomModel("object_" + std::to_string(i), features, random));
  return database;
}

/// Adds a scene feature at `point`, seen by a camera of focal length 525.
inline void addFeature(SceneFeatures& scene, const Eigen::Vector3f& point, const cv::Mat& descriptor) {
  Keypoint keypoint;
  keypoint.x = 525.0f * point.x() / point.z() + 319.5f;
  keypoint.y = 525.0f * point.y() / point.z() + 239.5f;
  keypoint.size = 20.0f;
  scene.image.keypoints.push_back(keypoint);
  scene.points.push_back(point);
  scene.image.descriptors.push_back(descriptor);
}

/// Adds the first `features` features of an object, with noise of the places (metres) and descriptors.
inline void addInstance(SceneFeatures& scene, const ObjectModel& model, const Pose& camera_from_object, int features,
                        double noise, std::mt19937& random) {
  const ModelFeatures& of_type = model.features.at(DescriptorType::kSurf128);
  const cv::Mat descriptors = perturbed(of_type.descriptors, 0.3, random);
  for (int i = 0; i < features; ++i) {
    const Eigen::Vector3f place = camera_from_object.cast<float>() * of_type.positions[i];
    addFeature(scene, place + randomPoint(noise, random), descriptors.row(i));
  }
}

/// Adds features that belong to nothing.
inline void addClutter(SceneFeatures& scene, int features, std::mt19937& random) {
  const cv::Mat descriptors = randomDescriptors(features, 128, random);
  for (int i = 0; i < features; ++i)
    addFeature(scene, randomPoint(0.4, random) + Eigen::Vector3f(0.0f, 0.0f, 1.0f), descriptors.row(i));
}

/// Correspondences of one object with a known answer: the first `inliers` are right, the others pair random features.
struct Problem {
  std::vector<Correspondence> pairs;  ///< by falling rank; distances do not tell right from wrong
  std::vector<Eigen::Vector3f> scene_points, model_points;
  Pose camera_from_object;
  int inliers = 0;
};

inline Problem makeProblem(int count, double outlier_ratio, double noise, std::mt19937& random) {
  Problem problem;
  problem.camera_from_object = randomPose(random);
  problem.inliers = static_cast<int>(count * (1.0 - outlier_ratio) + 0.5);
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3f model = randomPoint(0.1, random);
    const Eigen::Vector3f right = problem.camera_from_object.cast<float>() * model + randomPoint(noise, random);
    const Eigen::Vector3f wrong = randomPoint(0.4, random) + Eigen::Vector3f(0.0f, 0.0f, 1.0f);
    problem.model_points.push_back(model);
    problem.scene_points.push_back(i < problem.inliers ? right : wrong);
    problem.pairs.push_back({i, i, 0.0f});
  }
  std::shuffle(problem.pairs.begin(), problem.pairs.end(), random);
  for (int i = 0; i < count; ++i) problem.pairs[i].distance = 0.001f * static_cast<float>(i);
  return problem;
}

}  // namespace recognition::synthetic
