#include "training/cloud_finder.h"

namespace recognition {
namespace {

constexpr float kSameSide = 0.7f;  // least cosine between normals that agree

}  // namespace

CloudFinder::CloudFinder(const std::vector<SurfacePoint>& cloud, float reach)
    : cloud_(cloud), reach_(reach), grid_(reach) {
  for (size_t i = 0; i < cloud.size(); ++i) grid_.insert(cloud[i].position, static_cast<int>(i));
}

const SurfacePoint* CloudFinder::nearest(const Eigen::Vector3f& p, const Eigen::Vector3f& normal) const {
  const SurfacePoint* best = nullptr;
  float best_distance = reach_ * reach_;
  grid_.forNeighbours(p, [&](int i) {
    const SurfacePoint& point = cloud_[static_cast<size_t>(i)];
    const float d = (point.position - p).squaredNorm();
    if (d >= best_distance || point.normal.dot(normal) < kSameSide) return;
    best_distance = d;
    best = &point;
  });
  return best;
}

}  // namespace recognition
