#include "tools/bag_export.h"

#include <cmath>
#include <stdexcept>

#include "bags/bag_writer.h"
#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/evaluation/bop_dataset.h"

namespace recognition {
namespace {

std::map<std::string, Pose> posesOf(const std::vector<GroundTruth>& objects) {
  std::map<std::string, Pose> poses;
  for (const GroundTruth& object : objects) poses["obj_" + sixDigits(object.object_id)] = object.camera_from_object;
  return poses;
}

}  // namespace

void exportBag(const std::string& split_directory, const std::string& layout, const std::string& file,
               double interval) {
  if (layout != "challenge" && layout != "openni")
    throw std::invalid_argument("bag layout is '" + layout + "': must be challenge or openni");
  BagForm form;
  form.fast = true;
  form.depth_as_cloud = layout == "challenge";
  BagWriter bag(file, form.depth_as_cloud ? challengeTopics() : openniTopics(), form);
  double seconds = 1.0;
  for (const BopFrame& entry : readBopSplit(split_directory)) {
    RgbdFrame frame = loadBopFrame(entry);
    if (!form.depth_as_cloud) frame.depth.convertTo(frame.depth, CV_16U, 1000.0);
    const std::int64_t stamp = std::llround(1e9 * seconds);
    bag.write(frame, stamp);
    if (!entry.ground_truth.empty()) bag.writePoses(posesOf(entry.ground_truth), stamp);
    seconds += interval;
  }
  bag.close();
}

}  // namespace recognition
