#include "simulation/kinect.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <stdexcept>

#include "simulation/lit_renderer.h"

namespace recognition {
namespace {

constexpr int kDepthColumns = 640;
constexpr int kDepthRows = 480;

CameraModel makeColorCamera(const KinectParameters& p) {
  CameraModel camera;
  const bool full = p.color_mode == ColorMode::kSxga;
  camera.width = full ? 2 * kDepthColumns : kDepthColumns;
  camera.height = full ? 1024 : kDepthRows;
  camera.fx = camera.fy = p.color_focal_length * camera.width / (2.0 * kDepthColumns);
  camera.cx = (camera.width - 1) / 2.0;
  camera.cy = ((full ? 2 * kDepthRows : kDepthRows) - 1) / 2.0;  // the centre of what depth covers
  return camera;
}

CameraModel makeDepthCamera(const CameraModel& color) {
  CameraModel camera = color.scaled(static_cast<double>(kDepthColumns) / color.width);
  camera.height = kDepthRows;
  return camera;
}

void readGroup(const YAML::Node& node, const std::string& group, const ParameterList& parameters) {
  if (!node.IsMap()) throw std::invalid_argument(group + " is no map of parameters");
  for (const auto& entry : node) {
    const auto name = entry.first.as<std::string>();
    const auto found =
        std::find_if(parameters.begin(), parameters.end(), [&name](const Parameter& p) { return p.name == name; });
    if (found == parameters.end()) throw std::invalid_argument(group + "/" + name + " is no known parameter");
    if (!entry.second.IsScalar()) throw std::invalid_argument(group + "/" + name + " is no single value");
    setFromText(*found, entry.second.Scalar(), group);
  }
}

}  // namespace

ParameterList KinectParameters::list() {
  return {
      choiceParameter("color_mode", &color_mode, {"vga", "sxga"}, "640x480 or 1280x1024"),
      doubleParameter("color_focal_length", "px", &color_focal_length, 100.0, 10000.0,
                      "of the colour camera at 1280 columns"),
      intParameter("samples", "", &samples, 1, 8, "rays a pixel and direction for colour"),
  };
}

void KinectParameters::validate() const {
  KinectParameters copy = *this;
  validateParameters(copy.list(), "kinect");
  color.validate();
  depth.validate();
}

std::string KinectParameters::text() const {
  KinectParameters copy = *this;
  const std::pair<const char*, ParameterList> groups[] = {
      {"kinect", copy.list()}, {"color_sensor", copy.color.list()}, {"depth_sensor", copy.depth.list()}};
  std::string text;
  for (const auto& [name, parameters] : groups) {
    text += std::string(name) + ":\n";
    for (const Parameter& p : parameters) text += "  " + p.name + ": " + valueText(p) + "\n";
  }
  return text;
}

KinectParameters KinectParameters::fromYaml(const std::string& file) {
  KinectParameters parameters;
  try {
    for (const auto& entry : YAML::LoadFile(file)) {
      const auto group = entry.first.as<std::string>();
      if (group == "kinect")
        readGroup(entry.second, group, parameters.list());
      else if (group == "color_sensor")
        readGroup(entry.second, group, parameters.color.list());
      else if (group == "depth_sensor")
        readGroup(entry.second, group, parameters.depth.list());
      else
        throw std::invalid_argument(group + " is no group of parameters");
    }
    parameters.validate();
  } catch (const std::exception& error) {
    throw std::invalid_argument(file + ": " + error.what());
  }
  return parameters;
}

SimulatedKinect::SimulatedKinect(const KinectParameters& parameters)
    : parameters_(parameters),
      color_sensor_(parameters.color),
      depth_sensor_(parameters.depth),
      color_camera_(makeColorCamera(parameters)),
      depth_camera_(makeDepthCamera(color_camera_)) {
  parameters_.validate();
}

RgbdFrame SimulatedKinect::capture(const RayScene& scene, std::uint64_t seed, std::uint64_t camera_seed,
                                   const Exposure& exposure) const {
  RgbdFrame frame;
  cv::Mat radiance = renderRadiance(scene, color_camera_, parameters_.samples);
  if (exposure) radiance = exposure(radiance);
  frame.color = color_sensor_.expose(radiance, color_sensor_.settle(radiance, camera_seed), seed);
  const Pose world_from_infrared = depth_sensor_.worldFromInfrared(scene.scene().world_from_camera);
  const StructuredLightView view =
      renderStructuredLight(scene, depth_sensor_.camera(), world_from_infrared, depth_sensor_.baseline());
  frame.depth = depth_sensor_.registerToColor(depth_sensor_.measure(view, seed), depth_camera_);
  frame.color_camera = color_camera_;
  return frame;
}

}  // namespace recognition
