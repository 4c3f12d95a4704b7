#pragma once

#include "capture/streams/osc.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica::test {

/// Packets as other programs lay them out. Values are in Unity's axes.
class Packet {
 public:
  Packet() = default;
  Packet(const Packet&) = delete;
  Packet& operator=(const Packet&) = delete;

  Packet& bundle() {
    writer_.beginBundle();
    return *this;
  }
  Packet& place(std::string_view address, std::string_view name, const std::vector<float>& values) {
    writer_.beginMessage(address, "s" + std::string(values.size(), 'f'));
    writer_.add(name);
    for (const float value : values) writer_.add(value);
    writer_.endMessage();
    return *this;
  }
  Packet& bone(std::string_view name, const std::vector<float>& values = {0, 0.1f, 0, 0, 0, 0, 1}) {
    return place("/VMC/Ext/Bone/Pos", name, values);
  }
  Packet& numbers(std::string_view address, const std::vector<std::int32_t>& values) {
    writer_.beginMessage(address, std::string(values.size(), 'i'));
    for (const std::int32_t value : values) writer_.add(value);
    writer_.endMessage();
    return *this;
  }
  Packet& weight(std::string_view name, float value) { return place("/VMC/Ext/Blend/Val", name, {value}); }
  Packet& empty(std::string_view address) { return numbers(address, {}); }
  [[nodiscard]] std::span<const std::byte> bytes() const { return writer_.packet(); }

 private:
  std::vector<std::byte> memory_ = std::vector<std::byte>(16384);
  OscWriter writer_{memory_};
};

}  // namespace lorica::test
