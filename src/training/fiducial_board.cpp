#include "rgbd_recognition/training/fiducial_board.h"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace recognition {
namespace {

constexpr double kMaxBoard = 3.0;  // metres

int dictionaryFromName(const std::string& name) {
  const std::pair<const char*, int> known[] = {
      {"4x4_50", cv::aruco::DICT_4X4_50},   {"4x4_250", cv::aruco::DICT_4X4_250},
      {"5x5_100", cv::aruco::DICT_5X5_100}, {"5x5_250", cv::aruco::DICT_5X5_250},
      {"6x6_250", cv::aruco::DICT_6X6_250}, {"original", cv::aruco::DICT_ARUCO_ORIGINAL}};
  for (const auto& [known_name, value] : known)
    if (name == known_name) return value;
  throw std::invalid_argument("dictionary '" + name +
                              "' is none of 4x4_50, 4x4_250, 5x5_100, 5x5_250, 6x6_250, original");
}

double length(const YAML::Node& node, const char* key) {
  if (!node[key]) throw std::invalid_argument(std::string(key) + " is missing");
  const double value = node[key].as<double>();
  if (!(value > 0.0 && value < kMaxBoard))
    throw std::invalid_argument(std::string(key) + " is " + node[key].Scalar() + ": must be metres in (0, 3)");
  return value;
}

int count(const YAML::Node& node, const char* key) {
  if (!node[key]) throw std::invalid_argument(std::string(key) + " is missing");
  const int value = node[key].as<int>();
  if (value < 2 || value > 100)
    throw std::invalid_argument(std::string(key) + " is " + node[key].Scalar() + ": must be in [2, 100]");
  return value;
}

}  // namespace

// Marker ids count along the rows from the upper left; the upper left square of a ChArUco board is dark, markers stand
// in the light ones.
void FiducialBoard::addMarkerGrid(int columns, int rows, double marker, double pitch, bool charuco) {
  marker_side_ = marker;
  const Eigen::Vector2d half(0.5 * marker, 0.5 * marker);
  int id = 0;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector2d centre(pitch * (column - 0.5 * (columns - 1)), -pitch * (row - 0.5 * (rows - 1)));
      if (charuco && column > 0 && row > 0) saddles_.push_back(centre + Eigen::Vector2d(-0.5 * pitch, 0.5 * pitch));
      if (charuco && (column + row) % 2 == 0) {
        dark_squares_.emplace_back(centre.x() - 0.5 * pitch, centre.y() - 0.5 * pitch, pitch, pitch);
        continue;
      }
      markers_.push_back({id++,
                          {centre + Eigen::Vector2d(-half.x(), half.y()), centre + half,
                           centre + Eigen::Vector2d(half.x(), -half.y()), centre - half}});
    }
  }
}

void FiducialBoard::addCheckerboard(const Checkerboard& board) {
  if ((board.columns + board.rows) % 2 == 0)
    throw std::invalid_argument("a checkerboard of " + std::to_string(board.columns) + " x " +
                                std::to_string(board.rows) +
                                " inner corners looks the same upside down; one count must be odd, the other even");
  checkerboards_.push_back(board);
  for (int row = 0; row <= board.rows; ++row)
    for (int column = row % 2; column <= board.columns; column += 2) {
      const Eigen::Vector2d lower_left = board.corner(column - 1, row);
      dark_squares_.emplace_back(lower_left.x(), lower_left.y(), board.square, board.square);
    }
}

FiducialBoard FiducialBoard::fromYaml(const std::string& file) {
  FiducialBoard board;
  try {
    const YAML::Node node = YAML::LoadFile(file);
    if (!node["type"]) throw std::invalid_argument("type is missing");
    const std::string type = node["type"].as<std::string>();
    board.name_ = type;
    board.size_ = {length(node, "width"), length(node, "height")};
    if (type == "charuco" || type == "aruco") {
      const bool charuco = type == "charuco";
      const double marker = length(node, "marker");
      const double pitch = charuco ? length(node, "square") : marker + length(node, "gap");
      board.dictionary_ = dictionaryFromName(node["dictionary"].as<std::string>(""));
      if (marker >= pitch) throw std::invalid_argument("marker is not smaller than square");
      board.addMarkerGrid(count(node, "columns"), count(node, "rows"), marker, pitch, charuco);
      const int known = cv::aruco::getPredefinedDictionary(board.dictionary_)->bytesList.rows;
      if (static_cast<int>(board.markers_.size()) > known)
        throw std::invalid_argument("has more markers than its dictionary");
    } else if (type == "checkerboards") {
      for (const YAML::Node& one : node["checkerboards"])
        board.addCheckerboard({count(one, "columns"),
                               count(one, "rows"),
                               length(one, "square"),
                               {one["upper_left"][0].as<double>(), one["upper_left"][1].as<double>()}});
      if (board.checkerboards_.empty()) throw std::invalid_argument("checkerboards is empty");
    } else {
      throw std::invalid_argument("type '" + type + "' is none of charuco, aruco, checkerboards");
    }
  } catch (const std::exception& error) {
    throw std::invalid_argument(file + ": " + error.what());
  }
  return board;
}

std::vector<FiducialBoard::DarkArea> FiducialBoard::darkAreas() const {
  std::vector<DarkArea> areas;
  for (const cv::Rect2d& square : dark_squares_) areas.push_back({{square.x, square.y}, {square.width, square.height}});
  if (markers_.empty()) return areas;
  const auto dictionary = cv::aruco::getPredefinedDictionary(dictionary_);
  const int cells = dictionary->markerSize + 2;  // with the border, one cell wide
  for (const Marker& marker : markers_) {
    cv::Mat bits;
    cv::aruco::drawMarker(dictionary, marker.id, cells, bits);
    const Eigen::Vector2d right = (marker.corners[1] - marker.corners[0]) / cells,
                          down = (marker.corners[3] - marker.corners[0]) / cells;
    for (int row = 0; row < cells; ++row)
      for (int first = 0; first < cells; ++first) {
        int end = first;  // of a run of dark cells
        while (end < cells && bits.at<uchar>(row, end) == 0) ++end;
        if (end == first) continue;
        areas.push_back({marker.corners[0] + first * right + (row + 1) * down, (end - first) * right - down});
        first = end;
      }
  }
  return areas;
}

cv::Mat FiducialBoard::draw(double pixels_per_metre) const {
  const auto column = [&](double x) { return cvRound((x + 0.5 * size_.x()) * pixels_per_metre); };
  const auto row = [&](double y) { return cvRound((0.5 * size_.y() - y) * pixels_per_metre); };
  cv::Mat image(cvRound(size_.y() * pixels_per_metre), cvRound(size_.x() * pixels_per_metre), CV_8UC1, cv::Scalar(255));
  const cv::Rect whole({}, image.size());
  for (const cv::Rect2d& square : dark_squares_) {
    const cv::Point upper_left(column(square.x), row(square.y + square.height)),
        lower_right(column(square.x + square.width), row(square.y));
    image(cv::Rect(upper_left, lower_right) & whole).setTo(0);
  }
  for (const Marker& marker : markers_) {
    const cv::Point upper_left(column(marker.corners[0].x()), row(marker.corners[0].y()));
    const cv::Point lower_right(column(marker.corners[2].x()), row(marker.corners[2].y()));
    cv::Mat drawn, fitted;
    cv::aruco::drawMarker(cv::aruco::getPredefinedDictionary(dictionary_), marker.id,
                          std::max(32, lower_right.x - upper_left.x), drawn);
    const cv::Rect place = cv::Rect(upper_left, lower_right) & whole;
    cv::resize(drawn, fitted, place.size(), 0, 0, cv::INTER_AREA);
    fitted.copyTo(image(place));
  }
  return image;
}

}  // namespace recognition
