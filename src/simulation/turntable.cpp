#include "simulation/turntable.h"

#include <atomic>
#include <cmath>
#include <fstream>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <stdexcept>

#include "simulation/annotate.h"
#include "simulation/degree.h"
#include "simulation/random_stream.h"
#include "simulation/room.h"
#include "simulation/shapes.h"

namespace recognition {
namespace {

constexpr double kBoardHeight = 0.02;  // m above the table: the turntable's plate
constexpr double kPrint = 3000.0;      // px/m
const char* const kSplit = "train_kinect";

Eigen::AlignedBox3d extents(const CatalogObject& object) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : object.shape.points) box.extend(p);
  return box;
}

double footprint(const CatalogObject& object) { return extents(object).sizes().head<2>().norm(); }

std::shared_ptr<const BodyAppearance> boardAppearance(const FiducialBoard& board) {
  Finish matt;
  matt.specular = 0.02f;
  cv::Mat print;
  cv::cvtColor(board.draw(kPrint), print, cv::COLOR_GRAY2BGR);
  return std::make_shared<BodyAppearance>(
      std::make_shared<const TexturedMesh>(makePrintedPlane(board.size().x(), board.size().y(), print)), matt);
}

void addPlate(Scene& scene, const FiducialBoard& board) {
  const cv::Mat dark(8, 8, CV_8UC3, cv::Scalar::all(60));
  auto plate = std::make_shared<const TexturedMesh>(
      makeCylinder(0.5 * board.size().norm() + 0.02, kBoardHeight - 0.002, dark, 96));
  scene.bodies.push_back({std::make_shared<BodyAppearance>(plate, Finish()),
                          Pose(Eigen::Translation3d(0, 0, (kBoardHeight - 0.002) / 2)), 0});
}

std::string poseYaml(const Pose& pose) {
  std::ostringstream text;
  text.precision(12);
  text << "board_from_object:  # rows of the 3 x 4 matrix, m\n";
  for (int r = 0; r < 3; ++r)
    text << "  - [" << pose(r, 0) << ", " << pose(r, 1) << ", " << pose(r, 2) << ", " << pose(r, 3) << "]\n";
  return text.str();
}

std::string describe(const CatalogObject& object, const FiducialBoard& board, const KinectParameters& kinect,
                     TurntableParameters parameters, std::uint64_t seed) {
  std::string text = "object: " + object.name + "\nseed: " + std::to_string(seed) + "\n" + "board: " + board.name() +
                     "\n" + kinect.text() + "turntable:\n";
  for (const Parameter& p : parameters.list()) text += "  " + p.name + ": " + valueText(p) + "\n";
  return text;
}

// Room, turning plate, board, and the object last.
Scene setTable(const CatalogObject& object, const FiducialBoard& board, std::uint64_t seed) {
  cv::RNG rng = randomStream(seed, 1);
  const Room room = makeRoom(rng);
  Scene scene{room.bodies, room.lamps, room.ambient_above, room.ambient_below, Pose::Identity()};
  addPlate(scene, board);
  scene.bodies.push_back({boardAppearance(board), Pose::Identity(), 0});
  scene.bodies.push_back({object.appearance, Pose::Identity(), object.id});
  return scene;
}

// Board, object and camera of a view.
void turn(Scene& scene, const CatalogObject& object, const FiducialBoard& board, const TurntableParameters& parameters,
          int view) {
  const int per_tilt = (parameters.views + parameters.tilts - 1) / parameters.tilts;
  const double yaw = 2 * CV_PI * (view % per_tilt) / per_tilt;
  const Pose world_from_board =
      Eigen::Translation3d(0, 0, kBoardHeight) * Pose(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
  scene.bodies[scene.bodies.size() - 2].world_from_body = world_from_board;
  scene.bodies.back().world_from_body = world_from_board * boardFromObject(object, parameters.upside_down);

  const double share = parameters.tilts > 1 ? static_cast<double>(view / per_tilt) / (parameters.tilts - 1) : 0.5;
  const double tilt = kDegree * (parameters.min_tilt + share * (parameters.max_tilt - parameters.min_tilt));
  const Eigen::Vector3d sizes = extents(object).sizes();
  const double distance = parameters.distance > 0.0
                              ? parameters.distance
                              : std::max(0.6, 0.3 + 1.2 * std::max(sizes.norm(), 0.8 * board.size().x()));
  const Eigen::Vector3d middle(0, 0, kBoardHeight + 0.4 * sizes.z());
  scene.world_from_camera = lookAt(middle + distance * Eigen::Vector3d(0, -std::cos(tilt), std::sin(tilt)), middle);
}

}  // namespace

ParameterList TurntableParameters::list() {
  return {
      intParameter("views", "", &views, 1, 100000, "views of all tilts together"),
      intParameter("tilts", "", &tilts, 1, 100, "heights of the camera"),
      doubleParameter("min_tilt", "deg", &min_tilt, 0.0, 89.0, "least angle that the camera looks down"),
      doubleParameter("max_tilt", "deg", &max_tilt, 0.0, 89.0, "greatest angle that the camera looks down"),
      doubleParameter("distance", "m", &distance, 0.0, 10.0, "camera to the object's middle, 0: by the object's size"),
      boolParameter("upside_down", &upside_down, "the object stands on its head"),
  };
}

void TurntableParameters::validate() const {
  TurntableParameters copy = *this;
  validateParameters(copy.list(), "turntable");
  if (min_tilt > max_tilt) throw std::invalid_argument("turntable/min_tilt is above max_tilt");
}

Pose boardFromObject(const CatalogObject& object, bool upside_down) {
  const Eigen::AlignedBox3d box = extents(object);
  const Eigen::Vector3d centre = box.center();
  if (!upside_down) return Pose(Eigen::Translation3d(-centre.x(), -centre.y(), -box.min().z()));
  return Eigen::Translation3d(-centre.x(), centre.y(), box.max().z()) *
         Pose(Eigen::AngleAxisd(CV_PI, Eigen::Vector3d::UnitX()));
}

Scene turntableView(const CatalogObject& object, const FiducialBoard& board, const TurntableParameters& parameters,
                    int view, std::uint64_t seed) {
  Scene scene = setTable(object, board, seed);
  turn(scene, object, board, parameters, view);
  return scene;
}

void writeTurntable(const CatalogObject& object, const FiducialBoard& board, const KinectParameters& kinect_parameters,
                    const TurntableParameters& parameters, std::uint64_t seed, const std::string& directory,
                    const std::function<void(int, int)>& progress) {
  parameters.validate();
  if (footprint(object) > board.size().maxCoeff())
    throw std::invalid_argument("turntable: " + object.name + " is " + std::to_string(footprint(object)) +
                                " m across, larger than the board");
  const SimulatedKinect kinect(kinect_parameters);
  const BopWriter writer(directory, kSplit, parameters.views);
  writer.claim(describe(object, board, kinect_parameters, parameters, seed));
  std::ofstream(directory + "/board_from_object.yaml") << poseYaml(boardFromObject(object, parameters.upside_down));
  const Scene table = setTable(object, board, seed);
  std::atomic<int> done{0};
  cv::parallel_for_(
      cv::Range(0, parameters.views),
      [&](const cv::Range& range) {
        for (int view = range.start; view < range.end; ++view) {
          if (!writer.has(view)) {
            Scene scene = table;
            turn(scene, object, board, parameters, view);
            const int last = static_cast<int>(scene.bodies.size()) - 1;
            writer.write(view, captureAnnotated(scene, {last}, kinect, seed + static_cast<std::uint64_t>(view), seed));
          }
          progress(++done, parameters.views);
        }
      },
      parameters.views);
  writer.finish(parameters.views);
}

}  // namespace recognition
