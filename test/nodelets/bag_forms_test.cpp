// Bags as other programs record them.
#include <cmath>
#include <cstdio>
#include <cstring>

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <rosbag/bag.h>

#include "bags/bag_reader.h"
#include "bags/compressed_image.h"
#include "refusal.h"
#include "ros/image_conversions.h"

namespace recognition {
namespace {

using ::testing::HasSubstr;

class BagForms : public ::testing::Test {
 protected:
  void SetUp() override {
    file_ = ::testing::TempDir() + "bag_forms_" + std::to_string(::getpid()) + ".bag";
    header_.stamp = ros::Time(1.0);
    header_.frame_id = "optical";
    bag_ = std::make_unique<rosbag::Bag>(file_, rosbag::bagmode::Write);
  }
  void TearDown() override { std::remove(file_.c_str()); }

  template <typename Message>
  void write(const std::string& topic, const Message& message) {
    bag_->write(topic, header_.stamp, message);
  }

  void writeColor(const std::string& topic, const std::string& encoding = "bgr8") {
    const auto image = imageMessage(color_, header_);
    image->encoding = encoding;
    write(topic, *image);
  }
  void writeInfo(const std::string& topic, double k1 = 0.0) {
    sensor_msgs::CameraInfo info = cameraInfo({64, 48, 60.0, 60.0, 31.5, 23.5}, header_);
    info.D[0] = k1;
    write(topic, info);
  }
  void writeDepth(const std::string& topic) { write(topic, *imageMessage(depth_, header_)); }

  sensor_msgs::CompressedImage packed(const std::string& format, const std::string& ending, const cv::Mat& image,
                                      size_t header_bytes = 0) const {
    sensor_msgs::CompressedImage message;
    message.header = header_;
    message.format = format;
    std::vector<uchar> bytes;
    cv::imencode(ending, image, bytes);
    message.data.assign(header_bytes, 0);
    message.data.insert(message.data.end(), bytes.begin(), bytes.end());
    return message;
  }

  RgbdFrame frame() {
    bag_.reset();
    reader_ = std::make_unique<BagReader>(file_);
    if (!reader_->next(&recorded_)) throw std::runtime_error("no frame: " + reader_->remarks());
    return recorded_.frame;
  }

  const cv::Mat color_{48, 64, CV_8UC3, cv::Scalar(10, 20, 30)};
  const cv::Mat depth_{48, 64, CV_16UC1, cv::Scalar(1234)};
  std::string file_;
  std_msgs::Header header_;
  std::unique_ptr<rosbag::Bag> bag_;
  std::unique_ptr<BagReader> reader_;
  RecordedFrame recorded_;
};

TEST_F(BagForms, ofAzureInItsOwnNamespaceAndWithFourChannels) {
  cv::Mat four(48, 64, CV_8UC4, cv::Scalar(10, 20, 30, 255));
  sensor_msgs::Image image;
  image.header = header_;
  image.encoding = "bgra8";
  image.width = 64, image.height = 48, image.step = 256;
  image.data.assign(four.data, four.data + four.total() * 4);
  write("/k4a/rgb/image_raw", image);
  writeInfo("/k4a/rgb/camera_info");
  writeDepth("/k4a/depth_to_rgb/image_raw");
  EXPECT_EQ(frame().color.at<cv::Vec3b>(5, 5), cv::Vec3b(10, 20, 30));
  EXPECT_EQ(recorded_.frame.depth.at<std::uint16_t>(5, 5), 1234);
  EXPECT_EQ(reader_->remarks(), "");
}

TEST_F(BagForms, ofTwoCamerasAsksForOne) {
  for (const std::string space : {"/left/", "/right/"}) {
    writeColor(space + "color/image_raw");
    writeInfo(space + "color/camera_info");
    writeDepth(space + "aligned_depth_to_color/image_raw");
  }
  EXPECT_THAT(refusal<std::runtime_error>([&] { frame(); }),
              HasSubstr("left/color/image_raw and right/color/image_raw"));
  BagReader reader(file_,
                   {"/right/color/image_raw", "right/color/camera_info", "right/aligned_depth_to_color/image_raw"});
  EXPECT_TRUE(reader.next(&recorded_));
}

TEST_F(BagForms, compressedAsImageTransportDoes) {
  write("/camera/rgb/image_rect_color/compressed", packed("bgr8; png compressed bgr8", ".png", color_));
  writeInfo("/camera/rgb/camera_info");
  write("/camera/depth_registered/image_raw/compressedDepth", packed("16UC1; compressedDepth png", ".png", depth_, 12));
  EXPECT_EQ(frame().color.at<cv::Vec3b>(5, 5), cv::Vec3b(10, 20, 30));
  EXPECT_EQ(recorded_.frame.depth.at<std::uint16_t>(5, 5), 1234);
}

TEST_F(BagForms, compressedColourOfFourChannelsOr16Bits) {
  const cv::Mat four(48, 64, CV_8UC4, cv::Scalar(10, 20, 30, 255));
  const cv::Mat deep(48, 64, CV_16UC3, cv::Scalar(257 * 10, 257 * 20, 257 * 30));
  const cv::Mat gray(48, 64, CV_16UC1, cv::Scalar(257 * 40));
  const auto decoded = [&](const std::string& format, const cv::Mat& image) {
    ColorOrder order;
    const auto message = colorWithThreeChannels(colorFromCompressed(packed(format, ".png", image)));
    return colorView(*message, &order).at<cv::Vec3b>(5, 5);
  };
  EXPECT_EQ(decoded("bgra8; png compressed bgra8", four), cv::Vec3b(10, 20, 30));
  EXPECT_EQ(decoded("rgb16; png compressed bgr16", deep), cv::Vec3b(10, 20, 30));
  EXPECT_EQ(decoded("mono16; png compressed ", gray), cv::Vec3b(40, 40, 40));
}

TEST_F(BagForms, ofOpenni2sDriverRegisteredByTheDevice) {
  writeColor("/camera/rgb/image_rect_color");
  writeInfo("/camera/rgb/camera_info");
  writeDepth("/camera/depth_registered/hw_registered/image_rect_raw");
  EXPECT_EQ(frame().depth.at<std::uint16_t>(5, 5), 1234);
}

TEST_F(BagForms, saysThatItHoldsNoCameraInfo) {
  writeColor("/k4a/rgb/image_raw");
  writeDepth("/k4a/depth_to_rgb/image_raw");
  EXPECT_THAT(refusal<std::runtime_error>([&] { frame(); }),
              HasSubstr("holds no camera info for k4a/rgb/image_raw (k4a/rgb/camera_info)"));
}

TEST_F(BagForms, undistortsRawColourAndItsDepth) {
  writeColor("/camera/rgb/image_raw");
  writeInfo("/camera/rgb/camera_info", 0.3);
  writeDepth("/camera/depth_registered/image_raw");
  EXPECT_EQ(frame().color.at<cv::Vec3b>(0, 0), cv::Vec3b(0, 0, 0));  // seen beyond the picture's border
  EXPECT_EQ(recorded_.frame.depth.at<std::uint16_t>(0, 0), 0);
  EXPECT_EQ(recorded_.frame.color.at<cv::Vec3b>(24, 32), cv::Vec3b(10, 20, 30));
  EXPECT_THAT(reader_->remarks(), HasSubstr("camera/rgb/image_raw are not rectified; their distortion was undone"));
}

TEST_F(BagForms, leavesRectifiedColourAsItIs) {
  writeColor("/camera/rgb/image_rect_color");
  writeInfo("/camera/rgb/camera_info", 0.3);
  writeDepth("/camera/depth_registered/image_raw");
  EXPECT_EQ(frame().color.at<cv::Vec3b>(0, 0), cv::Vec3b(10, 20, 30));
  EXPECT_EQ(reader_->remarks(), "");
}

TEST_F(BagForms, saysWhichTopicIsOfAnotherType) {
  writeInfo("/camera/rgb/image_rect_color");
  writeInfo("/camera/rgb/camera_info");
  writeDepth("/camera/depth_registered/image_raw");
  bag_.reset();
  EXPECT_THAT(refusal<std::runtime_error>([&] { BagReader(file_, openniTopics()); }),
              HasSubstr("'camera/rgb/image_rect_color' is of type sensor_msgs/CameraInfo, not"));
}

TEST_F(BagForms, cutShortNamesWhatMendsIt) {
  writeColor("/camera/rgb/image_rect_color");
  bag_.reset();
  std::FILE* file = std::fopen(file_.c_str(), "rb");
  std::fseek(file, 0, SEEK_END);
  const long size = std::ftell(file);
  std::fclose(file);
  ASSERT_EQ(::truncate(file_.c_str(), size / 2), 0);
  EXPECT_THAT(refusal<std::runtime_error>([&] { BagReader reader(file_); }), HasSubstr("cut short"));
  EXPECT_THAT(refusal<std::runtime_error>([&] { BagReader reader(file_); }), HasSubstr("rosbag reindex mends that"));
}

TEST_F(BagForms, floatDepthInSteps) {
  cv::Mat steps(48, 64, CV_16UC1, cv::Scalar(0));
  steps.at<std::uint16_t>(3, 4) = 500;
  sensor_msgs::CompressedImage message = packed("32FC1; compressedDepth png", ".png", steps, 12);
  const float parameters[2] = {1000.0f, 100.0f};  // depth = 1000 / (step - 100)
  std::memcpy(message.data.data() + 4, parameters, sizeof parameters);
  const auto depth = depthFromCompressed(message);
  EXPECT_EQ(depth->encoding, "32FC1");
  EXPECT_FLOAT_EQ(depthView(*depth).at<float>(3, 4), 2.5f);
  EXPECT_TRUE(std::isnan(depthView(*depth).at<float>(0, 0)));
}

// 7 zeros, then 1000 and 998: nibbles 7 | 2 | 1000 as 2000 in threes of bits, 998 - 1000 = -2 as 3.
TEST_F(BagForms, depthPackedByRvl) {
  sensor_msgs::CompressedImage message;
  message.format = "16UC1; compressedDepth rvl";
  message.data.assign(12, 0);
  const std::uint32_t size[2] = {3, 3};
  const auto put = [&](const void* bytes, size_t count) {
    const auto* from = static_cast<const std::uint8_t*>(bytes);
    message.data.insert(message.data.end(), from, from + count);
  };
  put(size, sizeof size);
  // 2000 = 0b011 111 010 000, lowest three first, each but the last with 8 added: 8 a f 3.
  const std::uint32_t word = 0x728af330;
  put(&word, sizeof word);
  const cv::Mat depth = depthView(*depthFromCompressed(message)).clone();
  EXPECT_EQ(depth.at<std::uint16_t>(2, 0), 0);
  EXPECT_EQ(depth.at<std::uint16_t>(2, 1), 1000);
  EXPECT_EQ(depth.at<std::uint16_t>(2, 2), 998);
  message.data.resize(message.data.size() - 1);
  EXPECT_THAT(refusal([&] { depthFromCompressed(message); }), HasSubstr("damaged"));
}

TEST_F(BagForms, refusesCompressedImagesThatAreNone) {
  sensor_msgs::CompressedImage message;
  message.format = "jpeg";
  EXPECT_THAT(refusal([&] { colorFromCompressed(message); }), HasSubstr("'jpeg' is damaged: 0 bytes"));
  message.data.assign(100, 7);
  EXPECT_THAT(refusal([&] { colorFromCompressed(message); }), HasSubstr("100 bytes"));
  message.format = "16UC1; compressedDepth";
  EXPECT_THAT(refusal([&] { colorFromCompressed(message); }), HasSubstr("is depth, not colour"));
  message.data.resize(12);
  EXPECT_THAT(refusal([&] { depthFromCompressed(message); }), HasSubstr("too short"));
}

}  // namespace
}  // namespace recognition
