#include "features/feature_extractor.h"

#include "features/lifting.h"

#include "features/extractors.h"

namespace recognition {

ParameterList FeatureParameters::list() {
  return {
      choiceParameter("descriptor", &descriptor, {"surf128", "surf64", "sift"},
                      "Kind of feature; n of eq. (5) is 128, 64, 128"),
      boolParameter("use_regions", &use_regions, "Features only inside the regions of interest"),
      intParameter("region_margin", "px", &region_margin, 0, 50, "Depth pixels by which the regions grow"),
      intParameter("max_features", "", &max_features, 0, 100000, "Strongest features kept; 0 keeps all"),
      doubleParameter("surf_hessian_threshold", "", &surf.hessian_threshold, 0.0, 1000.0,
                      "Least determinant of the Hessian"),
      intParameter("surf_octaves", "", &surf.octaves, 1, 6, "Octaves of scale space"),
      intParameter("surf_layers", "", &surf.layers, 1, 6, "Scales an octave that can hold a keypoint"),
      intParameter("surf_sampling_step", "px", &surf.sampling_step, 1, 4, "Pixels between samples in the first octave"),
      intParameter("surf_double_below_width", "px", &surf.double_below_width, 0, 10000,
                   "Narrower images are doubled first; 0: never"),
      boolParameter("surf_upright", &surf.upright, "No orientation"),
      boolParameter("surf_overlap", &surf.overlap, "Overlapping sub-regions (M-SURF) in place of the article's"),
      intParameter("sift_layers", "", &sift.layers, 1, 10, "Layers an octave"),
      doubleParameter("sift_contrast_threshold", "", &sift.contrast_threshold, 0.0, 1.0,
                      "Weakest contrast, times the layers"),
      doubleParameter("sift_edge_threshold", "", &sift.edge_threshold, 1.0, 1000.0,
                      "Largest ratio of principal curvatures"),
      doubleParameter("sift_sigma", "px", &sift.sigma, 0.5, 10.0, "Smoothing of the doubled image"),
      boolParameter("sift_root", &sift.root, "Square roots of the L1-normalised descriptor"),
      intParameter("max_hole", "px", &lifting.max_hole, 0, 20,
                   "Depth pixels to the nearest valid depth that may be bridged"),
      doubleParameter("jump", "m", &lifting.jump, 0.001, 1.0, "Step in depth that parts two surfaces under a feature"),
      doubleParameter("foreground", "", &lifting.foreground, 0.01, 1.0,
                      "Share of weight from which the nearer surface owns a feature"),
  };
}

void FeatureParameters::validate() const {
  FeatureParameters copy = *this;
  validateParameters(copy.list(), "feature_extraction");
}

std::unique_ptr<FeatureExtractor> makeFeatureExtractor(const FeatureParameters& parameters) {
  parameters.validate();
  if (parameters.descriptor == DescriptorType::kSift)
    return makeSiftExtractor(parameters.sift, parameters.max_features);
  return makeSurfExtractor(parameters.surf, parameters.descriptor, parameters.max_features);
}

SceneFeatures extractSceneFeatures(const FeatureExtractor& extractor, const FeatureParameters& parameters,
                                   const RgbdFrame& frame, const cv::Mat& depth, const Segmentation& segmentation) {
  requireSameSize(segmentation, depth);
  const int k = frame.colorPerDepthPixel();
  cv::Mat mask;
  if (parameters.use_regions) mask = regionMask(segmentation, frame.color.size(), k, parameters.region_margin);
  const ImageFeatures features = extractor.extract(toGray(frame.color, frame.color_order), mask);
  return liftFeatures(features, depth, frame.depthCamera(), k, parameters.lifting);
}

}  // namespace recognition
