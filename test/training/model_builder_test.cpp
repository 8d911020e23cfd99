#include "training/model_builder.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "meshes/sample_meshes.h"
#include "meshes/surface_sampling.h"
#include "rgbd_recognition/features/feature_parameters.h"
#include "training/feature_merging.h"

namespace recognition {
namespace {

const Eigen::Vector3f kBox(0.1f, 0.2f, 0.06f);

TexturedMesh texturedBox() { return boxMesh(kBox, blobTexture(768, 5)); }

TrainingParameters quickTraining() {
  TrainingParameters parameters;
  parameters.views = 16;
  parameters.distances = 1;
  return parameters;
}

ObjectModel quickModel() {
  return buildModelFromMesh(texturedBox(), "box", quickTraining(), FeatureParameters(), {DescriptorType::kSift});
}

TEST(ModelBuilder, FeaturesLieOnTheSurfaceAndLookOutwards) {
  const ObjectModel model = quickModel();
  const ModelFeatures& features = model.features.at(DescriptorType::kSift);
  ASSERT_GT(features.count(), 300);
  ASSERT_EQ(features.positions.size(), static_cast<size_t>(features.count()));
  ASSERT_EQ(features.sizes.size(), features.positions.size());
  ASSERT_EQ(features.views.size(), features.positions.size());
  for (int i = 0; i < features.count(); ++i) {
    const auto k = static_cast<size_t>(i);
    EXPECT_LT(distanceToBox(features.positions[k], kBox), 0.001) << features.positions[k].transpose();
    EXPECT_NEAR(features.view_directions[k].norm(), 1.0f, 1e-5f);
    EXPECT_NEAR(features.orientations[k].norm(), 1.0f, 1e-5f);
    EXPECT_NEAR(features.orientations[k].dot(features.view_directions[k]), 0.0f, 1e-4f);
    EXPECT_NEAR(cv::norm(features.descriptors.row(i)), 1.0, 1e-5);
    EXPECT_GT(features.sizes[k], 0.0005f);
    EXPECT_LT(features.sizes[k], 0.2f);
    Eigen::Index axis;
    const Eigen::Vector3f share = features.positions[k].cwiseQuotient(kBox);
    share.cwiseAbs().maxCoeff(&axis);
    EXPECT_GT(share[axis] * features.view_directions[k][axis], 0.0f);
  }
}

TEST(ModelBuilder, FeaturesAreMergedOverViews) {
  const ObjectModel model = quickModel();
  const ModelFeatures& features = model.features.at(DescriptorType::kSift);
  EXPECT_GE(features.views.front(), 3);
  EXPECT_TRUE(std::is_sorted(features.views.rbegin(), features.views.rend()));
}

TEST(ModelBuilder, SameModelForAnyNumberOfThreads) {
  cv::setNumThreads(1);
  const ObjectModel one = quickModel();
  cv::setNumThreads(8);
  const ObjectModel many = quickModel();
  cv::setNumThreads(-1);
  EXPECT_EQ(cv::norm(one.features.at(DescriptorType::kSift).descriptors,
                     many.features.at(DescriptorType::kSift).descriptors, cv::NORM_INF),
            0.0);
  EXPECT_EQ(one.features.at(DescriptorType::kSift).positions, many.features.at(DescriptorType::kSift).positions);
}

TEST(ModelBuilder, AtMostSoManyFeatures) {
  TrainingParameters parameters = quickTraining();
  parameters.merging.max_features = 100;
  const ObjectModel model =
      buildModelFromMesh(texturedBox(), "box", parameters, FeatureParameters(), {DescriptorType::kSift});
  EXPECT_EQ(model.features.at(DescriptorType::kSift).count(), 100);
}

TEST(ModelBuilder, PlainObjectHasNoFeaturesButAShape) {
  const TexturedMesh plain = boxMesh(kBox, cv::Mat(64, 64, CV_8UC3, cv::Scalar(50, 50, 50)));
  const ObjectModel model =
      buildModelFromMesh(plain, "plain", quickTraining(), FeatureParameters(), {DescriptorType::kSift});
  EXPECT_LT(model.features.at(DescriptorType::kSift).count(), 30);
  EXPECT_GT(model.cloud.size(), 1000u);
}

TEST(ModelBuilder, RejectsWhatCannotBeSeen) {
  TexturedMesh flat = texturedBox();
  for (Eigen::Vector3f& vertex : flat.vertices) vertex = Eigen::Vector3f::Zero();
  EXPECT_THROW(buildModelFromMesh(flat, "flat", quickTraining(), FeatureParameters(), {DescriptorType::kSift}),
               std::invalid_argument);
  TrainingParameters parameters;
  parameters.views = 0;
  EXPECT_THROW(buildModelFromMesh(texturedBox(), "box", parameters, FeatureParameters(), {}), std::invalid_argument);
}

TEST(SurfaceSampling, CoversTheBoxEvenly) {
  const double spacing = 0.003;
  const std::vector<SurfacePoint> cloud = sampleSurface(texturedBox(), spacing, 100000);
  const double area = 2.0 * (0.1 * 0.2 + 0.2 * 0.06 + 0.06 * 0.1);
  EXPECT_NEAR(static_cast<double>(cloud.size()), area / (spacing * spacing), 0.15 * area / (spacing * spacing));
  for (const SurfacePoint& point : cloud) {
    EXPECT_LT(distanceToBox(point.position, kBox), 1e-6);
    EXPECT_GT(point.position.dot(point.normal), 0.0f);
  }
  const Extents extents = computeExtents(cloud);
  EXPECT_GT(extents.sigma_max, extents.sigma_min);
}

// A box in a box cannot be seen.
TEST(SurfaceSampling, LeavesTheInsideOut) {
  TexturedMesh mesh = texturedBox();
  const auto vertices = static_cast<std::uint32_t>(mesh.vertices.size());
  const size_t triangles = mesh.triangles.size();
  for (std::uint32_t i = 0; i < vertices; ++i) {
    mesh.vertices.push_back(0.5f * mesh.vertices[i]);
    mesh.normals.push_back(mesh.normals[i]);
    mesh.texture_coordinates.push_back(mesh.texture_coordinates[i]);
  }
  for (size_t i = 0; i < triangles; ++i) {
    const auto t = mesh.triangles[i];
    mesh.triangles.push_back({t[0] + vertices, t[1] + vertices, t[2] + vertices});
  }
  for (const SurfacePoint& point : sampleSurface(mesh, 0.004, 100000))
    EXPECT_LT(distanceToBox(point.position, kBox), 1e-6);
}

TEST(SurfaceSampling, NormalsLookOutwardsWhateverTheMeshSays) {
  TexturedMesh mesh = texturedBox();
  for (Eigen::Vector3f& normal : mesh.normals) normal = -normal;
  for (const SurfacePoint& point : sampleSurface(mesh, 0.004, 100000))
    EXPECT_GT(point.position.dot(point.normal), 0.0f);
}

// As tools export a box of eight vertices and twelve triangles.
TEST(SurfaceSampling, NormalsSmoothedOverABoxesEdgesAreItsFaces) {
  TexturedMesh mesh = texturedBox();
  for (size_t i = 0; i < mesh.vertices.size(); ++i) mesh.normals[i] = mesh.vertices[i].cwiseSign().normalized();
  for (const SurfacePoint& point : sampleSurface(mesh, 0.004, 100000))
    EXPECT_NEAR(point.normal.cwiseAbs().maxCoeff(), 1.0f, 1e-5f);
}

TEST(SurfaceSampling, HoldsToTheLargestCount) {
  EXPECT_LE(sampleSurface(texturedBox(), 0.001, 2000).size(), 2000u);
  EXPECT_GT(sampleSurface(texturedBox(), 0.001, 2000).size(), 1500u);
}

ModelFeatures featureAt(const Eigen::Vector3f& position, float size, float angle) {
  ModelFeatures features;
  features.descriptors = (cv::Mat_<float>(1, 2) << std::cos(angle), std::sin(angle));
  features.positions = {position};
  features.view_directions = {Eigen::Vector3f::UnitZ()};
  features.sizes = {size};
  features.views = {1};
  return features;
}

TEST(FeatureMerging, JoinsSamePlaceSizeAndLookOnly) {
  const MergingParameters parameters;
  const ModelFeatures first = featureAt({0, 0, 0}, 0.01f, 0.0f);
  const ModelFeatures merged = mergeFeatures({first, featureAt({0.002f, 0, 0}, 0.012f, 0.2f)}, parameters);
  ASSERT_EQ(merged.count(), 1);
  EXPECT_EQ(merged.views[0], 2);
  EXPECT_NEAR(merged.positions[0].x(), 0.001f, 1e-6f);
  EXPECT_NEAR(merged.sizes[0], 0.011f, 1e-6f);
  EXPECT_NEAR(merged.descriptors.at<float>(0, 0), std::cos(0.1f), 1e-5f);
  EXPECT_NEAR(merged.descriptors.at<float>(0, 1), std::sin(0.1f), 1e-5f);
  EXPECT_EQ(mergeFeatures({first, featureAt({0.006f, 0, 0}, 0.01f, 0.0f)}, parameters).count(), 2);
  EXPECT_EQ(mergeFeatures({first, featureAt({0, 0, 0}, 0.02f, 0.0f)}, parameters).count(), 2);
  EXPECT_EQ(mergeFeatures({first, featureAt({0, 0, 0}, 0.01f, 0.7f)}, parameters).count(), 2);
  EXPECT_EQ(mergeFeatures({}, parameters).count(), 0);
}

TEST(FeatureMerging, KeepsThoseSeenMost) {
  MergingParameters parameters;
  parameters.max_features = 10;
  std::vector<ModelFeatures> views;
  for (int i = 0; i < 20; ++i) views.push_back(featureAt({0.1f * static_cast<float>(i), 0, 0}, 0.01f, 0.0f));
  views.push_back(featureAt({1.9f, 0, 0}, 0.01f, 0.1f));
  const ModelFeatures merged = mergeFeatures(views, parameters);
  ASSERT_EQ(merged.count(), 10);
  EXPECT_NEAR(merged.positions[0].x(), 1.9f, 1e-6f);
  EXPECT_EQ(merged.views[0], 2);
  EXPECT_EQ(merged.views[1], 1);
}

}  // namespace
}  // namespace recognition
