#pragma once

#include <cstddef>
#include <vector>

namespace rgbd_recognition {

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

/// What least squares and AICc need besides the data, by number of samples n: with t centred on the run, the sums of t and t^3 vanish and those of t^2
/// and t^4 have closed forms, so that {1, t, t^2 - s} (s = mean of t^2) are orthogonal and every coefficient is one product.
struct FitTables {
  struct Entry {
    double inverse_n = 0.0;
    double mean_t2 = 0.0;            ///< s = (n^2 - 1) / 12
    double inverse_t2 = 0.0;         ///< 1 / sum of t^2; 0 where a line is not determined
    double inverse_p2 = 0.0;         ///< 1 / sum of (t^2 - s)^2; 0 where a parabola is not determined
    double penalty_linear = 0.0;     ///< eq. (6)-(7) without residuals, K = 2; infinite where AICc is not defined
    double penalty_quadratic = 0.0;  ///< the same for K = 3
  };

  /// Makes entries for up to n samples.
  void reserve(int n);
  const Entry& operator[](int n) const { return entries_[static_cast<size_t>(n)]; }

 private:
  std::vector<Entry> entries_;
};

/// Prefix sums of z, x z, x^2 z, z^2 over a run: the least-squares fit of any part of it, with its residuals, costs O(1).
class RunSums {
 public:
  /// Samples first..last (inclusive) of z. Keeps its memory between calls.
  void build(const float* z, int first, int last);

  /// Least-squares fits of a part: residual sums of squares and, on demand, polynomials.
  struct Fit {
    double rss_linear = 0.0;
    double rss_quadratic = 0.0;
    double mean = 0.0, slope = 0.0, curvature = 0.0;  ///< coefficients of 1, t, t^2 - s
  };
  Fit fit(int first, int last, const FitTables& tables) const;

  Polynomial linear(const Fit& fit, int first, int last) const;
  Polynomial quadratic(const Fit& fit, int first, int last, const FitTables& tables) const;

 private:
  struct Sums {
    double z, xz, xxz, zz;
  };
  std::vector<Sums> prefix_;
  int first_ = 0;
  double offset_ = 0.0;  ///< subtracted from z
};

/// AD of Sec. IV: AICc (eq. 6-7, without the constant -2C) of the better of line and parabola. `inverse_variance` = 1 / sigma^2.
struct AdaptiveScore {
  double aicc = 0.0;
  bool quadratic = false;
};
AdaptiveScore adaptiveScore(const RunSums::Fit& fit, const FitTables::Entry& entry, double inverse_variance);

}  // namespace rgbd_recognition
