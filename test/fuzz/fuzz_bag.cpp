#include "fuzz/fuzz.h"
#include "rgbd_recognition/ros/bag_reader.h"
#include "rgbd_recognition/ros/bag_writer.h"

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  using namespace rgbd_recognition;
  const std::string file = fuzzFolder() / "seed.bag";
  RgbdFrame frame;
  frame.color = cv::Mat(6, 8, CV_8UC3, cv::Scalar(1, 2, 3));
  frame.depth = cv::Mat(6, 8, CV_16UC1, cv::Scalar(900));
  frame.color_camera = {8, 6, 9.0, 9.0, 3.5, 2.5};
  for (const FrameTopics& topics : {openniTopics(), challengeTopics()}) {
    BagWriter writer(file, topics);
    writer.write(frame, 1000000000);
    writer.close();
    writeSeed(topics.depth.substr(topics.depth.rfind('/') + 1), readText(file));
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, size_t size) {
  using namespace rgbd_recognition;
  const std::string file = inputFile("recording.bag", data, size);
  mayRefuse([&] {
    BagReader reader(file);
    RecordedFrame frame;
    for (bool more = true; more;) mayRefuse([&] {
        more = false;  // unless the next one is read, or is bad alone
        more = reader.next(&frame);
      });
  });
  return 0;
}
