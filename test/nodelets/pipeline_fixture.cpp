#include "nodelets/pipeline_fixture.h"

#include <memory>

#include <boost/make_shared.hpp>

#include "model/temporary_directory.h"
#include "rgbd_recognition/meshes/mesh.h"
#include "training/model_builder.h"
#include "rgbd_recognition/model/model_store.h"
#include "bags/bag_reader.h"
#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/features/feature_parameters.h"

namespace recognition {
namespace {

std::string makeFolder() {  // removed at the end of the process
  static std::vector<std::unique_ptr<TemporaryDirectory>> folders;
  folders.push_back(std::make_unique<TemporaryDirectory>());
  return folders.back()->string();
}

std::string train() {
  const std::string folder = makeFolder();
  const ModelStore store(folder);
  TrainingParameters training;
  training.views = 24;
  for (const BopModel& model : listBopModels(RGBD_TEST_DATA "/demo/models")) {
    if (model.name != kFirstObject && model.name != kSecondObject) continue;
    const FeatureParameters features;
    store.save(buildModelFromMesh(readMesh(model.file, 0.001), model.name, training, features, {features.descriptor}));
  }
  return folder;
}

std::string plainName(const std::string& name) { return name.substr(name.rfind('/') + 1); }

}  // namespace

const char* const kFirstObject = "003_cracker_box";
const char* const kSecondObject = "004_sugar_box";

std::string emptyFolder() { return makeFolder(); }

const std::string& trainedStore() {
  static const std::string store = train();
  return store;
}

std::vector<FrameMessages> demoFrames() {
  std::vector<FrameMessages> frames;
  BagReader reader(RGBD_TEST_DATA "/demo/recording.bag");
  RecordedFrame recorded;
  while (reader.next(&recorded)) {
    std_msgs::Header header;
    header.stamp.fromNSec(static_cast<std::uint64_t>(recorded.stamp));
    header.frame_id = recorded.frame_id;
    const auto color = imageMessage(recorded.frame.color, header);
    if (recorded.frame.color_order == ColorOrder::kRgb) color->encoding = "rgb8";
    const auto info = boost::make_shared<sensor_msgs::CameraInfo>(cameraInfo(recorded.frame.color_camera, header));
    frames.push_back({color, imageMessage(recorded.frame.depth, header), info});
  }
  return frames;
}

FrameMessages withStamp(const FrameMessages& frame, const ros::Time& stamp) {
  const auto color = boost::make_shared<sensor_msgs::Image>(*frame.color);
  const auto depth = boost::make_shared<sensor_msgs::Image>(*frame.depth);
  const auto info = boost::make_shared<sensor_msgs::CameraInfo>(*frame.camera_info);
  color->header.stamp = depth->header.stamp = info->header.stamp = stamp;
  return {color, depth, info};
}

bool waitFor(const std::function<bool()>& condition, double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

PipelineTest::PipelineTest() : loader_(std::make_unique<nodelet::Loader>(false)) {
  static int tests = 0;
  ns_ = "/test_" + std::to_string(++tests);
  node_ = ros::NodeHandle(ns_);
  color_ = node_.advertise<sensor_msgs::Image>("rgb/image_rect_color", 1);
  depth_ = node_.advertise<sensor_msgs::Image>("depth_registered/image_raw", 1);
  camera_info_ = node_.advertise<sensor_msgs::CameraInfo>("rgb/camera_info", 1);
  diagnostics_ = node_.subscribe("/diagnostics", 100, &PipelineTest::onDiagnostics, this);
  spinner_.start();
}

PipelineTest::~PipelineTest() {
  detections_.reset();
  loader_.reset();
  spinner_.stop();
  ros::param::del(ns_);
}

bool PipelineTest::load(const std::string& name, const std::map<std::string, std::string>& remappings) {
  return loadAs(name, name, remappings);
}

bool PipelineTest::loadAs(const std::string& name, const std::string& type,
                          const std::map<std::string, std::string>& remappings) {
  const bool of_package = type.find('/') != std::string::npos;
  return loader_->load(ns_ + "/" + name, of_package ? type : "rgbd_recognition/" + type, remappings, {});
}

void PipelineTest::loadPipeline() {
  setParam("models", trainedStore());
  for (const char* name : {"segmentation", "feature_extraction", "hypothesis_generation", "reprojection_verification"})
    ASSERT_TRUE(load(name)) << name;
  detections_ = std::make_unique<Recorder<messages::DetectionArray>>(node_, "detections");
}

void PipelineTest::waitForCamera() {
  ASSERT_TRUE(waitFor([this] {
    return color_.getNumSubscribers() + depth_.getNumSubscribers() + camera_info_.getNumSubscribers() == 3;
  }));
}

void PipelineTest::publish(const FrameMessages& frame) {
  if (frame.color) color_.publish(frame.color);
  if (frame.depth) depth_.publish(frame.depth);
  if (frame.camera_info) camera_info_.publish(frame.camera_info);
}

messages::DetectionArrayConstPtr PipelineTest::detect(const FrameMessages& frame) {
  messages::DetectionArrayConstPtr found;
  publish(frame);
  waitFor([&] { return (found = detections_->at(frame.color->header.stamp)) != nullptr; });
  return found;
}

void PipelineTest::onDiagnostics(const diagnostic_msgs::DiagnosticArrayConstPtr& array) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const auto& status : array->status) {
    const std::string name = status.name.substr(0, status.name.find(':'));
    if (name.find(ns_.substr(1) + "/") == std::string::npos) continue;
    told_[plainName(name)].insert(status.message);
    for (const auto& value : status.values) told_[plainName(name)].insert(value.key + "=" + value.value);
  }
}

bool PipelineTest::diagnosed(const std::string& nodelet, const std::string& text, double seconds) {
  return waitFor(
      [&] {
        const std::lock_guard<std::mutex> lock(mutex_);
        for (const std::string& line : told_[nodelet])
          if (line.find(text) != std::string::npos) return true;
        return false;
      },
      seconds);
}

double PipelineTest::largestDiagnosed(const std::string& nodelet, const std::string& key) {
  double largest = 0.0;
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const std::string& line : told_[nodelet])
    if (line.compare(0, key.size() + 1, key + "=") == 0)
      largest = std::max(largest, std::stod(line.substr(key.size() + 1)));
  return largest;
}

}  // namespace recognition
