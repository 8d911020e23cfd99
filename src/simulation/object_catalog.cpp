#include "simulation/object_catalog.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "simulation/random_stream.h"
#include "simulation/shapes.h"
#include "simulation/textures.h"

namespace recognition {
namespace {

constexpr std::uint64_t kFinishSeed = 20110509;
constexpr double kMillimetre = 0.001;  // BOP's unit
constexpr double kTintSpread = 0.12;   // of the logarithm of an object's true colour over that of its scan
constexpr double kToneSpread = 0.12;   // of the logarithm of the exponent between the two: contrast

// Four in ten objects are glossy (tins, foil, lacquer), the rest paper, card and plastic.
Finish drawFinish(cv::RNG& rng) {
  const bool glossy = rng.uniform(0.0, 1.0) < 0.4;
  Finish finish;
  finish.specular = static_cast<float>(glossy ? rng.uniform(0.15, 0.5) : rng.uniform(0.02, 0.1));
  finish.shininess = static_cast<float>(glossy ? rng.uniform(40.0, 150.0) : rng.uniform(8.0, 40.0));
  finish.infrared_floor = static_cast<float>(rng.uniform(0.02, 0.3));
  return finish;
}

CatalogObject makeObject(int id, std::string name, std::shared_ptr<const TexturedMesh> mesh, const Finish& finish) {
  CatalogObject object;
  object.id = id;
  object.name = std::move(name);
  object.shape = convexShape(*mesh);
  object.appearance = std::make_shared<BodyAppearance>(std::move(mesh), finish);
  return object;
}

cv::Mat clutterTexture(const ClutterStyle& style, cv::RNG& rng) {
  if (style.blank > 0.0 && rng.uniform(0.0, 1.0) < style.blank)
    return cv::Mat(16, 16, CV_8UC3, cv::Scalar::all(rng.uniform(200.0, 250.0)));
  if (rng.uniform(0.0, 1.0) < style.printed) return makePrintTexture({768, 512}, rng);
  return makeMaterialTexture(static_cast<MaterialKind>(rng.uniform(0, static_cast<int>(MaterialKind::kCount))), 512,
                             rng);
}

}  // namespace

std::vector<CatalogObject> loadCatalog(const std::string& models_directory) {
  std::vector<CatalogObject> catalog;
  for (const BopModel& model : listBopModels(models_directory))
    catalog.push_back(loadObject(model.file, kMillimetre, model.id, model.name));
  if (catalog.empty()) throw std::runtime_error(models_directory + ": holds no models");
  return catalog;
}

CatalogObject loadObject(const std::string& file, double unit, int id, const std::string& name) {
  cv::RNG rng = randomStream(kFinishSeed, static_cast<std::uint64_t>(id));
  Finish finish = drawFinish(rng);
  for (int c = 0; c < 3; ++c) finish.tint[c] = static_cast<float>(std::exp(rng.gaussian(kTintSpread)));
  finish.tone = static_cast<float>(std::exp(rng.gaussian(kToneSpread)));
  return makeObject(id, name, std::make_shared<const TexturedMesh>(readMesh(file, unit)), finish);
}

CatalogObject makeClutter(const ClutterStyle& style, cv::RNG& rng) {
  const cv::Mat texture = clutterTexture(style, rng);
  const double kind = rng.uniform(0.0, 1.0);
  TexturedMesh mesh;
  if (kind < 0.55) {
    Eigen::Vector3d size(rng.uniform(0.03, 0.22), rng.uniform(0.03, 0.22), rng.uniform(0.02, 0.26));
    mesh = makeBox(size, texture);
  } else if (kind < 0.88) {
    mesh = makeCylinder(rng.uniform(0.02, 0.06), rng.uniform(0.04, 0.22), texture);
  } else {
    mesh = makeSphere(rng.uniform(0.025, 0.07), texture);
  }
  return makeObject(0, "clutter", std::make_shared<const TexturedMesh>(std::move(mesh)), drawFinish(rng));
}

CatalogObject age(const CatalogObject& object, const Aging& aging, cv::RNG& rng) {
  Finish finish = object.appearance->finish();
  finish.fade = static_cast<float>(rng.uniform(0.0, 1.0) * aging.fade_max);
  finish.chroma = static_cast<float>(rng.uniform(aging.chroma_min, 1.0 + 1e-9));
  for (int c = 0; c < 3; ++c) finish.tint[c] *= static_cast<float>(std::exp(rng.gaussian(aging.tint)));
  CatalogObject aged = object;
  aged.appearance = std::make_shared<BodyAppearance>(*object.appearance, finish);
  return aged;
}

}  // namespace recognition
