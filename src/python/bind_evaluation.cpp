#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <opencv2/imgproc.hpp>

#include "python/arrays.h"
#include "python/bindings.h"
#include "rgbd_recognition/evaluation/bop_dataset.h"
#include "rgbd_recognition/evaluation/frame_record.h"
#include "rgbd_recognition/evaluation/report.h"

namespace py = pybind11;

namespace recognition {
namespace {

/// Images and camera of a frame, as Recognizer.recognize() takes them.
py::tuple loadFrame(const BopFrame& frame) {
  const RgbdFrame loaded = loadBopFrame(frame);
  cv::Mat rgb;
  cv::cvtColor(loaded.color, rgb, cv::COLOR_BGR2RGB);
  return py::make_tuple(arrayOf(rgb), arrayOf(loaded.depth), loaded.color_camera);
}

void bindFrames(py::module_& module) {
  py::class_<GroundTruth>(module, "GroundTruth", "An object that truly is in a frame.")
      .def_readonly("object_id", &GroundTruth::object_id)
      .def_property_readonly(
          "pose", [](const GroundTruth& t) -> Eigen::Matrix4d { return t.camera_from_object.matrix(); },
          "4 x 4, camera from object")
      .def_readonly("visibility", &GroundTruth::visibility, "0..1, or -1");
  py::class_<BopFrame>(module, "BopFrame", "A frame of a BOP split, not loaded yet.")
      .def_property_readonly("name", &BopFrame::name)
      .def_readonly("ground_truth", &BopFrame::ground_truth)
      .def("load", &loadFrame, "(color, depth, camera), as Recognizer.recognize() takes them");
}

std::string reportOf(const std::vector<FrameRecord>& records) {
  return reportText(makeReport(records), records, RunInfo());
}

}  // namespace

void bindEvaluation(py::module_& module) {
  bindFrames(module);
  py::class_<FrameRecord>(module, "FrameRecord", "What a report needs of one frame.")
      .def("json", &toJsonLine, "one line, as in frames.jsonl of evaluate")
      .def_property_readonly(
          "score", [](const FrameRecord& record) { return scoreOf(record).score; },
          "the challenge's, of all instances");
  module.def("read_bop_split", &readBopSplit, py::arg("directory"), "The frames of a split of a BOP data set.");
  module.def(
      "evaluate_frame",
      [](Recognizer& recognizer, const BopFrame& frame, bool only_trained, bool oracle) {
        return evaluateFrame(recognizer, frame, {only_trained, oracle});
      },
      py::call_guard<py::gil_scoped_release>(), py::arg("recognizer"), py::arg("frame"), py::arg("only_trained") = true,
      py::arg("oracle") = false, "Recognises it and compares with its ground truth.");
  module.def("report", &reportOf, py::arg("records"), "What was found, missed and false, as text.");
}

}  // namespace recognition
