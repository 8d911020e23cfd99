#include "rgbd_recognition/training/object_trainer.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iomanip>
#include <sstream>
#include <stdexcept>

#include "core/short_number.h"
#include "rgbd_recognition/meshes/mesh.h"
#include "training/model_builder.h"
#include "training/model_extension.h"
#include "training/self_test.h"
#include "training/turned_over.h"

namespace recognition {
namespace {

constexpr int kFirstOwnId = 1001;                      // beyond the ids of the data sets that there are
constexpr int kMinFeaturesOfType = 30;                 // of a type, from all sides; a pose needs some from one side
constexpr double kLikelyMin = 0.02, kLikelyMax = 1.5;  // metres
const char* const kUntextured = "train --untextured says that it is meant";
constexpr char kMeshUnit[] = "mesh_unit";  // metres, of the file's numbers

class Clock {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void takeAll(const ViewSource& views, RecordedObject& object, TrainingListener& listener) {
  for (;;) {
    RecordedView view;
    try {
      if (!views(&view)) return;
    } catch (const TrainingCancelled&) {
      throw;
    } catch (const std::runtime_error& error) {
      object.refuse(error.what());
      continue;
    }
    listener.viewTaken(object, view, object.add(view));
  }
}

bool isExtension(const TrainingTask& task) {
  return task.existing == ExistingModel::kExtend || task.existing == ExistingModel::kExtendTurnedOver;
}

std::string typeNames(const std::vector<DescriptorType>& types) {
  std::vector<std::string> names;
  for (const DescriptorType type : types) names.emplace_back(descriptorName(type));
  std::sort(names.begin(), names.end());
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " ") + name;
  return text;
}

// Most objects that a Kinect-like camera is to find are of a length in between.
void requireLikelyLength(const std::string& file, const TexturedMesh& mesh, double unit) {
  const double length = longestSide(mesh);
  if (length >= kLikelyMin && length <= kLikelyMax) return;
  std::string others;
  for (const double other : {0.001, 0.01, 1.0})
    if (other != unit)
      others += ", unit " + shortNumber(other) + " makes it " + shortNumber(length / unit * other) + " m";
  throw std::runtime_error(file + ": is " + shortNumber(length) + " m long if its unit is " + shortNumber(unit) +
                           " m; is that right? Giving the unit " + shortNumber(unit) + " says so" + others);
}

void requireFeatures(const std::string& file, const ObjectModel& model) {
  int most = 0;
  for (const auto& [type, features] : model.features) most = std::max(most, features.count());
  if (most < kMinFeaturesOfType)
    throw std::runtime_error(file + ": has next to no texture (" + std::to_string(most) +
                             " features): recognition would not find it (" + kUntextured + ")");
}

std::string unitText(double unit) {
  std::ostringstream text;
  text << std::setprecision(12) << unit;
  return text.str();
}

std::string poseText(const Pose& pose) {
  std::ostringstream text;
  text << pose.matrix().topRows<3>().format(Eigen::IOFormat(Eigen::StreamPrecision, Eigen::DontAlignCols, " ", " "));
  return text.str();
}

}  // namespace

std::vector<DescriptorType> defaultDescriptorTypes() {
  const DescriptorType ours = FeatureParameters().descriptor, papers = DescriptorType::kSurf128;
  return ours == papers ? std::vector<DescriptorType>{papers} : std::vector<DescriptorType>{papers, ours};
}

ObjectTrainer::ObjectTrainer(const std::string& store, const TrainingSettings& settings)
    : settings_(settings), store_(store), lock_(store_.lock()) {
  settings_.recording.validate();
  settings_.meshes.validate();
  settings_.features.validate();
}

// What, if the same, makes training again needless.
ObjectTrainer::Provenance ObjectTrainer::provenanceOf(const ParameterList& parameters, const std::string& group) {
  Provenance provenance;
  for (const Parameter& p : parameters) provenance[group + "/" + p.name] = valueText(p);
  for (const Parameter& p : settings_.features.list())  // of the extractors alone: the others concern scenes
    if (p.name.rfind("sift_", 0) == 0 || p.name.rfind("surf_", 0) == 0)
      provenance["feature_extraction/" + p.name] = valueText(p);
  provenance["descriptors"] = typeNames(settings_.types);
  return provenance;
}

bool ObjectTrainer::isThere(const TrainingTask& task, const Provenance& provenance) const {
  requireObjectName(task.name);
  if (isExtension(task) && !store_.contains(task.name))
    throw std::runtime_error(task.name + ": there is no such model to extend");
  if (task.existing != ExistingModel::kKeep || !store_.contains(task.name)) return false;
  try {
    Provenance known = store_.load(task.name).provenance;
    if (provenance.count(kMeshUnit) > 0) known[kMeshUnit] = provenance.at(kMeshUnit);  // the checksum has it, too
    if (known == provenance) return true;
  } catch (const std::runtime_error&) {  // damaged
  }
  throw std::runtime_error(task.name + ": is in the store, but trained otherwise or damaged; overwrite or extend it");
}

// The id that the model has already, or one of our own: so that result files tell objects apart.
int ObjectTrainer::freeId(const std::string& name) const {
  int id = kFirstOwnId;
  for (const std::string& other : store_.names()) {
    try {
      const int taken = store_.load(other, {DescriptorType::kSurf128}).challenge_id;
      if (other == name && taken >= 0) return taken;
      id = std::max(id, taken + 1);
    } catch (const std::runtime_error&) {  // damaged
    }
  }
  return id;
}

TrainingOutcome ObjectTrainer::save(const TrainingTask& task, ObjectModel model, const Provenance& provenance) {
  TrainingOutcome outcome;
  if (isExtension(task)) {
    const ObjectModel before = store_.load(task.name);
    model = extendModel(before, model, settings_.recording,
                        task.existing == ExistingModel::kExtendTurnedOver ? Stand::kTurnedOver : Stand::kAny);
    model.provenance["extended_by"] = task.source;
  } else {
    model.challenge_id = task.challenge_id >= 0 ? task.challenge_id : freeId(task.name);
    model.source = task.source;
    model.provenance = provenance;
  }
  store_.save(model);
  outcome.model = std::move(model);
  return outcome;
}

TrainingOutcome ObjectTrainer::trainFromMesh(const TrainingTask& task, const std::string& file, double unit,
                                             TrainingListener& listener, const MeshOptions& options) {
  const Clock clock;
  requireObjectName(task.name);
  const TexturedMesh mesh = readMesh(file, unit, options.untextured);
  if (!options.unit_is_sure) requireLikelyLength(file, mesh, unit);
  if (!options.untextured && !hasColors(mesh))
    throw std::runtime_error(file +
                             ": has no texture, and no colours that differ; recognition finds textured objects (" +
                             kUntextured + ")");
  Provenance provenance = provenanceOf(settings_.meshes.list(), "training");
  provenance["mesh_crc32"] = meshChecksum(mesh);
  provenance[kMeshUnit] = unitText(unit);
  TrainingOutcome outcome;
  outcome.unchanged = isThere(task, provenance);
  if (outcome.unchanged) {
    outcome.model = store_.load(task.name);
  } else {
    const auto progress = [&](const std::string& stage, double done) { listener.progress(stage, done); };
    TrainingTask named = task;
    if (named.source == file) named.source = std::filesystem::absolute(file).lexically_normal().string();
    ObjectModel model =
        buildModelFromMesh(mesh, task.name, settings_.meshes, settings_.features, settings_.types, progress);
    if (!options.untextured) requireFeatures(file, model);
    outcome = save(named, std::move(model), provenance);
    if (options.self_test) outcome.self_test = testModel(mesh, outcome.model, settings_.features, progress);
  }
  outcome.seconds = clock.seconds();
  return outcome;
}

TrainingOutcome ObjectTrainer::trainFromViews(const TrainingTask& task, const std::optional<FiducialBoard>& board,
                                              const ViewSource& views, TrainingListener& listener) {
  const Clock clock;
  Provenance provenance = provenanceOf(settings_.recording.list(), "recording");
  provenance["recording"] = task.source;
  if (task.world_from_object) provenance["world_from_object"] = poseText(*task.world_from_object);
  TrainingOutcome outcome;
  outcome.unchanged = isThere(task, provenance);
  if (outcome.unchanged) {
    outcome.model = store_.load(task.name);
  } else {
    RecordedObject object(settings_.recording, settings_.features, board, task.world_from_object);
    takeAll(views, object, listener);
    const auto progress = [&](const std::string& stage, double done) { listener.progress(stage, done); };
    RecordedObject::Result result = object.build(task.name, settings_.types, progress);
    outcome = save(task, std::move(result.model), provenance);
    outcome.report = std::move(result.report);
    if (isExtension(task) && !isWhole(outcome.model))
      outcome.report.warnings.emplace_back(
          "still no view shows what it stood on; if it was turned over, its two sides look too much alike");
  }
  outcome.seconds = clock.seconds();
  return outcome;
}

std::string describe(const ObjectModel& model) {
  char text[120];
  std::snprintf(text, sizeof(text), "%zu points, sigma %.3f %.3f %.3f m", model.cloud.size(), model.extents.sigma_min,
                model.extents.sigma_max, model.extents.sigma_d);
  std::string line = text;
  for (const auto& [type, features] : model.features)
    line += ", " + std::to_string(features.count()) + " " + descriptorName(type) + " features";
  return line;
}

}  // namespace recognition
