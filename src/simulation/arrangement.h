#pragma once

#include "simulation/fixture.h"
#include "simulation/object_catalog.h"
#include "simulation/tabletop.h"

namespace recognition {

/// Things that are put on a table one after the other and come to rest.
class Arrangement {
 public:
  /// `radius` (m) about the table's middle within which things are put; the fixture may leave less.
  Arrangement(const Eigen::Vector2d& table, const Fixture& fixture, const TabletopParameters& parameters,
              double radius);

  void put(const CatalogObject& object, cv::RNG& rng);

  /// At rest and not inside one another. What fell off the table lies on the floor.
  bool settled();

  double top() const;  ///< of the highest body

  bool onTable(int body) const { return world_.bounds(body).min().z() > -0.01; }
  Pose pose(int body) const { return world_.pose(body); }

 private:
  struct Placement {
    Eigen::Matrix3d rotation;
    Eigen::Vector2d place;
  };

  Placement drawPlacement(const CatalogObject& object, cv::RNG& rng) const;
  Placement besideAnother(const CatalogObject& object, cv::RNG& rng) const;
  Eigen::Vector2d within(const CatalogObject& object, const Placement& placement) const;
  double topUnder(const CatalogObject& object, const Placement& placement) const;

  PhysicsWorld world_;
  Eigen::Vector2d table_;
  const Fixture& fixture_;
  const TabletopParameters& parameters_;
  double radius_;
  int count_ = 0;
};

}  // namespace recognition
