#pragma once

#include <cstddef>
#include <vector>

namespace recognition {

/// z = c0 + c1 t + c2 t^2 with t = i - centre, over samples i of a scan-line.
struct Polynomial {
  double c0 = 0.0;
  double c1 = 0.0;
  double c2 = 0.0;
  double centre = 0.0;

  double at(double i) const {
    const double t = i - centre;
    return c0 + t * (c1 + t * c2);
  }
};

/// SL of Sec. IV: the line through samples `first` and `last` (inclusive, first < last).
Polynomial fitSimpleLinear(const float* z, int first, int last);

/// SQ of Sec. IV: the parabola through `first`, the middle and `last` (last - first >= 2).
Polynomial fitSimpleQuadratic(const float* z, int first, int last);

/// What least squares and AICc need besides the data, by number of samples n: with t centred on the run, the sums of t
/// and t^3 vanish and those of t^2 and t^4 have closed forms, so that {1, t, t^2 - s} (s = mean of t^2) are orthogonal
/// and every coefficient is one product.
class FitTables {
 public:
  /// Makes entries for up to n samples.
  void reserve(int n);

  // Indexed by n; by column, so that scores of neighbouring splits are computed together.
  std::vector<double> middle;  ///< (n - 1) / 2
  std::vector<double> inverse_n;
  std::vector<double> mean_t2;            ///< s = (n^2 - 1) / 12
  std::vector<double> inverse_t2;         ///< 1 / sum of t^2; 0 where a line is not determined
  std::vector<double> inverse_p2;         ///< 1 / sum of (t^2 - s)^2; 0 where a parabola is not determined
  std::vector<double> penalty_linear;     ///< eq. (6)-(7) without residuals, K = 2; infinite where AICc is not defined
  std::vector<double> penalty_quadratic;  ///< the same for K = 3
};

/// Least-squares line and parabola of a part of a run.
struct LeastSquaresFit {
  double rss_linear = 0.0;  ///< residual sum of squares
  double rss_quadratic = 0.0;
  double mean = 0.0, slope = 0.0, curvature = 0.0;  ///< coefficients of 1, t, t^2 - s
};

/// AD of Sec. IV: AICc (eq. 6-7, without the constant -2C) of the better of line and parabola.
struct AdaptiveScore {
  double aicc = 0.0;
  bool quadratic = false;
};

/// Prefix sums of z, x z, x^2 z, z^2 over a run: the least-squares fit of any part of it, with its residuals, costs
/// O(1).
class RunSums {
 public:
  /// Samples first..last (inclusive) of z. Keeps its memory between calls.
  void build(const float* z, int first, int last);

  LeastSquaresFit fit(int first, int last, const FitTables& tables) const;

  Polynomial linear(const LeastSquaresFit& fit, int first, int last) const;
  Polynomial quadratic(const LeastSquaresFit& fit, int first, int last, const FitTables& tables) const;

  /// scores[k] = AICc of first..first+k-1 plus AICc of first+k..last, for k = kShortestAicc .. n - kShortestAicc.
  void splitScores(int first, int last, const FitTables& tables, double inverse_variance, double* scores) const;

 private:
  std::vector<double> z_, xz_, xxz_, zz_;
  int first_ = 0;
  double offset_ = 0.0;  ///< subtracted from z
};

constexpr int kShortestAicc = 4;  ///< samples of the shortest run for which AICc is defined (of a line)

/// `n` samples, `inverse_variance` = 1 / sigma^2.
AdaptiveScore adaptiveScore(const LeastSquaresFit& fit, int n, const FitTables& tables, double inverse_variance);

}  // namespace recognition
