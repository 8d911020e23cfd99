#pragma once

#include <vector>

#include "simulation/scene.h"

#include <opencv2/core.hpp>

namespace recognition {

/// What encloses the things on the table.
enum class Enclosure { kNone, kTote, kShelf };

/// Walls about the table's middle, and from where one looks in. World frame, metres.
struct Fixture {
  struct Wall {
    Eigen::Vector3d size;
    Eigen::Vector3d middle;
  };

  std::vector<Wall> walls;  ///< those of a shelf are higher than it will be: its roof comes last
  Eigen::Vector2d half = Eigen::Vector2d::Constant(10.0);  ///< half of the sides within which things are put
  double roof_gap = 0.0;                                   ///< between the highest thing and the roof, 0: no roof
  double board = 0.0;                                      ///< thickness of the roof
  cv::Mat texture;
  Finish finish;
  double min_azimuth = 0.0;  ///< rad, of the camera about the table's middle
  double max_azimuth = 2 * CV_PI;
  double min_tilt = 0.0;  ///< deg that the camera looks down; 0 and 0: as the scenes' parameters say
  double max_tilt = 0.0;
};

/// A tote seen from above or a shelf seen from the front, of random size and colour, white where `blank`.
Fixture makeFixture(Enclosure kind, bool blank, cv::RNG& rng);

/// The walls and the roof as they are seen, over things that reach up to `top`.
std::vector<SceneBody> fixtureBodies(const Fixture& fixture, double top);

}  // namespace recognition
