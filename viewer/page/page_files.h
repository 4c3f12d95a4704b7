#pragma once

#include "geometry/result.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
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

// What clients may send, see docs/SECURITY.md.
inline constexpr std::uint64_t kMaxSentFile = std::uint64_t{64} << 20;     ///< [bytes]
inline constexpr std::uint64_t kMaxSentFiles = std::uint64_t{1024} << 20;  ///< all that are kept [bytes]

/// Whether clients may open files of this kind. @param ending  without its dot: "bvh"
[[nodiscard]] bool mayBeSent(std::string_view ending);
/// ".glb, .gltf, ...", for sentences.
[[nodiscard]] const std::string& endingsThatMayBeSent();

/// Keeps a file that a client sent: whole or not at all, under a new name, see newDatedFile().
/// @param folder  is for such files alone, and made
/// @return its path; or why not, without the name of the folder
[[nodiscard]] Result<std::string> keepSentFile(const std::filesystem::path& folder, std::string_view ending,
                                               std::string_view bytes);

/// A sentence for clients, without the name of a folder, which is nobody's business.
[[nodiscard]] std::string withoutFolder(std::string sentence, const std::filesystem::path& folder);

}  // namespace lorica
