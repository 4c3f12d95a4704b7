#pragma once

#include "geometry/result.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace lorica {

/// Walks the words of a text file line by line, without copying. Ends of lines may be \n, \r\n or \r alone
/// (the first line decides).
/// Internal to the mesh files.
class LineScanner {
 public:
  /// @param comment  a word that starts with this character ends its line; 0 for a format without comments
  LineScanner(std::string_view text, std::string fileName, char comment);

  /// Goes to the next line that has a word. @return false at the end of the text
  bool nextLine();
  /// Next word of this line; empty at its end.
  std::string_view word();
  /// Rest of this line, blanks trimmed on both ends; a comment is not cut off.
  std::string_view rest();
  /// No word is left on this line.
  [[nodiscard]] bool atLineEnd();

  /// Next word of this line as a finite number or an integer. @return false when it is not: error() tells
  [[nodiscard]] bool real(double& value);
  [[nodiscard]] bool integer(std::int64_t& value);

  /// What the last real() or integer() found wrong, with what was read as in "y of vertex 12".
  [[nodiscard]] Error error(std::string_view what) const;
  /// "FILE: line 12: message".
  [[nodiscard]] Error fail(std::string_view message) const;
  /// "FILE: line 12: the file ends here; message", for a file that stops too soon.
  [[nodiscard]] Error failAtEnd(std::string_view message) const;

  /// Everything after this line's end.
  [[nodiscard]] std::string_view afterLine() const;
  [[nodiscard]] std::size_t line() const { return line_; }
  /// Bytes not yet walked: an upper bound for anything that a count in the file can promise.
  [[nodiscard]] std::size_t bytesLeft() const { return static_cast<std::size_t>(textEnd_ - cursor_); }

 private:
  const char* cursor_;
  const char* lineEnd_;
  const char* textEnd_;
  std::size_t line_ = 0;
  std::string fileName_;
  char newline_;
  char comment_;
  std::string_view offending_;
  const char* expected_ = "";
};

/// A word for a sentence: in quotes, unprintable bytes as \x1f, cut after 40 characters.
[[nodiscard]] std::string quotedWord(std::string_view word);

/// Whole word as a finite number; a leading + is allowed, and what is too small for a double is 0.
[[nodiscard]] bool parseReal(std::string_view word, double& value);
[[nodiscard]] bool parseInteger(std::string_view word, std::int64_t& value);

}  // namespace lorica
