#pragma once

#include <vector>

#include "training/object_view.h"
#include "features/feature_extractor.h"
#include "rgbd_recognition/training/recorded_object.h"
#include "rgbd_recognition/features/feature_parameters.h"

namespace recognition {

/// The features of `type` in all views, lifted, put onto the fused cloud (world frame) and merged.
ModelFeatures recordedFeatures(const std::vector<ObjectView>& views, const std::vector<SurfacePoint>& cloud,
                               FeatureParameters features, DescriptorType type, const RecordingParameters& parameters);

}  // namespace recognition
