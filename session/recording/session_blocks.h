#pragma once

#include "geometry/result.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// The bytes of .lsession files: a magic word, then blocks, each with kind, length and two checksums that chain it to
/// the previous block. Format: docs/SESSIONS.md.
static_assert(std::endian::native == std::endian::little, "session files are little-endian");

inline constexpr std::string_view kSessionMagic = "LSESSION";
/// Maximum size of a block, to detect invalid lengths [bytes].
inline constexpr std::uint32_t kLargestBlock = 64u << 20u;

enum class BlockKind : std::uint32_t { kHeader = 1, kScene = 2, kStep = 3, kEnd = 4 };

/// Appends a block to a file's bytes. @param chain  checksum of the previous block, input and output; initially 0
void appendBlock(BlockKind kind, std::string_view payload, std::uint64_t& chain, std::string& bytes);

struct Block {
  BlockKind kind = BlockKind::kEnd;
  std::string_view payload;  ///< in the file's bytes
  std::size_t offset = 0;    ///< in the file
};

struct Blocks {
  std::vector<Block> blocks;
  std::size_t cut = 0;  ///< number of bytes of an incomplete block at the end
};

/// Reads all complete blocks of a file. Copies nothing; lengths are checked before they are used.
/// @return the blocks, or an error with the position of damaged bytes
[[nodiscard]] Result<Blocks> readBlocks(std::string_view bytes, const std::string& name);

}  // namespace lorica
