#pragma once

#include "simulation/bop_writer.h"
#include "simulation/kinect.h"

namespace recognition {

/// A frame of the scene with the truth about some of its bodies. Seeds as in SimulatedKinect::capture().
AnnotatedFrame captureAnnotated(const Scene& scene, const std::vector<int>& bodies, const SimulatedKinect& kinect,
                                std::uint64_t seed, std::uint64_t camera_seed, const Exposure& exposure = nullptr);

}  // namespace recognition
