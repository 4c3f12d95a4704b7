#include "skinning/import/json_values.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lorica {
namespace {

using Json = nlohmann::json;

[[nodiscard]] bool isFiniteNumber(const Json& value) {
  return value.is_number() && std::isfinite(value.get<float>());
}

/// Whether it is a list that begins with so many finite numbers.
[[nodiscard]] bool hasNumbers(const Json& list, std::size_t count) {
  return list.is_array() && list.size() >= count && std::all_of(list.begin(), list.begin() + count, isFiniteNumber);
}

}  // namespace

const Json& memberOf(const Json& object, const char* key) {
  static const Json kNull;
  if (!object.is_object()) return kNull;
  const auto found = object.find(key);
  return found == object.end() ? kNull : *found;
}

float numberOf(const Json& object, const char* key, float otherwise) {
  const Json& value = memberOf(object, key);
  return isFiniteNumber(value) ? value.get<float>() : otherwise;
}

std::optional<int> indexIn(const Json& index, std::size_t count) {
  if (!index.is_number_integer()) return std::nullopt;
  const auto value = index.get<std::int64_t>();
  if (value < 0 || std::cmp_greater_equal(value, count)) return std::nullopt;
  return static_cast<int>(value);
}

std::optional<int> indexOf(const Json& object, const char* key, std::size_t count) {
  return indexIn(memberOf(object, key), count);
}

std::string textOf(const Json& object, const char* key) {
  const Json& value = memberOf(object, key);
  return value.is_string() ? value.get<std::string>() : std::string();
}

const Json& listOf(const Json& object, const char* key) {
  static const Json kEmpty = Json::array();
  const Json& list = memberOf(object, key);
  return list.is_array() ? list : kEmpty;
}

void numbersOf(const Json& object, const char* key, std::span<float> values) {
  const Json& list = memberOf(object, key);
  if (!hasNumbers(list, values.size())) return;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = list[i].get<float>();
}

float MemberReader::number(const Json& object, const char* key, float otherwise) {
  if (!isFiniteNumber(memberOf(object, key))) note(object, key, "a number");
  return numberOf(object, key, otherwise);
}

void MemberReader::numbers(const Json& object, const char* key, std::span<float> values) {
  if (!hasNumbers(memberOf(object, key), values.size())) note(object, key, counted(std::ssize(values), "number"));
  numbersOf(object, key, values);
}

bool MemberReader::flag(const Json& object, const char* key) {
  const Json& value = memberOf(object, key);
  if (!value.is_boolean()) note(object, key, "true or false");
  return value == true;
}

std::size_t MemberReader::word(const Json& object, const char* key, std::span<const char* const> words) {
  const Json& value = memberOf(object, key);
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (value == words[i]) return i;
  }
  note(object, key, fmt::format("{}", fmt::join(words, ", ")));
  return 0;
}

void MemberReader::note(const Json& object, const char* key, const std::string& expected) {
  if (memberOf(object, key).is_null()) return;
  if (broken_++ == 0) first_ = fmt::format("{} is not as expected, {}", key, expected);
}

std::string MemberReader::complaint() const {
  if (broken_ == 0) return {};
  if (broken_ == 1) return first_ + ": its default is used";
  return fmt::format("{}, and {} other members: their defaults are used", first_, broken_ - 1);
}

}  // namespace lorica
