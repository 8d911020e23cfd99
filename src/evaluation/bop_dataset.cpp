#include "rgbd_recognition/evaluation/bop_dataset.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <set>
#include <stdexcept>

#include "evaluation/bop_scene_files.h"
#include "evaluation/camera_file.h"
#include "evaluation/json_file.h"

namespace recognition {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

[[noreturn]] void fail(const std::string& file, const std::string& reason) {
  throw std::runtime_error(file + ": " + reason);
}

Pose readPose(const json& entry) {
  const std::vector<double> r = numbersOf(entry, "cam_R_m2c", 9), t = numbersOf(entry, "cam_t_m2c", 3);
  Pose pose = Pose::Identity();
  for (int i = 0; i < 9; ++i) pose.linear()(i / 3, i % 3) = r[static_cast<size_t>(i)];
  pose.translation() = Eigen::Vector3d(t[0], t[1], t[2]) * 0.001;  // BOP: millimetres
  return pose;
}

std::vector<GroundTruth> readGroundTruth(const json& instances, const json& info) {
  std::vector<GroundTruth> result;
  if (!instances.is_array()) throw std::runtime_error("its ground truth is no list");
  for (size_t i = 0; i < instances.size(); ++i) {
    GroundTruth truth;
    truth.object_id = static_cast<int>(numberOf(instances[i], "obj_id"));
    truth.camera_from_object = readPose(instances[i]);
    if (info.is_array() && i < info.size() && info[i].contains("visib_fract"))
      truth.visibility = numberOf(info[i], "visib_fract");
    result.push_back(truth);
  }
  return result;
}

/// Scene and frame.
using Targets = std::set<std::pair<int, int>>;

/// The frames of one scene, into a split; those of `targets` only, if there are such.
class SceneReader {
 public:
  SceneReader(const fs::path& scene, const std::string& sensor, const std::optional<Targets>& targets)
      : scene_(scene),
        targets_(targets),
        files_(scene.string(), sensor),
        truths_(fileOrNothing(files_.groundTruthFile())),
        infos_(fileOrNothing(files_.groundTruthInfoFile())) {}

  void read(BopSplit* split) const {
    const json cameras = readJsonFile(files_.cameraFile());
    for (const auto& [key, camera] : cameras.items()) {
      try {
        readFrame(key, camera, split);
      } catch (const std::exception& error) {
        fail(files_.cameraFile(), "frame '" + key + "': " + error.what());
      }
    }
  }

 private:
  static json fileOrNothing(const std::string& file) { return file.empty() ? json::object() : readJsonFile(file); }

  void readFrame(const std::string& key, const json& camera, BopSplit* split) const {
    if (key.empty() || key.size() > 9 || key.find_first_not_of("0123456789") != std::string::npos)
      throw std::runtime_error("is no number");
    BopFrame frame;
    frame.scene = std::stoi(scene_.filename().string());
    frame.frame = std::stoi(key);
    if (targets_ && targets_->count({frame.scene, frame.frame}) == 0) return;
    frame.color_file = files_.color().find(frame.frame);
    frame.depth_file = files_.depth().find(frame.frame);
    const CameraFile file = cameraFromJson(camera);
    frame.camera = file.camera;
    frame.depth_scale = file.depth_scale;
    frame.has_ground_truth = truths_.contains(key);
    if (frame.has_ground_truth)
      frame.ground_truth = readGroundTruth(truths_.at(key), infos_.contains(key) ? infos_.at(key) : json::array());
    const std::string missing = frame.color_file.empty()   ? "colour image in " + files_.color().folder()
                                : frame.depth_file.empty() ? "depth image in " + files_.depth().folder()
                                                           : "";
    if (missing.empty())
      split->frames.push_back(frame);
    else
      split->missing.push_back(frame.name() + ": no " + missing);
  }

  const fs::path scene_;
  const std::optional<Targets>& targets_;
  const BopSceneFiles files_;
  const json truths_, infos_;
};

/// The data set's list of the frames that count, if it has one for this split.
std::string targetsFileOf(const fs::path& split_directory) {
  const fs::path split = fs::absolute(split_directory).lexically_normal();
  const fs::path folder = split.has_filename() ? split : split.parent_path();
  if (folder.filename().string().rfind("test", 0) != 0) return "";
  for (const char* name : {"test_targets_bop19.json", "test_targets_bop24.json"})
    if (fs::exists(folder.parent_path() / name)) return (folder.parent_path() / name).string();
  return "";
}

Targets readTargets(const std::string& file) {
  Targets targets;
  try {
    for (const json& target : readJsonFile(file))
      targets.emplace(static_cast<int>(numberOf(target, "scene_id")), static_cast<int>(numberOf(target, "im_id")));
  } catch (const std::runtime_error& error) {
    const std::string reason = error.what();
    throw std::runtime_error(reason.rfind(file, 0) == 0 ? reason : file + ": " + reason);
  }
  return targets;
}

bool isScene(const fs::directory_entry& entry) {
  const std::string name = entry.path().filename().string();
  return entry.is_directory() && !name.empty() && name.size() <= 9 &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c); });
}

}  // namespace

std::string sixDigits(int number) {
  char text[16];
  std::snprintf(text, sizeof text, "%06d", number);
  return text;
}

std::string BopFrame::name() const { return sixDigits(scene) + "/" + sixDigits(frame); }

BopSplit openBopSplit(const std::string& split_directory, const BopSplitOptions& options) {
  if (!fs::is_directory(split_directory)) fail(split_directory, "is no directory");
  BopSplit split;
  std::optional<Targets> targets;
  if (options.only_targets) split.targets_file = targetsFileOf(split_directory);
  if (!split.targets_file.empty()) targets = readTargets(split.targets_file);
  bool has_scenes = false;
  for (const auto& entry : fs::directory_iterator(split_directory)) {
    if (!isScene(entry)) continue;
    has_scenes = true;
    if (BopSceneFiles::hasCameras(entry.path().string()))
      SceneReader(entry.path(), options.sensor, targets).read(&split);
    else
      split.missing.push_back(entry.path().filename().string() + ": no scene_camera.json");
  }
  if (!has_scenes)
    fail(split_directory, BopSceneFiles::hasCameras(split_directory)
                              ? "is a scene itself; give the folder that holds it"
                              : "holds no scene folders (NNNNNN with scene_camera.json)");
  std::sort(split.missing.begin(), split.missing.end());
  if (split.frames.empty() && !split.missing.empty())
    fail(split_directory, "no frame is there: " + describeMissing(split));
  if (split.frames.empty() && targets) fail(split.targets_file, "names none of the frames that are there");
  if (split.frames.empty()) fail(split_directory, "its scenes list no frames");
  std::sort(split.frames.begin(), split.frames.end(), [](const BopFrame& a, const BopFrame& b) {
    return std::make_pair(a.scene, a.frame) < std::make_pair(b.scene, b.frame);
  });
  return split;
}

std::vector<BopFrame> readBopSplit(const std::string& split_directory) { return openBopSplit(split_directory).frames; }

std::string describeMissing(const BopSplit& split) {
  constexpr size_t kShown = 3;
  std::string text;
  for (size_t i = 0; i < std::min(kShown, split.missing.size()); ++i) text += (i > 0 ? ", " : "") + split.missing[i];
  if (split.missing.size() > kShown) text += ", and " + std::to_string(split.missing.size() - kShown) + " more";
  return text;
}

}  // namespace recognition
