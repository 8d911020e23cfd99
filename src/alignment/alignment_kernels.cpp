#include "alignment/alignment_kernels.h"

#include <algorithm>
#include <cmath>

#include "core/depth_noise.h"
#include "core/simd.h"

namespace recognition {
namespace {

// The loops below are short and have few choices, so that GCC 12 vectorises them. Pointers of a loop stand in structs
// that it copies, so that no store can change them.
struct Vectors {
  float* __restrict x;
  float* __restrict y;
  float* __restrict z;
};

Vectors vectors(std::array<Column, 3>& columns) { return {columns[0].data(), columns[1].data(), columns[2].data()}; }

struct Input {
  const float* x;
  const float* y;
  const float* z;
};

Input input(const std::array<Column, 3>& columns) { return {columns[0].data(), columns[1].data(), columns[2].data()}; }

RGBD_SIMD_CLONES void rotate(const float* rotation, const float* shift, Input from, int count, Vectors to) {
  float r[9], t[3];
  std::copy(rotation, rotation + 9, r);
  std::copy(shift, shift + 3, t);
  for (int i = 0; i < count; ++i) {
    const float x = from.x[i], y = from.y[i], z = from.z[i];
    to.x[i] = r[0] * x + r[1] * y + r[2] * z + t[0];
    to.y[i] = r[3] * x + r[4] * y + r[5] * z + t[1];
    to.z[i] = r[6] * x + r[7] * y + r[8] * z + t[2];
  }
}

RGBD_SIMD_CLONES void projectAll(Input p, int count, float fx, float fy, float cx, float cy, float* __restrict column,
                                 float* __restrict row) {
  for (int i = 0; i < count; ++i) {
    const float inverse = 1.0f / p.z[i];
    column[i] = fx * p.x[i] * inverse + cx;
    row[i] = fy * p.y[i] * inverse + cy;
  }
}

/// The columns of AlignmentRows.
struct Rows {
  float* __restrict row[kAlignmentParameters];
  float* __restrict residual;
  float* __restrict robust;
  float* __restrict weight;
};

Rows rowsOf(std::array<Column, kAlignmentParameters>& row, Column& residual, Column& robust, Column& weight) {
  Rows rows;
  for (size_t k = 0; k < row.size(); ++k) rows.row[k] = row[k].data();
  rows.residual = residual.data();
  rows.robust = robust.data();
  rows.weight = weight.data();
  return rows;
}

struct DepthLimits {
  float gate, floor;
  float noise, min_noise;  // core/depth_noise.h
};

RGBD_SIMD_CLONES void depthRows(Input p, Input n, const float* seen, int count, Eigen::Vector3f anchor,
                                DepthLimits limits, Rows rows) {
  const float ax = anchor.x(), ay = anchor.y(), az = anchor.z(), most = 3.0f * limits.gate;
  const float squared_gate = limits.gate * limits.gate, squared_floor = limits.floor * limits.floor;
  for (int i = 0; i < count; ++i) {
    const float z = seen[i], px = p.x[i], py = p.y[i], pz = p.z[i], nx = n.x[i], ny = n.y[i], nz = n.z[i];
    const bool used = (z > 0.0f) & (pz > 0.0f) & (std::abs(z - pz) <= most);
    const float by_square = limits.noise * z * z;
    const float sensor = by_square > limits.min_noise ? by_square : limits.min_noise;
    const float variance = sensor * sensor + squared_floor, three_deviations = 9.0f * variance;
    // The ray through p meets the frame at depth z: n . (p z / p_z - p).
    const float distance = used ? (nx * px + ny * py + nz * pz) * (z / pz - 1.0f) : 0.0f;
    const float limit = three_deviations > squared_gate ? three_deviations : squared_gate;
    const float robust = used ? robustWeight(distance * distance / limit) : 0.0f;
    putTranslationAndRotation(rows, i, px - ax, py - ay, pz - az, -nx, -ny, -nz);
    rows.row[6][i] = 0.0f;
    rows.residual[i] = distance;
    rows.robust[i] = robust;
    rows.weight[i] = robust / variance;
  }
}

/// The columns of AlignedTexture.
struct TextureColumns {
  Input position;
  const float* model;
  const float* seen;
  const float* by_column;
  const float* by_row;
  const float* spread_column;
  const float* spread_row;
};

struct TextureLimits {
  float fx, fy;
  float gain, offset;
  float gate, variance;
};

RGBD_SIMD_CLONES void textureRows(TextureColumns texture, int count, Eigen::Vector3f anchor, TextureLimits limits,
                                  Rows rows) {
  const float ax = anchor.x(), ay = anchor.y(), az = anchor.z();
  const float per_variance = 1.0f / limits.variance, per_limit = per_variance / (limits.gate * limits.gate);
  for (int i = 0; i < count; ++i) {
    const float px = texture.position.x[i], py = texture.position.y[i], pz = texture.position.z[i], inverse = 1.0f / pz;
    const float residual = texture.seen[i] - (limits.gain * texture.model[i] + limits.offset);
    const float by_x = texture.by_column[i] * limits.fx * inverse, by_y = texture.by_row[i] * limits.fy * inverse;
    const float robust = robustWeight(residual * residual * per_limit);
    putTranslationAndRotation(rows, i, px - ax, py - ay, pz - az, by_x, by_y, -(by_x * px + by_y * py) * inverse);
    rows.row[6][i] = texture.by_column[i] * texture.spread_column[i] + texture.by_row[i] * texture.spread_row[i];
    rows.residual[i] = residual;
    rows.robust[i] = robust;
    rows.weight[i] = robust * per_variance;
  }
}

RGBD_SIMD_CLONES void sumAll(const std::array<Column, kAlignmentParameters>& row, const float* residual,
                             const float* weight, int count, AlignmentSums& sums) {
  const float* const rows[kAlignmentParameters] = {row[0].data(), row[1].data(), row[2].data(), row[3].data(),
                                                   row[4].data(), row[5].data(), row[6].data()};
  addRows(rows, residual, weight, count, &sums);
}

/// Depth under a pixel position, 0 outside and in holes.
float depthAt(const cv::Mat& depth, float column, float row) {
  if (!(std::abs(column) < 1e6f && std::abs(row) < 1e6f)) return 0.0f;
  const int u = cvRound(column), v = cvRound(row);
  return u < 0 || v < 0 || u >= depth.cols || v >= depth.rows ? 0.0f : depth.ptr<float>(v)[u];
}

template <size_t N>
void resizeAll(std::array<Column, N>& columns, size_t size) {
  for (Column& column : columns) column.resize(size);
}

}  // namespace

void AlignedPoints::assign(const PreparedModel& model, const std::vector<int>& points) {
  for (auto* columns : {&model_position, &model_normal, &position, &normal}) resizeAll(*columns, points.size());
  for (Column* one : {&lightness, &column, &row, &seen_depth}) one->resize(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const auto point = static_cast<size_t>(points[i]);
    for (int axis = 0; axis < 3; ++axis) {
      model_position[axis][i] = model.positions[point][axis];
      model_normal[axis][i] = model.normals[point][axis];
    }
    lightness[i] = model.lab[point][0];
  }
}

void AlignedPoints::move(const Pose& camera_from_object, const SceneView& scene) {
  const Eigen::Matrix<float, 3, 3, Eigen::RowMajor> rotation = camera_from_object.linear().cast<float>();
  const Eigen::Vector3f shift = camera_from_object.translation().cast<float>(), none = Eigen::Vector3f::Zero();
  rotate(rotation.data(), shift.data(), input(model_position), count(), vectors(position));
  rotate(rotation.data(), none.data(), input(model_normal), count(), vectors(normal));
  const CameraModel& camera = scene.camera;
  projectAll(input(position), count(), static_cast<float>(camera.fx), static_cast<float>(camera.fy),
             static_cast<float>(camera.cx), static_cast<float>(camera.cy), column.data(), row.data());
  for (size_t i = 0; i < seen_depth.size(); ++i) seen_depth[i] = depthAt(scene.depth, column[i], row[i]);
}

void AlignedTexture::collect(const AlignedPoints& points, const SceneView& scene, const Eigen::Vector3d& anchor,
                             double magnification, double gate) {
  for (Column& axis : position) axis.clear();
  for (Column* one : {&lightness, &seen, &by_column, &by_row, &spread_column, &spread_row}) one->clear();
  const Eigen::Vector2f middle = scene.camera.project(anchor).cast<float>();
  const auto magnify = static_cast<float>(1.0 + magnification), most = static_cast<float>(gate);
  const cv::Mat& image = scene.lightness;
  for (size_t i = 0; i < points.lightness.size(); ++i) {
    if (!(points.position[2][i] > 0.0f)) continue;
    const float du = points.column[i] - middle.x(), dv = points.row[i] - middle.y();
    const float u = middle.x() + magnify * du, v = middle.y() + magnify * dv;
    if (!(u >= 0.0f && v >= 0.0f && u < static_cast<float>(image.cols - 1) && v < static_cast<float>(image.rows - 1)))
      continue;
    const float z = depthAt(scene.depth, u, v);
    if (z > 0.0f && std::abs(z - points.position[2][i]) > most) continue;
    if (scene.clipped.ptr<std::uint8_t>(cvRound(v))[cvRound(u)]) continue;
    const int u0 = static_cast<int>(u), v0 = static_cast<int>(v);
    const float fu = u - static_cast<float>(u0), fv = v - static_cast<float>(v0);
    const float* top = image.ptr<float>(v0) + u0;
    const float* bottom = image.ptr<float>(v0 + 1) + u0;
    const float above = top[0] + fu * (top[1] - top[0]), below = bottom[0] + fu * (bottom[1] - bottom[0]);
    for (int axis = 0; axis < 3; ++axis) position[axis].push_back(points.position[axis][i]);
    lightness.push_back(points.lightness[i]);
    seen.push_back(above + fv * (below - above));
    by_column.push_back((1.0f - fv) * (top[1] - top[0]) + fv * (bottom[1] - bottom[0]));
    by_row.push_back((1.0f - fu) * (bottom[0] - top[0]) + fu * (bottom[1] - top[1]));
    spread_column.push_back(du);
    spread_row.push_back(dv);
  }
}

AlignmentSums AlignmentRows::sum() const {
  AlignmentSums sums;
  sumAll(row_, residual_.data(), weight_.data(), static_cast<int>(weight_.size()), sums);
  return sums;
}

double AlignmentRows::weights() const {
  double sum = 0.0;
  for (const float weight : robust_) sum += weight;
  return sum;
}

double AlignmentRows::squares() const {
  double sum = 0.0;
  for (size_t i = 0; i < weight_.size(); ++i) sum += weight_[i] * residual_[i] * residual_[i];
  return sum;
}

void AlignmentRows::resize(int count) {
  const auto size = static_cast<size_t>(count);
  const size_t padded = (size + kRowLanes - 1) / kRowLanes * kRowLanes;
  resizeAll(row_, padded);
  for (Column* one : {&residual_, &robust_, &weight_}) one->resize(padded);
  for (size_t i = size; i < padded; ++i) {
    for (Column& column : row_) column[i] = 0.0f;
    residual_[i] = robust_[i] = weight_[i] = 0.0f;
  }
}

void AlignmentRows::makeOfDepth(const AlignedPoints& points, const Eigen::Vector3d& anchor, double gate, double floor) {
  resize(points.count());
  const DepthLimits limits{static_cast<float>(gate), static_cast<float>(floor), static_cast<float>(kDepthNoise),
                           static_cast<float>(kMinDepthNoise)};
  depthRows(input(points.position), input(points.normal), points.seen_depth.data(), points.count(),
            anchor.cast<float>(), limits, rowsOf(row_, residual_, robust_, weight_));
}

void AlignmentRows::makeOfTexture(const AlignedTexture& texture, const CameraModel& camera,
                                  const Eigen::Vector3d& anchor, const LightnessTransform& illumination,
                                  const TextureWeights& weights) {
  resize(texture.count());
  const TextureColumns columns_of_texture{
      input(texture.position), texture.lightness.data(),     texture.seen.data(),      texture.by_column.data(),
      texture.by_row.data(),   texture.spread_column.data(), texture.spread_row.data()};
  const TextureLimits limits{static_cast<float>(camera.fx),         static_cast<float>(camera.fy),
                             static_cast<float>(illumination.gain), static_cast<float>(illumination.offset),
                             static_cast<float>(weights.gate),      static_cast<float>(weights.sigma * weights.sigma)};
  textureRows(columns_of_texture, texture.count(), anchor.cast<float>(), limits,
              rowsOf(row_, residual_, robust_, weight_));
}

}  // namespace recognition
