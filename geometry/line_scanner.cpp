#include "geometry/line_scanner.h"

#include "geometry/errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

namespace lorica {

namespace {

bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/// std::from_chars rejects a plus sign. Both "+-1" and "+" alone must stay invalid.
std::string_view withoutPlus(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  return word;
}

}  // namespace

LineScanner::LineScanner(std::string_view text, std::string fileName, char comment)
    : fileName_(std::move(fileName)), comment_(comment) {
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);  // byte order mark written by some editors
  // Only the first line is examined: the rest may be binary.
  const std::size_t end = text.find_first_of("\r\n");
  newline_ = end != std::string_view::npos && text[end] == '\r' && text.substr(end + 1, 1) != "\n" ? '\r' : '\n';
  cursor_ = lineEnd_ = text.data();
  textEnd_ = text.data() + text.size();
}

bool LineScanner::nextLine() {
  while (true) {
    if (line_ > 0 && lineEnd_ == textEnd_) return false;
    cursor_ = line_ == 0 ? lineEnd_ : lineEnd_ + 1;
    const void* end = cursor_ == textEnd_ ? nullptr : std::memchr(cursor_, newline_, textEnd_ - cursor_);
    lineEnd_ = end == nullptr ? textEnd_ : static_cast<const char*>(end);
    ++line_;
    if (workStopped()) stop();
    if (!atLineEnd()) return true;
  }
}

bool LineScanner::atLineEnd() {
  while (cursor_ != lineEnd_ && isBlank(*cursor_)) ++cursor_;
  if (cursor_ != lineEnd_ && comment_ != 0 && *cursor_ == comment_) cursor_ = lineEnd_;
  return cursor_ == lineEnd_;
}

std::string_view LineScanner::word() {
  if (interrupt_.stopped()) stop();
  if (atLineEnd()) return {};
  const char* begin = cursor_;
  while (cursor_ != lineEnd_ && !isBlank(*cursor_)) ++cursor_;
  return {begin, cursor_};
}

std::string_view LineScanner::rest() {
  while (cursor_ != lineEnd_ && isBlank(*cursor_)) ++cursor_;
  const char* begin = cursor_;
  const char* end = lineEnd_;
  while (end != begin && isBlank(end[-1])) --end;
  cursor_ = lineEnd_;
  return {begin, end};
}

bool LineScanner::real(double& value) {
  offending_ = word();
  expected_ = "a finite number";
  return parseReal(offending_, value);
}

bool LineScanner::integer(std::int64_t& value) {
  offending_ = word();
  expected_ = "an integer";
  return parseInteger(offending_, value);
}

Error LineScanner::error(std::string_view what) const {
  if (offending_.empty()) return fail(fmt::format("the line ends before {}, expected {}", what, expected_));
  return fail(fmt::format("{} is {}, expected {}", what, quotedWord(offending_), expected_));
}

Error LineScanner::fail(std::string_view message) const {
  return badFormat("{}: line {}: {}", fileName_, line_, message);
}

Error LineScanner::failAtEnd(std::string_view message) const {
  return badFormat("{}: line {}: the file ends here; {}", fileName_, line_, message);
}

std::string_view LineScanner::afterLine() const {
  if (lineEnd_ == textEnd_) return {};
  return {lineEnd_ + 1, textEnd_};
}

std::string quotedWord(std::string_view word) {
  std::string text = "'";
  for (const char c : word.substr(0, 40)) {
    const unsigned char byte = c;
    if (byte < 0x20 || byte >= 0x7f) {
      text += fmt::format("\\x{:02x}", byte);
    } else {
      text += c;
    }
  }
  return text + (word.size() > 40 ? "...'" : "'");
}

std::string notJson(std::string_view what) {
  if (const std::size_t bracket = what.find("] "); bracket != std::string_view::npos) what.remove_prefix(bracket + 2);
  constexpr std::string_view kBefore = "last read: '", kAfter = "'; expected ";
  const std::size_t before = what.find(kBefore);
  if (before == std::string_view::npos) return fmt::format("not JSON: {}", what);
  const std::size_t word = before + kBefore.size();
  std::size_t end = what.rfind(kAfter);
  if (end == std::string_view::npos || end < word) end = std::max(word, what.size() - 1);
  return fmt::format("not JSON: {}{}{}", what.substr(0, word - 1), quotedWord(what.substr(word, end - word)),
                     what.substr(std::min(what.size(), end + 1)));
}

bool parseReal(std::string_view word, double& value) {
  word = withoutPlus(word);
  const char* end = word.data() + word.size();
  const auto [stop, problem] = std::from_chars(word.data(), end, value);
  if (stop != end || word.empty()) return false;
  if (problem == std::errc::result_out_of_range && word.find_first_of("eE") != std::string_view::npos &&
      word.find_first_of("eE") + 1 == word.rfind('-')) {
    value = 0.0;
    return true;
  }
  return problem == std::errc() && std::isfinite(value);
}

bool parseInteger(std::string_view word, std::int64_t& value) {
  word = withoutPlus(word);
  const char* end = word.data() + word.size();
  const auto [stop, problem] = std::from_chars(word.data(), end, value);
  return problem == std::errc() && stop == end && !word.empty();
}

}  // namespace lorica
