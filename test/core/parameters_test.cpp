#include "rgbd_recognition/core/parameters.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "refusal.h"

namespace recognition {
namespace {

enum class Fruit { kApple, kPear };

struct Sample {
  bool flag = true;
  int count = 3;
  double length = 0.5;
  Fruit fruit = Fruit::kApple;
  ParameterList list() {
    return {boolParameter("flag", &flag, "a flag"), intParameter("count", "px", &count, 1, 9, "a count"),
            doubleParameter("length", "m", &length, 0.0, 1.0, "a length"),
            choiceParameter("fruit", &fruit, {"apple", "pear"}, "a choice")};
  }
};

std::string messageOf(const Parameter& parameter, const std::string& text) {
  return refusal([&] { setFromText(parameter, text, "group"); });
}

TEST(Parameters, TextRoundTrip) {
  Sample sample;
  const ParameterList list = sample.list();
  const char* texts[] = {"false", "7", "0.25", "pear"};
  for (size_t i = 0; i < list.size(); ++i) {
    setFromText(list[i], texts[i], "group");
    EXPECT_EQ(valueText(list[i]), texts[i]);
  }
  EXPECT_EQ(sample.fruit, Fruit::kPear);
}

TEST(Parameters, RejectionsNameFieldAndValue) {
  Sample sample;
  const ParameterList list = sample.list();
  EXPECT_THAT(messageOf(list[0], "yes"), testing::AllOf(testing::HasSubstr("group/flag"), testing::HasSubstr("yes")));
  EXPECT_THAT(messageOf(list[1], "2.5"), testing::HasSubstr("whole number"));
  EXPECT_THAT(messageOf(list[1], "10"), testing::AllOf(testing::HasSubstr("[1, 9] px"), testing::HasSubstr("10")));
  EXPECT_THAT(messageOf(list[2], "nan"), testing::HasSubstr("group/length"));
  EXPECT_THAT(messageOf(list[2], "0.1x"), testing::HasSubstr("not a number"));
  EXPECT_THAT(messageOf(list[3], "plum"), testing::HasSubstr("apple pear"));
}

TEST(Parameters, ValidateFindsOutOfRange) {
  Sample sample;
  EXPECT_NO_THROW(validateParameters(sample.list(), "group"));
  sample.length = 1.5;
  EXPECT_THROW(validateParameters(sample.list(), "group"), std::invalid_argument);
}

}  // namespace
}  // namespace recognition
