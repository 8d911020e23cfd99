#pragma once

#include <cstdint>
#include <string>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "rgbd_recognition/model/object_model.h"

namespace recognition {

inline ModelFeatures randomFeatures(DescriptorType type, int count, cv::RNG& rng) {
  ModelFeatures features;
  features.descriptors.create(count, descriptorLength(type), CV_32FC1);
  rng.fill(features.descriptors, cv::RNG::NORMAL, 0.0, 1.0);
  for (int i = 0; i < count; ++i) {
    cv::Mat row = features.descriptors.row(i);
    row /= cv::norm(row);
    features.positions.emplace_back(rng.uniform(-0.1f, 0.1f), rng.uniform(-0.1f, 0.1f), rng.uniform(-0.1f, 0.1f));
    features.view_directions.push_back(
        Eigen::Vector3f(rng.uniform(-1.0f, 1.0f), rng.uniform(-1.0f, 1.0f), 0.5f).normalized());
    if (type == DescriptorType::kSift)
      features.orientations.push_back(features.view_directions.back().unitOrthogonal());
    features.sizes.push_back(rng.uniform(0.002f, 0.05f));
    features.views.push_back(static_cast<std::uint16_t>(rng.uniform(1, 40)));
  }
  return features;
}

/// A model as a store holds it, with values that try the formats: texts with quotes and line ends, features with and
/// without orientations.
inline ObjectModel randomModel(const std::string& name) {
  cv::RNG rng(7);
  ObjectModel model;
  model.name = name;
  model.challenge_id = 12;
  model.source = "meshes/a \"quoted\": name.ply";
  model.provenance = {{"views", "40"}, {"note", "line one\nline two"}};
  for (int i = 0; i < 200; ++i)
    model.cloud.push_back({{rng.uniform(-0.1f, 0.1f), rng.uniform(-0.1f, 0.1f), rng.uniform(-0.1f, 0.1f)},
                           Eigen::Vector3f(rng.uniform(-1.0f, 1.0f), 0.3f, 0.1f).normalized(),
                           cv::Vec3b(static_cast<uchar>(i), 20, 250)});
  model.extents = computeExtents(model.cloud);
  model.rest_planes = {{Eigen::Vector3f(0.0f, 0.6f, 0.8f), -0.0625f}, {Eigen::Vector3f::UnitX(), 0.125f}};
  model.features[DescriptorType::kSift] = randomFeatures(DescriptorType::kSift, 50, rng);
  model.features[DescriptorType::kSurf64] = randomFeatures(DescriptorType::kSurf64, 30, rng);
  return model;
}

}  // namespace recognition
