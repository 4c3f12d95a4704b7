#pragma once

#include "skinning/body/closed_body.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace lorica {

/// Increase this when makeBody() gives another body for the same character, or when encodeBody() writes other bytes, so
/// that caches written by older versions are not used.
inline constexpr std::uint32_t kBodyVersion = 2;

/// A body as bytes, for caches: its surface, weights and figures. The character's own vertices are not among them.
/// @param body  made, without positions that morph targets reach
/// @param key   of what it was made from, such as a hash of the character and the settings
[[nodiscard]] std::string encodeBody(const ClosedBody& body, std::uint64_t key);

/// The body of a character from its bytes, bit for bit as it was made.
///
/// The bytes may come from anybody: every number is checked, the surface must be a closed two-manifold near the
/// character, and weights must refer to its joints and sum to 1.
/// @param character  the one that the body was made from
/// @param name       of the file, for messages
/// @return the body; or an error that says what was found where, also if the key is another one
[[nodiscard]] Result<ClosedBody> decodeBody(std::string_view bytes, const Character& character, std::uint64_t key,
                                            const std::string& name);

}  // namespace lorica
