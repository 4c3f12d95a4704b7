#include "capture/files/joint_stream_text.h"

#include "geometry/errors.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <utility>

namespace lorica::joints {
namespace {

/// Longer fields are not meaningful numbers.
constexpr std::size_t kLongestNumber = 60;

bool isDigit(char c) {
  return c >= '0' && c <= '9';
}
bool isLetter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// Strips blanks and quotes around a field.
std::string_view bare(std::string_view field) {
  const auto isPadding = [](char c) {
    return c == ' ' || c == '\t' || c == '"' || c == '\r' || c == '\v' || c == '\f';
  };
  while (!field.empty() && isPadding(field.front())) field.remove_prefix(1);
  while (!field.empty() && isPadding(field.back())) field.remove_suffix(1);
  return field;
}

/// What C, C#, Java, Python and MATLAB write for a missing number.
bool isMissing(std::string_view field) {
  if (field.empty()) return true;
  if (field.size() > 1 && (field[0] == '-' || field[0] == '+')) field.remove_prefix(1);
  constexpr std::array<std::string_view, 15> kMissing = {"nan",      "nan(ind)", "nan(snan)", "inf",    "infinity",
                                                         "null",     "none",     "na",        "n/a",    "1.#ind",
                                                         "1.#ind00", "1.#qnan",  "1.#qnan0",  "1.#inf", "1.#inf00"};
  return std::any_of(kMissing.begin(), kMissing.end(), [&](std::string_view m) { return sameWord(field, m); });
}

bool isUnsignedWhole(std::string_view token) {
  return !token.empty() && std::all_of(token.begin(), token.end(), isDigit);
}
bool isWhole(std::string_view token) {
  if (!token.empty() && (token[0] == '-' || token[0] == '+')) token.remove_prefix(1);
  return isUnsignedWhole(token);
}
/// The digits after a decimal comma, with an optional exponent.
bool isFraction(std::string_view token) {
  const std::size_t e = token.find_first_of("eE");
  if (e == std::string_view::npos) return isUnsignedWhole(token);
  return isUnsignedWhole(token.substr(0, e)) && isWhole(token.substr(e + 1));
}
/// Both and the comma between them.
std::string_view spanning(std::string_view whole, std::string_view fraction) {
  return {whole.data(), fraction.data() + fraction.size()};
}
/// A number that is written without a fraction, or a missing number.
bool isNumberWithoutFraction(std::string_view token) {
  const std::size_t e = token.find_first_of("eE");
  return isMissing(bare(token)) || isWhole(token.substr(0, e));
}

}  // namespace

Delimiter delimiterOf(std::string_view line) {
  if (line.find(';') != std::string_view::npos) return Delimiter::kSemicolon;
  if (line.find('\t') != std::string_view::npos) {
    // Tabs mixed with blanks count as blanks; a tab alone separates fields, which may be empty, and so do tabs between
    // names that hold blanks.
    if (isWord(line.substr(0, line.find('\t')))) return Delimiter::kTab;
    std::size_t begin = 0;
    while (begin <= line.size()) {
      const std::size_t end = std::min(line.find('\t', begin), line.size());
      if (bare(line.substr(begin, end - begin)).find(' ') != std::string_view::npos) return Delimiter::kBlanks;
      begin = end + 1;
    }
    return Delimiter::kTab;
  }
  // "1,5 2,5" has decimal commas, "1, 2" does not.
  const std::size_t comma = line.find(',');
  if (comma == std::string_view::npos) return Delimiter::kBlanks;
  for (std::size_t i = line.find(' '); i != std::string_view::npos; i = line.find(' ', i + 1)) {
    const bool apart = i > 0 && i + 1 < line.size() && line[i - 1] != ',' && line[i - 1] != ' ' && line[i + 1] != ',' &&
                       line[i + 1] != ' ';
    if (apart && isDigit(line[i - 1]) && (isDigit(line[i + 1]) || line[i + 1] == '-')) return Delimiter::kBlanks;
  }
  return Delimiter::kComma;
}

NumberKind readNumber(std::string_view field, double& value) {
  field = bare(field);
  if (parseReal(field, value)) return NumberKind::kNumber;
  if (isMissing(field)) return NumberKind::kMissing;
  const std::size_t comma = field.find(',');
  if (comma == std::string_view::npos || field.size() > kLongestNumber) return NumberKind::kBad;
  std::array<char, kLongestNumber> text;
  std::copy(field.begin(), field.end(), text.begin());
  text[comma] = '.';
  return parseReal({text.data(), field.size()}, value) ? NumberKind::kNumber : NumberKind::kBad;
}

bool isWord(std::string_view field) {
  field = bare(field);
  return !field.empty() && isLetter(field[0]) && !isMissing(field);
}

bool sameWord(std::string_view a, std::string_view b) {
  a = bare(a);
  b = bare(b);
  return a.size() == b.size() &&
         std::equal(a.begin(), a.end(), b.begin(), [](char x, char y) { return lower(x) == lower(y); });
}

std::string plainName(std::string_view name) {
  std::string plain;
  for (const char c : name) {
    if (isLetter(c) || isDigit(c) || static_cast<unsigned char>(c) > 0x7f) plain += lower(c);
  }
  return plain;
}

std::optional<double> readClock(std::string_view field) {
  field = bare(field);
  if (field.size() > kLongestNumber || field.find(':') == std::string_view::npos) return std::nullopt;
  std::string text(field);
  bool afternoon = false, halves = false;
  for (const std::string_view half : {"am", "pm"}) {
    if (text.size() < 2 || !sameWord(std::string_view(text).substr(text.size() - 2), half)) continue;
    halves = true;
    afternoon = half == "pm";
    text.resize(text.size() - 2);
  }
  // The zone is the same in all rows: it does not matter.
  if (const std::size_t zone = text.find_first_of("zZ+"); zone != std::string::npos) text.resize(zone);
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return std::nullopt;  // it was in the zone
  const std::size_t blank = text.substr(0, colon).find_last_of("tT ");
  const std::size_t hours = blank == std::string::npos ? 0 : blank + 1;
  if (const std::size_t zone = text.find('-', colon); zone != std::string::npos) text.resize(zone);
  std::array<double, 3> clock{};  // hours, minutes, seconds
  int parts = 0;
  for (std::size_t begin = hours; parts < 3;) {
    const std::size_t end = parts == 2 ? text.size() : std::min(text.find(':', begin), text.size());
    if (readNumber(std::string_view(text).substr(begin, end - begin), clock[parts++]) != NumberKind::kNumber)
      return std::nullopt;
    if (end == text.size()) break;
    begin = end + 1;
  }
  if (halves) clock[0] = std::fmod(clock[0], 12.0) + (afternoon ? 12.0 : 0.0);
  // "12:34.5" are minutes and seconds.
  double seconds = parts == 3 ? 3600.0 * clock[0] + 60.0 * clock[1] + clock[2] : 60.0 * clock[0] + clock[1];
  double year = 0.0, month = 0.0, day = 0.0;
  const auto number = [&](int begin, int length, double& value) {
    return readNumber(std::string_view(text).substr(begin, length), value) == NumberKind::kNumber;
  };
  if (hours >= 10 && number(0, 4, year) && number(5, 2, month) && number(8, 2, day)) {
    const std::chrono::year_month_day date(std::chrono::year(static_cast<int>(year)),
                                           std::chrono::month(static_cast<unsigned>(month)),
                                           std::chrono::day(static_cast<unsigned>(day)));
    if (!date.ok() || year < 1970.0) return std::nullopt;
    seconds += 86400.0 * static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
  }
  return seconds;
}

RowReader::RowReader(std::string_view text, std::string_view file)
    : scanner_(text, std::string(file), 0),
      file_(file),
      end_(text.data() + text.size()),
      endsWithNewline_(!text.empty() && (text.back() == '\n' || text.back() == '\r')) {}

bool RowReader::next() {
  while (scanner_.nextLine()) {
    const std::string_view line = scanner_.rest();
    if (line.empty() || line[0] == '#') continue;
    if (std::exchange(first_, false)) delimiter_ = delimiterOf(line);
    split(line);
    tabsBehind_ = 0;
    for (const char* c = line.data() + line.size(); c != end_ && (*c == '\t' || *c == ' '); ++c)
      tabsBehind_ += *c == '\t' ? 1 : 0;
    return true;
  }
  return false;
}

void RowReader::split(std::string_view line) {
  fields_.clear();
  if (delimiter_ == Delimiter::kBlanks) {
    constexpr std::string_view kBlanks = " \t\v\f\r";
    for (std::size_t begin = line.find_first_not_of(kBlanks); begin != std::string_view::npos;) {
      const std::size_t end = std::min(line.find_first_of(kBlanks, begin), line.size());
      fields_.push_back(line.substr(begin, end - begin));
      begin = line.find_first_not_of(kBlanks, end);
    }
    return;
  }
  const char delimiter = delimiter_ == Delimiter::kTab ? '\t' : delimiter_ == Delimiter::kComma ? ',' : ';';
  for (std::size_t begin = 0;;) {
    const std::size_t end = std::min(line.find(delimiter, begin), line.size());
    fields_.push_back(bare(line.substr(begin, end - begin)));
    if (end == line.size()) return;
    begin = end + 1;
  }
}

bool RowReader::fit(int count) {
  if (countOf(fields_) == count) return true;
  if (delimiter_ == Delimiter::kTab && countOf(fields_) < count && countOf(fields_) + tabsBehind_ >= count)
    fields_.resize(count);
  const auto withoutLast = [&](int n) { return countOf(fields_) == n + 1 && fields_.back().empty(); };
  if (withoutLast(count) || withoutLast(2 * count)) fields_.pop_back();
  if (countOf(fields_) == count) return true;
  if (delimiter_ != Delimiter::kComma || countOf(fields_) != 2 * count) return false;
  for (int i = 0; i < 2 * count; i += 2) {
    if (!isWhole(fields_[i]) || !isFraction(fields_[i + 1])) return false;
  }
  for (int i = 0; i < count; ++i) fields_[i] = spanning(fields_[2 * i], fields_[2 * i + 1]);
  fields_.resize(count);
  return true;
}

bool RowReader::cutOff() const {
  return !endsWithNewline_ && scanner_.bytesLeft() == 0;
}

Error RowReader::badCount(std::string_view expected) const {
  return fail(fmt::format("found {} fields, expected {}", fields_.size(), expected));
}

Error RowReader::badField(int column, std::string_view name, std::string_view expected) const {
  const std::string_view found = column < countOf(fields_) ? fields_[column] : std::string_view{};
  return badFormat("{}, line {}, column {} ({}): found {}, expected {}", file_, line(), column + 1, name,
                   quotedWord(found), expected);
}

Error RowReader::fail(std::string_view foundAndExpected) const {
  return badFormat("{}, line {}: {}", file_, line(), foundAndExpected);
}

Result<double> RowReader::number(int column, std::string_view name, double largest) const {
  double value = 0.0;
  if (readNumber(fields_[column], value) != NumberKind::kNumber) return badField(column, name, "a number");
  if (!(std::abs(value) <= largest)) {
    return badField(column, name, fmt::format("a number within +-{:g}", largest));
  }
  return value;
}

namespace {

constexpr int kMaxJoined = 16;   // numbers of one run
constexpr int kNoWay = 1 << 20;  // a cost beyond all others
constexpr int kOfPose = 7;       // numbers of a position and a quaternion, which are judged together

/// One number of a run, joined of two fields or one field alone.
struct Joined {
  std::string_view text;
  double value = 0.0;
  int cost = kNoWay;  // how unlike a coordinate or a component of a quaternion it is
};

Joined joinedAt(std::span<const std::string_view> tokens, int n, int token, bool joined) {
  Joined number;
  if (token + (joined ? 1 : 0) >= countOf(tokens)) return number;
  const std::string_view whole = tokens[token];
  int cost = 0;
  number.text = whole;
  if (joined) {
    const std::string_view fraction = tokens[token + 1];
    if (!isWhole(whole) || !isFraction(fraction)) return number;
    number.text = spanning(whole, fraction);
    if (fraction.find_first_not_of('0') == std::string_view::npos) cost += 5;  // "1,0" would be written "1"
  } else {
    if (!isNumberWithoutFraction(whole)) return number;
    if (whole != "0" && !isMissing(whole)) cost += 1;
  }
  const NumberKind kind = readNumber(number.text, number.value);
  if (kind == NumberKind::kBad) return number;
  if (kind == NumberKind::kMissing) number.value = 0.0;
  if (std::abs(number.value) > (n < 3 ? 10.0 : 1.001)) cost += 10;
  number.cost = cost;
  return number;
}

/// The way to join a position and a quaternion whose cost is least, of all; bit n - 1 - i is of number i.
std::pair<int, unsigned> joinedPose(std::span<const std::string_view> tokens, int joins) {
  std::pair<int, unsigned> best{kNoWay, 0};
  for (unsigned mask = 1u << kOfPose; mask-- > 0;) {
    if (std::popcount(mask) != joins) continue;
    int cost = 0, token = 0;
    double lengthSq = 0.0;
    for (int n = 0; n < kOfPose && cost < best.first; ++n) {
      const bool joined = (mask >> (kOfPose - 1 - n) & 1u) != 0;
      const Joined number = joinedAt(tokens, n, token, joined);
      token += joined ? 2 : 1;
      cost += number.cost;
      if (n >= 3) lengthSq += number.value * number.value;
    }
    if (lengthSq != 0.0 && std::abs(std::sqrt(lengthSq) - 1.0) > 0.01) cost += 100;
    if (cost < best.first) best = {cost, mask};
  }
  return best;
}

/// The same of any numbers, each judged alone: the work grows with their square.
std::pair<int, unsigned> joinedNumbers(std::span<const std::string_view> tokens, int count, int joins) {
  // least[n][j]: of the numbers from n on, if j before them were joined; and whether number n is then joined.
  std::array<std::array<int, kMaxJoined + 2>, kMaxJoined + 1> least{};
  std::array<std::array<bool, kMaxJoined + 2>, kMaxJoined + 1> joined{};
  for (int j = 0; j <= joins + 1; ++j) least[count][j] = j == joins ? 0 : kNoWay;
  for (int n = count; n-- > 0;) {
    least[n][joins + 1] = kNoWay;
    for (int j = 0; j <= std::min(joins, n); ++j) {
      const int two = joinedAt(tokens, n, n + j, true).cost + least[n + 1][j + 1];
      const int one = joinedAt(tokens, n, n + j, false).cost + least[n + 1][j];
      joined[n][j] = two <= one;
      least[n][j] = std::min({two, one, kNoWay});
    }
  }
  unsigned mask = 0;
  for (int n = 0, j = 0; n < count; ++n) {
    mask = mask << 1 | (joined[n][j] ? 1u : 0u);
    j += joined[n][j] ? 1 : 0;
  }
  return {least[0][0], mask};
}

}  // namespace

std::optional<std::vector<std::string_view>> joinDecimalCommas(std::span<const std::string_view> tokens, int count) {
  const int joins = countOf(tokens) - count;
  if (count == 0 || count > kMaxJoined || joins < 0 || joins > count) return std::nullopt;
  // On a tie the first numbers get the fractions.
  const auto [cost, mask] = count == kOfPose ? joinedPose(tokens, joins) : joinedNumbers(tokens, count, joins);
  if (cost >= kNoWay) return std::nullopt;
  std::vector<std::string_view> numbers;
  for (int n = 0, token = 0; n < count; ++n) {
    const bool joined = (mask >> (count - 1 - n) & 1u) != 0;
    numbers.push_back(joined ? spanning(tokens[token], tokens[token + 1]) : tokens[token]);
    token += joined ? 2 : 1;
  }
  return numbers;
}

}  // namespace lorica::joints
