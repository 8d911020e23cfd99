#pragma once

#include <stdexcept>

#include "rgbd_recognition/core/parameters.h"
#include "simulation/fixture.h"
#include "simulation/kinect.h"
#include "simulation/object_catalog.h"
#include "simulation/visibility.h"

namespace recognition {

/// What scenes may look like.
struct TabletopParameters {
  double min_distance = 0.5;  ///< m, of an object's centre from the camera
  double max_distance = 2.0;
  double min_tilt = 15.0;  ///< deg that the camera looks down
  double max_tilt = 70.0;
  double max_roll = 8.0;        ///< deg about the optical axis
  double min_visibility = 0.3;  ///< of each object's silhouette
  double occlusion = 0.6;       ///< share of scenes in which an object must be hidden by more than a quarter
  double stacking = 0.2;        ///< share of bodies put onto others
  double leaning = 0.15;        ///< share of bodies tipped against others
  double contact = 0.0;         ///< share of bodies put side by side with others, touching
  double seen_share = 1.0;      ///< share of the objects that must show min_visibility; the rest may be buried
  double spread = 0.07;         ///< m, radius of the heap for one body; grows with the root of their number
  Enclosure enclosure = Enclosure::kNone;
  bool blank = false;     ///< table, walls, tote and shelf are white
  ClutterStyle clutter;   ///< what else lies there
  int max_attempts = 60;  ///< arrangements tried before the clutter is left out, and then before giving up

  ParameterList list();
  void validate() const;
};

/// A settled scene seen by a camera. Bodies: those of the room, the objects, the clutter.
struct TabletopScene {
  Scene scene;
  std::vector<int> objects;  ///< bodies of the catalog's objects, in the order asked for
};

/// The objects do not fit together: others, or another seed, may.
struct UnarrangeableScene : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Lets the objects and some clutter come to rest on a random table in a random room, and finds a view in which all are
/// visible enough. Rearranges until one is found; throws UnarrangeableScene after twice max_attempts. Same arguments,
/// same scene.
TabletopScene composeTabletop(const std::vector<const CatalogObject*>& objects, int clutter,
                              const CameraModel& depth_camera, const TabletopParameters& parameters,
                              std::uint64_t seed);

}  // namespace recognition
