#pragma once

#include <functional>

#include "simulation/kinect.h"
#include "simulation/object_catalog.h"
#include "rgbd_recognition/training/fiducial_board.h"

namespace recognition {

/// A recording of one object that turns with its board before a fixed camera, once for each tilt. One camera: what its
/// automatic exposure aims at is drawn once.
struct TurntableParameters {
  int views = 72;          ///< of all tilts together
  int tilts = 3;           ///< camera heights
  double min_tilt = 25.0;  ///< deg that the camera looks down
  double max_tilt = 60.0;
  double distance = 0.0;     ///< m, camera to the object's middle; 0: as near as the object's size allows, at least 0.6
  bool upside_down = false;  ///< the object stands on its head

  ParameterList list();
  void validate() const;
};

/// Pose of the object on the board: upright as modelled, or turned about x by half a turn, its middle over the board's.
Pose boardFromObject(const CatalogObject& object, bool upside_down = false);

/// Writes the recording as a BOP data set (split train_kinect, the object's pose in each frame) with the object's pose
/// on the board in DIR/board_from_object.yaml. Views go around once per tilt. Throws std::invalid_argument if the
/// object is larger than the board. `progress(done, total)` may be called from any thread.
void writeTurntable(const CatalogObject& object, const FiducialBoard& board, const KinectParameters& kinect,
                    const TurntableParameters& parameters, std::uint64_t seed, const std::string& directory,
                    const std::function<void(int, int)>& progress);

/// The scene of one view; the object is the last body, the board the one before.
Scene turntableView(const CatalogObject& object, const FiducialBoard& board, const TurntableParameters& parameters,
                    int view, std::uint64_t seed);

}  // namespace recognition
