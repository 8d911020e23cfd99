// recognize_picture MODELS COLOR DEPTH CAMERA: finds the trained objects of a store in one RGB-D frame.
#include <iostream>

#include <rgbd_recognition/evaluation/bop_dataset.h>
#include <rgbd_recognition/model/model_store.h>
#include <rgbd_recognition/recognizer.h>

int main(int argc, char** argv) try {
  if (argc != 5) throw std::invalid_argument("usage: recognize_picture MODELS COLOR DEPTH CAMERA");
  const auto models = recognition::ModelStore(argv[1]).loadAll();
  for (const std::string& error : models.errors) std::cerr << error << "\n";
  const recognition::RgbdFrame frame = recognition::loadFrameFiles(argv[2], argv[3], argv[4]);
  recognition::Recognizer recognizer(recognition::RecognizerParameters(), models.database);
  for (const auto& detection : recognizer.recognize(frame).detections) {
    const auto& object = *models.database->objects[detection.hypothesis.object];
    std::cout << object.name << " at " << detection.camera_from_object.translation().transpose() << " m, confidence "
              << detection.confidence << "\n";
  }
} catch (const std::exception& error) {
  std::cerr << error.what() << "\n";
  return 1;
}
