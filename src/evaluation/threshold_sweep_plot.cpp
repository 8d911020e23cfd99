#include <cstdio>

#include <opencv2/imgproc.hpp>

#include "evaluation/threshold_sweep.h"

namespace recognition {
namespace {

constexpr int kPanel = 480;  // pixels, of each square panel
constexpr int kBorder = 60;
const cv::Scalar kColors[] = {{180, 90, 20}, {30, 90, 220}, {60, 150, 50}, {160, 40, 150}};

/// One square diagram with axes 0..1.
class Panel {
 public:
  Panel(cv::Mat& image, int left) : image_(image), left_(left) {}

  cv::Point at(double x, double y) const {
    return {left_ + kBorder + cvRound(x * kPanel), kBorder + kPanel - cvRound(y * kPanel)};
  }

  void axes(const std::string& title, const std::string& x_name) {
    for (int i = 0; i <= 5; ++i) {
      const double t = i / 5.0;
      char number[8];
      std::snprintf(number, sizeof number, "%.1f", t);
      cv::line(image_, at(t, 0), at(t, 1), cv::Scalar::all(225), 1);
      cv::line(image_, at(0, t), at(1, t), cv::Scalar::all(225), 1);
      text(number, at(t, 0) + cv::Point(-10, 18));
      text(number, at(0, t) + cv::Point(-30, 5));
    }
    cv::rectangle(image_, at(0, 1), at(1, 0), cv::Scalar::all(80), 1);
    text(title, at(0, 1) + cv::Point(0, -12));
    text(x_name, at(0.5, 0) + cv::Point(-60, 40));
  }

  void text(const std::string& words, cv::Point where) {
    cv::putText(image_, words, where, cv::FONT_HERSHEY_SIMPLEX, 0.42, cv::Scalar::all(40), 1, cv::LINE_AA);
  }

  void segment(cv::Point a, cv::Point b, const cv::Scalar& color) { cv::line(image_, a, b, color, 2, cv::LINE_AA); }

 private:
  cv::Mat& image_;
  const int left_;
};

}  // namespace

cv::Mat drawSweeps(const std::vector<NamedSweep>& sweeps) {
  constexpr int kWidth = kPanel + 2 * kBorder;
  cv::Mat image(kPanel + 2 * kBorder, 2 * kWidth, CV_8UC3, cv::Scalar::all(255));
  Panel score(image, 0), curve(image, kWidth);
  score.axes("score / 100 over the decision threshold", "threshold");
  curve.axes("precision over recall", "recall");
  for (size_t s = 0; s < sweeps.size(); ++s) {
    const cv::Scalar color = kColors[s % 4];
    const std::vector<SweepPoint>& p = sweeps[s].points;
    for (size_t i = 1; i < p.size(); ++i) {
      score.segment(score.at(p[i - 1].threshold, p[i - 1].score_percent / 100),
                    score.at(p[i].threshold, p[i].score_percent / 100), color);
      curve.segment(curve.at(p[i - 1].recall, p[i - 1].precision), curve.at(p[i].recall, p[i].precision), color);
    }
    score.segment(score.at(sweeps[s].chosen, 0), score.at(sweeps[s].chosen, 0.03), color);
    const cv::Point legend = curve.at(0.03, 0.1 + 0.06 * static_cast<double>(s));
    curve.segment(legend, legend + cv::Point(25, 0), color);
    curve.text(sweeps[s].name, legend + cv::Point(32, 4));
  }
  return image;
}

}  // namespace recognition
