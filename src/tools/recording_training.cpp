#include "recording_training.h"

#include <algorithm>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#ifdef RGBD_RECOGNITION_HAS_BAGS
#include "bag_source.h"
#endif

namespace rgbd_recognition {
namespace {

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
  auto* bags = app.add_option("--bags", options.bags, "folder of such recordings; each file's name is its object's")
                   ->check(CLI::ExistingDirectory)
                   ->excludes(name)
                   ->excludes(bag)
                   ->group(group);
  auto* topic = app.add_option("--color-topic", options.color_topic,
                               "colour images in the bag, if not openni's or the challenge's")
                    ->group(group);
  app.add_option("--info-topic", options.info_topic, "camera info of the colour images")->needs(topic)->group(group);
  app.add_option("--depth-topic", options.depth_topic, "registered depth images or organised clouds")
      ->needs(topic)
      ->group(group);
  auto* frames = app.add_option("--frames", options.frames, "as --bag, but a BOP split directory")
                     ->check(CLI::ExistingDirectory)
                     ->needs(name)
                     ->excludes(bag)
                     ->excludes(bags)
                     ->group(group);
  auto* board = app.add_option("--board", options.board, "fiducial board under the object, config/boards/*.yaml")
                    ->check(CLI::ExistingFile)
                    ->group(group);
  bag->needs(board);
  bags->needs(board);
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
  color->needs(depth)->needs(camera)->needs(mask)->excludes(bag)->excludes(bags)->excludes(frames);
}

std::vector<std::pair<std::string, std::string>> listRecordings(const RecordingOptions& options,
                                                                const std::string& name) {
  if (options.bags.empty())
    return {{name, !options.bag.empty() ? options.bag : !options.frames.empty() ? options.frames : options.color}};
  std::vector<std::pair<std::string, std::string>> recordings;
  for (const auto& entry : std::filesystem::directory_iterator(options.bags))
    if (entry.path().extension() == ".bag")
      recordings.emplace_back(entry.path().stem().string(), entry.path().string());
  if (recordings.empty()) throw std::runtime_error(options.bags + ": holds no .bag files");
  std::sort(recordings.begin(), recordings.end());
  return recordings;
}

std::unique_ptr<FrameSource> openRecording(const RecordingOptions& options, const std::string& file) {
  if (!options.frames.empty()) return openBopSource(file);
  if (!options.color.empty()) return openFileSource(file, options.depth, options.camera);
#ifdef RGBD_RECOGNITION_HAS_BAGS
  return openBagSource(file, options.color_topic, options.info_topic, options.depth_topic);
#else
  throw std::runtime_error(file + ": built without ROS, so bags cannot be read");
#endif
}

std::optional<FiducialBoard> readBoard(const RecordingOptions& options) {
  if (options.board.empty()) return std::nullopt;
  return FiducialBoard::fromYaml(options.board);
}

ViewSource viewsOf(FrameSource& source, const RecordingOptions& options) {
  return [&source, mask = readMask(options.mask)](RecordedView* view) {
    NamedFrame frame;
    if (!source.next(frame)) return false;
    *view = {frame.frame, std::nullopt, mask};
    return true;
  };
}

}  // namespace rgbd_recognition
