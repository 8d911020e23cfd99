#include "rgbd_recognition/segmentation/segmentation_parameters.h"

#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "refusal.h"

namespace recognition {
namespace {

TEST(SegmentationParameters, DefaultsAreValid) { EXPECT_NO_THROW(SegmentationParameters().validate()); }

TEST(SegmentationParameters, EveryNumberIsChecked) {
  for (size_t i = 0; i < SegmentationParameters().list().size(); ++i) {
    SegmentationParameters parameters;
    const Parameter p = parameters.list()[i];
    if (auto* const* value = std::get_if<int*>(&p.value))
      **value = static_cast<int>(p.min) - 1;
    else if (auto* const* number = std::get_if<double*>(&p.value))
      **number = std::numeric_limits<double>::quiet_NaN();
    else
      continue;
    EXPECT_THAT(refusal([&] { parameters.validate(); }), testing::HasSubstr("segmentation/" + p.name));
  }
}

TEST(SegmentationParameters, ModesHaveTheNamesOfTableTwo) {
  SegmentationParameters parameters;
  const Parameter mode = parameters.list()[0];
  setFromText(mode, "simple_linear", "segmentation");
  EXPECT_EQ(parameters.mode, SegmentationMode::kSimpleLinear);
  setFromText(mode, "ls_mixed", "segmentation");
  EXPECT_EQ(parameters.mode, SegmentationMode::kLsMixed);
  EXPECT_THROW(setFromText(mode, "fast", "segmentation"), std::invalid_argument);
}

}  // namespace
}  // namespace recognition
