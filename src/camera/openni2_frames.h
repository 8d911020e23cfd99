#pragma once

#include <memory>
#include <string>

namespace recognition {

/// Where a Kinect's cameras are: <camera>_link, <camera>_depth_frame, <camera>_rgb_frame and the two ..._optical_frame,
/// on /tf_static.
///
/// A latched topic remembers one message of a process, so all cameras of a process share a publisher and a message that
/// holds the frames of all of them.
class StaticFrames {
 public:
  /// The process' own, for as long as anyone holds it. Hold it until the camera has gone.
  static std::shared_ptr<StaticFrames> shared();

  /// A typical Kinect's geometry, as rgbd_launch's kinect_frames.launch has it.
  void addKinect(const std::string& camera);

  ~StaticFrames();

 private:
  StaticFrames();
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace recognition
