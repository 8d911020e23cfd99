#include "proposals/pose_proposer.h"

#include "features/active_features.h"
#include "proposals/correspondence_proposals.h"
#include "proposals/resting_proposals.h"

namespace recognition {
namespace {

class CorrespondenceProposer : public PoseProposer {
 public:
  explicit CorrespondenceProposer(int count) : count_(count) {}

  std::vector<Hypothesis> propose(const ProposalContext& context) const override {
    const SceneView& scene = context.scene;
    const auto active = activeFeatures(*scene.features, context.explained, scene.color_per_depth);
    return proposeByCorrespondence(context, active, count_);
  }

 private:
  int count_;
};

class RestingProposer : public PoseProposer {
 public:
  explicit RestingProposer(int count) : count_(count) {}

  /// Of objects that were looked for: any that is has some match in the frame, right or wrong.
  std::vector<Hypothesis> propose(const ProposalContext& context) const override {
    std::vector<int> objects;
    for (size_t i = 0; i < context.matches.by_object.size(); ++i)
      if (!context.matches.by_object[i].empty()) objects.push_back(static_cast<int>(i));
    return proposeRestingPoses(objects, context.explained, context.models, context.scene, count_);
  }

 private:
  int count_;
};

}  // namespace

std::vector<std::unique_ptr<PoseProposer>> makeProposers(const VerificationParameters& parameters) {
  std::vector<std::unique_ptr<PoseProposer>> proposers;
  if (parameters.correspondence_proposals > 0)
    proposers.push_back(std::make_unique<CorrespondenceProposer>(parameters.correspondence_proposals));
  if (parameters.resting_proposals > 0)
    proposers.push_back(std::make_unique<RestingProposer>(parameters.resting_proposals));
  return proposers;
}

}  // namespace recognition
