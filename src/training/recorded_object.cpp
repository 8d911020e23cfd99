#include "rgbd_recognition/training/recorded_object.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "core/angles.h"
#include "training/cloud_colors.h"
#include "training/cloud_fusion.h"
#include "training/object_hull.h"
#include "training/object_region.h"
#include "training/object_view.h"
#include "training/recorded_features.h"
#include "training/training_quality.h"
#include "training/view_overlap.h"

namespace recognition {
namespace {

constexpr double kMaxSpread = 0.006;    // of the board's distance by depth over that by its pose
constexpr double kMaxResidual = 0.006;  // metres
constexpr double kMaxCarved = 0.04;
constexpr int kBoardStride = 8;       // depth pixels
constexpr float kBoardReach = 0.15f;  // metres from the object's middle where the board is
constexpr double kBoardNoise = 2.0;   // in plane margins, the greatest height that noise gives the board
constexpr int kAlignmentStride = 3;   // depth pixels between the points that align a view
constexpr int kRoughStride = 2;       // of roughCloud()
constexpr size_t kMinPoints = 50;     // of a cloud

double medianOf(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// How much farther depth sees the board's points than their pose puts them: the median over the points is the board's
// size by depth over its size by description; where depth is registered to colour, it is the same all over the board.
void compareWithDepth(const BoardObservation& board, ObjectView& view) {
  std::vector<double> ratios;
  for (size_t i = 0; i < board.points.size(); ++i) {
    const cv::Point pixel(cvRound(board.pixels[i].x() / view.color_per_depth),
                          cvRound(board.pixels[i].y() / view.color_per_depth));
    if (!cv::Rect({}, view.depth.size()).contains(pixel)) continue;
    const float depth = view.depth.at<float>(pixel);
    if (depth > 0.0f) ratios.push_back(depth / (board.camera_from_board * board.points[i]).z());
  }
  if (ratios.empty()) return;
  view.board_scale = medianOf(ratios);
  for (double& ratio : ratios) ratio = std::abs(ratio / view.board_scale - 1.0);
  view.board_spread = medianOf(ratios);
}

// Where depth sees the board, near which z is 0: as much too high or low as what stands on it.
float boardHeight(const std::vector<ObjectView>& views) {
  std::vector<double> heights;
  for (const ObjectView& view : views)
    for (int v = 0; v < view.depth.rows; v += kBoardStride)
      for (int u = 0; u < view.depth.cols; u += kBoardStride) {
        if (view.mask.at<uchar>(v, u) > 0 || !(view.depth.at<float>(v, u) > 0.0f)) continue;
        const Eigen::Vector3f p = view.worldPoint(u, v);
        if (p.head<2>().norm() < kBoardReach && std::abs(p.z()) < kBoardReach / 10.0f)
          heights.push_back(static_cast<double>(p.z()));
      }
  return heights.empty() ? 0.0f : static_cast<float>(medianOf(heights));
}

Eigen::Vector3f directionOf(const ObjectView& view) { return view.cameraPlace().normalized(); }

}  // namespace

ParameterList RecordingParameters::list() {
  ParameterList list = {
      doubleParameter("view_angle", "deg", &view_angle, 0.0, 90.0, "least angle between two views that are used"),
      intParameter("max_views", "", &max_views, 1, 1000, "views used"),
      doubleParameter("plane_margin", "m", &plane_margin, 0.001, 0.05,
                      "what is lower above the board belongs to the board"),
      doubleParameter("max_radius", "m", &max_radius, 0.02, 2.0,
                      "of the region around the board's middle in which the object stands"),
      doubleParameter("max_height", "m", &max_height, 0.02, 2.0, "of that region"),
      intParameter("alignment_rounds", "", &alignment_rounds, 0, 50,
                   "of the views' poses with the cloud that all of them make"),
      doubleParameter("alignment_distance", "m", &alignment_distance, 0.002, 0.05, "farthest pairing in the alignment"),
      doubleParameter("pose_sigma", "m", &pose_sigma, 0.0001, 0.1, "how far a first pose is trusted"),
      doubleParameter("point_spacing", "m", &point_spacing, 0.0005, 0.05, "of the cloud P"),
      intParameter("min_views", "", &min_views, 1, 100, "that must agree on a point of the cloud, where so many look"),
      doubleParameter("scale_tolerance", "", &scale_tolerance, 0.001, 1.0,
                      "largest deviation of the board's size by depth from its description"),
      doubleParameter("feature_distance", "m", &feature_distance, 0.001, 0.05,
                      "farthest place of a feature from the cloud"),
      doubleParameter("far_distance", "m", &far_distance, 0.1, 10.0,
                      "farthest at which features are learnt, from shrunk images"),
      intParameter("distances", "", &distances, 1, 8,
                   "at which they are learnt, in geometric steps from the camera's own to the farthest")};
  const ParameterList merge = merging.list();
  list.insert(list.end(), merge.begin(), merge.end());
  return list;
}

void RecordingParameters::validate() const { validateParameters(RecordingParameters(*this).list(), "recording"); }

class RecordedObject::Impl {
 public:
  Impl(const RecordingParameters& parameters, const FeatureParameters& features, std::optional<FiducialBoard> board,
       const std::optional<Pose>& world_from_object)
      : parameters_(parameters), features_(features), board_(std::move(board)), world_from_object_(world_from_object) {
    parameters_.validate();
    features_.validate();
  }

  std::string add(const RecordedView& recorded) {
    ++seen_;
    last_pose_.reset();
    const std::string reason = tryToAdd(recorded);
    if (!reason.empty()) refused_.push_back("view " + std::to_string(seen_) + ": " + reason);
    return reason;
  }

  void refuse(const std::string& reason) {
    ++seen_;
    last_pose_.reset();
    refused_.push_back("view " + std::to_string(seen_) + ": " + reason);
  }

  Result build(const std::string& name, const std::vector<DescriptorType>& types,
               const TrainingProgress& progress) const {
    if (views_.empty())
      throw std::runtime_error(name + ": no view could be used" + (refused_.empty() ? "" : "; " + refused_.front()));
    checkBoard(name);
    std::vector<ObjectView> views = views_;
    const Eigen::Vector3d origin = moveOrigin(views, name);
    Result result;
    result.report = makeReport(views);
    result.model.name = name;
    result.model.cloud = makeCloud(views, result.report, progress);
    if (result.model.cloud.size() < kMinPoints)
      fail(name, "only " + std::to_string(result.model.cloud.size()) + " points of the object were measured");
    result.model.extents = wholeExtents(views, result.model.cloud);
    requireStill(name, result.report);
    if (views_.front().mask.empty()) result.model.rest_planes.push_back({Eigen::Vector3f::UnitZ(), boardHeight(views)});
    for (const DescriptorType type : types) {
      progress("features", static_cast<double>(result.model.features.size()) / static_cast<double>(types.size()));
      result.model.features[type] = recordedFeatures(views, result.model.cloud, features_, type, parameters_);
    }
    result.report.warnings = findWarnings(result.model, result.report, viewDirections());
    if (world_from_object_)
      result.model = moved(std::move(result.model), world_from_object_->inverse() * Eigen::Translation3d(origin));
    return result;
  }

  int views() const { return static_cast<int>(views_.size()); }
  const std::optional<Pose>& lastPose() const { return last_pose_; }

  std::vector<SurfacePoint> roughCloud() const {
    if (views_.empty()) return {};
    std::vector<ObjectView> views = views_;
    try {
      cutOut(views);
    } catch (const std::runtime_error&) {  // nothing stands there
      return {};
    }
    return surfacesOf(fuseSurfaces(views, measureSurfaces(views, kRoughStride),
                                   kRoughStride * static_cast<float>(parameters_.point_spacing)));
  }

  std::vector<Eigen::Vector3f> viewDirections() const {
    std::vector<Eigen::Vector3f> directions;
    for (const ObjectView& view : views_) directions.push_back(directionOf(view));
    return directions;
  }

 private:
  std::string tryToAdd(const RecordedView& recorded) {
    ObjectView view;
    try {
      view = makeObjectView(recorded.frame);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    if (!recorded.mask.empty() && (recorded.mask.size() != view.depth.size() || recorded.mask.type() != CV_8UC1))
      return "the mask does not fit the depth image";
    if (!findPose(recorded, view)) return board_ ? "the board is not seen" : "it has neither pose nor mask";
    last_pose_ = view.camera_from_world;
    if (views() >= parameters_.max_views) return "there are enough views";
    const double max_cosine = std::cos(parameters_.view_angle * kPi / 180.0);
    for (const ObjectView& other : views_)
      if (directionOf(other).dot(directionOf(view)) > max_cosine) return "too near to a view already used";
    view.mask = recorded.mask.clone();
    views_.push_back(std::move(view));
    return "";
  }

  bool findPose(const RecordedView& recorded, ObjectView& view) const {
    if (recorded.camera_from_world) view.camera_from_world = *recorded.camera_from_world;
    if (recorded.camera_from_world || !board_) return recorded.camera_from_world || !recorded.mask.empty();
    const auto board =
        detectBoard(*board_, toGray(recorded.frame.color, recorded.frame.color_order), recorded.frame.color_camera);
    if (!board) return false;
    view.camera_from_world = board->camera_from_board;
    view.board_rms = board->rms;
    compareWithDepth(*board, view);
    view.paper = colorOfPaper(*board_, view);
    return true;
  }

  void checkBoard(const std::string& name) const {
    std::vector<double> scales, spreads;
    for (const ObjectView& view : views_) scales.push_back(view.board_scale), spreads.push_back(view.board_spread);
    const double scale = medianOf(scales), spread = medianOf(spreads);
    if (spread > kMaxSpread)
      throw std::runtime_error(name + ": depth and colour disagree by " + std::to_string(spread) +
                               " of the distance over the board; is depth registered to colour?");
    if (std::abs(scale - 1.0) > parameters_.scale_tolerance)
      throw std::runtime_error(name + ": by depth, the board is " + std::to_string(scale) +
                               " times as large as its description says; was it printed at true size?");
  }

  // An object that moved on the board, or wrong poses, make several of it.
  void requireStill(const std::string& name, const TrainingReport& report) const {
    if (report.residual > kMaxResidual || report.carved > kMaxCarved)
      fail(name, "the views do not fit together (" + std::to_string(1000.0 * report.residual) + " mm apart, " +
                     std::to_string(100.0 * report.carved) + " % seen through); " +
                     (board_ ? "did the object move on the board?" : "are their poses right?"));
  }

  // Few views look like an object that is too large, moves or is not there: if they are too few, that is said first.
  [[noreturn]] void fail(const std::string& name, const std::string& reason) const {
    const std::string missing = views_.front().mask.empty() ? missingViews(viewDirections()) : "";
    throw std::runtime_error(name + ": " + (missing.empty() ? reason : missing + " (" + reason + ")"));
  }

  // Masks of the object in all views; the middle under it in the world.
  Eigen::Vector2f cutOut(std::vector<ObjectView>& views) const {
    const ObjectRegion region = findObjectRegion(views, parameters_);
    for (ObjectView& view : views) view.mask = maskOfRegion(view, region);
    if (board_ && 2.0 * region.innerRadius() > board_->size().maxCoeff())
      throw std::runtime_error("the object is " + std::to_string(2.0 * region.innerRadius()) +
                               " m across, larger than the board of " + std::to_string(board_->size().maxCoeff()) +
                               " m");
    return region.axis;
  }

  // Cuts the object out and puts the origin into its middle, on the board; with masks, at the centroid of the masked
  // points. Returns where that is in the world.
  Eigen::Vector3d moveOrigin(std::vector<ObjectView>& views, const std::string& name) const {
    Eigen::Vector3f origin = Eigen::Vector3f::Zero();
    if (views.front().mask.empty()) {
      try {
        origin.head<2>() = cutOut(views);
      } catch (const std::runtime_error& error) {
        fail(name, error.what());
      }
    } else {
      const std::vector<Surfel> surfels = measureSurface(views.front(), 1);
      for (const Surfel& s : surfels) origin += s.position / static_cast<float>(surfels.size());
      origin = (views.front().camera_from_world.inverse() * origin.cast<double>()).cast<float>();
    }
    for (ObjectView& view : views)
      view.camera_from_world = view.camera_from_world * Eigen::Translation3d(origin.cast<double>());
    return origin.cast<double>();
  }

  static std::vector<std::vector<Surfel>> measureSurfaces(const std::vector<ObjectView>& views, int stride) {
    std::vector<std::vector<Surfel>> surfels(views.size());
    cv::parallel_for_(cv::Range(0, static_cast<int>(views.size())), [&](const cv::Range& range) {
      for (auto i = static_cast<size_t>(range.start); i < static_cast<size_t>(range.end); ++i)
        surfels[i] = measureSurface(views[i], stride);
    });
    return surfels;
  }

  std::vector<SurfacePoint> makeCloud(std::vector<ObjectView>& views, TrainingReport& report,
                                      const TrainingProgress& progress) const {
    const auto spacing = static_cast<float>(parameters_.point_spacing);
    report.residual = alignViews(views, measureSurfaces(views, kAlignmentStride), parameters_.alignment_rounds,
                                 static_cast<float>(parameters_.alignment_distance), parameters_.pose_sigma, spacing,
                                 [&](double done) { progress("alignment", done); });
    progress("fusion", 0.0);
    const float highest_board = views_.front().mask.empty() ? static_cast<float>(kBoardNoise * parameters_.plane_margin)
                                                            : std::numeric_limits<float>::lowest();  // the masks tell
    std::vector<SurfacePoint> cloud = cleanCloud(views, fuseSurfaces(views, measureSurfaces(views, 1), spacing),
                                                 parameters_.min_views, spacing, highest_board, report.carved);
    takeColors(views, spacing, cloud);
    return cloud;
  }

  // Sigma of the whole object, as far as what cannot be seen of it is known: where it stands.
  Extents wholeExtents(const std::vector<ObjectView>& views, std::vector<SurfacePoint> cloud) const {
    const auto spacing = static_cast<float>(parameters_.point_spacing);
    if (!views_.front().mask.empty()) return computeEvenExtents(cloud, spacing);
    for (const SurfacePoint& point :
         estimateUnseen(views, cloud, static_cast<float>(parameters_.plane_margin), spacing))
      cloud.push_back(point);
    return computeEvenExtents(cloud, spacing);
  }

  TrainingReport makeReport(const std::vector<ObjectView>& views) const {
    TrainingReport report;
    report.views_used = static_cast<int>(views.size());
    report.views_seen = seen_;
    report.refused = refused_;
    for (const ObjectView& view : views) {
      report.board_rms += view.board_rms / report.views_used;
      report.board_spread += view.board_spread / report.views_used;
      report.overexposed += overexposedShare(view) / report.views_used;
    }
    report.coverage = coverageOf(viewDirections());
    return report;
  }

  RecordingParameters parameters_;
  FeatureParameters features_;
  std::optional<FiducialBoard> board_;
  std::optional<Pose> world_from_object_;
  std::vector<ObjectView> views_;
  std::vector<std::string> refused_;
  int seen_ = 0;
  std::optional<Pose> last_pose_;
};

RecordedObject::RecordedObject(const RecordingParameters& parameters, const FeatureParameters& features,
                               std::optional<FiducialBoard> board, std::optional<Pose> world_from_object)
    : impl_(std::make_unique<Impl>(parameters, features, std::move(board), world_from_object)) {}
RecordedObject::~RecordedObject() = default;

std::string RecordedObject::add(const RecordedView& view) { return impl_->add(view); }
void RecordedObject::refuse(const std::string& reason) { impl_->refuse(reason); }
int RecordedObject::views() const { return impl_->views(); }
std::vector<Eigen::Vector3f> RecordedObject::viewDirections() const { return impl_->viewDirections(); }
double RecordedObject::coverage() const { return coverageOf(impl_->viewDirections()); }
const std::optional<Pose>& RecordedObject::lastPose() const { return impl_->lastPose(); }
std::vector<SurfacePoint> RecordedObject::roughCloud() const { return impl_->roughCloud(); }
RecordedObject::Result RecordedObject::build(const std::string& name, const std::vector<DescriptorType>& types,
                                             const TrainingProgress& progress) {
  return impl_->build(
      name, types, progress ? progress : [](const std::string&, double) {});
}

}  // namespace recognition
