#pragma once

#include "skinning/clip.h"
#include "skinning/import/gltf_document.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// The keys of an animation's sampler.
struct GltfKeys {
  KeyInterpolation interpolation = KeyInterpolation::kLinear;
  std::vector<double> times;
  std::vector<double> values;
  [[nodiscard]] std::size_t listsPerKey() const { return interpolation == KeyInterpolation::kCubicSpline ? 3 : 1; }
};

/// Reads accessors after checking everything that they refer to. Numbers are returned as doubles, normalised ones in
/// [-1, 1].
///
/// All accessors together may return at most `numbersPerByte` numbers per byte of the file, or 250,000 times as many if
/// that is more: a file may refer to the same bytes many times, or to zeros that it does not store.
class GltfAccessors {
 public:
  explicit GltfAccessors(const GltfDocument& document, std::uint64_t numbersPerByte = 8);

  /// @param accessor    index, not yet checked
  /// @param components  1, 2, 3, 4 or 16 numbers per element; others are rejected
  /// @param user        who reads it, for messages: "mesh 3 'Body', primitive 0: POSITION"
  /// @return count x components finite numbers; or an error
  [[nodiscard]] Result<std::vector<double>> numbers(int accessor, int components, const std::string& user);

  /// The same for joints and indices: unsigned integers, unchanged.
  [[nodiscard]] Result<std::vector<std::uint32_t>> integers(int accessor, int components, const std::string& user);

  /// Like numbers(), but non-finite numbers are allowed, for the caller to repair.
  [[nodiscard]] Result<std::vector<double>> anyNumbers(int accessor, int components, const std::string& user);

  /// @param sampler  index, not yet checked. @param components  of a value
  /// @return the sampler's content; the number of values is not yet checked
  [[nodiscard]] Result<GltfKeys> keys(const tinygltf::Animation& animation, int sampler, int components,
                                      const std::string& user);

  /// Takes numbers that a caller keeps beside those that it read from the same limit. @return false if it is exhausted
  [[nodiscard]] bool spend(std::uint64_t numbers);

 private:
  [[nodiscard]] Result<std::span<const std::byte>> elements(int view, std::uint64_t offset, std::uint64_t count,
                                                            std::uint64_t elementBytes, const std::string& who,
                                                            std::uint64_t& stride) const;
  template <typename Number>
  [[nodiscard]] Result<std::vector<Number>> read(int accessor, int components, const std::string& user);

  const GltfDocument& document_;
  std::uint64_t budget_;
};

/// Returns an error unless 0 <= index < count.
[[nodiscard]] Result<void> checkIndex(const GltfDocument& document, int index, std::size_t count,
                                      const std::string& user, std::string_view kind);

}  // namespace lorica
