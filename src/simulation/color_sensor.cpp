#include "simulation/color_sensor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "simulation/random_stream.h"

namespace recognition {
namespace {

constexpr double kFullWidth = 1280.0;  // image whose pixels the blur is given in
constexpr double kSharpeningRadius = 1.2;
constexpr int kCurveSteps = 4096;

// Red and blue beside green, as on the sensor: rows G R G R / B G B G. Channel index in BGR.
int bayerChannel(int u, int v) { return v % 2 == 0 ? (u % 2 == 0 ? 1 : 2) : (u % 2 == 0 ? 0 : 1); }

double contrastCurve(double x, double weight) { return (1.0 - weight) * x + weight * x * x * (3.0 - 2.0 * x); }

// Linear 0..1 in kCurveSteps to 8-bit display values (float, so that sharpening comes before rounding).
std::array<float, kCurveSteps + 1> toneCurve(double gamma, double contrast) {
  std::array<float, kCurveSteps + 1> curve{};
  for (size_t i = 0; i < curve.size(); ++i)
    curve[i] = static_cast<float>(255.0 *
                                  contrastCurve(std::pow(static_cast<double>(i) / kCurveSteps, 1.0 / gamma), contrast));
  return curve;
}

template <typename Work>
void forRows(int rows, const Work& work) {
  cv::parallel_for_(cv::Range(0, rows), [&work](const cv::Range& range) {
    for (int v = range.start; v < range.end; ++v) work(v);
  });
}

}  // namespace

ParameterList ColorSensorParameters::list() {
  return {
      doubleParameter("blur", "px", &blur, 0.0, 5.0, "standard deviation of lens and motion blur at full resolution"),
      doubleParameter("full_well", "", &full_well, 100.0, 1e6, "electrons at saturation without gain"),
      doubleParameter("read_noise", "", &read_noise, 0.0, 1000.0, "electrons of read noise"),
      doubleParameter("max_gain", "", &max_gain, 1.0, 100.0, "analogue gain in the darkest scenes"),
      doubleParameter("longest_exposure", "1/klx", &longest_exposure, 0.01, 100.0,
                      "level that 1 klx from a white surface gives without gain"),
      doubleParameter("mean_level_min", "", &mean_level_min, 0.01, 1.0,
                      "least linear mean that automatic exposure aims at"),
      doubleParameter("mean_level_max", "", &mean_level_max, 0.01, 1.0,
                      "greatest linear mean that automatic exposure aims at"),
      doubleParameter("white_balance_min", "", &white_balance_min, 0.0, 1.0,
                      "least share of the light's tint that is removed"),
      doubleParameter("white_balance_max", "", &white_balance_max, 0.0, 1.0,
                      "greatest share of the light's tint that is removed"),
      doubleParameter("white_balance_error", "", &white_balance_error, 0.0, 1.0,
                      "standard deviation of the log of red and blue gains"),
      doubleParameter("saturation_min", "", &saturation_min, 0.0, 3.0, "least factor on chroma"),
      doubleParameter("saturation_max", "", &saturation_max, 0.0, 3.0, "greatest factor on chroma"),
      doubleParameter("contrast_max", "", &contrast_max, 0.0, 1.0, "greatest weight of the S-shaped tone curve"),
      doubleParameter("gamma", "", &gamma, 1.0, 4.0, "exponent of the display"),
      doubleParameter("chroma_blur", "px", &chroma_blur, 0.0, 5.0,
                      "standard deviation of what chroma subsampling leaves"),
      doubleParameter("sharpening", "", &sharpening, 0.0, 3.0, "weight of the unsharp mask"),
      doubleParameter("vignetting", "", &vignetting, 0.0, 0.9, "loss of light in the corners"),
  };
}

void ColorSensorParameters::validate() const {
  ColorSensorParameters copy = *this;
  validateParameters(copy.list(), "color_sensor");
}

ColorSettings ColorSensor::settle(const cv::Mat& radiance, std::uint64_t seed) const {
  if (radiance.type() != CV_32FC3) throw std::invalid_argument("colour sensor: light is not CV_32FC3");
  cv::RNG rng = randomStream(seed, 1);
  const ColorSensorParameters& p = parameters_;
  const cv::Scalar mean = cv::mean(radiance);
  const double light = std::max(1e-6, (mean[0] + mean[1] + mean[2]) / 3.0);
  ColorSettings settings;
  settings.exposure = logUniform(rng, p.mean_level_min, p.mean_level_max) / light;
  settings.gain = std::clamp(settings.exposure / p.longest_exposure, 1.0, p.max_gain);
  const double balance = rng.uniform(p.white_balance_min, p.white_balance_max);
  for (int c = 0; c < 3; ++c)
    settings.white_balance[c] = std::pow(std::max(1e-6, mean[1]) / std::max(1e-6, mean[c]), balance);
  settings.white_balance[0] *= std::exp(rng.gaussian(p.white_balance_error));
  settings.white_balance[2] *= std::exp(rng.gaussian(p.white_balance_error));
  settings.saturation = rng.uniform(p.saturation_min, p.saturation_max);
  settings.contrast = rng.uniform(0.0, p.contrast_max);
  return settings;
}

namespace {

// Electrons of the mosaic, read as 16 bit at 1/4 of the range (head room for white balance).
cv::Mat exposeMosaic(const cv::Mat& light, const ColorSensorParameters& p, const ColorSettings& settings,
                     std::uint64_t seed) {
  cv::Mat mosaic(light.size(), CV_16UC1);
  const double cu = (light.cols - 1) / 2.0;
  const double cv = (light.rows - 1) / 2.0;
  const double shot = settings.gain / p.full_well;
  const double read = std::pow(p.read_noise * settings.gain / p.full_well, 2);
  forRows(light.rows, [&](int v) {
    cv::Mat normal(1, light.cols, CV_32FC1);
    randomStream(seed, 2, static_cast<std::uint64_t>(v)).fill(normal, cv::RNG::NORMAL, 0.0, 1.0);
    for (int u = 0; u < light.cols; ++u) {
      const double radius = ((u - cu) * (u - cu) + (v - cv) * (v - cv)) / (cu * cu + cv * cv);
      const double x =
          light.at<cv::Vec3f>(v, u)[bayerChannel(u, v)] * settings.exposure * (1.0 - p.vignetting * radius);
      const double noisy = std::min(1.0, x + std::sqrt(shot * x + read) * normal.at<float>(0, u));
      mosaic.at<std::uint16_t>(v, u) = cv::saturate_cast<std::uint16_t>(4096.0 + 32767.0 * noisy);
    }
  });
  return mosaic;
}

// White balance, saturation and tone: CV_32FC3 in 0..255.
cv::Mat develop(const cv::Mat& demosaiced, const ColorSensorParameters& p, const ColorSettings& settings) {
  cv::Mat display(demosaiced.size(), CV_32FC3);
  const auto curve = toneCurve(p.gamma, settings.contrast);
  forRows(display.rows, [&](int v) {
    for (int u = 0; u < display.cols; ++u) {
      const auto& raw = demosaiced.at<cv::Vec3w>(v, u);
      double linear[3];
      for (int c = 0; c < 3; ++c) linear[c] = std::min(1.0, settings.white_balance[c] * (raw[c] - 4096.0) / 32767.0);
      const double gray = 0.114 * linear[0] + 0.587 * linear[1] + 0.299 * linear[2];
      for (int c = 0; c < 3; ++c) {
        const double x = std::clamp(gray + settings.saturation * (linear[c] - gray), 0.0, 1.0);
        display.at<cv::Vec3f>(v, u)[c] = curve[static_cast<size_t>(x * kCurveSteps + 0.5)];
      }
    }
  });
  return display;
}

// Luminance sharpened, chroma softened: CV_8UC3.
cv::Mat finish(const cv::Mat& display, const ColorSensorParameters& p) {
  cv::Mat ycc, chroma, soft, color;
  cv::cvtColor(display, ycc, cv::COLOR_BGR2YCrCb);
  std::vector<cv::Mat> channels;
  cv::split(ycc, channels);
  cv::GaussianBlur(channels[0], soft, {}, kSharpeningRadius);
  cv::addWeighted(channels[0], 1.0 + p.sharpening, soft, -p.sharpening, 0.0, channels[0]);
  if (p.chroma_blur > 0.0)
    for (size_t c = 1; c < 3; ++c) cv::GaussianBlur(channels[c], channels[c], {}, p.chroma_blur);
  cv::merge(channels, ycc);
  cv::cvtColor(ycc, color, cv::COLOR_YCrCb2BGR);
  color.convertTo(color, CV_8U);
  return color;
}

}  // namespace

cv::Mat ColorSensor::expose(const cv::Mat& radiance, const ColorSettings& settings, std::uint64_t seed) const {
  if (radiance.type() != CV_32FC3) throw std::invalid_argument("colour sensor: light is not CV_32FC3");
  cv::Mat light = radiance, demosaiced;
  const double blur = parameters_.blur * radiance.cols / kFullWidth;
  if (blur > 0.0) cv::GaussianBlur(radiance, light, {}, std::max(0.3, blur));
  const cv::Mat mosaic = exposeMosaic(light, parameters_, settings, seed);
  cv::demosaicing(mosaic, demosaiced, cv::COLOR_BayerGB2BGR);  // OpenCV names the second row
  const cv::Mat display = develop(demosaiced, parameters_, settings);
  return finish(display, parameters_);
}

}  // namespace recognition
