#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "python/arrays.h"
#include "python/bindings.h"
#include "rgbd_recognition/model/model_store.h"
#include "rgbd_recognition/recognizer.h"

namespace py = pybind11;

namespace recognition {
namespace {

std::shared_ptr<const ModelDatabase> loadModels(const std::string& directory) {
  const ModelStore::LoadResult loaded = ModelStore(directory).loadAll();
  for (const std::string& error : loaded.errors)
    PyErr_WarnEx(PyExc_RuntimeWarning, ("model skipped: " + error).c_str(), 1);
  if (PyErr_Occurred()) throw py::error_already_set();
  if (loaded.database->objects.empty()) throw std::runtime_error(directory + " holds no model");
  return loaded.database;
}

Recognizer makeRecognizer(const std::string& directory, const std::string& config) {
  return Recognizer(config.empty() ? RecognizerParameters() : RecognizerParameters::fromYaml(config),
                    loadModels(directory));
}

/// A hypothesis with its object's name, which it knows by index only.
struct NamedHypothesis {
  VerifiedHypothesis hypothesis;
  std::string object;
  int object_id;
};

struct NamedResult {
  std::shared_ptr<const RecognitionResult> result;
  std::vector<NamedHypothesis> detections, hypotheses;
};

std::vector<NamedHypothesis> named(const std::vector<VerifiedHypothesis>& hypotheses, const ModelDatabase& database) {
  std::vector<NamedHypothesis> all;
  for (const VerifiedHypothesis& h : hypotheses) {
    const ObjectModel& model = *database.objects[static_cast<size_t>(h.hypothesis.object)];
    all.push_back({h, model.name, model.challenge_id});
  }
  return all;
}

NamedResult recognize(Recognizer& recognizer, const py::array& color, const py::array& depth, const CameraModel& camera,
                      const std::string& order) {
  if (order != "rgb" && order != "bgr") throw py::value_error("order must be 'rgb' or 'bgr', not '" + order + "'");
  RgbdFrame frame;
  frame.color = imageOf(color, "color");
  frame.color_order = order == "rgb" ? ColorOrder::kRgb : ColorOrder::kBgr;
  frame.depth = imageOf(depth, "depth");
  frame.color_camera = camera;
  if (camera.width == 0) {
    frame.color_camera.width = frame.color.cols;
    frame.color_camera.height = frame.color.rows;
  }
  const py::gil_scoped_release others_run;
  auto result = std::make_shared<const RecognitionResult>(recognizer.recognize(frame));
  return {result, named(result->detections, recognizer.database()), named(result->hypotheses, recognizer.database())};
}

void bindCamera(py::module_& module) {
  py::class_<CameraModel>(module, "Camera", "Pinhole camera of a rectified colour image, eq. (2); pixels.")
      .def(py::init([](double fx, double fy, double cx, double cy, int width, int height) {
             return CameraModel{width, height, fx, fy, cx, cy};
           }),
           py::arg("fx"), py::arg("fy"), py::arg("cx"), py::arg("cy"), py::arg("width") = 0, py::arg("height") = 0,
           "width and height: the image's by default")
      .def_readonly("fx", &CameraModel::fx)
      .def_readonly("fy", &CameraModel::fy)
      .def_readonly("cx", &CameraModel::cx)
      .def_readonly("cy", &CameraModel::cy)
      .def_readonly("width", &CameraModel::width)
      .def_readonly("height", &CameraModel::height);
}

void bindDetection(py::module_& module) {
  const auto read = [](auto member) { return [member](const NamedHypothesis& h) { return h.hypothesis.*member; }; };
  py::class_<NamedHypothesis>(module, "Detection", "An object with a pose: accepted, or with the reason why not.")
      .def_readonly("object", &NamedHypothesis::object, "name of the model")
      .def_readonly("object_id", &NamedHypothesis::object_id, "BOP's obj_id, or -1")
      .def_property_readonly("confidence", read(&VerifiedHypothesis::confidence), "probability that it is right")
      .def_property_readonly(
          "pose", [](const NamedHypothesis& h) -> Eigen::Matrix4d { return h.hypothesis.camera_from_object.matrix(); },
          "4 x 4, camera from object")
      .def_property_readonly("covariance", read(&VerifiedHypothesis::covariance),
                             "6 x 6 of the pose: x y z (m), rotation (rad)")
      .def_property_readonly("accepted", [](const NamedHypothesis& h) { return h.hypothesis.accepted(); })
      .def_property_readonly("rejection",
                             [](const NamedHypothesis& h) { return rejectionName(h.hypothesis.rejection); })
      .def_property_readonly("source",
                             [](const NamedHypothesis& h) { return sourceName(h.hypothesis.hypothesis.source); })
      .def_property_readonly("consensus",
                             [](const NamedHypothesis& h) { return h.hypothesis.hypothesis.consensus.size(); })
      .def("__repr__", [](const NamedHypothesis& h) {
        return "<Detection " + h.object + ", confidence " + std::to_string(h.hypothesis.confidence) + ">";
      });
}

py::dict stageTimes(const NamedResult& r) {
  const StageTimes& t = r.result->times;
  py::dict times;
  times["segmentation"] = t.segmentation;
  times["feature_extraction"] = t.feature_extraction;
  times["hypothesis_generation"] = t.hypothesis_generation;
  times["reprojection_verification"] = t.reprojection_verification;
  times["total"] = t.total;
  return times;
}

void bindResult(py::module_& module) {
  py::class_<NamedResult>(module, "Result", "All that one frame gave.")
      .def_readonly("detections", &NamedResult::detections, "by falling confidence")
      .def_readonly("hypotheses", &NamedResult::hypotheses, "all that was tested")
      .def_property_readonly(
          "labels", [](const NamedResult& r) { return arrayOf(r.result->segmentation.labels); },
          "int32 at depth's resolution: patches from 1 on, 0 no patch, -1 a large plane")
      .def_property_readonly(
          "keypoints",
          [](const NamedResult& r) {
            const auto& all = r.result->features.image.keypoints;
            py::array_t<float> rows({static_cast<py::ssize_t>(all.size()), py::ssize_t(2)});
            auto cells = rows.mutable_unchecked<2>();
            for (size_t i = 0; i < all.size(); ++i) {
              cells(static_cast<py::ssize_t>(i), 0) = all[i].x;
              cells(static_cast<py::ssize_t>(i), 1) = all[i].y;
            }
            return rows;
          },
          "n x 2, pixels of the colour image: features that have a depth")
      .def_property_readonly(
          "left_out", [](const NamedResult& r) { return r.result->search.left_out; }, "what a budget cut, in words")
      .def_property_readonly("times", stageTimes, "wall seconds a stage");
}

}  // namespace

void bindRecognition(py::module_& module) {
  bindCamera(module);
  bindDetection(module);
  bindResult(module);
  py::class_<Recognizer>(module, "Recognizer", "The whole method in one call. One thread at a time.")
      .def(py::init(&makeRecognizer), py::arg("models"), py::arg("config") = "",
           "models: folder of a store; config: parameter file, the built-in defaults without")
      .def("recognize", &recognize, py::arg("color"), py::arg("depth"), py::arg("camera"), py::arg("order") = "rgb",
           "color: rows x columns x 3, uint8. depth: registered to color, uint16 millimetres or float32 metres; its "
           "size\n"
           "divides color's. Neither is copied. ValueError for a frame that does not fit.")
      .def_property_readonly("names", [](const Recognizer& r) {
        std::vector<std::string> names;
        for (const auto& object : r.database().objects) names.push_back(object->name);
        return names;
      });
}

}  // namespace recognition
