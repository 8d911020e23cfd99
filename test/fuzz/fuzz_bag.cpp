#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <tf2_msgs/TFMessage.h>

#include "fuzz/fuzz.h"
#include "bags/bag_reader.h"
#include "bags/bag_writer.h"
#include "ros/object_tf.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition {
namespace {

constexpr std::int64_t kStamp = 1000000000;

/// What `file` holds and a transform, packed otherwise: the fuzzer gets into what is not packed at all.
void writeRepacked(const std::string& file, rosbag::CompressionType compression, const std::string& name) {
  const std::string repacked = fuzzFolder() / "repacked.bag";
  rosbag::Bag in(file), out(repacked, rosbag::bagmode::Write);
  out.setCompression(compression);
  rosbag::View view(in);
  for (const rosbag::MessageInstance& message : view) out.write(message.getTopic(), message.getTime(), message);
  tf2_msgs::TFMessage tf;
  tf.transforms.resize(1);
  tf.transforms[0].header.stamp.fromNSec(kStamp);
  tf.transforms[0].header.frame_id = "camera";
  tf.transforms[0].child_frame_id = "object";
  tf.transforms[0].transform.rotation.w = 1.0;
  out.write("/tf", tf.transforms[0].header.stamp, tf);
  out.close();
  writeSeed(name, readText(repacked));
}

}  // namespace
}  // namespace recognition

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  using namespace recognition;
  const std::string file = fuzzFolder() / "seed.bag";
  RgbdFrame frame;
  frame.color = cv::Mat(6, 8, CV_8UC3, cv::Scalar(1, 2, 3));
  frame.depth = cv::Mat(6, 8, CV_16UC1, cv::Scalar(900));
  frame.color_camera = {8, 6, 9.0, 9.0, 3.5, 2.5};
  for (const FrameTopics& topics : {openniTopics(), challengeTopics()}) {
    BagWriter writer(file, topics);
    writer.write(frame, kStamp);
    writer.close();
    const std::string name = topics.depth.substr(topics.depth.rfind('/') + 1);
    writeRepacked(file, rosbag::compression::Uncompressed, name + "_plain");
    writeRepacked(file, rosbag::compression::LZ4, name + "_lz4");
    writeRepacked(file, rosbag::compression::BZ2, name + "_bz2");
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, size_t size) {
  using namespace recognition;
  const std::string file = inputFile("recording.bag", data, size);
  mayRefuse([&] {
    BagReader reader(file);
    RecordedFrame frame;
    for (bool more = true; more;)
      mayRefuse([&] {
        more = false;  // unless the next one is read, or is bad alone
        more = reader.next(&frame);
      });
  });
  mayRefuse([&] { ObjectTf::ofBag(file, "object").cameraFromObject("camera", kStamp); });
  return 0;
}
