#pragma once

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "rgbd_recognition/features/feature_types.h"
#include "rgbd_recognition/model/object_model.h"

namespace recognition::benchmarks {

/// The search for the `k` nearest model descriptors of each query (CV_32FC1), by one thread: that of the package and
/// hnswlib's at several settings, each with milliseconds and with the share of the exact answer that it finds.
nlohmann::json compareNeighbourSearch(const ModelDatabase& database, DescriptorType type, const cv::Mat& queries, int k,
                                      bool with_hnsw);

}  // namespace recognition::benchmarks
