#pragma once

#include <array>
#include <vector>

#include "rgbd_recognition/core/camera.h"
#include "rgbd_recognition/core/pose.h"
#include "alignment/illumination.h"
#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"
#include "alignment/weighted_rows.h"

/// A refinement's rows over points of a model, by SIMD: one coordinate after the other. Metres, pixels of the depth
/// image, CIELAB L.
namespace recognition {

using Column = std::vector<float>;

/// Points of a model, and where a pose puts them in the camera's frame and in the image.
struct AlignedPoints {
  std::array<Column, 3> model_position, model_normal;
  Column lightness;
  std::array<Column, 3> position, normal;
  Column column, row;  ///< not rounded
  Column seen_depth;   ///< of the frame there, 0 in holes and outside

  int count() const { return static_cast<int>(lightness.size()); }
  void assign(const PreparedModel& model, const std::vector<int>& points);
  void move(const Pose& camera_from_object, const SceneView& scene);
};

/// Points whose lightness can be compared with the frame's.
struct AlignedTexture {
  std::array<Column, 3> position;
  Column lightness;                  ///< of the model
  Column seen, by_column, by_row;    ///< of the frame, and its change a pixel
  Column spread_column, spread_row;  ///< from the anchor's pixel, unmagnified

  int count() const { return static_cast<int>(lightness.size()); }
  /// Of the points those whose pixel is not clipped, and whose depth is nearer than `gate` to the frame's: holes may
  /// show texture, other surfaces do not. `magnification`: how much larger the image is than the pose has it.
  void collect(const AlignedPoints& points, const SceneView& scene, const Eigen::Vector3d& anchor, double magnification,
               double gate);
};

constexpr int kAlignmentParameters = 7;  ///< translation and rotation about the anchor (camera's axes), magnification
using AlignmentSums = RowSums<kAlignmentParameters>;

/// Weighted rows of least squares.
class AlignmentRows {
 public:
  /// Point to plane, with the sensor's noise beside `floor`, weights of Geman and McClure for distances of `gate` or
  /// three deviations.
  void makeOfDepth(const AlignedPoints& points, const Eigen::Vector3d& anchor, double gate, double floor);

  /// How the frame's lightness is compared with the model's.
  struct TextureWeights {
    double sigma;  ///< deviation of L
    double gate;   ///< in deviations
  };
  void makeOfTexture(const AlignedTexture& texture, const CameraModel& camera, const Eigen::Vector3d& anchor,
                     const LightnessTransform& illumination, const TextureWeights& weights);

  AlignmentSums sum() const;
  double weights() const;  ///< sum of the robust weights
  double squares() const;  ///< weighted sum of the squared residuals over their deviations

 private:
  void resize(int count);

  std::array<Column, kAlignmentParameters> row_;
  Column residual_;
  Column robust_;  // weights
  Column weight_;  // over the residual's variance; 0 beyond the last, to a multiple of kRowLanes
};

}  // namespace recognition
