#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace rgbd_recognition {

/// How the scene's light and camera turn the model's CIELAB colours: c' = A c + b, the identity when default
/// constructed.
struct ColorTransform {
  cv::Matx33f a = cv::Matx33f::eye();
  cv::Vec3f b = {0.0f, 0.0f, 0.0f};

  cv::Vec3f operator()(const cv::Vec3f& lab) const { return a * lab + b; }
};

/// A colour of the model beside what the frame has there, CIELAB.
struct ColorPair {
  cv::Vec3f model;
  cv::Vec3f scene;
};

/// The transform that turns the model's colours into the scene's: least squares with robust weights, drawn towards the
/// identity (lightness freely, chroma reluctantly: light changes brightness and contrast much, hue little), so that few
/// or uniform colours cannot explain whatever is there. The identity for no pairs.
ColorTransform fitColorTransform(const std::vector<ColorPair>& pairs);

/// The same for lightness alone.
struct LightnessTransform {
  float gain = 1.0f, offset = 0.0f;
};

/// What fitColorTransform() makes of colours without chroma, by SIMD. `model` and `scene`: CIELAB L, of one size.
LightnessTransform fitLightness(const std::vector<float>& model, const std::vector<float>& scene);

}  // namespace rgbd_recognition
