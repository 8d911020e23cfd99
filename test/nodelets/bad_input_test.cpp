// Bad input: told with topic and reason, counted, and the next frame goes on. Bad parameters: the nodelet refuses to
// start.
#include <limits>

#include <boost/make_shared.hpp>
#include <dynamic_reconfigure/Reconfigure.h>

#include "nodelets/pipeline_fixture.h"

namespace recognition {
namespace {

class BadInputTest : public PipelineTest {
 protected:
  void SetUp() override {
    setParam("models", emptyFolder());  // the faster
    ASSERT_TRUE(load("segmentation"));
    segments_ = std::make_unique<Recorder<messages::Segmentation>>(node_, "segmentation/segmentation");
    waitForCamera();
  }

  void TearDown() override {
    if (!HasFatalFailure() && segments_) expectTheNextFrameGoesOn();
  }

  void expectTheNextFrameGoesOn() {
    for (int i = 0; i < 3; ++i) publish(withStamp(good_, ros::Time(3e9 + i)));
    EXPECT_TRUE(waitFor([this] {
      return segments_->at(ros::Time(3e9)) || segments_->at(ros::Time(3e9 + 1)) || segments_->at(ros::Time(3e9 + 2));
    }));
  }

  sensor_msgs::ImagePtr copyOf(const sensor_msgs::ImageConstPtr& image) {
    return boost::make_shared<sensor_msgs::Image>(*image);
  }

  const FrameMessages good_ = demoFrames().front();
  FrameMessages bad_ = good_;
  std::unique_ptr<Recorder<messages::Segmentation>> segments_;
};

/// One row of the table: what is done to a good frame, and what is told of it (nothing: it is taken).
struct Row {
  const char* name;
  std::function<void(sensor_msgs::Image& color, sensor_msgs::Image& depth, sensor_msgs::CameraInfo& info)> spoil;
  const char* told;
};

void setDepth(sensor_msgs::Image& depth, float value) {
  fillImage(cv::Mat(480, 640, CV_32FC1, cv::Scalar(value)), depth.header, &depth);
}

void padRows(sensor_msgs::Image& image) {
  std::vector<std::uint8_t> padded;
  for (std::uint32_t v = 0; v < image.height; ++v) {
    padded.insert(padded.end(), image.data.begin() + v * image.step, image.data.begin() + (v + 1) * image.step);
    padded.insert(padded.end(), 12, 0);
  }
  image.data = padded;
  image.step += 12;
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();

// clang-format off
const Row kRows[] = {
    {"colourMono", [](auto& color, auto&, auto&) { color.encoding = "mono8"; }, nullptr},
    {"colourBayer", [](auto& color, auto&, auto&) { color.encoding = "bayer_grbg8"; }, nullptr},
    {"colourWithoutEncoding", [](auto& color, auto&, auto&) { color.encoding = ""; }, "colour image has encoding ''"},
    {"colourOfNoSize", [](auto& color, auto&, auto&) { color.width = color.height = 0; }, "colour image has size 0x0"},
    {"colourHuge", [](auto& color, auto&, auto&) { color.width = 4000000000u; }, "implausible size"},
    {"colourCutShort", [](auto& color, auto&, auto&) { color.data.resize(1000); }, "1000 bytes, too few"},
    {"colourStepTooSmall", [](auto& color, auto&, auto&) { color.step = 640; }, "colour image has step 640"},
    {"colourEmpty", [](auto& color, auto&, auto&) { color.data.clear(); }, "0 bytes, too few"},
    {"depthAsColour", [](auto&, auto& depth, auto&) { depth.encoding = "rgb8"; }, "depth image has encoding 'rgb8'"},
    {"depthBigEndian", [](auto&, auto& depth, auto&) { depth.is_bigendian = 1; }, "big-endian"},
    {"depthOddStep", [](auto&, auto& depth, auto&) { depth.step += 1; }, "depth image has step"},
    {"depthCutShort", [](auto&, auto& depth, auto&) { depth.data.resize(7); }, "7 bytes, too few"},
    {"depthInAnotherFrame", [](auto&, auto& depth, auto&) { depth.header.frame_id = "ir"; }, "not registered"},
    {"colourWithoutFrame", [](auto& color, auto&, auto&) { color.header.frame_id = ""; }, "has no frame_id"},
    {"colourWithoutNamedFrame", [](auto& color, auto&, auto&) { color.header.frame_id = "/"; }, "has no frame_id"},
    {"infoWithoutP", [](auto&, auto&, auto& info) { info.P.fill(0.0); }, "not calibrated"},
    {"infoNan", [](auto&, auto&, auto& info) { info.P[2] = kNan; }, "not finite"},
    {"infoOfAnotherSize", [](auto&, auto&, auto& info) { info.width = 1280, info.height = 1024; }, "1280x1024"},
    {"infoHugeBinning", [](auto&, auto&, auto& info) { info.binning_x = 4000000000u; }, "binning 4000000000x"},
    {"depthNan", [](auto&, auto& depth, auto&) { setDepth(depth, kNan); }, "the depth image is empty"},
    {"depthInf", [](auto&, auto& depth, auto&) { setDepth(depth, kInf); }, "the depth image is empty"},
    {"depthZero", [](auto&, auto& depth, auto&) { setDepth(depth, 0.0f); }, "the depth image is empty"},
    {"depthNegative", [](auto&, auto& depth, auto&) { setDepth(depth, -1.0f); }, "the depth image is empty"},
    {"depthFar", [](auto&, auto& depth, auto&) { setDepth(depth, 1e30f); }, "the depth image is empty"},
    {"depthNear", [](auto&, auto& depth, auto&) { setDepth(depth, 1e-30f); }, "depth ends at"},
    {"colourPadded", [](auto& color, auto&, auto&) { padRows(color); }, nullptr},
    {"depthPadded", [](auto&, auto& depth, auto&) { padRows(depth); }, nullptr},
    {"depthFrameWithSlash", [](auto&, auto& depth, auto&) { depth.header.frame_id.insert(0, "/"); }, nullptr},
    {"colourFrameWithSlash", [](auto& color, auto&, auto&) { color.header.frame_id.insert(0, "//"); }, nullptr},
    {"depthMono16", [](auto&, auto& depth, auto&) { depth.encoding = "mono16"; }, nullptr},
};
// clang-format on

class ImageTable : public BadInputTest, public ::testing::WithParamInterface<Row> {};

TEST_P(ImageTable, isToldOrTaken) {
  const auto color = copyOf(good_.color), depth = copyOf(good_.depth);
  const auto info = boost::make_shared<sensor_msgs::CameraInfo>(*good_.camera_info);
  GetParam().spoil(*color, *depth, *info);
  publish({color, depth, info});
  if (GetParam().told)
    EXPECT_TRUE(diagnosed("segmentation", GetParam().told));
  else
    EXPECT_TRUE(waitFor([&] { return segments_->at(color->header.stamp) != nullptr; }));
}

INSTANTIATE_TEST_SUITE_P(Rows, ImageTable, ::testing::ValuesIn(kRows),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_F(BadInputTest, unknownEncoding) {
  const auto color = copyOf(good_.color);
  color->encoding = "yuv411";
  bad_.color = color;
  publish(bad_);
  EXPECT_TRUE(diagnosed("segmentation", "colour image has encoding 'yuv411'"));
  EXPECT_TRUE(diagnosed("segmentation", ns_ + "/rgb/image_rect_color"));
  EXPECT_TRUE(diagnosed("segmentation", "bad inputs=1"));
}

TEST_F(BadInputTest, depthOfAnotherSize) {
  bad_.depth = imageMessage(cv::Mat::ones(200, 300, CV_16UC1), good_.depth->header);
  publish(bad_);
  EXPECT_TRUE(diagnosed("segmentation", "300x200"));
}

TEST_F(BadInputTest, noDepth) {
  bad_.depth = nullptr;
  publish(bad_);
  EXPECT_TRUE(diagnosed("segmentation",
                        "no message, while others of the camera arrive [" + ns_ + "/depth_registered/image_raw]"));
}

TEST_F(BadInputTest, noCameraInfo) {
  camera_info_.shutdown();
  bad_.camera_info = nullptr;
  publish(bad_);
  EXPECT_TRUE(diagnosed("segmentation", "nobody publishes this topic [" + ns_ + "/rgb/camera_info]"));
  camera_info_ = node_.advertise<sensor_msgs::CameraInfo>("rgb/camera_info", 1);
  waitForCamera();
}

TEST_F(BadInputTest, stampsTooFarApart) {
  bad_.depth = withStamp(good_, good_.color->header.stamp + ros::Duration(0.5)).depth;
  publish(bad_);
  EXPECT_TRUE(diagnosed("segmentation", "stamps differ by more than"));
}

TEST_F(BadInputTest, aReasonStandsInFrontOfItsTopics) {
  const auto color = copyOf(good_.color);
  color->encoding = "yuv411";
  publish({color, good_.depth, good_.camera_info});
  EXPECT_TRUE(diagnosed("segmentation", "last bad input=colour image has encoding 'yuv411'"));
}

TEST_F(BadInputTest, resultsHaveNoLeadingSlash) {
  const auto color = copyOf(good_.color);
  color->header.frame_id = "/" + good_.color->header.frame_id;
  publish({color, good_.depth, good_.camera_info});
  ASSERT_TRUE(waitFor([&] { return segments_->at(color->header.stamp) != nullptr; }));
  EXPECT_EQ(segments_->at(color->header.stamp)->header.frame_id, good_.color->header.frame_id);
}

TEST_F(BadInputTest, aFrameThatIsDeliveredTwiceIsWorkedOnOnce) {
  publish(good_);
  publish(good_);
  ASSERT_TRUE(waitFor([&] { return segments_->count() > 0; }));
  expectTheNextFrameGoesOn();
  int times = 0;
  for (const auto& stamp : segments_->stamps()) times += stamp == good_.color->header.stamp;
  EXPECT_EQ(times, 1);
}

TEST_F(BadInputTest, emptyStore) { EXPECT_TRUE(diagnosed("segmentation", "no models loaded")); }

class ParameterTest : public PipelineTest {
 protected:
  void SetUp() override { setParam("models", emptyFolder()); }
};

TEST_F(ParameterTest, goodOnesLoad) {
  setParam("reprojection_verification/theta_c", 0.3);
  setParam("reprojection_verification/w", 3);
  EXPECT_TRUE(load("reprojection_verification"));
}

TEST_F(ParameterTest, misspelt) {
  setParam("reprojection_verification/theta", 0.3);
  EXPECT_FALSE(load("reprojection_verification"));
}

TEST_F(ParameterTest, ofTheWrongType) {
  setParam("reprojection_verification/theta_c", std::string("high"));
  EXPECT_FALSE(load("reprojection_verification"));
}

TEST_F(ParameterTest, outOfRange) {
  setParam("segmentation/erosion", 1000);
  EXPECT_FALSE(load("segmentation"));
}

TEST_F(ParameterTest, unknownChoice) {
  setParam("feature_extraction/descriptor", std::string("orb"));
  EXPECT_FALSE(load("feature_extraction"));
}

TEST_F(ParameterTest, oursOutOfRange) {
  setParam("segmentation/max_interval", -1.0);
  EXPECT_FALSE(load("segmentation"));
}

TEST_F(ParameterTest, oursOfTheWrongType) {
  setParam("segmentation/enabled", std::string("maybe"));
  EXPECT_FALSE(load("segmentation"));
  setParam("feature_extraction/lazy", std::string("very"));
  EXPECT_FALSE(load("feature_extraction"));
  setParam("hypothesis_generation/objects", std::string("box"));
  EXPECT_FALSE(load("hypothesis_generation"));
  setParam("reprojection_verification/target_frame", 7);
  EXPECT_FALSE(load("reprojection_verification"));
  setParam("tracking/fixed_frame", 7);
  EXPECT_FALSE(load("tracking"));
}

TEST_F(ParameterTest, anUnknownTransport) {
  setParam("segmentation/image_transport", std::string("carrier_pigeon"));
  EXPECT_FALSE(load("segmentation"));
}

TEST_F(ParameterTest, reconfiguredOutOfRangeIsRefusedAndNotMovedIntoIt) {
  ASSERT_TRUE(load("segmentation"));
  const auto set = [this](int erosion) {
    dynamic_reconfigure::Reconfigure call;
    call.request.config.ints.resize(1);
    call.request.config.ints.front().name = "erosion";
    call.request.config.ints.front().value = erosion;
    EXPECT_TRUE(ros::service::call(ns_ + "/segmentation/set_parameters", call));
    for (const auto& item : call.response.config.ints)
      if (item.name == "erosion") return item.value;
    return -1;
  };
  EXPECT_EQ(set(4), 4);
  EXPECT_EQ(set(1000), 4);
  EXPECT_EQ(set(5), 5);
}

TEST_F(ParameterTest, noModels) {
  ros::param::del(ns_ + "/models");
  EXPECT_FALSE(load("hypothesis_generation"));
  setParam("models", std::string("/no/such/folder"));
  EXPECT_FALSE(load("hypothesis_generation"));
}

class PointsTest : public PipelineTest {
 protected:
  void SetUp() override {
    ASSERT_TRUE(load("points_to_depth"));
    points_ =
        node_.advertise<sensor_msgs::PointCloud2>("points", 1);  // first: roscpp connects twice if both come at once
    depth_images_ = std::make_unique<Recorder<sensor_msgs::Image>>(node_, "points_to_depth/depth");
    ASSERT_TRUE(waitFor([this] { return points_.getNumSubscribers() == 1; }));
    cloud_ = boost::make_shared<sensor_msgs::PointCloud2>();
    cloud_->header.stamp = ros::Time(7.0);
    cloud_->width = 3, cloud_->height = 2, cloud_->point_step = 16, cloud_->row_step = 48;
    cloud_->data.resize(96);
    cloud_->fields.resize(1);
    cloud_->fields[0].name = "z", cloud_->fields[0].offset = 8,
    cloud_->fields[0].datatype = sensor_msgs::PointField::FLOAT32;
  }

  std::unique_ptr<Recorder<sensor_msgs::Image>> depth_images_;
  ros::Publisher points_;
  sensor_msgs::PointCloud2Ptr cloud_;
};

TEST_F(PointsTest, organisedCloudBecomesADepthImage) {
  points_.publish(cloud_);
  ASSERT_TRUE(waitFor([this] { return depth_images_->at(ros::Time(7.0)) != nullptr; }));
  EXPECT_EQ(depth_images_->at(ros::Time(7.0))->encoding, "32FC1");
  EXPECT_EQ(depth_images_->at(ros::Time(7.0))->width, 3u);
}

TEST_F(PointsTest, unorganisedCloudIsTold) {
  cloud_->width = 6, cloud_->height = 1, cloud_->row_step = 96;
  points_.publish(cloud_);
  EXPECT_TRUE(diagnosed("points_to_depth", "unorganised"));
  EXPECT_TRUE(diagnosed("points_to_depth", ns_ + "/points"));
}

}  // namespace
}  // namespace recognition

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "bad_input_test");
  const ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
