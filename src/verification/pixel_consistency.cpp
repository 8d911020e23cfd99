#include "verification/pixel_consistency.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/depth_noise.h"

namespace recognition {
namespace {

/// Offsets of B_w, eq. (16), nearest first: a match is most often near.
std::vector<cv::Point> windowOffsets(int w) {
  std::vector<cv::Point> offsets;
  for (int dv = -w; dv <= w; ++dv)
    for (int du = -w; du <= w; ++du) offsets.emplace_back(du, dv);
  std::stable_sort(offsets.begin(), offsets.end(),
                   [](const cv::Point& a, const cv::Point& b) { return a.dot(a) < b.dot(b); });
  return offsets;
}

/// 1_c of eq. (16) over B_w, whose parts outside the image do not count.
class ColorWindow {
 public:
  ColorWindow(const cv::Mat& lab, int w, double limit)
      : lab_(lab),
        inner_(w, w, lab.cols - 2 * w, lab.rows - 2 * w),
        offsets_(windowOffsets(w)),
        limit_(static_cast<float>(limit * limit)) {
    for (const cv::Point& offset : offsets_)
      steps_.push_back(offset.y * static_cast<std::ptrdiff_t>(lab.step1() / 3) + offset.x);
  }

  bool holds(const cv::Point& m, const cv::Vec3f& color) const {
    if (!inner_.contains(m)) return holdsAtBorder(m, color);
    const cv::Vec3f* centre = lab_.ptr<cv::Vec3f>(m.y) + m.x;
    for (const std::ptrdiff_t step : steps_)
      if (isNear(centre[step], color)) return true;
    return false;
  }

 private:
  bool holdsAtBorder(const cv::Point& m, const cv::Vec3f& color) const {
    const cv::Rect image(0, 0, lab_.cols, lab_.rows);
    return std::any_of(offsets_.begin(), offsets_.end(), [&](const cv::Point& offset) {
      return image.contains(m + offset) && isNear(lab_.at<cv::Vec3f>(m + offset), color);
    });
  }

  bool isNear(const cv::Vec3f& a, const cv::Vec3f& b) const {
    const float l = a[0] - b[0], x = a[1] - b[1], y = a[2] - b[2];
    return l * l + x * x + y * y < limit_;
  }

  const cv::Mat& lab_;
  cv::Rect inner_;
  std::vector<cv::Point> offsets_;
  std::vector<std::ptrdiff_t> steps_;  // of a pointer to the window's middle
  float limit_;
};

/// Counts of the consistent pixels of M_j by segment, f(S) of eq. (14).
struct SegmentOverlap {
  std::vector<int> f;  // by label

  explicit SegmentOverlap(const Segmentation& segmentation) : f(segmentation.patches.size() + 1, 0) {}
  void add(int label) {
    if (label > 0 && label < static_cast<int>(f.size())) ++f[static_cast<size_t>(label)];
  }
  int best() const {
    const auto most = std::max_element(f.begin(), f.end());
    return *most > 0 ? static_cast<int>(most - f.begin()) : 0;
  }
};

}  // namespace

double depthTolerance(const VerificationParameters& parameters, double z) {
  return parameters.epsilon_d + parameters.epsilon_d_noise * depthSigma(z);
}

cv::Mat testDepth(const ReprojectedModel& reprojected, const SceneView& scene,
                  const VerificationParameters& parameters) {
  const cv::Rect& box = reprojected.box;
  cv::Mat state(box.size(), CV_8UC1, cv::Scalar(0));
  for (int v = 0; v < box.height; ++v) {
    const float* model_row = reprojected.depth.ptr<float>(v);
    const float* scene_row = scene.depth.ptr<float>(v + box.y) + box.x;
    auto* out = state.ptr<PixelState>(v);
    const double ray_y = (v + box.y - scene.camera.cy) / scene.camera.fy;
    for (int u = 0; u < box.width; ++u) {
      const double z = model_row[u];
      if (z <= 0.0) continue;
      if (!(scene_row[u] > 0.0f)) {
        out[u] = PixelState::kUnknown;
        continue;
      }
      const double ray_x = (u + box.x - scene.camera.cx) / scene.camera.fx;
      // Eq. (15): ranges, the distances ||p||, of the same pixel. Its printed form has lost the absolute value.
      const double difference = (scene_row[u] - z) * std::sqrt(ray_x * ray_x + ray_y * ray_y + 1.0);
      const double tolerance = depthTolerance(parameters, z);
      out[u] = difference >= tolerance    ? PixelState::kFreeSpace
               : difference <= -tolerance ? PixelState::kOccluded
                                          : PixelState::kConsistent;
    }
  }
  return state;
}

cv::Mat testColor(const ReprojectedModel& reprojected, const ModelCloud& model, const ColorTransform& illumination,
                  const SceneView& scene, const VerificationParameters& parameters) {
  const cv::Rect& box = reprojected.box;
  cv::Mat color_ok(box.size(), CV_8UC1, cv::Scalar(0));
  const ColorWindow window(scene.lab, parameters.w, parameters.epsilon_c);
  for (int v = 0; v < box.height; ++v) {
    const int* point_row = reprojected.point.ptr<int>(v);
    auto* out = color_ok.ptr<std::uint8_t>(v);
    for (int u = 0; u < box.width; ++u) {
      if (point_row[u] < 0) continue;
      const auto point = static_cast<size_t>(point_row[u]);
      const cv::Vec3f color = illumination(model.lab[point], model.normals[point]);
      out[u] = window.holds(box.tl() + cv::Point(u, v), color);
    }
  }
  return color_ok;
}

ConsistencyScores consistencyScores(const PixelConsistency& pixels, const cv::Rect& box,
                                    const Segmentation& segmentation, double w_c) {
  ConsistencyScores scores;
  int depth_ok = 0, color_ok = 0, occluded = 0, free_space = 0;
  SegmentOverlap overlap(segmentation);
  for (int v = 0; v < box.height; ++v) {
    const auto* state = pixels.state.ptr<PixelState>(v);
    const auto* color = pixels.color_ok.ptr<std::uint8_t>(v);
    const int* label = segmentation.labels.ptr<int>(v + box.y) + box.x;
    for (int u = 0; u < box.width; ++u) {
      if (state[u] == PixelState::kOutside) continue;
      ++scores.projected;
      const bool consistent = state[u] == PixelState::kConsistent;
      depth_ok += consistent;
      color_ok += color[u];
      occluded += state[u] == PixelState::kOccluded;
      free_space += state[u] == PixelState::kFreeSpace;
      if (consistent && color[u]) overlap.add(label[u]);
    }
  }
  if (scores.projected == 0) return scores;
  const double projected = scores.projected;
  scores.s_d = depth_ok / projected;  // eq. (12)
  scores.s_c = color_ok / projected;  // eq. (13)
  scores.best_segment = overlap.best();
  if (scores.best_segment > 0) {  // eq. (14)
    const size_t best = static_cast<size_t>(scores.best_segment);
    scores.s_o = overlap.f[best] / static_cast<double>(std::max(1, segmentation.patches[best - 1].pixels));
  }
  scores.total = (w_c * scores.s_c + (1.0 - w_c) * scores.s_d) * scores.s_o;  // eq. (17)
  scores.visible = 1.0 - occluded / projected;
  scores.free_space = free_space / projected;
  return scores;
}

}  // namespace recognition
