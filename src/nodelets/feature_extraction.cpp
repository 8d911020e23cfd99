#include <pluginlib/class_list_macros.hpp>
#include <rgbd_recognition/FeatureExtractionConfig.h>

#include "features/feature_extractor.h"
#include "ros/frame_bundle.h"
#include "ros/message_conversions.h"
#include "ros/reconfigurable.h"
#include "ros/stage_nodelet.h"
#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/features/feature_parameters.h"

namespace recognition {

/// Second stage, Sec. V: texture features in the regions of interest, lifted to 3D.
class FeatureExtractionNodelet : public StageNodelet {
 private:
  void configure() override {
    parameters_.read(getPrivateNodeHandle(), stageParameterNames(),
                     [this](const FeatureParameters& parameters) { extractor_ = makeFeatureExtractor(parameters); });
  }

  void advertise() override {
    ros::NodeHandle& node = getPrivateNodeHandle();
    parameters_.serve(node);
    output_.advertise([&](auto message, const char* topic) { return advertiseLazy<decltype(message)>(node, topic); },
                      true);
  }

  void startInputs() override {
    input_.subscribe(getNodeHandle(), "segmentation", false, [this](const FrameBundle& bundle) { process(bundle); });
  }
  void stopInputs() override { input_.unsubscribe(); }

  void process(FrameBundle bundle) {
    const Stopwatch watch;
    try {
      const RgbdFrame frame = frameView(bundle.images);
      const Segmentation segmentation = fromMessage(*bundle.segmentation);
      const SceneFeatures features =
          extractSceneFeatures(*extractor_, parameters_.current(), frame, depthInMetres(frame.depth), segmentation);
      bundle.features = toMessage(features, bundle.header());
      processed(bundle.header(), watch.seconds());
      output_.publish(bundle);
    } catch (const std::exception& error) {
      reject("segmentation", error.what());
    }
  }

  Reconfigurable<rgbd_recognition::FeatureExtractionConfig, FeatureParameters> parameters_;
  std::unique_ptr<FeatureExtractor> extractor_;
  FrameBundleInput input_;
  FrameBundleOutput output_;
};

}  // namespace recognition

PLUGINLIB_EXPORT_CLASS(recognition::FeatureExtractionNodelet, nodelet::Nodelet)
