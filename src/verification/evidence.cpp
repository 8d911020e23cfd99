#include "verification/evidence.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "alignment/local_correlation.h"
#include "core/depth_noise.h"
#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"

namespace recognition {
namespace {

constexpr float kLightnessNoise = 4.0f;
constexpr float kDistanceCap = 50.0f;
constexpr float kGoodDistance = 14.0f;  // CIELAB distance at which colour says neither yes nor no
constexpr double kFreeSpaceGain = -1.0;
constexpr double kWrongColorGain = -0.6;
constexpr int kIlluminationSamples = 1500;

/// M_j without its rim, 255 or 0.
cv::Mat interior(const ReprojectedModel& reprojected, int rim) {
  cv::Mat inside = reprojected.point >= 0;
  cv::erode(inside, inside, cv::Mat::ones(2 * rim + 1, 2 * rim + 1, CV_8UC1), {-1, -1}, 1, cv::BORDER_CONSTANT,
            cv::Scalar(0));
  return inside;
}

/// Lightness of the model as lit, and of the frame, over the box.
struct Lightness {
  cv::Mat model, scene, mask;
};

Lightness lightnessOf(const ReprojectedModel& reprojected, const cv::Mat& inside, const cv::Mat& state,
                      const ModelCloud& model, const ColorTransform& illumination, const SceneView& scene) {
  const cv::Rect& box = reprojected.box;
  Lightness out{cv::Mat(box.size(), CV_32FC1, cv::Scalar(0)), cv::Mat(box.size(), CV_32FC1, cv::Scalar(0)),
                cv::Mat(box.size(), CV_32FC1, cv::Scalar(0))};
  for (int v = 0; v < box.height; ++v) {
    for (int u = 0; u < box.width; ++u) {
      const auto s = state.at<PixelState>(v, u);
      if (!inside.at<std::uint8_t>(v, u) || (s != PixelState::kConsistent && s != PixelState::kUnknown)) continue;
      out.mask.at<float>(v, u) = 1.0f;
      const auto point = static_cast<size_t>(reprojected.point.at<int>(v, u));
      out.model.at<float>(v, u) = illumination(model.lab[point], model.normals[point])[0];
      out.scene.at<float>(v, u) = scene.lab.at<cv::Vec3f>(v + box.y, u + box.x)[0];
    }
  }
  cv::blur(out.model, out.model, {3, 3});
  cv::blur(out.scene, out.scene, {3, 3});
  return out;
}

/// Smallest CIELAB distance to the pixel and its neighbours two away: texture that is slightly off is not wrong.
float colorDistance(const cv::Mat& lab, const cv::Point& m, const cv::Vec3f& color) {
  float best = kDistanceCap * kDistanceCap;
  for (int dv = -2; dv <= 2; dv += 2) {
    for (int du = -2; du <= 2; du += 2) {
      const cv::Point b = m + cv::Point(du, dv);
      if (b.x < 0 || b.y < 0 || b.x >= lab.cols || b.y >= lab.rows) continue;
      const cv::Vec3f d = lab.at<cv::Vec3f>(b) - color;
      best = std::min(best, d.dot(d));
    }
  }
  return std::sqrt(best);
}

/// Gain of a pixel whose depth agrees: colour and structure each say yes (1) or no.
float consistentGain(float color_distance, float correlation, float contrast) {
  const float color = std::clamp(1.0f - color_distance / kGoodDistance, static_cast<float>(kWrongColorGain), 1.0f);
  return (1.0f - contrast) * 0.5f * color + contrast * (0.35f * color + 0.65f * correlation);
}

/// Sums of weighAppearance().
struct Sums {
  double structure = 0.0, contrast = 0.0, distance = 0.0, chroma_change = 0.0, gain = 0.0;
  int pixels = 0, colors = 0, consistent = 0, free_space = 0;
};

Evidence evidenceOf(const Sums& sums) {
  Evidence evidence;
  const double pixels = std::max(1, sums.pixels), colors = std::max(1, sums.colors);
  evidence.structure = sums.contrast > 0.0 ? sums.structure / sums.contrast : 0.0;
  evidence.texture = sums.contrast / pixels;
  evidence.color_distance = sums.colors > 0 ? sums.distance / colors : kDistanceCap;
  evidence.illumination_change = sums.chroma_change / colors;
  evidence.depth_fit = sums.consistent / static_cast<double>(std::max(1, sums.consistent + sums.free_space));
  evidence.seen = sums.consistent;
  evidence.gain = sums.gain;
  return evidence;
}

}  // namespace

int countInliers(const Hypothesis& hypothesis, const ObjectModel& object, const Pose& camera_from_object,
                 const SceneView& scene, double max_distance, double max_pixels) {
  const SceneFeatures& features = *scene.features;
  const auto own = object.features.find(features.image.type);
  if (own == object.features.end()) return 0;
  std::vector<int> agreeing;
  for (const Correspondence& c : hypothesis.consensus) {
    const Eigen::Vector3d p =
        camera_from_object * own->second.positions.at(static_cast<size_t>(c.model_feature)).cast<double>();
    if (p.z() <= 0.0) continue;
    const Eigen::Vector3d q = features.points.at(static_cast<size_t>(c.scene_feature)).cast<double>();
    const Keypoint& keypoint = features.image.keypoints.at(static_cast<size_t>(c.scene_feature));
    const Eigen::Vector2d seen = depthPixel(keypoint, scene.color_per_depth);
    if ((p - q).norm() > max_distance + 3.0 * depthSigma(q.z())) continue;
    if ((scene.camera.project(p) - seen).norm() > max_pixels) continue;
    agreeing.push_back(c.scene_feature);
  }
  std::sort(agreeing.begin(), agreeing.end());
  return static_cast<int>(std::unique(agreeing.begin(), agreeing.end()) - agreeing.begin());
}

double segmentShare(const cv::Mat& state, const cv::Rect& box, const Segmentation& segmentation, int step) {
  std::vector<int> explained(segmentation.patches.size() + 1, 0);  // f of eq. (14) without colour, by label
  int consistent = 0;
  for (int v = 0; v < box.height; ++v) {
    const auto* states = state.ptr<PixelState>(v);
    const int* labels = segmentation.labels.ptr<int>(step * (v + box.y));
    for (int u = 0; u < box.width; ++u) {
      if (states[u] != PixelState::kConsistent) continue;
      ++consistent;
      const int label = labels[step * (u + box.x)];
      if (label > 0 && label < static_cast<int>(explained.size())) ++explained[static_cast<size_t>(label)];
    }
  }
  double sum = 0.0;
  for (const Patch& patch : segmentation.patches) {
    const double f = explained[static_cast<size_t>(patch.label)];
    if (f > 0.0) sum += f * std::min(1.0, f * step * step / std::max(1, patch.pixels));
  }
  return sum / std::max(1, consistent);
}

ColorTransform fitIllumination(const ReprojectedModel& reprojected, const cv::Mat& state, const ModelCloud& model,
                               const SceneView& scene, const AppearanceScale& scale) {
  const cv::Rect& box = reprojected.box;
  const cv::Mat inside = interior(reprojected, scale.rim);
  const int step = std::max(1, reprojected.pixels / kIlluminationSamples);
  std::vector<ColorPair> pairs;
  int count = 0;
  for (int v = 0; v < box.height; ++v) {
    for (int u = 0; u < box.width; ++u) {
      if (state.at<PixelState>(v, u) != PixelState::kConsistent || !inside.at<std::uint8_t>(v, u)) continue;
      if (scene.clipped.at<std::uint8_t>(v + box.y, u + box.x) || count++ % step != 0) continue;
      const auto point = static_cast<size_t>(reprojected.point.at<int>(v, u));
      pairs.push_back({model.lab[point], scene.lab.at<cv::Vec3f>(v + box.y, u + box.x), model.normals[point]});
    }
  }
  return fitColorTransform(pairs);
}

Evidence weighAppearance(const ReprojectedModel& reprojected, const PixelConsistency& pixels,
                         const ModelCloud& model, const ColorTransform& illumination, const SceneView& scene,
                         const AppearanceScale& scale) {
  const cv::Rect& box = reprojected.box;
  if (box.empty()) return {};
  const cv::Mat inside = interior(reprojected, scale.rim);
  const Lightness lightness = lightnessOf(reprojected, inside, pixels.state, model, illumination, scene);
  const LocalCorrelation local =
      correlateLocally(lightness.model, lightness.scene, lightness.mask, scale.window, kLightnessNoise);
  Sums sums;
  for (int v = 0; v < box.height; ++v) {
    for (int u = 0; u < box.width; ++u) {
      if (!inside.at<std::uint8_t>(v, u)) continue;
      const auto state = pixels.state.at<PixelState>(v, u);
      float gain = 0.0f;
      if (state == PixelState::kFreeSpace) {
        ++sums.free_space;
        gain = static_cast<float>(kFreeSpaceGain);
      }
      if (lightness.mask.at<float>(v, u) > 0.0f) {
        const float contrast = local.contrast.at<float>(v, u), correlation = local.correlation.at<float>(v, u);
        const auto point = static_cast<size_t>(reprojected.point.at<int>(v, u));
        const cv::Vec3f& plain = model.lab[point];
        const cv::Vec3f lit = illumination(plain, model.normals[point]);
        const bool clipped = scene.clipped.at<std::uint8_t>(v + box.y, u + box.x) != 0;
        const float distance = clipped ? kGoodDistance : colorDistance(scene.lab, box.tl() + cv::Point(u, v), lit);
        gain = consistentGain(distance, correlation, contrast);
        ++sums.pixels;
        sums.structure += contrast * correlation;
        sums.contrast += contrast;
        sums.consistent += state == PixelState::kConsistent;
        if (!clipped) {
          ++sums.colors;
          sums.distance += distance;
          sums.chroma_change += std::hypot(lit[1] - plain[1], lit[2] - plain[2]);
        }
      }
      sums.gain += gain;
    }
  }
  return evidenceOf(sums);
}

}  // namespace recognition
