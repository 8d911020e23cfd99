#include "rgbd_recognition/recognizer.h"

#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <opencv2/core/utility.hpp>

#include "rgbd_recognition/evaluation/bop_dataset.h"
#include "rgbd_recognition/model/model_store.h"

namespace recognition {
namespace {

/// A line of answers.csv: scene, frame, object, x, y, z (mm).
struct Answer {
  int scene, frame;
  std::string object;
  Eigen::Vector3d place;
};

std::vector<Answer> storedAnswers() {
  std::vector<Answer> answers;
  std::ifstream in(RGBD_TEST_DATA "/demo/answers.csv");
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream text(line);
    Answer answer;
    std::string field[6];
    for (std::string& one : field) std::getline(text, one, ',');
    answer = {std::stoi(field[0]), std::stoi(field[1]), field[2],
              1e-3 * Eigen::Vector3d(std::stod(field[3]), std::stod(field[4]), std::stod(field[5]))};
    answers.push_back(answer);
  }
  return answers;
}

class Recognition : public ::testing::Test {
 protected:
  Recognition() : database_(ModelStore(RGBD_STORE).loadAll().database) {}

  std::shared_ptr<const ModelDatabase> database_;
};

TEST_F(Recognition, FindsInTheDemosFramesWhatItFoundBefore) {
  const std::vector<Answer> stored = storedAnswers();
  ASSERT_FALSE(stored.empty());
  Recognizer recognizer(RecognizerParameters(), database_);
  size_t found = 0;
  for (const BopFrame& source : readBopSplit(RGBD_TEST_DATA "/demo/test_primesense")) {
    const RecognitionResult result = recognizer.recognize(loadBopFrame(source));
    EXPECT_TRUE(result.search.left_out.empty()) << "no limit is set";
    for (const VerifiedHypothesis& one : result.detections) {
      const std::string& name = database_->objects[static_cast<size_t>(one.hypothesis.object)]->name;
      const auto same = [&](const Answer& answer) {
        return answer.scene == source.scene && answer.frame == source.frame && answer.object == name &&
               (answer.place - one.camera_from_object.translation()).norm() < 0.003;
      };
      EXPECT_TRUE(std::any_of(stored.begin(), stored.end(), same))
          << source.name() << " " << name << " at " << 1e3 * one.camera_from_object.translation().transpose();
      ++found;
    }
  }
  EXPECT_EQ(found, stored.size());
}

TEST_F(Recognition, SameForAnyNumberOfThreadsAndForTheExhaustiveSearch) {
  const BopFrame source = readBopSplit(RGBD_TEST_DATA "/demo/test_primesense").front();
  const RgbdFrame frame = loadBopFrame(source);
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const RecognitionResult one = Recognizer(RecognizerParameters(), database_).recognize(frame);
  cv::setNumThreads(4);
  const RecognitionResult many = Recognizer(RecognizerParameters(), database_).recognize(frame);
  cv::setNumThreads(threads);
  ASSERT_EQ(one.hypotheses.size(), many.hypotheses.size());
  for (size_t i = 0; i < one.hypotheses.size(); ++i) {
    EXPECT_EQ(one.hypotheses[i].rejection, many.hypotheses[i].rejection);
    EXPECT_EQ(one.hypotheses[i].confidence, many.hypotheses[i].confidence);
  }
  RecognizerParameters exhaustive;
  exhaustive.reprojection_verification.exhaustive = true;
  const RecognitionResult all = Recognizer(exhaustive, database_).recognize(frame);
  ASSERT_EQ(all.detections.size(), one.detections.size());
  for (size_t i = 0; i < all.detections.size(); ++i)
    EXPECT_EQ(all.detections[i].hypothesis.object, one.detections[i].hypothesis.object);
}

}  // namespace
}  // namespace recognition
