#include "simulation/room.h"

#include "simulation/random_stream.h"
#include "simulation/shapes.h"
#include "simulation/textures.h"

namespace recognition {
namespace {

constexpr double kCeiling = 2.0;  // metres above it
constexpr double kTop = 0.03;     // thickness of the table top
constexpr int kTexture = 1024;    // px

Finish makeFinish(double specular, double shininess, double infrared_floor) {
  return {static_cast<float>(specular), static_cast<float>(shininess), static_cast<float>(infrared_floor)};
}

void add(Room& room, TexturedMesh mesh, const Finish& finish, const Pose& world_from_body) {
  room.bodies.push_back(
      {std::make_shared<BodyAppearance>(std::make_shared<const TexturedMesh>(std::move(mesh)), finish), world_from_body,
       0});
}

Pose at(double x, double y, double z, double yaw = 0.0) {
  return Eigen::Translation3d(x, y, z) * Pose(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
}

MaterialKind pickKind(std::initializer_list<MaterialKind> kinds, cv::RNG& rng) {
  return pick(std::vector<MaterialKind>(kinds), rng);
}

cv::Mat blankTexture(cv::RNG& rng) { return cv::Mat(16, 16, CV_8UC3, cv::Scalar::all(rng.uniform(205.0, 250.0))); }

void addTable(Room& room, bool blank, cv::RNG& rng) {
  room.table_size = {rng.uniform(1.1, 1.8), rng.uniform(0.8, 1.3)};
  const MaterialKind kind =
      pickKind({MaterialKind::kPlain, MaterialKind::kPlain, MaterialKind::kWood, MaterialKind::kWood,
                MaterialKind::kCloth, MaterialKind::kChecker, MaterialKind::kSpeckle},
               rng);
  const bool glossy = kind == MaterialKind::kWood && rng.uniform(0.0, 1.0) < 0.4;
  const Finish finish = makeFinish(glossy ? 0.12 : 0.02, glossy ? 60.0 : 12.0, rng.uniform(0.1, 0.4));
  const double tile = kind == MaterialKind::kCloth ? rng.uniform(0.25, 0.6) : rng.uniform(0.4, 1.0);
  const cv::Mat texture = blank ? blankTexture(rng) : makeMaterialTexture(kind, kTexture, rng);
  add(room, makeTiledPlane(room.table_size.x(), room.table_size.y(), tile, texture), finish, at(0, 0, 0));
  const cv::Mat side = makeMaterialTexture(MaterialKind::kPlain, 128, rng);
  add(room, makeBox({room.table_size.x(), room.table_size.y(), kTop}, side), finish, at(0, 0, -kTop / 2 - 0.001));
}

void addWalls(Room& room, const Eigen::Vector2d& half, bool blank, cv::RNG& rng) {
  const MaterialKind kind =
      pickKind({MaterialKind::kPlain, MaterialKind::kPlain, MaterialKind::kSpeckle, MaterialKind::kCloth}, rng);
  const cv::Mat texture = blank ? blankTexture(rng) : makeMaterialTexture(kind, 512, rng);
  const double height = kCeiling - kFloorHeight;
  for (int side = 0; side < 4; ++side) {
    const double yaw = side * CV_PI / 2;
    const double distance = side % 2 == 0 ? half.y() : half.x();
    const double width = 2 * (side % 2 == 0 ? half.x() : half.y());
    Pose wall = at(0, 0, 0, yaw) * Pose(Eigen::Translation3d(0, distance, kFloorHeight + height / 2));
    wall.rotate(Eigen::AngleAxisd(CV_PI / 2, Eigen::Vector3d::UnitX()));
    add(room, makeTiledPlane(width, height, 1.2, texture), makeFinish(0.01, 8.0, 0.3), wall);
  }
}

// Boxes and columns that stand on the floor about the table; some of them black, also in the infrared.
void addFurniture(Room& room, const Eigen::Vector2d& half, cv::RNG& rng) {
  for (int i = rng.uniform(0, 7); i > 0; --i) {
    const bool black = rng.uniform(0.0, 1.0) < 0.4;
    cv::Mat texture = makeMaterialTexture(
        static_cast<MaterialKind>(rng.uniform(0, static_cast<int>(MaterialKind::kCount))), 512, rng);
    if (rng.uniform(0.0, 1.0) < 0.3) texture = makePrintTexture({768, 512}, rng);
    if (black) texture *= 0.12;
    const Finish finish = makeFinish(black ? 0.1 : 0.03, 30.0, black ? 0.01 : 0.25);
    const Eigen::Vector3d size(rng.uniform(0.2, 0.7), rng.uniform(0.2, 0.6), rng.uniform(0.4, 1.5));
    const double angle = rng.uniform(0.0, 2 * CV_PI);
    const double radius = rng.uniform(1.25, 1.9);
    const double x = std::clamp(radius * std::cos(angle), -half.x() + 0.4, half.x() - 0.4);
    const double y = std::clamp(radius * std::sin(angle), -half.y() + 0.4, half.y() - 0.4);
    const bool round = rng.uniform(0.0, 1.0) < 0.25;
    add(room, round ? makeCylinder(size.x() / 2, size.z(), texture) : makeBox(size, texture), finish,
        at(x, y, kFloorHeight + size.z() / 2, rng.uniform(0.0, CV_PI)));
  }
}

// BGR of a lamp between incandescent and daylight.
Eigen::Vector3f lampColor(cv::RNG& rng) {
  const auto warm = static_cast<float>(rng.uniform(0.0, 1.0));
  return warm * Eigen::Vector3f(0.5f, 0.85f, 1.25f) + (1.0f - warm) * Eigen::Vector3f(1.15f, 1.0f, 0.85f);
}

void addLight(Room& room, const Eigen::Vector2d& half, cv::RNG& rng) {
  const auto strength = static_cast<float>(logUniform(rng, 0.08, 2.0));  // klx: a dim home to a bright shop
  const auto ambient = static_cast<float>(rng.uniform(0.25, 0.7));
  const int count = rng.uniform(1, 5);
  Eigen::Vector3f tint = Eigen::Vector3f::Zero();
  for (int i = 0; i < count; ++i) {
    Lamp lamp;
    const double reach = rng.uniform(0.0, 0.85);
    const double angle = rng.uniform(0.0, 2 * CV_PI);
    lamp.position = Eigen::Vector3d(reach * half.x() * std::cos(angle), reach * half.y() * std::sin(angle),
                                    rng.uniform(1.0, kCeiling - 0.05))
                        .cast<float>();
    lamp.radius = static_cast<float>(logUniform(rng, 0.04, 0.35));
    const Eigen::Vector3f color = lampColor(rng);
    tint += color / static_cast<float>(count);
    lamp.power = strength * (1.0f - ambient) * static_cast<float>(rng.uniform(0.4, 1.6)) / static_cast<float>(count) *
                 lamp.position.squaredNorm() * color;
    room.lamps.push_back(lamp);
  }
  room.ambient_above = ambient * strength * tint;
  room.ambient_below = static_cast<float>(rng.uniform(0.2, 0.6)) * room.ambient_above;
}

}  // namespace

Room makeRoom(cv::RNG& rng, bool blank) {
  Room room;
  const Eigen::Vector2d half(rng.uniform(2.2, 3.5), rng.uniform(2.2, 3.5));
  addTable(room, blank, rng);
  const cv::Mat floor = makeMaterialTexture(
      pickKind({MaterialKind::kCarpet, MaterialKind::kCarpet, MaterialKind::kWood, MaterialKind::kSpeckle}, rng),
      kTexture, rng);
  add(room, makeTiledPlane(2 * half.x(), 2 * half.y(), 1.0, floor), makeFinish(0.02, 10.0, 0.2),
      at(0, 0, kFloorHeight));
  addWalls(room, half, blank, rng);
  addFurniture(room, half, rng);
  addLight(room, half, rng);
  return room;
}

}  // namespace recognition
