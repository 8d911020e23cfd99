#pragma once

namespace recognition {

constexpr int kRowLanes = 8;  ///< partial sums, added in a fixed order

/// Weight of Geman and McClure: 1 at 0, 1/4 where the residual is at its gate.
template <typename Number>
inline Number robustWeight(Number scaled_square) {
  return Number(1) / ((Number(1) + scaled_square) * (Number(1) + scaled_square));
}

/// Row i of how a residual changes with a step (rows 0 to 2: `by`, its change with the point) and with a turn about an
/// anchor at `arm` from the point (rows 3 to 5: arm x by).
template <typename Rows>
inline void putTranslationAndRotation(Rows& rows, int i, float arm_x, float arm_y, float arm_z, float by_x, float by_y,
                                      float by_z) {
  rows.row[0][i] = by_x;
  rows.row[1][i] = by_y;
  rows.row[2][i] = by_z;
  rows.row[3][i] = arm_y * by_z - arm_z * by_y;
  rows.row[4][i] = arm_z * by_x - arm_x * by_z;
  rows.row[5][i] = arm_x * by_y - arm_y * by_x;
}

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

}  // namespace recognition
