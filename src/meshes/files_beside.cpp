#include "meshes/files_beside.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "meshes/mesh_readers.h"
#include "meshes/text_cursor.h"

namespace recognition {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxSide = 8192;  // pixels; finer texture is not seen from any distance of training

int hexDigit(char c) {
  const char* const digits = "0123456789abcdef";
  const std::string all = digits;
  const size_t at = all.find(static_cast<char>(std::tolower(static_cast<unsigned char>(c))));
  return at == std::string::npos ? -1 : static_cast<int>(at);
}

std::string withoutPercent(const std::string& text) {
  std::string plain;
  for (size_t i = 0; i < text.size(); ++i) {
    const bool is_code =
        text[i] == '%' && i + 2 < text.size() && hexDigit(text[i + 1]) >= 0 && hexDigit(text[i + 2]) >= 0;
    plain += is_code ? static_cast<char>(16 * hexDigit(text[i + 1]) + hexDigit(text[i + 2])) : text[i];
    if (is_code) i += 2;
  }
  return plain;
}

std::string cleaned(std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  if (name.size() > 1 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
  if (name.rfind("file://", 0) == 0) name.erase(0, 7);
  return name;
}

bool isFile(const fs::path& path) {
  std::error_code none;
  return fs::is_regular_file(path, none);
}

/// `folder`/`name`, whatever the case of its letters.
std::optional<std::string> findInFolder(const fs::path& folder, const std::string& name) {
  if (name.empty()) return std::nullopt;
  if (isFile(folder / name)) return (folder / name).string();
  std::error_code none;
  std::vector<std::string> found;
  for (const auto& entry : fs::directory_iterator(folder, none))
    if (lowerCase(entry.path().filename().string()) == lowerCase(name) && isFile(entry.path()))
      found.push_back(entry.path().string());
  std::sort(found.begin(), found.end());
  return found.empty() ? std::nullopt : std::optional<std::string>(found.front());
}

}  // namespace

std::optional<std::string> findBeside(const std::string& mesh_file, const std::string& name) {
  const fs::path folder = fs::path(mesh_file).has_parent_path() ? fs::path(mesh_file).parent_path() : fs::path(".");
  for (const std::string& path : {cleaned(name), withoutPercent(cleaned(name))}) {
    if (path.empty()) continue;
    if (isFile(folder / path)) return (folder / path).string();  // absolute ones, too
    if (const auto found = findInFolder((folder / path).parent_path(), fs::path(path).filename().string()))
      return found;
    if (const auto found = findInFolder(folder, fs::path(path).filename().string())) return found;
  }
  return std::nullopt;
}

cv::Mat decodeTexture(const std::string& bytes, const std::string& name) {
  cv::Mat image;
  try {
    const cv::Mat view(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data()));
    if (!bytes.empty()) image = cv::imdecode(view, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {  // as for a size that is not plausible
  }
  if (image.empty()) image = decodeTga(bytes);
  if (image.empty())
    throw std::runtime_error("texture " + name + " is no readable image (PNG, JPEG, TIFF, BMP, TGA and WebP are read)");
  if (const int side = std::max(image.cols, image.rows); side > kMaxSide) {
    const double factor = static_cast<double>(kMaxSide) / side;
    cv::Mat reduced;
    cv::resize(image, reduced, {std::max(1, cvRound(image.cols * factor)), std::max(1, cvRound(image.rows * factor))},
               0, 0, cv::INTER_AREA);
    return reduced;
  }
  return image;
}

cv::Mat readTextureFile(const std::string& mesh_file, const std::string& name) {
  const auto found = findBeside(mesh_file, name);
  if (!found) throw std::runtime_error("texture " + name + " is missing (looked for beside the mesh, too)");
  return decodeTexture(readBytes(*found), *found);
}

}  // namespace recognition
