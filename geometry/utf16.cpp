#include "geometry/utf16.h"

#include <cstddef>
#include <cwchar>
#include <locale>

namespace lorica {

std::string asUtf8(std::string bytes) {
  const auto byte = [&](std::size_t at) -> unsigned { return static_cast<unsigned char>(bytes[at]); };
  if (bytes.size() < 2) return bytes;
  const bool little = (byte(0) == 0xff && byte(1) == 0xfe) || (byte(0) != 0 && byte(1) == 0);
  const bool big = (byte(0) == 0xfe && byte(1) == 0xff) || (byte(0) == 0 && byte(1) != 0);
  if (!little && !big) return bytes;
  std::u16string units;
  units.reserve(bytes.size() / 2);
  for (std::size_t at = 0; at + 1 < bytes.size(); at += 2) {
    const unsigned unit = little ? byte(at) | byte(at + 1) << 8 : byte(at) << 8 | byte(at + 1);
    if (at > 0 || unit != 0xfeff) units += static_cast<char16_t>(unit);
  }
  constexpr std::size_t kLongest = 3;  // bytes for a unit; a pair of units takes 4
  std::u8string text(kLongest * units.size(), u8'\0');
  std::mbstate_t state{};
  const char16_t* read = nullptr;
  char8_t* end = text.data();
  // Stops at half a pair of units: such a text is cut there.
  (void)std::use_facet<std::codecvt<char16_t, char8_t, std::mbstate_t>>(std::locale::classic())
      .out(state, units.data(), units.data() + units.size(), read, text.data(), text.data() + text.size(), end);
  return {text.data(), end};
}

}  // namespace lorica
