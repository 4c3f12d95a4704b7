#include "skinning/import/gltf_parts.h"

#include "geometry/errors.h"
#include "skinning/import/file_scene.h"

#include <fmt/format.h>

namespace lorica {

namespace {

using Bytes = std::span<const std::byte>;

[[nodiscard]] std::uint32_t littleEndian32(Bytes bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::to_integer<std::uint32_t>(bytes[at + i]) << (8 * i);
  return value;
}

[[nodiscard]] std::string_view asText(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

[[nodiscard]] Result<GltfParts> splitGlb(Bytes bytes, const std::string& name) {
  constexpr std::size_t kHeaderBytes = 12;
  constexpr std::size_t kChunkHeaderBytes = 8;
  constexpr std::uint32_t kJson = 0x4E4F534A;
  constexpr std::uint32_t kBinary = 0x004E4942;
  const auto bad = [&](std::string what) { return badFormat(name + ": " + std::move(what)); };

  if (bytes.size() < kHeaderBytes) {
    return bad(fmt::format("{} bytes, expected at least {} for a GLB header: the file is truncated", bytes.size(),
                           kHeaderBytes));
  }
  const std::uint32_t version = littleEndian32(bytes, 4);
  if (version != 2) {
    return unsupported("{}: GLB version {}, expected 2", name, version);
  }
  const std::uint32_t length = littleEndian32(bytes, 8);
  if (length > bytes.size()) {
    return bad(fmt::format("its header declares {} bytes, the file has {}: it is truncated", grouped(length),
                           grouped(bytes.size())));
  }
  bytes = bytes.first(length);

  GltfParts parts;
  std::size_t at = kHeaderBytes;
  for (int chunk = 0; at < bytes.size(); ++chunk) {
    if (bytes.size() - at < kChunkHeaderBytes) {
      if (chunk >= 1) break;  // padding that some writers leave behind
      return bad(fmt::format("chunk {} starts at byte {} of {}, which leaves no room for its header", chunk,
                             grouped(at), grouped(bytes.size())));
    }
    const std::uint32_t chunkBytes = littleEndian32(bytes, at);
    const std::uint32_t kind = littleEndian32(bytes, at + 4);
    at += kChunkHeaderBytes;
    if (chunkBytes > bytes.size() - at) {
      return bad(fmt::format("chunk {} of {} bytes starts at byte {} and ends past the file's {}", chunk,
                             grouped(chunkBytes), grouped(at), grouped(bytes.size())));
    }
    const Bytes content = bytes.subspan(at, chunkBytes);
    if (chunk == 0 && kind != kJson) return bad(fmt::format("chunk 0 has type {:#x}, expected JSON", kind));
    if (chunk == 0) parts.json = asText(content);
    if (chunk > 0 && kind == kBinary && !parts.binary) parts.binary = content;
    at += chunkBytes;
  }
  if (parts.json.empty()) return bad("the GLB has no JSON chunk");
  return parts;
}

}  // namespace

Result<GltfParts> splitGltf(Bytes bytes, const std::string& name) {
  GltfParts parts;
  if (bytes.size() >= 4 && asText(bytes.first(4)) == "glTF") {
    LORICA_TRY(const GltfParts split, splitGlb(bytes, name));
    parts = split;
  } else {
    parts.json = asText(bytes);
  }
  while (parts.json.ends_with('\0')) parts.json.remove_suffix(1);  // some writers pad with zeros
  return parts;
}

}  // namespace lorica
