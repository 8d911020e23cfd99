#include "simulation/bop_writer.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "core/image_file.h"
#include "rgbd_recognition/evaluation/bop_dataset.h"

namespace recognition {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

const char* const kCsvHeader = "Ts,Run,Frame,dID,oID,R11,R12,R13,R21,R22,R23,R31,R32,R33,Tx,Ty,Tz";

void requireGood(const std::ostream& out, const fs::path& file) {
  if (!out) throw std::runtime_error(file.string() + ": cannot be written");
}

// Under another name first, so that the file is whole or absent.
void writeText(const fs::path& file, const std::string& text) {
  const fs::path unfinished = file.string() + "." + std::to_string(getpid()) + ".part";
  std::ofstream out(unfinished, std::ios::binary);
  out << text;
  out.close();
  requireGood(out, file);
  fs::rename(unfinished, file);
}

// Held by one thread of one process at a time.
class FileLock {
 public:
  explicit FileLock(const std::string& file) : descriptor_(open(file.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644)) {
    if (descriptor_ < 0 || flock(descriptor_, LOCK_EX) != 0) throw std::runtime_error(file + ": cannot be locked");
  }
  ~FileLock() { close(descriptor_); }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int descriptor_;
};

void writePng(const fs::path& file, const cv::Mat& image) {
  writeImage(file.string(), image, {cv::IMWRITE_PNG_COMPRESSION, 1});
}

ordered_json readJson(const fs::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file.string() + ": cannot be read");
  return ordered_json::parse(in);
}

ordered_json boxJson(const cv::Rect& box) { return {box.x, box.y, box.width, box.height}; }

ordered_json cameraJson(const CameraModel& camera) {
  return {{"cam_K", {camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0}}, {"depth_scale", 1.0}};
}

void addWorld(const Pose& camera_from_world, ordered_json* camera) {
  const Eigen::Matrix3d r = camera_from_world.linear();
  const Eigen::Vector3d t = 1000.0 * camera_from_world.translation();  // BOP: millimetres
  (*camera)["cam_R_w2c"] = {r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)};
  (*camera)["cam_t_w2c"] = {t.x(), t.y(), t.z()};
}

ordered_json poseJson(const AnnotatedObject& object) {
  const Eigen::Matrix3d r = object.camera_from_object.linear();
  const Eigen::Vector3d t = 1000.0 * object.camera_from_object.translation();  // BOP: millimetres
  return {{"cam_R_m2c", {r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)}},
          {"cam_t_m2c", {t.x(), t.y(), t.z()}},
          {"obj_id", object.object_id}};
}

ordered_json infoJson(const AnnotatedObject& object) {
  return {{"bbox_obj", boxJson(object.visibility.box_all)}, {"bbox_visib", boxJson(object.visibility.box_visible)},
          {"px_count_all", object.visibility.all},          {"px_count_valid", object.valid_depth},
          {"px_count_visib", object.visibility.visible},    {"visib_fract", object.visibility.fraction()}};
}

std::string csvRows(int scene, int frame, const ordered_json& objects) {
  std::string rows;
  for (size_t i = 0; i < objects.size(); ++i) {
    const auto& object = objects[i];
    rows += std::to_string(frame) + "," + std::to_string(scene) + "," + std::to_string(frame) + "," +
            object["obj_id"].dump() + "," + std::to_string(i);
    for (const auto& value : object["cam_R_m2c"]) rows += "," + value.dump();
    for (const auto& value : object["cam_t_m2c"]) rows += "," + ordered_json(value.get<double>() / 1000.0).dump();
    rows += "\n";
  }
  return rows;
}

}  // namespace

BopWriter::BopWriter(std::string directory, std::string split, int frames_per_scene)
    : directory_(std::move(directory)), split_(std::move(split)), frames_per_scene_(frames_per_scene) {
  if (frames_per_scene < 1) throw std::invalid_argument("frames per scene is " + std::to_string(frames_per_scene));
}

std::string BopWriter::sceneDirectory(int frame) const {
  return (fs::path(directory_) / split_ / sixDigits(1 + frame / frames_per_scene_)).string();
}

std::string BopWriter::fragmentFile(int frame) const {
  return (fs::path(directory_) / split_ / ".frames" / (sixDigits(frame) + ".json")).string();
}

std::string BopWriter::claimFile() const {
  return (fs::path(directory_) / split_ / ".frames" / "made_from.txt").string();
}

bool BopWriter::started() const { return fs::exists(claimFile()); }

void BopWriter::claim(const std::string& origin) const {
  const fs::path file = claimFile();
  if (fs::exists(file)) {
    std::ifstream in(file, std::ios::binary);
    const std::string earlier((std::istreambuf_iterator<char>(in)), {});
    if (earlier != origin)
      throw std::runtime_error(directory_ + ": holds frames made with other settings (" + file.string() + ")");
    return;
  }
  fs::create_directories(file.parent_path());
  writeText(file, origin);
}

bool BopWriter::has(int frame) const { return fs::exists(fragmentFile(frame)); }

void BopWriter::write(int frame, const AnnotatedFrame& annotated) const {
  const fs::path scene = sceneDirectory(frame);
  const std::string name = sixDigits(frame % frames_per_scene_) + ".png";
  for (const char* folder : {"rgb", "depth"}) fs::create_directories(scene / folder);
  fs::create_directories(fs::path(fragmentFile(frame)).parent_path());
  writePng(scene / "rgb" / name, annotated.frame.color);
  writePng(scene / "depth" / name, annotated.frame.depth);
  ordered_json poses = ordered_json::array(), infos = ordered_json::array();
  for (const AnnotatedObject& object : annotated.objects) {
    poses.push_back(poseJson(object));
    infos.push_back(infoJson(object));
  }
  ordered_json camera = cameraJson(annotated.frame.color_camera);
  if (annotated.camera_from_world) addWorld(*annotated.camera_from_world, &camera);
  const ordered_json fragment = {{"camera", camera}, {"gt", poses}, {"gt_info", infos}};
  writeText(fragmentFile(frame), fragment.dump(1));
  publish(frame / frames_per_scene_);
}

void BopWriter::publish(int scene) const {
  const fs::path lock_file = fs::path(claimFile()).parent_path() / "lock";
  const FileLock lock(lock_file.string());  // threads and processes write frames of one scene
  ordered_json cameras = ordered_json::object(), truths = cameras, infos = cameras;
  const int first = scene * frames_per_scene_;
  for (int frame = first; frame < first + frames_per_scene_; ++frame) {
    if (!has(frame)) continue;
    const ordered_json fragment = readJson(fragmentFile(frame));
    const std::string key = std::to_string(frame - first);
    cameras[key] = fragment["camera"];
    truths[key] = fragment["gt"];
    infos[key] = fragment["gt_info"];
  }
  const fs::path directory = sceneDirectory(first);
  writeText(directory / "scene_gt.json", truths.dump(1));
  writeText(directory / "scene_gt_info.json", infos.dump(1));
  writeText(directory / "scene_camera.json", cameras.dump(1));  // last: it names the frames
}

void BopWriter::finish(int count, bool partly) const {
  std::string csv = std::string(kCsvHeader) + "\n";
  for (int scene = 0; scene < scenesOf(count); ++scene) {
    const int first = scene * frames_per_scene_;
    bool any = false;
    for (int frame = first; frame < std::min(count, first + frames_per_scene_); ++frame) {
      if (partly && !has(frame)) continue;
      csv += csvRows(1 + scene, frame - first, readJson(fragmentFile(frame))["gt"]);
      any = true;
    }
    if (any) publish(scene);
  }
  writeText(fs::path(directory_) / (split_ + "_ground_truth.csv"), csv);
}

void BopWriter::copyModels(const std::string& models_directory) const {
  const fs::path target = fs::path(directory_) / "models";
  fs::create_directories(target);
  for (const auto& entry : fs::directory_iterator(models_directory))
    if (entry.is_regular_file())
      fs::copy_file(entry.path(), target / entry.path().filename(), fs::copy_options::overwrite_existing);
}

}  // namespace recognition
