#include "tools/sequence_evaluation.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <stdexcept>

#include "evaluation/sequence_score.h"
#include "rgbd_recognition/sequence_recognizer.h"
#include "tools/progress_bar.h"

namespace recognition {
namespace {

namespace fs = std::filesystem;

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

/// Tracks in each frame.
class Followed {
 public:
  Followed(const SequenceEvaluation& evaluation, const RecognizerParameters& parameters,
           const std::shared_ptr<const ModelDatabase>& database)
      : recognizer_(parameters, {}, database, evaluation.search_seconds), database_(*database) {}

  SequenceFrame next(const BopFrame& source, double stamp, const RgbdFrame& frame) {
    SequenceFrame out = frameOf(source, stamp);
    for (const Track& track : recognizer_.next(stamp, frame).tracks)
      if (track.state != TrackState::kDoubtful && track.state != TrackState::kOutOfView)
        out.answers.push_back({database_.objects[static_cast<size_t>(track.object_index)]->challenge_id, track.instance,
                               track.fixed_from_object});
    out.seconds = recognizer_.trackingSeconds();
    return out;
  }

 private:
  SequenceRecognizer recognizer_;
  const ModelDatabase& database_;
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
      const int id = recognizer_.database().objects[static_cast<size_t>(detection.hypothesis.object)]->challenge_id;
      found_.push_back({id, instances[id]++, detection.camera_from_object});
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
  for (const auto& [scene, film] : films) {
    Followed follow(evaluation, parameters, database);
    Detected detect(evaluation, recognizer);
    std::vector<SequenceFrame> tracks, detections;
    for (const BopFrame* source : film) {
      const double stamp = 1.0 + source->frame / evaluation.rate;
      const RgbdFrame frame = loadBopFrame(*source);
      tracks.push_back(follow.next(*source, stamp, frame));
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
  fs::create_directories(evaluation.out);
  const fs::path file = fs::path(evaluation.out) / "sequence.json";
  std::ofstream out(file);
  out << "{\"tracking\": " << sequenceJson(followed) << ", \"detection_alone\": " << sequenceJson(detected) << "}\n";
  if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
  std::cout << "written: " << file.string() << "\n";
}

}  // namespace recognition
