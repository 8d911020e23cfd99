#include "simulation/color_sensor.h"

#include <gtest/gtest.h>

#include "simulation/fixtures.h"

namespace recognition {
namespace {

cv::Mat evenLight(double value) { return cv::Mat(120, 160, CV_32FC3, cv::Scalar::all(value)); }

ColorSensorParameters plainCamera() {
  ColorSensorParameters parameters;
  parameters.vignetting = 0.0;
  parameters.sharpening = 0.0;
  return parameters;
}

double relativeNoise(double light, double gain) {
  ColorSettings settings;
  settings.gain = gain;
  ColorSensorParameters parameters = plainCamera();
  parameters.gamma = 1.0;
  cv::Scalar mean, deviation;
  cv::meanStdDev(ColorSensor(parameters).expose(evenLight(light), settings, 1), mean, deviation);
  return deviation[1] / mean[1];
}

TEST(ColorSensor, GrayStaysGray) {
  const cv::Scalar mean = cv::mean(ColorSensor(plainCamera()).expose(evenLight(0.5), ColorSettings(), 1));
  const double expected = 255 * std::pow(0.5, 1 / 2.2);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], expected, 2.0);
}

TEST(ColorSensor, KeepsRedAndBlueApart) {
  const cv::Mat red(120, 160, CV_32FC3, cv::Scalar(0.05, 0.1, 0.7));
  const cv::Scalar mean = cv::mean(ColorSensor(plainCamera()).expose(red, ColorSettings(), 1));
  EXPECT_GT(mean[2], mean[1] + 50);
  EXPECT_GT(mean[1], mean[0] + 10);
}

TEST(ColorSensor, NoiseGrowsInTheDarkAndWithGain) {
  EXPECT_GT(relativeNoise(0.05, 1.0), 1.5 * relativeNoise(0.5, 1.0));
  EXPECT_GT(relativeNoise(0.4, 8.0), 1.8 * relativeNoise(0.4, 1.0));
}

TEST(ColorSensor, BrightLightClips) {
  const cv::Mat image = ColorSensor(plainCamera()).expose(evenLight(3.0), ColorSettings(), 1);
  EXPECT_GT(cv::mean(image)[1], 253.0);
}

TEST(ColorSensor, ExposureFindsTheLevelForDimAndBrightScenes) {
  const ColorSensorParameters parameters;
  const ColorSensor sensor(parameters);
  for (const double light : {0.01, 0.3, 4.0}) {
    const ColorSettings settings = sensor.settle(evenLight(light), 3);
    EXPECT_GE(settings.exposure * light, parameters.mean_level_min * 0.999);
    EXPECT_LE(settings.exposure * light, parameters.mean_level_max * 1.001);
  }
  EXPECT_GT(sensor.settle(evenLight(0.01), 3).gain, sensor.settle(evenLight(4.0), 3).gain);
  EXPECT_NE(sensor.settle(evenLight(0.3), 3).exposure, sensor.settle(evenLight(0.3), 4).exposure);
}

TEST(ColorSensor, NeedsGainInLivingRoomsAndNoneInDaylight) {
  ColorSensorParameters parameters;
  parameters.mean_level_min = 0.18;
  parameters.mean_level_max = 0.181;
  const auto gain = [&](double lux) {  // on things that reflect 30 %
    return ColorSensor(parameters).settle(evenLight(0.3 * lux / 1000.0), 1).gain;
  };
  EXPECT_GT(gain(100.0), 4.0);
  EXPECT_NEAR(gain(400.0), 0.18 / 0.12 / parameters.longest_exposure, 0.02);
  EXPECT_DOUBLE_EQ(gain(2000.0), 1.0);
}

TEST(ColorSensor, SameForAnyNumberOfThreads) {
  const ColorSensor sensor{ColorSensorParameters()};
  cv::setNumThreads(1);
  const cv::Mat one = sensor.expose(evenLight(0.3), ColorSettings(), 5);
  cv::setNumThreads(8);
  EXPECT_TRUE(sameBits(one, sensor.expose(evenLight(0.3), ColorSettings(), 5)));
  EXPECT_FALSE(sameBits(one, sensor.expose(evenLight(0.3), ColorSettings(), 6)));
}

TEST(ColorSensor, RejectsOtherImages) {
  const ColorSensor sensor{ColorSensorParameters()};
  EXPECT_THROW(sensor.expose(cv::Mat(10, 10, CV_8UC3), ColorSettings(), 1), std::invalid_argument);
  ColorSensorParameters parameters;
  parameters.full_well = 0.0;
  EXPECT_THROW(ColorSensor{parameters}, std::invalid_argument);
}

}  // namespace
}  // namespace recognition
