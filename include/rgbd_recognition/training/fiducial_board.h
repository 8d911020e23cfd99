#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "rgbd_recognition/core/camera.h"
#include "rgbd_recognition/core/pose.h"

namespace recognition {

/// A printed board under the object, from config/boards/*.yaml.
///
/// Board frame: origin in the board's middle, x to the right of the print, y to its top, z out of the paper (up, on a
/// turntable); metres.
class FiducialBoard {
 public:
  /// A square marker of an ArUco dictionary; corners in the board frame, clockwise from the upper left of the print, as
  /// ArUco has them.
  struct Marker {
    int id = 0;
    Eigen::Vector2d corners[4];
  };
  /// A chessboard, found only if all of it is seen; one count is even, the other odd, so that it has no symmetry.
  struct Checkerboard {
    int columns = 0;  ///< inner corners
    int rows = 0;
    double square = 0.0;         ///< side, metres
    Eigen::Vector2d upper_left;  ///< inner corner, board frame
    Eigen::Vector2d corner(int column, int row) const { return upper_left + square * Eigen::Vector2d(column, -row); }
  };

  /// Throws std::invalid_argument with file, key and reason.
  static FiducialBoard fromYaml(const std::string& file);

  const std::string& name() const { return name_; }
  Eigen::Vector2d size() const { return size_; }  ///< width and height of the print, metres
  int dictionary() const { return dictionary_; }  ///< cv::aruco::PREDEFINED_DICTIONARY_NAME of the markers
  double markerSide() const { return marker_side_; }
  const std::vector<Marker>& markers() const { return markers_; }
  /// Corners between the squares of a ChArUco board, board frame.
  const std::vector<Eigen::Vector2d>& saddles() const { return saddles_; }
  const std::vector<Checkerboard>& checkerboards() const { return checkerboards_; }

  /// A dark rectangle of the print: lower left corner and size, board frame, metres.
  struct DarkArea {
    Eigen::Vector2d corner, size;
  };
  /// All that is dark in the print, markers cell by cell: for drawing it at true size, whatever the resolution.
  std::vector<DarkArea> darkAreas() const;
  /// The print, CV_8UC1.
  cv::Mat draw(double pixels_per_metre) const;

 private:
  std::string name_;
  Eigen::Vector2d size_ = Eigen::Vector2d::Zero();
  int dictionary_ = 0;
  double marker_side_ = 0.0;
  std::vector<Marker> markers_;
  std::vector<Eigen::Vector2d> saddles_;
  std::vector<cv::Rect2d> dark_squares_;  // lower left corner and size, board frame
  std::vector<Checkerboard> checkerboards_;

  void addMarkerGrid(int columns, int rows, double marker, double pitch, bool charuco);
  void addCheckerboard(const Checkerboard& board);
};

/// A board seen in an image.
struct BoardObservation {
  Pose camera_from_board = Pose::Identity();
  std::vector<Eigen::Vector3d> points;  ///< board frame, metres
  std::vector<Eigen::Vector2d> pixels;  ///< where they are seen
  double rms = 0.0;                     ///< of the reprojection, pixels
};

/// The board's pose from a CV_8UC1 image; nothing if too little of it is seen to be sure.
std::optional<BoardObservation> detectBoard(const FiducialBoard& board, const cv::Mat& gray, const CameraModel& camera);

}  // namespace recognition
