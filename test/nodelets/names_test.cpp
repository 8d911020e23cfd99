// Names of tf frames and paths as messages tell them.
#include <cstdlib>
#include <filesystem>

#include <boost/make_shared.hpp>
#include <gtest/gtest.h>

#include "ros/absolute_path.h"
#include "ros/frame_names.h"
#include "ros/target_frame.h"

namespace recognition {
namespace {

TEST(PlainFrame, hasNoLeadingSlash) {
  EXPECT_EQ(plainFrame("camera"), "camera");
  EXPECT_EQ(plainFrame("/camera"), "camera");
  EXPECT_EQ(plainFrame("//robot/camera"), "robot/camera");
  EXPECT_EQ(plainFrame("/"), "");
  EXPECT_EQ(plainFrame(""), "");
}

TEST(WithPlainFrame, copiesOnlyWhatHasASlash) {
  const auto plain = boost::make_shared<sensor_msgs::Image>(), slashed = boost::make_shared<sensor_msgs::Image>();
  plain->header.frame_id = "camera";
  slashed->header.frame_id = "/camera";
  slashed->data.assign(3, 7);
  EXPECT_EQ(withPlainFrame(plain), plain);
  EXPECT_EQ(withPlainFrame(slashed)->header.frame_id, "camera");
  EXPECT_EQ(withPlainFrame(slashed)->data, slashed->data);
}

TEST(TargetFrame, isTheCamerasWhateverTheSlashes) {
  std_msgs::Header header;
  header.frame_id = "/optical";
  const TargetFrame target("");
  EXPECT_TRUE(target.isCamera(header));
  EXPECT_EQ(target.nameFor(header), "optical");
}

TEST(AbsolutePath, isBelowTheFolderOrHome) {
  const std::string home = std::getenv("HOME");
  EXPECT_EQ(absolutePath("/store", "/shell"), "/store");
  EXPECT_EQ(absolutePath("turn.bag", "/shell"), "/shell/turn.bag");
  EXPECT_EQ(absolutePath("../turn.bag", "/shell"), "/turn.bag");
  EXPECT_EQ(absolutePath("~/models", "/shell"), std::filesystem::path(home + "/models").lexically_normal());
  EXPECT_EQ(absolutePath("turn.bag"), (std::filesystem::current_path() / "turn.bag").string());
  EXPECT_EQ(absolutePath("", "/shell"), "");
}

}  // namespace
}  // namespace recognition
