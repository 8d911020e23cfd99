#include "matching/correspondence_search.h"

#include <algorithm>
#include <cmath>

#include "matching/descriptor_index.h"

namespace recognition {
namespace {

using Pairs = std::vector<Correspondence>;

void sortByDistance(Pairs& pairs) {
  std::sort(pairs.begin(), pairs.end(), [](const Correspondence& a, const Correspondence& b) {
    if (a.distance != b.distance) return a.distance < b.distance;
    return a.scene_feature != b.scene_feature ? a.scene_feature < b.scene_feature : a.model_feature < b.model_feature;
  });
}

/// Sizes of model features that agree with a scene feature's; all where that is unknown.
SizeRange agreeingSizes(float scene_size, double tolerance) {
  if (!(scene_size > 0.0f)) return {};
  return {static_cast<float>(scene_size / tolerance), static_cast<float>(scene_size * tolerance)};
}

/// Whether two features are of one size in metres, as far as both are known.
bool sizesAgree(float scene_size, float model_size, double tolerance) {
  return !(model_size > 0.0f) || agreeingSizes(scene_size, tolerance).meets({model_size, model_size});
}

float modelSize(const ModelFeatures& model, int feature) {
  return model.sizes.empty() ? 0.0f : model.sizes[static_cast<size_t>(feature)];
}

/// The paper's direction: each model feature, its nearest scene feature.
class ExhaustiveSearch : public CorrespondenceSearch {
 public:
  ExhaustiveSearch(const MatchingParameters& parameters, const std::vector<const ModelFeatures*>& models)
      : parameters_(parameters), models_(models) {
    for (const ModelFeatures* model : models) rows_.push_back(quantize(model->descriptors));
  }

  SceneMatches match(const SceneFeatures& scene) const override {
    SceneMatches matches;
    matches.by_object.resize(models_.size());
    if (scene.points.empty()) return matches;
    const DescriptorIndex scene_index({scene.image.descriptors}, scene.image.descriptors.cols);
    const std::vector<float> sizes = metricSizes(scene);
    cv::parallel_for_(cv::Range(0, static_cast<int>(models_.size())), [&](const cv::Range& range) {
      for (int object = range.start; object < range.end; ++object)
        matches.by_object[object] = matchObject(object, scene_index, sizes);
    });
    return matches;
  }

  size_t bytes() const override {
    size_t sum = 0;
    for (const QuantizedRows& rows : rows_) sum += rows.values.size() + 2 * sizeof(std::int32_t) * rows.norms.size();
    return sum;
  }

 private:
  Pairs matchObject(int object, const DescriptorIndex& scene_index, const std::vector<float>& sizes) const {
    const QuantizedRows& rows = rows_[object];
    const std::vector<NearestRows> nearest = scene_index.nearest(rows, 1, parameters_.delta_f);
    Pairs pairs;
    for (int feature = 0; feature < rows.count(); ++feature) {
      if (nearest[feature].rows().empty()) continue;
      const RankedRow best = nearest[feature].rows().front();
      const auto scene_feature = static_cast<int>(rowOf(best));
      if (!sizesAgree(sizes[scene_feature], modelSize(*models_[object], feature), parameters_.size_tolerance)) continue;
      pairs.push_back({scene_feature, feature, distanceFromScore(rows.norms[feature], scoreOf(best))});
    }
    sortByDistance(pairs);
    return pairs;
  }

  MatchingParameters parameters_;
  std::vector<const ModelFeatures*> models_;
  std::vector<QuantizedRows> rows_;
};

/// The fast direction: each scene feature, its nearest features over all models.
class IndexSearch : public CorrespondenceSearch {
 public:
  IndexSearch(const MatchingParameters& parameters, const std::vector<const ModelFeatures*>& models, int length)
      : parameters_(parameters), models_(models), index_(descriptorsOf(models), length, {}, sizesOf(models)) {
    for (size_t object = 0; object < models.size(); ++object)
      first_row_.push_back(object == 0 ? 0 : first_row_.back() + models[object - 1]->count());
  }

  SceneMatches match(const SceneFeatures& scene) const override {
    SceneMatches matches;
    matches.by_object.resize(models_.size());
    if (scene.points.empty() || index_.count() == 0) return matches;
    const QuantizedRows queries = quantize(scene.image.descriptors);
    const std::vector<float> sizes = metricSizes(scene);
    std::vector<SizeRange> ranges;
    for (const float size : sizes) ranges.push_back(agreeingSizes(size, parameters_.size_tolerance));
    const std::vector<NearestRows> nearest =
        index_.nearest(queries, parameters_.neighbors, parameters_.delta_f, ranges);
    for (int feature = 0; feature < queries.count(); ++feature)
      for (const Found& found : choose(nearest[feature], feature, queries.norms[feature], sizes[feature]))
        matches.by_object[found.object].push_back(found.pair);
    for (Pairs& pairs : matches.by_object) sortByDistance(pairs);
    return matches;
  }

  size_t bytes() const override { return index_.bytes(); }

 private:
  struct Found {
    int object;
    Correspondence pair;
  };

  static std::vector<cv::Mat> descriptorsOf(const std::vector<const ModelFeatures*>& models) {
    std::vector<cv::Mat> descriptors;
    for (const ModelFeatures* model : models) descriptors.push_back(model->descriptors);
    return descriptors;
  }

  static std::vector<std::vector<float>> sizesOf(const std::vector<const ModelFeatures*>& models) {
    std::vector<std::vector<float>> sizes;
    for (const ModelFeatures* model : models) sizes.push_back(model->sizes);
    return sizes;
  }

  std::vector<Found> choose(const NearestRows& nearest, int scene_feature, std::int32_t norm, float size) const {
    std::vector<Found> found;
    double limit = 0.0;
    for (const RankedRow row : nearest.rows()) {
      const int object = objectOf(rowOf(row));
      const int feature = static_cast<int>(rowOf(row)) - first_row_[object];
      if (!sizesAgree(size, modelSize(*models_[object], feature), parameters_.size_tolerance)) continue;
      const float distance = distanceFromScore(norm, scoreOf(row));
      if (found.empty()) limit = parameters_.neighbor_ratio * distance;
      if (distance > limit) break;
      const auto same_object = [object](const Found& f) { return f.object == object; };
      if (std::count_if(found.begin(), found.end(), same_object) >= parameters_.neighbors_per_object) continue;
      found.push_back({object, {scene_feature, feature, distance}});
    }
    return found;
  }

  int objectOf(std::uint32_t row) const {
    return static_cast<int>(std::upper_bound(first_row_.begin(), first_row_.end(), static_cast<int>(row)) -
                            first_row_.begin()) -
           1;
  }

  MatchingParameters parameters_;
  std::vector<const ModelFeatures*> models_;
  DescriptorIndex index_;
  std::vector<int> first_row_;  ///< of each object in the index
};

}  // namespace

std::unique_ptr<CorrespondenceSearch> makeCorrespondenceSearch(const MatchingParameters& parameters,
                                                               const std::vector<const ModelFeatures*>& models,
                                                               int length) {
  if (parameters.search == SearchMode::kExhaustive) return std::make_unique<ExhaustiveSearch>(parameters, models);
  return std::make_unique<IndexSearch>(parameters, models, length);
}

std::vector<float> metricSizes(const SceneFeatures& scene) {
  std::vector<float> sizes(scene.points.size(), 0.0f);
  if (!(scene.focal_length > 0.0f)) return sizes;
  for (size_t i = 0; i < sizes.size(); ++i)
    sizes[i] = scene.image.keypoints[i].size * scene.points[i].z() / scene.focal_length;
  return sizes;
}

}  // namespace recognition
