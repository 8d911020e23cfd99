#include "rgbd_recognition/sequence_recognizer.h"

#include <limits>
#include <stdexcept>
#include <string>

#include "core/stopwatch.h"
#include "tracking/object_tracker.h"
#include "tracking/segments_to_search.h"

namespace recognition {
struct SequenceRecognizer::State {
  State(const RecognizerParameters& parameters, const TrackingParameters& tracking,
        std::shared_ptr<const ModelDatabase> database, double seconds)
      : recognizer(parameters, std::move(database)),
        tracker(tracking, parameters.reprojection_verification, recognizer.preparedModels()),
        to_search(tracking.search_period),
        search_seconds(seconds) {}

  /// Gives the tracker the result of the search that has ended by then.
  void endSearch(double stamp) {
    if (!in_search || stamp < ends) return;
    in_search = false;
    tracker.add(began, result.detections);
    to_search.searched(began, true);
  }

  void beginSearch(double stamp, const RgbdFrame& frame) {
    if (in_search || !to_search.isWorthALook(stamp, frame, tracker.explained())) return;
    const Stopwatch watch;
    result = recognizer.recognize(frame, [&](const Segmentation& segmentation) {
      return to_search.select(stamp, frame, segmentation, tracker.explained());
    });
    if (result.segmentation.patches.empty()) return;
    searched = watch.seconds();
    began = stamp;
    ends = stamp + (search_seconds > 0.0 ? search_seconds : searched);
    in_search = true;
    ++searches;
  }

  Recognizer recognizer;
  ObjectTracker tracker;
  SegmentsToSearch to_search;
  double search_seconds;
  RecognitionResult result;
  bool in_search = false;
  double began = 0.0, ends = 0.0;  // stamps
  double tracked = 0.0, searched = 0.0;
  int searches = 0;
};

SequenceRecognizer::SequenceRecognizer(const RecognizerParameters& parameters, const TrackingParameters& tracking,
                                       std::shared_ptr<const ModelDatabase> database, double search_seconds) {
  if (!(search_seconds >= 0.0 && search_seconds < std::numeric_limits<double>::max()))
    throw std::invalid_argument("a search cannot take " + std::to_string(search_seconds) + " s");
  state_ = std::make_unique<State>(parameters, tracking, std::move(database), search_seconds);
}

SequenceRecognizer::~SequenceRecognizer() = default;

TrackingOutcome SequenceRecognizer::next(double stamp, const RgbdFrame& frame, const Pose& fixed_from_camera) {
  State& s = *state_;
  s.searched = 0.0;
  s.endSearch(stamp);
  const Stopwatch watch;
  TrackingOutcome outcome = s.tracker.follow(stamp, frame, fixed_from_camera);
  s.tracked = watch.seconds();
  if (outcome.restarted) s.in_search = false;
  if (!outcome.ignored) s.beginSearch(stamp, frame);
  return outcome;
}

double SequenceRecognizer::trackingSeconds() const { return state_->tracked; }
double SequenceRecognizer::searchSeconds() const { return state_->searched; }
int SequenceRecognizer::searches() const { return state_->searches; }

}  // namespace recognition
