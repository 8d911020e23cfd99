#pragma once

#include <string>
#include <vector>

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/TransformStamped.h>

#include "rgbd_recognition/features/feature_types.h"
#include "rgbd_recognition/matching/hypothesis.h"
#include "rgbd_recognition/model/object_model.h"
#include "ros/messages.h"
#include "rgbd_recognition/segmentation/segmentation.h"
#include "rgbd_recognition/verification/verified_hypothesis.h"
#include "rgbd_recognition/matching/scene_matches.h"

/// Between the core's types and our messages. Those from a message throw std::invalid_argument that names field and
/// value of anything that does not fit, since other nodes may send them. Objects travel by name: two processes may hold
/// their models in different order.
namespace recognition {

geometry_msgs::Pose poseMessage(const Pose& pose);
Pose poseFromMessage(const geometry_msgs::Pose& message);
Pose poseFromMessage(const geometry_msgs::Transform& message);
/// Frame `child` at a pose in the header's frame.
geometry_msgs::TransformStamped transformMessage(const geometry_msgs::Pose& pose, const std_msgs::Header& header,
                                                 const std::string& child);

messages::SegmentationPtr toMessage(const Segmentation& segmentation, const std_msgs::Header& header);
/// A view: labels and edges share the message's pixels.
Segmentation fromMessage(const messages::Segmentation& message);

messages::SceneFeaturesPtr toMessage(const SceneFeatures& features, const std_msgs::Header& header);
/// A view: descriptors share the message's memory.
SceneFeatures fromMessage(const messages::SceneFeatures& message);

messages::HypothesisArrayPtr toMessage(const std::vector<Hypothesis>& hypotheses, int round,
                                       const ModelDatabase& database, const std_msgs::Header& header);
/// `features` are those that the correspondences point into.
std::vector<Hypothesis> fromMessage(const messages::HypothesisArray& message, const ModelDatabase& database,
                                    const SceneFeatures& features);

void addMatches(const SceneMatches& matches, const ModelDatabase& database, messages::HypothesisArray* message);
/// One element an object of `database`; none for objects that the message leaves out.
SceneMatches matchesFromMessage(const messages::HypothesisArray& message, const ModelDatabase& database,
                                const SceneFeatures& features);

/// Instances are numbered an object in the order given.
messages::DetectionArrayPtr toMessage(const std::vector<VerifiedHypothesis>& hypotheses, const ModelDatabase& database,
                                      const std_msgs::Header& header);

std::vector<std::string> objectNames(const std::vector<int>& objects, const ModelDatabase& database);

}  // namespace recognition
