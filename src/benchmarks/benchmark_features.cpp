// SURF-128 and SURF-64 against OpenCV's SIFT and dlib's SURF: time for the same number of keypoints on one thread, and
// matching score.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#ifdef RGBD_WITH_DLIB
#include <dlib/array2d.h>
#include <dlib/image_keypoint.h>
#endif

#include "benchmarks/feature_pairs.h"
#include "features/feature_extractor.h"
#include "rgbd_recognition/features/feature_parameters.h"

namespace recognition {
namespace {

constexpr int kMaxWidth = 1280;
constexpr float kCorrect = 3.0f;  // pixels from the true place

struct Options {
  std::string images, models, summary;
  int pairs = 20;
  int features = 1000;
  int repeat = 5;
};

// Thresholds low enough that the number of keypoints decides.
FeatureParameters parametersOf(DescriptorType type, int features) {
  FeatureParameters parameters;
  parameters.descriptor = type;
  parameters.max_features = features;
  parameters.surf.hessian_threshold = 0.5;
  parameters.sift.contrast_threshold = 0.01;
  return parameters;
}

std::vector<cv::Mat> readPictures(const std::string& directory) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(directory))
    if (entry.path().extension() == ".png" || entry.path().extension() == ".jpg") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<cv::Mat> pictures;
  for (const auto& file : files) {
    cv::Mat picture = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
    if (picture.type() != CV_8UC3) continue;  // a depth image or a mask
    const double scale = std::min(1.0, static_cast<double>(kMaxWidth) / picture.cols);
    if (scale < 1.0) cv::resize(picture, picture, cv::Size(), scale, scale, cv::INTER_AREA);
    pictures.push_back(picture);
  }
  if (pictures.empty()) throw std::runtime_error(directory + " holds no colour images (.png, .jpg)");
  return pictures;
}

double threadSeconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Mean over the images of the least CPU time, milliseconds.
double timeOf(const std::vector<cv::Mat>& images, int repeat, const std::function<void(const cv::Mat&)>& work) {
  double sum = 0.0;
  for (const cv::Mat& image : images) {
    double least = 1e9;
    for (int i = 0; i < repeat; ++i) {
      const double start = threadSeconds();
      work(image);
      least = std::min(least, threadSeconds() - start);
    }
    sum += least;
  }
  return 1000.0 * sum / static_cast<double>(images.size());
}

double dlibTime(const std::vector<cv::Mat>& images, const Options& options) {
#ifdef RGBD_WITH_DLIB
  return timeOf(images, options.repeat, [&](const cv::Mat& image) {
    dlib::array2d<unsigned char> copy(image.rows, image.cols);
    for (int y = 0; y < image.rows; ++y) std::copy_n(image.ptr<uchar>(y), image.cols, &copy[y][0]);
    dlib::get_surf_points(copy, options.features, 5.0);
  });
#else
  (void)images, (void)options;
  return std::nan("");
#endif
}

struct Score {
  int seen = 0;     ///< features of the first picture whose place the second shows
  int correct = 0;  ///< of those, whose nearest neighbour lies there
  double share() const { return seen > 0 ? static_cast<double>(correct) / seen : 0.0; }
};

Score scoreOf(const std::vector<FeaturePair>& pairs, const FeatureExtractor& extractor) {
  Score score;
  for (const FeaturePair& pair : pairs) {
    const ImageFeatures first = extractor.extract(pair.first, pair.first_mask);
    const ImageFeatures second = extractor.extract(pair.second, pair.second_mask);
    if (first.count() == 0 || second.count() == 0) continue;
    const cv::Mat similarity = first.descriptors * second.descriptors.t();
    for (int i = 0; i < first.count(); ++i) {
      const Keypoint& keypoint = first.keypoints[i];
      const cv::Vec2f place = pair.place.at<cv::Vec2f>(cvRound(keypoint.y), cvRound(keypoint.x));
      if (std::isnan(place[0])) continue;
      const float* row = similarity.ptr<float>(i);
      const Keypoint& match = second.keypoints[std::max_element(row, row + second.count()) - row];
      ++score.seen;
      score.correct += std::hypot(match.x - place[0], match.y - place[1]) < kCorrect;
    }
  }
  return score;
}

nlohmann::json measure(const Options& options) {
  const std::vector<cv::Mat> pictures = readPictures(options.images);
  std::vector<cv::Mat> images(pictures.size());
  for (size_t i = 0; i < pictures.size(); ++i) cv::cvtColor(pictures[i], images[i], cv::COLOR_BGR2GRAY);
  const std::vector<FeaturePair> pairs =
      options.models.empty() ? warpedPairs(pictures, 1) : renderedPairs(options.models, options.pairs, {640, 480}, 1);

  nlohmann::json summary;
  std::printf("%-8s %8s %10s %8s %8s\n", "", "ms", "keypoints", "score", "correct");
  for (const DescriptorType type : {DescriptorType::kSurf128, DescriptorType::kSurf64, DescriptorType::kSift}) {
    const auto extractor = makeFeatureExtractor(parametersOf(type, options.features));
    size_t keypoints = 0;
    for (const cv::Mat& image : images) keypoints += extractor->extract(image, cv::Mat()).keypoints.size();
    const double ms =
        timeOf(images, options.repeat, [&](const cv::Mat& image) { extractor->extract(image, cv::Mat()); });
    const Score score = scoreOf(pairs, *extractor);
    const std::string name = descriptorName(type);
    summary[name + "_ms"] = ms;
    summary[name + "_matching_score"] = score.share();
    summary[name + "_correct_matches"] = score.correct;
    std::printf("%-8s %8.2f %10zu %8.3f %8d\n", name.c_str(), ms, keypoints / images.size(), score.share(),
                score.correct);
  }
  summary["dlib_surf_ms"] = dlibTime(images, options);
  summary["ratio_to_sift"] = summary["surf128_ms"].get<double>() / summary["sift_ms"].get<double>();
  std::printf("%-8s %8.2f\n", "dlib", summary["dlib_surf_ms"].get<double>());
  std::printf("SURF-128 takes %.3f of SIFT's time\n", summary["ratio_to_sift"].get<double>());
  return summary;
}

}  // namespace
}  // namespace recognition

int main(int argc, char** argv) {
  recognition::Options options;
  CLI::App app("Times SURF and SIFT on images, one thread, and scores their matches where the truth is known");
  app.add_option("--images", options.images, "Folder of colour images (searched recursively)")->required();
  app.add_option("--models", options.models, "BOP models folder for rendered pairs; without it the images are warped");
  app.add_option("--pairs", options.pairs, "Rendered pairs")->capture_default_str();
  app.add_option("--features", options.features, "Keypoints an image")->capture_default_str();
  app.add_option("--repeat", options.repeat, "Runs an image; the fastest counts")->capture_default_str();
  app.add_option("--summary", options.summary, "JSON file for the figures");
  CLI11_PARSE(app, argc, argv);
  try {
    cv::setNumThreads(1);
    const nlohmann::json summary = recognition::measure(options);
    if (!options.summary.empty() && !(std::ofstream(options.summary) << summary.dump(2) << "\n"))
      throw std::runtime_error(options.summary + " cannot be written");
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
