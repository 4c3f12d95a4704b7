#pragma once

#include "geometry/named_file.h"
#include "skinning/import/character_file.h"

#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// --trust-paths, for the whole command: files may name files anywhere.
void trustPaths();

/// Which files a file may name.
[[nodiscard]] PathTrust pathTrust();

/// How character files are read: FBX and COLLADA by a process of this program of their own; Ctrl-C ends it.
/// @param hidden  see CharacterFileSettings
[[nodiscard]] CharacterFileSettings characterFileSettings(std::vector<std::string> hidden = {});

/// The first argument with which this program reads a file for another process of itself, see serveIsolatedReader().
/// Internal: no subcommand that users see.
inline constexpr std::string_view kReadForItself = "--read-character-for-itself";

}  // namespace lorica
