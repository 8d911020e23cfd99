#pragma once

#include "rgbd_recognition/simulation/bop_writer.h"
#include "rgbd_recognition/simulation/kinect.h"

namespace rgbd_recognition {

/// A frame of the scene with the truth about some of its bodies. Seeds as in SimulatedKinect::capture().
AnnotatedFrame captureAnnotated(const Scene& scene, const std::vector<int>& bodies, const SimulatedKinect& kinect,
                                std::uint64_t seed, std::uint64_t camera_seed);

}  // namespace rgbd_recognition
