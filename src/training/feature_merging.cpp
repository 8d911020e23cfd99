#include "training/feature_merging.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <Eigen/Geometry>

#include "core/point_grid.h"

namespace recognition {
namespace {

constexpr double kMaxTolerance = 0.01;  // metres, however large the feature

using Descriptor = Eigen::Map<const Eigen::VectorXf>;

// A feature of the object in the making: sums over the features that it was merged from.
struct Cluster {
  Eigen::VectorXf descriptor;  // sum
  Eigen::VectorXf mean;        // its unit-length direction
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  Eigen::Vector3f view_direction = Eigen::Vector3f::Zero();
  Eigen::Vector3f orientation = Eigen::Vector3f::Zero();
  float size = 0.0f;
  int count = 0;
  int views = 0;
  int last_view = -1;

  Eigen::Vector3f meanPosition() const { return position / static_cast<float>(count); }
  Eigen::Vector3f meanOrientation() const {  // perpendicular to the mean view direction
    const Eigen::Vector3f view = view_direction.normalized();
    const Eigen::Vector3f across = orientation - orientation.dot(view) * view;
    return across.squaredNorm() > 0.0f ? across.normalized() : view.unitOrthogonal();
  }
  float meanSize() const { return size / static_cast<float>(count); }
};

class Merger {
 public:
  explicit Merger(const MergingParameters& parameters)
      : parameters_(parameters),
        grid_(static_cast<float>(kMaxTolerance)),
        log_ratio_(std::log(parameters.size_ratio)) {}

  void addView(const ModelFeatures& features, int view) {
    const cv::Mat descriptors = unitDescriptors(features.descriptors);
    has_orientations_ = has_orientations_ || !features.orientations.empty();
    for (int i = 0; i < features.count(); ++i) {
      const auto k = static_cast<size_t>(i);
      const Descriptor descriptor(descriptors.ptr<float>(i), descriptors.cols);
      int target = findCluster(descriptor, features.positions[k], features.sizes[k]);
      if (target < 0) {
        target = static_cast<int>(clusters_.size());
        clusters_.emplace_back();
        clusters_.back().descriptor = Eigen::VectorXf::Zero(descriptor.size());
        grid_.insert(features.positions[k], target);
      }
      add(features, k, descriptor, view, clusters_[static_cast<size_t>(target)]);
    }
  }

  ModelFeatures result() const {
    std::vector<int> order(clusters_.size());
    std::iota(order.begin(), order.end(), 0);
    const auto viewsOf = [this](int i) { return clusters_[static_cast<size_t>(i)].views; };
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return viewsOf(a) > viewsOf(b); });
    order.resize(std::min(order.size(), static_cast<size_t>(parameters_.max_features)));
    ModelFeatures merged;
    if (order.empty()) return merged;
    merged.descriptors.create(static_cast<int>(order.size()), static_cast<int>(clusters_.front().mean.size()),
                              CV_32FC1);
    for (size_t row = 0; row < order.size(); ++row) {
      const Cluster& cluster = clusters_[static_cast<size_t>(order[row])];
      std::copy(cluster.mean.begin(), cluster.mean.end(), merged.descriptors.ptr<float>(static_cast<int>(row)));
      merged.positions.push_back(cluster.meanPosition());
      merged.view_directions.push_back(cluster.view_direction.normalized());
      if (has_orientations_) merged.orientations.push_back(cluster.meanOrientation());
      merged.sizes.push_back(cluster.meanSize());
      merged.views.push_back(static_cast<std::uint16_t>(std::min(cluster.views, 65535)));
    }
    return merged;
  }

 private:
  // The most similar cluster that may take the feature, or -1.
  int findCluster(const Descriptor& descriptor, const Eigen::Vector3f& position, float size) const {
    const auto tolerance = static_cast<float>(
        std::min(kMaxTolerance, parameters_.distance + parameters_.size_share * static_cast<double>(size)));
    auto best_distance = static_cast<float>(parameters_.descriptor_distance * parameters_.descriptor_distance);
    int best = -1;
    grid_.forNeighbours(position, [&](int i) {
      const Cluster& cluster = clusters_[static_cast<size_t>(i)];
      if ((cluster.meanPosition() - position).squaredNorm() > tolerance * tolerance) return;
      if (std::abs(std::log(cluster.meanSize() / size)) > log_ratio_) return;
      const float distance = (cluster.mean - descriptor).squaredNorm();
      if (distance > best_distance) return;
      best_distance = distance;
      best = i;
    });
    return best;
  }

  static void add(const ModelFeatures& features, size_t k, const Descriptor& descriptor, int view, Cluster& cluster) {
    cluster.descriptor += descriptor;
    cluster.mean = cluster.descriptor.normalized();
    cluster.position += features.positions[k];
    cluster.view_direction += features.view_directions[k];
    if (!features.orientations.empty()) cluster.orientation += features.orientations[k];
    cluster.size += features.sizes[k];
    ++cluster.count;
    if (cluster.last_view != view) cluster.views += features.views.empty() ? 1 : features.views[k];
    cluster.last_view = view;
  }

  const MergingParameters& parameters_;
  bool has_orientations_ = false;
  std::vector<Cluster> clusters_;
  PointGrid grid_;
  double log_ratio_;
};

}  // namespace

ParameterList MergingParameters::list() {
  return {
      doubleParameter("merge_distance", "m", &distance, 0.0, 0.01, "features of two views nearer than this may be one"),
      doubleParameter("merge_size_share", "", &size_share, 0.0, 1.0,
                      "share of a feature's size added to merge_distance"),
      doubleParameter("merge_size_ratio", "", &size_ratio, 1.0, 4.0,
                      "largest ratio between the sizes of merged features"),
      doubleParameter("merge_descriptor_distance", "", &descriptor_distance, 0.0, 2.0,
                      "largest distance between the descriptors of merged features"),
      intParameter("max_model_features", "", &max_features, 10, 100000, "features kept an object and descriptor type")};
}

void MergingParameters::validate() const { validateParameters(MergingParameters(*this).list(), "training"); }

ModelFeatures mergeFeatures(const std::vector<ModelFeatures>& views, const MergingParameters& parameters) {
  parameters.validate();
  Merger merger(parameters);
  for (size_t view = 0; view < views.size(); ++view) merger.addView(views[view], static_cast<int>(view));
  return merger.result();
}

}  // namespace recognition
