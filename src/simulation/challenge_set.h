#pragma once

#include <functional>
#include <string>

#include "core/shard.h"
#include "simulation/bop_writer.h"
#include "simulation/world.h"

namespace recognition {

/// Sizes of a test set like the challenge's.
struct ChallengeSetParameters {
  int frames = 176;
  int instances = 434;
  double empty_share = 0.1;       ///< of frames that hold clutter only
  double duplicate_share = 0.15;  ///< of frames with several instances of one object
  int max_instances = 7;          ///< in one frame

  static ChallengeSetParameters wg() { return {}; }
  static ChallengeSetParameters nist() { return {399, 831}; }

  /// The same set with another number of frames, instances in proportion.
  ChallengeSetParameters withFrames(int count) const;
  void validate() const;
};

/// Catalog indices of the objects in each frame.
using TabletopPlan = std::vector<std::vector<int>>;

/// How a set is made.
struct SetMaking {
  World world;
  KinectParameters kinect;
  std::uint64_t seed = 1;
  bool keep_objects = false;  ///< a scene that cannot be arranged draws other places, but no other objects
  Shard shard;                ///< of several processes that write into one folder
  std::function<void(int done, int total)> progress = [](int, int) {};      ///< after each frame, from any thread
  std::function<void(const std::string&)> log = [](const std::string&) {};  ///< what did not go as planned
};

/// The set's number of instances exactly, all objects about equally often, near-identical ones (same extents within 5
/// %) together in some frames. Same arguments, same plan.
TabletopPlan planChallengeSet(const ChallengeSetParameters& set, const std::vector<CatalogObject>& catalog,
                              std::uint64_t seed);

/// One scene with up to `max_clutter` other things for each frame of the plan, by composeTabletop(). A scene that
/// cannot be arranged is drawn anew with other objects, then with fewer, in the end none, and the log says so. Frames
/// that an earlier run left are kept.
void writeTabletops(const TabletopPlan& plan, const std::vector<CatalogObject>& catalog, const SetMaking& making,
                    const BopWriter& writer);

/// Writes the set as a BOP data set: `models` and the split test_kinect.
void writeChallengeSet(const ChallengeSetParameters& set, const std::string& models_directory, const SetMaking& making,
                       const std::string& directory);

}  // namespace recognition
