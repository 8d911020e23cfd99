#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "features/feature_extractor.h"
#include "synthetic_image.h"
#include "rgbd_recognition/features/feature_parameters.h"

namespace recognition {
namespace {

ImageFeatures extract(const cv::Mat& image, const FeatureParameters& parameters) {
  return makeFeatureExtractor(parameters)->extract(image, cv::Mat());
}

FeatureParameters surf(DescriptorType type) {
  FeatureParameters parameters;
  parameters.descriptor = type;
  return parameters;
}

// Share of the first's features, of those whose mapped place is well inside the second, with their nearest descriptor
// within 2 pixels of it.
double matchingScore(const ImageFeatures& first, const ImageFeatures& second, const cv::Matx23d& motion,
                     cv::Size size) {
  const cv::Mat similarity = first.descriptors * second.descriptors.t();
  int seen = 0, correct = 0;
  for (int i = 0; i < first.count(); ++i) {
    const cv::Vec2d place = motion * cv::Vec3d(first.keypoints[i].x, first.keypoints[i].y, 1.0);
    if (place[0] < 20 || place[1] < 20 || place[0] > size.width - 20 || place[1] > size.height - 20) continue;
    const float* row = similarity.ptr<float>(i);
    const Keypoint& match = second.keypoints[std::max_element(row, row + second.count()) - row];
    ++seen;
    correct += std::hypot(match.x - place[0], match.y - place[1]) < 2.0;
  }
  return seen > 0 ? static_cast<double>(correct) / seen : 0.0;
}

double scoreAfter(double degrees, double scale, DescriptorType type) {
  const cv::Mat image = texturedImage({320, 240}, 11);
  const cv::Mat motion = cv::getRotationMatrix2D(cv::Point2f(159.5f, 119.5f), degrees, scale);
  cv::Mat moved;
  cv::warpAffine(image, moved, motion, image.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
  FeatureParameters strongest = surf(type);
  strongest.max_features = 300;
  return matchingScore(extract(image, strongest), extract(moved, surf(type)), cv::Matx23d(motion), image.size());
}

struct Blob {
  double x, y, sigma, contrast;
};

class BlobTest : public testing::TestWithParam<std::tuple<Blob, bool>> {};

// Derivatives of a Gaussian answer strongest at the blob's own sigma, size 9 / 1.2 sigma; box filters at 0.7 to 0.9 of
// that.
TEST_P(BlobTest, IsFoundWhereItIs) {
  const auto& [blob, doubled] = GetParam();
  FeatureParameters parameters = surf(DescriptorType::kSurf128);
  parameters.surf.double_below_width = doubled ? 1000 : 0;
  const ImageFeatures features = extract(blobImage({200, 160}, blob.x, blob.y, blob.sigma, blob.contrast), parameters);
  ASSERT_GE(features.count(), 1);
  const Keypoint& strongest = features.keypoints[0];
  EXPECT_NEAR(strongest.x, blob.x, 0.15);
  EXPECT_NEAR(strongest.y, blob.y, 0.15);
  EXPECT_NEAR(strongest.size / (7.5 * blob.sigma), 0.8, 0.12);
  EXPECT_EQ(strongest.bright, blob.contrast > 0);
}

INSTANTIATE_TEST_SUITE_P(Surf, BlobTest,
                         testing::Combine(testing::Values(Blob{100, 80, 3, 100}, Blob{90.3, 70.6, 4, -80},
                                                          Blob{110.5, 84.25, 6, 60}, Blob{100.2, 79.5, 9, 120}),
                                          testing::Bool()));

TEST(Surf, SizeGrowsWithTheBlob) {
  double last = 0.0;
  for (double sigma : {2.0, 3.0, 4.5, 6.75, 10.0}) {
    const ImageFeatures features = extract(blobImage({240, 240}, 120, 120, sigma, 100), surf(DescriptorType::kSurf128));
    ASSERT_GE(features.count(), 1) << sigma;
    EXPECT_GT(features.keypoints[0].size, 1.2 * last) << sigma;
    last = features.keypoints[0].size;
  }
}

class SurfInvariance : public testing::TestWithParam<DescriptorType> {};

TEST_P(SurfInvariance, Rotation) {
  for (double degrees : {30.0, 90.0, 145.0}) EXPECT_GT(scoreAfter(degrees, 1.0, GetParam()), 0.65) << degrees;
}

TEST_P(SurfInvariance, Scale) {
  for (double scale : {0.75, 1.3, 1.8}) EXPECT_GT(scoreAfter(0.0, scale, GetParam()), 0.6) << scale;
}

TEST_P(SurfInvariance, OrientationTurnsWithTheImage) {
  const cv::Mat image = texturedImage({240, 240}, 12);
  cv::Mat turned;
  cv::rotate(image, turned, cv::ROTATE_90_CLOCKWISE);  // (x, y) -> (239 - y, x): angles grow by 90 degrees
  const ImageFeatures first = extract(image, surf(GetParam())), second = extract(turned, surf(GetParam()));
  int found = 0, right = 0;
  for (const Keypoint& a : first.keypoints)
    for (const Keypoint& b : second.keypoints) {
      if (std::hypot(b.x - (239 - a.y), b.y - a.x) > 0.2 || std::abs(b.size / a.size - 1.0) > 0.02) continue;
      ++found;
      right += std::abs(std::remainder(b.angle - a.angle - CV_PI / 2, 2 * CV_PI)) < 0.05;
    }
  ASSERT_GT(found, first.count() / 2);
  EXPECT_GT(right, 0.9 * found);
}

TEST_P(SurfInvariance, BrightnessAndContrast) {
  const cv::Mat image = texturedImage({320, 240}, 13);
  cv::Mat brighter, flatter;
  image.convertTo(brighter, CV_8U, 1.0, 15.0);
  image.convertTo(flatter, CV_8U, 0.6, 20.0);
  FeatureParameters parameters = surf(GetParam());
  parameters.max_features = 300;
  const ImageFeatures first = extract(image, parameters);
  const cv::Matx23d still(1, 0, 0, 0, 1, 0);
  const ImageFeatures shifted = extract(brighter, parameters);
  ASSERT_EQ(shifted.count(), first.count());
  EXPECT_LT(cv::norm(shifted.descriptors, first.descriptors, cv::NORM_INF), 1e-5);  // no level saturates
  EXPECT_GT(matchingScore(first, extract(flatter, parameters), still, image.size()), 0.95);
}

TEST_P(SurfInvariance, NoiseMovesDescriptorsLittle) {
  const cv::Mat image = texturedImage({320, 240}, 14);
  cv::Mat noise(image.size(), CV_16SC1), noisy;
  cv::RNG random(3);
  random.fill(noise, cv::RNG::NORMAL, 0.0, 5.0);
  cv::add(image, noise, noisy, cv::noArray(), CV_8U);
  const cv::Matx23d still(1, 0, 0, 0, 1, 0);
  EXPECT_GT(matchingScore(extract(image, surf(GetParam())), extract(noisy, surf(GetParam())), still, image.size()),
            0.8);
}

INSTANTIATE_TEST_SUITE_P(Surf, SurfInvariance, testing::Values(DescriptorType::kSurf128, DescriptorType::kSurf64),
                         [](const auto& info) { return std::string(descriptorName(info.param)); });

TEST(Surf, UprightHasNoAngle) {
  FeatureParameters parameters = surf(DescriptorType::kSurf64);
  parameters.surf.upright = true;
  for (const Keypoint& keypoint : extract(texturedImage({160, 120}, 15), parameters).keypoints)
    EXPECT_EQ(keypoint.angle, 0.0f);
}

// The plain descriptor's entries are sums of the extended one's: dx of both signs of dy, and so on.
TEST(Surf, ExtendedSplitsThePlainSums) {
  const cv::Mat image = texturedImage({200, 160}, 16);
  const ImageFeatures plain = extract(image, surf(DescriptorType::kSurf64));
  const ImageFeatures extended = extract(image, surf(DescriptorType::kSurf128));
  ASSERT_EQ(plain.count(), extended.count());
  for (int i = 0; i < plain.count(); ++i) {
    cv::Mat joined(1, 64, CV_32FC1);
    const float* e = extended.descriptors.ptr<float>(i);
    for (int cell = 0; cell < 16; ++cell, e += 8) {
      const float sums[] = {e[0] + e[2], e[4] + e[6], e[1] + e[3], e[5] + e[7]};
      std::copy_n(sums, 4, joined.ptr<float>() + 4 * cell);
    }
    joined /= cv::norm(joined);
    EXPECT_LT(cv::norm(joined, plain.descriptors.row(i), cv::NORM_INF), 1e-4);
  }
}

TEST(Surf, PaperSettingsWork) {
  FeatureParameters parameters = surf(DescriptorType::kSurf128);
  parameters.surf.double_below_width = 0;
  parameters.surf.overlap = false;
  parameters.surf.layers = 2;
  const ImageFeatures features = extract(texturedImage({320, 240}, 17), parameters);
  ASSERT_GT(features.count(), 100);
  for (int i = 0; i < features.count(); ++i) EXPECT_NEAR(cv::norm(features.descriptors.row(i)), 1.0, 1e-5);
}

}  // namespace
}  // namespace recognition
