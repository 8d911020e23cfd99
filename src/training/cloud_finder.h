#pragma once

#include <vector>

#include "core/point_grid.h"
#include "rgbd_recognition/model/object_model.h"

namespace recognition {

/// A cloud, to find points of another near it.
class CloudFinder {
 public:
  /// Both the cloud and this must outlive what nearest() returns. `reach`: metres.
  CloudFinder(const std::vector<SurfacePoint>& cloud, float reach);

  /// The cloud's point nearest to p, within reach, whose normal agrees, or null.
  const SurfacePoint* nearest(const Eigen::Vector3f& p, const Eigen::Vector3f& normal) const;

 private:
  const std::vector<SurfacePoint>& cloud_;
  float reach_;
  PointGrid grid_;
};

}  // namespace recognition
