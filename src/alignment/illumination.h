#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace recognition {

/// How the scene's illumination and camera turn the model's CIELAB colours: c' = A c + b, and what faces the lamp is brighter:
/// L' grows by (L + 16) s.n on a surface of normal n. The identity when default constructed.
struct ColorTransform {
  static constexpr float kBlack = 16.0f;  ///< L + 16 goes with the cube root of the illumination

  cv::Matx33f a = cv::Matx33f::eye();
  cv::Vec3f b = {0.0f, 0.0f, 0.0f};
  Eigen::Vector3f shading = Eigen::Vector3f::Zero();  ///< s, in the frame of the normals

  cv::Vec3f operator()(const cv::Vec3f& lab, const Eigen::Vector3f& normal = Eigen::Vector3f::Zero()) const {
    cv::Vec3f lit = a * lab + b;
    lit[0] += (lab[0] + kBlack) * shading.dot(normal);
    return lit;
  }
};

/// A colour of the model beside what the frame has there, CIELAB.
struct ColorPair {
  cv::Vec3f model;
  cv::Vec3f scene;
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< of the model's surface, unit; zero: without shading
};

/// The transform that turns the model's colours into the scene's: least squares with robust weights, drawn towards the
/// identity (lightness freely, chroma reluctantly: illumination changes brightness and contrast much, hue little), so that few
/// or uniform colours cannot explain whatever is there. The identity for no pairs.
ColorTransform fitColorTransform(const std::vector<ColorPair>& pairs);

/// The same for lightness alone.
struct LightnessTransform {
  float gain = 1.0f, offset = 0.0f;
};

/// What fitColorTransform() makes of colours without chroma, by SIMD. `model` and `scene`: CIELAB L, of one size.
LightnessTransform fitLightness(const std::vector<float>& model, const std::vector<float>& scene);

}  // namespace recognition
