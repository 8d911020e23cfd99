#include "benchmarks/pcl_segmentation.h"

#include <limits>
#include <vector>

#include <pcl/features/integral_image_normal.h>
#include <pcl/point_types.h>
#include <pcl/segmentation/euclidean_cluster_comparator.h>
#include <pcl/segmentation/organized_connected_component_segmentation.h>
#include <pcl/segmentation/organized_multi_plane_segmentation.h>

#include "rgbd_recognition/segmentation/segmentation.h"

namespace recognition {
namespace {

using Point = pcl::PointXYZ;

constexpr float kDepthChange = 0.01f;
constexpr float kNormalSmoothing = 10.0f;  // pixels
constexpr unsigned kMinPlane = 500;        // pixels
constexpr size_t kMaxPlane = 20000;        // pixels
constexpr size_t kMinCluster = 200;        // pixels
constexpr double kPlaneAngle = 4.0 * M_PI / 180.0;
constexpr double kPlaneDistance = 0.02;    // metres
constexpr float kClusterDistance = 0.01f;  // metres

}  // namespace

class PclSegmentation::Impl {
 public:
  explicit Impl(const DepthFrame& frame) : cloud_(new pcl::PointCloud<Point>(frame.depth.cols, frame.depth.rows)) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    cloud_->is_dense = false;
    for (int v = 0; v < frame.depth.rows; ++v) {
      for (int u = 0; u < frame.depth.cols; ++u) {
        const float z = frame.depth.at<float>(v, u);
        const Eigen::Vector3f p = frame.camera.unproject(u, v, z).cast<float>();
        cloud_->at(u, v) = z > 0.0f ? Point(p.x(), p.y(), p.z()) : Point(nan, nan, nan);
      }
    }
  }

  cv::Mat segment() const {
    const pcl::PointCloud<pcl::Normal>::Ptr normals = estimateNormals();
    const std::vector<pcl::PointIndices> planes = findPlanes(normals);
    cv::Mat image(static_cast<int>(cloud_->height), static_cast<int>(cloud_->width), CV_32SC1, cv::Scalar(kUnlabelled));
    int next = 1;
    for (const pcl::PointIndices& plane : planes) {
      const int label = plane.indices.size() > kMaxPlane ? kLargePlane : next++;
      for (const auto index : plane.indices) image.at<int>(static_cast<int>(index)) = label;
    }
    for (const pcl::PointIndices& cluster : findClusters(planes)) {
      if (cluster.indices.size() < kMinCluster) continue;
      for (const auto index : cluster.indices)
        if (image.at<int>(static_cast<int>(index)) == kUnlabelled) image.at<int>(static_cast<int>(index)) = next;
      ++next;
    }
    return image;
  }

 private:
  pcl::PointCloud<pcl::Normal>::Ptr estimateNormals() const {
    const pcl::PointCloud<pcl::Normal>::Ptr normals(new pcl::PointCloud<pcl::Normal>);
    pcl::IntegralImageNormalEstimation<Point, pcl::Normal> estimation;
    estimation.setNormalEstimationMethod(estimation.AVERAGE_3D_GRADIENT);
    estimation.setMaxDepthChangeFactor(kDepthChange);
    estimation.setNormalSmoothingSize(kNormalSmoothing);
    estimation.setInputCloud(cloud_);
    estimation.compute(*normals);
    return normals;
  }

  std::vector<pcl::PointIndices> findPlanes(const pcl::PointCloud<pcl::Normal>::Ptr& normals) const {
    pcl::OrganizedMultiPlaneSegmentation<Point, pcl::Normal, pcl::Label> segmentation;
    segmentation.setMinInliers(kMinPlane);
    segmentation.setAngularThreshold(kPlaneAngle);
    segmentation.setDistanceThreshold(kPlaneDistance);
    segmentation.setInputNormals(normals);
    segmentation.setInputCloud(cloud_);
    std::vector<pcl::PlanarRegion<Point>, Eigen::aligned_allocator<pcl::PlanarRegion<Point>>> regions;
    std::vector<pcl::ModelCoefficients> coefficients;
    std::vector<pcl::PointIndices> planes, all_labels, boundaries;
    pcl::PointCloud<pcl::Label>::Ptr labels(new pcl::PointCloud<pcl::Label>);
    segmentation.segmentAndRefine(regions, coefficients, planes, labels, all_labels, boundaries);
    return planes;
  }

  /// Euclidean components of what is on no plane. Points on planes are taken out of the cloud, since the meaning of the
  /// comparator's set of labels differs from version to version.
  std::vector<pcl::PointIndices> findClusters(const std::vector<pcl::PointIndices>& planes) const {
    const pcl::PointCloud<Point>::Ptr rest(new pcl::PointCloud<Point>(*cloud_));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const pcl::PointIndices& plane : planes)
      for (const auto index : plane.indices) (*rest)[static_cast<size_t>(index)] = Point(nan, nan, nan);
    const pcl::EuclideanClusterComparator<Point, pcl::Label>::Ptr comparator(
        new pcl::EuclideanClusterComparator<Point, pcl::Label>);
    comparator->setInputCloud(rest);
    comparator->setDistanceThreshold(kClusterDistance, false);
    pcl::OrganizedConnectedComponentSegmentation<Point, pcl::Label> components(comparator);
    components.setInputCloud(rest);
    pcl::PointCloud<pcl::Label> cluster_labels;
    std::vector<pcl::PointIndices> clusters;
    components.segment(cluster_labels, clusters);
    return clusters;
  }

  const pcl::PointCloud<Point>::Ptr cloud_;
};

PclSegmentation::PclSegmentation(const DepthFrame& frame) : impl_(std::make_unique<Impl>(frame)) {}
PclSegmentation::~PclSegmentation() = default;
cv::Mat PclSegmentation::segment() const { return impl_->segment(); }

}  // namespace recognition
