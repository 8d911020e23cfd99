#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace recognition {

/// A corner of a face: indices into the lists of RawMesh; -1 for what it does not have. Not checked yet.
struct RawCorner {
  std::int64_t position = -1;
  std::int64_t coordinate = -1;
  std::int64_t normal = -1;
};

struct RawFace {
  size_t first = 0;  ///< of its corners
  std::uint32_t count = 0;
  int material = -1;
};

/// What a face may be covered with. `texture` is a name as the file has it.
struct RawMaterial {
  std::string name;
  std::string texture;
  std::optional<cv::Vec3b> color;  ///< RGB
  cv::Mat image;                   ///< CV_8UC3 BGR, of a texture that the file itself holds

  bool hasTexture() const { return !texture.empty() || !image.empty(); }
};

/// A mesh as a file has it: faces of any number of corners, each corner with indices of its own; file's unit.
struct RawMesh {
  std::vector<Eigen::Vector3d> positions;
  std::vector<cv::Vec3b> position_colors;  ///< RGB by position, or empty
  std::vector<Eigen::Vector3f> normals;
  std::vector<Eigen::Vector2f> coordinates;  ///< (0, 0) is the texture's lower left
  std::vector<RawCorner> corners;
  std::vector<RawFace> faces;
  std::vector<cv::Vec3b> face_colors;  ///< RGB by face, or empty
  std::vector<RawMaterial> materials;
};

/// More corners than any real face has; their triangulation takes time with the square of the number.
constexpr std::uint64_t kMaxCorners = 5000;

/// RGB in 8 bits from numbers whose range shows in the largest of all: 0..1, 0..255, or 0..65535.
class ColorScale {
 public:
  void see(double value) { largest_ = value > largest_ ? value : largest_; }
  cv::Vec3b apply(const cv::Vec3d& rgb) const {
    const double factor = largest_ <= 1.0 ? 255.0 : largest_ <= 255.0 ? 1.0 : 255.0 / 65535.0;
    cv::Vec3b result;
    for (int k = 0; k < 3; ++k) result[k] = cv::saturate_cast<uchar>(factor * rgb[k]);
    return result;
  }

 private:
  double largest_ = 0.0;
};

}  // namespace recognition
