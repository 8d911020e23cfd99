#include <boost/make_shared.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "refusal.h"
#include "ros/image_conversions.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition {
namespace {

using ::testing::HasSubstr;

struct Messages {
  sensor_msgs::ImagePtr color = imageMessage(cv::Mat(4, 6, CV_8UC3, cv::Scalar(1, 2, 3)), {});
  sensor_msgs::ImagePtr depth = imageMessage(cv::Mat(4, 6, CV_16UC1, cv::Scalar(1000)), {});
  sensor_msgs::CameraInfoPtr info =
      boost::make_shared<sensor_msgs::CameraInfo>(cameraInfo({6, 4, 5.0, 6.0, 2.5, 1.5}, {}));

  RgbdFrame frame() const { return frameView({color, depth, info}); }
  std::string problem() const {
    return refusal([this] { frame(); });
  }
};

TEST(FrameView, sharesThePixelsOfTheMessages) {
  const Messages messages;
  const RgbdFrame frame = messages.frame();
  EXPECT_EQ(frame.color.data, messages.color->data.data());
  EXPECT_EQ(frame.depth.data, messages.depth->data.data());
  EXPECT_EQ(frame.color_order, ColorOrder::kBgr);
}

TEST(FrameView, readsTheOrderOfChannels) {
  Messages messages;
  messages.color->encoding = "rgb8";
  EXPECT_EQ(messages.frame().color_order, ColorOrder::kRgb);
}

TEST(FrameView, honoursStep) {
  Messages messages;
  messages.depth->step = 20;
  messages.depth->data.assign(80, 0);
  messages.depth->data[3 * 20 + 5 * 2] = 7;
  EXPECT_EQ(messages.frame().depth.at<std::uint16_t>(3, 5), 7);
}

TEST(FrameView, acceptsMono16AndFloatDepth) {
  Messages messages;
  messages.depth->encoding = "mono16";
  EXPECT_EQ(messages.frame().depth.type(), CV_16UC1);
  messages.depth = imageMessage(cv::Mat(4, 6, CV_32FC1, cv::Scalar(1.0)), {});
  EXPECT_EQ(messages.frame().depth.type(), CV_32FC1);
}

TEST(FrameView, namesAnUnknownEncoding) {
  Messages messages;
  messages.color->encoding = "yuv411";
  EXPECT_THAT(messages.problem(), HasSubstr("colour image has encoding 'yuv411'"));
  messages = {};
  messages.depth->encoding = "64FC1";
  EXPECT_THAT(messages.problem(), HasSubstr("depth image has encoding '64FC1'"));
}

TEST(FrameView, refusesBigEndianDepth) {
  Messages messages;
  messages.depth->is_bigendian = 1;
  EXPECT_THAT(messages.problem(), HasSubstr("depth image is big-endian"));
}

TEST(FrameView, refusesStepAndDataThatAreTooSmall) {
  Messages messages;
  messages.color->step = 17;
  EXPECT_THAT(messages.problem(), HasSubstr("step 17"));
  messages = {};
  messages.depth->step = 13;
  EXPECT_THAT(messages.problem(), HasSubstr("step 13"));
  messages = {};
  messages.color->data.resize(71);
  EXPECT_THAT(messages.problem(), HasSubstr("71 bytes"));
}

TEST(FrameView, refusesZeroAndHugeSizes) {
  Messages messages;
  messages.color->width = 0;
  EXPECT_THAT(messages.problem(), HasSubstr("0x4"));
  messages = {};
  messages.depth->height = 4000000000u;
  EXPECT_THAT(messages.problem(), HasSubstr("4000000000"));
}

TEST(FrameView, refusesDepthOfAnotherFrameAndInfoOfAnotherSize) {
  Messages messages;
  messages.depth->header.frame_id = "ir";
  EXPECT_THAT(messages.problem(), HasSubstr("'ir'"));
  messages = {};
  messages.info->width = 12;
  EXPECT_THAT(messages.problem(), HasSubstr("12x4"));
}

TEST(CameraFromInfo, readsPWithBinningAndRegion) {
  sensor_msgs::CameraInfo info = cameraInfo({1280, 1024, 1050.0, 1051.0, 639.5, 511.5}, {});
  info.K[0] = 1.0;  // of the unrectified image: not ours
  info.binning_x = info.binning_y = 2;
  info.roi.x_offset = 40, info.roi.y_offset = 20, info.roi.width = 1200, info.roi.height = 960;
  const CameraModel camera = cameraFromInfo(info);
  EXPECT_EQ(camera.width, 600);
  EXPECT_EQ(camera.height, 480);
  EXPECT_DOUBLE_EQ(camera.fx, 525.0);
  EXPECT_DOUBLE_EQ(camera.cx, (639.5 - 40 + 0.5) / 2 - 0.5);
  EXPECT_DOUBLE_EQ(camera.cy, (511.5 - 20 + 0.5) / 2 - 0.5);
}

TEST(CameraFromInfo, refusesAnUncalibratedCamera) {
  EXPECT_THAT(refusal([] { cameraFromInfo(sensor_msgs::CameraInfo()); }), HasSubstr("not calibrated"));
}

TEST(ColorWithThreeChannels, convertsFourChannelsAndPassesThree) {
  const auto bgr = imageMessage(cv::Mat(2, 2, CV_8UC3), {});
  EXPECT_EQ(colorWithThreeChannels(bgr), bgr);
  auto rgba = boost::make_shared<sensor_msgs::Image>();
  rgba->encoding = "rgba8", rgba->width = rgba->height = 1, rgba->step = 4, rgba->data = {1, 2, 3, 255};
  EXPECT_THAT(colorWithThreeChannels(rgba)->data, ::testing::ElementsAre(3, 2, 1));
}

// A BGR picture of 4x4 in an encoding, back in BGR.
cv::Mat converted(const std::string& encoding, const cv::Mat& pixels) {
  sensor_msgs::Image image;
  image.encoding = encoding;
  image.width = pixels.cols, image.height = pixels.rows, image.step = pixels.cols * pixels.elemSize();
  image.data.assign(pixels.data, pixels.data + pixels.total() * pixels.elemSize());
  ColorOrder order;
  return colorView(*colorWithThreeChannels(boost::make_shared<sensor_msgs::Image>(image)), &order).clone();
}

TEST(ColorWithThreeChannels, readsWhatCamerasSend) {
  const cv::Scalar bgr(40, 90, 200);
  const cv::Vec3b wanted(40, 90, 200);
  const auto expect = [&](const std::string& encoding, const cv::Mat& pixels, const cv::Vec3b& color, int tolerance) {
    const cv::Mat result = converted(encoding, pixels);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(result.at<cv::Vec3b>(3, 3)[k], color[k], tolerance) << encoding;
  };
  expect("bgra8", cv::Mat(8, 8, CV_8UC4, cv::Scalar(40, 90, 200, 255)), wanted, 0);
  expect("bgr16", cv::Mat(8, 8, CV_16UC3, bgr * 257.0), wanted, 0);
  expect("rgb16", cv::Mat(8, 8, CV_16UC3, cv::Scalar(200, 90, 40) * 257.0), wanted, 0);
  expect("mono8", cv::Mat(8, 8, CV_8UC1, cv::Scalar(70)), {70, 70, 70}, 0);
  expect("mono16", cv::Mat(8, 8, CV_16UC1, cv::Scalar(70 * 257)), {70, 70, 70}, 0);
  for (const std::string pattern : {"rggb", "bggr", "gbrg", "grbg"}) {
    cv::Mat raw(8, 8, CV_8UC1);
    for (int v = 0; v < 8; ++v)
      for (int u = 0; u < 8; ++u) {
        const char channel = pattern[static_cast<size_t>(2 * (v % 2) + u % 2)];
        raw.at<uchar>(v, u) = wanted[channel == 'b' ? 0 : channel == 'g' ? 1 : 2];
      }
    expect("bayer_" + pattern + "8", raw, wanted, 1);
    cv::Mat wide;
    raw.convertTo(wide, CV_16U, 257.0);
    expect("bayer_" + pattern + "16", wide, wanted, 1);
  }
  expect("yuv422", cv::Mat(8, 8, CV_8UC2, cv::Scalar(128, 120)), {121, 121, 121}, 1);
  EXPECT_THAT(refusal([] { converted("yuv422", cv::Mat(8, 7, CV_8UC2, cv::Scalar(128, 120))); }),
              HasSubstr("odd width"));
}

TEST(UndistortedFrame, usesKAndDOfTheCameraInfo) {
  Messages messages;
  messages.info->D[0] = -0.3;
  messages.info->K[0] = 4.0;
  EXPECT_TRUE(distortionOf(*messages.info).isThere());
  const RgbdFrame frame = undistortedFrame({messages.color, messages.depth, messages.info});
  EXPECT_DOUBLE_EQ(frame.color_camera.fx, 5.0);  // of P
  EXPECT_DOUBLE_EQ(rawCameraFromInfo(*messages.info).fx, 4.0);
  messages.info->P.fill(0.0);
  EXPECT_DOUBLE_EQ(undistortedFrame({messages.color, messages.depth, messages.info}).color_camera.fx, 4.0);
  messages.info->distortion_model = "own";
  EXPECT_THAT(refusal([&] { undistortedFrame({messages.color, messages.depth, messages.info}); }), HasSubstr("'own'"));
}

TEST(RectifiedMessages, areThoseThemselvesUnlessColourIsRawAndDistorted) {
  Messages own;
  const FrameMessages messages{own.color, own.depth, own.info};
  EXPECT_EQ(rectified(messages, "/camera/rgb/image_raw", "/camera/depth/image_raw").color, messages.color);
  own.info->D[0] = -0.3;
  EXPECT_EQ(rectified(messages, "/camera/rgb/image_rect_color", "/camera/depth/image_raw").color, messages.color);
  const FrameMessages undone = rectified(messages, "/camera/rgb/image_raw", "/camera/depth/image_raw");
  EXPECT_NE(undone.color, messages.color);
  EXPECT_EQ(undone.color->header.stamp, messages.color->header.stamp);
  EXPECT_FALSE(distortionOf(*undone.camera_info).isThere());
  EXPECT_EQ(frameView(undone).depth.size(), frameView(messages).depth.size());
}

TEST(DepthFromPoints, refusesCloudsThatAreNoImage) {
  sensor_msgs::PointCloud2 cloud;
  cloud.height = 1, cloud.width = 24;
  EXPECT_THAT(refusal([&] { depthFromPoints(cloud); }), HasSubstr("unorganised"));
  cloud.height = 4, cloud.width = 6;
  EXPECT_THAT(refusal([&] { depthFromPoints(cloud); }), HasSubstr("no float field z"));
  cloud.fields.resize(1);
  cloud.fields[0].name = "z", cloud.fields[0].datatype = sensor_msgs::PointField::FLOAT32;
  cloud.point_step = 16, cloud.row_step = 96, cloud.data.resize(383);
  EXPECT_THAT(refusal([&] { depthFromPoints(cloud); }), HasSubstr("383 bytes"));
}

}  // namespace
}  // namespace recognition
