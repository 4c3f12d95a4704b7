#include "capture/streams/vmc_writer.h"

#include "capture/streams/vmc_names.h"

#include <fmt/format.h>

#include <algorithm>

namespace lorica {
namespace {

constexpr std::string_view kPlace = "sfffffff";

/// A name, a position and a rotation.
void addPlace(OscWriter& writer, std::string_view name, const Vec3& position, const Quat& rotation) {
  const Vec3 p = mirrored(position);
  const Quat q = mirrored(rotation);
  writer.add(name);
  for (const double value : {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()}) writer.add(static_cast<float>(value));
}

void addState(OscWriter& writer, bool tracking) {
  writer.beginMessage("/VMC/Ext/OK", "iiii");
  writer.add(std::int32_t{1});  // loaded
  writer.add(std::int32_t{3});  // calibrated
  writer.add(std::int32_t{0});  // calibrated in the normal way
  writer.add(std::int32_t{tracking ? 1 : 0});
  writer.endMessage();
}

}  // namespace

std::span<const std::byte> ContactWriter::write(const SentContact& contact) {
  std::array<char, 64> address;
  std::array<char, 128> text;
  const auto written = [](const auto& memory, std::size_t size) {
    return std::string_view(memory.data(), std::min(size, memory.size()));
  };
  const std::size_t addressSize =
      fmt::format_to_n(address.data(), address.size(), "/VMC/Thru/lorica/contact/{}", contact.phase).size;
  const Vec3 p = mirrored(contact.point);
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

VmcBones allVmcBones() {
  VmcBones bones{};
  bones.fill(true);
  return bones;
}

VmcWriter::VmcWriter(const VmcBones& bones) : bones_(bones), memory_(kLargestPacket) {}

std::span<const std::byte> VmcWriter::write(const BonePose& pose, std::span<const VmcWeight> expressions,
                                            double seconds, bool tracking) {
  OscWriter writer(memory_);
  writer.beginBundle();
  addState(writer, tracking);
  writer.beginMessage("/VMC/Ext/T", "f");
  writer.add(static_cast<float>(seconds));
  writer.endMessage();
  writer.beginMessage("/VMC/Ext/Root/Pos", kPlace);
  addPlace(writer, "root", pose.rootPosition, pose.rootRotation);
  writer.endMessage();
  for (std::size_t b = 0; b < bones_.size(); ++b) {
    if (!bones_[b] || !pose.rotation[b]) continue;
    writer.beginMessage("/VMC/Ext/Bone/Pos", kPlace);
    addPlace(writer, vmcNameOf(static_cast<HumanBone>(b)), pose.offset[b], *pose.rotation[b]);
    writer.endMessage();
  }
  for (const VmcWeight& expression : expressions) {
    writer.beginMessage("/VMC/Ext/Blend/Val", "sf");
    writer.add(expression.name);
    writer.add(expression.weight);
    writer.endMessage();
  }
  if (!expressions.empty()) {
    writer.beginMessage("/VMC/Ext/Blend/Apply", "");
    writer.endMessage();
  }
  return writer.fits() ? writer.packet() : std::span<const std::byte>();
}

}  // namespace lorica
