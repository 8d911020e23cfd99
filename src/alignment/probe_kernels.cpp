#include "alignment/probe_kernels.h"

#include <cmath>

#include "core/simd.h"

namespace recognition {
namespace {

constexpr float kMinFacing = 0.2f;  // cosine
constexpr float kNearest = 0.1f;    // metres

// The loops below are short and have few choices, so that GCC 12 vectorises them.
inline float one(int condition) { return static_cast<float>(condition); }

/// Weighted point-to-plane equations: what a step along each parameter changes in the distance.
struct PlaneRows {
  alignas(64) float row[6][kProbeBlock];
  alignas(64) float distance[kProbeBlock];
  alignas(64) float weight[kProbeBlock];
};

RGBD_SIMD_CLONES int makeRows(const ProbeView& v, const ProbeLooks& l, int count, const float* anchor, float gate,
                              PlaneRows& rows) {
  int used = 0;
  const float ax = anchor[0], ay = anchor[1], az = anchor[2], inverse_gate = 1.0f / gate;
  const float per_x = 1.0f / v.fx, per_y = 1.0f / v.fy, cx = v.cx, cy = v.cy;
  for (int i = 0; i < count; ++i) {
    const float z = l.depth[i];
    const float px = l.position[0][i], py = l.position[1][i], pz = l.position[2][i];
    const float nx = l.normal[0][i], ny = l.normal[1][i], nz = l.normal[2][i];
    const float near = one((z > 0.0f) & (std::abs(z - pz) <= 2.0f * gate));
    const float dx = (l.column[i] - cx) * per_x * z - px, dy = (l.row[i] - cy) * per_y * z - py, dz = z - pz;
    const float distance = nx * dx + ny * dy + nz * dz, scaled = distance * inverse_gate;
    putTranslationAndRotation(rows, i, px - ax, py - ay, pz - az, nx, ny, nz);
    rows.distance[i] = distance;
    rows.weight[i] = near * robustWeight(scaled * scaled);
    used += static_cast<int>(near);
  }
  return used;
}

/// Rows beyond the last must weigh nothing, up to a multiple of kRowLanes.
RGBD_SIMD_CLONES void sumRows(const PlaneRows& r, int count, RowSums<6>& sums) {
  const float* const rows[6] = {r.row[0], r.row[1], r.row[2], r.row[3], r.row[4], r.row[5]};
  addRows(rows, r.distance, r.weight, count, &sums);
}

struct PointColumns {
  const float* position[3];
  const float* normal[3];
};

/// Where points are seen.
struct Pixels {
  float column[kProbeBlock], row[kProbeBlock];  // not rounded
  float nearest_column[kProbeBlock], nearest_row[kProbeBlock];
  float state[kProbeBlock];  // less than 0 where nothing is seen
  std::int32_t index[kProbeBlock];
};

RGBD_SIMD_CLONES void moveAndProject(const ProbeView& view, const PointColumns& points, int count,
                                     ProbeLooks& __restrict l, Pixels& __restrict pixels) {
  const ProbeView v = view;  // of its own, so that no store can change it
  const float* const r = v.rotation;
  for (int i = 0; i < count; ++i) {
    const float x = points.position[0][i], y = points.position[1][i], z = points.position[2][i];
    const float a = points.normal[0][i], b = points.normal[1][i], c = points.normal[2][i];
    const float px = r[0] * x + r[1] * y + r[2] * z + v.translation[0];
    const float py = r[3] * x + r[4] * y + r[5] * z + v.translation[1];
    const float pz = r[6] * x + r[7] * y + r[8] * z + v.translation[2];
    const float nx = r[0] * a + r[1] * b + r[2] * c, ny = r[3] * a + r[4] * b + r[5] * c,
                nz = r[6] * a + r[7] * b + r[8] * c;
    const float facing = -(nx * px + ny * py + nz * pz), squared = px * px + py * py + pz * pz;
    l.position[0][i] = px;
    l.position[1][i] = py;
    l.position[2][i] = pz;
    l.normal[0][i] = nx;
    l.normal[1][i] = ny;
    l.normal[2][i] = nz;
    pixels.column[i] = v.fx * px / pz + v.cx;
    pixels.row[i] = v.fy * py / pz + v.cy;
    pixels.state[i] = one((pz > kNearest) & (facing > 0.0f) & (facing * facing >= kMinFacing * kMinFacing * squared));
  }
}

/// To between 0 and `most`, also what is not a number.
RGBD_SIMD_CLONES void limitAll(const float* values, int count, float most, float* limited) {
  for (int i = 0; i < count; ++i) limited[i] = values[i] > 0.0f ? values[i] : 0.0f;
  for (int i = 0; i < count; ++i) limited[i] = limited[i] < most ? limited[i] : most;
}

RGBD_SIMD_CLONES void choosePixels(int count, int stride, ProbeLooks& l, Pixels& pixels) {
  for (int i = 0; i < count; ++i) {
    const float column = pixels.nearest_column[i], row = pixels.nearest_row[i];
    const float inside = one(std::abs(pixels.column[i] - column) < 0.5f) * one(std::abs(pixels.row[i] - row) < 0.5f);
    const auto whole_column = static_cast<std::int32_t>(column + 0.5f);
    const auto whole_row = static_cast<std::int32_t>(row + 0.5f);
    l.column[i] = static_cast<float>(whole_column);
    l.row[i] = static_cast<float>(whole_row);
    pixels.index[i] = whole_row * stride + whole_column;
    pixels.state[i] = kTurnedAway + pixels.state[i] * (kOutsideView - kTurnedAway + inside);
  }
}

RGBD_SIMD_CLONES void hideUnseen(const Pixels& pixels, int count, float* depth) {
  for (int i = 0; i < count; ++i) depth[i] = pixels.state[i] < 0.0f ? pixels.state[i] : depth[i];
}

}  // namespace

ProbeView::ProbeView(const SceneView& scene, const Eigen::Isometry3f& camera_from_object)
    : fx(static_cast<float>(scene.camera.fx)),
      fy(static_cast<float>(scene.camera.fy)),
      cx(static_cast<float>(scene.camera.cx)),
      cy(static_cast<float>(scene.camera.cy)),
      depth(scene.depth.ptr<float>()),
      cols(scene.depth.cols),
      rows(scene.depth.rows),
      stride(static_cast<int>(scene.depth.step1())) {
  Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(static_cast<float*>(rotation)) = camera_from_object.linear();
  Eigen::Map<Eigen::Vector3f>(static_cast<float*>(translation)) = camera_from_object.translation();
}

void lookAt(const ProbeView& view, const ProbePoints& points, int first, int count, ProbeLooks* looks) {
  PointColumns columns;
  for (int axis = 0; axis < 3; ++axis) {
    columns.position[axis] = points.position[axis].data() + first;
    columns.normal[axis] = points.normal[axis].data() + first;
  }
  Pixels pixels;
  moveAndProject(view, columns, count, *looks, pixels);
  limitAll(pixels.column, count, static_cast<float>(view.cols - 1), pixels.nearest_column);
  limitAll(pixels.row, count, static_cast<float>(view.rows - 1), pixels.nearest_row);
  choosePixels(count, view.stride, *looks, pixels);
  for (int i = 0; i < count; ++i) looks->depth[i] = view.depth[pixels.index[i]];
  hideUnseen(pixels, count, looks->depth);
}

PlaneSums sumPlanes(const ProbeView& view, const ProbeLooks& looks, int count, const float* anchor, float gate) {
  PlaneRows rows;
  PlaneSums sums;
  sums.used = makeRows(view, looks, count, anchor, gate, rows);
  int padded = count;
  for (; padded % kRowLanes != 0; ++padded) {
    for (auto& row : rows.row) row[padded] = 0.0f;
    rows.distance[padded] = rows.weight[padded] = 0.0f;
  }
  sumRows(rows, padded, sums.equations);
  return sums;
}

}  // namespace recognition
