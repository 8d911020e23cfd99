#pragma once

#include <map>
#include <string>

namespace recognition {

/// The images of one folder by the number in their names, however many digits it has ("000012.png", "12.tif").
class NumberedImages {
 public:
  /// A folder that is not there holds none.
  explicit NumberedImages(const std::string& folder);

  /// "" if there is none.
  std::string find(int number) const;
  const std::string& folder() const { return folder_; }
  bool empty() const { return files_.empty(); }

 private:
  std::string folder_;
  std::map<int, std::string> files_;
};

/// Where the files of one BOP scene are. Data sets of several sensors have the sensor's name behind those of files and
/// folders: rgb_photoneo, scene_camera_photoneo.json.
class BopSceneFiles {
 public:
  /// With `sensor` empty: the files without such a name, else those of the only sensor. Throws std::runtime_error that
  /// lists the sensors where it takes one to be chosen, or names what is missing.
  BopSceneFiles(const std::string& scene, const std::string& sensor);

  /// Whether the folder has a scene_camera.json, of any sensor.
  static bool hasCameras(const std::string& scene);

  std::string cameraFile() const { return fileNamed("scene_camera"); }
  /// "" if there is none.
  std::string groundTruthFile() const { return existing("scene_gt"); }
  std::string groundTruthInfoFile() const { return existing("scene_gt_info"); }

  const NumberedImages& color() const { return rgb_.empty() ? gray_ : rgb_; }
  const NumberedImages& depth() const { return depth_; }

 private:
  std::string folderNamed(const std::string& name) const;
  std::string fileNamed(const std::string& name) const;
  std::string existing(const std::string& name) const;

  std::string scene_, ending_;  // "_photoneo", or ""
  NumberedImages rgb_, gray_, depth_;
};

}  // namespace recognition
