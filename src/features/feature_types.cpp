#include "rgbd_recognition/features/feature_types.h"

#include <stdexcept>
#include <string>

namespace rgbd_recognition {

const char* descriptorName(DescriptorType type) {
  switch (type) {
    case DescriptorType::kSurf128:
      return "surf128";
    case DescriptorType::kSurf64:
      return "surf64";
    case DescriptorType::kSift:
      return "sift";
  }
  return "";
}

DescriptorType descriptorFromName(const std::string& name) {
  for (const DescriptorType type : {DescriptorType::kSurf128, DescriptorType::kSurf64, DescriptorType::kSift})
    if (name == descriptorName(type)) return type;
  throw std::invalid_argument("descriptor type '" + name + "' is none of surf128, surf64, sift");
}

int descriptorLength(DescriptorType type) { return type == DescriptorType::kSurf64 ? 64 : 128; }

}  // namespace rgbd_recognition
