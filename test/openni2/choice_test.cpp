#include <gtest/gtest.h>

#include <map>
#include <stdexcept>

#include "camera/openni2_choice.h"

namespace recognition {
namespace {

const std::vector<ListedDevice> kListed = {{"freenect:A1", "Kinect"}, {"1d27/0609@2/5", "PS1080"}};

std::string serialOf(const std::string& uri) {
  const std::map<std::string, std::string> serials = {
      {"freenect:A1", "A1"}, {"1d27/0609@2/5", "P7"}, {"1d27/0609@2/9", "P7"}};
  return serials.at(uri);
}

std::string noSerialNeeded(const std::string& uri) {
  ADD_FAILURE() << "asked for the serial number of " << uri;
  return "";
}

TEST(DeviceChoice, ByIndex) {
  EXPECT_EQ("freenect:A1", DeviceChoice("").find(kListed, noSerialNeeded));
  EXPECT_EQ("freenect:A1", DeviceChoice("#1").find(kListed, noSerialNeeded));
  EXPECT_EQ("1d27/0609@2/5", DeviceChoice("#2").find(kListed, noSerialNeeded));
  EXPECT_EQ("", DeviceChoice("#3").find(kListed, noSerialNeeded));
  EXPECT_EQ("", DeviceChoice("").find({}, noSerialNeeded));
}

TEST(DeviceChoice, RefusesNoNumber) {
  for (const char* text : {"#", "#0", "#-1", "#first", "#1000000000000"}) {
    EXPECT_THROW(DeviceChoice{text}, std::invalid_argument) << text;
  }
}

TEST(DeviceChoice, ByUriOnlyWhileItIsThere) {
  EXPECT_EQ("1d27/0609@2/5", DeviceChoice("1d27/0609@2/5").find(kListed, noSerialNeeded));
  EXPECT_EQ("", DeviceChoice("freenect:B2").find(kListed, noSerialNeeded));
}

TEST(DeviceChoice, BySerial) {
  EXPECT_EQ("1d27/0609@2/5", DeviceChoice("P7").find(kListed, serialOf));
  EXPECT_EQ("", DeviceChoice("P8").find(kListed, serialOf));
}

TEST(DeviceChoice, FilesAndRecordingsNeedNoListing) {
  EXPECT_EQ("/tmp/a.oni", DeviceChoice("/tmp/a.oni").find({}, noSerialNeeded));
  EXPECT_EQ("virtual:/tmp/scene", DeviceChoice("virtual:/tmp/scene").find({}, noSerialNeeded));
}

TEST(DeviceChoice, FindsTheRememberedDeviceAtAnotherPort) {
  DeviceChoice by_uri("1d27/0609@2/5");
  by_uri.remember("P7");
  const std::vector<ListedDevice> moved = {{"freenect:A1", "Kinect"}, {"1d27/0609@2/9", "PS1080"}};
  EXPECT_EQ("1d27/0609@2/9", by_uri.find(moved, serialOf));
  EXPECT_EQ("", by_uri.find({{"freenect:A1", "Kinect"}}, serialOf));  // not just any other

  DeviceChoice first("");
  first.remember("P7");
  EXPECT_EQ("1d27/0609@2/9", first.find(moved, serialOf));
  EXPECT_EQ("freenect:A1", first.find({{"freenect:A1", "Kinect"}}, serialOf));
}

}  // namespace
}  // namespace recognition
