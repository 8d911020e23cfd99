#pragma once

#include <functional>
#include <string>
#include <vector>

#include "rgbd_recognition/core/parameters.h"
#include "simulation/bop_writer.h"
#include "simulation/tabletop.h"
#include "simulation/world.h"

namespace recognition {

/// How the camera of a sequence moves.
enum class CameraPath {
  kStill,     ///< on a tripod
  kHandHeld,  ///< swaying and shaking
  kArm,       ///< about the things on an arc, with stops
  kPanTilt    ///< turning on a head, with stops
};

/// A film of a table: what moves in it, and how fast.
struct SequenceParameters {
  CameraPath path = CameraPath::kHandHeld;
  double seconds = 10.0;
  double rate = 30.0;       ///< frames a second
  int moved = 1;            ///< objects that are lifted, carried, turned and put down, one after the other
  int passing = 1;          ///< boxes that pass between the camera and the things
  double max_speed = 0.3;   ///< m/s, of what is carried
  double max_turn = 60.0;   ///< deg/s, likewise
  double exposure = 0.012;  ///< s: motion blur; 0: none
  double readout = 0.015;   ///< s from the first row to the last: rolling shutter; 0: none

  int frames() const;
  ParameterList list();
  void validate() const;
};

/// What is where at a moment of a sequence.
class SceneInMotion {
 public:
  /// `objects`: bodies of the scene that may be moved. Same arguments, same motion.
  SceneInMotion(TabletopScene scene, const SequenceParameters& parameters, std::uint64_t seed);
  ~SceneInMotion();

  /// The scene at `seconds` from the beginning, with the camera.
  Scene at(double seconds) const;
  const std::vector<int>& objects() const { return start_.objects; }

 private:
  struct Carried;
  struct Passing;

  TabletopScene start_;
  SequenceParameters parameters_;
  Eigen::Vector3d middle_;
  std::vector<double> phases_;
  std::vector<Carried> carried_;
  std::vector<Passing> passing_;
};

/// Where each pixel's surface goes: pixels a second, CV_32FC2, of `camera`'s image; 0 where nothing is seen.
cv::Mat imageMotion(const SceneInMotion& motion, double seconds, const CameraModel& camera);

/// An image as a moving scene exposes it: averaged along the motion for `exposure` seconds, its rows read one after the
/// other within `readout` seconds about its stamp. CV_32FC3.
cv::Mat exposedInMotion(const cv::Mat& radiance, const cv::Mat& motion, double exposure, double readout);

/// Films of `ids` (catalog's obj_id; repeats allowed) with up to `clutter` other things as scenes of a BOP split, a
/// scene a film, another room, arrangement and motion each.
struct SequenceSet {
  std::vector<int> ids;
  int clutter = 3;
  int films = 1;
  World world = World::of(WorldPreset::kChallenge);
  KinectParameters kinect;
  std::uint64_t seed = 1;
  std::function<void(int done, int total)> progress = [](int, int) {};
};

void writeSequences(const SequenceSet& set, const SequenceParameters& parameters,
                    const std::vector<CatalogObject>& catalog, const std::string& directory);

}  // namespace recognition
