// The training nodelet beside the running pipeline: from a turntable recording to the object found in real frames; what
// it refuses, and that the store stays as it was.
#include <gmock/gmock.h>
#include <std_srvs/Trigger.h>
#include <sys/resource.h>

#include <atomic>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>

#include "nodelets/box_recording.h"
#include "nodelets/pipeline_fixture.h"
#include "rgbd_recognition/model/model_store.h"
#include "ros/training_messages.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using Request = messages::TrainObjectRequest;

class TrainingTest : public PipelineTest {
 protected:
  void SetUp() override {
    folder_ = emptyFolder();
    store_ = folder_ + "/store";
    setParam("training/models", store_);
    setParam("training/boards", kBoards);
    setParam("training/folder", folder_);
    setParam("training/parameters/meshes/views", 4);
    setParam("training/parameters/meshes/distances", 1);
    ASSERT_TRUE(load("training"));
    request_.name = "box";
    request_.source = Request::BAG;
  }

  messages::TrainObjectResponse train(const Request& request) {
    messages::TrainObject call;
    call.request = request;
    EXPECT_TRUE(ros::service::call(ns_ + "/training/train_object", call));
    return call.response;
  }

  /// Why a request was refused; the store must stay empty.
  std::string refusal(const Request& request) {
    const auto response = train(request);
    EXPECT_FALSE(response.success);
    EXPECT_TRUE(ModelStore(store_).names().empty());
    return response.message;
  }
  std::string refusalOf(const std::vector<RgbdFrame>& frames) {
    request_.file = writeBag(folder_ + "/views.bag", frames);
    return refusal(request_);
  }

  /// Publishes the recording and its poses over and over until told to stop.
  std::thread playLive(std::atomic<bool>& stop) {
    return std::thread([this, &stop] {
      double time = 1000.0;
      for (size_t i = 0; !stop; i = (i + 1) % recording().size()) {
        std_msgs::Header header;
        header.stamp = ros::Time(time += 0.1);
        header.frame_id = "camera";
        tf_.publish(transformOf(poses()[i], header));
        const RgbdFrame& frame = recording()[i];
        const auto color = imageMessage(frame.color, header);
        if (frame.color_order == ColorOrder::kRgb) color->encoding = "rgb8";
        publish({color, imageMessage(frame.depth, header),
                 boost::make_shared<sensor_msgs::CameraInfo>(cameraInfo(frame.color_camera, header))});
        std::this_thread::sleep_for(std::chrono::milliseconds(30));
      }
    });
  }

  std::string folder_, store_;
  Request request_;
  ros::Publisher tf_ = node_.advertise<tf2_msgs::TFMessage>("/tf", 100);
};

bool finds(const messages::DetectionArrayConstPtr& detections, const std::string& object) {
  if (detections)
    for (const auto& detection : detections->detections)
      if (detection.object == object) return true;
  return false;
}

TEST_F(TrainingTest, AnObjectTrainedOnTheTurntableIsFoundInTheRunningPipeline) {
  for (const char* name : {"segmentation", "feature_extraction", "hypothesis_generation", "reprojection_verification"})
    setParam(std::string(name) + "/models", store_);
  loadPipeline();
  waitForCamera();
  const FrameMessages frame = demoFrames().front();
  EXPECT_FALSE(finds(detect(frame), "cracker_box"));

  const Recorder<messages::TrainingProgress> progress(node_, "training/progress");
  request_.name = "cracker_box";
  request_.file = writeBag(folder_ + "/turntable.bag", recording());
  const auto response = train(request_);
  ASSERT_TRUE(response.success) << response.message;
  EXPECT_EQ(response.views_used, recording().size());
  EXPECT_EQ(response.views_refused, 0u);
  EXPECT_GT(response.points, 2000u);
  EXPECT_GT(response.features.front(), 500u);
  EXPECT_GT(response.coverage, 0.5);
  EXPECT_LT(response.board_error, 1.0);
  EXPECT_NEAR(response.sigma[1], ModelStore(trainedStore()).load(kFirstObject).extents.sigma_max, 0.015);
  EXPECT_GT(progress.count(), recording().size());

  double time = 5000.0;
  EXPECT_TRUE(waitFor([&] { return finds(detect(withStamp(frame, ros::Time(time += 1.0))), "cracker_box"); }, 30.0));

  messages::RenameObject rename;
  rename.request.name = "cracker_box";
  rename.request.new_name = "crackers";
  ASSERT_TRUE(ros::service::call(ns_ + "/training/rename_object", rename));
  EXPECT_TRUE(rename.response.success) << rename.response.message;
  EXPECT_TRUE(waitFor([&] { return finds(detect(withStamp(frame, ros::Time(time += 1.0))), "crackers"); }, 30.0));
  messages::RemoveObject remove;
  remove.request.name = "crackers";
  ASSERT_TRUE(ros::service::call(ns_ + "/training/remove_object", remove));
  EXPECT_TRUE(remove.response.success) << remove.response.message;
  EXPECT_TRUE(waitFor([&] { return !finds(detect(withStamp(frame, ros::Time(time += 1.0))), "crackers"); }, 30.0));
}

TEST_F(TrainingTest, LiveViewsMakeAModelAndAreShown) {
  const Recorder<sensor_msgs::Image> view(node_, "training/view"), coverage(node_, "training/coverage");
  const Recorder<sensor_msgs::PointCloud2> cloud(node_, "training/cloud");
  ASSERT_TRUE(waitFor([&] { return color_.getNumSubscribers() == 1; }));  // somebody looks
  std::atomic<bool> stop{false};
  std::thread camera = playLive(stop);
  EXPECT_TRUE(waitFor([&] { return view.count() > 0; })) << "the view is shown before a training too";
  request_.source = Request::LIVE;
  request_.views = 6;
  request_.seconds = 60.0;
  request_.challenge_id = 5;
  const auto response = train(request_);
  stop = true;
  camera.join();
  ASSERT_TRUE(response.success) << response.message;
  EXPECT_EQ(response.views_used, 6u);
  EXPECT_GT(coverage.count(), 0u);
  EXPECT_GT(cloud.count(), 1u);

  messages::ListObjects list;
  ASSERT_TRUE(ros::service::call(ns_ + "/training/list_objects", list));
  ASSERT_EQ(list.response.objects.size(), 1u);
  EXPECT_EQ(list.response.objects[0].name, "box");
  EXPECT_EQ(list.response.objects[0].challenge_id, 5);
  EXPECT_EQ(list.response.objects[0].points, response.points);
  messages::GetObject get;
  get.request.name = "box";
  ASSERT_TRUE(ros::service::call(ns_ + "/training/get_object", get));
  EXPECT_EQ(get.response.cloud.width, response.points);
  EXPECT_NEAR(get.response.summary.sigma[1], response.sigma[1], 1e-6);

  request_.source = Request::BAG;
  request_.file = writeBag(folder_ + "/more.bag", {recording().begin() + 20, recording().end()});
  EXPECT_THAT(train(request_).message, HasSubstr("overwrite or extend"));
  request_.existing = Request::EXTEND;
  const auto extended = train(request_);
  EXPECT_TRUE(extended.success) << extended.message;
  EXPECT_GT(extended.points, response.points);
}

TEST_F(TrainingTest, TfTellsThePosesOfABagWithoutABoard) {
  request_.file = writeBag(folder_ + "/no_tf.bag", {recording()[0]});
  request_.object_frame = "stand";
  EXPECT_THAT(refusal(request_), AllOf(HasSubstr("no_tf.bag"), HasSubstr("no tf")));
  request_.file = writeBagWithTf(folder_ + "/tf.bag");
  request_.object_frame = "teapot";
  EXPECT_THAT(refusal(request_), AllOf(HasSubstr("'teapot'"), HasSubstr("stand")));
  request_.object_frame = "stand";
  request_.board = "charuco";
  EXPECT_THAT(refusal(request_), AllOf(HasSubstr("charuco"), HasSubstr("stand")));
  request_.board = "";
  request_.stands_at[1] = std::nan("");
  EXPECT_THAT(refusal(request_), HasSubstr("stands_at"));
  request_.stands_at[1] = 0.0;
  request_.stands_at[2] = 0.5;  // in the air
  EXPECT_THAT(refusal(request_), HasSubstr("nothing stands"));

  request_.stands_at[2] = 0.0;
  const auto response = train(request_);
  ASSERT_TRUE(response.success) << response.message;
  EXPECT_EQ(response.views_used, recording().size());
  EXPECT_EQ(response.board_error, 0.0);
  EXPECT_LT(response.residual, 0.002);
  EXPECT_NEAR(response.sigma[1], ModelStore(trainedStore()).load(kFirstObject).extents.sigma_max, 0.015);
}

TEST_F(TrainingTest, TfTellsThePosesOfLiveViews) {
  std::atomic<bool> stop{false};
  std::thread camera = playLive(stop);
  request_.source = Request::LIVE;
  request_.object_frame = "teapot";
  request_.seconds = 3.0;
  EXPECT_THAT(refusal(request_), AllOf(HasSubstr("'teapot'"), HasSubstr("'camera'")));
  request_.object_frame = "stand";
  request_.views = 6;
  request_.seconds = 60.0;
  const auto response = train(request_);
  stop = true;
  camera.join();
  ASSERT_TRUE(response.success) << response.message;
  EXPECT_EQ(response.views_used, 6u);
  EXPECT_EQ(response.board_error, 0.0);
  EXPECT_GT(response.points, 1000u);
}

TEST_F(TrainingTest, RefusesNamesThatAreNone) {
  request_.file = writeBag(folder_ + "/views.bag", {recording()[0]});
  for (const std::string& name : {std::string(), std::string("a/b"), std::string(".."), std::string("../store2/box"),
                                  std::string("/tmp/box"), std::string(10000, 'x'), std::string("a b")}) {
    request_.name = name;
    EXPECT_THAT(refusal(request_), HasSubstr("name")) << name.substr(0, 20);
    messages::RemoveObject remove;
    remove.request.name = name;
    EXPECT_TRUE(ros::service::call(ns_ + "/training/remove_object", remove));
    EXPECT_FALSE(remove.response.success) << name.substr(0, 20);
    messages::RenameObject rename;
    rename.request.name = "box";
    rename.request.new_name = name;
    EXPECT_TRUE(ros::service::call(ns_ + "/training/rename_object", rename));
    EXPECT_FALSE(rename.response.success) << name.substr(0, 20);
    messages::GetObject get;
    get.request.name = name;
    EXPECT_TRUE(ros::service::call(ns_ + "/training/get_object", get));
    EXPECT_FALSE(get.response.success) << name.substr(0, 20);
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ + "/store2"));
}

TEST_F(TrainingTest, SaysWhatIsWrongWithARequest) {
  const std::string bag = writeBag(folder_ + "/views.bag", {recording()[0]});
  EXPECT_THAT(refusal(request_), HasSubstr("file"));
  request_.file = "/nowhere.bag";
  EXPECT_THAT(refusal(request_), HasSubstr("/nowhere.bag"));
  request_.file = RGBD_TEST_DATA "/demo/models/models_info.json";
  EXPECT_THAT(refusal(request_), HasSubstr("models_info.json"));
  request_.file = bag;
  request_.board = "no_such_board";
  EXPECT_THAT(refusal(request_), HasSubstr("no_such_board"));
  request_.board = "/no/board.yaml";
  EXPECT_THAT(refusal(request_), HasSubstr("/no/board.yaml"));
  request_.board = "";
  request_.source = 9;
  EXPECT_THAT(refusal(request_), HasSubstr("source is 9"));
  request_.source = Request::BAG;
  request_.existing = 7;
  EXPECT_THAT(refusal(request_), HasSubstr("existing is 7"));
  request_.existing = Request::EXTEND;
  EXPECT_THAT(refusal(request_), HasSubstr("no such model"));
  request_.existing = Request::KEEP;
  request_.source = Request::MESH;
  request_.file = "/nowhere.ply";
  EXPECT_THAT(refusal(request_), HasSubstr("/nowhere.ply"));
  request_.source = Request::LIVE;
  request_.seconds = -1.0;
  EXPECT_THAT(refusal(request_), HasSubstr("seconds"));
  request_.seconds = 1.0;
  EXPECT_THAT(refusal(request_), HasSubstr("no frame"));
}

TEST_F(TrainingTest, RelativePathsAreBelowItsFolderAndToldInFull) {
  request_.file = "missing.bag";
  EXPECT_THAT(refusal(request_), HasSubstr(folder_ + "/missing.bag"));
  request_.source = Request::MESH;
  request_.file = "meshes/../missing.ply";
  EXPECT_THAT(refusal(request_), HasSubstr(folder_ + "/missing.ply"));
}

TEST_F(TrainingTest, AsksAboutAnUnlikelyUnitOfAMeshAsTheToolDoes) {
  request_.source = Request::MESH;
  request_.file = folder_ + "/large.obj";
  std::ofstream(request_.file) << "v 0 0 0 1 0 0\nv 3 0 0 0 1 0\nv 0 3 0 0 0 1\nf 1 2 3\n";
  EXPECT_THAT(refusal(request_), HasSubstr("is 3 m long if its unit is 1 m; is that right?"));
}

TEST_F(TrainingTest, SaysWhatIsWrongWithARecording) {
  std::vector<RgbdFrame> frames(recording().begin(), recording().begin() + 4);
  for (RgbdFrame& frame : frames) frame.color = cv::Mat(frame.color.size(), CV_8UC3, cv::Scalar(90, 90, 90));
  EXPECT_THAT(refusalOf(frames), HasSubstr("board is not seen"));

  const std::string file = folder_ + "/no_info.bag";
  rosbag::Bag bag(file, rosbag::bagmode::Write);
  std_msgs::Header header;
  header.stamp = ros::Time(1.0);
  bag.write("/camera/rgb/image_rect_color", header.stamp, *imageMessage(recording()[0].color, header));
  bag.write("/camera/depth_registered/image_raw", header.stamp, *imageMessage(recording()[0].depth, header));
  bag.close();
  request_.file = file;
  EXPECT_THAT(refusal(request_), HasSubstr("camera info"));
}

TEST_F(TrainingTest, OneTrainingAtATimeThatCanBeCancelled) {
  messages::TrainObjectResponse first;
  Request live = request_;
  live.source = Request::LIVE;
  std::thread training([&] { first = train(live); });
  const Recorder<messages::TrainingProgress> progress(node_, "training/progress");
  ASSERT_TRUE(waitFor([&] { return progress.count() > 0; }));
  request_.file = "/nowhere.bag";
  EXPECT_THAT(train(request_).message, HasSubstr("another training"));
  std_srvs::Trigger cancel;
  EXPECT_TRUE(ros::service::call(ns_ + "/training/cancel", cancel));
  EXPECT_TRUE(cancel.response.success);
  training.join();
  EXPECT_FALSE(first.success);
  EXPECT_EQ(first.message, "cancelled");
  EXPECT_TRUE(ros::service::call(ns_ + "/training/cancel", cancel));
  EXPECT_FALSE(cancel.response.success) << "nothing to cancel";
  EXPECT_TRUE(ModelStore(store_).names().empty());
}

TEST_F(TrainingTest, AFullDiskOrAnotherWriterLeavesTheStoreAsItWas) {
  request_.source = Request::MESH;
  request_.file = RGBD_TEST_DATA "/demo/models/obj_000003.ply";
  request_.unit = 0.001;
  {
    const ModelStore other(store_);
    const auto lock = other.lock();
    EXPECT_THAT(refusal(request_), HasSubstr("another program"));
  }
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit previous{};
  getrlimit(RLIMIT_FSIZE, &previous);
  const rlimit small{4096, previous.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  const std::string reason = refusal(request_);
  setrlimit(RLIMIT_FSIZE, &previous);
  EXPECT_THAT(reason, HasSubstr("too large"));
  const auto trained = train(request_);
  EXPECT_TRUE(trained.success);
  EXPECT_THAT(trained.message, HasSubstr("self-test (rendered"));
}

TEST_F(PipelineTest, TrainingRefusesWrongParameters) {
  setParam("training/models", emptyFolder());
  setParam("training/parameters/recording/view_angle", 400.0);
  EXPECT_FALSE(load("training"));
}

}  // namespace
}  // namespace recognition

int main(int argc, char** argv) {
  ::testing::InitGoogleMock(&argc, argv);
  ros::init(argc, argv, "training_test");
  const ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
