#include "alignment/illumination.h"

#include <random>

#include <gtest/gtest.h>

namespace recognition {
namespace {

constexpr float kBlack = ColorTransform::kBlack;

std::vector<ColorPair> pairsUnder(const ColorTransform& illumination, int count, double noise) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> l(15, 85), ab(-50, 50);
  std::normal_distribution<float> error(0.0f, static_cast<float>(noise));
  std::vector<ColorPair> pairs;
  for (int i = 0; i < count; ++i) {
    const cv::Vec3f c(l(random), ab(random), ab(random));
    pairs.push_back({c, illumination(c) + cv::Vec3f(error(random), error(random), error(random))});
  }
  return pairs;
}

ColorTransform brighter() {
  ColorTransform illumination;
  illumination.a(0, 0) = 1.2f;
  illumination.b = {8.0f, -3.0f, 6.0f};
  illumination.a(1, 1) = illumination.a(2, 2) = 0.8f;
  return illumination;
}

TEST(ColorTransform, RecoversTheLight) {
  const ColorTransform fitted = fitColorTransform(pairsUnder(brighter(), 500, 4.0));
  for (const cv::Vec3f& c : {cv::Vec3f(30, 10, -20), cv::Vec3f(70, -30, 20)})
    EXPECT_LT(cv::norm(fitted(c) - brighter()(c)), 3.0);
}

TEST(ColorTransform, OutliersDoNotDecide) {
  std::vector<ColorPair> pairs = pairsUnder(brighter(), 500, 4.0);
  for (size_t i = 0; i < pairs.size(); i += 4) pairs[i].scene = {95, 0, 0};
  const ColorTransform fitted = fitColorTransform(pairs);
  EXPECT_LT(cv::norm(fitted(cv::Vec3f(40, 20, -10)) - brighter()(cv::Vec3f(40, 20, -10))), 5.0);
}

TEST(ColorTransform, AUniformColourCannotBecomeAnother) {
  const std::vector<ColorPair> red_on_green(300, ColorPair{{50, 60, 40}, {50, -60, 40}});
  const cv::Vec3f turned = fitColorTransform(red_on_green)({50, 60, 40});
  EXPECT_GT(cv::norm(turned - cv::Vec3f(50, -60, 40)), 60.0);
}

// A box of one colour whose top faces the lamp.
TEST(ColorTransform, OneSideMayBeBrighter) {
  const Eigen::Vector3f top = Eigen::Vector3f::UnitZ(), front = -Eigen::Vector3f::UnitY();
  std::vector<ColorPair> pairs;
  for (int i = 0; i < 200; ++i) {
    const float l = 30.0f + 0.2f * static_cast<float>(i);
    pairs.push_back({{l, 5, 5}, {1.15f * (l + kBlack) - kBlack, 5, 5}, top});
    pairs.push_back({{l, 5, 5}, {0.85f * (l + kBlack) - kBlack, 5, 5}, front});
  }
  const ColorTransform fitted = fitColorTransform(pairs);
  EXPECT_NEAR(fitted({50, 5, 5}, top)[0], 1.15f * (50 + kBlack) - kBlack, 2.0f);
  EXPECT_NEAR(fitted({50, 5, 5}, front)[0], 0.85f * (50 + kBlack) - kBlack, 2.0f);
  EXPECT_NEAR(fitted({50, 5, 5}, top)[1], 5.0f, 1.0f);
}

TEST(ColorTransform, IdentityWithoutPairs) { EXPECT_EQ(fitColorTransform({})({12, 3, -4}), cv::Vec3f(12, 3, -4)); }

TEST(ColorTransform, LightnessAloneIsFittedLikeColoursWithoutChroma) {
  std::vector<ColorPair> pairs = pairsUnder(brighter(), 203, 4.0);
  for (size_t i = 0; i < pairs.size(); i += 5) pairs[i].scene[0] = 95.0f;
  std::vector<float> model, scene;
  for (ColorPair& pair : pairs) {
    pair.model[1] = pair.model[2] = pair.scene[1] = pair.scene[2] = 0.0f;
    model.push_back(pair.model[0]);
    scene.push_back(pair.scene[0]);
  }
  const ColorTransform of_colors = fitColorTransform(pairs);
  const LightnessTransform illumination = fitLightness(model, scene);
  EXPECT_NEAR(illumination.gain, of_colors.a(0, 0), 1e-4);
  EXPECT_NEAR(illumination.offset, of_colors.b[0], 1e-3);
}

TEST(ColorTransform, NoLightnessNoChange) {
  EXPECT_EQ(fitLightness({}, {}).gain, 1.0f);
  EXPECT_EQ(fitLightness({}, {}).offset, 0.0f);
}

}  // namespace
}  // namespace recognition
