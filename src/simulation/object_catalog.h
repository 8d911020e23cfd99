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
  std::shared_ptr<const Appearance> appearance;
  RigidShape shape;
};

/// All objects of a BOP `models` folder; each keeps the same finish (gloss, infrared reflectance) in all sets. Throws
/// std::runtime_error with file and reason: none there, unreadable, no faces, texture missing, size implausible.
std::vector<CatalogObject> loadCatalog(const std::string& models_directory);

/// One mesh file; `unit` is the length of its unit in metres. Errors as above.
CatalogObject loadObject(const std::string& file, double unit, int id, const std::string& name);

/// A box, cylinder or ball with an invented print, plain colour or material: nothing that a model set holds.
CatalogObject makeClutter(cv::RNG& rng);

}  // namespace recognition
