#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "python/arrays.h"
#include "python/bindings.h"
#include "rgbd_recognition/model/model_store.h"
#include "rgbd_recognition/training/object_trainer.h"

namespace py = pybind11;

namespace recognition {
namespace {

/// One column of the cloud as rows of three: a copy, as the cloud keeps points, normals and colours side by side.
template <typename Value, typename Get>
py::array cloudColumn(const ObjectModel& model, Get get) {
  py::array_t<Value> column({static_cast<py::ssize_t>(model.cloud.size()), py::ssize_t(3)});
  auto cells = column.template mutable_unchecked<2>();
  for (size_t i = 0; i < model.cloud.size(); ++i)
    for (int k = 0; k < 3; ++k) cells(static_cast<py::ssize_t>(i), k) = get(model.cloud[i])[k];
  return column;
}

void bindModel(py::module_& module) {
  using ModelClass = py::class_<ObjectModel, std::shared_ptr<ObjectModel>>;
  ModelClass(module, "Model", "A trained object: cloud, features, extents.")
      .def_readonly("name", &ObjectModel::name)
      .def_readonly("object_id", &ObjectModel::challenge_id, "BOP's obj_id, or -1")
      .def_readonly("source", &ObjectModel::source, "what it was trained from")
      .def_property_readonly(
          "points",
          [](const ObjectModel& m) {
            return cloudColumn<float>(m, [](const SurfacePoint& p) -> const Eigen::Vector3f& { return p.position; });
          },
          "n x 3, metres")
      .def_property_readonly(
          "normals",
          [](const ObjectModel& m) {
            return cloudColumn<float>(m, [](const SurfacePoint& p) -> const Eigen::Vector3f& { return p.normal; });
          },
          "n x 3, unit")
      .def_property_readonly(
          "colors",
          [](const ObjectModel& m) {
            return cloudColumn<std::uint8_t>(m, [](const SurfacePoint& p) -> const cv::Vec3b& { return p.rgb; });
          },
          "n x 3, red, green, blue")
      .def_property_readonly(
          "extents",
          [](const ObjectModel& m) {
            return Eigen::Vector3d(m.extents.sigma_min, m.extents.sigma_max, m.extents.sigma_d);
          },
          "sigma_min, sigma_max, sigma_d of eq. (4), metres")
      .def(
          "descriptors",
          [](const ObjectModel& m, const std::string& type) {
            const auto found = m.features.find(descriptorFromName(type));
            if (found == m.features.end()) throw py::key_error(m.name + " has no " + type + " features");
            return arrayOf(found->second.descriptors);
          },
          py::arg("type"), "n x length, int8; type: surf128, surf64 or sift")
      .def("__repr__", [](const ObjectModel& m) { return m.name + ": " + describe(m); });
}

void bindStore(py::module_& module) {
  py::class_<ModelStore>(module, "ModelStore", "A folder of models.")
      .def(py::init<std::string>(), py::arg("directory"))
      .def_property_readonly("directory", &ModelStore::directory)
      .def("names", &ModelStore::names)
      .def("__contains__", &ModelStore::contains)
      .def(
          "load",
          [](const ModelStore& store, const std::string& name) {
            return std::make_shared<ObjectModel>(store.load(name));
          },
          py::arg("name"), "RuntimeError if it is not there or damaged")
      .def("remove", &ModelStore::remove, py::arg("name"))
      .def("rename", &ModelStore::rename, py::arg("old"), py::arg("new"))
      .def("export_model", &ModelStore::exportModel, py::arg("name"), py::arg("file"))
      .def("import_model", &ModelStore::importModel, py::arg("file"), "The name of the model that was added.");
}

std::vector<DescriptorType> descriptorTypes(const std::vector<std::string>& names) {
  std::vector<DescriptorType> types;
  for (const std::string& name : names) types.push_back(descriptorFromName(name));
  return types;
}

class Trainer {
 public:
  Trainer(const std::string& directory, const std::vector<std::string>& descriptors)
      : trainer_(directory, settings(descriptors)) {}

  std::shared_ptr<ObjectModel> trainFromMesh(const std::string& file, const std::string& name, double unit,
                                             bool replace) {
    TrainingTask task;
    task.name = name;
    task.source = file;
    task.existing = replace ? ExistingModel::kReplace : ExistingModel::kKeep;
    TrainingListener silent;
    return std::make_shared<ObjectModel>(trainer_.trainFromMesh(task, file, unit, silent).model);
  }

 private:
  static TrainingSettings settings(const std::vector<std::string>& descriptors) {
    TrainingSettings settings;
    if (!descriptors.empty()) settings.types = descriptorTypes(descriptors);
    return settings;
  }

  ObjectTrainer trainer_;
};

}  // namespace

void bindModels(py::module_& module) {
  bindModel(module);
  bindStore(module);
  py::class_<Trainer>(module, "Trainer", "Trains objects into the store in a folder; the only writer while it lives.")
      .def(py::init<std::string, std::vector<std::string>>(), py::arg("directory"),
           py::arg("descriptors") = std::vector<std::string>(),
           "descriptors: of surf128, surf64, sift; those of the shipped configurations by default")
      .def("train_from_mesh", &Trainer::trainFromMesh, py::call_guard<py::gil_scoped_release>(), py::arg("file"),
           py::arg("name"), py::arg("unit") = 1.0, py::arg("replace") = false,
           "The new model. unit: metres a unit of the file, 0.001 for millimetres.");
}

}  // namespace recognition
