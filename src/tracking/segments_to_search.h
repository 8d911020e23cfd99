#pragma once

#include <map>

#include <opencv2/core.hpp>

#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/segmentation/segmentation.h"

namespace recognition {

/// What of a frame is worth a search beside what tracks explain: a segment that was searched in full and has not
/// changed waits, and now and then all is searched again. Frames are compared as SceneChange does: by copies of a cell
/// for each 8 pixels. Stamps are in seconds; one that is older than the last forgets all.
class SegmentsToSearch {
 public:
  /// `period`: seconds after which the whole frame is searched again.
  explicit SegmentsToSearch(double period) : period_(period) {}

  /// Whether anything beside the explained pixels (as ObjectTracker::explained() gives them; may be empty) has changed
  /// since the frame that select() saw last, or is not searched yet, or awaits another detection: if not, the frame need
  /// not even be segmented.
  bool isWorthALook(double stamp, const RgbdFrame& frame, const cv::Mat& explained);

  /// The segments to search, with labels anew; none is left where all is explained or known. The search of this frame
  /// is then expected to end with searched().
  Segmentation select(double stamp, const RgbdFrame& frame, const Segmentation& segmentation, const cv::Mat& explained);

  /// The frame of that stamp was searched: in full, or not, as where a time budget cut it short.
  void searched(double stamp, bool in_full);

  /// Forgets all: the next frame is searched as a whole.
  void reset();

 private:
  /// A frame in small.
  struct Cells {
    cv::Mat gray, depth;  ///< depth in metres, 0 where unknown
    cv::Mat mask;         ///< CV_8UC1, 255: cells of segments that are searched
  };

  bool wantsAll(double stamp) const { return all_ || stamp - last_whole_ >= period_; }
  static Cells cellsOf(const RgbdFrame& frame);
  static cv::Mat changed(const Cells& now, const Cells& before);
  void forgetIfBackwards(double stamp);

  double period_;
  bool all_ = true;                    // nothing was searched yet
  double last_whole_ = 0.0;            // stamp of the last frame that was searched as a whole
  double last_ = 0.0;                  // of the last frame
  Cells looked_;                       // the frame that select() saw last; empty: none
  bool unsearched_ = false;            // it had segments whose search has not ended in full
  Cells known_;                        // mask: cells whose segments were searched in full, as they looked then
  std::map<double, Cells> in_search_;  // by stamp
};

}  // namespace recognition
