#include "features/feature_extractor.h"

#include <gtest/gtest.h>

#include <opencv2/core/utility.hpp>
#include <stdexcept>
#include <string>

#include "synthetic_image.h"
#include "rgbd_recognition/features/feature_parameters.h"

namespace recognition {
namespace {

class EachDescriptor : public testing::TestWithParam<DescriptorType> {
 protected:
  FeatureParameters parameters() const {
    FeatureParameters parameters;
    parameters.descriptor = GetParam();
    return parameters;
  }
};

TEST_P(EachDescriptor, RowsAreOfUnitLength) {
  const ImageFeatures features = makeFeatureExtractor(parameters())->extract(texturedImage({320, 240}, 1), cv::Mat());
  ASSERT_GT(features.count(), 100);
  ASSERT_EQ(features.descriptors.rows, features.count());
  ASSERT_EQ(features.descriptors.cols, descriptorLength(GetParam()));
  EXPECT_EQ(features.type, GetParam());
  for (int i = 0; i < features.count(); ++i) EXPECT_NEAR(cv::norm(features.descriptors.row(i)), 1.0, 1e-5);
}

TEST_P(EachDescriptor, SameBytesForAnyNumberOfThreads) {
  const cv::Mat image = texturedImage({320, 240}, 2);
  const auto extractor = makeFeatureExtractor(parameters());
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const ImageFeatures one = extractor->extract(image, cv::Mat());
  for (int n : {2, 8}) {
    cv::setNumThreads(n);
    const ImageFeatures many = extractor->extract(image, cv::Mat());
    ASSERT_EQ(many.count(), one.count());
    for (int i = 0; i < one.count(); ++i) EXPECT_EQ(many.keypoints[i].x, one.keypoints[i].x);
    EXPECT_EQ(cv::norm(many.descriptors, one.descriptors, cv::NORM_INF), 0.0);
  }
  cv::setNumThreads(threads);
}

TEST_P(EachDescriptor, OnlyInsideTheMask) {
  const cv::Mat image = texturedImage({320, 240}, 3);
  cv::Mat mask(image.size(), CV_8UC1, cv::Scalar(0));
  mask(cv::Rect(100, 60, 80, 90)).setTo(255);
  const ImageFeatures features = makeFeatureExtractor(parameters())->extract(image, mask);
  ASSERT_GT(features.count(), 10);
  for (const Keypoint& keypoint : features.keypoints)
    EXPECT_NE(mask.at<uchar>(cvRound(keypoint.y), cvRound(keypoint.x)), 0);
}

TEST_P(EachDescriptor, StrongestAreKept) {
  const cv::Mat image = texturedImage({320, 240}, 4);
  FeatureParameters few = parameters();
  few.max_features = 50;
  const ImageFeatures all = makeFeatureExtractor(parameters())->extract(image, cv::Mat());
  const ImageFeatures kept = makeFeatureExtractor(few)->extract(image, cv::Mat());
  ASSERT_EQ(kept.count(), 50);
  for (int i = 0; i < kept.count(); ++i) EXPECT_EQ(kept.keypoints[i].response, all.keypoints[i].response);
}

TEST_P(EachDescriptor, FlatOrTinyImagesGiveNothing) {
  const auto extractor = makeFeatureExtractor(parameters());
  EXPECT_EQ(extractor->extract(cv::Mat(120, 160, CV_8UC1, cv::Scalar(90)), cv::Mat()).count(), 0);
  EXPECT_NO_THROW(extractor->extract(texturedImage({5, 4}, 5), cv::Mat()));
}

TEST_P(EachDescriptor, RejectsWrongImages) {
  const auto extractor = makeFeatureExtractor(parameters());
  EXPECT_THROW(extractor->extract(cv::Mat(), cv::Mat()), std::invalid_argument);
  EXPECT_THROW(extractor->extract(cv::Mat(9, 9, CV_8UC3), cv::Mat()), std::invalid_argument);
  EXPECT_THROW(extractor->extract(cv::Mat(9, 9, CV_8UC1), cv::Mat(8, 9, CV_8UC1)), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(Features, EachDescriptor,
                         testing::Values(DescriptorType::kSurf128, DescriptorType::kSurf64, DescriptorType::kSift),
                         [](const auto& info) { return std::string(descriptorName(info.param)); });

TEST(FeatureParameters, OutOfRangeIsNamed) {
  FeatureParameters parameters;
  parameters.max_features = -1;
  EXPECT_THROW(makeFeatureExtractor(parameters), std::invalid_argument);
}

TEST(FeatureTypes, NamesRoundTrip) {
  for (const DescriptorType type : {DescriptorType::kSurf128, DescriptorType::kSurf64, DescriptorType::kSift})
    EXPECT_EQ(descriptorFromName(descriptorName(type)), type);
  EXPECT_THROW(descriptorFromName("orb"), std::invalid_argument);
}

}  // namespace
}  // namespace recognition
