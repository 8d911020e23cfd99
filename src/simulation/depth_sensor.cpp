#include "simulation/depth_sensor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "simulation/random_stream.h"

namespace recognition {
namespace {

constexpr double kDoubtCorrelation = 1.5;             // px: lost pixels come in patches
constexpr double kSplatMargin = 0.1;                  // px, so that slanted surfaces stay closed
constexpr double kQuantisationVariance = 1.0 / 12.0;  // of rounding to whole steps

// Unit-variance normal noise, low-passed. `channels` 1 or 2.
cv::Mat smoothNoise(cv::Size size, int type, double correlation, std::uint64_t seed, std::uint64_t part) {
  cv::Mat noise(size, type), smooth;
  cv::parallel_for_(cv::Range(0, size.height), [&](const cv::Range& rows) {
    for (int v = rows.start; v < rows.end; ++v) {
      cv::Mat row = noise.row(v);
      randomStream(seed, part, static_cast<std::uint64_t>(v)).fill(row, cv::RNG::NORMAL, 0.0, 1.0);
    }
  });
  if (correlation <= 0.0) return noise;
  cv::GaussianBlur(noise, smooth, {}, correlation, correlation, cv::BORDER_REFLECT);
  const cv::Mat kernel = cv::getGaussianKernel(2 * cvCeil(4 * correlation) + 1, correlation, CV_64F);
  smooth /= kernel.dot(kernel);  // standard deviation of the blurred noise
  return smooth;
}

cv::Mat biasField(cv::Size size, double length, std::uint64_t seed) {
  const double factor = std::max(1.0, length / 2.0);
  const cv::Size coarse_size(cvCeil(size.width / factor) + 2, cvCeil(size.height / factor) + 2);
  cv::Mat field;
  cv::resize(smoothNoise(coarse_size, CV_32FC1, 1.0, seed, 4), field, {}, factor, factor, cv::INTER_CUBIC);
  return field(cv::Rect({}, size)).clone();
}

double incidence(const cv::Vec3f& normal, const Eigen::Vector3d& ray) {
  const double cosine = -(normal[0] * ray.x() + normal[1] * ray.y() + normal[2] * ray.z()) / ray.norm();
  return std::acos(std::clamp(cosine, 0.0, 1.0));
}

double angleRatio(double theta) { return theta / std::max(0.02, CV_PI / 2 - theta); }

// Displacement that, with rounding to pixels and the support's own noise (half the window lit at an edge), makes
// Nguyen's lateral noise.
double wanderReach(const DepthSensorParameters& p, double theta) {
  const double nguyen = p.lateral_noise + p.lateral_noise_slope * std::min(20.0, angleRatio(theta));
  const double support = 0.5 * p.support_noise * p.window;
  return std::sqrt(std::max(0.0, nguyen * nguyen - support * support - kQuantisationVariance));
}

}  // namespace

ParameterList DepthSensorParameters::list() {
  return {
      intParameter("width", "px", &width, 16, 4096, "columns of the infrared image"),
      intParameter("height", "px", &height, 16, 4096, "rows of the infrared image"),
      doubleParameter("focal_length", "px", &focal_length, 10.0, 10000.0, "of the infrared camera"),
      doubleParameter("baseline", "m", &baseline, 0.005, 1.0, "infrared camera to projector"),
      doubleParameter("color_offset", "m", &color_offset, -1.0, 1.0, "infrared camera to colour camera"),
      doubleParameter("subpixel", "", &subpixel, 1.0, 256.0, "disparity steps a pixel"),
      doubleParameter("disparity_noise", "", &disparity_noise, 0.0, 20.0, "steps of noise, quantisation included"),
      doubleParameter("noise_correlation", "px", &noise_correlation, 0.0, 10.0,
                      "smoothing of that noise by the window"),
      doubleParameter("angular_noise", "m", &angular_noise, 0.0, 0.01,
                      "growth of axial noise with the angle of incidence"),
      doubleParameter("lateral_noise", "px", &lateral_noise, 0.0, 10.0, "standard deviation of edges seen straight on"),
      doubleParameter("lateral_noise_slope", "px", &lateral_noise_slope, 0.0, 1.0,
                      "growth of it with the angle of incidence"),
      doubleParameter("lateral_correlation", "px", &lateral_correlation, 0.0, 10.0,
                      "correlation of an edge's wandering"),
      doubleParameter("bias", "", &bias, 0.0, 20.0, "steps of smooth error over the image"),
      doubleParameter("bias_length", "px", &bias_length, 2.0, 1000.0, "correlation length of that error"),
      intParameter("window", "px", &window, 1, 31, "side of the correlation window"),
      doubleParameter("same_surface", "px", &same_surface, 0.01, 10.0,
                      "disparity within which a window's pixels agree"),
      doubleParameter("min_support", "", &min_support, 0.0, 1.0, "share of the window that must be lit and agree"),
      doubleParameter("support_noise", "", &support_noise, 0.0, 1.0, "relative standard deviation of that share"),
      doubleParameter("half_signal", "", &half_signal, 0.0, 1.0, "reflectance cos / z^2 that halves the support"),
      doubleParameter("glare_limit", "", &glare_limit, 0.0, 1.0, "mirrored projector light that blinds a pixel"),
      doubleParameter("min_depth", "m", &min_depth, 0.0, 10.0, "nearest depth reported"),
      doubleParameter("max_depth", "m", &max_depth, 0.1, 65.0, "farthest depth reported"),
      doubleParameter("scale", "", &scale, 0.5, 2.0, "reported depth over true depth"),
      doubleParameter("registration_x", "px", &registration_x, -50.0, 50.0, "depth lies this far right of colour"),
      doubleParameter("registration_y", "px", &registration_y, -50.0, 50.0, "depth lies this far below colour"),
  };
}

void DepthSensorParameters::validate() const {
  DepthSensorParameters copy = *this;
  validateParameters(copy.list(), "depth_sensor");
  if (window % 2 == 0)
    throw std::invalid_argument("depth_sensor/window is " + std::to_string(window) + ": must be odd");
}

DepthSensor::DepthSensor(const DepthSensorParameters& parameters) : parameters_(parameters) {
  parameters_.validate();
  camera_.width = parameters_.width;
  camera_.height = parameters_.height;
  camera_.fx = camera_.fy = parameters_.focal_length;
  camera_.cx = (parameters_.width - 1) / 2.0;
  camera_.cy = (parameters_.height - 1) / 2.0;
}

Pose DepthSensor::worldFromInfrared(const Pose& world_from_color) const {
  return world_from_color * Eigen::Translation3d(-parameters_.color_offset, 0.0, 0.0);
}

cv::Mat DepthSensor::trueDisparity(const StructuredLightView& view) const {
  cv::Mat disparity(view.depth.size(), CV_32FC1);
  const auto fb = static_cast<float>(parameters_.focal_length * parameters_.baseline);
  for (int v = 0; v < disparity.rows; ++v)
    for (int u = 0; u < disparity.cols; ++u) {
      const float z = view.depth.at<float>(v, u);
      disparity.at<float>(v, u) = z > 0.0f ? fb / z : 0.0f;
    }
  return disparity;
}

namespace {

// The two surfaces that compete for a window: the centre's own and the nearest.
struct Window {
  int own = 0;   // lit pixels that agree with the centre
  int near = 0;  // lit pixels that agree with the nearest surface
  cv::Point nearest;
};

Window lookAround(const StructuredLightView& view, const cv::Mat& disparity, cv::Point centre, int radius, float same) {
  Window window;
  window.nearest = centre;
  const float own = disparity.at<float>(centre);
  const cv::Rect area =
      cv::Rect(centre.x - radius, centre.y - radius, 2 * radius + 1, 2 * radius + 1) & cv::Rect({}, disparity.size());
  float nearest = 0.0f;
  for (int v = area.y; v < area.br().y; ++v)
    for (int u = area.x; u < area.br().x; ++u) {
      const float d = disparity.at<float>(v, u);
      if (!(view.signal.at<float>(v, u) > 0.0f)) continue;
      window.own += std::abs(d - own) < same;
      if (d > nearest) {
        nearest = d;
        window.nearest = {u, v};
      }
    }
  if (nearest - own < same) {
    window.near = window.own;
    window.nearest = centre;
    return window;
  }
  for (int v = area.y; v < area.br().y; ++v)
    for (int u = area.x; u < area.br().x; ++u)
      window.near += view.signal.at<float>(v, u) > 0.0f && nearest - disparity.at<float>(v, u) < 2.0f * same;
  return window;
}

}  // namespace

// Depth at which the ray of `pixel` meets the surface that `source` sees.
double DepthSensor::extrapolate(const StructuredLightView& view, cv::Point source, const Eigen::Vector3d& ray) const {
  const cv::Vec3f& n = view.normals.at<cv::Vec3f>(source);
  const double depth = view.depth.at<float>(source);
  const Eigen::Vector3d point = camera_.unproject(source.x, source.y, depth);
  const double facing = n[0] * ray.x() + n[1] * ray.y() + n[2] * ray.z();
  if (std::abs(facing) < 0.05) return depth;
  const double z = (n[0] * point.x() + n[1] * point.y() + n[2] * point.z()) / facing;
  return std::abs(z - depth) < 0.03 * depth ? z : depth;
}

double DepthSensor::quantised(double z, double theta, double noise, double bias) const {
  const DepthSensorParameters& p = parameters_;
  const double fb = p.focal_length * p.baseline;
  const double random =
      std::sqrt(std::max(0.0, p.disparity_noise * p.disparity_noise - kQuantisationVariance)) / p.subpixel;
  const double ratio = angleRatio(theta);
  const double angular = p.angular_noise * ratio * ratio / std::sqrt(z) * fb / (z * z);
  const double measured = fb / z + noise * std::sqrt(random * random + angular * angular) + bias * p.bias / p.subpixel;
  const double steps = std::round(measured * p.subpixel);
  return steps > 0.0 ? fb * p.subpixel / steps : 0.0;
}

float DepthSensor::measurePixel(const StructuredLightView& view, const cv::Mat& disparity, cv::Point pixel,
                                const Draws& draws) const {
  const DepthSensorParameters& p = parameters_;
  const Eigen::Vector3d ray = camera_.unproject(pixel.x, pixel.y, 1.0);
  const double theta = incidence(view.normals.at<cv::Vec3f>(pixel), ray);
  const double reach = wanderReach(p, theta);
  const cv::Point centre(std::clamp(cvRound(pixel.x + reach * draws.wander[0]), 0, disparity.cols - 1),
                         std::clamp(cvRound(pixel.y + reach * draws.wander[1]), 0, disparity.rows - 1));
  const Window window = lookAround(view, disparity, centre, p.window / 2, static_cast<float>(p.same_surface));
  const cv::Point source = window.near > window.own ? window.nearest : centre;
  const double agreement = static_cast<double>(std::max(window.near, window.own)) / (p.window * p.window);
  const double signal = view.signal.at<float>(source);
  const double support = agreement * signal / (signal + p.half_signal) * (1.0 + p.support_noise * draws.doubt);
  if (!(support >= p.min_support) || view.glare.at<float>(source) > p.glare_limit) return 0.0f;
  const double z = quantised(extrapolate(view, source, ray), theta, draws.noise, draws.bias);
  return z >= p.min_depth && z <= p.max_depth ? static_cast<float>(p.scale * z) : 0.0f;
}

cv::Mat DepthSensor::measure(const StructuredLightView& view, std::uint64_t seed) const {
  const cv::Size size(camera_.width, camera_.height);
  if (view.depth.size() != size)
    throw std::invalid_argument("depth sensor: the view has another size than the infrared camera");
  const cv::Mat disparity = trueDisparity(view);
  const cv::Mat wander = smoothNoise(size, CV_32FC2, parameters_.lateral_correlation, seed, 1);
  const cv::Mat noise = smoothNoise(size, CV_32FC1, parameters_.noise_correlation, seed, 2);
  const cv::Mat doubt = smoothNoise(size, CV_32FC1, kDoubtCorrelation, seed, 3);
  const cv::Mat bias = biasField(size, parameters_.bias_length, seed);
  cv::Mat depth(size, CV_32FC1);
  cv::parallel_for_(cv::Range(0, size.height), [&](const cv::Range& rows) {
    for (int v = rows.start; v < rows.end; ++v)
      for (int u = 0; u < size.width; ++u) {
        const cv::Point pixel(u, v);
        const Draws draws{wander.at<cv::Vec2f>(pixel), noise.at<float>(pixel), bias.at<float>(pixel),
                          doubt.at<float>(pixel)};
        depth.at<float>(pixel) = measurePixel(view, disparity, pixel, draws);
      }
  });
  return depth;
}

namespace {

// Pixels about (x, y) that lie within `half` of it; the nearest depth wins.
void splat(const Eigen::Vector2d& pixel, double half, std::uint16_t millimetres, cv::Mat* registered) {
  const cv::Point first(cvRound(pixel.x() - half), cvRound(pixel.y() - half));
  const cv::Point last(cvRound(pixel.x() + half), cvRound(pixel.y() + half));
  const cv::Rect area = cv::Rect(first, last + cv::Point(1, 1)) & cv::Rect({}, registered->size());
  for (int y = area.y; y < area.br().y; ++y)
    for (int x = area.x; x < area.br().x; ++x) {
      auto& held = registered->at<std::uint16_t>(y, x);
      if (held == 0 || millimetres < held) held = millimetres;
    }
}

}  // namespace

cv::Mat DepthSensor::registerToColor(const cv::Mat& depth, const CameraModel& target) const {
  cv::Mat registered(target.height, target.width, CV_16UC1, cv::Scalar(0));
  const double ratio = target.fx / camera_.fx;  // above 1, a pixel of depth covers more than one of colour
  const double half = ratio > 1.0 ? (ratio - 1.0) / 2.0 + kSplatMargin : 0.0;
  const Eigen::Vector2d offset(parameters_.registration_x, parameters_.registration_y);
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const float z = depth.at<float>(v, u);
      if (!(z > 0.0f)) continue;
      Eigen::Vector3d point = camera_.unproject(u, v, z);
      point.x() -= parameters_.color_offset;
      splat(target.project(point) + offset, half, cv::saturate_cast<std::uint16_t>(1000.0f * z), &registered);
    }
  return registered;
}

}  // namespace recognition
