#include "features/surf_descriptor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core/hal/hal.hpp>

#include "core/simd.h"

namespace recognition {

constexpr int kCells = 4;
constexpr int kMaxSums = 8;
constexpr int kMaxSide = 24;

// The terms of the sums for a row of samples in the keypoint's frame: dx, dy, |dx|, |dy|; extended, the x terms where
// dy >= 0, where dy < 0, and the y terms likewise.
static inline void responseTerms(const float* dx, const float* dy, float c, float s, int side, bool extended,
                                 float (*terms)[kMaxSide]) {
  for (int i = 0; i < side; ++i) {
    const float x = c * dx[i] + s * dy[i], y = c * dy[i] - s * dx[i];
    const float abs_x = std::abs(x), abs_y = std::abs(y);
    if (extended) {
      const float x_there = y >= 0.0f ? x : 0.0f, abs_x_there = y >= 0.0f ? abs_x : 0.0f;
      const float y_there = x >= 0.0f ? y : 0.0f, abs_y_there = x >= 0.0f ? abs_y : 0.0f;
      terms[0][i] = x_there;
      terms[1][i] = abs_x_there;
      terms[2][i] = x - x_there;
      terms[3][i] = abs_x - abs_x_there;
      terms[4][i] = y_there;
      terms[5][i] = abs_y_there;
      terms[6][i] = y - y_there;
      terms[7][i] = abs_y - abs_y_there;
    } else {
      terms[0][i] = x;
      terms[1][i] = y;
      terms[2][i] = abs_x;
      terms[3][i] = abs_y;
    }
  }
}

// Sums up terms by sub-regions. The weights are separable, so samples are pooled along columns first. `profile`: kCells
// x kMaxSide; descriptor: kCells x kCells x (extended ? 8 : 4).
RGBD_SIMD_CLONES void poolResponses(const float* dx, const float* dy, float c, float s, int side, const float* profile,
                                    bool extended, float* descriptor) {
  const int count = extended ? kMaxSums : kMaxSums / 2;
  float pooled[kCells][kMaxSums][kMaxSide] = {}, terms[kMaxSums][kMaxSide] = {};
  for (int row = 0; row < side; ++row) {
    responseTerms(dx + row * side, dy + row * side, c, s, side, extended, terms);
    for (int cell = 0; cell < kCells; ++cell) {
      const float weight = profile[cell * kMaxSide + row];
      if (weight == 0.0f) continue;
      for (int k = 0; k < count; ++k)
        for (int i = 0; i < kMaxSide; ++i) pooled[cell][k][i] += weight * terms[k][i];
    }
  }
  for (int row = 0; row < kCells; ++row)
    for (int column = 0; column < kCells; ++column)
      for (int k = 0; k < count; ++k) {
        float sum = 0.0f;
        for (int i = 0; i < side; ++i) sum += profile[column * kMaxSide + i] * pooled[row][k][i];
        descriptor[(row * kCells + column) * count + k] = sum;
      }
}

namespace {

constexpr float kScaleOfSize = 1.2f / 9.0f;  // a filter of size 9 is a Gaussian of 1.2 pixels (Sec. 3.3)
constexpr int kCircle = 6;                   // radius, in s
constexpr float kOrientationSigma = 2.0f;    // in s
constexpr int kBins = 72;                    // of 5 degrees
constexpr int kWindow = kBins / 6;           // 60 degrees

float scaleOf(const Keypoint& keypoint) { return kScaleOfSize * keypoint.size; }
int halfSide(float length) { return std::max(1, static_cast<int>(std::lround(length))); }
int descriptorHalf(const Keypoint& keypoint) { return halfSide(scaleOf(keypoint)); }
int orientationHalf(const Keypoint& keypoint) { return halfSide(2.0f * scaleOf(keypoint)); }
float gauss(float x, float sigma) { return std::exp(-x * x / (2.0f * sigma * sigma)); }

struct OrientationCircle {
  SampleOffsets offsets;
  std::vector<float> weights;
};

OrientationCircle orientationCircle() {
  OrientationCircle circle;
  for (int y = -kCircle; y <= kCircle; ++y)
    for (int x = -kCircle; x <= kCircle; ++x)
      if (x * x + y * y <= kCircle * kCircle) {
        circle.offsets.add(static_cast<float>(x), static_cast<float>(y));
        circle.weights.push_back(gauss(static_cast<float>(x), kOrientationSigma) *
                                 gauss(static_cast<float>(y), kOrientationSigma));
      }
  return circle;
}

// Weight of a sample `x` s from the keypoint in sub-region `cell` of a row of four, each 5 s wide (Sec. 4.2: Gaussian
// of 3.3 s on the keypoint).
float plainWeight(float x, int cell) {
  const float distance = std::abs(x - 5.0f * (static_cast<float>(cell) - 1.5f));
  return distance < 2.5f ? gauss(x, 3.3f) : 0.0f;
}

// The same where sub-regions are 9 s wide and overlap, with a Gaussian of 2.5 s each and one of 1.5 sub-regions over
// them (Agrawal, Konolige, Blas, "CenSurE", ECCV 2008, Sec. 4).
float overlappingWeight(float x, int cell) {
  const float place = static_cast<float>(cell) - 1.5f, distance = std::abs(x - 5.0f * place);
  return distance < 4.6f ? gauss(distance, 2.5f) * gauss(place, 1.5f) : 0.0f;
}

void normalize(float* descriptor, int n) {
  double square = 0.0;
  for (int i = 0; i < n; ++i) square += static_cast<double>(descriptor[i]) * descriptor[i];
  if (square <= 0.0) return;
  const float scale = static_cast<float>(1.0 / std::sqrt(square));
  for (int i = 0; i < n; ++i) descriptor[i] *= scale;
}

using AngleBins = std::array<float, kBins + kWindow>;  // the first window's bins once more at the end

// Angle of the longest sum of responses in a window of 60 degrees.
float longestWindow(AngleBins& x, AngleBins& y) {
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

}  // namespace

void makeSurfResponses(const IntegralImage& image, const std::vector<Keypoint>& keypoints, bool oriented,
                       HaarResponses& dense) {
  for (const Keypoint& keypoint : keypoints)
    for (const int half : {descriptorHalf(keypoint), oriented ? orientationHalf(keypoint) : descriptorHalf(keypoint)})
      if (half <= kMaxInterpolatedHalf) dense.make(image, half);
}

float surfOrientation(const IntegralImage& image, const HaarResponses& dense, const Keypoint& keypoint) {
  static const OrientationCircle circle = orientationCircle();
  thread_local HaarSampler sampler;
  sampler.place(keypoint.x, keypoint.y, scaleOf(keypoint), 0.0f, circle.offsets);
  sampler.evaluate(image, dense, orientationHalf(keypoint));
  thread_local std::vector<float> degrees;
  degrees.resize(circle.weights.size());
  cv::hal::fastAtan32f(sampler.dy().data(), sampler.dx().data(), degrees.data(), static_cast<int>(degrees.size()),
                       true);
  AngleBins x{}, y{};
  for (size_t i = 0; i < degrees.size(); ++i) {
    const int bin = static_cast<int>(degrees[i] * (kBins / 360.0f)) % kBins;
    x[bin] += circle.weights[i] * sampler.dx()[i];
    y[bin] += circle.weights[i] * sampler.dy()[i];
  }
  return longestWindow(x, y);
}

SurfDescriptor::SurfDescriptor(bool extended, const SurfParameters& parameters)
    : extended_(extended), side_(parameters.overlap ? kMaxSide : 20) {
  const auto place = [this](int i) { return static_cast<float>(i) - 0.5f * static_cast<float>(side_ - 1); };
  for (int row = 0; row < side_; ++row)
    for (int column = 0; column < side_; ++column) offsets_.add(place(column), place(row));
  profile_.assign(kCells * kMaxSide, 0.0f);
  for (int cell = 0; cell < kCells; ++cell)
    for (int i = 0; i < side_; ++i)
      profile_[cell * kMaxSide + i] =
          parameters.overlap ? overlappingWeight(place(i), cell) : plainWeight(place(i), cell);
}

void SurfDescriptor::describe(const IntegralImage& image, const HaarResponses& dense, const Keypoint& keypoint,
                              float* descriptor) const {
  thread_local HaarSampler sampler;
  const float c = std::cos(keypoint.angle), s = std::sin(keypoint.angle), scale = scaleOf(keypoint);
  sampler.place(keypoint.x, keypoint.y, scale * c, scale * s, offsets_);
  sampler.evaluate(image, dense, descriptorHalf(keypoint));
  poolResponses(sampler.dx().data(), sampler.dy().data(), c, s, side_, profile_.data(), extended_, descriptor);
  const int n = kCells * kCells * (extended_ ? kMaxSums : kMaxSums / 2);
  normalize(descriptor, n);
}

}  // namespace recognition
