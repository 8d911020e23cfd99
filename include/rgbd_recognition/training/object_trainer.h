#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rgbd_recognition/features/feature_parameters.h"
#include "rgbd_recognition/training/training_parameters.h"
#include "rgbd_recognition/model/model_store.h"
#include "rgbd_recognition/training/recorded_object.h"

namespace recognition {

/// The descriptors that the shipped configurations ask for, so that one store serves all.
std::vector<DescriptorType> defaultDescriptorTypes();

/// How models are trained, from any source.
struct TrainingSettings {
  RecordingParameters recording;
  TrainingParameters meshes;
  FeatureParameters features;  ///< of the extractors
  std::vector<DescriptorType> types = defaultDescriptorTypes();
};

/// What to do if the store has a model of the name already.
enum class ExistingModel {
  kKeep,              ///< nothing if it has the same source and parameters; else refuse
  kReplace,           ///< train anew
  kExtend,            ///< add to it, see extendModel()
  kExtendTurnedOver,  ///< the same, where the object is known to stand on its head
};

struct TrainingTask {
  std::string name;
  int challenge_id = -1;
  std::string source;  ///< a file or a topic; with the parameters it tells whether a training was done before
  ExistingModel existing = ExistingModel::kKeep;
  std::optional<Pose> world_from_object;  ///< of recordings: the model's frame, see RecordedObject
};

/// How a mesh is taken.
struct MeshOptions {
  bool unit_is_sure = true;  ///< else a mesh below 2 cm or above 1.5 m is refused, and the message asks for the unit
  bool untextured = false;   ///< else a mesh without texture, or with next to no features, is refused
  bool self_test = false;    ///< whether the new model is looked for in rendered frames, see SelfTest
};

/// What recognition can expect of a mesh's model: in how many rendered frames it was found, by distance. The frames
/// have 640x480 pixels and depth with a Kinect's noise; the object stands in front of a wall.
struct SelfTest {
  struct Distance {
    double metres = 0.0;
    int views = 0;  ///< 0: too near for the object's size
    int found = 0;
  };
  std::vector<Distance> distances;
  double texel = 0.0;  ///< side of a texel on the surface, metres; 0 without a texture
};

struct TrainingOutcome {
  bool unchanged = false;  ///< the store had this model already, of the same source and parameters
  ObjectModel model;       ///< as it is in the store now
  TrainingReport report;   ///< of views; empty for meshes
  std::optional<SelfTest> self_test;
  double seconds = 0.0;
};

/// The next view of a recording, or false at its end. Throws std::runtime_error for a view that cannot be read, and
/// goes on after it; TrainingCancelled ends all.
using ViewSource = std::function<bool(RecordedView*)>;

/// Is told how a training goes on, in its thread.
class TrainingListener {
 public:
  virtual ~TrainingListener() = default;
  /// As TrainingProgress; may throw TrainingCancelled.
  virtual void progress(const std::string& /*stage*/, double /*done*/) {}
  /// A view was taken; `reason` is empty, or why it was not used.
  virtual void viewTaken(const RecordedObject& /*object*/, const RecordedView& /*view*/,
                         const std::string& /*reason*/) {}
};

/// Trains objects into a store: the one pipeline behind the tool and the nodelet. The store changes only once a model
/// is complete.
class ObjectTrainer {
 public:
  /// Takes the right to write for its lifetime; throws std::runtime_error if another writer has it.
  ObjectTrainer(const std::string& store, const TrainingSettings& settings);

  /// Both throw std::invalid_argument or std::runtime_error with the reason if no model can be made: a bad name, a bad
  /// source, a model that is there already (see ExistingModel), a store that cannot be written. `unit` is the length of
  /// the mesh file's unit in metres. A task without a challenge id gets one that is free in the store.
  TrainingOutcome trainFromMesh(const TrainingTask& task, const std::string& file, double unit,
                                TrainingListener& listener, const MeshOptions& options = {});
  TrainingOutcome trainFromViews(const TrainingTask& task, const std::optional<FiducialBoard>& board,
                                 const ViewSource& views, TrainingListener& listener);

  const ModelStore& store() const { return store_; }

 private:
  using Provenance = std::map<std::string, std::string>;
  Provenance provenanceOf(const ParameterList& parameters, const std::string& group);
  bool isThere(const TrainingTask& task, const Provenance& provenance) const;
  TrainingOutcome save(const TrainingTask& task, ObjectModel model, const Provenance& provenance);
  int freeId(const std::string& name) const;

  TrainingSettings settings_;
  ModelStore store_;
  std::shared_ptr<ModelStore::WriteLock> lock_;
};

/// One line for people: points, Sigma, features by type.
std::string describe(const ObjectModel& model);

/// One line for people: at which distances it was found, and how fine its texture is.
std::string describe(const SelfTest& test);

}  // namespace recognition
