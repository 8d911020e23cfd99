#pragma once

#include <functional>
#include <vector>

#include "training/object_view.h"
#include "rgbd_recognition/model/object_model.h"

namespace recognition {

/// A point of the fused cloud.
struct FusedPoint {
  SurfacePoint surface;  ///< world frame
  int views = 0;         ///< that measured it
  int inner_views = 0;   ///< of those, the ones that measured it well inside the object's outline
};

/// Averages the measured surfaces of all views (surfels[i] of views[i], weighted) in cells of `spacing`, both sides of
/// thin walls apart; colour counts where the surface is seen straight on.
std::vector<FusedPoint> fuseSurfaces(const std::vector<ObjectView>& views,
                                     const std::vector<std::vector<Surfel>>& surfels, float spacing);

/// Without how many views measured them.
std::vector<SurfacePoint> surfacesOf(const std::vector<FusedPoint>& fused);

/// The points that at least `min_views` views measured (where so many look at them), that no more views see through
/// than measured them, that have neighbours and, up to `highest_board` metres above the board, are not its; thinned to
/// about `spacing`. `carved`: the share of what several views measured well inside the object's outline, away from
/// depth's edges, that more views see through.
std::vector<SurfacePoint> cleanCloud(const std::vector<ObjectView>& views, const std::vector<FusedPoint>& fused,
                                     int min_views, float spacing, float highest_board, double& carved);

/// Refines the views' poses: point-to-plane steps of each view to the cloud that all make, held to its first pose by
/// `pose_sigma` (metres; as an angle at 0.2 m). All views meet in one cloud, so the loop closes. Returns the median
/// distance of the views' points from the cloud, metres. `progress(done)`, 0 to 1, is called before each round.
double alignViews(std::vector<ObjectView>& views, const std::vector<std::vector<Surfel>>& surfels, int rounds,
                  float distance, double pose_sigma, float spacing, const std::function<void(double)>& progress);

}  // namespace recognition
