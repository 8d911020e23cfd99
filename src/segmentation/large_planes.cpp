#include "segmentation/large_planes.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <opencv2/imgproc.hpp>

#include "core/depth_noise.h"

namespace recognition {
namespace {

constexpr int kBlock = 8;              ///< pixels
constexpr double kMinFilled = 0.25;    ///< share of a block's pixels that must be smooth
constexpr double kSpreadBound = 2.0;   ///< spread inside a block of the plane, standard deviations of the sensor
constexpr double kDriftBound = 1.5;    ///< change of bias from block to block, the same unit
constexpr double kFitBiasBound = 4.0;  ///< distance from the plane of a block that it is fitted to, the same unit
constexpr double kBiasBound = 12.0;    ///< distance of a block that belongs to the bent plane, the same unit
constexpr double kIslandBound = 2.0;   ///< the same for blocks that are not connected with it
constexpr int kGrowthRounds = 8;
constexpr double kAlignmentPoints = 0.01;  ///< share of a region's blocks that may still change

const double kSigma = depthSigma(1.0);  ///< of 1/z, at any range

}  // namespace

LargePlaneFinder::LargePlaneFinder(const SegmentationParameters& parameters) : parameters_(parameters) {}

void LargePlaneFinder::Sums::add(const Sums& o) {
  n += o.n, x += o.x, y += o.y, xx += o.xx, xy += o.xy, yy += o.yy, d += o.d, xd += o.xd, yd += o.yd, dd += o.dd;
}

double LargePlaneFinder::Sums::bias(const Eigen::Vector3d& p) const { return (d - p[0] * x - p[1] * y - p[2] * n) / n; }

double LargePlaneFinder::Sums::spread(const Eigen::Vector3d& p) const {
  const double a = p[0], b = p[1], c = p[2];
  const double model = a * a * xx + b * b * yy + c * c * n + 2.0 * (a * b * xy + a * c * x + b * c * y);
  const double square = dd - 2.0 * (a * xd + b * yd + c * d) + model;
  return std::sqrt(std::max(0.0, square / n - bias(p) * bias(p)));
}

bool LargePlaneFinder::Sums::fit(Eigen::Vector3d* plane) const {
  Eigen::Matrix3d normal;
  normal << xx, xy, x, xy, yy, y, x, y, n;
  const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
  if (n < 3.0 || solver.info() != Eigen::Success) return false;
  *plane = solver.solve(Eigen::Vector3d(xd, yd, d));
  return plane->allFinite();
}

/// Standard deviation of 1/z on the plane: the sensor's, and its lateral noise times the slope (ScanLineSplitter,
/// deviation 4).
double LargePlaneFinder::sigmaOf(const Eigen::Vector3d& plane) const {
  const double slant = parameters_.lateral * plane.head<2>().norm() * pixel_angle_;
  return std::sqrt(kSigma * kSigma + slant * slant);
}

const std::vector<InverseDepthPlane>& LargePlaneFinder::find(const cv::Mat& inverse, const cv::Mat& smooth,
                                                             const CameraModel& camera, double largest_length,
                                                             cv::Mat* planes) {
  planes->create(inverse.size(), CV_8UC1);
  planes->setTo(0);
  found_.clear();
  sumBlocks(inverse, smooth, camera);
  collectSeeds(smooth);
  for (const auto& seed : seeds_) {
    InverseDepthPlane plane;
    if (taken_[static_cast<size_t>(seed.second)] || !grow(seed.second, &plane)) continue;
    if (plane.length > largest_length) {
      addIslands(plane.coefficients);
      markPixels(inverse, camera, plane.coefficients, planes);
      found_.push_back(plane);
    }
    for (int block : region_) taken_[static_cast<size_t>(block)] = 1;
  }
  return found_;
}

void LargePlaneFinder::sumBlocks(const cv::Mat& inverse, const cv::Mat& smooth, const CameraModel& camera) {
  pixel_angle_ = 1.0 / camera.fx;
  columns_ = (inverse.cols + kBlock - 1) / kBlock;
  rows_ = (inverse.rows + kBlock - 1) / kBlock;
  blocks_.assign(static_cast<size_t>(columns_) * rows_, Sums());
  taken_.assign(blocks_.size(), 0);
  in_region_.assign(blocks_.size(), 0);
  cv::parallel_for_(cv::Range(0, rows_), [&](const cv::Range& part) {
    for (int v = part.start * kBlock; v < std::min(part.end * kBlock, inverse.rows); ++v) {
      const double y = (v - camera.cy) / camera.fy;
      for (int column = 0; column < columns_; ++column) {
        const int begin = column * kBlock, end = std::min(begin + kBlock, inverse.cols);
        Sums& s = blocks_[static_cast<size_t>(v / kBlock) * columns_ + column];
        addRow(inverse.ptr<float>(v), smooth.ptr(v), begin, end, camera, y, &s);
      }
    }
  });
}

void LargePlaneFinder::addRow(const float* inverse, const std::uint8_t* smooth, int begin, int end,
                              const CameraModel& camera, double y, Sums* s) const {
  double n = 0.0, x_sum = 0.0, xx = 0.0, d_sum = 0.0, xd = 0.0, dd = 0.0;
  for (int u = begin; u < end; ++u) {
    if (!smooth[u]) continue;
    const double x = (u - camera.cx) * pixel_angle_, d = inverse[u];
    n += 1.0, x_sum += x, xx += x * x, d_sum += d, xd += x * d, dd += d * d;
  }
  s->n += n, s->x += x_sum, s->y += y * n, s->xx += xx, s->xy += y * x_sum, s->yy += y * y * n;
  s->d += d_sum, s->xd += xd, s->yd += y * d_sum, s->dd += dd;
}

void LargePlaneFinder::collectSeeds(const cv::Mat& smooth) {
  cv::resize(smooth, half_, {(smooth.cols + 1) / 2, (smooth.rows + 1) / 2}, 0, 0, cv::INTER_NEAREST);
  cv::distanceTransform(half_, distance_, cv::DIST_L1, 3, CV_8U);
  seeds_.clear();
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const int u = std::min(column * kBlock + kBlock / 2, smooth.cols - 1);
      const int v = std::min(row * kBlock + kBlock / 2, smooth.rows - 1);
      const int distance = 2 * distance_.at<std::uint8_t>(v / 2, u / 2);
      if (distance >= parameters_.plane_seed_distance) seeds_.emplace_back(distance, row * columns_ + column);
    }
  }
  std::sort(seeds_.begin(), seeds_.end(),
            [](const auto& a, const auto& b) { return a.first != b.first ? a.first > b.first : a.second < b.second; });
}

bool LargePlaneFinder::grow(int seed, InverseDepthPlane* plane) {
  Sums sums;
  for (int row = std::max(0, seed / columns_ - 1); row <= std::min(rows_ - 1, seed / columns_ + 1); ++row)
    for (int column = std::max(0, seed % columns_ - 1); column <= std::min(columns_ - 1, seed % columns_ + 1); ++column)
      sums.add(blocks_[static_cast<size_t>(row) * columns_ + column]);
  int size = 0;
  for (int round = 0; round < kGrowthRounds; ++round) {
    Eigen::Vector3d p;
    if (!sums.fit(&p) || (round == 0 && sums.spread(p) > kSpreadBound * sigmaOf(p))) return false;
    plane->coefficients = p;
    const int grown = growOnce(seed, p, kFitBiasBound, &sums);
    if (grown == 0) return false;
    if (std::abs(grown - size) <= kAlignmentPoints * size) break;
    size = grown;
  }
  growOnce(seed, plane->coefficients, kBiasBound, &sums);
  plane->length = lengthOfRegion();
  return true;
}

int LargePlaneFinder::growOnce(int seed, const Eigen::Vector3d& plane, double bias_bound, Sums* sums) {
  std::fill(in_region_.begin(), in_region_.end(), 0);
  region_.clear();
  *sums = Sums();
  const double sigma = sigmaOf(plane);
  const auto visit = [&](int block, double from_bias) {
    const Sums& s = blocks_[static_cast<size_t>(block)];
    if (in_region_[static_cast<size_t>(block)] || taken_[static_cast<size_t>(block)]) return;
    if (s.n < kMinFilled * kBlock * kBlock) return;
    const double bias = s.bias(plane);
    if (std::abs(bias - from_bias) > kDriftBound * sigma || std::abs(bias) > bias_bound * sigma) return;
    if (s.spread(plane) > kSpreadBound * sigma) return;
    in_region_[static_cast<size_t>(block)] = 1;
    region_.push_back(block);
    sums->add(s);
  };
  visit(seed, 0.0);
  for (size_t next = 0; next < region_.size(); ++next) {
    const int block = region_[next], column = block % columns_, row = block / columns_;
    const double bias = blocks_[static_cast<size_t>(block)].bias(plane);
    if (column > 0) visit(block - 1, bias);
    if (column + 1 < columns_) visit(block + 1, bias);
    if (row > 0) visit(block - columns_, bias);
    if (row + 1 < rows_) visit(block + columns_, bias);
  }
  return static_cast<int>(region_.size());
}

double LargePlaneFinder::lengthOfRegion() const {
  double n = 0.0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
  for (int block : region_) {
    const Sums& s = blocks_[static_cast<size_t>(block)];
    const Eigen::Vector3d p = Eigen::Vector3d(s.x / s.n, s.y / s.n, 1.0) * (s.n / s.d);
    n += s.n;
    sum += s.n * p;
    square += s.n * p * p.transpose();
  }
  const Eigen::Matrix3d covariance = square / n - sum * sum.transpose() / (n * n);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  return 6.0 * std::sqrt(std::max(0.0, solver.eigenvalues()[2]));
}

void LargePlaneFinder::addIslands(const Eigen::Vector3d& plane) {
  const double sigma = sigmaOf(plane);
  for (size_t block = 0; block < blocks_.size(); ++block) {
    const Sums& s = blocks_[block];
    if (taken_[block] || in_region_[block] || s.n < kMinFilled * kBlock * kBlock) continue;
    if (std::abs(s.bias(plane)) > kIslandBound * sigma || s.spread(plane) > kSpreadBound * sigma) continue;
    in_region_[block] = 1;
    region_.push_back(static_cast<int>(block));
  }
}

/// Bias of the block or, beside the region, the mean of its neighbours'. False far from the region.
bool LargePlaneFinder::biasNear(int column, int row, const Eigen::Vector3d& plane, double* bias) const {
  const size_t block = static_cast<size_t>(row) * columns_ + column;
  if (in_region_[block]) {
    *bias = blocks_[block].bias(plane);
    return true;
  }
  int count = 0;
  *bias = 0.0;
  for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1); ++r) {
    for (int c = std::max(0, column - 1); c <= std::min(columns_ - 1, column + 1); ++c) {
      const size_t neighbour = static_cast<size_t>(r) * columns_ + c;
      if (!in_region_[neighbour]) continue;
      *bias += blocks_[neighbour].bias(plane);
      ++count;
    }
  }
  *bias /= std::max(1, count);
  return count > 0;
}

void LargePlaneFinder::markPixels(const cv::Mat& inverse, const CameraModel& camera, const Eigen::Vector3d& plane,
                                  cv::Mat* planes) const {
  const float bound = static_cast<float>(parameters_.plane_bound * sigmaOf(plane));
  const float step = static_cast<float>(plane[0] / camera.fx);
  cv::parallel_for_(cv::Range(0, rows_), [&](const cv::Range& part) {
    for (int row = part.start; row < part.end; ++row) {
      for (int column = 0; column < columns_; ++column) {
        double bias = 0.0;
        if (!biasNear(column, row, plane, &bias)) continue;
        const int u_end = std::min((column + 1) * kBlock, inverse.cols);
        for (int v = row * kBlock; v < std::min((row + 1) * kBlock, inverse.rows); ++v) {
          const float* from = inverse.ptr<float>(v);
          std::uint8_t* to = planes->ptr(v);
          const float start = static_cast<float>(bias + plane[2] + plane[1] * (v - camera.cy) / camera.fy -
                                                 plane[0] * camera.cx / camera.fx);
          for (int u = column * kBlock; u < u_end; ++u)
            if (from[u] > 0.0f && std::abs(from[u] - (start + step * static_cast<float>(u))) <= bound) to[u] = 255;
        }
      }
    }
  });
}

}  // namespace recognition
