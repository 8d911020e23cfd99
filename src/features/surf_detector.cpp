#include "features/surf_detector.h"

#include <Eigen/LU>
#include <algorithm>
#include <cstring>
#include <opencv2/core/utility.hpp>

#include "features/hessian_filter.h"
#include "core/simd.h"

namespace recognition {

// 1 where a sample is above the threshold and not below its four neighbours and the two in scale.
RGBD_SIMD_CLONES void markCandidates(const float* above, const float* row, const float* below, const float* finer,
                                     const float* coarser, float threshold, int n, std::uint8_t* marks) {
  for (int i = 0; i < n; ++i) {
    const float v = row[i];
    marks[i] = (v > threshold) & (v >= row[i - 1]) & (v >= row[i + 1]) & (v >= above[i]) & (v >= below[i]) &
               (v >= finer[i]) & (v >= coarser[i]);
  }
}

namespace {

constexpr int kTile = 64;     // samples; what the mask does not touch is skipped by tiles
constexpr int kMaxRun = 256;  // samples of a row worked on together: what fits the cache

struct Octave {
  int step = 1;
  std::vector<HessianFilter> filters;
};

// Filter sizes 9, 15, 21, 27; 15, 27, 39, 51; 27, 51, 75, 99; ... (Sec. 3.3).
Octave octaveOf(int index, const SurfParameters& parameters) {
  Octave octave;
  octave.step = parameters.sampling_step << index;
  for (int layer = 0; layer < parameters.layers + 2; ++layer)
    octave.filters.emplace_back(3 * ((2 << index) * (layer + 1) + 1));
  return octave;
}

// The responses of all layers of an octave in a rectangle of samples, three rows at a time.
class OctaveScan {
 public:
  OctaveScan(const IntegralImage& image, const Octave& octave, float threshold, const cv::Rect& samples)
      : image_(image), octave_(octave), threshold_(threshold), samples_(samples), width_(samples.width + 2) {
    rows_.assign(octave.filters.size() * 3 * width_, 0.0f);
    marks_.resize(samples.width);
  }

  std::vector<Keypoint> run() {
    fillRow(samples_.y - 1);
    fillRow(samples_.y);
    for (int y = samples_.y; y < samples_.y + samples_.height; ++y) {
      fillRow(y + 1);
      for (size_t layer = 1; layer + 1 < octave_.filters.size(); ++layer) scanRow(static_cast<int>(layer), y);
    }
    return std::move(found_);
  }

 private:
  // Element 0 is sample column samples_.x - 1.
  float* row(int layer, int y) { return rows_.data() + (static_cast<size_t>(layer) * 3 + (y + 3) % 3) * width_; }

  void fillRow(int y) {
    const int step = octave_.step;
    for (size_t layer = 0; layer < octave_.filters.size(); ++layer) {
      const HessianFilter& filter = octave_.filters[layer];
      float* out = row(static_cast<int>(layer), y);
      std::fill(out, out + width_, 0.0f);
      const int margin = filter.margin();
      if (y * step < margin || y * step >= image_.height() - margin) continue;
      const int begin = std::max(samples_.x - 1, (margin + step - 1) / step);
      const int end = std::min(samples_.x + samples_.width + 1, (image_.width() - margin - 1) / step + 1);
      if (begin < end)
        filter.determinants(image_, begin * step, y * step, step, end - begin, buffers_,
                            out + begin - (samples_.x - 1));
    }
  }

  void scanRow(int layer, int y) {
    const int margin = octave_.filters[layer + 1].margin() + octave_.step;
    if (y * octave_.step < margin || y * octave_.step >= image_.height() - margin) return;
    markCandidates(row(layer, y - 1) + 1, row(layer, y) + 1, row(layer, y + 1) + 1, row(layer - 1, y) + 1,
                   row(layer + 1, y) + 1, threshold_, samples_.width, marks_.data());
    const std::uint8_t* marks = marks_.data();
    for (int i = 0; i < samples_.width; ++i) {
      const void* mark = std::memchr(marks + i, 1, static_cast<size_t>(samples_.width - i));
      if (!mark) break;
      i = static_cast<int>(static_cast<const std::uint8_t*>(mark) - marks);
      const int x = (samples_.x + i) * octave_.step;
      if (x >= margin && x < image_.width() - margin && isMaximum(layer, i + 1, y)) refine(layer, i + 1, y);
    }
  }

  bool isMaximum(int layer, int i, int y) {
    const float value = row(layer, y)[i];
    for (int l = layer - 1; l <= layer + 1; ++l)
      for (int v = y - 1; v <= y + 1; ++v)
        for (int u = i - 1; u <= i + 1; ++u) {
          const bool self = l == layer && v == y && u == i;
          if (!self && row(l, v)[u] >= value) return false;
        }
    return true;
  }

  // Brown and Lowe's quadratic fit in x, y and scale (Sec. 3.4).
  void refine(int layer, int i, int y) {
    const auto at = [&](int dx, int dy, int dl) { return row(layer + dl, y + dy)[i + dx]; };
    const float centre = at(0, 0, 0);
    const auto second = [&](int dx, int dy, int dl) { return at(dx, dy, dl) - 2.0f * centre + at(-dx, -dy, -dl); };
    const auto mixed = [&](int ax, int ay, int al, int bx, int by, int bl) {
      return 0.25f * (at(ax + bx, ay + by, al + bl) - at(ax - bx, ay - by, al - bl) - at(bx - ax, by - ay, bl - al) +
                      at(-ax - bx, -ay - by, -al - bl));
    };
    const Eigen::Vector3f gradient(0.5f * (at(1, 0, 0) - at(-1, 0, 0)), 0.5f * (at(0, 1, 0) - at(0, -1, 0)),
                                   0.5f * (at(0, 0, 1) - at(0, 0, -1)));
    Eigen::Matrix3f hessian;
    hessian(0, 0) = second(1, 0, 0);
    hessian(1, 1) = second(0, 1, 0);
    hessian(2, 2) = second(0, 0, 1);
    hessian(0, 1) = hessian(1, 0) = mixed(1, 0, 0, 0, 1, 0);
    hessian(0, 2) = hessian(2, 0) = mixed(1, 0, 0, 0, 0, 1);
    hessian(1, 2) = hessian(2, 1) = mixed(0, 1, 0, 0, 0, 1);
    const Eigen::Vector3f offset = -hessian.partialPivLu().solve(gradient);
    if (!(offset.cwiseAbs().maxCoeff() < 1.0f)) return;

    const int x = samples_.x + i - 1, step = octave_.step;
    const HessianFilter& filter = octave_.filters[layer];
    Keypoint keypoint;
    keypoint.x = (static_cast<float>(x) + offset.x()) * static_cast<float>(step);
    keypoint.y = (static_cast<float>(y) + offset.y()) * static_cast<float>(step);
    keypoint.size = static_cast<float>(filter.size()) +
                    offset.z() * static_cast<float>(octave_.filters[1].size() - octave_.filters[0].size());
    keypoint.response = centre + 0.5f * gradient.dot(offset);
    keypoint.bright = !filter.isDark(image_, x * step, y * step);
    found_.push_back(keypoint);
  }

  const IntegralImage& image_;
  const Octave& octave_;
  const float threshold_;
  const cv::Rect samples_;
  const size_t width_;
  std::vector<float> rows_;
  std::vector<std::uint8_t> marks_;
  HessianFilter::Rows buffers_;
  std::vector<Keypoint> found_;
};

// The tiles of an octave's samples that the mask touches, joined along rows.
std::vector<cv::Rect> touchedRuns(const IntegralImage& image, const cv::Mat& mask, int step) {
  const int columns = (image.width() + step - 1) / step, rows = (image.height() + step - 1) / step;
  std::vector<cv::Rect> runs;
  for (int y = 0; y < rows; y += kTile) {
    const int height = std::min(kTile, rows - y);
    bool open = false;
    for (int x = 0; x < columns; x += kTile) {
      const int width = std::min(kTile, columns - x);
      const auto scaled = [&](int v) { return static_cast<int>(image.lengthToOriginal(static_cast<float>(v * step))); };
      const cv::Rect pixels(scaled(x) - 2, scaled(y) - 2, scaled(width) + 5, scaled(height) + 5);
      const bool touched = mask.empty() || cv::countNonZero(mask(pixels & cv::Rect(0, 0, mask.cols, mask.rows))) > 0;
      if (touched && open && runs.back().width < kMaxRun)
        runs.back().width += width;
      else if (touched)
        runs.emplace_back(x, y, width, height);
      open = touched;
    }
  }
  return runs;
}

}  // namespace

std::vector<Keypoint> detectSurf(const IntegralImage& image, const cv::Mat& mask, const SurfParameters& parameters) {
  std::vector<Keypoint> keypoints;
  for (int index = 0; index < parameters.octaves; ++index) {
    const Octave octave = octaveOf(index, parameters);
    const std::vector<cv::Rect> runs = touchedRuns(image, mask, octave.step);
    std::vector<std::vector<Keypoint>> found(runs.size());
    cv::parallel_for_(cv::Range(0, static_cast<int>(runs.size())), [&](const cv::Range& range) {
      for (int i = range.start; i < range.end; ++i)
        found[i] = OctaveScan(image, octave, static_cast<float>(parameters.hessian_threshold), runs[i]).run();
    });
    for (const auto& some : found) keypoints.insert(keypoints.end(), some.begin(), some.end());
  }
  return keypoints;
}

}  // namespace recognition
