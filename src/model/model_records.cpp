#include "model/model_records.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "model/pcd.h"

namespace recognition {
namespace {

constexpr float kFarthest = 10.0f;  // metres from the object's origin
constexpr float kNormalTolerance = 0.05f;

const std::vector<PcdField>& cloudFields() {
  static const std::vector<PcdField> fields = {
      {"x"}, {"y"}, {"z"}, {"normal_x"}, {"normal_y"}, {"normal_z"}, {"rgb", 'U', 4, 1}};
  return fields;
}

// Orientations are there if the model knows them.
std::vector<PcdField> featureFields(DescriptorType type, bool oriented) {
  std::vector<PcdField> fields = {{"x"}, {"y"}, {"z"}, {"view_x"}, {"view_y"}, {"view_z"}};
  if (oriented) fields.insert(fields.end(), {{"orientation_x"}, {"orientation_y"}, {"orientation_z"}});
  fields.insert(fields.end(), {{"size"}, {"views", 'U', 2, 1}, {"descriptor", 'I', 1, descriptorLength(type)}});
  return fields;
}

bool hasOrientations(const std::string& pcd) {
  const size_t found = pcd.find("orientation_x");
  return found != std::string::npos && found < pcd.find("DATA");
}

// Packs and unpacks the values of a record one after the other.
template <typename T>
void put(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

template <typename T>
T take(const char*& at) {
  T value;
  std::memcpy(&value, at, sizeof(T));
  at += sizeof(T);
  return value;
}

void putVector(std::string& bytes, const Eigen::Vector3f& v) {
  for (int k = 0; k < 3; ++k) put(bytes, v[k]);
}

Eigen::Vector3f takePosition(const char*& at) {
  Eigen::Vector3f v;
  for (int k = 0; k < 3; ++k) v[k] = take<float>(at);
  if (!(v.norm() < kFarthest)) throw std::runtime_error("has a point that is not finite or too far away");
  return v;
}

Eigen::Vector3f takeDirection(const char*& at) {
  Eigen::Vector3f v;
  for (int k = 0; k < 3; ++k) v[k] = take<float>(at);
  if (!(std::abs(v.norm() - 1.0f) < kNormalTolerance))
    throw std::runtime_error("has a direction that is not of unit length");
  return v;
}

void putDescriptor(std::string& bytes, const std::int8_t* descriptor, int length) {
  bytes.append(reinterpret_cast<const char*>(descriptor), static_cast<size_t>(length));
}

void takeDescriptor(const char*& at, std::int8_t* descriptor, int length) {
  std::memcpy(descriptor, at, static_cast<size_t>(length));
  at += length;
  if (std::all_of(descriptor, descriptor + length, [](std::int8_t value) { return value == 0; }))
    throw std::runtime_error("has a descriptor that is zero");
}

void requireConsistent(const ModelFeatures& features, DescriptorType type) {
  const auto n = static_cast<size_t>(features.count());
  if (features.positions.size() != n || features.view_directions.size() != n || features.sizes.size() != n ||
      features.views.size() != n || (!features.orientations.empty() && features.orientations.size() != n))
    throw std::invalid_argument("its features have vectors of different lengths");
  if (n > 0 && features.descriptors.cols != descriptorLength(type))
    throw std::invalid_argument(std::string("its descriptors are not of type ") + descriptorName(type));
}

}  // namespace

std::string encodeCloud(const std::vector<SurfacePoint>& cloud) {
  std::string records;
  records.reserve(cloud.size() * recordBytes(cloudFields()));
  for (const SurfacePoint& point : cloud) {
    putVector(records, point.position);
    putVector(records, point.normal);
    put(records, std::uint32_t(point.rgb[0]) << 16 | std::uint32_t(point.rgb[1]) << 8 | std::uint32_t(point.rgb[2]));
  }
  return encodePcd(cloudFields(), records, static_cast<int>(cloud.size()));
}

std::vector<SurfacePoint> decodeCloud(const std::string& pcd) {
  const std::string records = decodePcd(pcd, cloudFields());
  std::vector<SurfacePoint> cloud(records.size() / recordBytes(cloudFields()));
  const char* at = records.data();
  for (SurfacePoint& point : cloud) {
    point.position = takePosition(at);
    point.normal = takeDirection(at);
    const auto rgb = take<std::uint32_t>(at);
    point.rgb = cv::Vec3b(static_cast<uchar>(rgb >> 16), static_cast<uchar>(rgb >> 8), static_cast<uchar>(rgb));
  }
  return cloud;
}

std::string encodeFeatures(const ModelFeatures& features, DescriptorType type) {
  requireConsistent(features, type);
  const bool oriented = !features.orientations.empty();
  const cv::Mat descriptors = quantizedDescriptors(features.descriptors);
  std::string records;
  records.reserve(static_cast<size_t>(features.count()) * recordBytes(featureFields(type, oriented)));
  for (int i = 0; i < features.count(); ++i) {
    const auto k = static_cast<size_t>(i);
    putVector(records, features.positions[k]);
    putVector(records, features.view_directions[k]);
    if (oriented) putVector(records, features.orientations[k]);
    put(records, features.sizes[k]);
    put(records, features.views[k]);
    putDescriptor(records, descriptors.ptr<std::int8_t>(i), descriptors.cols);
  }
  return encodePcd(featureFields(type, oriented), records, features.count());
}

ModelFeatures decodeFeatures(const std::string& pcd, DescriptorType type, int format_version) {
  const bool oriented = hasOrientations(pcd);
  const std::string records = decodePcd(pcd, featureFields(type, oriented));
  const size_t count = records.size() / recordBytes(featureFields(type, oriented));
  ModelFeatures features;
  features.descriptors.create(static_cast<int>(count), descriptorLength(type), CV_8SC1);
  const char* at = records.data();
  for (size_t i = 0; i < count; ++i) {
    features.positions.push_back(takePosition(at));
    features.view_directions.push_back(takeDirection(at));
    if (oriented) features.orientations.push_back(takeDirection(at));
    features.sizes.push_back(take<float>(at));
    if (!(features.sizes.back() > 0.0f && features.sizes.back() < kFarthest))
      throw std::runtime_error("has a feature of impossible size");
    features.views.push_back(take<std::uint16_t>(at));
    takeDescriptor(at, features.descriptors.ptr<std::int8_t>(static_cast<int>(i)), descriptorLength(type));
  }
  if (format_version < 2)  // each descriptor had a scale of its own
    features.descriptors = quantizedDescriptors(unitDescriptors(features.descriptors));
  return features;
}

}  // namespace recognition
