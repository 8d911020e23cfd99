#include "matching/hypothesis_generator.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>

#include "core/angles.h"
#include "matching/algorithm2.h"
#include "matching/pose_support.h"
#include "rgbd_recognition/matching/scene_matches.h"

namespace recognition {
namespace {

/// Correspondences this much farther than Delta_d from a pose's prediction still count as explained by it.
constexpr double kExplainedFactor = 2.0;

/// Objects that are searched for side by side; fixed, whatever the number of threads.
constexpr int kObjectsAtATime = 4;

/// Beyond so many hypotheses of an object the search goes on only while consensus sets are clear: many instances of one
/// object (a tote of cartons) have them, clutter has not.
constexpr int kFewHypotheses = 4, kClearConsensus = 8;

/// Units of WorkBudget that the support of one correspondence costs.
constexpr int kSupportWork = 1000;

/// FNV-1a: the same object draws the same samples in any database, so also when objects are split over several
/// generators.
std::uint32_t seedOf(const std::string& name, int seed, int round) {
  std::uint32_t hash = 2166136261u ^ static_cast<std::uint32_t>(seed);
  for (const char c : name) hash = (hash ^ static_cast<std::uint8_t>(c)) * 16777619u;
  return (hash ^ static_cast<std::uint32_t>(round)) * 16777619u;
}

using FeatureFrames = std::vector<Eigen::Quaternionf>;

/// Algorithm 2 for one object, again and again until nothing of size is left.
class ObjectSearch {
 public:
  ObjectSearch(const MatchingParameters& parameters, const ModelFeatures& model, const FeatureFrames& model_frames,
               const SceneFeatures& scene, const FeatureFrames& scene_frames)
      : parameters_(parameters),
        model_(model),
        model_frames_(model_frames),
        scene_(scene),
        scene_frames_(scene_frames) {}

  struct Result {
    std::vector<Hypothesis> hypotheses;
    std::int64_t spent = 0;
    bool cut = false;
  };

  /// An object's correspondences in the order in which Algorithm 2 fixes them.
  struct Candidates {
    std::vector<Correspondence> pairs;  ///< T_f
    int priority = 0;                   ///< the larger, the sooner is the object searched for
    std::int64_t spent = 0;
  };

  Candidates order(const std::vector<Correspondence>& pairs) const {
    FeatureFrames rotations;
    if (parameters_.order == CorrespondenceOrder::kSupport)
      rotations = impliedRotations(pairs, scene_frames_, model_frames_);
    if (rotations.empty()) return {pairs, static_cast<int>(pairs.size()), 0};
    const std::vector<int> support = poseSupport(pairs, rotations, scene_.points, model_.positions,
                                                 parameters_.support_radius, parameters_.max_rotation);
    Candidates candidates{sortBySupport(pairs, support), 0, kSupportWork * static_cast<std::int64_t>(pairs.size())};
    for (const int count : support) candidates.priority = std::max(candidates.priority, count);
    const auto enough = [&](int count) { return count >= parameters_.min_support; };
    candidates.pairs.resize(static_cast<size_t>(std::count_if(support.begin(), support.end(), enough)));
    return candidates;
  }

  Result run(std::vector<Correspondence> pairs, std::uint32_t seed, WorkBudget budget) const {
    Result result;
    const std::int64_t granted = budget.left;
    int last_size = 0;
    Algorithm2 algorithm(parameters_, seed);
    // Twice as many tries as hypotheses, for consensus sets that are no hypotheses.
    for (int i = 0; i < 2 * parameters_.hypotheses_per_object && !budget.exhausted(); ++i) {
      if (static_cast<int>(result.hypotheses.size()) == parameters_.hypotheses_per_object) break;
      if (static_cast<int>(result.hypotheses.size()) >= kFewHypotheses && last_size < kClearConsensus) break;
      if (static_cast<int>(pairs.size()) < parameters_.min_consensus) break;
      const CorrespondenceSet set(pairs, scene_.points, model_.positions,
                                  impliedRotations(pairs, scene_frames_, model_frames_));
      WorkBudget half{budget.left / 2};  // so that a long search leaves some for the object's other poses
      const std::int64_t given = half.left;
      const PoseConsensus found = algorithm.search(set, parameters_.min_consensus - 1, half);
      budget.spend(given - half.left);
      result.cut = result.cut || half.exhausted();
      if (found.members.empty()) break;
      last_size = found.size();
      Hypothesis hypothesis = makeHypothesis(set, found);
      if (worthTesting(hypothesis, result.hypotheses)) result.hypotheses.push_back(std::move(hypothesis));
      pairs = unexplained(set, found);
    }
    const auto more = [](const Hypothesis& a, const Hypothesis& b) { return a.consensus.size() > b.consensus.size(); };
    std::stable_sort(result.hypotheses.begin(), result.hypotheses.end(), more);
    result.spent = granted - budget.left;
    return result;
  }

 private:
  Hypothesis makeHypothesis(const CorrespondenceSet& set, const PoseConsensus& found) const {
    Hypothesis hypothesis;
    hypothesis.camera_from_object = found.camera_from_object;
    for (const int member : found.members)
      if (facesCamera(set.pair(member), found.camera_from_object)) hypothesis.consensus.push_back(set.pair(member));
    return hypothesis;
  }

  bool facesCamera(const Correspondence& pair, const Pose& camera_from_object) const {
    if (parameters_.max_view_angle >= 180.0 || model_.view_directions.empty()) return true;
    const Eigen::Vector3d towards_trained =
        camera_from_object.linear() * model_.view_directions[pair.model_feature].cast<double>();
    const Eigen::Vector3d towards_camera = -scene_.points[pair.scene_feature].cast<double>().normalized();
    return towards_trained.dot(towards_camera) >= std::cos(parameters_.max_view_angle * kDegree);
  }

  bool worthTesting(const Hypothesis& hypothesis, const std::vector<Hypothesis>& earlier) const {
    const auto size = static_cast<double>(hypothesis.consensus.size());
    if (size < parameters_.min_consensus) return false;
    std::set<int> features;
    for (const Correspondence& pair : hypothesis.consensus) features.insert(pair.scene_feature);
    return std::none_of(earlier.begin(), earlier.end(), [&](const Hypothesis& other) {
      const auto shared =
          std::count_if(other.consensus.begin(), other.consensus.end(),
                        [&](const Correspondence& pair) { return features.count(pair.scene_feature) > 0; });
      return shared > 0.5 * size && size < parameters_.alternative_ratio * static_cast<double>(other.consensus.size());
    });
  }

  std::vector<Correspondence> unexplained(const CorrespondenceSet& set, const PoseConsensus& found) const {
    std::vector<float> residuals;
    const double distance = kExplainedFactor * parameters_.delta_d;
    const auto limit = static_cast<float>(distance * distance);
    set.squaredResiduals(found.camera_from_object, limit, residuals);
    for (const int member : found.members) residuals[member] = 0.0f;
    std::vector<Correspondence> left;
    for (int i = 0; i < set.size(); ++i)
      if (residuals[i] > limit) left.push_back(set.pair(i));
    return left;
  }

  const MatchingParameters& parameters_;
  const ModelFeatures& model_;
  const FeatureFrames& model_frames_;
  const SceneFeatures& scene_;
  const FeatureFrames& scene_frames_;
};

std::vector<const ModelFeatures*> featuresOf(const ModelDatabase& database, DescriptorType type) {
  std::vector<const ModelFeatures*> models;
  for (const auto& object : database.objects) {
    const auto found = object->features.find(type);
    if (found == object->features.end())
      throw std::invalid_argument("model " + object->name + " has no " + descriptorName(type) + " features");
    models.push_back(&found->second);
  }
  return models;
}

}  // namespace

const char* sourceName(HypothesisSource source) {
  switch (source) {
    case HypothesisSource::kConsensus:
      return "consensus";
    case HypothesisSource::kCorrespondence:
      return "correspondence";
    case HypothesisSource::kShape:
      return "shape";
    case HypothesisSource::kAlternative:
      return "alternative";
  }
  return "";
}

class HypothesisGenerator::Impl {
 public:
  Impl(const MatchingParameters& parameters, std::shared_ptr<const ModelDatabase> database, DescriptorType type)
      : parameters_(parameters), database_(std::move(database)), type_(type), models_(featuresOf(*database_, type)) {
    parameters_.validate();
    search_ = makeCorrespondenceSearch(parameters_, models_, descriptorLength(type));
    model_frames_.resize(models_.size());
    cv::parallel_for_(cv::Range(0, static_cast<int>(models_.size())), [&](const cv::Range& range) {
      for (int i = range.start; i < range.end; ++i)
        model_frames_[i] = featureFrames(*models_[i], database_->objects[i]->cloud);
    });
  }

  SceneMatches match(const SceneFeatures& scene) const {
    if (scene.image.type != type_)
      throw std::invalid_argument(std::string("scene descriptors are ") + descriptorName(scene.image.type) +
                                  ", the models' are " + descriptorName(type_));
    return search_->match(scene);
  }

  std::vector<Hypothesis> generate(const SceneFeatures& scene, const SceneMatches& matches,
                                   const std::vector<std::uint8_t>& active, const std::vector<int>& wanted, int round,
                                   GenerationReport* report) const {
    check(scene, matches, active, wanted);
    std::vector<int> objects = wanted;
    if (objects.empty()) {
      objects.resize(models_.size());
      std::iota(objects.begin(), objects.end(), 0);
    }
    std::vector<std::vector<Correspondence>> pairs(objects.size());
    for (size_t i = 0; i < objects.size(); ++i) pairs[i] = activePairs(matches.by_object[objects[i]], active);
    return collect(objects, searchAll({scene, featureFrames(scene)}, objects, pairs, round), round, report);
  }

  size_t bytes() const { return search_->bytes(); }

 private:
  using Results = std::vector<ObjectSearch::Result>;

  /// What a frame's objects are searched for in.
  struct Scene {
    const SceneFeatures& features;
    FeatureFrames frames;
  };

  ObjectSearch searchFor(int object, const Scene& scene) const {
    return ObjectSearch(parameters_, *models_[object], model_frames_[object], scene.features, scene.frames);
  }

  void check(const SceneFeatures& scene, const SceneMatches& matches, const std::vector<std::uint8_t>& active,
             const std::vector<int>& objects) const {
    if (matches.by_object.size() != models_.size())
      throw std::invalid_argument("matches with " + std::to_string(matches.by_object.size()) +
                                  " objects, the database has " + std::to_string(models_.size()));
    if (!active.empty() && active.size() != scene.points.size())
      throw std::invalid_argument(std::to_string(active.size()) + " activity flags for " +
                                  std::to_string(scene.points.size()) + " scene features");
    for (const int object : objects)
      if (object < 0 || object >= static_cast<int>(models_.size()))
        throw std::invalid_argument("object " + std::to_string(object) + " is not among the " +
                                    std::to_string(models_.size()) + " of the database");
  }

  static std::vector<Correspondence> activePairs(const std::vector<Correspondence>& pairs,
                                                 const std::vector<std::uint8_t>& active) {
    if (active.empty()) return pairs;
    std::vector<Correspondence> left;
    std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(left),
                 [&](const Correspondence& pair) { return active[pair.scene_feature] != 0; });
    return left;
  }

  using AllCandidates = std::vector<ObjectSearch::Candidates>;

  AllCandidates orderAll(const Scene& scene, const std::vector<int>& objects,
                         const std::vector<std::vector<Correspondence>>& pairs) const {
    AllCandidates candidates(objects.size());
    cv::parallel_for_(cv::Range(0, static_cast<int>(objects.size())), [&](const cv::Range& range) {
      for (int i = range.start; i < range.end; ++i) candidates[i] = searchFor(objects[i], scene).order(pairs[i]);
    });
    return candidates;
  }

  /// Objects of the highest priority first, a few at a time; those at a time share half of what is left of the budget, so
  /// that nothing starves and the result is the same for any number of threads.
  Results searchAll(const Scene& scene, const std::vector<int>& objects,
                    const std::vector<std::vector<Correspondence>>& pairs, int round) const {
    AllCandidates candidates = orderAll(scene, objects, pairs);
    std::int64_t left = WorkBudget::milliseconds(parameters_.work_limit_ms).left;
    std::vector<int> order(objects.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return candidates[a].priority > candidates[b].priority; });

    Results results(objects.size());
    for (size_t first = 0; first < order.size(); first += kObjectsAtATime) {
      const size_t last = std::min(order.size(), first + kObjectsAtATime);
      const WorkBudget share{left / (2 * kObjectsAtATime)};
      cv::parallel_for_(cv::Range(static_cast<int>(first), static_cast<int>(last)), [&](const cv::Range& range) {
        for (int k = range.start; k < range.end; ++k) {
          const int i = order[k], object = objects[i];
          const std::uint32_t seed = seedOf(database_->objects[object]->name, parameters_.seed, round);
          results[i] = searchFor(object, scene).run(std::move(candidates[i].pairs), seed, share);
        }
      });
      for (size_t k = first; k < last; ++k) left -= results[order[k]].spent;
    }
    for (size_t i = 0; i < results.size(); ++i) results[i].spent += candidates[i].spent;
    return results;
  }

  static std::vector<Hypothesis> collect(const std::vector<int>& objects, Results results, int round,
                                         GenerationReport* report) {
    std::vector<Hypothesis> hypotheses;
    for (size_t i = 0; i < objects.size(); ++i) {
      for (Hypothesis& hypothesis : results[i].hypotheses) {
        hypothesis.object = objects[i];
        hypothesis.round = round;
        hypotheses.push_back(std::move(hypothesis));
      }
      if (!report) continue;
      report->work_ms +=
          static_cast<double>(results[i].spent) / static_cast<double>(WorkBudget::milliseconds(1.0).left);
      if (!results[i].cut) continue;
      report->budget_exhausted = true;
      auto& cut = report->objects_cut_short;
      if (std::find(cut.begin(), cut.end(), objects[i]) == cut.end()) cut.push_back(objects[i]);
    }
    return hypotheses;
  }

  MatchingParameters parameters_;
  std::shared_ptr<const ModelDatabase> database_;
  DescriptorType type_;
  std::vector<const ModelFeatures*> models_;
  std::vector<FeatureFrames> model_frames_;
  std::unique_ptr<CorrespondenceSearch> search_;
};

HypothesisGenerator::HypothesisGenerator(const MatchingParameters& parameters,
                                         std::shared_ptr<const ModelDatabase> database, DescriptorType type)
    : impl_(std::make_unique<Impl>(parameters, std::move(database), type)) {}

HypothesisGenerator::~HypothesisGenerator() = default;

SceneMatches HypothesisGenerator::match(const SceneFeatures& scene) const { return impl_->match(scene); }

std::vector<Hypothesis> HypothesisGenerator::generate(const SceneFeatures& scene, const SceneMatches& matches,
                                                      const std::vector<std::uint8_t>& active,
                                                      const std::vector<int>& objects, int round,
                                                      GenerationReport* report) const {
  return impl_->generate(scene, matches, active, objects, round, report);
}

size_t HypothesisGenerator::bytes() const { return impl_->bytes(); }

}  // namespace recognition
