#include "simulation/depth_sensor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/depth_noise.h"
#include "simulation/fixtures.h"

namespace recognition {
namespace {

StructuredLightView emptyView(const DepthSensor& sensor) {
  const cv::Size size(sensor.camera().width, sensor.camera().height);
  return {cv::Mat(size, CV_32FC1, cv::Scalar(0)), cv::Mat(size, CV_32FC3, cv::Scalar(0, 0, -1)),
          cv::Mat(size, CV_32FC1, cv::Scalar(1)), cv::Mat(size, CV_32FC1, cv::Scalar(0))};
}

StructuredLightView wallAt(const DepthSensor& sensor, double z) {
  StructuredLightView view = emptyView(sensor);
  view.depth.setTo(z);
  return view;
}

DepthSensorParameters withoutBias() {
  DepthSensorParameters parameters;
  parameters.bias = 0.0;
  return parameters;
}

double deviation(const cv::Mat& depth, double z) {
  double sum = 0.0;
  int count = 0;
  for (int v = 40; v < depth.rows - 40; ++v)
    for (int u = 40; u < depth.cols - 40; ++u) {
      const float d = depth.at<float>(v, u);
      if (!(d > 0.0f)) continue;
      sum += (d - z) * (d - z);
      ++count;
    }
  return std::sqrt(sum / std::max(1, count));
}

class AxialNoise : public testing::TestWithParam<double> {};

TEST_P(AxialNoise, IsKhoshelhams) {
  const double z = GetParam();
  const DepthSensor sensor(withoutBias());
  const cv::Mat depth = sensor.measure(wallAt(sensor, z), 7);
  EXPECT_NEAR(deviation(depth, z) / depthSigma(z, 0.0), 1.0, 0.15) << "at " << z << " m";
}

INSTANTIATE_TEST_SUITE_P(Depths, AxialNoise, testing::Values(0.71, 1.03, 1.52, 2.02, 3.05));

TEST(DepthSensor, StepsAreAnEighthOfAPixel) {
  const DepthSensorParameters parameters;
  const DepthSensor sensor(parameters);
  const cv::Mat depth = sensor.measure(wallAt(sensor, 1.3), 3);
  const double fb = parameters.focal_length * parameters.baseline;
  for (int u = 100; u < 500; ++u) {
    const double steps = 8.0 * fb / depth.at<float>(200, u);
    EXPECT_NEAR(steps, std::round(steps), 1e-3);
  }
}

// A plane turned by theta about the vertical, ending at the middle column; nothing behind it. Standard deviation of its
// edge in pixels.
double edgeDeviation(double theta, std::uint64_t seed) {
  const DepthSensor sensor(withoutBias());
  StructuredLightView view = emptyView(sensor);
  view.signal.setTo(0);
  const int edge = sensor.camera().width / 2;
  for (int v = 0; v < view.depth.rows; ++v)
    for (int u = 0; u < edge; ++u) {
      view.depth.at<float>(v, u) = static_cast<float>(1.0 / (1.0 - std::tan(theta) * (u - edge) / sensor.camera().fx));
      view.normals.at<cv::Vec3f>(v, u) = {static_cast<float>(-std::sin(theta)), 0.0f,
                                          static_cast<float>(-std::cos(theta))};
      view.signal.at<float>(v, u) = 1.0f;
    }
  const cv::Mat depth = sensor.measure(view, seed);
  double sum = 0.0, squares = 0.0;
  for (int v = 0; v < depth.rows; ++v) {
    int last = depth.cols - 1;
    while (last > 0 && !(depth.at<float>(v, last) > 0.0f)) --last;
    sum += last;
    squares += static_cast<double>(last) * last;
  }
  const double mean = sum / depth.rows;
  return std::sqrt(squares / depth.rows - mean * mean);
}

TEST(DepthSensor, LateralNoiseIsNguyens) {
  for (const double theta : {0.0, 0.5, 1.0}) {
    const double nguyen = 0.8 + 0.035 * theta / (CV_PI / 2 - theta);
    double mean = 0.0;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) mean += edgeDeviation(theta, seed) / 4;
    EXPECT_NEAR(mean / nguyen, 1.0, 0.3) << "theta " << theta;
  }
}

TEST(DepthSensor, ProjectorShadowIsLost) {
  const DepthSensorParameters parameters;
  const DepthSensor sensor(parameters);
  Scene scene;
  const Pose wall = Eigen::Translation3d(0, 0, 2) * Pose(Eigen::AngleAxisd(CV_PI, Eigen::Vector3d::UnitX()));
  scene.bodies.push_back({makeAppearance(makeTiledPlane(6, 6, 1, plainTexture(200))), wall, 0});
  scene.bodies.push_back(
      {makeAppearance(makeBox({0.3, 0.3, 0.02}, plainTexture(200))), Pose(Eigen::Translation3d(0, 0, 1.0)), 0});
  const RayScene rays(scene);
  const auto view = renderStructuredLight(rays, sensor.camera(), Pose::Identity(), sensor.baseline());
  const cv::Mat depth = sensor.measure(view, 1);
  int lost_left = 0, lost_right = 0;
  const int left = static_cast<int>(sensor.camera().cx - 0.15 * 580 / 0.99);
  const int right = static_cast<int>(sensor.camera().cx + 0.15 * 580 / 0.99);
  for (int u = left - 60; u < left; ++u) lost_left += view.signal.at<float>(240, u) == 0.0f;
  for (int u = right; u < right + 60; ++u) lost_right += view.signal.at<float>(240, u) == 0.0f;
  const double expected = 580.0 * 0.075 * (1 / 0.99 - 1 / 2.0);
  EXPECT_NEAR(lost_left, expected, 1.5);
  EXPECT_EQ(lost_right, 0);
  EXPECT_EQ(depth.at<float>(240, left - 12), 0.0f);
  EXPECT_NEAR(depth.at<float>(240, right + 15), 2.0, 0.05);
}

TEST(DepthSensor, LosesDarkGlaringAndUnlitPixels) {
  const DepthSensor sensor{DepthSensorParameters()};
  StructuredLightView view = wallAt(sensor, 1.0);
  view.signal(cv::Rect(0, 0, 640, 160)).setTo(0.002);
  view.glare(cv::Rect(0, 320, 640, 160)).setTo(0.9);
  const cv::Mat depth = sensor.measure(view, 5);
  EXPECT_EQ(cv::countNonZero(depth.rowRange(0, 150)), 0);
  EXPECT_GT(cv::countNonZero(depth.rowRange(170, 310)), 0.99 * 140 * 640 * 0.98);
  EXPECT_EQ(cv::countNonZero(depth.rowRange(330, 480)), 0);
}

TEST(DepthSensor, RegistersToTheColourCamera) {
  const DepthSensor sensor{DepthSensorParameters()};
  cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(0));
  depth.at<float>(240, 400) = 1.5f;
  CameraModel color{640, 480, 525, 525, 319.5, 239.5};
  const cv::Mat registered = sensor.registerToColor(depth, color);
  const double x = (400 - 319.5) / 580 * 1.5 - 0.025;
  const int u = cvRound(525 * x / 1.5 + 319.5);
  EXPECT_EQ(registered.at<std::uint16_t>(240, u), 1500);
  EXPECT_EQ(cv::countNonZero(registered), 1);
}

TEST(DepthSensor, LeavesNoGapsWhereColourIsFiner) {
  DepthSensorParameters parameters;
  parameters.focal_length = 475.0;
  const DepthSensor sensor(parameters);
  const CameraModel color{640, 480, 617.0, 617.0, 319.5, 239.5};
  const cv::Mat registered = sensor.registerToColor(cv::Mat(480, 640, CV_32FC1, cv::Scalar(0.8f)), color);
  EXPECT_EQ(cv::countNonZero(registered(cv::Rect(40, 40, 560, 400)) == 0), 0);
}

TEST(DepthSensor, ErrorsOfCalibrationShiftAndScale) {
  DepthSensorParameters parameters;
  parameters.color_offset = 0.0;
  parameters.registration_x = 3.0;
  parameters.registration_y = -2.0;
  const DepthSensor sensor(parameters);
  cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(0));
  depth.at<float>(200, 300) = 1.0f;
  const cv::Mat registered = sensor.registerToColor(depth, sensor.camera());
  EXPECT_EQ(cv::countNonZero(registered), 1);
  EXPECT_EQ(registered.at<std::uint16_t>(198, 303), 1000);

  DepthSensorParameters scaled = withoutBias();
  const cv::Scalar before = cv::mean(DepthSensor(scaled).measure(wallAt(DepthSensor(scaled), 1.0), 3));
  scaled.scale = 1.02;
  const cv::Scalar after = cv::mean(DepthSensor(scaled).measure(wallAt(DepthSensor(scaled), 1.0), 3));
  EXPECT_NEAR(after[0] / before[0], 1.02, 1e-4);
}

TEST(DepthSensor, SameForAnyNumberOfThreads) {
  const DepthSensor sensor{DepthSensorParameters()};
  const StructuredLightView view = wallAt(sensor, 1.0);
  cv::setNumThreads(1);
  const cv::Mat one = sensor.measure(view, 9);
  cv::setNumThreads(8);
  EXPECT_TRUE(sameBits(one, sensor.measure(view, 9)));
  EXPECT_FALSE(sameBits(one, sensor.measure(view, 10)));
}

TEST(DepthSensor, RejectsBadParameters) {
  DepthSensorParameters parameters;
  parameters.window = 6;
  EXPECT_THROW(DepthSensor{parameters}, std::invalid_argument);
  parameters.window = 7;
  parameters.baseline = -1.0;
  EXPECT_THROW(DepthSensor{parameters}, std::invalid_argument);
}

}  // namespace
}  // namespace recognition
