#include "ros/why_picture.h"

#include <algorithm>
#include <map>
#include <string>

#include <opencv2/imgproc.hpp>

#include "rgbd_recognition/annotation.h"
#include "ros/detection_output.h"

namespace recognition {
namespace {

constexpr size_t kMaxDrawn = 3;         // of the rejected; more would hide what they are drawn on
constexpr size_t kMaxLines = 10;        // for the rejected
constexpr double kWorthTelling = 0.05;  // confidence of a second pose of an object that was found
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
const cv::Scalar kFeatureColor(120, 255, 255), kTextColor(235, 235, 235), kGround(24, 24, 24);
const cv::Vec3b kSegmentColor(255, 255, 255);

struct Line {
  std::string text;
  cv::Scalar color;
};

const std::string& nameOf(const FrameAnswer& answer, int object) {
  return answer.database.objects.at(static_cast<size_t>(object))->name;
}

std::string meaningOf(const VerifiedHypothesis& hypothesis) {
  switch (hypothesis.rejection) {
    case Rejection::kExplained:
      return "its features belong to " + (hypothesis.conflict_with.empty() ? "others" : hypothesis.conflict_with);
    case Rejection::kBudget:
      return "no time was left for it";
    case Rejection::kProbe:
      return "depth has another shape";
    case Rejection::kOutOfView:
      return "outside of the image";
    case Rejection::kTooLittleSeen:
      return "something is in front of it";
    case Rejection::kFreeSpace:
      return "the camera sees through it";
    case Rejection::kConsensus:
      return "too few features agree";
    case Rejection::kBound:
    case Rejection::kCoarse:
      return "too little likeness";
    case Rejection::kIndistinct:
      return "fits as well beside this place";
    case Rejection::kConsistency:
      return "colour, depth or segment agree too little";
    case Rejection::kConflict:
      return hypothesis.conflict_with + " fits better";
    default:
      return {};
  }
}

bool isNearer(const VerifiedHypothesis& a, const VerifiedHypothesis& b) {
  return a.confidence != b.confidence ? a.confidence > b.confidence : a.level > b.level;
}

/// The object was found, in about this place or without another one worth telling.
bool isSettled(const FrameAnswer& answer, const VerifiedHypothesis& hypothesis) {
  const int object = hypothesis.hypothesis.object;
  const double size = answer.database.objects.at(static_cast<size_t>(object))->extents.sigma_max;
  return std::any_of(answer.found.begin(), answer.found.end(), [&](const VerifiedHypothesis& found) {
    if (found.hypothesis.object != object) return false;
    const Eigen::Vector3d apart = found.camera_from_object.translation() - hypothesis.camera_from_object.translation();
    return apart.norm() < 0.5 * size || hypothesis.confidence < kWorthTelling;
  });
}

/// Large planes darker, the outlines of segments white.
void drawSegments(cv::Mat& bgr, const Segmentation& segmentation, int color_per_depth) {
  cv::Mat labels;
  cv::resize(segmentation.labels, labels, segmentation.labels.size() * color_per_depth, 0, 0, cv::INTER_NEAREST);
  for (int v = 0; v + 1 < std::min(labels.rows, bgr.rows); ++v) {
    const int* row = labels.ptr<int>(v);
    const int* below = labels.ptr<int>(v + 1);
    cv::Vec3b* pixels = bgr.ptr<cv::Vec3b>(v);
    for (int u = 0; u + 1 < std::min(labels.cols, bgr.cols); ++u) {
      const bool at_segment = row[u] > 0 || row[u + 1] > 0 || below[u] > 0;
      if (at_segment && (row[u] != row[u + 1] || row[u] != below[u]))
        pixels[u] = kSegmentColor;
      else if (row[u] == kLargePlane)
        pixels[u] *= 0.5;
    }
  }
}

/// A square: at this size a circle would be none.
void drawFeature(cv::Mat& bgr, const SceneFeatures& features, int index, int size, const cv::Scalar& color) {
  const Keypoint& keypoint = features.image.keypoints.at(static_cast<size_t>(index));
  const cv::Rect square(cvRound(keypoint.x - 0.5f * (size - 1)), cvRound(keypoint.y - 0.5f * (size - 1)), size, size);
  cv::rectangle(bgr, square, color, cv::FILLED);
}

/// All as small dots; those on which a hypothesis rests larger, in its colour.
void drawFeatures(cv::Mat& bgr, const FrameAnswer& answer, const std::vector<const VerifiedHypothesis*>& rejected) {
  const int size = bgr.cols >= 1000 ? 3 : 2;  // pixels
  for (int i = 0; i < answer.features.image.count(); ++i) drawFeature(bgr, answer.features, i, size, kFeatureColor);
  const auto draw_used = [&](const VerifiedHypothesis& hypothesis, const cv::Scalar& color) {
    for (const Correspondence& pair : hypothesis.hypothesis.consensus)
      drawFeature(bgr, answer.features, pair.scene_feature, size + 1, color);
  };
  for (const VerifiedHypothesis* hypothesis : rejected) draw_used(*hypothesis, rejectedColor());
  for (const VerifiedHypothesis& found : answer.found) draw_used(found, objectColor(found.hypothesis.object));
}

std::vector<Line> linesOf(const FrameAnswer& answer, const std::vector<const VerifiedHypothesis*>& rejected) {
  std::vector<Line> lines;
  std::map<int, bool> told;
  for (const VerifiedHypothesis& found : answer.found) {
    const int object = found.hypothesis.object;
    lines.push_back({nameWithConfidence(nameOf(answer, object), found.confidence) + ": found", objectColor(object)});
    told[object] = true;
  }
  for (const VerifiedHypothesis* hypothesis : rejected) {
    const int object = hypothesis->hypothesis.object;
    told[object] = true;
    if (lines.size() >= answer.found.size() + kMaxLines) continue;
    lines.push_back({nameWithConfidence(nameOf(answer, object), hypothesis->confidence) + ": " +
                         inWords(rejectionName(hypothesis->rejection)) + ", " + meaningOf(*hypothesis),
                     rejectedColor()});
  }
  if (rejected.size() > kMaxLines)
    lines.push_back({std::to_string(rejected.size() - kMaxLines) + " more still less likely", kTextColor});
  const size_t untold = answer.database.objects.size() - told.size();
  if (untold > 0)
    lines.push_back({std::to_string(untold) + (untold == 1 ? " model" : " models") + ": no pose to test", kTextColor});
  return lines;
}

/// Cut where it is wider than `width` pixels.
std::string fitted(std::string text, int width, double scale, int thickness) {
  int baseline = 0;
  const auto width_of = [&](const std::string& shown) {
    return cv::getTextSize(shown, kFont, scale, thickness, &baseline).width;
  };
  if (width_of(text) <= width) return text;
  while (!text.empty() && width_of(text + "...") > width) text.pop_back();
  return text + "...";
}

/// The lines below the picture, in as many columns as fit.
cv::Mat withLines(const cv::Mat& picture, const std::vector<Line>& lines) {
  const double scale = readableTextScale(picture.size());
  const int thickness = std::max(1, cvRound(1.5 * scale));
  int baseline = 0, widest = 1;
  const int capitals = cv::getTextSize("X", kFont, scale, thickness, &baseline).height;
  for (const Line& line : lines)
    widest = std::max(widest, cv::getTextSize(line.text, kFont, scale, thickness, &baseline).width);
  const int height = capitals + baseline + capitals / 2, gap = capitals;
  const int columns = std::max(1, (picture.cols - gap) / (widest + gap));
  const int rows = (static_cast<int>(lines.size()) + columns - 1) / columns;
  cv::Mat all(picture.rows + rows * height + gap, picture.cols, CV_8UC3, kGround);
  picture.copyTo(all(cv::Rect({}, picture.size())));
  for (size_t i = 0; i < lines.size(); ++i) {
    const int row = static_cast<int>(i) % rows, column = static_cast<int>(i) / rows;
    const cv::Point corner(gap + column * (picture.cols - gap) / columns, picture.rows + row * height + gap + capitals);
    cv::putText(all, fitted(lines[i].text, (picture.cols - gap) / columns - gap, scale, thickness), corner, kFont,
                scale, lines[i].color, thickness, cv::LINE_AA);
  }
  return all;
}

}  // namespace

std::vector<const VerifiedHypothesis*> bestRejected(const FrameAnswer& answer) {
  std::map<int, const VerifiedHypothesis*> best;
  for (const VerifiedHypothesis& hypothesis : answer.tested) {
    if (hypothesis.accepted() || hypothesis.rejection == Rejection::kDuplicate) continue;
    const VerifiedHypothesis*& so_far = best[hypothesis.hypothesis.object];
    if ((!so_far || isNearer(hypothesis, *so_far)) && !isSettled(answer, hypothesis)) so_far = &hypothesis;
  }
  std::vector<const VerifiedHypothesis*> all;
  for (const auto& [object, hypothesis] : best)
    if (hypothesis) all.push_back(hypothesis);
  std::stable_sort(all.begin(), all.end(), [](const auto* a, const auto* b) { return isNearer(*a, *b); });
  return all;
}

cv::Mat whyPicture(const FrameAnswer& answer) {
  cv::Mat picture = bgrCopy(answer.frame);
  picture *= 0.75;  // so that what is drawn stands out
  const auto rejected = bestRejected(answer);
  const std::vector<const VerifiedHypothesis*> drawn(rejected.begin(),
                                                     rejected.begin() + std::min(rejected.size(), kMaxDrawn));
  drawSegments(picture, answer.segmentation, answer.frame.colorPerDepthPixel());
  drawFeatures(picture, answer, drawn);
  std::vector<Annotation> annotations;
  for (const VerifiedHypothesis& found : answer.found)
    annotations.push_back({found.hypothesis.object, found.camera_from_object,
                           nameWithConfidence(nameOf(answer, found.hypothesis.object), found.confidence)});
  for (const VerifiedHypothesis* hypothesis : drawn)
    annotations.push_back(
        {hypothesis->hypothesis.object, hypothesis->camera_from_object,
         nameOf(answer, hypothesis->hypothesis.object) + ": " + inWords(rejectionName(hypothesis->rejection)), true});
  drawAnnotations(picture, annotations, answer.database, answer.frame.color_camera);
  return withLines(picture, linesOf(answer, rejected));
}

}  // namespace recognition
