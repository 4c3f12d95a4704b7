#include "skinning/import/json_values.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lorica {

namespace {

using Json = nlohmann::json;

[[nodiscard]] bool isFinite(const Json& value) {
  return value.is_number() && std::isfinite(value.get<float>());
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
  return isFinite(value) ? value.get<float>() : otherwise;
}

std::optional<int> indexOf(const Json& object, const char* key, std::size_t count) {
  const Json& value = memberOf(object, key);
  if (!value.is_number_integer()) return std::nullopt;
  const auto index = value.get<std::int64_t>();
  if (index < 0 || index >= static_cast<std::int64_t>(count)) return std::nullopt;
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

}  // namespace lorica
