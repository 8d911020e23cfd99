#pragma once

#include <opencv2/core.hpp>

namespace recognition {

/// Procedural materials of table tops, floors and walls.
enum class MaterialKind { kPlain, kWood, kCloth, kChecker, kSpeckle, kCarpet, kCount };

/// A seamless CV_8UC3 tile of `size` x `size` pixels.
cv::Mat makeMaterialTexture(MaterialKind kind, int size, cv::RNG& rng);

/// Something like the print on a package: flat areas, stripes, lettering, emblems and a picture-like region. CV_8UC3.
cv::Mat makePrintTexture(cv::Size size, cv::RNG& rng);

}  // namespace recognition
