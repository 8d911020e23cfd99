#include "tools/recording_training.h"

#include <algorithm>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include <yaml-cpp/yaml.h>

#ifdef RGBD_RECOGNITION_HAS_BAGS
#include "tools/bag_source.h"
#endif

namespace recognition {
namespace {

cv::Mat readMask(const std::string& file) {
  if (file.empty()) return {};
  const cv::Mat mask = cv::imread(file, cv::IMREAD_GRAYSCALE);
  if (mask.empty()) throw std::runtime_error(file + ": is no readable image");
  return mask > 0;
}

Pose readPose(const std::string& file, const std::string& key) {
  try {
    const YAML::Node rows = YAML::LoadFile(file)[key];
    if (!rows || rows.size() != 3) throw std::runtime_error("has no '" + key + "' with three rows");
    Pose pose = Pose::Identity();
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c) pose(r, c) = rows[r][c].as<double>();
    if (!(pose.linear() * pose.linear().transpose()).isIdentity(1e-4) || pose.linear().determinant() < 0.0)
      throw std::runtime_error("'" + key + "' is no rotation and translation");
    return pose;
  } catch (const std::exception& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
}

// The world of a recording without a board: the object's frame, moved to where the object stands.
Pose objectFromStand(const RecordingOptions& options) {
  if (options.stands_at.empty()) return Pose::Identity();
  return Pose(Eigen::Translation3d(options.stands_at[0], options.stands_at[1], options.stands_at[2]));
}

constexpr const char* kGroup = "Recordings";

/// Where the frames of a recording come from.
struct FrameOptions {
  CLI::Option *bag, *bags, *frames;
};

FrameOptions addFrameOptions(CLI::App& app, RecordingOptions& options, CLI::Option* name) {
  auto* bag = app.add_option("--bag", options.bag, "recording of one object; needs --board or --object-frame")
                  ->check(CLI::ExistingFile)
                  ->needs(name)
                  ->group(kGroup);
  auto* bags = app.add_option("--bags", options.bags, "folder of such recordings; each file's name is its object's")
                   ->check(CLI::ExistingDirectory)
                   ->excludes(name)
                   ->excludes(bag)
                   ->group(kGroup);
  auto* topic = app.add_option("--color-topic", options.color_topic,
                               "colour images in the bag, if not openni's or the challenge's")
                    ->group(kGroup);
  app.add_option("--info-topic", options.info_topic, "camera info of the colour images")->needs(topic)->group(kGroup);
  app.add_option("--depth-topic", options.depth_topic, "registered depth images or organised clouds")
      ->needs(topic)
      ->group(kGroup);
  app.add_option("--max-interval", options.max_interval, "in a bag, between a colour image and its depth, seconds")
      ->check(CLI::PositiveNumber)
      ->capture_default_str()
      ->group(kGroup);
  auto* frames = app.add_option("--frames", options.frames, "a BOP split directory; needs --board or --object-id")
                     ->check(CLI::ExistingDirectory)
                     ->needs(name)
                     ->excludes(bag)
                     ->excludes(bags)
                     ->group(kGroup);
  return {bag, bags, frames};
}

/// What tells the camera's pose, and where the object is.
struct PlaceOptions {
  CLI::Option *board, *object_frame, *object_id, *stands_at;
};

PlaceOptions addPlaceOptions(CLI::App& app, RecordingOptions& options, const FrameOptions& from) {
  auto* board = app.add_option("--board", options.board, "fiducial board under the object, config/boards/*.yaml")
                    ->check(CLI::ExistingFile)
                    ->group(kGroup);
  app.add_option("--board-from-object", options.board_from_object,
                 "yaml of the object's pose on the board, as `simulate turntable` writes it: the model gets that frame")
      ->check(CLI::ExistingFile)
      ->needs(board)
      ->group(kGroup);
  auto* tf = app.add_option("--object-frame", options.object_frame,
                            "without a board: the object's frame in the bag's tf, z up; the model gets that frame")
                 ->excludes(board)
                 ->excludes(from.frames)
                 ->group(kGroup);
  auto* id = app.add_option("--object-id", options.object_id,
                            "without a board: the object whose poses stand in scene_gt.json; the model gets its frame")
                 ->needs(from.frames)
                 ->excludes(board)
                 ->group(kGroup);
  auto* stands = app.add_option("--stands-at", options.stands_at,
                                "without a board: where in its frame the object stands, x,y,z in metres [0,0,0]")
                     ->delimiter(',')
                     ->expected(3)
                     ->excludes(board)
                     ->group(kGroup);
  return {board, tf, id, stands};
}

/// Throws what CLI11 reports, if frames come without a place.
void checkPlace(const FrameOptions& from, const PlaceOptions& place) {
  const bool recorded = *from.bag || *from.bags || *from.frames;
  if (recorded && !*place.board && !*place.object_frame && !*place.object_id)
    throw CLI::RequiredError(*from.frames ? "--board or --object-id" : "--board or --object-frame");
  if (*place.stands_at && !*place.object_frame && !*place.object_id)
    throw CLI::RequiresError("--stands-at", "--object-frame or --object-id");
  if (*place.object_frame && !*from.bag && !*from.bags) throw CLI::RequiresError("--object-frame", "--bag or --bags");
}

void addViewOptions(CLI::App& app, RecordingOptions& options, CLI::Option* name, const FrameOptions& from) {
  auto* color = app.add_option("--color", options.color, "one labelled view: colour image")
                    ->check(CLI::ExistingFile)
                    ->needs(name)
                    ->group(kGroup);
  auto* depth = app.add_option("--depth", options.depth, "its registered depth, 16 bit, millimetres")
                    ->check(CLI::ExistingFile)
                    ->group(kGroup);
  auto* camera = app.add_option("--camera", options.camera, "its camera: JSON, yaml, ini, or nine numbers")
                     ->check(CLI::ExistingFile)
                     ->group(kGroup);
  auto* mask = app.add_option("--mask", options.mask, "its object: an image of depth's size, not 0 on the object")
                   ->check(CLI::ExistingFile)
                   ->group(kGroup);
  color->needs(depth)->needs(camera)->needs(mask)->excludes(from.bag)->excludes(from.bags)->excludes(from.frames);
}

}  // namespace

void addRecordingOptions(CLI::App& app, RecordingOptions& options, CLI::Option* name) {
  const FrameOptions from = addFrameOptions(app, options, name);
  const PlaceOptions place = addPlaceOptions(app, options, from);
  app.final_callback([=] { checkPlace(from, place); });
  addViewOptions(app, options, name, from);
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
  if (!options.frames.empty()) return openBopSource(file, {}, options.object_id);
  if (!options.color.empty()) return openFileSource(file, options.depth, options.camera);
#ifdef RGBD_RECOGNITION_HAS_BAGS
  return openBagSource(file, {options.color_topic, options.info_topic, options.depth_topic, options.max_interval},
                       options.object_frame);
#else
  throw std::runtime_error(file + ": built without ROS, so bags cannot be read");
#endif
}

std::optional<FiducialBoard> readBoard(const RecordingOptions& options) {
  if (options.board.empty()) return std::nullopt;
  return FiducialBoard::fromYaml(options.board);
}

std::optional<Pose> readWorldFromObject(const RecordingOptions& options) {
  if (!options.board_from_object.empty()) return readPose(options.board_from_object, "board_from_object");
  if (options.object_frame.empty() && !options.object_id) return std::nullopt;
  return objectFromStand(options).inverse();
}

ViewSource viewsOf(FrameSource& source, const RecordingOptions& options) {
  return [&source, object_from_world = objectFromStand(options), mask = readMask(options.mask)](RecordedView* view) {
    NamedFrame frame;
    if (!source.next(frame)) return false;
    *view = {frame.frame, std::nullopt, mask};
    if (frame.camera_from_object) view->camera_from_world = *frame.camera_from_object * object_from_world;
    return true;
  };
}

}  // namespace recognition
