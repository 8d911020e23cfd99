#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace recognition {

/// Several textures and plain colours in one picture.
class TextureAtlas {
 public:
  /// A texture with the range of the coordinates that are used of it: beyond 0..1 it repeats.
  struct Page {
    cv::Mat image;  ///< CV_8UC3 BGR
    Eigen::Vector2f min = Eigen::Vector2f::Zero();
    Eigen::Vector2f max = Eigen::Vector2f::Ones();
  };

  /// Throws std::runtime_error for a page that repeats too often to be packed.
  TextureAtlas(const std::vector<Page>& pages, const std::vector<cv::Vec3b>& rgb_colors);

  const cv::Mat& image() const { return image_; }

  /// Coordinates in the atlas of a page's coordinates, and of a plain colour, which lies in one point.
  Eigen::Vector2f onPage(size_t page, const Eigen::Vector2f& coordinate) const;
  Eigen::Vector2f ofColor(size_t color) const;

 private:
  /// Where a picture lies, and which coordinates it covers.
  struct Cell {
    cv::Mat image;
    cv::Rect place;
    Eigen::Vector2f origin, tiles;
  };

  void arrange();

  std::vector<Cell> cells_;  // the pages, then one with all colours
  int colors_in_a_row_ = 0;
  cv::Mat image_;
};

}  // namespace recognition
