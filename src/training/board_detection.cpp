#include <algorithm>
#include <cmath>

#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "rgbd_recognition/training/fiducial_board.h"

namespace recognition {
namespace {

constexpr int kMinMarkers = 3;
constexpr int kMarkerWindow = 2;  // pixels around a marker's corner; more would take in its bits and neighbours
constexpr double kMaxRms = 2.5;   // pixels; beyond, the board is another one than described
constexpr double kNearMarker =
    1.5;  // a saddle counts as seen if a seen marker's centre is nearer than this, in marker sides
const cv::TermCriteria kSubPixel(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 40, 0.01);

cv::Matx33d cameraMatrix(const CameraModel& camera) {
  return {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
}

// Points of the board with the pixels that show them.
struct PointPairs {
  std::vector<cv::Point3f> board;
  std::vector<cv::Point2f> image;

  void add(const Eigen::Vector2d& point, const cv::Point2f& pixel) {
    board.emplace_back(static_cast<float>(point.x()), static_cast<float>(point.y()), 0.0f);
    image.push_back(pixel);
  }
};

struct CameraPose {
  cv::Vec3d rotation, translation;

  bool solve(const PointPairs& pairs, const CameraModel& camera, bool from_scratch) {
    if (pairs.board.size() < 4) return false;
    const cv::Matx33d matrix = cameraMatrix(camera);
    if (from_scratch &&
        !cv::solvePnP(pairs.board, pairs.image, matrix, cv::noArray(), rotation, translation, false, cv::SOLVEPNP_IPPE))
      return false;
    return cv::solvePnP(pairs.board, pairs.image, matrix, cv::noArray(), rotation, translation, true,
                        cv::SOLVEPNP_ITERATIVE);
  }

  std::vector<cv::Point2f> project(const std::vector<cv::Point3f>& points, const CameraModel& camera) const {
    std::vector<cv::Point2f> pixels;
    cv::projectPoints(points, rotation, translation, cameraMatrix(camera), cv::noArray(), pixels);
    return pixels;
  }

  Pose toPose() const {
    cv::Matx33d matrix;
    cv::Rodrigues(rotation, matrix);
    Pose pose = Pose::Identity();
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) pose.linear()(r, c) = matrix(r, c);
      pose.translation()[r] = translation[r];
    }
    return pose;
  }
};

std::vector<const FiducialBoard::Marker*> detectMarkers(const FiducialBoard& board, const cv::Mat& gray,
                                                        PointPairs& pairs) {
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  parameters->cornerRefinementWinSize = kMarkerWindow;
  parameters->adaptiveThreshWinSizeMax = 33;
  cv::aruco::detectMarkers(gray, cv::aruco::getPredefinedDictionary(board.dictionary()), corners, ids, parameters);
  std::vector<const FiducialBoard::Marker*> seen;
  for (size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] < 0 || ids[i] >= static_cast<int>(board.markers().size())) continue;
    seen.push_back(&board.markers()[static_cast<size_t>(ids[i])]);
    for (size_t k = 0; k < 4; ++k) pairs.add(seen.back()->corners[k], corners[i][k]);
  }
  return seen;
}

// The corners between squares beside seen markers, found near where the markers' pose puts them.
PointPairs findSaddles(const FiducialBoard& board, const std::vector<const FiducialBoard::Marker*>& seen,
                       const cv::Mat& gray, const CameraModel& camera, const CameraPose& pose) {
  PointPairs pairs;
  for (const Eigen::Vector2d& saddle : board.saddles()) {
    const bool near = std::any_of(seen.begin(), seen.end(), [&](const FiducialBoard::Marker* marker) {
      return (0.5 * (marker->corners[0] + marker->corners[2]) - saddle).norm() < kNearMarker * board.markerSide();
    });
    if (near) pairs.add(saddle, {});
  }
  if (pairs.board.empty()) return pairs;
  pairs.image = pose.project(pairs.board, camera);
  const std::vector<cv::Point2f> predicted = pairs.image;
  const double square = camera.fx * board.markerSide() / cv::norm(pose.translation);  // about a marker's side in pixels
  const int window = std::clamp(static_cast<int>(0.15 * square), 2, 8);
  cv::cornerSubPix(gray, pairs.image, cv::Size(window, window), cv::Size(-1, -1), kSubPixel);
  PointPairs kept;
  for (size_t i = 0; i < pairs.image.size(); ++i)
    if (cv::norm(pairs.image[i] - predicted[i]) < window)
      kept.add({pairs.board[i].x, pairs.board[i].y}, pairs.image[i]);
  return kept;
}

double meanAround(const cv::Mat& gray, const cv::Point2f& at) {
  const cv::Rect around = cv::Rect(cvRound(at.x) - 1, cvRound(at.y) - 1, 3, 3) & cv::Rect({}, gray.size());
  return around.empty() ? 0.0 : cv::mean(gray(around))[0];
}

// Whether corner 0 is the upper left of the print: the square right below it is then dark, its neighbour light.
bool startsUpperLeft(const cv::Mat& gray, const std::vector<cv::Point2f>& corners, int columns) {
  const auto centre = [&](int column) {
    const auto at = [&](int c, int r) { return corners[static_cast<size_t>(r * columns + c)]; };
    return 0.25f * (at(column, 0) + at(column + 1, 0) + at(column, 1) + at(column + 1, 1));
  };
  return meanAround(gray, centre(0)) < meanAround(gray, centre(1));
}

void detectCheckerboard(const FiducialBoard::Checkerboard& board, const cv::Mat& gray, PointPairs& pairs) {
  std::vector<cv::Point2f> corners;
  if (!cv::findChessboardCornersSB(gray, cv::Size(board.columns, board.rows), corners,
                                   cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_ACCURACY))
    return;
  if (!startsUpperLeft(gray, corners, board.columns)) std::reverse(corners.begin(), corners.end());
  for (int row = 0; row < board.rows; ++row)
    for (int column = 0; column < board.columns; ++column)
      pairs.add(board.corner(column, row), corners[static_cast<size_t>(row * board.columns + column)]);
}

std::optional<BoardObservation> observe(const PointPairs& pairs, const CameraPose& pose, const CameraModel& camera) {
  BoardObservation observation;
  observation.camera_from_board = pose.toPose();
  const std::vector<cv::Point2f> projected = pose.project(pairs.board, camera);
  double sum = 0.0;
  for (size_t i = 0; i < projected.size(); ++i) {
    sum += std::pow(cv::norm(projected[i] - pairs.image[i]), 2);
    observation.points.emplace_back(pairs.board[i].x, pairs.board[i].y, 0.0);
    observation.pixels.emplace_back(pairs.image[i].x, pairs.image[i].y);
  }
  observation.rms = std::sqrt(sum / static_cast<double>(projected.size()));
  const Eigen::Vector3d up = observation.camera_from_board.linear().col(2);
  const bool seen_from_above = up.dot(observation.camera_from_board.translation()) < 0.0;
  if (!seen_from_above || observation.rms > kMaxRms) return std::nullopt;
  return observation;
}

}  // namespace

std::optional<BoardObservation> detectBoard(const FiducialBoard& board, const cv::Mat& gray,
                                            const CameraModel& camera) {
  PointPairs pairs;
  CameraPose pose;
  if (board.markers().empty()) {
    for (const auto& checkerboard : board.checkerboards()) detectCheckerboard(checkerboard, gray, pairs);
    if (!pose.solve(pairs, camera, true)) return std::nullopt;
  } else {
    const auto seen = detectMarkers(board, gray, pairs);
    if (static_cast<int>(seen.size()) < kMinMarkers || !pose.solve(pairs, camera, true)) return std::nullopt;
    const PointPairs saddles = findSaddles(board, seen, gray, camera, pose);
    if (saddles.board.size() >= 6 && pose.solve(saddles, camera, false)) pairs = saddles;
  }
  return observe(pairs, pose, camera);
}

}  // namespace recognition
