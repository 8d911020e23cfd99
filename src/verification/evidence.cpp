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

/// Smallest CIELAB distance to the pixel and its neighbours two away: texture that is slightly off is not wrong.
float colorDistance(const cv::Mat& lab, const cv::Point& m, const cv::Vec3f& color) {
  float best = kDistanceCap * kDistanceCap;
  for (int v = m.y < 2 ? m.y : m.y - 2; v <= std::min(m.y + 2, lab.rows - 1); v += 2) {
    const auto* row = lab.ptr<cv::Vec3f>(v);
    for (int u = m.x < 2 ? m.x : m.x - 2; u <= std::min(m.x + 2, lab.cols - 1); u += 2) {
      const float l = row[u][0] - color[0], a = row[u][1] - color[1], b = row[u][2] - color[2];
      best = std::min(best, l * l + a * a + b * b);
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
  int pixels = 0, colors = 0;
};

Appearance appearanceOf(const Sums& sums) {
  Appearance appearance;
  const double pixels = std::max(1, sums.pixels), colors = std::max(1, sums.colors);
  appearance.structure = sums.contrast > 0.0 ? sums.structure / sums.contrast : 0.0;
  appearance.texture = sums.contrast / pixels;
  appearance.color_distance = sums.colors > 0 ? sums.distance / colors : kDistanceCap;
  appearance.illumination_change = sums.chroma_change / colors;
  appearance.gain = sums.gain;
  return appearance;
}

}  // namespace

PosedModel::PosedModel(const ModelCloud& own_model, const ReprojectedModel& its_pixels, const cv::Mat& their_state,
                       const SceneView& frame, const AppearanceScale& own_scale)
    : model(own_model), reprojected(its_pixels), state(their_state), scene(frame), scale(own_scale) {
  inside = reprojected.point >= 0;
  cv::erode(inside, inside, cv::Mat::ones(2 * scale.rim + 1, 2 * scale.rim + 1, CV_8UC1), {-1, -1}, 1,
            cv::BORDER_CONSTANT, cv::Scalar(0));
}

DepthFit depthFit(const PosedModel& posed) {
  int consistent = 0, free_space = 0;
  for (int v = 0; v < posed.state.rows; ++v) {
    const auto* states = posed.state.ptr<PixelState>(v);
    const auto* inside = posed.inside.ptr<std::uint8_t>(v);
    for (int u = 0; u < posed.state.cols; ++u) {
      consistent += inside[u] && states[u] == PixelState::kConsistent ? 1 : 0;
      free_space += inside[u] && states[u] == PixelState::kFreeSpace ? 1 : 0;
    }
  }
  return {static_cast<double>(consistent) / std::max(1, consistent + free_space), static_cast<double>(consistent)};
}

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

ColorTransform fitIllumination(const PosedModel& posed) {
  const cv::Rect& box = posed.reprojected.box;
  const int step = std::max(1, posed.reprojected.pixels / kIlluminationSamples);
  std::vector<ColorPair> pairs;
  int count = 0;
  for (int v = 0; v < box.height; ++v) {
    for (int u = 0; u < box.width; ++u) {
      if (posed.state.at<PixelState>(v, u) != PixelState::kConsistent || !posed.inside.at<std::uint8_t>(v, u)) continue;
      if (posed.scene.clipped.at<std::uint8_t>(v + box.y, u + box.x) || count++ % step != 0) continue;
      const auto point = static_cast<size_t>(posed.reprojected.point.at<int>(v, u));
      pairs.push_back(
          {posed.model.lab[point], posed.scene.lab.at<cv::Vec3f>(v + box.y, u + box.x), posed.model.normals[point]});
    }
  }
  return fitColorTransform(pairs);
}

LitModel lightModel(const PosedModel& posed, const ColorTransform& illumination) {
  const cv::Rect& box = posed.reprojected.box;
  const auto empty = [&](int type) { return cv::Mat(box.size(), type, cv::Scalar::all(0)); };
  LitModel out{empty(CV_32FC3), empty(CV_32FC1), empty(CV_32FC1), empty(CV_32FC1)};
  for (int v = 0; v < box.height; ++v) {
    const auto* states = posed.state.ptr<PixelState>(v);
    const auto* inside = posed.inside.ptr<std::uint8_t>(v);
    const int* points = posed.reprojected.point.ptr<int>(v);
    const auto* seen = posed.scene.lab.ptr<cv::Vec3f>(v + box.y) + box.x;
    auto* color = out.color.ptr<cv::Vec3f>(v);
    float *lightness = out.lightness.ptr<float>(v), *scene = out.scene.ptr<float>(v), *mask = out.mask.ptr<float>(v);
    for (int u = 0; u < box.width; ++u) {
      if (!inside[u] || (states[u] != PixelState::kConsistent && states[u] != PixelState::kUnknown)) continue;
      const auto point = static_cast<size_t>(points[u]);
      color[u] = illumination(posed.model.lab[point], posed.model.normals[point]);
      lightness[u] = color[u][0];
      scene[u] = seen[u][0];
      mask[u] = 1.0f;
    }
  }
  cv::blur(out.lightness, out.lightness, {3, 3});
  cv::blur(out.scene, out.scene, {3, 3});
  return out;
}

Appearance weighAppearance(const PosedModel& posed, const ColorTransform& illumination) {
  const cv::Rect& box = posed.reprojected.box;
  if (box.empty()) return {};
  const LitModel lit = lightModel(posed, illumination);
  const LocalCorrelation local =
      correlateLocally(lit.lightness, lit.scene, lit.mask, posed.scale.window, kLightnessNoise);
  Sums sums;
  for (int v = 0; v < box.height; ++v) {
    const float *mask = lit.mask.ptr<float>(v), *contrasts = local.contrast.ptr<float>(v);
    const float* correlations = local.correlation.ptr<float>(v);
    const auto* clipped_ones = posed.scene.clipped.ptr<std::uint8_t>(v + box.y) + box.x;
    const auto* states = posed.state.ptr<PixelState>(v);
    const auto* inside = posed.inside.ptr<std::uint8_t>(v);
    for (int u = 0; u < box.width; ++u) {
      if (mask[u] == 0.0f) {
        if (inside[u] && states[u] == PixelState::kFreeSpace) sums.gain += kFreeSpaceGain;
        continue;
      }
      const float contrast = contrasts[u], correlation = correlations[u];
      const cv::Vec3f color = lit.color.at<cv::Vec3f>(v, u);
      const bool clipped = clipped_ones[u] != 0;
      const float distance =
          clipped ? kGoodDistance : colorDistance(posed.scene.lab, box.tl() + cv::Point(u, v), color);
      sums.gain += consistentGain(distance, correlation, contrast);
      ++sums.pixels;
      sums.structure += contrast * correlation;
      sums.contrast += contrast;
      if (clipped) continue;
      const cv::Vec3f& plain = posed.model.lab[static_cast<size_t>(posed.reprojected.point.at<int>(v, u))];
      ++sums.colors;
      sums.distance += distance;
      sums.chroma_change += std::hypot(color[1] - plain[1], color[2] - plain[2]);
    }
  }
  return appearanceOf(sums);
}

}  // namespace recognition
