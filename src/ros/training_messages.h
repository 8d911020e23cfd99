#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <string>
#include <vector>

#include "rgbd_recognition/training/object_trainer.h"

#include <rgbd_recognition/GetObject.h>
#include <rgbd_recognition/ListObjects.h>
#include <rgbd_recognition/RemoveObject.h>
#include <rgbd_recognition/RenameObject.h>
#include <rgbd_recognition/TrainObject.h>
#include <rgbd_recognition/TrainingProgress.h>

namespace recognition {
namespace messages = ::rgbd_recognition;

/// What was asked for. Throws std::invalid_argument naming field and value: a name that is none, an unknown source or
/// way with existing models, a file that is missing, numbers that are none.
TrainingTask taskFromMessage(const messages::TrainObjectRequest& request, const std::string& live_source);

/// As the tool takes a mesh: it asks about an implausible length if the unit is not given, and tests the new model.
MeshOptions meshOptionsOf(const messages::TrainObjectRequest& request);

void fillResponse(const TrainingOutcome& outcome, messages::TrainObjectResponse* response);

messages::ObjectSummary summaryOf(const ObjectModel& model);

/// Positions in metres with rgb, as rviz and PCL read it.
sensor_msgs::PointCloud2 cloudMessage(const std::vector<SurfacePoint>& cloud, const std_msgs::Header& header);

}  // namespace recognition
