#pragma once

#include "geometry/result.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace lorica {

/// The bytes of .lsession files: a magic word, then blocks, each with kind, length and two checksums that chain it to
/// the block before. Format: docs/SESSIONS.md.
static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

inline constexpr std::string_view kSessionMagic = "LSESSION";
/// Of one block, so that a reader knows what is absurd [bytes].
inline constexpr std::uint32_t kLargestBlock = 64u << 20u;

enum class BlockKind : std::uint32_t { kHeader = 1, kScene = 2, kStep = 3, kEnd = 4 };

/// Puts numbers behind each other.
class ByteWriter {
 public:
  template <typename Number>
  void put(Number number) {
    static_assert(std::is_arithmetic_v<Number>);
    const auto* bytes = reinterpret_cast<const char*>(&number);
    bytes_.append(bytes, sizeof(Number));
  }
  void clear() { bytes_.clear(); }
  [[nodiscard]] std::string_view bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Takes them off again; past the end everything is 0 and ok() false.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  template <typename Number>
  Number get() {
    static_assert(std::is_arithmetic_v<Number>);
    Number number{};
    if (bytes_.size() < sizeof(Number)) {
      ok_ = false;
      bytes_ = {};
      return number;
    }
    std::memcpy(&number, bytes_.data(), sizeof(Number));
    bytes_.remove_prefix(sizeof(Number));
    return number;
  }
  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size(); }

 private:
  std::string_view bytes_;
  bool ok_ = true;
};

/// Appends a block to a file's bytes. @param chain  the checksum of the block before, in and out; 0 at first
void appendBlock(BlockKind kind, std::string_view payload, std::uint64_t& chain, std::string& bytes);

struct Block {
  BlockKind kind = BlockKind::kEnd;
  std::string_view payload;  ///< in the file's bytes
  std::size_t offset = 0;    ///< in the file
};

struct Blocks {
  std::vector<Block> blocks;
  std::size_t cut = 0;  ///< bytes at the end that are the begin of a block which was not written to its end
};

/// All whole blocks of a file. Copies nothing and believes no length before it is checked.
/// @return the blocks, or which bytes are damaged
[[nodiscard]] Result<Blocks> readBlocks(std::string_view bytes, const std::string& name);

}  // namespace lorica
