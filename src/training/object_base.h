#pragma once

#include <vector>

#include "rgbd_recognition/model/object_model.h"

namespace rgbd_recognition {

/// What no view shows of an object that stands on z = 0, as points about `spacing` apart: its base, taken as the convex
/// hull of its lowest measured points, and its side from there up to `lowest`. Without colour: it is for Sigma, eq.
/// (4), which is of the whole object.
std::vector<SurfacePoint> estimateBase(const std::vector<SurfacePoint>& cloud, float lowest, float spacing);

}  // namespace rgbd_recognition
