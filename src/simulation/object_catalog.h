#pragma once

#include <memory>
#include <string>
#include <vector>

#include "simulation/physics.h"
#include "simulation/scene.h"

namespace recognition {

/// Something that can be put on a table.
struct CatalogObject {
  int id = 0;  ///< BOP obj_id; 0 for clutter
  std::string name;
  std::shared_ptr<const BodyAppearance> appearance;
  RigidShape shape;
};

/// All objects of a BOP `models` folder; each keeps the same finish (gloss, infrared reflectance) in all sets. Throws
/// std::runtime_error with file and reason: none there, unreadable, no faces, texture missing, size implausible.
std::vector<CatalogObject> loadCatalog(const std::string& models_directory);

/// One mesh file; `unit` is the length of its unit in metres. Errors as above.
CatalogObject loadObject(const std::string& file, double unit, int id, const std::string& name);

/// What clutter looks like: shares of invented prints and of blank white; the rest is plain colour or material.
struct ClutterStyle {
  double printed = 0.6;
  double blank = 0.0;
};

/// A box, cylinder or ball: nothing that a model set holds.
CatalogObject makeClutter(const ClutterStyle& style, cv::RNG& rng);

/// How far things have moved from their scans.
struct Aging {
  double fade_max = 0.0;    ///< share of bleached paper, drawn from 0
  double chroma_min = 1.0;  ///< factor on chroma, drawn to 1
  double tint = 0.0;        ///< standard deviation of the logarithm of each channel's factor
};

/// The object with a finish that has aged by a draw.
CatalogObject age(const CatalogObject& object, const Aging& aging, cv::RNG& rng);

}  // namespace recognition
