#pragma once

#include <vector>

#include "rgbd_recognition/matching/hypothesis.h"
#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"

namespace recognition {

/// Ours, beyond the paper: poses of objects whose texture helps nothing, because it is worn, seen from a blank side or
/// too far away. Most objects lie as they rest on a plane (restingPoses()), so only a turn about the plane's normal and
/// a place are open: each patch of the segmentation is tried as that part of the surface which looks its way
/// (FaceTable), and each blob as all of the surface that is seen, for many turns, and the frame's depth and colours
/// tell which poses deserve a test, as with proposeByCorrespondence().
///
/// `objects`: indices of those to look for; `explained` (CV_8UC1, depth resolution): not 0 where a detection explains
/// the frame; patches of which most is are left out. At most `count` hypotheses, the highest priority first, without a
/// consensus set; none where no plane is seen. Same result for any number of threads.
std::vector<Hypothesis> proposeRestingPoses(const std::vector<int>& objects, const cv::Mat& explained,
                                            const PreparedModels& models, const SceneView& scene, int count);

}  // namespace recognition
