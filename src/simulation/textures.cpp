#include "simulation/textures.h"

#include <opencv2/imgproc.hpp>

namespace recognition {
namespace {

// Smooth seamless noise, CV_32FC1 about 0, with features of size / cells pixels, stretched along x by `stretch`.
cv::Mat smoothNoise(int size, double cells, double stretch, cv::RNG& rng) {
  const cv::Size coarse_size(std::max(1, cvRound(cells / stretch)), std::max(1, cvRound(cells)));
  cv::Mat coarse(coarse_size, CV_32FC1), bordered, fine;
  rng.fill(coarse, cv::RNG::NORMAL, 0.0, 1.0);
  cv::copyMakeBorder(coarse, bordered, 2, 2, 2, 2, cv::BORDER_WRAP);
  const double fx = static_cast<double>(size) / coarse_size.width;
  const double fy = static_cast<double>(size) / coarse_size.height;
  cv::resize(bordered, fine, {}, fx, fy, cv::INTER_CUBIC);
  return fine(cv::Rect(cvRound(2 * fx), cvRound(2 * fy), size, size)).clone();
}

cv::Mat octaves(int size, double cells, int count, double stretch, cv::RNG& rng) {
  cv::Mat sum = cv::Mat::zeros(size, size, CV_32FC1);
  for (int i = 0; i < count && cells * (1 << i) <= size; ++i)
    sum += smoothNoise(size, cells * (1 << i), stretch, rng) / (1 << i);
  return sum;
}

// base + amount * field, per channel, CV_8UC3.
cv::Mat tint(const cv::Scalar& base, const cv::Scalar& amount, const cv::Mat& field) {
  std::vector<cv::Mat> channels(3);
  for (int c = 0; c < 3; ++c) field.convertTo(channels[static_cast<size_t>(c)], CV_8U, amount[c], base[c]);
  cv::Mat color;
  cv::merge(channels, color);
  return color;
}

cv::Scalar randomColor(cv::RNG& rng, double min, double max) {
  return {rng.uniform(min, max), rng.uniform(min, max), rng.uniform(min, max)};
}

cv::Scalar randomGray(cv::RNG& rng, double min, double max, double spread) {
  const double value = rng.uniform(min, max);
  return {value + rng.uniform(-spread, spread), value + rng.uniform(-spread, spread),
          value + rng.uniform(-spread, spread)};
}

cv::Mat makePlain(int size, cv::RNG& rng) {
  const bool bright = rng.uniform(0.0, 1.0) < 0.6;
  const cv::Scalar base = bright ? randomGray(rng, 170, 240, 12) : randomGray(rng, 30, 150, 30);
  return tint(base, cv::Scalar::all(2.5), octaves(size, 8, 6, 1.0, rng));
}

cv::Mat makeWood(int size, cv::RNG& rng) {
  const double lightness = rng.uniform(0.35, 1.0);
  const cv::Scalar base(90 * lightness, 140 * lightness, 200 * lightness);
  cv::Mat rings = 3.0 * smoothNoise(size, 6, 5.0, rng), grain;
  for (int v = 0; v < size; ++v) {
    float* row = rings.ptr<float>(v);
    for (int u = 0; u < size; ++u)
      row[u] = std::sin(row[u] + 6.2831853f * 9.0f * static_cast<float>(v) / static_cast<float>(size));
  }
  grain = 0.6 * rings + 0.8 * octaves(size, 64, 3, 12.0, rng);
  return tint(base, cv::Scalar(14, 17, 20) * lightness, grain);
}

cv::Mat makeCloth(int size, cv::RNG& rng) {
  const cv::Scalar base = randomColor(rng, 40, 220);
  const cv::Scalar stripe = randomColor(rng, 40, 230);
  cv::Mat cloth = tint(base, cv::Scalar::all(8), octaves(size, 128, 3, 1.0, rng));
  const bool patterned = rng.uniform(0.0, 1.0) < 0.6;
  const int pitch = size / rng.uniform(4, 12);
  for (int v = 0; v < size; ++v)
    for (int u = 0; u < size; ++u) {
      auto& pixel = cloth.at<cv::Vec3b>(v, u);
      const bool in_stripe = patterned && ((u % pitch < pitch / 4) != (v % pitch < pitch / 4));
      const int weave = ((u / 2 + v / 2) % 2 == 0) ? 7 : -7;
      for (int c = 0; c < 3; ++c)
        pixel[c] = cv::saturate_cast<uchar>((in_stripe ? 0.4 * pixel[c] + 0.6 * stripe[c] : pixel[c]) + weave);
    }
  return cloth;
}

cv::Mat makeChecker(int size, cv::RNG& rng) {
  const cv::Mat dark = rng.uniform(0.0, 1.0) < 0.5
                           ? makeWood(size, rng)
                           : tint(randomColor(rng, 20, 110), cv::Scalar::all(4), octaves(size, 32, 4, 1.0, rng));
  cv::Mat checker = tint(randomGray(rng, 180, 235, 15), cv::Scalar::all(4), octaves(size, 32, 4, 1.0, rng));
  const int squares = 2 * rng.uniform(1, 4);
  const int side = size / squares;
  for (int row = 0; row < squares; ++row)
    for (int column = row % 2; column < squares; column += 2) {
      const cv::Rect square(column * side, row * side, side, side);
      dark(square).copyTo(checker(square));
    }
  return checker;
}

cv::Mat makeSpeckle(int size, cv::RNG& rng) {
  cv::Mat speckle = tint(randomGray(rng, 90, 210, 15), cv::Scalar::all(6), octaves(size, 16, 5, 1.0, rng));
  const cv::Scalar colors[3] = {randomGray(rng, 20, 90, 20), randomGray(rng, 150, 250, 10), randomColor(rng, 40, 200)};
  const int count = size * size / rng.uniform(150, 600);
  for (int i = 0; i < count; ++i) {
    const cv::Point at(rng.uniform(0, size), rng.uniform(0, size));
    cv::ellipse(speckle, at, {rng.uniform(1, 5), rng.uniform(1, 4)}, rng.uniform(0.0, 180.0), 0, 360,
                colors[rng.uniform(0, 3)], cv::FILLED, cv::LINE_AA);
  }
  return speckle;
}

cv::Mat makeCarpet(int size, cv::RNG& rng) {
  return tint(randomGray(rng, 40, 130, 20), randomColor(rng, 10, 35), octaves(size, size / 8.0, 4, 1.0, rng));
}

std::string randomWord(cv::RNG& rng) {
  std::string word;
  const int length = rng.uniform(3, 9);
  for (int i = 0; i < length; ++i) word += static_cast<char>((i == 0 ? 'A' : 'a') + rng.uniform(0, 26));
  return word;
}

void printWords(cv::Mat& image, int count, double scale, const cv::Scalar& color, cv::RNG& rng) {
  const int fonts[] = {cv::FONT_HERSHEY_DUPLEX, cv::FONT_HERSHEY_TRIPLEX, cv::FONT_HERSHEY_COMPLEX,
                       cv::FONT_HERSHEY_SCRIPT_COMPLEX};
  for (int i = 0; i < count; ++i)
    cv::putText(image, randomWord(rng), {rng.uniform(0, image.cols * 3 / 4), rng.uniform(10, image.rows)},
                fonts[rng.uniform(0, 4)], scale * rng.uniform(0.7, 1.4), color, std::max(1, cvRound(scale * 2)),
                cv::LINE_AA);
}

void printFinePrint(cv::Mat& image, cv::RNG& rng) {
  const cv::Rect block(rng.uniform(0, image.cols / 2), rng.uniform(0, image.rows / 2), image.cols / 3, image.rows / 4);
  cv::rectangle(image, block, randomGray(rng, 200, 255, 5), cv::FILLED);
  for (int y = block.y + 8; y + 2 < block.br().y; y += 10)
    cv::putText(image, randomWord(rng) + " " + randomWord(rng) + " " + randomWord(rng), {block.x + 4, y},
                cv::FONT_HERSHEY_PLAIN, 0.6, randomGray(rng, 10, 60, 5), 1, cv::LINE_AA);
}

void printEmblem(cv::Mat& image, cv::RNG& rng) {
  const cv::Point centre(rng.uniform(0, image.cols), rng.uniform(0, image.rows));
  const int radius = rng.uniform(image.cols / 20, image.cols / 6);
  for (double part : {1.0, 0.8, 0.45})
    cv::ellipse(image, centre, {cvRound(radius * part), cvRound(radius * part * rng.uniform(0.5, 1.0))},
                rng.uniform(0.0, 180.0), 0, 360, randomColor(rng, 0, 255), cv::FILLED, cv::LINE_AA);
}

// Blobs of smooth colour: what a photograph of food looks like from afar.
void printPicture(cv::Mat& image, cv::RNG& rng) {
  const int side = std::min(image.cols, image.rows) / 2;
  std::vector<cv::Mat> channels(3);
  for (auto& channel : channels) octaves(side, 3, 6, 1.0, rng).convertTo(channel, CV_8U, 45, rng.uniform(60, 190));
  cv::Mat picture;
  cv::merge(channels, picture);
  picture.copyTo(image(cv::Rect(rng.uniform(0, image.cols - side), rng.uniform(0, image.rows - side), side, side)));
}

}  // namespace

cv::Mat makeMaterialTexture(MaterialKind kind, int size, cv::RNG& rng) {
  switch (kind) {
    case MaterialKind::kWood:
      return makeWood(size, rng);
    case MaterialKind::kCloth:
      return makeCloth(size, rng);
    case MaterialKind::kChecker:
      return makeChecker(size, rng);
    case MaterialKind::kSpeckle:
      return makeSpeckle(size, rng);
    case MaterialKind::kCarpet:
      return makeCarpet(size, rng);
    default:
      return makePlain(size, rng);
  }
}

cv::Mat makePrintTexture(cv::Size size, cv::RNG& rng) {
  cv::Mat image(size, CV_8UC3, randomColor(rng, 20, 240));
  for (int i = 0; i < 3; ++i) {
    const cv::Point corner(rng.uniform(0, size.width), rng.uniform(0, size.height));
    cv::rectangle(image, corner, corner + cv::Point(rng.uniform(20, size.width), rng.uniform(20, size.height)),
                  randomColor(rng, 0, 255), cv::FILLED);
  }
  if (rng.uniform(0.0, 1.0) < 0.7) printPicture(image, rng);
  for (int i = rng.uniform(1, 6); i > 0; --i) printEmblem(image, rng);
  for (int i = rng.uniform(0, 3); i > 0; --i) printFinePrint(image, rng);
  printWords(image, rng.uniform(2, 6), size.width / 250.0, randomColor(rng, 0, 255), rng);
  printWords(image, rng.uniform(2, 10), size.width / 700.0, randomColor(rng, 0, 255), rng);
  return image;
}

}  // namespace recognition
