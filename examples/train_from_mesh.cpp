// train_from_mesh MODELS MESH NAME [UNIT]: adds the model of a textured mesh to a store. UNIT: metres, 0.001 for millimetres.
#include <iostream>

#include <rgbd_recognition/training/object_trainer.h>

int main(int argc, char** argv) try {
  if (argc != 4 && argc != 5) throw std::invalid_argument("usage: train_from_mesh MODELS MESH NAME [UNIT]");
  recognition::ObjectTrainer trainer(argv[1], recognition::TrainingSettings());
  recognition::TrainingTask task;
  task.name = argv[3];
  task.source = argv[2];
  recognition::TrainingListener silent;
  const auto outcome = trainer.trainFromMesh(task, argv[2], argc == 5 ? std::stod(argv[4]) : 1.0, silent);
  std::cout << recognition::describe(outcome.model) << "\n";
} catch (const std::exception& error) {
  std::cerr << error.what() << "\n";
  return 1;
}
