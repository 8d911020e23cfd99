#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace recognition {

/// Goes through a text in memory: lines, words, numbers; fast, and the same in every locale.
class TextCursor {
 public:
  explicit TextCursor(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {}

  /// The next line without its end (LF, CR LF, or CR where the first line ends so); false behind the last one.
  bool nextLine(std::string_view* line);

  /// The next word; empty at the end.
  std::string_view word();

  /// The next word as a number; false if there is none, or it is no number. What follows a word's number is no number.
  bool number(double* value);

  /// The next digits, with a sign in front; false if there are none. Stops behind them, within a word too.
  bool integer(std::int64_t* value);

  /// Takes one character if it is the next one.
  bool take(char c);

  /// All that is left, without blanks around it.
  std::string_view rest();

  bool atEnd();
  const char* position() const { return at_; }

 private:
  void skipBlanks();
  bool special(double* value);
  bool digits(double* value);

  const char* at_;
  const char* end_;
  char line_end_ = 0;  // of this text; 0: not known yet
};

std::string lowerCase(std::string text);

}  // namespace recognition
