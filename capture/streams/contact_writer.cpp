#include "capture/streams/contact_writer.h"

#include "capture/streams/bone_stream.h"
#include "capture/streams/osc.h"

#include <fmt/format.h>

#include <algorithm>

namespace lorica {

std::span<const std::byte> ContactWriter::write(const SentContact& contact) {
  std::array<char, 64> address;
  std::array<char, 128> text;
  const auto written = [](const auto& memory, std::size_t size) {
    return std::string_view(memory.data(), std::min(size, memory.size()));
  };
  const std::size_t addressSize =
      fmt::format_to_n(address.data(), address.size(), "/VMC/Thru/lorica/contact/{}", contact.phase).size;
  const Vec3 p = mirrorX(contact.point);
  const std::size_t textSize =
      (contact.other.empty() ? fmt::format_to_n(text.data(), text.size(), "{} prop:{} {:.3f} {:.3f} {:.3f}",
                                                contact.bone, contact.prop, p.x(), p.y(), p.z())
                             : fmt::format_to_n(text.data(), text.size(), "{} {} {:.3f} {:.3f} {:.3f}", contact.bone,
                                                contact.other, p.x(), p.y(), p.z()))
          .size;
  OscWriter writer(memory_);
  writer.beginMessage(written(address, addressSize), "sf");
  writer.add(written(text, textSize));
  writer.add(static_cast<float>(contact.strength));
  writer.endMessage();
  return writer.packet();
}

}  // namespace lorica
