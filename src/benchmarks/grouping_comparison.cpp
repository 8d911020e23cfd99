#include "benchmarks/grouping_comparison.h"

#include <chrono>
#include <functional>
#include <random>

#include <pcl/recognition/cg/geometric_consistency.h>
#include <pcl/recognition/cg/hough_3d.h>

#include "matching/synthetic_scene.h"
#include "matching/algorithm2.h"

namespace recognition::benchmarks {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Frames = pcl::PointCloud<pcl::ReferenceFrame>;
using Transforms = std::vector<Eigen::Matrix4f, Eigen::aligned_allocator<Eigen::Matrix4f>>;

/// A method's best answer: pose, and indices of Problem::pairs.
struct Answer {
  bool found = false;
  Pose pose = Pose::Identity();
  std::vector<int> scene_features;
};

Cloud::Ptr toCloud(const std::vector<Eigen::Vector3f>& points) {
  Cloud::Ptr cloud(new Cloud);
  for (const Eigen::Vector3f& point : points) cloud->push_back({point.x(), point.y(), point.z()});
  return cloud;
}

pcl::CorrespondencesPtr toPcl(const synthetic::Problem& problem) {
  pcl::CorrespondencesPtr pairs(new pcl::Correspondences);
  for (const Correspondence& pair : problem.pairs)
    pairs->push_back({pair.model_feature, pair.scene_feature, pair.distance});
  return pairs;
}

pcl::ReferenceFrame toFrame(const Eigen::Matrix3f& rotation) {
  pcl::ReferenceFrame frame;
  for (int k = 0; k < 3; ++k) {
    frame.x_axis[k] = rotation(k, 0);
    frame.y_axis[k] = rotation(k, 1);
    frame.z_axis[k] = rotation(k, 2);
  }
  return frame;
}

Answer largest(const Transforms& transforms, const std::vector<pcl::Correspondences>& groups) {
  Answer answer;
  size_t most = 0;
  for (size_t i = 0; i < groups.size(); ++i) {
    if (groups[i].size() <= most) continue;
    most = groups[i].size();
    answer.found = true;
    answer.pose.matrix() = transforms[i].cast<double>();
    answer.scene_features.clear();
    for (const pcl::Correspondence& pair : groups[i]) answer.scene_features.push_back(pair.index_match);
  }
  return answer;
}

/// Rotation that each pair of features suggests: within 10 degrees for right ones, any for others.
std::vector<Eigen::Quaternionf> makeRotations(const synthetic::Problem& problem) {
  std::mt19937 random(5);
  std::vector<Eigen::Quaternionf> rotations;
  for (int i = 0; i < static_cast<int>(problem.model_points.size()); ++i) {
    const Pose turn = i < problem.inliers ? problem.camera_from_object : synthetic::randomPose(random);
    const Eigen::AngleAxisf error(0.17f, synthetic::randomPoint(1.0, random).normalized());
    rotations.emplace_back(error * turn.linear().cast<float>());
  }
  return rotations;
}

Answer algorithm2(const synthetic::Problem& problem, const std::vector<Eigen::Quaternionf>& rotations) {
  MatchingParameters parameters;
  parameters.alpha = 1.0;
  WorkBudget budget = WorkBudget::milliseconds(10000.0);
  std::vector<Eigen::Quaternionf> of_pairs;
  for (const Correspondence& pair : problem.pairs)
    if (!rotations.empty()) of_pairs.push_back(rotations[pair.scene_feature]);
  const CorrespondenceSet set(problem.pairs, problem.scene_points, problem.model_points, of_pairs);
  const PoseConsensus found = Algorithm2(parameters, 1).search(set, parameters.min_consensus - 1, budget);
  Answer answer{found.size() > 0, found.camera_from_object, {}};
  for (const int member : found.members) answer.scene_features.push_back(set.pair(member).scene_feature);
  return answer;
}

Answer geometricConsistency(const synthetic::Problem& problem) {
  pcl::GeometricConsistencyGrouping<pcl::PointXYZ, pcl::PointXYZ> grouping;
  grouping.setGCSize(MatchingParameters().epsilon_g);
  grouping.setGCThreshold(MatchingParameters().min_consensus);
  grouping.setInputCloud(toCloud(problem.model_points));
  grouping.setSceneCloud(toCloud(problem.scene_points));
  grouping.setModelSceneCorrespondences(toPcl(problem));
  Transforms transforms;
  std::vector<pcl::Correspondences> groups;
  grouping.recognize(transforms, groups);
  return largest(transforms, groups);
}

Answer hough3d(const synthetic::Problem& problem, const std::vector<Eigen::Quaternionf>& rotations) {
  Frames::Ptr model_frames(new Frames), scene_frames(new Frames);
  for (const Eigen::Quaternionf& rotation : rotations) {
    model_frames->push_back(toFrame(Eigen::Matrix3f::Identity()));
    scene_frames->push_back(toFrame(rotation.toRotationMatrix()));
  }
  pcl::Hough3DGrouping<pcl::PointXYZ, pcl::PointXYZ, pcl::ReferenceFrame, pcl::ReferenceFrame> grouping;
  grouping.setHoughBinSize(2.0 * MatchingParameters().delta_d);
  grouping.setHoughThreshold(MatchingParameters().min_consensus);
  grouping.setUseInterpolation(true);
  grouping.setUseDistanceWeight(false);
  grouping.setInputCloud(toCloud(problem.model_points));
  grouping.setInputRf(model_frames);
  grouping.setSceneCloud(toCloud(problem.scene_points));
  grouping.setSceneRf(scene_frames);
  grouping.setModelSceneCorrespondences(toPcl(problem));
  Transforms transforms;
  std::vector<pcl::Correspondences> groups;
  grouping.recognize(transforms, groups);
  return largest(transforms, groups);
}

nlohmann::json measure(const synthetic::Problem& problem, const std::function<Answer()>& method) {
  const auto start = std::chrono::steady_clock::now();
  const Answer answer = method();
  const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
  int right = 0;
  for (const int feature : answer.scene_features) right += feature < problem.inliers;
  nlohmann::json result = {{"ms", elapsed.count()}, {"right", right}, {"wrong", answer.scene_features.size() - right}};
  if (answer.found) {
    result["translation_error_m"] = translationDistance(answer.pose, problem.camera_from_object);
    result["rotation_error_deg"] = rotationDistance(answer.pose, problem.camera_from_object) * 180.0 / std::acos(-1.0);
  }
  return result;
}

}  // namespace

nlohmann::json compareGrouping(int correspondences, int seed) {
  nlohmann::json table;
  std::mt19937 random(static_cast<unsigned>(seed));
  for (const double outliers : {0.5, 0.8, 0.9, 0.95, 0.98, 0.99}) {
    const auto problem = synthetic::makeProblem(correspondences, outliers, 0.002, random);
    nlohmann::json row = {{"outlier_ratio", outliers}, {"inliers", problem.inliers}};
    const auto rotations = makeRotations(problem);
    row["algorithm2"] = measure(problem, [&] { return algorithm2(problem, {}); });
    row["algorithm2_oriented"] = measure(problem, [&] { return algorithm2(problem, rotations); });
    row["geometric_consistency"] = measure(problem, [&] { return geometricConsistency(problem); });
    row["hough3d"] = measure(problem, [&] { return hough3d(problem, rotations); });
    table.push_back(row);
  }
  return table;
}

}  // namespace recognition::benchmarks
