#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace lorica {

/// A file of the page, as it was built into the program.
struct PageFile {
  std::string_view path;  ///< "/page.js"
  std::string_view type;  ///< of its content
  std::span<const std::uint8_t> bytes;
};

/// The file that a client asks for; null if there is none. Without a page that was built, "/" says how to get it.
[[nodiscard]] const PageFile* pageFile(std::string_view path);

/// Whether the page was built.
[[nodiscard]] bool pageBuilt();

}  // namespace lorica
