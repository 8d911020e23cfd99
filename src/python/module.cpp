// The Python module rgbd_recognition.core: the library without ROS, with numpy.

#include "python/bindings.h"

PYBIND11_MODULE(core, module) {
  module.doc() =
      "Finds trained, textured objects in RGB-D frames, without ROS.\n\n"
      "Lengths are metres. A pose is a 4 x 4 array that leads from the object's frame to the camera's optical frame.";
  recognition::bindModels(module);
  recognition::bindRecognition(module);
  recognition::bindEvaluation(module);
}
