#include "ros/training_messages.h"

#include <sensor_msgs/point_cloud2_iterator.h>

#include <cmath>
#include <map>
#include <stdexcept>

namespace recognition {
namespace {

constexpr double kLongest = 3600.0;  // of a live training, seconds

ExistingModel existingFrom(std::uint8_t value) {
  switch (value) {
    case messages::TrainObjectRequest::KEEP:
      return ExistingModel::kKeep;
    case messages::TrainObjectRequest::OVERWRITE:
      return ExistingModel::kReplace;
    case messages::TrainObjectRequest::EXTEND:
      return ExistingModel::kExtend;
    case messages::TrainObjectRequest::EXTEND_TURNED_OVER:
      return ExistingModel::kExtendTurnedOver;
    default:
      throw std::invalid_argument("existing is " + std::to_string(value) +
                                  ": must be 0 (keep), 1 (overwrite), 2 (extend) or 3 (extend, turned over)");
  }
}

// What a recording's poses are from, beside its board; the model's frame.
void addPoses(const messages::TrainObjectRequest& request, TrainingTask* task) {
  if (request.object_frame.empty()) return;
  if (request.source == messages::TrainObjectRequest::MESH)
    throw std::invalid_argument("object_frame is '" + request.object_frame + "', but a mesh needs none");
  if (!request.board.empty())
    throw std::invalid_argument("board is '" + request.board + "' and object_frame is '" + request.object_frame +
                                "': one of them tells the poses");
  const Eigen::Vector3d stands_at(request.stands_at[0], request.stands_at[1], request.stands_at[2]);
  if (!stands_at.allFinite()) throw std::invalid_argument("stands_at holds a value that is no number");
  task->source += ", poses of tf frame " + request.object_frame;
  task->world_from_object = Eigen::Translation3d(-stands_at);
}

// "view 12: the board is not seen" and its like, counted by reason.
std::vector<std::string> countReasons(const std::vector<std::string>& refused) {
  std::map<std::string, int> counts;
  for (const std::string& line : refused) ++counts[line.substr(line.find(": ") + 2)];
  std::vector<std::string> lines;
  for (const auto& [reason, count] : counts) lines.push_back(std::to_string(count) + " views: " + reason);
  return lines;
}

}  // namespace

TrainingTask taskFromMessage(const messages::TrainObjectRequest& request, const std::string& live_source) {
  requireObjectName(request.name);
  if (request.source > messages::TrainObjectRequest::MESH)
    throw std::invalid_argument("source is " + std::to_string(request.source) +
                                ": must be 0 (live), 1 (bag) or 2 (mesh)");
  const bool live = request.source == messages::TrainObjectRequest::LIVE;
  if (!live && request.file.empty()) throw std::invalid_argument("file is empty: it names the bag or mesh");
  if (!std::isfinite(request.unit) || request.unit < 0.0)
    throw std::invalid_argument("unit is " + std::to_string(request.unit) + ": must be metres, or 0 for 1");
  if (!(request.seconds >= 0.0 && request.seconds <= kLongest))
    throw std::invalid_argument("seconds is " + std::to_string(request.seconds) + ": must be in [0, 3600]");
  TrainingTask task{request.name, request.challenge_id == 0 ? -1 : request.challenge_id,
                    live ? live_source : request.file, existingFrom(request.existing), std::nullopt};
  addPoses(request, &task);
  return task;
}

MeshOptions meshOptionsOf(const messages::TrainObjectRequest& request) {
  MeshOptions options;
  options.unit_is_sure = request.unit > 0.0;
  options.self_test = true;
  return options;
}

void fillResponse(const TrainingOutcome& outcome, messages::TrainObjectResponse* response) {
  const messages::ObjectSummary summary = summaryOf(outcome.model);
  const TrainingReport& report = outcome.report;
  response->success = 1;
  response->message = (outcome.unchanged ? "trained already: " : "") + describe(outcome.model);
  if (outcome.self_test) response->message += "; " + describe(*outcome.self_test);
  response->views_used = static_cast<std::uint32_t>(report.views_used);
  response->views_refused = static_cast<std::uint32_t>(report.refused.size());
  response->refused = countReasons(report.refused);
  response->points = summary.points;
  response->descriptors = summary.descriptors;
  response->features = summary.features;
  response->sigma = summary.sigma;
  response->coverage = report.coverage;
  response->board_error = report.board_rms;
  response->residual = report.residual;
  response->warnings = report.warnings;
  response->seconds = outcome.seconds;
}

messages::ObjectSummary summaryOf(const ObjectModel& model) {
  messages::ObjectSummary summary;
  summary.name = model.name;
  summary.challenge_id = model.challenge_id;
  summary.source = model.source;
  summary.points = static_cast<std::uint32_t>(model.cloud.size());
  for (const auto& [type, features] : model.features) {
    summary.descriptors.emplace_back(descriptorName(type));
    summary.features.push_back(static_cast<std::uint32_t>(features.count()));
  }
  summary.sigma = {model.extents.sigma_min, model.extents.sigma_max, model.extents.sigma_d};
  return summary;
}

sensor_msgs::PointCloud2 cloudMessage(const std::vector<SurfacePoint>& cloud, const std_msgs::Header& header) {
  sensor_msgs::PointCloud2 message;
  message.header = header;
  message.is_dense = true;
  sensor_msgs::PointCloud2Modifier modifier(message);
  modifier.setPointCloud2FieldsByString(2, "xyz", "rgb");
  modifier.resize(cloud.size());
  if (cloud.empty()) return message;  // an iterator takes the address of the first byte
  sensor_msgs::PointCloud2Iterator<float> xyz(message, "x");
  sensor_msgs::PointCloud2Iterator<std::uint8_t> bgr(message, "rgb");
  for (const SurfacePoint& point : cloud) {
    for (int c = 0; c < 3; ++c) {
      xyz[c] = point.position[c];
      bgr[c] = point.rgb[2 - c];
    }
    ++xyz, ++bgr;
  }
  return message;
}

}  // namespace recognition
