#include "simulation/sequence.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>

#include <opencv2/imgproc.hpp>

#include "simulation/annotate.h"
#include "simulation/degree.h"
#include "simulation/random_stream.h"
#include "simulation/ray_scene.h"
#include "simulation/shapes.h"
#include "simulation/textures.h"

namespace recognition {
namespace {

constexpr double kLift = 0.12;           // metres that carried things are lifted
constexpr double kCarry = 0.12;          // metres that they are carried aside
constexpr double kPause = 1.0;           // seconds before, between and after
constexpr double kPeakOfMean = 1.875;    // peak speed of a minimum-jerk motion over its mean
constexpr double kMotionStep = 1e-3;     // seconds, of differences
constexpr std::uint64_t kMaxDraws = 20;  // of scenes that cannot be arranged

/// 0 to 1 as a hand moves: no jerk at either end (Flash and Hogan 1985).
double smooth(double share) {
  const double s = std::clamp(share, 0.0, 1.0);
  return s * s * s * (10.0 + s * (-15.0 + 6.0 * s));
}

/// A slow swing with stops: -1 to 1 and back.
double swing(double seconds, double period) {
  const double share = std::fmod(seconds / period + 100.0, 1.0);
  if (share < 0.15) return -1.0;
  if (share < 0.5) return -1.0 + 2.0 * smooth((share - 0.15) / 0.35);
  if (share < 0.65) return 1.0;
  return 1.0 - 2.0 * smooth((share - 0.65) / 0.35);
}

Eigen::Vector3d middleOf(const TabletopScene& scene) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const int body : scene.objects)
    sum += scene.scene.bodies[static_cast<size_t>(body)].world_from_body.translation();
  return scene.objects.empty() ? sum : Eigen::Vector3d(sum / static_cast<double>(scene.objects.size()));
}

Pose turnedAbout(const Eigen::Vector3d& point, const Eigen::AngleAxisd& turn) {
  return Eigen::Translation3d(point) * turn * Eigen::Translation3d(-point);
}

}  // namespace

int SequenceParameters::frames() const { return std::max(1, static_cast<int>(std::lround(seconds * rate))); }

ParameterList SequenceParameters::list() {
  return {
      choiceParameter("path", &path, {"still", "hand", "arm", "pan_tilt"}, "how the camera moves"),
      doubleParameter("seconds", "s", &seconds, 0.01, 3600.0, "length of a film"),
      doubleParameter("rate", "Hz", &rate, 1.0, 120.0, "frames a second"),
      intParameter("moved", "", &moved, 0, 50, "objects that are lifted, carried and put down"),
      intParameter("passing", "", &passing, 0, 50, "boxes that pass before the things"),
      doubleParameter("max_speed", "m/s", &max_speed, 0.01, 5.0, "of what is carried"),
      doubleParameter("max_turn", "deg/s", &max_turn, 0.0, 720.0, "of what is carried"),
      doubleParameter("exposure", "s", &exposure, 0.0, 0.1, "time that an image is exposed: motion blur"),
      doubleParameter("readout", "s", &readout, 0.0, 0.1, "time from the first row to the last: rolling shutter"),
  };
}

void SequenceParameters::validate() const {
  SequenceParameters copy = *this;
  validateParameters(copy.list(), "sequence");
}

/// An object on its way: lifted, carried, put down where it is free.
struct SceneInMotion::Carried {
  int body;
  double begin, seconds;
  Eigen::Vector3d way;
  double turn;  // radians about the vertical
  Pose start;
};

/// A box on its way across the view.
struct SceneInMotion::Passing {
  int body;
  double begin, seconds;
  Eigen::Vector3d from, to;
};

SceneInMotion::SceneInMotion(TabletopScene scene, const SequenceParameters& parameters, std::uint64_t seed)
    : start_(std::move(scene)), parameters_(parameters), middle_(middleOf(start_)) {
  parameters_.validate();
  cv::RNG rng = randomStream(seed, 21);
  for (int i = 0; i < 12; ++i) phases_.push_back(rng.uniform(0.0, 2.0 * CV_PI));
  const double each = (kLift * 2.0 + kCarry) * kPeakOfMean / parameters_.max_speed;
  double begin = kPause;
  for (int i = 0; i < parameters_.moved && !start_.objects.empty(); ++i, begin += each + kPause) {
    Carried one;
    one.body = start_.objects[static_cast<size_t>(i) % start_.objects.size()];
    one.begin = begin;
    one.seconds = each;
    one.start = start_.scene.bodies[static_cast<size_t>(one.body)].world_from_body;
    for (const Carried& earlier : carried_)
      if (earlier.body == one.body) one.start.translation() += earlier.way;
    Eigen::Vector3d out = one.start.translation() - middle_;
    out.z() = 0.0;
    if (out.norm() < 0.01) out = Eigen::Vector3d(std::cos(phases_[0]), std::sin(phases_[0]), 0.0);
    one.way = kCarry * out.normalized();
    one.turn = std::min(kDegree * parameters_.max_turn * each / kPeakOfMean, 0.5 * CV_PI) * (i % 2 == 0 ? 1.0 : -1.0);
    carried_.push_back(one);
  }
  const Eigen::Vector3d eye = start_.scene.world_from_camera.translation();
  const Eigen::Vector3d aside = start_.scene.world_from_camera.linear().col(0);
  for (int i = 0; i < parameters_.passing; ++i) {
    const cv::Mat texture = makePrintTexture({128, 128}, rng);
    const Finish finish;
    SceneBody body;
    const TexturedMesh mesh = makeBox({0.10, 0.14, 0.03}, texture);
    body.appearance = std::make_shared<BodyAppearance>(std::make_shared<const TexturedMesh>(mesh), finish);
    body.world_from_body = start_.scene.world_from_camera;
    const Eigen::Vector3d between = eye + 0.65 * (middle_ - eye);
    passing_.push_back({static_cast<int>(start_.scene.bodies.size()), kPause + 2.5 * i, 2.5, between - 0.6 * aside,
                        between + 0.6 * aside});
    start_.scene.bodies.push_back(body);
  }
}

SceneInMotion::~SceneInMotion() = default;

Scene SceneInMotion::at(double seconds) const {
  Scene scene = start_.scene;
  const auto wave = [&](int number, double hertz) {
    return std::sin(2.0 * CV_PI * hertz * seconds + phases_[static_cast<size_t>(number)]) -
           std::sin(phases_[static_cast<size_t>(number)]);
  };
  Pose& camera = scene.world_from_camera;
  const Pose begin = camera;
  const Eigen::Vector3d right = begin.linear().col(0);
  switch (parameters_.path) {
    case CameraPath::kStill:
      break;
    case CameraPath::kHandHeld: {
      const Eigen::Vector3d sway(wave(0, 0.23) + 0.25 * wave(1, 1.1), wave(2, 0.31) + 0.25 * wave(3, 0.9),
                                 wave(4, 0.17));
      const Eigen::Vector3d turn(wave(5, 0.29) + 0.3 * wave(6, 1.3), wave(7, 0.21) + 0.3 * wave(8, 1.7), wave(9, 0.4));
      const Pose swayed = begin * Eigen::Translation3d(0.03 * sway);
      camera = swayed;
      const Eigen::Vector3d angles = 1.5 * kDegree * turn;
      if (angles.norm() > 0.0) camera = swayed * Eigen::AngleAxisd(angles.norm(), angles.normalized());
      break;
    }
    case CameraPath::kArm: {
      const double angle = 15.0 * kDegree * (swing(seconds, 12.0) + 1.0);
      camera = turnedAbout(middle_, Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())) * begin;
      break;
    }
    case CameraPath::kPanTilt: {
      const double pan = 5.0 * kDegree * (swing(seconds, 8.0) + 1.0),
                   tilt = 2.0 * kDegree * (swing(seconds, 11.0) + 1.0);
      camera = turnedAbout(begin.translation(), Eigen::AngleAxisd(pan, Eigen::Vector3d::UnitZ())) *
               turnedAbout(begin.translation(), Eigen::AngleAxisd(tilt, right)) * begin;
      break;
    }
  }
  for (const Carried& one : carried_) {
    const double share = smooth((seconds - one.begin) / one.seconds);
    if (seconds < one.begin) continue;
    Pose pose = one.start;
    pose.linear() = Eigen::AngleAxisd(share * one.turn, Eigen::Vector3d::UnitZ()) * one.start.linear();
    pose.translation() += share * one.way + kLift * std::sin(CV_PI * share) * Eigen::Vector3d::UnitZ();
    scene.bodies[static_cast<size_t>(one.body)].world_from_body = pose;
  }
  for (const Passing& one : passing_) {
    const double share = std::clamp((seconds - one.begin) / one.seconds, 0.0, 1.0);
    Pose pose = start_.scene.world_from_camera;
    pose.translation() = one.from + share * (one.to - one.from);
    if (share <= 0.0 || share >= 1.0) pose.translation() = Eigen::Vector3d(0.0, 0.0, -5.0);  // below the floor
    scene.bodies[static_cast<size_t>(one.body)].world_from_body = pose;
  }
  return scene;
}

cv::Mat imageMotion(const SceneInMotion& motion, double seconds, const CameraModel& camera) {
  const Scene now = motion.at(seconds), next = motion.at(seconds + kMotionStep);
  const RayScene rays(now);
  std::vector<Pose> next_from_now;  // of each body, the camera's axes
  for (size_t i = 0; i < now.bodies.size(); ++i)
    next_from_now.push_back(next.world_from_camera.inverse() * next.bodies[i].world_from_body *
                            now.bodies[i].world_from_body.inverse());
  cv::Mat flow(camera.height, camera.width, CV_32FC2, cv::Scalar::all(0));
  const Eigen::Vector3f eye = now.world_from_camera.translation().cast<float>();
  cv::parallel_for_(cv::Range(0, camera.height), [&](const cv::Range& range) {
    for (int v = range.start; v < range.end; ++v)
      for (int u = 0; u < camera.width; ++u) {
        const Eigen::Vector3d direction = now.world_from_camera.linear() * camera.unproject(u, v, 1.0);
        const SurfaceHit hit = rays.cast(eye, direction.cast<float>());
        if (!hit.met()) continue;
        const Eigen::Vector3d world =
            now.world_from_camera.translation() + static_cast<double>(hit.distance) * direction;
        const Eigen::Vector3d p = next_from_now[static_cast<size_t>(hit.body)] * world;
        if (p.z() <= 0.0) continue;
        const Eigen::Vector2d way = (camera.project(p) - Eigen::Vector2d(u, v)) / kMotionStep;
        flow.at<cv::Vec2f>(v, u) = {static_cast<float>(way.x()), static_cast<float>(way.y())};
      }
  });
  return flow;
}

cv::Mat exposedInMotion(const cv::Mat& radiance, const cv::Mat& motion, double exposure, double readout) {
  constexpr int kSteps = 7;
  cv::Mat sum(radiance.size(), CV_32FC3, cv::Scalar::all(0)), from(radiance.size(), CV_32FC2), warped;
  for (int step = 0; step < kSteps; ++step) {
    const double in_exposure = exposure * ((step + 0.5) / kSteps - 0.5);
    for (int v = 0; v < radiance.rows; ++v) {
      const auto time = static_cast<float>(in_exposure + readout * ((v + 0.5) / radiance.rows - 0.5));
      const auto* way = motion.ptr<cv::Vec2f>(v);
      auto* place = from.ptr<cv::Vec2f>(v);
      for (int u = 0; u < radiance.cols; ++u)
        place[u] = {static_cast<float>(u) - time * way[u][0], static_cast<float>(v) - time * way[u][1]};
    }
    cv::remap(radiance, warped, from, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    sum += warped;
  }
  return sum / kSteps;
}

namespace {

/// A table with the set's objects that can be arranged, as the film's first moment.
TabletopScene firstScene(const SequenceSet& set, const std::vector<CatalogObject>& catalog, const FrameWorld& world,
                         std::uint64_t seed) {
  std::vector<const CatalogObject*> objects;
  for (const int id : set.ids) {
    const auto found = std::find_if(catalog.begin(), catalog.end(), [id](const auto& one) { return one.id == id; });
    if (found == catalog.end())
      throw std::invalid_argument("--objects: the models folder has no object " + std::to_string(id));
    objects.push_back(&*found);
  }
  const SimulatedKinect kinect(world.kinect);
  for (std::uint64_t draw = 0;; ++draw) {
    try {
      return composeTabletop(objects, set.clutter, kinect.depthCamera(), world.tabletop, seed + draw);
    } catch (const UnarrangeableScene&) {
      if (draw >= kMaxDraws) throw;
    }
  }
}

AnnotatedFrame filmFrame(const SceneInMotion& motion, const SequenceParameters& parameters,
                         const SimulatedKinect& kinect, int frame, std::uint64_t seed) {
  const double seconds = frame / parameters.rate;
  Exposure exposure;
  if (parameters.exposure > 0.0 || parameters.readout > 0.0)
    exposure = [&](const cv::Mat& radiance) {
      return exposedInMotion(radiance, imageMotion(motion, seconds, kinect.colorCamera()), parameters.exposure,
                             parameters.readout);
    };
  const Scene scene = motion.at(seconds);
  const auto frame_seed = static_cast<std::uint64_t>(randomStream(seed, 22, static_cast<std::uint64_t>(frame)).next());
  AnnotatedFrame annotated = captureAnnotated(scene, motion.objects(), kinect, frame_seed, seed, exposure);
  annotated.camera_from_world = scene.world_from_camera.inverse();
  return annotated;
}

}  // namespace

void writeSequences(const SequenceSet& set, const SequenceParameters& parameters,
                    const std::vector<CatalogObject>& catalog, const std::string& directory) {
  SequenceParameters described = parameters;
  described.validate();
  std::string origin = set.world.text() + "seed: " + std::to_string(set.seed) + "\nsequence:\n";
  for (const Parameter& p : described.list()) origin += "  " + p.name + ": " + valueText(p) + "\n";
  for (const int id : set.ids) origin += "object: " + std::to_string(id) + "\n";
  const int frames = parameters.frames(), total = frames * set.films;
  const BopWriter writer(directory, "test_kinect", frames);
  writer.claim(origin + KinectParameters(set.kinect).text());
  std::atomic<int> done{0};
  for (int film = 0; film < set.films; ++film) {
    const auto seed = static_cast<std::uint64_t>(randomStream(set.seed, 20, static_cast<std::uint64_t>(film)).next());
    const FrameWorld world = drawFrameWorld(set.world, set.kinect, seed);
    const SimulatedKinect kinect(world.kinect);
    const SceneInMotion motion(firstScene(set, catalog, world, seed), parameters, seed);
    cv::parallel_for_(
        cv::Range(0, frames),
        [&](const cv::Range& range) {
          for (int i = range.start; i < range.end; ++i) {
            const int frame = film * frames + i;
            if (!writer.has(frame)) writer.write(frame, filmFrame(motion, parameters, kinect, i, seed));
            set.progress(++done, total);
          }
        },
        frames);
  }
  writer.finish(total);
}

}  // namespace recognition
