#include "training/model_builder.h"

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "meshes/surface_sampling.h"
#include "training/feature_merging.h"
#include "training/training_view.h"
#include "features/feature_extractor.h"

namespace recognition {
namespace {

constexpr int kViewsAtATime = 16;  // between two calls of progress

using FeaturesByType = std::vector<ModelFeatures>;  // in the order of the types asked for

std::vector<std::unique_ptr<FeatureExtractor>> makeExtractors(FeatureParameters parameters,
                                                              const std::vector<DescriptorType>& types) {
  parameters.max_features = 0;  // a limit for scenes
  std::vector<std::unique_ptr<FeatureExtractor>> extractors;
  for (const DescriptorType type : types) {
    parameters.descriptor = type;
    extractors.push_back(makeFeatureExtractor(parameters));
  }
  return extractors;
}

}  // namespace

ParameterList TrainingParameters::list() {
  ParameterList list = {
      intParameter("views", "", &views, 4, 1000, "camera directions around the object"),
      doubleParameter("near_distance", "m", &near_distance, 0.1, 10.0, "of the nearest training camera"),
      doubleParameter("far_distance", "m", &far_distance, 0.1, 10.0, "of the farthest training camera"),
      intParameter("distances", "", &distances, 1, 8, "training distances, in geometric steps from near to far"),
      doubleParameter("focal_length", "px", &focal_length, 100.0, 5000.0, "of the training camera"),
      doubleParameter("blur", "px", &blur, 0.0, 5.0, "Gaussian sigma of the training images"),
      doubleParameter("largest_slant", "deg", &largest_slant, 10.0, 89.0,
                      "between surface normal and view of a training feature"),
      doubleParameter("outline_margin", "", &outline_margin, 0.0, 2.0,
                      "least distance of a feature from the outline, share of its size"),
      doubleParameter("point_spacing", "m", &point_spacing, 0.0005, 0.05, "of the cloud P"),
      intParameter("max_points", "", &max_points, 100, 1000000, "of the cloud P")};
  const ParameterList merge = merging.list();
  list.insert(list.end(), merge.begin(), merge.end());
  return list;
}

void TrainingParameters::validate() const {
  validateParameters(TrainingParameters(*this).list(), "training");
  if (far_distance < near_distance)
    throw std::invalid_argument("training/far_distance is less than training/near_distance");
}

ObjectModel buildModelFromMesh(const TexturedMesh& mesh, const std::string& name, const TrainingParameters& training,
                               const FeatureParameters& features, const std::vector<DescriptorType>& types,
                               const TrainingProgress& progress) {
  training.validate();
  const auto extractors = makeExtractors(features, types);
  ObjectModel model;
  model.name = name;
  model.cloud = sampleSurface(mesh, training.point_spacing, training.max_points);
  if (model.cloud.size() < 4) throw std::invalid_argument(name + ": no surface can be seen from outside");
  model.extents = computeExtents(model.cloud);

  const std::shared_ptr<const TexturedMesh> shared(std::shared_ptr<void>(), &mesh);
  const MeshRenderer renderer({{shared}});
  const std::vector<TrainingCamera> cameras = placeTrainingCameras(mesh, training);
  std::vector<FeaturesByType> by_type(types.size(), FeaturesByType(cameras.size()));
  const auto takeViews = [&](const cv::Range& range) {
    for (auto i = static_cast<size_t>(range.start); i < static_cast<size_t>(range.end); ++i) {
      const TrainingView view = renderTrainingView(renderer, cameras[i], training);
      for (size_t t = 0; t < types.size(); ++t)
        by_type[t][i] = placeOnSurface(extractors[t]->extract(view.gray, view.mask), view, renderer, training);
    }
  };
  const int count = static_cast<int>(cameras.size());
  for (int first = 0; first < count; first += kViewsAtATime) {
    if (progress) progress("rendering", static_cast<double>(first) / count);
    cv::parallel_for_(cv::Range(first, std::min(count, first + kViewsAtATime)), takeViews);
  }
  for (size_t t = 0; t < types.size(); ++t) model.features[types[t]] = mergeFeatures(by_type[t], training.merging);
  return model;
}

}  // namespace recognition
