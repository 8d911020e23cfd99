#include "evaluation/result_files.h"

#include <sstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "refusal.h"

namespace recognition {
namespace {

ResultRow sample() {
  ResultRow row;
  row.stamp = 1297.25;
  row.run = 1;
  row.frame = 7;
  row.object_id = 3;
  row.instance = 1;
  row.camera_from_object.linear() = Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  row.camera_from_object.translation() = Eigen::Vector3d(0.1, -0.2, 1.5);
  return row;
}

TEST(ResultFiles, ChallengeCsvRoundTrip) {
  std::stringstream file;
  writeChallengeCsv(file, {sample()});
  EXPECT_EQ(file.str().substr(0, file.str().find('\n')),
            "Ts,Run,Frame,dID,oID,R11,R12,R13,R21,R22,R23,R31,R32,R33,Tx,Ty,Tz");
  const auto rows = readChallengeCsv(file);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_DOUBLE_EQ(rows[0].stamp, 1297.25);
  EXPECT_EQ(rows[0].object_id, 3);
  EXPECT_EQ(rows[0].instance, 1);
  EXPECT_TRUE(rows[0].camera_from_object.isApprox(sample().camera_from_object, 1e-8));
}

TEST(ResultFiles, NamedCsvRoundTrip) {
  std::stringstream file;
  ResultRow row = sample();
  row.object = "003_cracker_box";
  writeNamedHeader(file);
  writeNamedRows(file, {row});
  writeNamedRows(file, {sample()});
  const auto rows = readChallengeCsv(file);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].object, "003_cracker_box");
  EXPECT_EQ(rows[1].object, "");
  EXPECT_EQ(rows[1].object_id, 3);
}

TEST(ResultFiles, ChallengeCsvErrorsNameTheLine) {
  for (const char* text :
       {"nonsense\n", "Ts,Run,Frame,dID,oID,R11,R12,R13,R21,R22,R23,R31,R32,R33,Tx,Ty,Tz\n1,2,3\n",
        "Ts,Run,Frame,dID,oID,R11,R12,R13,R21,R22,R23,R31,R32,R33,Tx,Ty,Tz\n1,2,3,x,0,0,0,0,0,0,0,0,0,0,0,0,0\n",
        "Ts,Run,Frame,dID,oID,R11,R12,R13,R21,R22,R23,R31,R32,R33,Tx,Ty,Tz\n1,2,3,7e99,0,0,0,0,0,0,0,0,0,0,0,0,0\n"}) {
    std::istringstream file(text);
    EXPECT_THAT(refusal<std::runtime_error>([&] { readChallengeCsv(file); }), testing::StartsWith("line ")) << text;
  }
}

TEST(ResultFiles, BopCsvIsInMillimetres) {
  std::ostringstream file;
  ResultRow row = sample();
  row.camera_from_object.linear().setIdentity();
  row.confidence = 0.5;
  row.seconds = 0.25;
  writeBopCsv(file, {row});
  EXPECT_EQ(file.str(), "scene_id,im_id,obj_id,score,R,t,time\n1,7,3,0.5,1 0 0 0 1 0 0 0 1,100 -200 1500,0.25\n");
}

}  // namespace
}  // namespace recognition
