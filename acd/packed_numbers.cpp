#include "acd/packed_numbers.h"

#include "geometry/little_endian.h"

#include <fmt/format.h>

#include <array>

namespace lorica {
namespace {

constexpr std::array<std::uint32_t, 4> kMask = {0xFF, 0xFFFF, 0xFFFFFF, 0xFFFFFFFF};  // by number of bytes - 1

/// For one control byte: start and bit mask of each of its four numbers, and the total number of bytes.
struct NumberGroup {
  std::array<std::uint32_t, 4> mask{};
  std::array<std::uint8_t, 4> begin{};
  std::uint32_t bytes = 0;
};

constexpr std::array<NumberGroup, 256> makeGroups() {
  std::array<NumberGroup, 256> groups{};
  for (unsigned control = 0; control < groups.size(); ++control) {
    NumberGroup& group = groups[control];
    for (unsigned slot = 0; slot < 4; ++slot) {
      const unsigned lessOne = control >> (2 * slot) & 3;
      group.mask[slot] = kMask[lessOne];
      group.begin[slot] = group.bytes;
      group.bytes += lessOne + 1;
    }
  }
  return groups;
}

constexpr std::array<NumberGroup, 256> kGroups = makeGroups();

unsigned bytesLessOne(std::uint32_t value) {
  return (value > kMask[0] ? 1u : 0u) + (value > kMask[1] ? 1u : 0u) + (value > kMask[2] ? 1u : 0u);
}

}  // namespace

void appendPacked(std::span<const std::uint32_t> values, std::string& bytes) {
  for (std::size_t i = 0; i < values.size(); i += 4) {
    unsigned control = 0;
    for (std::size_t slot = 0; slot < 4 && i + slot < values.size(); ++slot) {
      control |= bytesLessOne(values[i + slot]) << (2 * slot);
    }
    bytes.push_back(control);
  }
  for (const std::uint32_t value : values) {
    for (unsigned byte = 0; byte <= bytesLessOne(value); ++byte) {
      bytes.push_back(value >> (8 * byte) & 0xFF);
    }
  }
}

std::optional<std::size_t> unpack(std::string_view bytes, std::span<std::uint32_t> values) {
  // One size check for all numbers: the control bytes give their lengths.
  const std::size_t groupCount = values.size() / 4 + (values.size() % 4 > 0 ? 1 : 0);
  if (bytes.size() < groupCount) return std::nullopt;
  const auto controlOf = [&bytes](std::size_t group) { return static_cast<unsigned char>(bytes[group]); };
  std::size_t end = groupCount;
  for (std::size_t g = 0; g < groupCount; ++g) end += kGroups[controlOf(g)].bytes;
  if (const std::size_t last = values.size() % 4; last > 0) {
    if (controlOf(groupCount - 1) >> (2 * last) != 0) return std::nullopt;
    end -= 4 - last;
  }
  if (bytes.size() < end) return std::nullopt;

  // Each number is loaded as four bytes, some of which belong to the next numbers: only while four bytes are available.
  std::size_t at = groupCount;
  std::size_t i = 0;
  for (; i + 4 <= values.size() && at + 16 <= bytes.size(); i += 4) {
    const NumberGroup& group = kGroups[controlOf(i / 4)];
    for (unsigned slot = 0; slot < 4; ++slot) {
      values[i + slot] = loadLittleEndian<std::uint32_t>(bytes.data() + at + group.begin[slot]) & group.mask[slot];
    }
    at += group.bytes;
  }
  for (; i < values.size(); ++i) {
    const unsigned length = (controlOf(i / 4) >> (2 * (i % 4)) & 3u) + 1;
    values[i] = 0;
    for (unsigned byte = 0; byte < length; ++byte) {
      values[i] |= std::uint32_t{static_cast<unsigned char>(bytes[at++])} << (8 * byte);
    }
  }
  return at;
}

void takePacked(ByteReader& reader, const char* what, std::span<std::uint32_t> values) {
  if (reader.ok()) {
    if (const std::optional<std::size_t> taken = unpack(reader.rest(), values)) {
      reader.skip(*taken);
      return;
    }
    reader.fail(reader.offset(),
                fmt::format("expected {}: {} packed numbers, which do not fit the {} bytes that are left", what,
                            values.size(), reader.left()));
  }
  std::fill(values.begin(), values.end(), 0u);
}

}  // namespace lorica
