#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <opencv2/core.hpp>

namespace recognition {

/// An image of numpy as OpenCV sees it: the same pixels, not copied; valid as long as the array is. `what` names it in
/// the ValueError for an array that is no image: rows x columns, or rows x columns x channels, of uint8, uint16 or
/// float32, whose pixels lie side by side in a row (rows may be apart).
cv::Mat imageOf(const pybind11::array& array, const char* what);

/// An image or matrix of OpenCV as numpy sees it: the same memory, which lives as long as the array does.
pybind11::array arrayOf(const cv::Mat& image);

}  // namespace recognition
