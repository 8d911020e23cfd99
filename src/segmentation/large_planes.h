#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "rgbd_recognition/core/camera.h"
#include "rgbd_recognition/segmentation/segmentation_parameters.h"

namespace recognition {

/// A plane as a depth camera sees it: 1/z = coefficients . (X, Y, 1) with X = (u - cx) / fx, Y = (v - cy) / fy. Linear
/// in the image, and 1 = coefficients . p for its points p.
struct InverseDepthPlane {
  Eigen::Vector3d coefficients = Eigen::Vector3d::Zero();
  double length = 0.0;  ///< three-sigma extent of its points, 6 sqrt(lambda_max) as in eq. (4), metres
};

/// Planes too large for any trained object (Sec. IV-A), in whatever orientation.
///
/// As in the paper, peaks of the distance transform of the edges are the seeds from which planar regions grow.
/// Deviation: regions grow by blocks of 8 x 8 pixels, whose sums make each test and each refit O(1), and only their
/// pixels are tested one by one at the end; parts of the plane that objects cut off from its main part are removed with
/// it; and a plane may bend slowly, as those do that a structured-light sensor sees, since its lens is never rectified
/// quite.
class LargePlaneFinder {
 public:
  explicit LargePlaneFinder(const SegmentationParameters& parameters);

  /// `inverse`: CV_32FC1 1/z, 0 invalid; `smooth`: CV_8UC1, 0 at edges and invalid pixels. Marks pixels of planes
  /// longer than `largest_length` (metres) with 255 in `planes` (CV_8UC1), edges near them included, and returns the
  /// planes.
  const std::vector<InverseDepthPlane>& find(const cv::Mat& inverse, const cv::Mat& smooth, const CameraModel& camera,
                                             double largest_length, cv::Mat* planes);

 private:
  /// Sums over the smooth pixels of a block.
  struct Sums {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0, d = 0, xd = 0, yd = 0, dd = 0;
    void add(const Sums& other);
    /// Mean and standard deviation of d - plane.
    double bias(const Eigen::Vector3d& plane) const;
    double spread(const Eigen::Vector3d& plane) const;
    bool fit(Eigen::Vector3d* plane) const;
  };

  void sumBlocks(const cv::Mat& inverse, const cv::Mat& smooth, const CameraModel& camera);
  void addRow(const float* inverse, const std::uint8_t* smooth, int begin, int end, const CameraModel& camera, double y,
              Sums* sums) const;
  void collectSeeds(const cv::Mat& smooth);
  bool grow(int seed, InverseDepthPlane* plane);
  int growOnce(int seed, const Eigen::Vector3d& plane, double bias_bound, Sums* sums);
  double lengthOfRegion() const;
  void addIslands(const Eigen::Vector3d& plane);
  void markPixels(const cv::Mat& inverse, const CameraModel& camera, const Eigen::Vector3d& plane,
                  cv::Mat* planes) const;
  bool biasNear(int column, int row, const Eigen::Vector3d& plane, double* bias) const;
  double sigmaOf(const Eigen::Vector3d& plane) const;

  const SegmentationParameters parameters_;
  double pixel_angle_ = 0.0;  ///< 1 / f
  int columns_ = 0;
  int rows_ = 0;
  std::vector<Sums> blocks_;
  std::vector<std::uint8_t> taken_;  ///< block belongs to a grown plane, large or not
  std::vector<int> region_;          ///< blocks of the plane that grows
  std::vector<std::uint8_t> in_region_;
  std::vector<std::pair<int, int>> seeds_;  ///< distance from edges, block
  cv::Mat half_, distance_;                 ///< at half the resolution: enough for seeds, a quarter of the time
  std::vector<InverseDepthPlane> found_;
};

}  // namespace recognition
