#include "surf_descriptor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "haar_wavelets.h"

namespace rgbd_recognition {
namespace {

constexpr float kScaleOfSize = 1.2f / 9.0f;  // a filter of size 9 is a Gaussian of 1.2 pixels (Sec. 3.3)
constexpr int kCircle = 6;                   // radius, in s
constexpr int kBins = 72;                    // of 5 degrees
constexpr int kWindow = kBins / 6;           // 60 degrees
constexpr int kCells = 4;
constexpr int kSamples = 5;  // along a side of a sub-region
constexpr int kGrid = kCells * kSamples;
constexpr float kDescriptorSigma = 3.3f;   // in s
constexpr float kOrientationSigma = 2.0f;  // in s

float scaleOf(const Keypoint& keypoint) { return kScaleOfSize * keypoint.size; }
int halfSide(float length) { return std::max(1, static_cast<int>(std::lround(length))); }

struct Offset {
  float x, y, weight;
};

std::vector<Offset> circleOffsets() {
  std::vector<Offset> offsets;
  for (int y = -kCircle; y <= kCircle; ++y)
    for (int x = -kCircle; x <= kCircle; ++x)
      if (x * x + y * y <= kCircle * kCircle)
        offsets.push_back(
            {float(x), float(y), std::exp(-(x * x + y * y) / (2.0f * kOrientationSigma * kOrientationSigma))});
  return offsets;
}

// Samples in the order of the sub-regions, row by row within each.
std::vector<Offset> gridOffsets() {
  std::vector<Offset> offsets;
  for (int cell = 0; cell < kCells * kCells; ++cell)
    for (int sample = 0; sample < kSamples * kSamples; ++sample) {
      const float x = static_cast<float>(cell % kCells * kSamples + sample % kSamples) - 0.5f * (kGrid - 1);
      const float y = static_cast<float>(cell / kCells * kSamples + sample / kSamples) - 0.5f * (kGrid - 1);
      offsets.push_back({x, y, std::exp(-(x * x + y * y) / (2.0f * kDescriptorSigma * kDescriptorSigma))});
    }
  return offsets;
}

// Wavelet responses around the keypoint, in the image's frame.
void sampleAround(const IntegralImage& image, const Keypoint& keypoint, const std::vector<Offset>& offsets, float angle,
                  int half, HaarSamples& samples) {
  const float c = std::cos(angle) * scaleOf(keypoint), s = std::sin(angle) * scaleOf(keypoint);
  samples.resize(offsets.size());
  for (size_t i = 0; i < offsets.size(); ++i) {
    samples.x[i] = keypoint.x + c * offsets[i].x - s * offsets[i].y;
    samples.y[i] = keypoint.y + s * offsets[i].x + c * offsets[i].y;
  }
  samples.evaluate(image, half);
}

struct CellSums {
  float dx = 0.0f, dy = 0.0f, abs_dx = 0.0f, abs_dy = 0.0f;

  void add(float x, float y) {
    dx += x;
    dy += y;
    abs_dx += std::abs(x);
    abs_dy += std::abs(y);
  }
};

void normalize(float* descriptor, int n, bool root) {
  if (root) {
    for (int i = 0; i < n; ++i) descriptor[i] = std::copysign(std::sqrt(std::abs(descriptor[i])), descriptor[i]);
  }
  double square = 0.0;
  for (int i = 0; i < n; ++i) square += double(descriptor[i]) * descriptor[i];
  if (square <= 0.0) return;
  const float scale = static_cast<float>(1.0 / std::sqrt(square));
  for (int i = 0; i < n; ++i) descriptor[i] *= scale;
}

}  // namespace

float surfOrientation(const IntegralImage& image, const Keypoint& keypoint) {
  static const std::vector<Offset> offsets = circleOffsets();
  thread_local HaarSamples samples;
  sampleAround(image, keypoint, offsets, 0.0f, halfSide(2.0f * scaleOf(keypoint)), samples);
  std::array<float, kBins + kWindow> x{}, y{};
  for (size_t i = 0; i < offsets.size(); ++i) {
    const float dx = offsets[i].weight * samples.dx[i], dy = offsets[i].weight * samples.dy[i];
    const float turn = std::atan2(dy, dx) * static_cast<float>(0.5 / CV_PI);
    const int bin = static_cast<int>((turn < 0.0f ? turn + 1.0f : turn) * kBins) % kBins;
    x[bin] += dx;
    y[bin] += dy;
  }
  std::copy_n(x.begin(), kWindow, x.begin() + kBins);
  std::copy_n(y.begin(), kWindow, y.begin() + kBins);
  float longest = -1.0f, best_x = 1.0f, best_y = 0.0f;
  for (int first = 0; first < kBins; ++first) {
    float sum_x = 0.0f, sum_y = 0.0f;
    for (int bin = first; bin < first + kWindow; ++bin) {
      sum_x += x[bin];
      sum_y += y[bin];
    }
    const float length = sum_x * sum_x + sum_y * sum_y;
    if (length <= longest) continue;
    longest = length;
    best_x = sum_x;
    best_y = sum_y;
  }
  return std::atan2(best_y, best_x);
}

void surfDescriptor(const IntegralImage& image, const Keypoint& keypoint, bool extended, bool root, float* descriptor) {
  static const std::vector<Offset> offsets = gridOffsets();
  thread_local HaarSamples samples;
  sampleAround(image, keypoint, offsets, keypoint.angle, halfSide(scaleOf(keypoint)), samples);
  const float c = std::cos(keypoint.angle), s = std::sin(keypoint.angle);
  const int length = extended ? 8 : 4;
  for (int cell = 0; cell < kCells * kCells; ++cell) {
    CellSums all, rest_x, rest_y;  // extended: `all.dx` where dy >= 0, rest_x where dy < 0; and the other way round
    for (int i = cell * kSamples * kSamples; i < (cell + 1) * kSamples * kSamples; ++i) {
      const float dx = offsets[i].weight * (c * samples.dx[i] + s * samples.dy[i]);
      const float dy = offsets[i].weight * (c * samples.dy[i] - s * samples.dx[i]);
      (extended && dy < 0.0f ? rest_x : all).add(dx, 0.0f);
      (extended && dx < 0.0f ? rest_y : all).add(0.0f, dy);
    }
    float* out = descriptor + cell * length;
    if (extended) {
      const float values[] = {all.dx, all.abs_dx, rest_x.dx, rest_x.abs_dx,
                              all.dy, all.abs_dy, rest_y.dy, rest_y.abs_dy};
      std::copy_n(values, 8, out);
    } else {
      const float values[] = {all.dx, all.dy, all.abs_dx, all.abs_dy};
      std::copy_n(values, 4, out);
    }
  }
  normalize(descriptor, kCells * kCells * length, root);
}

}  // namespace rgbd_recognition
