#include "capture/sensor/oni_depth_codec.h"

#include "geometry/errors.h"
#include "geometry/little_endian.h"

#include <algorithm>
#include <cstdlib>
#include <optional>

namespace lorica {
namespace {

// Half a byte: 0 to 12 is the previous value minus this one, plus 6; 13 pads the image's last byte; 15 means that an
// explicit value follows. A whole byte of 0xe1 to 0xef is that many pairs of pixels equal to the last one.
constexpr int kZeroDifference = 6;
constexpr int kLargestDifference = 12;
constexpr int kNoPixel = 13;
constexpr int kValueFollows = 15;
constexpr int kFirstRun = 0xe0;
constexpr int kLastRun = 0xef;
constexpr int kValueByte = 0xff;
// Explicit value: a byte of at least 0x80 is a difference, else two bytes are the value, high byte first.
constexpr int kDifferenceBit = 0x80;
constexpr int kZeroOfDifferenceByte = 192;

std::uint16_t word(std::span<const std::uint8_t> bytes, std::size_t at) {
  return loadLittleEndian<std::uint16_t>(reinterpret_cast<const char*>(bytes.data() + at));
}

/// @param depthOf  maps a value to a depth: false if there is none
template <typename DepthOf>
Result<void> unpack(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> depths, DepthOf depthOf) {
  std::size_t at = 0;
  std::size_t pixel = 0;
  std::uint16_t value = 0;
  const auto put = [&]() -> bool {
    if (pixel == depths.size() || !depthOf(value, depths[pixel])) return false;
    ++pixel;
    return true;
  };
  const auto subtract = [&](int difference) { value = value - difference; };
  /// Reads an explicit value; false if the bytes run out.
  const auto readValue = [&]() -> bool {
    if (at >= bytes.size()) return false;
    const int upper = bytes[at++];
    if ((upper & kDifferenceBit) != 0) {
      subtract(upper - kZeroOfDifferenceByte);
      return true;
    }
    if (at >= bytes.size()) return false;
    value = (upper << 8) | bytes[at++];
    return true;
  };

  if (bytes.size() < 2) {
    return badFormat("found {} bytes of packed depth, expected at least 2", bytes.size());
  }
  value = word(bytes, 0);
  at = 2;
  bool good = put();
  while (good && at < bytes.size()) {
    const int byte = bytes[at++];
    if (byte < kFirstRun) {
      const int first = byte >> 4;
      const int second = byte & 15;
      if (first > kLargestDifference || second == 14) {
        return badFormat("found byte 0x{:02x} at {} of packed depth, expected two differences of up to 6", byte,
                         at - 1);
      }
      subtract(first - kZeroDifference);
      good = put();
      if (second == kValueFollows) {
        good = good && readValue() && put();
      } else if (second != kNoPixel) {
        subtract(second - kZeroDifference);
        good = good && put();
      }
    } else if (byte == kValueByte) {
      good = readValue() && put();
    } else if (byte > kFirstRun && byte <= kLastRun) {
      const std::size_t count = 2 * (byte - kFirstRun);
      good = count <= depths.size() - pixel;
      if (good) std::fill_n(depths.begin() + pixel, count, depths[pixel - 1]);
      if (good) pixel += count;
    } else {
      return badFormat("found byte 0x{:02x} at {} of packed depth, expected 0xe1 to 0xef or 0xff", byte, at - 1);
    }
  }
  if (!good) {
    return badFormat(
        "packed depth is damaged near byte {} of {}: found value {} for pixel {}, expected one of the "
        "table and {} pixels",
        at, bytes.size(), value, pixel, depths.size());
  }
  if (pixel != depths.size()) {
    return badFormat("found {} pixels in packed depth, expected {}", pixel, depths.size());
  }
  return {};
}

/// Packs pixel by pixel: small differences are collected in pairs, equal pairs in runs.
class OniPacker {
 public:
  std::string pack(std::span<const std::uint16_t> values) {
    out_.clear();
    appendLittleEndian(values[0], out_);
    for (std::size_t i = 1; i < values.size(); ++i) {
      const int difference = values[i - 1] - values[i];
      if (std::abs(difference) <= 6) {
        addSmall(difference + 6);
      } else {
        addLarge(difference, values[i]);
      }
    }
    flushRun();
    if (half_) out_ += static_cast<char>(*half_ << 4 | 13);
    return out_;
  }

 private:
  void addSmall(int nibble) {
    if (!half_) {
      half_ = nibble;
      return;
    }
    const int byte = *half_ << 4 | nibble;
    half_.reset();
    if (byte == 0x66) {
      if (++run_ == 15) flushRun();
      return;
    }
    flushRun();
    out_ += static_cast<char>(byte);
  }
  void addLarge(int difference, std::uint16_t value) {
    flushRun();
    out_ += static_cast<char>(half_ ? *half_ << 4 | 15 : 0xff);
    half_.reset();
    if (std::abs(difference) <= 63) {
      out_ += static_cast<char>(difference + 192);
    } else {
      out_ += static_cast<char>(value >> 8);
      out_ += static_cast<char>(value & 0xff);
    }
  }
  void flushRun() {
    if (run_ > 0) out_ += static_cast<char>(0xe0 + run_);
    run_ = 0;
  }

  std::string out_;
  std::optional<int> half_;
  int run_ = 0;
};

}  // namespace

Result<void> OniDepthDecoder::decode(OniCodec codec, std::span<const std::uint8_t> packed,
                                     std::span<std::uint16_t> depths) {
  switch (codec) {
    case OniCodec::kRaw:
      if (packed.size() != 2 * depths.size()) {
        return badFormat("found {} bytes of depth, expected {}", packed.size(), 2 * depths.size());
      }
      for (std::size_t i = 0; i < depths.size(); ++i) depths[i] = word(packed, 2 * i);
      return {};
    case OniCodec::kPacked:
      return unpack(packed, depths, [](std::uint16_t value, std::uint16_t& depth) {
        depth = value;
        return true;
      });
    case OniCodec::kTable: {
      const std::size_t count = packed.size() < 2 ? 0 : word(packed, 0);
      if (count == 0 || packed.size() < 2 + 2 * count) {
        return badFormat("found a table of {} depths in {} bytes, expected at least 1 and their bytes", count,
                         packed.size());
      }
      table_.resize(count);
      for (std::size_t i = 0; i < count; ++i) table_[i] = word(packed, 2 + 2 * i);
      return unpack(packed.subspan(2 + 2 * count), depths, [this](std::uint16_t value, std::uint16_t& depth) {
        if (value >= table_.size()) return false;
        depth = table_[value];
        return true;
      });
    }
  }
  return badFormat("found an unknown codec, expected NONE, 16zP or 16zT");
}

std::string packOniDepth(OniCodec codec, std::span<const std::uint16_t> depths) {
  if (codec == OniCodec::kRaw) {
    std::string out;
    for (const std::uint16_t depth : depths) appendLittleEndian(depth, out);
    return out;
  }
  if (codec == OniCodec::kPacked) return OniPacker().pack(depths);
  constexpr std::size_t kDepths = 1U << 16U;
  std::vector<bool> occurs(kDepths);
  for (const std::uint16_t depth : depths) occurs[depth] = true;
  std::string out;
  appendLittleEndian(static_cast<std::uint16_t>(std::ranges::count(occurs, true)), out);
  std::vector<std::uint16_t> indices(kDepths), values(depths.size());
  std::uint16_t next = 0;
  for (std::size_t depth = 0; depth < kDepths; ++depth) {
    if (!occurs[depth]) continue;
    indices[depth] = next++;
    appendLittleEndian(static_cast<std::uint16_t>(depth), out);
  }
  std::transform(depths.begin(), depths.end(), values.begin(), [&](std::uint16_t depth) { return indices[depth]; });
  return out + OniPacker().pack(values);
}

}  // namespace lorica
