#pragma once

#include "geometry/named_file.h"
#include "skinning/import/assimp_file.h"
#include "skinning/import/isolated_reader.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace lorica {

/// What the process that reads a file may use.
struct IsolationLimits {
  std::uint64_t cpuSeconds = 0;
  std::uint64_t memoryBytes = 0;  ///< beside the program itself; the result may have as many bytes
  std::uint64_t stackBytes = 0;
};

/// The limits for a file of this size.
[[nodiscard]] IsolationLimits isolationLimits(std::uint64_t fileBytes);

/// readAssimpScene() in another process.
[[nodiscard]] Result<FileScene> readIsolatedScene(std::span<const std::byte> bytes, const std::string& name,
                                                  AssimpFormat format, const NamedFiles& files,
                                                  const IsolatedReader& reader);

}  // namespace lorica
