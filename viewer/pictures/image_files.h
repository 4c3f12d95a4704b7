#pragma once

#include "geometry/files.h"
#include "geometry/result.h"
#include "viewer/renderer/image.h"

#include <filesystem>
#include <span>
#include <string>

namespace lorica {

/// Compressed; the file appears when it is complete.
[[nodiscard]] Result<void> writePng(const std::filesystem::path& file, const Image& image, NamedBy by = NamedBy::kUser);
/// Of any PNG, as 8 bits a channel with opacity.
[[nodiscard]] Result<Image> readPng(const std::filesystem::path& file);

/// Images in rows, each with its label underneath.
[[nodiscard]] Image contactSheet(std::span<const Image> images, std::span<const std::string> labels, int columns);

}  // namespace lorica
