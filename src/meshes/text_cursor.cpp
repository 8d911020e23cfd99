#include "meshes/text_cursor.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

namespace recognition {
namespace {

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }
bool isDigit(char c) { return c >= '0' && c <= '9'; }

constexpr std::uint64_t kMaxMantissa = 1000000000000000000u;  // further digits count no more
constexpr int kMaxExponent = 400;

double powerOfTen(int exponent) {
  static const double exact[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  return exponent <= 22 ? exact[exponent] : std::pow(10.0, exponent);
}

}  // namespace

bool TextCursor::nextLine(std::string_view* line) {
  if (at_ == end_) return false;
  if (line_end_ == 0) {
    const char* const first = std::find_if(at_, end_, [](char c) { return c == '\n' || c == '\r'; });
    line_end_ = first != end_ && *first == '\r' && first + 1 != end_ && first[1] != '\n' ? '\r' : '\n';
  }
  const char* const stop = std::find(at_, end_, line_end_);
  *line = {at_, static_cast<size_t>(stop - at_)};
  if (!line->empty() && line->back() == '\r') line->remove_suffix(1);
  at_ = stop == end_ ? end_ : stop + 1;
  return true;
}

void TextCursor::skipBlanks() {
  while (at_ != end_ && isBlank(*at_)) ++at_;
}

bool TextCursor::atEnd() {
  skipBlanks();
  return at_ == end_;
}

std::string_view TextCursor::word() {
  skipBlanks();
  const char* const begin = at_;
  while (at_ != end_ && !isBlank(*at_)) ++at_;
  return {begin, static_cast<size_t>(at_ - begin)};
}

std::string_view TextCursor::rest() {
  skipBlanks();
  const char* stop = end_;
  while (stop != at_ && isBlank(stop[-1])) --stop;
  const std::string_view text{at_, static_cast<size_t>(stop - at_)};
  at_ = end_;
  return text;
}

bool TextCursor::take(char c) {
  if (at_ == end_ || *at_ != c) return false;
  ++at_;
  return true;
}

bool TextCursor::integer(std::int64_t* value) {
  skipBlanks();
  const bool negative = take('-');
  if (!negative) take('+');
  if (at_ == end_ || !isDigit(*at_)) return false;
  std::int64_t sum = 0;
  for (; at_ != end_ && isDigit(*at_); ++at_)
    if (sum < std::numeric_limits<std::int64_t>::max() / 16) sum = 10 * sum + (*at_ - '0');
  *value = negative ? -sum : sum;
  return true;
}

bool TextCursor::number(double* value) {
  skipBlanks();
  const bool negative = take('-');
  if (!negative) take('+');
  if (!digits(value) && !special(value)) return false;
  if (negative) *value = -*value;
  return at_ == end_ || isBlank(*at_);
}

bool TextCursor::special(double* value) {
  const std::string name = lowerCase(std::string(word()));
  *value = name == "nan" ? std::numeric_limits<double>::quiet_NaN() : std::numeric_limits<double>::infinity();
  return name == "nan" || name == "inf" || name == "infinity";
}

bool TextCursor::digits(double* value) {
  std::uint64_t mantissa = 0;
  int exponent = 0, count = 0;
  const auto readDigits = [&](int step) {
    for (; at_ != end_ && isDigit(*at_); ++at_, ++count) {
      const bool counts = mantissa < kMaxMantissa;
      if (counts) mantissa = 10 * mantissa + static_cast<std::uint64_t>(*at_ - '0');
      exponent += counts ? step : step + 1;
    }
  };
  readDigits(0);
  if (take('.')) readDigits(-1);
  if (count == 0) return false;
  if (take('e') || take('E')) {
    std::int64_t power = 0;
    if (!integer(&power)) return false;
    exponent += static_cast<int>(std::clamp<std::int64_t>(power, -kMaxExponent, kMaxExponent));
  }
  const double scale = powerOfTen(std::abs(exponent));
  *value = exponent < 0 ? static_cast<double>(mantissa) / scale : static_cast<double>(mantissa) * scale;
  return true;
}

std::string lowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

}  // namespace recognition
