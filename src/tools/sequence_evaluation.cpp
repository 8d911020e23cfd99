#include "tools/sequence_evaluation.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <stdexcept>

#include "alignment/prepared_model.h"
#include "evaluation/result_files.h"
#include "evaluation/sequence_score.h"
#include "rgbd_recognition/sequence_recognizer.h"
#include "tools/progress_bar.h"

namespace recognition {
namespace {

namespace fs = std::filesystem;

/// What tracks say of a frame, as rows of a results file.
std::vector<ResultRow> rowsOf(const BopFrame& source, const SequenceFrame& frame, const ModelDatabase& database) {
  std::vector<ResultRow> rows;
  for (const SequenceAnswer& answer : frame.answers) {
    ResultRow row;
    row.stamp = frame.stamp;
    row.run = source.scene;
    row.frame = source.frame;
    row.object_id = answer.object_id;
    row.instance = answer.instance;
    row.camera_from_object = answer.camera_from_object;
    for (const auto& object : database.objects)
      if (object->challenge_id == answer.object_id) row.object = object->name;
    rows.push_back(row);
  }
  return rows;
}

SequenceFrame frameOf(const BopFrame& frame, double stamp) {
  SequenceFrame out;
  out.stamp = stamp;
  out.truth = frame.ground_truth;
  return out;
}

void leaveOutUntrained(const ModelDatabase& database, std::vector<SequenceFrame>* film) {
  const auto is_unknown = [&](const GroundTruth& truth) {
    return std::none_of(database.objects.begin(), database.objects.end(),
                        [&](const auto& object) { return object->challenge_id == truth.object_id; });
  };
  for (SequenceFrame& frame : *film)
    frame.truth.erase(std::remove_if(frame.truth.begin(), frame.truth.end(), is_unknown), frame.truth.end());
}

SequenceAnswer answerOf(const PreparedModels& models, int object, int instance, const Pose& camera_from_object) {
  return {models.object(object).challenge_id, instance, camera_from_object, models.at(object).centre.cast<double>()};
}

/// Tracks in each frame.
class Followed {
 public:
  Followed(const SequenceEvaluation& evaluation, const RecognizerParameters& parameters,
           const std::shared_ptr<const ModelDatabase>& database, std::shared_ptr<const PreparedModels> models)
      : recognizer_(parameters, {}, database, evaluation.search_seconds), models_(std::move(models)) {}

  SequenceFrame next(const BopFrame& source, double stamp, const RgbdFrame& frame) {
    SequenceFrame out = frameOf(source, stamp);
    for (const Track& track : recognizer_.next(stamp, frame).tracks)
      if (track.state != TrackState::kDoubtful && track.state != TrackState::kOutOfView)
        out.answers.push_back(answerOf(*models_, track.object_index, track.instance, track.fixed_from_object));
    out.seconds = recognizer_.trackingSeconds();
    return out;
  }

 private:
  SequenceRecognizer recognizer_;
  std::shared_ptr<const PreparedModels> models_;
};

/// Detection alone: the newest result there is, of whichever frame.
class Detected {
 public:
  Detected(const SequenceEvaluation& evaluation, const Recognizer& recognizer)
      : recognizer_(recognizer), search_seconds_(evaluation.search_seconds) {}

  SequenceFrame next(const BopFrame& source, double stamp, const RgbdFrame& frame) {
    if (searching_ && stamp >= ends_) {
      answers_ = found_;
      searching_ = false;
    }
    SequenceFrame out = frameOf(source, stamp);
    out.answers = answers_;
    if (searching_) return out;
    const RecognitionResult result = recognizer_.recognize(frame);
    std::map<int, int> instances;
    found_.clear();
    for (const VerifiedHypothesis& detection : result.detections) {
      const int object = detection.hypothesis.object;
      found_.push_back(
          answerOf(*recognizer_.preparedModels(), object, instances[object]++, detection.camera_from_object));
    }
    ends_ = stamp + (search_seconds_ > 0.0 ? search_seconds_ : result.times.total);
    out.seconds = result.times.total;
    searching_ = true;
    return out;
  }

 private:
  Recognizer recognizer_;
  double search_seconds_;
  std::vector<SequenceAnswer> answers_, found_;
  bool searching_ = false;
  double ends_ = 0.0;
};

}  // namespace

void evaluateSequences(const SequenceEvaluation& evaluation, const RecognizerParameters& parameters,
                       const std::shared_ptr<const ModelDatabase>& database, const std::vector<BopFrame>& frames) {
  std::map<int, std::vector<const BopFrame*>> films;
  for (const BopFrame& frame : frames) films[frame.scene].push_back(&frame);
  const Recognizer recognizer(parameters, database);
  ProgressBar progress("evaluate", static_cast<int>(frames.size()));
  SequenceScore followed, detected;
  fs::create_directories(evaluation.out);
  std::ofstream rows(fs::path(evaluation.out) / "tracks.csv");
  if (!rows) throw std::runtime_error(evaluation.out + "/tracks.csv: cannot be written");
  writeNamedHeader(rows);
  for (const auto& [scene, film] : films) {
    Followed follow(evaluation, parameters, database, recognizer.preparedModels());
    Detected detect(evaluation, recognizer);
    std::vector<SequenceFrame> tracks, detections;
    for (const BopFrame* source : film) {
      const double stamp = 1.0 + source->frame / evaluation.rate;
      const RgbdFrame frame = loadBopFrame(*source);
      tracks.push_back(follow.next(*source, stamp, frame));
      writeNamedRows(rows, rowsOf(*source, tracks.back(), *database));
      detections.push_back(detect.next(*source, stamp, frame));
      progress.advance(source->name());
    }
    if (evaluation.only_trained) {
      leaveOutUntrained(*database, &tracks);
      leaveOutUntrained(*database, &detections);
    }
    followed.add(scoreSequence(tracks));
    detected.add(scoreSequence(detections));
  }
  std::cout << sequenceText("tracking", followed) << sequenceText("detection alone", detected);
  if (!rows.flush()) throw std::runtime_error(evaluation.out + "/tracks.csv: cannot be written");
  const fs::path file = fs::path(evaluation.out) / "sequence.json";
  std::ofstream out(file);
  out << "{\"tracking\": " << sequenceJson(followed) << ", \"detection_alone\": " << sequenceJson(detected) << "}\n";
  if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
  std::cout << "written: " << file.string() << "\n";
}

}  // namespace recognition
