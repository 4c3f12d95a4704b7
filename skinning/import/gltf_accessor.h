#pragma once

#include "skinning/import/gltf_document.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// Reads accessors after checking all that they refer to. Numbers come as doubles, normalised ones in [-1, 1].
///
/// All accessors together give at most 8 numbers for each byte of the file, and 2 million at least: a file may name
/// the same bytes many times over, or zeros that it need not hold.
class GltfAccessors {
 public:
  explicit GltfAccessors(const GltfDocument& document);

  /// @param accessor    index, not yet checked
  /// @param components  1, 3, 4 or 16 numbers an element; others are refused
  /// @param user        who asks, for the sentence: "mesh 3 'Body', primitive 0: POSITION"
  /// @return count x components finite numbers; or a sentence
  [[nodiscard]] Result<std::vector<double>> numbers(int accessor, int components, const std::string& user);

  /// The same for joints and indices: unsigned integers, as they are.
  [[nodiscard]] Result<std::vector<std::uint32_t>> integers(int accessor, int components, const std::string& user);

  /// As numbers(), but not finite ones are let through, for the caller to mend.
  [[nodiscard]] Result<std::vector<double>> anyNumbers(int accessor, int components, const std::string& user);

 private:
  [[nodiscard]] Result<std::span<const std::byte>> elements(int view, std::uint64_t offset, std::uint64_t count,
                                                            std::uint64_t elementBytes, const std::string& who,
                                                            std::uint64_t& stride) const;
  template <typename Number>
  [[nodiscard]] Result<std::vector<Number>> read(int accessor, int components, const std::string& user,
                                                 bool wantIntegers);
  [[nodiscard]] Error bad(const std::string& what) const;

  const GltfDocument& document_;
  std::uint64_t budget_;
};

/// Fails with a sentence unless 0 <= index < count.
[[nodiscard]] Result<void> checkIndex(const GltfDocument& document, int index, std::size_t count,
                                      const std::string& user, std::string_view kind);

}  // namespace lorica
