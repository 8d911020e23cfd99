#include "meshes/texture_atlas.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include <opencv2/imgproc.hpp>

namespace recognition {
namespace {

constexpr int kGutter = 16;                     // pixels around each page, of its own border
constexpr int kTile = 4;                        // pixels of a plain colour's side
constexpr double kMaxPixels = 8192.0 * 8192.0;  // of all pages; they are reduced beyond
constexpr float kTolerance = 1e-3f;             // of coordinates beyond the border by rounding alone
constexpr int kMaxTiles = 64;                   // of a page that repeats

cv::Mat colorTiles(const std::vector<cv::Vec3b>& rgb_colors, int in_a_row) {
  const int rows = (static_cast<int>(rgb_colors.size()) + in_a_row - 1) / in_a_row;
  cv::Mat image(rows * kTile, in_a_row * kTile, CV_8UC3, cv::Scalar::all(0));
  for (int i = 0; i < static_cast<int>(rgb_colors.size()); ++i) {
    const cv::Vec3b& rgb = rgb_colors[static_cast<size_t>(i)];
    image(cv::Rect(i % in_a_row * kTile, i / in_a_row * kTile, kTile, kTile)) = cv::Scalar(rgb[2], rgb[1], rgb[0]);
  }
  return image;
}

}  // namespace

TextureAtlas::TextureAtlas(const std::vector<Page>& pages, const std::vector<cv::Vec3b>& rgb_colors) {
  double pixels = 0.0;
  for (const Page& page : pages) {
    const Eigen::Vector2f origin = (page.min.array() + kTolerance).floor();
    const Eigen::Vector2f tiles = ((page.max.array() - kTolerance).ceil() - origin.array()).max(1.0f);
    if (!(tiles.x() * tiles.y() <= static_cast<float>(kMaxTiles)))
      throw std::runtime_error("repeats one of its textures too often for them to be joined; bake them into one");
    pixels += static_cast<double>(page.image.total()) * tiles.x() * tiles.y();
    cells_.push_back({page.image, {}, origin, tiles});
  }
  const double factor = std::min(1.0, std::sqrt(kMaxPixels / std::max(1.0, pixels)));
  for (Cell& cell : cells_) {
    if (factor < 1.0)
      cv::resize(cell.image, cell.image,
                 {std::max(1, cvFloor(cell.image.cols * factor)), std::max(1, cvFloor(cell.image.rows * factor))}, 0, 0,
                 cv::INTER_AREA);
    cell.image = cv::repeat(cell.image, static_cast<int>(cell.tiles.y()), static_cast<int>(cell.tiles.x()));
  }
  if (!rgb_colors.empty()) {
    colors_in_a_row_ = cvCeil(std::sqrt(static_cast<double>(rgb_colors.size())));
    cells_.push_back({colorTiles(rgb_colors, colors_in_a_row_), {}, {0.0f, 0.0f}, {1.0f, 1.0f}});
  }
  arrange();
}

// The highest first, in rows.
void TextureAtlas::arrange() {
  std::vector<size_t> order(cells_.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return cells_[a].image.rows > cells_[b].image.rows; });
  double area = 0.0;
  int width = 0;
  for (const Cell& cell : cells_) {
    area += (cell.image.cols + 2.0 * kGutter) * (cell.image.rows + 2.0 * kGutter);
    width = std::max(width, cell.image.cols + 2 * kGutter);
  }
  width = std::max(width, cvCeil(std::sqrt(area)));
  cv::Point next(0, 0);
  int row_height = 0;
  for (const size_t i : order) {
    const cv::Size size(cells_[i].image.cols + 2 * kGutter, cells_[i].image.rows + 2 * kGutter);
    if (next.x + size.width > width) next = {0, next.y + row_height}, row_height = 0;
    cells_[i].place = {next.x + kGutter, next.y + kGutter, cells_[i].image.cols, cells_[i].image.rows};
    next.x += size.width;
    row_height = std::max(row_height, size.height);
  }
  image_ = cv::Mat(next.y + row_height, width, CV_8UC3, cv::Scalar::all(0));
  for (const Cell& cell : cells_) {
    const cv::Rect whole(cell.place.x - kGutter, cell.place.y - kGutter, cell.place.width + 2 * kGutter,
                         cell.place.height + 2 * kGutter);
    cv::copyMakeBorder(cell.image, image_(whole), kGutter, kGutter, kGutter, kGutter, cv::BORDER_REPLICATE);
  }
  for (Cell& cell : cells_) cell.image.release();
}

Eigen::Vector2f TextureAtlas::onPage(size_t page, const Eigen::Vector2f& coordinate) const {
  const Cell& cell = cells_[page];
  const Eigen::Array2f at = (coordinate - cell.origin).array() / cell.tiles.array();
  return {(static_cast<float>(cell.place.x) + at.x() * static_cast<float>(cell.place.width)) /
              static_cast<float>(image_.cols),
          1.0f - (static_cast<float>(cell.place.y) + (1.0f - at.y()) * static_cast<float>(cell.place.height)) /
                     static_cast<float>(image_.rows)};
}

Eigen::Vector2f TextureAtlas::ofColor(size_t color) const {
  const int column = static_cast<int>(color) % colors_in_a_row_, row = static_cast<int>(color) / colors_in_a_row_;
  const cv::Rect& place = cells_.back().place;
  const float x = static_cast<float>(place.x + column * kTile + kTile / 2) + 0.5f;  // a pixel's centre: it alone counts
  const float y = static_cast<float>(place.y + row * kTile + kTile / 2) + 0.5f;
  return {x / static_cast<float>(image_.cols), 1.0f - y / static_cast<float>(image_.rows)};
}

}  // namespace recognition
