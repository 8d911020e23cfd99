#include "recording_training.h"

#include <memory>
#include <stdexcept>

#include <opencv2/imgcodecs.hpp>

#include "frame_source.h"
#include "progress_bar.h"
#ifdef RGBD_RECOGNITION_HAS_BAGS
#include "bag_source.h"
#endif

namespace rgbd_recognition {
namespace {

std::unique_ptr<FrameSource> openRecording(const RecordingOptions& options) {
  if (!options.frames.empty()) return openBopSource(options.frames);
  if (!options.color.empty()) return openFileSource(options.color, options.depth, options.camera);
#ifdef RGBD_RECOGNITION_HAS_BAGS
  return openBagSource(options.bag, options.color_topic, options.info_topic, options.depth_topic);
#else
  throw std::runtime_error("--bag: built without ROS, so bags cannot be read");
#endif
}

cv::Mat readMask(const std::string& file) {
  if (file.empty()) return {};
  const cv::Mat mask = cv::imread(file, cv::IMREAD_GRAYSCALE);
  if (mask.empty()) throw std::runtime_error(file + ": is no readable image");
  return mask > 0;
}

}  // namespace

void addRecordingOptions(CLI::App& app, RecordingOptions& options, CLI::Option* name) {
  const char* group = "Recordings";
  auto* bag = app.add_option("--bag", options.bag, "turntable recording of one object; needs --board")
                  ->check(CLI::ExistingFile)
                  ->needs(name)
                  ->group(group);
  auto* topic = app.add_option("--color-topic", options.color_topic,
                               "colour images in the bag, if not openni's or the challenge's")
                    ->needs(bag)
                    ->group(group);
  app.add_option("--info-topic", options.info_topic, "camera info of the colour images")->needs(topic)->group(group);
  app.add_option("--depth-topic", options.depth_topic, "registered depth images or organised clouds")
      ->needs(topic)
      ->group(group);
  auto* frames = app.add_option("--frames", options.frames, "as --bag, but a BOP split directory")
                     ->check(CLI::ExistingDirectory)
                     ->needs(name)
                     ->excludes(bag)
                     ->group(group);
  auto* board = app.add_option("--board", options.board, "fiducial board under the object, config/boards/*.yaml")
                    ->check(CLI::ExistingFile)
                    ->group(group);
  bag->needs(board);
  frames->needs(board);
  auto* color = app.add_option("--color", options.color, "one labelled view: colour image")
                    ->check(CLI::ExistingFile)
                    ->needs(name)
                    ->group(group);
  auto* depth = app.add_option("--depth", options.depth, "its registered depth, 16 bit, millimetres")
                    ->check(CLI::ExistingFile)
                    ->group(group);
  auto* camera = app.add_option("--camera", options.camera, "its camera")->check(CLI::ExistingFile)->group(group);
  auto* mask = app.add_option("--mask", options.mask, "its object: an image of depth's size, not 0 on the object")
                   ->check(CLI::ExistingFile)
                   ->group(group);
  color->needs(depth)->needs(camera)->needs(mask)->excludes(bag)->excludes(frames);
}

RecordedObject::Result trainFromRecording(const RecordingOptions& options, const std::string& name,
                                          const FeatureParameters& features, const std::vector<DescriptorType>& types) {
  std::optional<FiducialBoard> board;
  if (!options.board.empty()) board = FiducialBoard::fromYaml(options.board);
  const cv::Mat mask = readMask(options.mask);
  const auto source = openRecording(options);
  RecordedObject object(options.parameters, features, std::move(board));
  ProgressBar progress("reading", source->size());
  for (NamedFrame frame; source->next(frame);) {
    object.add({frame.frame, std::nullopt, mask});
    progress.advance(frame.name);
  }
  return object.build(name, types);
}

}  // namespace rgbd_recognition
