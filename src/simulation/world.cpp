#include "simulation/world.h"

#include <stdexcept>

#include "simulation/random_stream.h"

namespace recognition {
namespace {

bool happens(double share, cv::RNG& rng) { return rng.uniform(0.0, 1.0) < share; }

// As the SR300's kind: infrared camera and projector 4.7 cm apart, near, finer steps, more holes. The baseline and the
// fields of view are the data sheet's; noise and losses are chosen so that they bracket those of real frames.
void makeShortRange(KinectParameters& kinect, cv::RNG& rng) {
  kinect.color_focal_length = 1235.0;
  DepthSensorParameters& depth = kinect.depth;
  depth.focal_length = 475.0;
  depth.baseline = 0.047;
  depth.subpixel = 32.0;
  depth.disparity_noise = rng.uniform(1.0, 3.0);
  depth.bias = rng.uniform(1.0, 6.0);
  depth.bias_length = rng.uniform(20.0, 80.0);
  depth.window = 5;
  depth.lateral_noise = rng.uniform(0.6, 1.6);
  depth.half_signal = rng.uniform(0.02, 0.08);
  depth.glare_limit = rng.uniform(0.04, 0.12);
  depth.min_depth = 0.2;
}

// As the Kinect's and Xtion's kind, each of another make and age.
void makeStructuredLight(KinectParameters& kinect, cv::RNG& rng) {
  kinect.color_focal_length = rng.uniform(1030.0, 1085.0);
  DepthSensorParameters& depth = kinect.depth;
  depth.disparity_noise = rng.uniform(0.4, 0.9);
  depth.bias = rng.uniform(0.5, 2.0);
  depth.bias_length = rng.uniform(30.0, 90.0);
  depth.lateral_noise = rng.uniform(0.6, 1.4);
  depth.half_signal = rng.uniform(0.01, 0.05);
  depth.glare_limit = rng.uniform(0.05, 0.2);
}

void drawSensor(const WorldParameters& p, KinectParameters& kinect, cv::RNG& rng) {
  if (happens(p.short_range_share, rng))
    makeShortRange(kinect, rng);
  else if (p.short_range_share > 0.0)
    makeStructuredLight(kinect, rng);
  kinect.color.blur = rng.uniform(p.blur_min, p.blur_max);
  kinect.color.sharpening = rng.uniform(p.sharpening_min, p.sharpening_max);
  kinect.color.saturation_min = p.saturation_min;
  kinect.color.saturation_max = p.saturation_max;
  kinect.color.mean_level_min = p.mean_level_min;
  kinect.color.mean_level_max = p.mean_level_max;
  kinect.depth.scale = 1.0 + rng.uniform(-p.depth_scale, p.depth_scale);
  const double angle = rng.uniform(0.0, 2 * CV_PI);
  const double offset = rng.uniform(0.0, p.misregistration);
  kinect.depth.registration_x = offset * std::cos(angle);
  kinect.depth.registration_y = offset * std::sin(angle);
}

void drawEnclosure(const WorldParameters& p, FrameWorld& frame, cv::RNG& rng) {
  const double kind = rng.uniform(0.0, 1.0);
  TabletopParameters& table = frame.tabletop;
  table.blank = happens(p.blank_share, rng);
  if (happens(p.contact_share, rng)) table.contact = rng.uniform(0.4, 1.0);
  if (kind < p.shelf_share) {
    table.enclosure = Enclosure::kShelf;
    table.stacking = 0.05;
    table.spread = rng.uniform(0.06, 0.14);
    table.max_distance = std::min(table.max_distance, 1.3);
    table.contact = std::max(table.contact, 0.3);
  } else if (kind < p.shelf_share + p.tote_share) {
    table.enclosure = Enclosure::kTote;
    table.seen_share = 0.6;
    table.spread = rng.uniform(0.05, 0.12);
    table.max_distance = std::min(table.max_distance, 1.2);
    if (happens(p.many_share, rng)) frame.many = rng.uniform(3, p.max_many + 1);
  }
}

World challengeWorld() {
  World world;
  world.tabletop.max_distance = 1.2;
  world.tabletop.min_visibility = 0.5;
  world.tabletop.occlusion = 0.25;
  world.tabletop.stacking = 0.1;
  world.tabletop.leaning = 0.05;
  world.tabletop.spread = 0.12;
  world.max_clutter = 3;
  WorldParameters& p = world.parameters;
  p.sensor_varies = true;
  p.blur_min = 0.3;
  p.sharpening_min = 0.8;
  p.sharpening_max = 1.4;
  p.saturation_min = 0.9;
  p.saturation_max = 1.3;
  p.mean_level_min = 0.18;
  p.mean_level_max = 0.4;
  return world;
}

World wideWorld() {
  World world;
  world.tabletop.min_distance = 0.4;
  world.tabletop.max_distance = 1.6;
  world.tabletop.min_tilt = 5.0;
  world.tabletop.occlusion = 0.4;
  world.tabletop.clutter = {0.75, 0.15};
  world.empty_share = 0.25;
  world.max_clutter = 8;
  WorldParameters& p = world.parameters;
  p.shelf_share = 0.3;
  p.tote_share = 0.25;
  p.blank_share = 0.35;
  p.many_share = 0.6;
  p.contact_share = 0.5;
  p.fade_max = 0.35;
  p.chroma_min = 0.55;
  p.tint = 0.12;
  p.sensor_varies = true;
  p.blur_min = 0.2;
  p.blur_max = 1.6;
  p.sharpening_min = 0.2;
  p.sharpening_max = 1.6;
  p.saturation_min = 0.6;
  p.saturation_max = 1.6;
  p.mean_level_min = 0.1;
  p.mean_level_max = 0.75;
  p.misregistration = 3.0;
  p.depth_scale = 0.02;
  p.short_range_share = 0.35;
  return world;
}

}  // namespace

ParameterList WorldParameters::list() {
  return {
      doubleParameter("shelf_share", "", &shelf_share, 0.0, 1.0, "frames that look into a shelf"),
      doubleParameter("tote_share", "", &tote_share, 0.0, 1.0, "frames that look into a tote"),
      doubleParameter("blank_share", "", &blank_share, 0.0, 1.0, "frames with white surroundings"),
      doubleParameter("many_share", "", &many_share, 0.0, 1.0, "totes with many instances of one object"),
      intParameter("max_many", "", &max_many, 3, 30, "instances of it at most"),
      doubleParameter("contact_share", "", &contact_share, 0.0, 1.0, "frames whose things touch"),
      doubleParameter("fade_max", "", &fade_max, 0.0, 1.0, "bleached share of a texture at most"),
      doubleParameter("chroma_min", "", &chroma_min, 0.0, 1.0, "factor on a texture's chroma at least"),
      doubleParameter("tint", "", &tint, 0.0, 1.0, "log of the factor on a texture's channels, standard deviation"),
      boolParameter("sensor_varies", &sensor_varies, "the values below are drawn for each frame"),
      doubleParameter("blur_min", "px", &blur_min, 0.0, 5.0, "blur at least"),
      doubleParameter("blur_max", "px", &blur_max, 0.0, 5.0, "blur at most"),
      doubleParameter("sharpening_min", "", &sharpening_min, 0.0, 3.0, "weight of the unsharp mask at least"),
      doubleParameter("sharpening_max", "", &sharpening_max, 0.0, 3.0, "weight of the unsharp mask at most"),
      doubleParameter("saturation_min", "", &saturation_min, 0.0, 3.0, "factor on chroma at least"),
      doubleParameter("saturation_max", "", &saturation_max, 0.0, 3.0, "factor on chroma at most"),
      doubleParameter("mean_level_min", "", &mean_level_min, 0.01, 1.0, "exposure aims at this level at least"),
      doubleParameter("mean_level_max", "", &mean_level_max, 0.01, 1.0, "exposure aims at this level at most"),
      doubleParameter("misregistration", "px", &misregistration, 0.0, 20.0, "depth beside colour at most"),
      doubleParameter("depth_scale", "", &depth_scale, 0.0, 0.2, "relative error of depth at most"),
      doubleParameter("short_range_share", "", &short_range_share, 0.0, 1.0, "frames by a sensor like an SR300"),
  };
}

void WorldParameters::validate() const {
  WorldParameters copy = *this;
  validateParameters(copy.list(), "world");
  if (shelf_share + tote_share > 1.0) throw std::invalid_argument("world: shelf_share and tote_share are above 1");
}

World World::of(WorldPreset preset) {
  if (preset == WorldPreset::kChallenge) return challengeWorld();
  return preset == WorldPreset::kWide ? wideWorld() : World();
}

std::string World::text() const {
  World copy = *this;
  std::string text = "max_clutter: " + std::to_string(max_clutter) + "\nworld:\n";
  for (const Parameter& p : copy.parameters.list()) text += "  " + p.name + ": " + valueText(p) + "\n";
  text += "tabletop:\n";
  for (const Parameter& p : copy.tabletop.list()) text += "  " + p.name + ": " + valueText(p) + "\n";
  return text;
}

FrameWorld drawFrameWorld(const World& world, const KinectParameters& base, std::uint64_t seed) {
  cv::RNG rng = randomStream(seed, 4);
  const WorldParameters& p = world.parameters;
  FrameWorld frame{base, world.tabletop, {p.fade_max, p.chroma_min, p.tint}, 0};
  drawEnclosure(p, frame, rng);
  if (p.sensor_varies) drawSensor(p, frame.kinect, rng);
  return frame;
}

}  // namespace recognition
