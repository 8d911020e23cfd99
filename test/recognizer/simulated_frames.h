#pragma once

#include <cstdint>
#include <vector>

#include "simulation/bop_writer.h"
#include "simulation/object_catalog.h"
#include "simulation/world.h"

namespace recognition {

/// The demo's objects as meshes.
std::vector<CatalogObject> demoCatalog();

/// All objects of the catalog on a table of a world drawn from the preset, colour as large as depth. Depth is where it
/// should be, whatever the preset: poses are measured against the truth.
AnnotatedFrame simulatedFrame(const std::vector<CatalogObject>& catalog, WorldPreset preset, std::uint64_t seed);

/// What holds no trained object but may be taken for one.
struct DecoyScene {
  bool shelf = false;  ///< a shelf bin stands on the table
  bool blank = false;  ///< table, walls and shelf are white
};

/// A white board, two leaflets, and a box in print for each object of the catalog: as large as the object, annotated as
/// such though it is none.
AnnotatedFrame decoyFrame(const std::vector<CatalogObject>& catalog, const DecoyScene& decoys, std::uint64_t seed);

/// Middle and size of a mesh's bounding box, object frame, metres.
struct MeshBox {
  Eigen::Vector3d middle, size;
};
MeshBox boxOf(const CatalogObject& object);

}  // namespace recognition
