#pragma once

#include <cstddef>
#include <cstdint>

namespace lorica {

// What a file, a packet or an option can ask for at most. Each is checked before the work, and a larger one is refused
// with a sentence; docs/SECURITY.md has them as a table. Limits of a format's own size stay with its reader.

// Options, and the arguments of C and Python.
inline constexpr int kMaxThreads = 1024;
inline constexpr int kMaxOfAnything = 1'000'000;  ///< parts, vertices of a hull, frames, pictures

}  // namespace lorica
