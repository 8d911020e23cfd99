#pragma once

#include "simulation/scene.h"

namespace recognition {

constexpr double kFloorHeight = -0.72;  ///< metres: the table top is at 0

/// A table in a room. The table top is the rectangle about the origin at z = 0.
struct Room {
  std::vector<SceneBody> bodies;  ///< table, floor, walls, furniture
  std::vector<Lamp> lamps;
  Eigen::Vector3f ambient_above;
  Eigen::Vector3f ambient_below;
  Eigen::Vector2d table_size;  ///< metres along x and y
};

/// Table, floor, walls, furniture and lamps of random materials, sizes, colours and strengths; table and walls white
/// where `blank`.
Room makeRoom(cv::RNG& rng, bool blank = false);

}  // namespace recognition
