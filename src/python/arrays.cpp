#include "python/arrays.h"

#include <string>

namespace py = pybind11;

namespace recognition {
namespace {

int depthOf(const py::array& array) {
  if (py::isinstance<py::array_t<std::uint8_t>>(array)) return CV_8U;
  if (py::isinstance<py::array_t<std::uint16_t>>(array)) return CV_16U;
  if (py::isinstance<py::array_t<float>>(array)) return CV_32F;
  return -1;
}

py::dtype typeOf(int depth) {
  switch (depth) {
    case CV_8U:
      return py::dtype::of<std::uint8_t>();
    case CV_8S:
      return py::dtype::of<std::int8_t>();
    case CV_16U:
      return py::dtype::of<std::uint16_t>();
    case CV_32S:
      return py::dtype::of<std::int32_t>();
    case CV_32F:
      return py::dtype::of<float>();
    default:
      throw py::type_error("an image of a type that numpy does not get");
  }
}

}  // namespace

cv::Mat imageOf(const py::array& array, const char* what) {
  const int depth = depthOf(array);
  if (depth < 0) throw py::value_error(std::string(what) + " must be uint8, uint16 or float32");
  if (array.ndim() != 2 && array.ndim() != 3)
    throw py::value_error(std::string(what) + " must have two or three dimensions, not " +
                          std::to_string(array.ndim()));
  const py::ssize_t channels = array.ndim() == 3 ? array.shape(2) : 1, pixel = channels * array.itemsize();
  if (channels < 1 || channels > 4) throw py::value_error(std::string(what) + " must have one to four channels");
  if (array.strides(1) != pixel || (array.ndim() == 3 && array.strides(2) != array.itemsize()) ||
      array.strides(0) < array.shape(1) * pixel)
    throw py::value_error(std::string(what) + " must have its pixels side by side: numpy.ascontiguousarray() helps");
  return cv::Mat(static_cast<int>(array.shape(0)), static_cast<int>(array.shape(1)),
                 CV_MAKETYPE(depth, static_cast<int>(channels)), const_cast<void*>(array.data()),
                 static_cast<size_t>(array.strides(0)));
}

py::array arrayOf(const cv::Mat& image) {
  auto* owner = new cv::Mat(image);
  const py::capsule holder(owner, [](void* mat) { delete static_cast<cv::Mat*>(mat); });
  const auto channel = static_cast<py::ssize_t>(image.elemSize1());
  std::vector<py::ssize_t> shape{image.rows, image.cols};
  std::vector<py::ssize_t> strides{static_cast<py::ssize_t>(image.step[0]), static_cast<py::ssize_t>(image.elemSize())};
  if (image.channels() > 1) {
    shape.push_back(image.channels());
    strides.push_back(channel);
  }
  return py::array(typeOf(image.depth()), shape, strides, image.data, holder);
}

}  // namespace recognition
