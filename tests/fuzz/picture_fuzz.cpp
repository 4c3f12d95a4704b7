#include "geometry/result.h"
#include "geometry/work_budgets.h"
#include "skinning/look/picture.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

/// Any bytes as a picture, as stored and reduced. PNG's checksums are repaired first, since no fuzzer keeps them in
/// step; those of the packed pixels stay, so damaged pixels are seen too.
namespace {

using namespace lorica;

constexpr std::size_t kSignature = 8;

std::uint32_t checksum(std::string_view bytes) {
  std::uint32_t crc = 0xffffffffU;
  for (const char c : bytes) {
    crc ^= static_cast<std::uint8_t>(c);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1U) != 0U ? 0xedb88320U : 0U);
  }
  return ~crc;
}

void repairChecksums(std::string& png) {
  for (std::size_t at = kSignature; at + 12 <= png.size();) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = length << 8 | static_cast<std::uint8_t>(png[at + i]);
    if (length > png.size() - at - 12) return;
    const std::uint32_t crc = checksum(std::string_view(png).substr(at + 4, length + 4));
    for (std::size_t i = 0; i < 4; ++i) png[at + 8 + length + i] = static_cast<char>(crc >> (24 - 8 * i));
    at += 12 + length;
  }
}

void checkPicture(const Result<Picture>& picture, int largestSide) {
  if (!picture) {
    LORICA_CHECK(picture.error().message.starts_with("fuzz: "), "an error that does not say where");
    LORICA_CHECK(picture.error().message.find('\n') == std::string::npos, "one sentence on one line");
    return;
  }
  const int limit = largestSide > 0 ? largestSide : kMaxPictureSide;
  LORICA_CHECK(std::min(picture->width, picture->height) > 0 && std::max(picture->width, picture->height) <= limit,
               "a size outside the limits");
  LORICA_CHECK(
      picture->rgba.size() == static_cast<std::size_t>(picture->width) * static_cast<std::size_t>(picture->height) * 4,
      "a picture of another size");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string file(reinterpret_cast<const char*>(data), size);
  if (file.starts_with("\x89PNG")) repairChecksums(file);
  const auto bytes = std::as_bytes(std::span(file));
  const Result<Picture> stored = decodePicture(bytes, "fuzz");
  checkPicture(stored, 0);
  const Result<Picture> reduced = decodePicture(bytes, "fuzz", 9);
  checkPicture(reduced, 9);
  LORICA_CHECK(stored.ok() == reduced.ok(), "a picture that is whole only as stored, or only reduced");
  return 0;
}
