#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace lorica {

/// A message of Open Sound Control 1.0 (https://opensoundcontrol.stanford.edu/spec-1_0.html), as views of its packet.
struct OscMessage {
  std::string_view address;         ///< begins with a slash
  std::string_view types;           ///< one letter per argument; may promise more than `data` holds
  std::span<const std::byte> data;  ///< of the arguments
};

/// Reads the messages of a packet, also those in bundles. Time tags are ignored. Allocates nothing, throws nothing, and
/// reads nothing outside the packet, whatever its bytes.
class OscPacket {
 public:
  explicit OscPacket(std::span<const std::byte> packet);

  /// @return the next message; nothing at the end, or where the packet is malformed
  [[nodiscard]] std::optional<OscMessage> next();
  /// Whether the last next() met malformed bytes, or bundles nested more than 8 deep.
  [[nodiscard]] bool malformed() const { return malformed_; }
  /// Whether the packet is a bundle.
  [[nodiscard]] bool isBundle() const { return isBundle_; }

 private:
  static constexpr std::size_t kDeepest = 8;

  [[nodiscard]] std::optional<OscMessage> fail();

  std::span<const std::byte> packet_;
  std::array<std::size_t, kDeepest> ends_{};  ///< of the open bundles, the innermost last
  std::size_t depth_ = 0;
  std::size_t at_ = 0;
  bool isBundle_ = false;
  bool malformed_ = false;
};

/// Reads the arguments of a message one after another. After one of another type than asked for, or one that the data
/// does not hold, nothing more is read.
class OscArguments {
 public:
  explicit OscArguments(const OscMessage& message) : types_(message.types), data_(message.data) {}

  /// Number of arguments that were promised and not yet read.
  [[nodiscard]] std::size_t left() const { return types_.size(); }
  /// A finite float or double, an integer of 32 or 64 bits, or a truth value as 1 or 0.
  [[nodiscard]] std::optional<double> number();
  [[nodiscard]] std::optional<std::string_view> text();

 private:
  std::string_view types_;
  std::span<const std::byte> data_;
};

/// Writes one packet into memory of the caller. What does not fit is not written, see fits().
class OscWriter {
 public:
  explicit OscWriter(std::span<std::byte> memory) : memory_(memory) {}

  /// Opens a bundle, to be executed at once; before everything else.
  void beginBundle();
  /// @param types  one of s, f and i for each value that follows
  void beginMessage(std::string_view address, std::string_view types);
  void add(float value);
  void add(std::int32_t value);
  void add(std::string_view value);
  void endMessage();

  [[nodiscard]] std::span<const std::byte> packet() const { return memory_.first(size_); }
  /// Whether everything fitted so far.
  [[nodiscard]] bool fits() const { return fits_; }

 private:
  void put(const void* bytes, std::size_t count);
  void putWord(std::uint32_t value);
  void putText(std::string_view text, char before = '\0');

  std::span<std::byte> memory_;
  std::size_t size_ = 0;
  std::size_t messageAt_ = 0;  ///< where the size of the open message is to be written
  bool bundled_ = false;
  bool fits_ = true;
};

}  // namespace lorica
