// Each .cfg holds what the core's list holds. After a change: parameter_table --update .
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rgbd_recognition/FeatureExtractionConfig.h>
#include <rgbd_recognition/HypothesisGenerationConfig.h>
#include <rgbd_recognition/ReprojectionVerificationConfig.h>
#include <rgbd_recognition/SegmentationConfig.h>
#include <yaml-cpp/yaml.h>

#include "rgbd_recognition/recognizer.h"
#include "ros/parameters.h"
#include "rgbd_recognition/features/feature_parameters.h"

namespace recognition {
namespace {

std::map<std::string, std::string> texts(const dynamic_reconfigure::Config& config) {
  std::map<std::string, std::string> values;
  for (const auto& item : config.bools) values[item.name] = item.value ? "true" : "false";
  for (const auto& item : config.ints) values[item.name] = std::to_string(item.value);
  for (const auto& item : config.doubles) values[item.name] = cv::format("%.9g", item.value);
  for (const auto& item : config.strs) values[item.name] = item.value;
  return values;
}

template <typename Config, typename Parameters>
void expectSame() {
  Parameters parameters;
  const ParameterList list = parameters.list();
  dynamic_reconfigure::Config standard, least, most;
  Config::__getDefault__().__toMessage__(standard);
  Config::__getMin__().__toMessage__(least);
  Config::__getMax__().__toMessage__(most);
  EXPECT_EQ(texts(standard), texts(configMessage(list)));
  const auto minima = texts(least), maxima = texts(most);
  for (const Parameter& p : list) {
    SCOPED_TRACE(p.name);
    ASSERT_EQ(minima.count(p.name), 1u);
    if (std::holds_alternative<int*>(p.value) || std::holds_alternative<double*>(p.value)) {
      EXPECT_NEAR(std::stod(minima.at(p.name)), p.min, 1e-8 * std::abs(p.min));
      EXPECT_NEAR(std::stod(maxima.at(p.name)), p.max, 1e-8 * std::abs(p.max));
    }
    for (const auto& description : Config::__getDescriptionMessage__().groups.at(0).parameters) {
      if (description.name != p.name) continue;
      for (const std::string& choice : p.choices)
        EXPECT_THAT(description.edit_method, ::testing::HasSubstr("'" + choice + "'"));
    }
  }
}

TEST(Cfg, holdsTheCoresParameters) {
  expectSame<rgbd_recognition::SegmentationConfig, SegmentationParameters>();
  expectSame<rgbd_recognition::FeatureExtractionConfig, FeatureParameters>();
  expectSame<rgbd_recognition::HypothesisGenerationConfig, MatchingParameters>();
  expectSame<rgbd_recognition::ReprojectionVerificationConfig, VerificationParameters>();
}

/// Values of group/name that default.yaml and advanced.yaml hold together.
std::map<std::string, std::string> shippedValues() {
  std::map<std::string, std::string> values;
  for (const char* name : {"default.yaml", "advanced.yaml"}) {
    for (const auto& group : YAML::LoadFile(std::string(RGBD_SOURCE_DIR "/config/") + name)) {
      for (const auto& entry : group.second) {
        const std::string key = group.first.as<std::string>() + "/" + entry.first.as<std::string>();
        EXPECT_TRUE(values.emplace(key, entry.second.as<std::string>()).second) << key << " stands in both files";
      }
    }
  }
  return values;
}

TEST(ShippedYaml, holdsEachOfTheCoresParametersOnceWithItsDefault) {
  std::map<std::string, std::string> values = shippedValues();
  RecognizerParameters standard;
  for (const auto& [group, list] : standard.groups()) {
    for (const Parameter& p : list) {
      EXPECT_EQ(values[group + "/" + p.name], valueText(p)) << group << "/" << p.name;
      values.erase(group + "/" + p.name);
    }
  }
  EXPECT_THAT(values, ::testing::IsEmpty());
}

TEST(ShippedYaml, changesNothingWhereverItIsLoaded) {
  RecognizerParameters standard;
  const auto expected = standard.groups();
  for (const char* name : {"default.yaml", "advanced.yaml"}) {
    RecognizerParameters read = RecognizerParameters::fromYaml(std::string(RGBD_SOURCE_DIR "/config/") + name);
    const auto groups = read.groups();
    for (size_t g = 0; g < groups.size(); ++g)
      for (size_t i = 0; i < groups[g].second.size(); ++i)
        EXPECT_EQ(valueText(groups[g].second[i]), valueText(expected[g].second[i])) << groups[g].second[i].name;
  }
}

TEST(ShippedYaml, showsAUserAboutADozenValues) {
  int count = 0;
  for (const auto& group : YAML::LoadFile(RGBD_SOURCE_DIR "/config/default.yaml"))
    count += static_cast<int>(group.second.size());
  EXPECT_GE(count, 9);
  EXPECT_LE(count, 15);
}

struct Sample {
  bool flag = false;
  int count = 3;
  double length = 0.5;
  enum class Kind { kFirst, kSecond } kind = Kind::kFirst;

  ParameterList list() {
    return {boolParameter("flag", &flag, ""), intParameter("count", "", &count, 0, 10, ""),
            doubleParameter("length", "m", &length, 0.0, 1.0, ""),
            choiceParameter("kind", &kind, {"first", "second"}, "")};
  }
};

TEST(ApplyConfig, setsWhatAnotherListHolds) {
  Sample from, to;
  from.flag = true, from.count = 7, from.length = 0.1 + 0.2, from.kind = Sample::Kind::kSecond;
  applyConfig(configMessage(from.list()), to.list(), "sample");
  EXPECT_TRUE(to.flag);
  EXPECT_EQ(to.count, 7);
  EXPECT_EQ(to.length, 0.1 + 0.2);
  EXPECT_EQ(to.kind, Sample::Kind::kSecond);
}

TEST(ApplyConfig, refusesWhatIsOutOfRange) {
  Sample from, to;
  from.count = 11;
  EXPECT_THROW(applyConfig(configMessage(from.list()), to.list(), "sample"), std::invalid_argument);
}

}  // namespace
}  // namespace recognition
