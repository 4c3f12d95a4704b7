#pragma once

#include "geometry/interrupt.h"
#include "geometry/result.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace lorica {

/// Reads the words of a text file line by line, without copying. Lines may end in \n, \r\n or \r alone (the first line
/// decides). If the work is stopped the text ends there: what readers of it return goes through unlessStopped().
/// Internal to the readers of text.
class LineScanner {
 public:
  /// @param comment  a word that starts with this character starts a comment; 0 for a format without comments
  LineScanner(std::string_view text, std::string fileName, char comment);

  /// Advances to the next line that has a word. @return false at the end of the text
  bool nextLine();
  /// Reads the next word of this line; empty at the end of the line.
  std::string_view word();
  /// Reads the rest of this line without leading and trailing blanks; comments are kept.
  std::string_view rest();
  /// Returns whether no word is left on this line.
  [[nodiscard]] bool atLineEnd();

  /// Reads the next word of this line as a finite number or as an integer. @return false if it is not; see error()
  [[nodiscard]] bool real(double& value);
  [[nodiscard]] bool integer(std::int64_t& value);

  /// The error of the last real() or integer().
  /// @param what  the value that was being read, such as "y of vertex 12"
  [[nodiscard]] Error error(std::string_view what) const;
  /// An error with the message "FILE: line 12: message".
  [[nodiscard]] Error fail(std::string_view message) const;
  /// An error with the message "FILE: line 12: the file ends here; message", for a truncated file.
  [[nodiscard]] Error failAtEnd(std::string_view message) const;

  /// Everything after the end of this line.
  [[nodiscard]] std::string_view afterLine() const;
  [[nodiscard]] std::size_t line() const { return line_; }
  /// Bytes not yet read. Limits how many items a count in the file can refer to.
  [[nodiscard]] std::size_t bytesLeft() const { return textEnd_ - cursor_; }

 private:
  void stop() { cursor_ = lineEnd_ = textEnd_; }

  const char* cursor_;
  const char* lineEnd_;
  const char* textEnd_;
  std::size_t line_ = 0;
  std::string fileName_;
  char newline_;
  char comment_;
  std::string_view offending_;
  const char* expected_ = "";
  SparseInterrupt interrupt_;  // of words
};

/// Formats a word for a message: in quotes, unprintable bytes as \x1f, truncated after 40 characters.
[[nodiscard]] std::string quotedWord(std::string_view word);

/// A syntax error of the JSON library as it is reported: "not JSON: " and what(), without the library's error number
/// and with the text that it read last as a quotedWord(), since that may be most of the file.
[[nodiscard]] std::string notJson(std::string_view what);

/// Parses a whole word as a finite number or an integer. A leading + is allowed; a number too small for a double is 0.
/// @return whether the word is such a number
[[nodiscard]] bool parseReal(std::string_view word, double& value);
[[nodiscard]] bool parseInteger(std::string_view word, std::int64_t& value);

}  // namespace lorica
