#pragma once

#include <pybind11/pybind11.h>

namespace recognition {

// Each adds one part of the library to the Python module.
void bindModels(pybind11::module_& module);       ///< ModelStore, Model, Trainer
void bindRecognition(pybind11::module_& module);  ///< Camera, Recognizer, Result, Detection
void bindEvaluation(pybind11::module_& module);   ///< read_bop_split(), evaluate_frame(), report()

}  // namespace recognition
