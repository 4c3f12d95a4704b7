#include "skinning/import/json_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lorica {
namespace {

using Json = nlohmann::json;

[[nodiscard]] bool isFinite(const Json& value) {
  return value.is_number() && std::isfinite(value.get<float>());
}

}  // namespace

void VrmValues::addFault(const std::string& kind, const std::string& sentence) {
  const auto found =
      std::find_if(faults_.begin(), faults_.end(), [&](const Fault& fault) { return fault.kind == kind; });
  if (found != faults_.end()) {
    ++found->count;
  } else {
    faults_.push_back({kind, sentence});
  }
}

void VrmValues::writeFaultsTo(std::vector<std::string>& notes) const {
  for (const Fault& fault : faults_) {
    notes.push_back(fault.count == 1
                        ? "springs: " + fault.sentence
                        : fmt::format("springs: {} ({} more of this kind)", fault.sentence, grouped(fault.count - 1)));
  }
}

const Json& VrmValues::listOf(const Json& object, const char* key) {
  static const Json kEmpty = Json::array();
  const Json& list = memberOf(object, key);
  return list.is_array() ? list : kEmpty;
}

std::optional<int> VrmValues::indexIn(const Json& index, std::size_t count) {
  if (!index.is_number_integer()) return std::nullopt;
  const auto value = index.get<std::int64_t>();
  if (value < 0 || std::cmp_greater_equal(value, count)) return std::nullopt;
  return static_cast<int>(value);
}
std::optional<int> VrmValues::nodeIn(const Json& index, const std::string& who) {
  const std::optional<int> node = indexIn(index, scene_.nodes.size());
  if (!node) addFault("node", fmt::format("{} refers to node {}, which does not exist: skipped", who, shown(index)));
  return node;
}
std::string VrmValues::shown(const Json& value) {
  return value.is_structured() ? std::string(value.type_name()) : value.dump().substr(0, 24);
}

double VrmValues::number(const Json& object, const char* key, double otherwise, double min, double max,
                         const std::string& who) {
  const Json& value = memberOf(object, key);
  if (value.is_null()) return otherwise;
  const double given = value.is_number() ? value.get<double>() : kInfinity;
  if (given >= min && given <= max) return given;
  const double used = value.is_number() && !std::isnan(given) ? std::clamp(given, min, max) : otherwise;
  addFault("number",
           fmt::format("{}: {} is {}, expected {} to {}: {} is used", who, key, shown(value), min, max, used));
  return used;
}

Vec3 VrmValues::vectorOf(const Json& list, const char* key, const Vec3& otherwise, const std::string& who) {
  const Json& value = memberOf(list, key);
  if (value.is_null()) return otherwise;
  Vec3 v = otherwise;
  bool sound = value.is_array() && value.size() == 3;
  for (int i = 0; i < 3 && sound; ++i) {
    sound = value[i].is_number();
    if (sound) v[i] = value[i].get<double>();
  }
  if (sound && v.cwiseAbs().maxCoeff() <= kLargestNumber) return v;
  addFault("vector", fmt::format("{}: {} is not three numbers of at most {:g}: ignored", who, key, kLargestNumber));
  return otherwise;
}

Vec3 VrmValues::unityVectorOf(const Json& object, const char* key, const Vec3& otherwise, const std::string& who) {
  const Json& value = memberOf(object, key);
  if (value.is_null()) return otherwise;
  const auto part = [&](const char* axis) { return number(value, axis, 0.0, -kLargestNumber, kLargestNumber, who); };
  return {part("x"), part("y"), -part("z")};
}

const Json& memberOf(const Json& object, const char* key) {
  static const Json kNull;
  if (!object.is_object()) return kNull;
  const auto found = object.find(key);
  return found == object.end() ? kNull : *found;
}

float numberOf(const Json& object, const char* key, float otherwise) {
  const Json& value = memberOf(object, key);
  return isFinite(value) ? value.get<float>() : otherwise;
}

std::optional<int> indexOf(const Json& object, const char* key, std::size_t count) {
  const Json& value = memberOf(object, key);
  if (!value.is_number_integer()) return std::nullopt;
  const auto index = value.get<std::int64_t>();
  if (index < 0 || std::cmp_greater_equal(index, count)) return std::nullopt;
  return static_cast<int>(index);
}

void numbersOf(const Json& object, const char* key, std::span<float> values) {
  const Json& list = memberOf(object, key);
  if (!list.is_array() || list.size() < values.size()) return;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!isFinite(list[i])) return;
  }
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = list[i].get<float>();
}

float MemberReader::number(const Json& object, const char* key, float otherwise) {
  if (!isFinite(memberOf(object, key))) note(object, key, "a number");
  return numberOf(object, key, otherwise);
}

void MemberReader::numbers(const Json& object, const char* key, std::span<float> values) {
  const Json& list = memberOf(object, key);
  if (!list.is_array() || list.size() < values.size() ||
      !std::all_of(list.begin(), list.begin() + values.size(), isFinite)) {
    note(object, key, fmt::format("{} numbers", values.size()));
  }
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
