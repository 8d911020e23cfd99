#pragma once

namespace rgbd_recognition {

constexpr int kRowLanes = 8;  ///< partial sums, added in a fixed order

/// Normal equations of N parameters: rows of the lower triangle, and the right side.
template <int N>
struct RowSums {
  float hessian[N * (N + 1) / 2];
  float gradient[N];
};

/// Sums weighted rows of least squares, which lie one parameter after the other: weight row row^T, weight residual row.
/// `count` is a multiple of kRowLanes. To be called from a function with RGBD_SIMD_CLONES, whose instructions it takes.
template <int N>
__attribute__((always_inline)) inline void addRows(const float* const (&row)[N], const float* residual,
                                                   const float* weight, int count, RowSums<N>* sums) {
  float hessian[N * (N + 1) / 2][kRowLanes] = {}, gradient[N][kRowLanes] = {};
  for (int i = 0; i < count; i += kRowLanes) {
    int k = 0;
    for (int a = 0; a < N; ++a) {
      float weighted[kRowLanes];
      for (int lane = 0; lane < kRowLanes; ++lane) weighted[lane] = weight[i + lane] * row[a][i + lane];
      for (int b = 0; b <= a; ++b, ++k)
        for (int lane = 0; lane < kRowLanes; ++lane) hessian[k][lane] += weighted[lane] * row[b][i + lane];
      for (int lane = 0; lane < kRowLanes; ++lane) gradient[a][lane] += weighted[lane] * residual[i + lane];
    }
  }
  for (int k = 0; k < N * (N + 1) / 2; ++k) {
    sums->hessian[k] = 0.0f;
    for (const float part : hessian[k]) sums->hessian[k] += part;
  }
  for (int a = 0; a < N; ++a) {
    sums->gradient[a] = 0.0f;
    for (const float part : gradient[a]) sums->gradient[a] += part;
  }
}

}  // namespace rgbd_recognition
