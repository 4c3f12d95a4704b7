#pragma once

#include "geometry/files.h"
#include "geometry/new_file.h"
#include "geometry/result.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Arrays of numpy: a file with one (.npy), and archives of them (.npz). Internal: not installed.
namespace lorica {

/// Limit of a file, and of all that is unpacked of one [bytes].
inline constexpr std::uint64_t kMaxArrayBytes = std::uint64_t{1} << 30;

struct NamedArray {
  std::string name;                ///< "depth"
  std::string type;                ///< of its elements, as numpy writes it: "<f4"
  std::vector<std::size_t> shape;  ///< none: a single element
  std::string bytes;               ///< little-endian, the last index runs fastest
};

/// Reads all arrays of an .npz, or the one of a .npy, which has the file's name. Elements are numbers, truth values and
/// text, little-endian and in C order; those of Python's objects are left out, since reading them runs code.
/// @return at least one, or an error that says what else was found
[[nodiscard]] Result<std::vector<NamedArray>> readArrays(const std::filesystem::path& file,
                                                         NamedBy by = NamedBy::kUser);

/// The names of an .npz's arrays, without reading them; none of what is no such file.
[[nodiscard]] std::vector<std::string> arrayNames(const std::filesystem::path& file);

/// The same for bytes in memory.
/// @param file  named in errors
/// @param most  that is unpacked [bytes]
[[nodiscard]] Result<std::vector<NamedArray>> parseArrays(std::string_view bytes, const std::filesystem::path& file,
                                                          std::uint64_t most = kMaxArrayBytes);

/// The elements of an array of float32 or float64, or of whole numbers of 1 to 8 bytes; an error names the array.
[[nodiscard]] Result<std::vector<double>> numbersOf(const NamedArray& array);

/// Writes an .npz that is not compressed. The same arrays give the same bytes.
[[nodiscard]] Result<void> writeArrays(std::span<const NamedArray> arrays, NewFile& file);

}  // namespace lorica
