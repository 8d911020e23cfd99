#pragma once

#include <string>

#include "simulation/kinect.h"
#include "simulation/tabletop.h"

namespace recognition {

/// How far the simulated frames reach.
enum class WorldPreset {
  kChallenge,  ///< plausible for the challenge of 2011: near, mostly seen, true colours, sharp
  kHard,       ///< far, hidden, noisy and colourful; one sensor, as its file says
  kWide        ///< the failures of real frames: shelves, totes, blank surfaces, other sensors, aged things
};

/// Ranges from which each frame draws what it is like.
struct WorldParameters {
  double shelf_share = 0.0;    ///< of frames that look into a shelf
  double tote_share = 0.0;     ///< of frames that look into a tote
  double blank_share = 0.0;    ///< of frames with white table, walls, tote or shelf
  double many_share = 0.0;     ///< of totes that hold many instances of one object
  int max_many = 12;           ///< instances of it
  double contact_share = 0.0;  ///< of frames whose things stand side by side, touching
  double fade_max = 0.0;       ///< bleached share of an object's texture
  double chroma_min = 1.0;     ///< factor on an object's chroma
  double tint = 0.0;           ///< log of the factor on each channel of an object's texture, standard deviation
  bool sensor_varies = false;  ///< false: the ranges below are not drawn, the sensor is as its file says
  double blur_min = 0.5;       ///< px at 1280 columns
  double blur_max = 0.5;
  double sharpening_min = 0.6;
  double sharpening_max = 0.6;
  double saturation_min = 1.2;
  double saturation_max = 1.9;
  double mean_level_min = 0.13;
  double mean_level_max = 0.55;
  double misregistration = 0.0;    ///< px of depth beside colour, at most
  double depth_scale = 0.0;        ///< relative error of depth, at most
  double short_range_share = 0.0;  ///< of frames by a short-range sensor like an SR300

  ParameterList list();
  void validate() const;
};

/// A preset's ranges and what its tables look like.
struct World {
  WorldParameters parameters;
  TabletopParameters tabletop;
  double empty_share = 0.1;  ///< of frames without any object of the models
  int max_clutter = 5;

  static World of(WorldPreset preset);
  std::string text() const;
};

/// What one frame drew.
struct FrameWorld {
  KinectParameters kinect;
  TabletopParameters tabletop;
  Aging aging;
  int many = 0;  ///< instances of the frame's first object, 0: as planned
};

/// Same arguments, same draw. `base` is the sensor whose values the preset does not draw.
FrameWorld drawFrameWorld(const World& world, const KinectParameters& base, std::uint64_t seed);

}  // namespace recognition
