#include "capture/streams/osc.h"

#include <bit>
#include <cmath>
#include <cstring>

// Our own, because of what a hostile packet does to the libraries: oscpack 1.1 reads outside a message of 12 bytes
// whose types are two blobs (the check of a blob's size builds an exception and does not throw it), and liblo is LGPL.

namespace lorica {
namespace {

constexpr std::string_view kBundle("#bundle\0", 8);
constexpr std::size_t kBundleHead = 16;  ///< "#bundle", time tag

std::uint32_t wordAt(std::span<const std::byte> bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | std::to_integer<std::uint32_t>(bytes[i]);
  return value;
}

std::string_view textOf(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Length of a string with its end and padding; nothing if it does not end within the bytes.
std::optional<std::size_t> paddedLength(std::span<const std::byte> bytes) {
  const std::size_t end = textOf(bytes).find('\0');
  if (end == std::string_view::npos) return std::nullopt;
  const std::size_t padded = (end / 4 + 1) * 4;
  if (padded > bytes.size()) return std::nullopt;
  return padded;
}

/// Takes a string from the front of the bytes.
std::optional<std::string_view> takeText(std::span<const std::byte>& bytes) {
  const std::optional<std::size_t> length = paddedLength(bytes);
  if (!length) return std::nullopt;
  const std::string_view padded = textOf(bytes.first(*length));
  bytes = bytes.subspan(*length);
  return padded.substr(0, padded.find('\0'));
}

std::optional<OscMessage> messageIn(std::span<const std::byte> bytes) {
  const std::optional<std::string_view> address = takeText(bytes);
  if (!address || !address->starts_with('/')) return std::nullopt;
  if (bytes.empty()) return OscMessage{*address, {}, {}};  // some old senders omit the types
  const std::optional<std::string_view> types = takeText(bytes);
  if (!types || !types->starts_with(',')) return std::nullopt;
  return OscMessage{*address, types->substr(1), bytes};
}

}  // namespace

OscPacket::OscPacket(std::span<const std::byte> packet)
    : packet_(packet), isBundle_(textOf(packet).starts_with(kBundle)) {}

std::optional<OscMessage> OscPacket::fail() {
  malformed_ = true;
  at_ = packet_.size();
  depth_ = 0;
  return std::nullopt;
}

std::optional<OscMessage> OscPacket::next() {
  while (at_ < packet_.size()) {
    while (depth_ > 0 && at_ == ends_[depth_ - 1]) --depth_;
    std::size_t end = packet_.size();
    if (depth_ > 0) {
      const std::size_t left = ends_[depth_ - 1] - at_;
      if (left < 4) return fail();
      const std::uint32_t size = wordAt(packet_.subspan(at_));
      if (size > left - 4) return fail();
      at_ += 4;
      end = at_ + size;
    } else if (at_ > 0) {
      return fail();  // bytes behind the packet's only element
    }
    const std::span<const std::byte> element = packet_.subspan(at_, end - at_);
    if (element.size() % 4 != 0) return fail();
    if (!textOf(element).starts_with(kBundle)) {
      at_ = end;
      const std::optional<OscMessage> message = messageIn(element);
      return message ? message : fail();
    }
    if (element.size() < kBundleHead || depth_ == kDeepest) return fail();
    ends_[depth_++] = end;
    at_ += kBundleHead;
  }
  return std::nullopt;
}

std::optional<double> OscArguments::number() {
  const char type = types_.empty() ? '\0' : types_.front();
  const std::size_t size = type == 'f' || type == 'i' ? 4 : type == 'd' || type == 'h' ? 8 : 0;
  const bool truth = type == 'T' || type == 'F';
  if ((size == 0 && !truth) || data_.size() < size) {
    types_ = {};
    return std::nullopt;
  }
  types_.remove_prefix(1);
  if (truth) return type == 'T' ? 1.0 : 0.0;
  const std::uint32_t word = wordAt(data_);
  const std::uint64_t both = size == 8 ? std::uint64_t{word} << 32 | wordAt(data_.subspan(4)) : 0;
  data_ = data_.subspan(size);
  if (type == 'i') return static_cast<std::int32_t>(word);
  if (type == 'h') return static_cast<double>(static_cast<std::int64_t>(both));
  const double value = type == 'd' ? std::bit_cast<double>(both) : std::bit_cast<float>(word);
  if (std::isfinite(value)) return value;
  types_ = {};
  return std::nullopt;
}

std::optional<std::string_view> OscArguments::text() {
  std::optional<std::string_view> text;
  if (types_.starts_with('s')) text = takeText(data_);
  types_ = text ? types_.substr(1) : std::string_view();
  return text;
}

void OscWriter::put(const void* bytes, std::size_t count) {
  if (!fits_ || count > memory_.size() - size_) {
    fits_ = false;
    return;
  }
  std::memcpy(memory_.data() + size_, bytes, count);
  size_ += count;
}

void OscWriter::putWord(std::uint32_t value) {
  const std::array<unsigned char, 4> bytes = {
      static_cast<unsigned char>(value >> 24), static_cast<unsigned char>(value >> 16),
      static_cast<unsigned char>(value >> 8), static_cast<unsigned char>(value)};
  put(bytes.data(), bytes.size());
}

void OscWriter::putText(std::string_view text, char before) {
  constexpr std::array<char, 4> kZeros{};
  std::size_t length = text.size();
  if (before != '\0') {
    put(&before, 1);
    ++length;
  }
  put(text.data(), text.size());
  put(kZeros.data(), 4 - length % 4);
}

void OscWriter::beginBundle() {
  bundled_ = true;
  put(kBundle.data(), kBundle.size());
  putWord(0);
  putWord(1);  // the time tag that means "at once"
}

void OscWriter::beginMessage(std::string_view address, std::string_view types) {
  messageAt_ = size_;
  if (bundled_) putWord(0);
  putText(address);
  putText(types, ',');
}

void OscWriter::add(float value) {
  putWord(std::bit_cast<std::uint32_t>(value));
}

void OscWriter::add(std::int32_t value) {
  putWord(value);
}

void OscWriter::add(std::string_view value) {
  putText(value);
}

void OscWriter::endMessage() {
  if (!fits_ || !bundled_) return;
  const std::size_t end = size_;
  size_ = messageAt_;
  putWord(end - messageAt_ - 4);
  size_ = end;
}

}  // namespace lorica
