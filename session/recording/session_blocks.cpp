#include "session/recording/session_blocks.h"

#include "geometry/byte_reader.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/interrupt.h"

#include <fmt/format.h>

namespace lorica {
namespace {

// Layout of a block: kind and length, their checksum, the payload, its checksum.
constexpr std::size_t kHeadBytes = 2 * sizeof(std::uint32_t);
constexpr std::size_t kCheckBytes = sizeof(std::uint64_t);

std::uint64_t checkOf(std::string_view bytes, std::uint64_t chain) {
  return contentHash(bytes, chain);
}

}  // namespace

void appendBlock(BlockKind kind, std::string_view payload, std::uint64_t& chain, std::string& bytes) {
  LORICA_CHECK(payload.size() <= kLargestBlock, "the payload of a block is too large");
  const auto put = [&](const auto& number) { bytes.append(reinterpret_cast<const char*>(&number), sizeof(number)); };
  const std::size_t begin = bytes.size();
  put(static_cast<std::uint32_t>(kind));
  put(static_cast<std::uint32_t>(payload.size()));
  const std::uint64_t head = checkOf(std::string_view(bytes).substr(begin, kHeadBytes), chain);
  put(head);
  bytes.append(payload);
  chain = checkOf(payload, head);
  put(chain);
}

Result<Blocks> readBlocks(std::string_view bytes, const std::string& name) {
  const auto damaged = [&](std::size_t offset, std::string_view what) {
    return badFormat("{}: byte {}: {}", name, offset, what);
  };
  if (bytes.substr(0, kSessionMagic.size()) != kSessionMagic) {
    return badFormat("{}: not a session file, expected a file written by `lorica record`; `lorica FILE` opens others",
                     name);
  }
  Blocks read;
  std::uint64_t chain = 0;
  std::size_t at = kSessionMagic.size();
  while (at < bytes.size()) {
    const std::string_view rest = bytes.substr(at);
    const std::size_t headSize = kHeadBytes + kCheckBytes;
    if (rest.size() < headSize) break;
    if (workStopped()) return cancelled();
    ByteReader head(rest.substr(0, headSize));
    const auto kind = head.take<std::uint32_t>();
    const auto length = head.take<std::uint32_t>();
    const auto headCheck = head.take<std::uint64_t>();
    if (checkOf(rest.substr(0, kHeadBytes), chain) != headCheck) {
      return damaged(at, fmt::format("the header of block {} is damaged: its checksum is wrong", read.blocks.size()));
    }
    if (kind < 1 || kind > static_cast<std::uint32_t>(BlockKind::kEnd)) {
      return damaged(at, fmt::format("found a block of kind {}, expected 1 to 4", kind));
    }
    if (length > kLargestBlock) {
      return damaged(at, fmt::format("found a block of {} bytes, expected at most {}", length, kLargestBlock));
    }
    if (rest.size() < headSize + length + kCheckBytes) break;
    const std::string_view payload = rest.substr(headSize, length);
    ByteReader tail(rest.substr(headSize + length, kCheckBytes));
    chain = checkOf(payload, headCheck);
    if (tail.take<std::uint64_t>() != chain) {
      return damaged(at, fmt::format("block {} is damaged: its checksum is wrong", read.blocks.size()));
    }
    read.blocks.push_back({static_cast<BlockKind>(kind), payload, at});
    at += headSize + length + kCheckBytes;
  }
  read.cut = bytes.size() - at;
  return read;
}

}  // namespace lorica
