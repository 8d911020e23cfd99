#pragma once

namespace recognition {

/// Values of a mask of what tracks explain (CV_8UC1): by confirmed tracks; by ones that await another detection, where
/// the search goes on. 0: by none.
constexpr int kExplainedPixel = 255, kUnconfirmedPixel = 128;

}  // namespace recognition
