#pragma once

#include <vector>

#include "training/object_view.h"
#include "rgbd_recognition/model/object_model.h"
#include "rgbd_recognition/training/fiducial_board.h"

namespace recognition {

/// The colour of the board's paper in a view of pose camera_from_board; kPaper, which changes nothing, where too little
/// of it is seen. What lamps, exposure and white balance make of paper, they make of the object's upper side.
cv::Vec3f colorOfPaper(const FiducialBoard& board, const ObjectView& view);

/// Share of the object's pixels in a view that are too bright for the camera: their texture is lost.
double overexposedShare(const ObjectView& view);

/// Colours of a cloud (world frame) as its views see them there, each averaged over `spacing` metres, with light and
/// exposure taken out as far as the view's paper tells. Of the views that see a point, the middle half by brightness
/// counts: no highlights, no shadows, and nothing that a view of a slightly wrong pose puts there. A point that no view
/// sees keeps its colour.
void takeColors(const std::vector<ObjectView>& views, float spacing, std::vector<SurfacePoint>& cloud);

}  // namespace recognition
