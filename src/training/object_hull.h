#pragma once

#include <vector>

#include "training/object_view.h"
#include "rgbd_recognition/model/object_model.h"

namespace recognition {

/// What no view shows of an object that stands on z = 0, as points about `spacing` apart: the surface of the space that
/// the views leave to it, where `cloud` has no point. Views carve what they see through, so that what leans out above
/// the board is not filled down to it. Below `lowest`, where nothing was measured, the sides go straight down to a flat
/// base. Without colour: it is for Sigma, eq. (4), which is of the whole object.
std::vector<SurfacePoint> estimateUnseen(const std::vector<ObjectView>& views, const std::vector<SurfacePoint>& cloud,
                                         float lowest, float spacing);

/// Sigma, eq. (4), of points that are not equally dense everywhere: each stands for the surface about it.
Extents computeEvenExtents(const std::vector<SurfacePoint>& cloud, float spacing);

}  // namespace recognition
