#include "ros/message_conversions.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include <boost/make_shared.hpp>

#include "ros/image_conversions.h"
#include "rgbd_recognition/matching/scene_matches.h"

namespace recognition {
namespace {

void require(bool good, const std::string& message) {
  if (!good) throw std::invalid_argument(message);
}

template <typename Point>
Point pointMessage(const Eigen::Vector3f& p) {
  Point message;
  message.x = p.x(), message.y = p.y(), message.z = p.z();
  return message;
}

template <typename Point>
Eigen::Vector3f vectorFrom(const Point& p) {
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

messages::Patch toMessage(const Patch& patch) {
  messages::Patch message;
  message.label = patch.label;
  message.pixels = static_cast<std::uint32_t>(patch.pixels);
  message.box.x_offset = static_cast<std::uint32_t>(patch.box.x);
  message.box.y_offset = static_cast<std::uint32_t>(patch.box.y);
  message.box.width = static_cast<std::uint32_t>(patch.box.width);
  message.box.height = static_cast<std::uint32_t>(patch.box.height);
  message.centroid = pointMessage<geometry_msgs::Point>(patch.centroid);
  for (int i = 0; i < 3; ++i) {
    message.eigenvalues[static_cast<size_t>(i)] = patch.eigenvalues[i];
    message.axes[static_cast<size_t>(i)] = pointMessage<geometry_msgs::Vector3>(patch.axes.col(i));
  }
  return message;
}

Patch fromMessage(const messages::Patch& message) {
  Patch patch;
  patch.label = message.label;
  patch.pixels = static_cast<int>(message.pixels);
  patch.box = {static_cast<int>(message.box.x_offset), static_cast<int>(message.box.y_offset),
               static_cast<int>(message.box.width), static_cast<int>(message.box.height)};
  patch.centroid = vectorFrom(message.centroid);
  for (int i = 0; i < 3; ++i) {
    patch.eigenvalues[i] = message.eigenvalues[static_cast<size_t>(i)];
    patch.axes.col(i) = vectorFrom(message.axes[static_cast<size_t>(i)]);
  }
  return patch;
}

messages::ImageFeatures toMessage(const ImageFeatures& features) {
  messages::ImageFeatures message;
  message.descriptor = descriptorName(features.type);
  for (const Keypoint& keypoint : features.keypoints) {
    message.x.push_back(keypoint.x);
    message.y.push_back(keypoint.y);
    message.size.push_back(keypoint.size);
    message.angle.push_back(keypoint.angle);
    message.response.push_back(keypoint.response);
    message.bright.push_back(keypoint.bright);
  }
  for (int i = 0; i < features.descriptors.rows; ++i) {
    const float* row = features.descriptors.ptr<float>(i);
    message.descriptors.insert(message.descriptors.end(), row, row + features.descriptors.cols);
  }
  return message;
}

ImageFeatures fromMessage(const messages::ImageFeatures& message) {
  ImageFeatures features;
  features.type = descriptorFromName(message.descriptor);
  const size_t n = message.x.size(), length = static_cast<size_t>(descriptorLength(features.type));
  require(message.y.size() == n && message.size.size() == n && message.angle.size() == n &&
              message.response.size() == n && message.bright.size() == n && message.descriptors.size() == n * length,
          "features have " + std::to_string(n) + " x, " + std::to_string(message.y.size()) + " y, and " +
              std::to_string(message.descriptors.size()) + " descriptor values: arrays do not fit");
  require(std::all_of(message.descriptors.begin(), message.descriptors.end(),
                      [](float value) { return std::isfinite(value); }),
          "descriptors of features hold a value that is not finite");
  for (const auto* values : {&message.x, &message.y, &message.size, &message.angle})
    require(std::all_of(values->begin(), values->end(), [](float value) { return std::isfinite(value); }),
            "features hold a place, size or angle that is not finite");
  for (size_t i = 0; i < n; ++i)
    features.keypoints.push_back(
        {message.x[i], message.y[i], message.size[i], message.angle[i], message.response[i], message.bright[i] != 0});
  if (n > 0)
    features.descriptors = cv::Mat(static_cast<int>(n), static_cast<int>(length), CV_32FC1,
                                   const_cast<float*>(message.descriptors.data()));
  return features;
}

/// To a Hypothesis or ObjectMatches message.
template <typename Message>
void addPairs(const std::vector<Correspondence>& pairs, Message* message) {
  for (const Correspondence& pair : pairs) {
    message->scene_features.push_back(pair.scene_feature);
    message->model_features.push_back(pair.model_feature);
    message->distances.push_back(pair.distance);
  }
}

messages::Hypothesis toMessage(const Hypothesis& hypothesis, const ModelDatabase& database) {
  messages::Hypothesis message;
  message.object = database.objects.at(static_cast<size_t>(hypothesis.object))->name;
  message.pose = poseMessage(hypothesis.camera_from_object);
  addPairs(hypothesis.consensus, &message);
  return message;
}

int indexOf(const std::string& object, const ModelDatabase& database) {
  const int index = database.find(object);
  require(index >= 0,
          "object '" + object + "' is not among the " + std::to_string(database.objects.size()) + " models loaded");
  return index;
}

/// Of a Hypothesis or ObjectMatches message, whose object is number `object`.
template <typename Message>
std::vector<Correspondence> pairsOf(const Message& message, int object, const ModelDatabase& database,
                                    const SceneFeatures& features, const std::string& what) {
  const std::string whose = what + " of '" + message.object + "'";
  const auto& model = database.objects[static_cast<size_t>(object)]->features;
  const auto found = model.find(features.image.type);
  const int scene_count = static_cast<int>(features.points.size()),
            model_count = found == model.end() ? 0 : found->second.count();
  require(message.scene_features.size() == message.model_features.size() &&
              message.distances.size() == message.model_features.size(),
          whose + " has arrays of different lengths");
  std::vector<Correspondence> pairs;
  for (size_t i = 0; i < message.scene_features.size(); ++i) {
    const Correspondence pair{message.scene_features[i], message.model_features[i], message.distances[i]};
    require(pair.scene_feature >= 0 && pair.scene_feature < scene_count && pair.model_feature >= 0 &&
                pair.model_feature < model_count,
            whose + " has the correspondence " + std::to_string(pair.scene_feature) + "-" +
                std::to_string(pair.model_feature) + ", there are " + std::to_string(scene_count) + " scene and " +
                std::to_string(model_count) + " model features");
    pairs.push_back(pair);
  }
  return pairs;
}

Hypothesis fromMessage(const messages::Hypothesis& message, const ModelDatabase& database,
                       const SceneFeatures& features) {
  Hypothesis hypothesis;
  hypothesis.object = indexOf(message.object, database);
  hypothesis.camera_from_object = poseFromMessage(message.pose);
  hypothesis.consensus = pairsOf(message, hypothesis.object, database, features, "hypothesis");
  return hypothesis;
}

messages::Detection toMessage(const VerifiedHypothesis& verified, const ModelDatabase& database) {
  const ConsistencyScores& scores = verified.scores;
  messages::Detection message;
  message.object = database.objects.at(static_cast<size_t>(verified.hypothesis.object))->name;
  message.pose.pose = poseMessage(verified.camera_from_object);
  for (size_t i = 0; i < 36; ++i)
    message.pose.covariance[i] = verified.covariance(static_cast<int>(i) / 6, static_cast<int>(i) % 6);
  message.accepted = verified.accepted();
  if (!verified.accepted()) message.rejection = rejectionName(verified.rejection);
  message.conflict_with = verified.conflict_with;
  message.confidence = verified.confidence;
  message.s_d = scores.s_d;
  message.s_c = scores.s_c;
  message.s_o = scores.s_o;
  message.total = scores.total;
  message.visible = scores.visible;
  message.free_space = scores.free_space;
  message.projected = static_cast<std::uint32_t>(scores.projected);
  message.best_segment = scores.best_segment;
  message.consensus = static_cast<std::uint32_t>(verified.hypothesis.consensus.size());
  message.source = sourceName(verified.hypothesis.source);
  message.round = static_cast<std::uint32_t>(verified.hypothesis.round);
  message.inliers = static_cast<std::uint32_t>(std::max(0, verified.evidence.inliers));
  message.significance = verified.evidence.significance;
  message.segment_share = verified.evidence.segment_share;
  return message;
}

}  // namespace

geometry_msgs::Pose poseMessage(const Pose& pose) {
  const Eigen::Quaterniond q(pose.linear());
  geometry_msgs::Pose message;
  message.position.x = pose.translation().x();
  message.position.y = pose.translation().y();
  message.position.z = pose.translation().z();
  message.orientation.x = q.x();
  message.orientation.y = q.y();
  message.orientation.z = q.z();
  message.orientation.w = q.w();
  return message;
}

Pose poseFromMessage(const geometry_msgs::Pose& message) {
  const Eigen::Vector3d t(message.position.x, message.position.y, message.position.z);
  const Eigen::Quaterniond q(message.orientation.w, message.orientation.x, message.orientation.y,
                             message.orientation.z);
  require(t.allFinite(), "pose has a position that is not finite");
  require(std::abs(q.norm() - 1.0) < 1e-3, "pose has a quaternion of length " + std::to_string(q.norm()));
  Pose pose = Pose::Identity();
  pose.linear() = q.normalized().toRotationMatrix();
  pose.translation() = t;
  return pose;
}

Pose poseFromMessage(const geometry_msgs::Transform& message) {
  geometry_msgs::Pose pose;
  pose.position.x = message.translation.x;
  pose.position.y = message.translation.y;
  pose.position.z = message.translation.z;
  pose.orientation = message.rotation;
  return poseFromMessage(pose);
}

geometry_msgs::TransformStamped transformMessage(const geometry_msgs::Pose& pose, const std_msgs::Header& header,
                                                 const std::string& child) {
  geometry_msgs::TransformStamped message;
  message.header = header;
  message.child_frame_id = child;
  message.transform.translation.x = pose.position.x;
  message.transform.translation.y = pose.position.y;
  message.transform.translation.z = pose.position.z;
  message.transform.rotation = pose.orientation;
  return message;
}

messages::SegmentationPtr toMessage(const Segmentation& segmentation, const std_msgs::Header& header) {
  const auto message = boost::make_shared<messages::Segmentation>();
  message->header = header;
  fillImage(segmentation.labels, header, &message->labels);
  fillImage(segmentation.edges, header, &message->edges);
  for (const Patch& patch : segmentation.patches) message->patches.push_back(toMessage(patch));
  return message;
}

Segmentation fromMessage(const messages::Segmentation& message) {
  Segmentation segmentation;
  segmentation.labels = labelView(message.labels);
  segmentation.edges = maskView(message.edges);
  require(segmentation.labels.size() == segmentation.edges.size(), "segmentation's labels and edges differ in size");
  for (const messages::Patch& patch : message.patches) segmentation.patches.push_back(fromMessage(patch));
  const int patches = static_cast<int>(segmentation.patches.size());
  for (int i = 0; i < patches; ++i)
    require(segmentation.patches[static_cast<size_t>(i)].label == i + 1,
            "segmentation's patch " + std::to_string(i) + " has label " +
                std::to_string(segmentation.patches[static_cast<size_t>(i)].label));
  double largest = 0.0;
  cv::minMaxLoc(segmentation.labels, nullptr, &largest);
  require(largest <= patches, "segmentation has label " + std::to_string(static_cast<int>(largest)) + " and " +
                                  std::to_string(patches) + " patches");
  return segmentation;
}

messages::SceneFeaturesPtr toMessage(const SceneFeatures& features, const std_msgs::Header& header) {
  const auto message = boost::make_shared<messages::SceneFeatures>();
  message->header = header;
  message->image = toMessage(features.image);
  for (const Eigen::Vector3f& point : features.points)
    message->points.push_back(pointMessage<geometry_msgs::Point32>(point));
  for (const Eigen::Vector3f& normal : features.normals)
    message->normals.push_back(pointMessage<geometry_msgs::Point32>(normal));
  message->focal_length = features.focal_length;
  message->without_depth = toMessage(features.without_depth);
  return message;
}

SceneFeatures fromMessage(const messages::SceneFeatures& message) {
  SceneFeatures features;
  features.image = fromMessage(message.image);
  features.without_depth = fromMessage(message.without_depth);
  features.focal_length = message.focal_length;
  require(std::isfinite(features.focal_length) && features.focal_length >= 0.0f,
          "features have a focal length of " + std::to_string(features.focal_length) + " pixels");
  for (const auto& point : message.points) {
    features.points.push_back(vectorFrom(point));
    require(features.points.back().allFinite(), "features have a point that is not finite");
  }
  for (const auto& normal : message.normals) {
    features.normals.push_back(vectorFrom(normal));
    require(features.normals.back().allFinite(), "features have a normal that is not finite");
  }
  require(features.normals.empty() || features.normals.size() == features.points.size(),
          "there are " + std::to_string(features.normals.size()) + " normals for " +
              std::to_string(features.points.size()) + " points");
  require(features.points.size() == features.image.keypoints.size(),
          "there are " + std::to_string(features.points.size()) + " points for " +
              std::to_string(features.image.count()) + " features");
  return features;
}

messages::HypothesisArrayPtr toMessage(const std::vector<Hypothesis>& hypotheses, int round,
                                       const ModelDatabase& database, const std_msgs::Header& header) {
  const auto message = boost::make_shared<messages::HypothesisArray>();
  message->header = header;
  message->round = static_cast<std::uint32_t>(round);
  for (const Hypothesis& hypothesis : hypotheses) message->hypotheses.push_back(toMessage(hypothesis, database));
  return message;
}

std::vector<Hypothesis> fromMessage(const messages::HypothesisArray& message, const ModelDatabase& database,
                                    const SceneFeatures& features) {
  std::vector<Hypothesis> hypotheses;
  for (const messages::Hypothesis& hypothesis : message.hypotheses) {
    hypotheses.push_back(fromMessage(hypothesis, database, features));
    hypotheses.back().round = static_cast<int>(message.round);
  }
  return hypotheses;
}

void addMatches(const SceneMatches& matches, const ModelDatabase& database, messages::HypothesisArray* message) {
  for (size_t object = 0; object < matches.by_object.size(); ++object) {
    message->matches.emplace_back();
    message->matches.back().object = database.objects.at(object)->name;
    addPairs(matches.by_object[object], &message->matches.back());
  }
}

SceneMatches matchesFromMessage(const messages::HypothesisArray& message, const ModelDatabase& database,
                                const SceneFeatures& features) {
  SceneMatches matches;
  matches.by_object.resize(database.objects.size());
  for (const messages::ObjectMatches& own : message.matches) {
    const int object = indexOf(own.object, database);
    matches.by_object[static_cast<size_t>(object)] = pairsOf(own, object, database, features, "array of matches");
  }
  return matches;
}

messages::DetectionArrayPtr toMessage(const std::vector<VerifiedHypothesis>& hypotheses, const ModelDatabase& database,
                                      const std_msgs::Header& header) {
  const auto message = boost::make_shared<messages::DetectionArray>();
  message->header = header;
  std::map<std::string, std::uint32_t> instances;
  for (const VerifiedHypothesis& verified : hypotheses) {
    message->detections.push_back(toMessage(verified, database));
    message->detections.back().instance = instances[message->detections.back().object]++;
  }
  return message;
}

std::vector<std::string> objectNames(const std::vector<int>& objects, const ModelDatabase& database) {
  std::vector<std::string> names;
  for (const int object : objects) names.push_back(database.objects.at(static_cast<size_t>(object))->name);
  return names;
}

}  // namespace recognition
