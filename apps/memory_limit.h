#pragma once

#include "apps/command_line.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace lorica {

/// "8G" as bytes, with the units of Slurm: K, M, G, T are powers of 1024.
[[nodiscard]] std::optional<std::uint64_t> bytesIn(const std::string& text);

/// Accepts what bytesIn() knows, from a number of megabytes on.
[[nodiscard]] TextCheck memorySize(std::uint64_t leastMegabytes = 0);

/// What a command may take that has no --memory: 2 GB, or 200 bytes for each byte of the files that it names, if that
/// is more. Files beside a .gltf count with it.
/// @param words  of the command line
[[nodiscard]] std::uint64_t usualMemory(std::span<const std::string> words);

/// Lets this process allocate no more than that; a lower limit that it was started with stays. Where memory is missing
/// from now on, it ends with a sentence and exit status 2, whatever thread it is in: temporary files are removed, and
/// recordings are finished, as at a hard stop.
/// @param threads  whose stacks are on top of it
void limitMemory(std::uint64_t bytes, int threads);

/// Ends the program as above.
[[noreturn]] void endWithoutMemory() noexcept;

}  // namespace lorica
