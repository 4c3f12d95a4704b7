#pragma once

#include <nlohmann/json.hpp>

#include <cstddef>
#include <optional>
#include <span>

namespace lorica {

/// An object's member; null if there is none or `object` is not an object.
[[nodiscard]] const nlohmann::json& memberOf(const nlohmann::json& object, const char* key);

/// A member that is a finite number, else `otherwise`.
[[nodiscard]] float numberOf(const nlohmann::json& object, const char* key, float otherwise);

/// A member that is a whole number from 0 to count - 1.
[[nodiscard]] std::optional<int> indexOf(const nlohmann::json& object, const char* key, std::size_t count);

/// Copies a member that is a list of at least as many finite numbers; else `values` stays unchanged.
void numbersOf(const nlohmann::json& object, const char* key, std::span<float> values);

}  // namespace lorica
