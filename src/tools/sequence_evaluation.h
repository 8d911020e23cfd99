#pragma once

#include <memory>
#include <string>
#include <vector>

#include "rgbd_recognition/evaluation/bop_dataset.h"
#include "rgbd_recognition/recognizer.h"

namespace recognition {

struct SequenceEvaluation {
  double rate = 30.0;           ///< frames a second
  double search_seconds = 0.0;  ///< see SequenceRecognizer
  bool only_trained = false;    ///< leaves out true instances of objects that the database does not have
  std::string out;              ///< folder for sequence.json and tracks.csv
};

/// Follows the objects of each scene, taken for a film, and beside it detects them in each frame that detection alone
/// gets through; prints both and writes them to `out`.
void evaluateSequences(const SequenceEvaluation& evaluation, const RecognizerParameters& parameters,
                       const std::shared_ptr<const ModelDatabase>& database, const std::vector<BopFrame>& frames);

}  // namespace recognition
