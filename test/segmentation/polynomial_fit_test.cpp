#include "segmentation/polynomial_fit.h"

#include <cmath>
#include <random>
#include <vector>

#include <Eigen/QR>
#include <gtest/gtest.h>

namespace recognition {
namespace {

/// Range values as on a scan-line: a smooth surface at about 1 m with noise.
std::vector<float> randomLine(int n, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::normal_distribution<double> noise(0.0, 0.002);
  const double slope = 0.004 * uniform(rng), bend = 2e-5 * uniform(rng), start = 1.5 + uniform(rng);
  std::vector<float> z;
  for (int i = 0; i < n; ++i) z.push_back(static_cast<float>(start + slope * i + bend * i * i + noise(rng)));
  return z;
}

/// Plain least squares with `k` coefficients; t = index - centre of the run.
struct PlainFit {
  Eigen::VectorXd coefficients;
  double rss = 0.0;
};
PlainFit plainFit(const std::vector<float>& z, int first, int last, int k) {
  const int n = last - first + 1;
  Eigen::MatrixXd a(n, k);
  Eigen::VectorXd b(n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < k; ++j) a(i, j) = std::pow(first + i - 0.5 * (first + last), j);
    b[i] = z[static_cast<size_t>(first + i)];
  }
  PlainFit fit;
  fit.coefficients = a.householderQr().solve(b);
  fit.rss = (a * fit.coefficients - b).squaredNorm();
  return fit;
}

/// Eq. (6)-(7) without -2C, of the better model.
double plainAicc(const std::vector<float>& z, int first, int last, double sigma) {
  const double n = last - first + 1;
  double best = INFINITY;
  for (int k = 2; k <= 3; ++k)
    if (n > k + 1)
      best =
          std::min(best, 2.0 * k + plainFit(z, first, last, k).rss / (sigma * sigma) + 2.0 * k * (k + 1) / (n - k - 1));
  return best;
}

TEST(PolynomialFit, SimpleFitsPassThroughTheirPoints) {
  const std::vector<float> z = randomLine(40, 1);
  const Polynomial line = fitSimpleLinear(z.data(), 3, 30);
  EXPECT_NEAR(line.at(3), z[3], 1e-9);
  EXPECT_NEAR(line.at(30), z[30], 1e-9);
  const Polynomial parabola = fitSimpleQuadratic(z.data(), 3, 30);
  for (int i : {3, 16, 30}) EXPECT_NEAR(parabola.at(i), z[static_cast<size_t>(i)], 1e-9);
}

TEST(PolynomialFit, SumsAgreeWithPlainLeastSquares) {
  FitTables tables;
  tables.reserve(1280);
  std::mt19937 rng(2);
  for (unsigned trial = 0; trial < 200; ++trial) {
    const int n = std::uniform_int_distribution<int>(8, trial % 10 == 0 ? 1280 : 100)(rng);
    const std::vector<float> z = randomLine(n, trial);
    RunSums sums;
    const int run_first = std::uniform_int_distribution<int>(0, 3)(rng);
    sums.build(z.data(), run_first, n - 1);
    const int first = std::uniform_int_distribution<int>(run_first, n - 5)(rng);
    const int last = std::uniform_int_distribution<int>(first + 3, n - 1)(rng);
    const LeastSquaresFit fit = sums.fit(first, last, tables);
    const PlainFit linear = plainFit(z, first, last, 2), quadratic = plainFit(z, first, last, 3);
    EXPECT_NEAR(fit.rss_linear, linear.rss, 1e-9 + 1e-6 * linear.rss);
    EXPECT_NEAR(fit.rss_quadratic, quadratic.rss, 1e-9 + 1e-6 * quadratic.rss);
    const Polynomial p = sums.linear(fit, first, last), q = sums.quadratic(fit, first, last, tables);
    EXPECT_NEAR(p.c0, linear.coefficients[0], 1e-9);
    EXPECT_NEAR(p.c1, linear.coefficients[1], 1e-9);
    EXPECT_NEAR(q.c0, quadratic.coefficients[0], 1e-8);
    EXPECT_NEAR(q.c2, quadratic.coefficients[2], 1e-9);
  }
}

TEST(PolynomialFit, AiccAgreesWithItsDefinition) {
  constexpr double kSigma = 0.0017;
  FitTables tables;
  tables.reserve(64);
  for (unsigned trial = 0; trial < 50; ++trial) {
    const int n = 9 + static_cast<int>(trial);
    const std::vector<float> z = randomLine(n, trial);
    RunSums sums;
    sums.build(z.data(), 0, n - 1);
    const AdaptiveScore whole = adaptiveScore(sums.fit(1, n - 1, tables), n - 1, tables, 1.0 / (kSigma * kSigma));
    EXPECT_NEAR(whole.aicc, plainAicc(z, 1, n - 1, kSigma), 1e-3);
    std::vector<double> scores(static_cast<size_t>(n));
    sums.splitScores(1, n - 1, tables, 1.0 / (kSigma * kSigma), scores.data());
    for (int left = kShortestAicc; left <= n - 1 - kShortestAicc; ++left)
      EXPECT_NEAR(scores[static_cast<size_t>(left)],
                  plainAicc(z, 1, left, kSigma) + plainAicc(z, left + 1, n - 1, kSigma), 1e-3)
          << "n " << n << " left " << left;
  }
}

TEST(PolynomialFit, AiccIsInfiniteWhereItIsNotDefined) {
  FitTables tables;
  tables.reserve(5);
  LeastSquaresFit fit;
  EXPECT_TRUE(std::isinf(adaptiveScore(fit, 3, tables, 1.0).aicc));
  EXPECT_DOUBLE_EQ(adaptiveScore(fit, 4, tables, 1.0).aicc, 4.0 + 12.0);  // K = 2: 2 K + 2 K (K + 1) / (4 - 3)
  EXPECT_FALSE(adaptiveScore(fit, 4, tables, 1.0).quadratic);
}

}  // namespace
}  // namespace recognition
