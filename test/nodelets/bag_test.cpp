#include <cstdio>
#include <stdexcept>

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include "model/temporary_directory.h"
#include "refusal.h"
#include "bags/bag_reader.h"
#include "bags/bag_writer.h"
#include "ros/image_conversions.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

RgbdFrame smallFrame(int shade) {
  RgbdFrame frame;
  frame.color = cv::Mat(4, 6, CV_8UC3, cv::Scalar(shade, 10, 20));
  frame.depth = cv::Mat(4, 6, CV_16UC1, cv::Scalar(1000 + shade));
  frame.color_camera = {6, 4, 5.0, 6.0, 2.5, 1.5};
  return frame;
}

class BagTest : public ::testing::Test {
 protected:
  void SetUp() override { file_ = ::testing::TempDir() + "bag_test_" + std::to_string(::getpid()) + ".bag"; }
  void TearDown() override { std::remove(file_.c_str()); }

  void writeUnpacked(const std::string& color = "/camera/rgb/image_rect_color") {
    std_msgs::Header header;
    header.stamp = ros::Time(1.0);
    rosbag::Bag bag(file_, rosbag::bagmode::Write);
    bag.write(color, header.stamp, imageMessage(smallFrame(7).color, header));
    bag.write("/camera/rgb/camera_info", header.stamp, cameraInfo(smallFrame(0).color_camera, header));
    bag.write("/camera/depth_registered/image_raw", header.stamp, imageMessage(smallFrame(0).depth, header));
  }

  void putByte(size_t at, char byte) {
    std::fstream file(file_, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(static_cast<std::streamoff>(at));
    file.put(byte);
  }

  void readAll() {
    BagReader reader(file_);
    for (RecordedFrame recorded; reader.next(&recorded);) EXPECT_FALSE(recorded.frame.color.empty());
  }

  std::string file_;
};

TEST_F(BagTest, readsBackWhatWasWritten) {
  BagWriter writer(file_, openniTopics(), {"optical"});
  for (int i = 0; i < 3; ++i) writer.write(smallFrame(i), 1000000000 + i * 33000000);
  writer.close();

  BagReader reader(file_);
  EXPECT_EQ(reader.colorImages(), 3);
  RecordedFrame recorded;
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(reader.next(&recorded));
    EXPECT_EQ(recorded.stamp, 1000000000 + i * 33000000);
    EXPECT_EQ(recorded.frame_id, "optical");
    EXPECT_EQ(recorded.frame.color.at<cv::Vec3b>(3, 5), cv::Vec3b(i, 10, 20));
    EXPECT_EQ(recorded.frame.depth.at<std::uint16_t>(3, 5), 1000 + i);
    EXPECT_DOUBLE_EQ(recorded.frame.color_camera.cx, 2.5);
  }
  EXPECT_FALSE(reader.next(&recorded));
  EXPECT_EQ(reader.skipped(), 0);
}

TEST_F(BagTest, takesRawColourWhereNoneIsRectified) {
  writeUnpacked("/camera/rgb/image_raw");
  RecordedFrame recorded;
  ASSERT_TRUE(BagReader(file_).next(&recorded));
  EXPECT_EQ(recorded.frame.color.at<cv::Vec3b>(3, 5), cv::Vec3b(7, 10, 20));
}

TEST_F(BagTest, readsOrganisedCloudsAsDepth) {
  std_msgs::Header header;
  header.stamp = ros::Time(1.0);
  sensor_msgs::PointCloud2 cloud;
  cloud.header = header;
  sensor_msgs::PointCloud2Modifier modifier(cloud);
  modifier.setPointCloud2FieldsByString(2, "xyz", "rgb");
  modifier.resize(24);
  cloud.width = 6, cloud.height = 4, cloud.row_step = 6 * cloud.point_step;
  float next = 0.0f;
  for (sensor_msgs::PointCloud2Iterator<float> z(cloud, "z"); z != z.end(); ++z) *z = next++;
  rosbag::Bag bag(file_, rosbag::bagmode::Write);
  bag.write("/camera/rgb/points", header.stamp, cloud);
  bag.write("camera/rgb/camera_info", header.stamp, cameraInfo(smallFrame(0).color_camera, header));
  bag.write("camera/rgb/image_color", header.stamp, imageMessage(smallFrame(0).color, header));
  bag.close();

  BagReader reader(file_);
  RecordedFrame recorded;
  ASSERT_TRUE(reader.next(&recorded));
  EXPECT_FLOAT_EQ(recorded.frame.depth.at<float>(2, 3), 15.0f);
}

TEST_F(BagTest, skipsColourWithoutDepthInTime) {
  std_msgs::Header header;
  rosbag::Bag bag(file_, rosbag::bagmode::Write);
  for (const double time : {1.0, 1.1, 1.2}) {
    header.stamp = ros::Time(time);
    bag.write("/camera/rgb/image_rect_color", header.stamp, imageMessage(smallFrame(0).color, header));
    bag.write("/camera/rgb/camera_info", header.stamp, cameraInfo(smallFrame(0).color_camera, header));
    header.stamp += ros::Duration(time == 1.1 ? 0.05 : 0.01);
    bag.write("/camera/depth_registered/image_raw", header.stamp, imageMessage(smallFrame(0).depth, header));
  }
  bag.close();

  BagReader reader(file_);
  RecordedFrame recorded;
  ASSERT_TRUE(reader.next(&recorded));
  EXPECT_EQ(recorded.stamp, 1000000000);
  ASSERT_TRUE(reader.next(&recorded));
  EXPECT_EQ(recorded.stamp, 1200000000);
  EXPECT_FALSE(reader.next(&recorded));
  EXPECT_EQ(reader.skipped(), 1);
  EXPECT_THAT(reader.remarks(), HasSubstr("1 of 3 colour images were skipped, 1 without depth within 20 ms"));
  EXPECT_THAT(reader.remarks(), HasSubstr("the nearest depth is 50 ms away (--max-interval 0.055"));

  BagReader patient(file_, 0.06);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(patient.next(&recorded));
  EXPECT_EQ(patient.remarks(), "");
}

TEST_F(BagTest, namesABadFrameAndGoesOn) {
  std_msgs::Header header;
  rosbag::Bag bag(file_, rosbag::bagmode::Write);
  for (int i = 0; i < 2; ++i) {
    header.stamp = ros::Time(1.0 + i);
    const auto color = imageMessage(smallFrame(0).color, header);
    if (i == 0) color->encoding = "yuv999";
    bag.write("/camera/rgb/image_rect_color", header.stamp, color);
    bag.write("/camera/rgb/camera_info", header.stamp, cameraInfo(smallFrame(0).color_camera, header));
    bag.write("/camera/depth_registered/image_raw", header.stamp, imageMessage(smallFrame(0).depth, header));
  }
  bag.close();

  BagReader reader(file_);
  RecordedFrame recorded;
  EXPECT_THAT(refusal<std::runtime_error>([&] { reader.next(&recorded); }), HasSubstr("yuv999"));
  ASSERT_TRUE(reader.next(&recorded));
  EXPECT_EQ(recorded.stamp, 2000000000);
  EXPECT_EQ(reader.skipped(), 0);  // of those without depth or camera info
}

TEST_F(BagTest, saysWhereABagIsDamaged) {
  writeUnpacked();
  const std::string good = readText(file_);
  const auto reason = [&](const std::string& key, size_t after, const std::string& bytes) {
    const size_t at = good.find(key);
    EXPECT_NE(at, std::string::npos) << key;
    writeText(file_, std::string(good).replace(at + key.size() + after, bytes.size(), bytes));
    return refusal<std::runtime_error>([&] { readAll(); });
  };
  const std::string huge = "\xff\xff\xff\x7f";
  const std::string pixels = std::string("\x48\0\0\0", 4) + std::string("\x07\x0a\x14");
  EXPECT_THAT(reason("#ROSBAG V", 0, "1"), HasSubstr("no bag of format 2.0"));
  EXPECT_THAT(reason("#ROSBAG V2.0\n", 0, huge), AllOf(HasSubstr(file_), HasSubstr("byte 17: the file ends before")));
  EXPECT_THAT(reason("#ROSBAG V2.0\n", 4, huge), HasSubstr("byte 13: the record's header is damaged"));
  EXPECT_THAT(reason("index_pos=", 0, huge), HasSubstr("the file ends before"));
  EXPECT_THAT(reason("index_pos=", 0, std::string(8, '\0')), HasSubstr("rosbag reindex"));
  EXPECT_THAT(reason("conn_count=", 0, huge), HasSubstr("is no connection"));
  EXPECT_THAT(reason("chunk_count=", 0, huge), HasSubstr("ends before"));
  EXPECT_THAT(reason("compression=", 0, "some"), HasSubstr("unknown compression 'some'"));
  EXPECT_THAT(reason("size=", 0, huge), HasSubstr("too many for a chunk"));
  EXPECT_THAT(reason("chunk_pos=", 0, huge), HasSubstr("ends before"));
  EXPECT_THAT(reason("op=\x02", static_cast<size_t>(-8), huge), HasSubstr("no whole message"));
  EXPECT_THAT(reason(pixels, static_cast<size_t>(-7), huge), HasSubstr("shorter than it says"));
  EXPECT_THAT(reason("#", 0, "ROSBAG"), "");
}

TEST_F(BagTest, bearsAnyByte) {
  for (const bool packed : {false, true}) {
    if (packed)
      BagWriter(file_, openniTopics()).write(smallFrame(7), 1);
    else
      writeUnpacked();
    const std::string good = readText(file_);
    int refused = 0;
    for (size_t at = 0; at < good.size(); at += at % 13 + 1) {
      putByte(at, static_cast<char>(~good[at]));
      refused += !refusal<std::runtime_error>([&] { readAll(); }).empty();
      putByte(at, good[at]);
    }
    EXPECT_GT(refused, 50);
  }
}

TEST_F(BagTest, namesTheTopicThatIsMissingAndThoseThatAreThere) {
  BagWriter(file_, openniTopics()).write(smallFrame(0), 1);
  const std::string message = refusal<std::runtime_error>([&] { BagReader(file_, challengeTopics()); });
  EXPECT_THAT(message, HasSubstr("camera/rgb/image_color"));
  EXPECT_THAT(message, HasSubstr("/camera/rgb/image_rect_color (sensor_msgs/Image)"));
  EXPECT_THAT(refusal<std::runtime_error>([] { BagReader("/no/such.bag"); }), HasSubstr("/no/such.bag"));
}

}  // namespace
}  // namespace recognition
