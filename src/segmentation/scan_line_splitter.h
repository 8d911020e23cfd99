#pragma once

#include <cstdint>
#include <vector>

#include "segmentation/polynomial_fit.h"
#include "rgbd_recognition/segmentation/segmentation.h"
#include "rgbd_recognition/segmentation/segmentation_parameters.h"

namespace recognition {

/// A smooth sub-segment of a scan-line: samples first..last, inclusive.
struct SubSegment {
  int first = 0;
  int last = 0;

  int size() const { return last - first + 1; }
};

struct EdgePoint {
  int index = 0;  ///< in the scan-line
  EdgeType type = EdgeType::kNone;
};

/// Algorithm 1 on one scan-line. Keeps its memory between calls; one object a thread.
///
/// Deviations from the paper. (1) Neighbours farther apart than `jump` separate runs as an invalid range does: they
/// would be split there anyway, only later. (2) Where the samples jump at the split-index, the halves do not share it:
/// a shared outlier would be split off once more. AICc halves never share it, so that both sides of eq. (6) sum over
/// the same samples, and both "before" and "after" a candidate are tried. (3) Halves too short for AICc to be defined
/// (fewer than 4 samples) are no candidates. (4) A sensor's pixels are not quite where they seem (lateral noise, Nguyen
/// et al. 2012), so slanted surfaces are noisier: with slope c1 of the fit, sigma^2 grows by (lateral c1)^2, and
/// epsilon in proportion to sigma. (5) An edge point at which the surface turns by less than `crease_angle` is none:
/// smooth surfaces that are no parabolas (spheres, cylinders) are split there.
class ScanLineSplitter {
 public:
  explicit ScanLineSplitter(const SegmentationParameters& parameters);

  /// z[0..n): NoiseModel::kConstant depth, kSensor inverse depth; 0 invalid. `pitch`: distance of neighbouring rays at
  /// depth 1 (1 / f, for diagonals sqrt(2) / f).
  void split(const float* z, int n, double pitch);

  /// S_f of the last call, from first to last.
  const std::vector<SubSegment>& segments() const { return segments_; }
  /// Edge points of the last call, from first to last: creases where lines fitted to the few samples on both sides meet
  /// within epsilon, else jumps.
  const std::vector<EdgePoint>& edges() const { return edges_; }

 private:
  void splitRun(SubSegment run);
  void splitByResidual(SubSegment run, bool then_aicc);
  void splitByAicc(SubSegment run);
  bool maximumResidualSplit(SubSegment s, SubSegment* left, SubSegment* right);
  bool minimumAiccSplit(SubSegment s, SubSegment* left, SubSegment* right);
  double varianceAt(double slope) const { return variance_ + lateral_variance_ * slope * slope; }
  float epsilonAt(double slope) const;
  EdgePoint edgeBetween(SubSegment left, SubSegment right) const;
  bool bends(double z, double slope_before, double slope_after) const;
  int fartherOf(int i, int j) const;

  const SegmentationMode mode_;
  const bool inverse_;
  const float epsilon_;
  const float jump_;
  const double variance_;
  const double lateral_variance_;
  const int lambda_min_;
  const int switch_length_;

  const double tan_crease_;

  const float* z_ = nullptr;
  double pitch_ = 0.0;
  FitTables tables_;
  RunSums sums_;
  std::vector<std::int32_t> residuals_;  ///< bits of |residual|, ordered as the numbers are
  std::vector<double> scores_;           ///< AICc by length of the left half
  std::vector<SubSegment> residual_stack_;
  std::vector<SubSegment> aicc_stack_;
  std::vector<SubSegment> segments_;
  std::vector<EdgePoint> edges_;
  size_t run_begin_ = 0;  ///< first of segments_ that belongs to the current run
};

}  // namespace recognition
