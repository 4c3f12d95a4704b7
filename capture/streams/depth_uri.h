#pragma once

#include <string_view>

namespace lorica {

// What libLoricaSensor.so.0 and those who load it agree on.
inline constexpr std::string_view kSentUri = "lorica://depth/";  ///< and an address as of DepthStreamSettings::at
inline constexpr const char* kSentVariable = "LORICA_DEPTH";     ///< such an address: that camera instead of people
inline constexpr const char* kSentFormatVariable = "LORICA_DEPTH_FORMAT";  ///< of bare images, see parseBareDepth()

}  // namespace lorica
