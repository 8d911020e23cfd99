#pragma once

#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"
#include "verification/pose_verification.h"

namespace recognition {

/// How much better the colours of `a` suit the frame than those of `b` do, in standard errors, positive for `a`. Only the
/// pixels count that both explain and where the two, as lit, differ: what two objects have in common says nothing about
/// which of them it is. 0 where they differ in next to nothing.
double colorPreference(const TestedHypothesis& a, const TestedHypothesis& b, const PreparedModels& models,
                       const SceneView& scene);

}  // namespace recognition
