#include <stdexcept>

#include <nlohmann/json.hpp>

#include "rgbd_recognition/evaluation/frame_record.h"

namespace recognition {
namespace {

using nlohmann::json;

json poseJson(const Pose& pose) {
  json numbers = json::array();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) numbers.push_back(pose.matrix()(i, j));
  return numbers;
}

Pose poseOf(const json& numbers) {
  Pose pose = Pose::Identity();
  for (int i = 0; i < 12; ++i) pose.matrix()(i / 4, i % 4) = numbers.at(static_cast<size_t>(i)).get<double>();
  return pose;
}

/// Lower triangle, row by row.
json covarianceJson(const Eigen::Matrix<double, 6, 6>& covariance) {
  json numbers = json::array();
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j <= i; ++j) numbers.push_back(covariance(i, j));
  return numbers;
}

Eigen::Matrix<double, 6, 6> covarianceOf(const json& numbers) {
  Eigen::Matrix<double, 6, 6> covariance;
  size_t k = 0;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j <= i; ++j, ++k) covariance(i, j) = covariance(j, i) = numbers.at(k).get<double>();
  return covariance;
}

json timesJson(const StageTimes& times) {
  return {{"segmentation", times.segmentation},
          {"feature_extraction", times.feature_extraction},
          {"hypothesis_generation", times.hypothesis_generation},
          {"reprojection_verification", times.reprojection_verification},
          {"total", times.total}};
}

StageTimes timesOf(const json& j) {
  StageTimes times;
  times.segmentation = j.at("segmentation").get<double>();
  times.feature_extraction = j.at("feature_extraction").get<double>();
  times.hypothesis_generation = j.at("hypothesis_generation").get<double>();
  times.reprojection_verification = j.at("reprojection_verification").get<double>();
  times.total = j.at("total").get<double>();
  return times;
}

json evidenceJson(const Evidence& e) {
  return {{"inliers", e.inliers},
          {"features", e.features},
          {"matched", e.matched},
          {"significance", e.significance},
          {"peak", e.peak},
          {"structure", e.structure},
          {"texture", e.texture},
          {"color_distance", e.color_distance},
          {"illumination_change", e.illumination_change},
          {"depth_fit", e.depth_fit},
          {"seen", e.seen},
          {"gain", e.gain},
          {"segment_share", e.segment_share}};
}

Evidence evidenceOf(const json& j) {
  Evidence e;
  e.inliers = j.at("inliers").get<int>();
  e.features = j.at("features").get<int>();
  e.matched = j.at("matched").get<int>();
  e.significance = j.at("significance").get<double>();
  e.peak = j.at("peak").get<double>();
  e.structure = j.at("structure").get<double>();
  e.texture = j.at("texture").get<double>();
  e.color_distance = j.at("color_distance").get<double>();
  e.illumination_change = j.at("illumination_change").get<double>();
  e.segment_share = j.at("segment_share").get<double>();
  e.depth_fit = j.at("depth_fit").get<double>();
  e.seen = j.at("seen").get<double>();
  e.gain = j.at("gain").get<double>();
  return e;
}

json hypothesisJson(const HypothesisRecord& h) {
  const ConsistencyScores& s = h.scores;
  json j = {{"object", h.object},
            {"object_id", h.object_id},
            {"pose", poseJson(h.camera_from_object)},
            {"s_d", s.s_d},
            {"s_c", s.s_c},
            {"s_o", s.s_o},
            {"total", s.total},
            {"projected", s.projected},
            {"visible", s.visible},
            {"free_space", s.free_space},
            {"best_segment", s.best_segment},
            {"confidence", h.confidence},
            {"consensus", h.consensus},
            {"source", h.source},
            {"level", h.level},
            {"round", h.round},
            {"rejection", h.rejection},
            {"conflict_with", h.conflict_with},
            {"evidence", evidenceJson(h.evidence)}};
  if (!h.covariance.isZero(0.0)) j["covariance"] = covarianceJson(h.covariance);
  return j;
}

HypothesisRecord hypothesisOf(const json& j) {
  HypothesisRecord h;
  h.object = j.at("object").get<std::string>();
  h.object_id = j.at("object_id").get<int>();
  h.camera_from_object = poseOf(j.at("pose"));
  if (j.contains("covariance")) h.covariance = covarianceOf(j.at("covariance"));
  h.scores.s_d = j.at("s_d").get<double>();
  h.scores.s_c = j.at("s_c").get<double>();
  h.scores.s_o = j.at("s_o").get<double>();
  h.scores.total = j.at("total").get<double>();
  h.scores.projected = j.at("projected").get<int>();
  h.scores.visible = j.at("visible").get<double>();
  h.scores.free_space = j.at("free_space").get<double>();
  h.scores.best_segment = j.at("best_segment").get<int>();
  h.evidence = evidenceOf(j.at("evidence"));
  h.confidence = j.at("confidence").get<double>();
  h.consensus = j.at("consensus").get<int>();
  h.source = j.at("source").get<std::string>();
  h.level = j.at("level").get<std::string>();
  h.round = j.at("round").get<int>();
  h.rejection = j.at("rejection").get<std::string>();
  h.conflict_with = j.at("conflict_with").get<std::string>();
  return h;
}

json truthJson(const TruthRecord& t) {
  json j = {{"object", t.object},
            {"object_id", t.object_id},
            {"pose", poseJson(t.camera_from_object)},
            {"visibility", t.visibility},
            {"cause", static_cast<int>(t.trace.cause)},
            {"visible_pixels", t.trace.visible_pixels},
            {"segmented", t.trace.segmented},
            {"features", t.trace.features},
            {"correct_correspondences", t.trace.correct_correspondences},
            {"best_consensus", t.trace.best_consensus},
            {"detail", t.trace.detail}};
  if (t.oracle) j["oracle"] = hypothesisJson(*t.oracle);
  return j;
}

TruthRecord truthOf(const json& j) {
  TruthRecord t;
  t.object = j.at("object").get<std::string>();
  t.object_id = j.at("object_id").get<int>();
  t.camera_from_object = poseOf(j.at("pose"));
  t.visibility = j.at("visibility").get<double>();
  const int cause = j.at("cause").get<int>();
  if (cause < 0 || cause >= kMissCauses) throw std::runtime_error("cause " + std::to_string(cause) + " is unknown");
  t.trace.cause = static_cast<MissCause>(cause);
  t.trace.visible_pixels = j.at("visible_pixels").get<int>();
  t.trace.segmented = j.at("segmented").get<double>();
  t.trace.features = j.at("features").get<int>();
  t.trace.correct_correspondences = j.at("correct_correspondences").get<int>();
  t.trace.best_consensus = j.at("best_consensus").get<int>();
  t.trace.detail = j.at("detail").get<std::string>();
  if (j.contains("oracle")) t.oracle = hypothesisOf(j.at("oracle"));
  return t;
}

}  // namespace

std::string toJsonLine(const FrameRecord& r) {
  json j = {{"scene", r.scene},
            {"frame", r.frame},
            {"seconds", timesJson(r.times)},
            {"cpu_seconds", timesJson(r.cpu_times)},
            {"rounds", r.rounds},
            {"features", r.features},
            {"left_out", r.left_out},
            {"truth", json::array()},
            {"detections", json::array()},
            {"hypotheses", json::array()}};
  for (const TruthRecord& t : r.truth) j["truth"].push_back(truthJson(t));
  for (const HypothesisRecord& h : r.detections) j["detections"].push_back(hypothesisJson(h));
  for (const HypothesisRecord& h : r.hypotheses) j["hypotheses"].push_back(hypothesisJson(h));
  return j.dump();
}

FrameRecord fromJsonLine(const std::string& line) {
  try {
    const json j = json::parse(line);
    FrameRecord r;
    r.scene = j.at("scene").get<int>();
    r.frame = j.at("frame").get<int>();
    r.times = timesOf(j.at("seconds"));
    r.cpu_times = timesOf(j.at("cpu_seconds"));
    r.left_out = j.at("left_out").get<std::vector<std::string>>();
    r.rounds = j.at("rounds").get<int>();
    r.features = j.at("features").get<int>();
    for (const json& t : j.at("truth")) r.truth.push_back(truthOf(t));
    for (const json& h : j.at("detections")) r.detections.push_back(hypothesisOf(h));
    for (const json& h : j.at("hypotheses")) r.hypotheses.push_back(hypothesisOf(h));
    return r;
  } catch (const json::exception& error) {
    throw std::runtime_error(std::string("frame record: ") + error.what());
  }
}

}  // namespace recognition
