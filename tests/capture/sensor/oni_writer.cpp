#include "tests/capture/sensor/oni_writer.h"

#include "geometry/little_endian.h"

#include <algorithm>

namespace lorica::test {
namespace {

template <typename T>
std::string packed(T value) {
  std::string out;
  appendLittleEndian(value, out);
  return out;
}

std::string sizedText(const std::string& text) {
  return packed(static_cast<std::uint32_t>(text.size() + 1)) + text + '\0';
}

void overwrite(std::string& bytes, std::size_t at, const std::string& with) {
  std::copy(with.begin(), with.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at));
}

enum : std::uint32_t { kDevice = 1, kDepth = 2, kColor = 3 };  // types, also used as node numbers here

}  // namespace

OniWriter::OniWriter(const OniWriterSettings& settings) : settings_(settings) {
  bytes_ = "NI10";
  bytes_ += settings.oldVersion ? std::string("\1\0\0\0\6\0\0\0", 8) : std::string("\1\0\1\0\0\0\0\0", 8);
  bytes_ += packed(std::uint64_t{0}) + packed(std::uint32_t{kColor});

  addNode(kDevice, kDevice, 0x454e4f4e, "Device");
  property(5, kDevice, "DeviceName", std::string("a test's\0", 9));
  record(9, kDevice, {});

  depthCountAt_ = bytes_.size();
  addNode(kDepth, kDepth, static_cast<std::uint32_t>(settings.codec), "Depth");
  number(kDepth, "oniRequiredFrameSize", static_cast<std::uint64_t>(2 * settings.width * settings.height));
  number(kDepth, "xnIsGenerating", 1);
  number(kDepth, "xnDeviceMaxDepth", 65535);
  property(6, kDepth, "xnMapOutputMode",
           packed(static_cast<std::uint32_t>(settings.width)) + packed(static_cast<std::uint32_t>(settings.height)) +
               packed(std::uint32_t{30}));
  number(kDepth, "xnPixelFormat", 4);
  number(kDepth, "oniPixelFormat", settings.tenths ? 101 : 100);
  property(6, kDepth, "xnFOV", packed(settings.horizontalFov) + packed(settings.verticalFov));
  const OniCrop crop = settings.crop.value_or(OniCrop{0, 0, 0, 0});
  number(kDepth, "Cropping", 1);
  property(6, kDepth, "xnCropping",
           packed(std::uint32_t{settings.crop.has_value()}) + packed(crop.left) + packed(crop.top) +
               packed(crop.width) + packed(crop.height));
  number(kDepth, "xnMirror", settings.mirrored ? 1 : 0);
  record(9, kDepth, {});
  record(8, kDepth, packed(0xffffffffu) + packed(~std::uint64_t{0}));

  colorCountAt_ = bytes_.size();
  addNode(kColor, kColor, 0x454e4f4e, "Image");
  property(6, kColor, "xnMapOutputMode",
           packed(std::uint32_t{2}) + packed(std::uint32_t{1}) + packed(std::uint32_t{30}));
  number(kColor, "xnPixelFormat", 1);
  number(kColor, "oniPixelFormat", 200);
  property(6, kColor, "xnCropping", std::string(12, '\0'));
  record(9, kColor, {});
  record(8, kColor, packed(0xffffffffu) + packed(~std::uint64_t{0}));
}

void OniWriter::addFrame(std::uint64_t timeUs, std::span<const std::uint16_t> depths) {
  ++frames_;
  lastUs_ = timeUs;
  const std::string fields = packed(timeUs) + packed(frames_);
  record(10, kColor, fields, "colour");
  record(10, kDepth, fields, packOniDepth(settings_.codec, depths));
}

std::string OniWriter::finished() const {
  OniWriter end = *this;
  end.record(7, kDepth, {});
  end.record(7, kColor, {});
  end.record(11, 0, {});
  overwrite(end.bytes_, 12, packed(lastUs_));
  const std::size_t header = settings_.oldVersion ? 24 : 28;
  const std::string counts = packed(frames_) + packed(std::uint64_t{0}) + packed(lastUs_);
  overwrite(end.bytes_, depthCountAt_ + header + sizedText("Depth").size() + 8, counts);
  overwrite(end.bytes_, colorCountAt_ + header + sizedText("Image").size() + 8, counts);
  return end.bytes_;
}

void OniWriter::record(std::uint32_t type, std::uint32_t node, const std::string& fields, const std::string& payload) {
  const std::size_t header = settings_.oldVersion ? 24 : 28;
  bytes_ += std::string("NIR\0", 4) + packed(type) + packed(node);
  bytes_ +=
      packed(static_cast<std::uint32_t>(header + fields.size())) + packed(static_cast<std::uint32_t>(payload.size()));
  bytes_ += std::string(header - 20, '\0') + fields + payload;
}

void OniWriter::addNode(std::uint32_t type, std::uint32_t node, std::uint32_t codec, const std::string& name) {
  record(13, node,
         sizedText(name) + packed(type) + packed(codec) + packed(0xffffffffu) + packed(std::uint64_t{0}) +
             packed(~std::uint64_t{0}) + std::string(settings_.oldVersion ? 4 : 8, '\0'));
}

void OniWriter::property(std::uint32_t type, std::uint32_t node, const std::string& name, const std::string& value) {
  record(type, node, sizedText(name) + packed(static_cast<std::uint32_t>(value.size())) + value);
}

void OniWriter::number(std::uint32_t node, const std::string& name, std::uint64_t value) {
  property(3, node, name, packed(value));
}

}  // namespace lorica::test
