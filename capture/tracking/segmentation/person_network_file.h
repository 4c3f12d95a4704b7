#pragma once

#include <cstdint>
#include <span>

namespace lorica {

/// The bytes of person_network.bin, which the build makes a source file of.
[[nodiscard]] std::span<const std::uint8_t> personNetworkFile();

}  // namespace lorica
