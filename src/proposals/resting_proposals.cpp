#include "proposals/resting_proposals.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "core/angles.h"
#include "proposals/proposal_ranking.h"
#include "proposals/support_plane.h"

namespace recognition {
namespace {

constexpr int kTurns = 24;                                  // about the plane's normal
constexpr int kMinPixels = 200;                             // of a patch
constexpr size_t kMaxSurfaces = 24;                         // the largest ones
constexpr float kMaxChroma = 22.0f, kMaxLightness = 40.0f;  // CIELAB, between mean colours
constexpr double kMaxExplained = 0.5;                       // of a patch
constexpr float kLongest = 1.15f;   // of a patch, four deviations, against the object's diameter
constexpr float kMinFace = 0.03f;   // of the model's points that look a patch's way
constexpr float kDeepest = 0.08f;   // metres into the plane, that a hidden part of a patch may feign
constexpr float kAfloat = 0.06f;    // metres above it
constexpr float kTouching = 0.03f;  // metres into the plane that the patch's noise explains
constexpr float kUpright = 0.5f;    // cosine between an upright patch's normal and the plane's, at most
constexpr ProbeLimits kRestingLimits = {0.25, 0.4};
constexpr size_t kAlignedPerObject = 32;
constexpr ProposalLimits kLimits = {64, 3, 0, 0.1};
constexpr size_t kRefinedResting = 8;

/// A patch that may be a part of an object's surface, or a blob that may be all of it that is seen.
struct Surface {
  Eigen::Vector3f centroid, normal;  ///< camera's frame; the normal towards the camera, of a blob the line of sight
  float length = 0.0f;               ///< metres
  bool blob = false;
  int pixels = 0;
  Eigen::Vector3f lab = Eigen::Vector3f::Zero();  ///< mean colour, CIELAB
};

/// Mean colour of each label from 1 on, of every second pixel.
std::vector<Eigen::Vector3f> meanColors(const cv::Mat& labels, int count, const cv::Mat& lab) {
  std::vector<Eigen::Vector3f> sums(static_cast<size_t>(count) + 1, Eigen::Vector3f::Zero());
  std::vector<float> pixels(sums.size(), 0.0f);
  for (int v = 0; v < labels.rows; v += 2)
    for (int u = 0; u < labels.cols; u += 2) {
      const int label = labels.at<int>(v, u);
      if (label <= 0 || label > count) continue;
      const cv::Vec3f& color = lab.at<cv::Vec3f>(v, u);
      sums[static_cast<size_t>(label)] += Eigen::Vector3f(color[0], color[1], color[2]);
      ++pixels[static_cast<size_t>(label)];
    }
  for (size_t i = 0; i < sums.size(); ++i) sums[i] /= std::max(1.0f, pixels[i]);
  return sums;
}

float lengthOf(const Patch& patch) { return 4.0f * std::sqrt(patch.eigenvalues[2]); }

/// Pixels above the planes that jumps in depth part from others.
std::vector<Surface> openBlobs(const SceneView& scene, const cv::Mat& explained) {
  const cv::Mat jumps = scene.segmentation->edges == static_cast<int>(EdgeType::kJump);
  const cv::Mat open = (scene.segmentation->labels != kLargePlane) & (scene.depth > 0.0f) & ~jumps & (explained == 0);
  cv::Mat blob_of;
  const int count = cv::connectedComponents(open, blob_of, 4, CV_32S);
  std::vector<Surface> surfaces;
  const std::vector<Patch> blobs = describePatches(scene.depth, scene.camera, blob_of, count, kMinPixels);
  const auto colors = meanColors(blob_of, count - 1, scene.lab);
  for (const Patch& blob : blobs)
    surfaces.push_back({blob.centroid, -blob.centroid.normalized(), lengthOf(blob), true, blob.pixels,
                        colors.at(static_cast<size_t>(blob.label))});
  return surfaces;
}

std::vector<Surface> openPatches(const SceneView& scene, const cv::Mat& explained) {
  const Segmentation& segmentation = *scene.segmentation;
  std::vector<int> taken(segmentation.patches.size() + 1, 0);
  for (int v = 0; v < explained.rows; ++v)
    for (int u = 0; u < explained.cols; ++u) {
      const int label = segmentation.labels.at<int>(v, u);
      if (label > 0 && explained.at<std::uint8_t>(v, u)) ++taken[static_cast<size_t>(label)];
    }
  std::vector<Surface> surfaces;
  const auto colors = meanColors(segmentation.labels, static_cast<int>(segmentation.patches.size()), scene.lab);
  for (const Patch& patch : segmentation.patches) {
    if (patch.pixels < kMinPixels) continue;
    if (taken[static_cast<size_t>(patch.label)] > kMaxExplained * patch.pixels) continue;
    const Eigen::Vector3f normal = patch.axes.col(0);
    surfaces.push_back({patch.centroid, normal.dot(patch.centroid) > 0.0f ? Eigen::Vector3f(-normal) : normal,
                        lengthOf(patch), false, patch.pixels, colors[static_cast<size_t>(patch.label)]});
  }
  return surfaces;
}

/// The poses of one object in which it rests on the plane and a surface of the scene is its own.
class RestingObject {
 public:
  RestingObject(int object, const PreparedModels& models, const SceneView& scene, const SupportPlane& plane)
      : object_(object), model_(models.at(object)), scene_(scene), plane_(plane) {}

  std::vector<Proposal> find(const std::vector<Surface>& surfaces) const {
    std::vector<Proposal> found;
    for (const RestingPose& pose : model_.resting_poses) {
      const Eigen::Quaternionf upright = Eigen::Quaternionf::FromTwoVectors(pose.down, -plane_.up);
      for (int turn = 0; turn < kTurns; ++turn) {
        const float angle = 2.0f * static_cast<float>(kPi) * static_cast<float>(turn) / kTurns;
        const Eigen::Matrix3f rotation = (Eigen::AngleAxisf(angle, plane_.up) * upright).toRotationMatrix();
        for (const Surface& surface : surfaces) lookAt(rotation, pose.reach, surface, &found);
      }
    }
    keepBest(kAlignedPerObject, &found);
    for (Proposal& one : found) {
      one.camera_from_object = alignToDepth(model_, kAlignmentPoints, one.camera_from_object, scene_);
      one.probe = probeSurface(model_, kSecondProbe, one.camera_from_object, scene_);
      one.rate(false);
    }
    keepDistinct(model_, kRefinedResting, &found);
    return found;
  }

 private:
  void lookAt(const Eigen::Matrix3f& rotation, float reach, const Surface& surface,
              std::vector<Proposal>* found) const {
    if (surface.length > kLongest * 2.0f * model_.radius) return;
    const FaceTable& faces = surface.blob ? model_.halves : model_.faces;
    const FaceTable::Face& face = faces.facing(rotation.transpose() * surface.normal);
    if (face.share < kMinFace || !mayHaveColor(face.lab, surface.lab)) return;
    Eigen::Vector3f place = surface.centroid - rotation * face.centroid;
    if (!standOnPlane(reach, surface, &place)) return;
    Proposal one;
    one.object = object_;
    one.camera_from_object.linear() = rotation.cast<double>();
    one.camera_from_object.translation() = place.cast<double>();
    one.probe = probeSurface(model_, kFirstProbe, one.camera_from_object, scene_, kRestingLimits);
    if (!kRestingLimits.hold(one.probe)) return;
    one.rate(false);
    found->push_back(one);
  }

  /// Illumination and saturation change a mean colour by less than this.
  static bool mayHaveColor(const Eigen::Vector3f& model, const Eigen::Vector3f& scene) {
    const Eigen::Vector3f off = model - scene;
    return off.tail<2>().norm() < kMaxChroma && std::abs(off.x()) < kMaxLightness;
  }

  /// Where only a part of a blob or of an upright surface is seen, its centroid is off along the surface: the plane
  /// says by how much. What is far above the plane stands on something else. False if the object would lie in the
  /// plane.
  bool standOnPlane(float reach, const Surface& surface, Eigen::Vector3f* place) const {
    const float gap = plane_.up.dot(*place) - reach - plane_.height;
    const bool upright = surface.blob || std::abs(surface.normal.dot(plane_.up)) < kUpright;
    if (gap < -kDeepest || (gap < -kTouching && !upright)) return false;
    if (upright && gap < kAfloat) *place -= gap * plane_.up;
    return true;
  }

  int object_;
  const PreparedModel& model_;
  const SceneView& scene_;
  const SupportPlane& plane_;
};

}  // namespace

std::vector<Hypothesis> proposeRestingPoses(const std::vector<int>& objects, const cv::Mat& explained,
                                            const PreparedModels& models, const SceneView& scene, int count) {
  const std::optional<SupportPlane> plane = findSupportPlane(scene);
  if (!plane) return {};
  std::vector<Surface> surfaces = openPatches(scene, explained);
  const std::vector<Surface> blobs = openBlobs(scene, explained);
  surfaces.insert(surfaces.end(), blobs.begin(), blobs.end());
  std::stable_sort(surfaces.begin(), surfaces.end(),
                   [](const Surface& a, const Surface& b) { return a.pixels > b.pixels; });
  if (surfaces.size() > kMaxSurfaces) surfaces.resize(kMaxSurfaces);
  std::vector<std::vector<Proposal>> by_object(static_cast<size_t>(models.count()));
  const cv::Range all(0, static_cast<int>(objects.size()));
  cv::parallel_for_(
      all,
      [&](const cv::Range& range) {
        for (int i = range.start; i < range.end; ++i) {
          const int object = objects[static_cast<size_t>(i)];
          by_object[static_cast<size_t>(object)] = RestingObject(object, models, scene, *plane).find(surfaces);
        }
      },
      all.size());
  ProposalLimits limits = kLimits;
  limits.tested = static_cast<size_t>(count);
  return hypothesesOf(std::move(by_object), models, scene, limits);
}

}  // namespace recognition
