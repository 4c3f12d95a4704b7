#include "capture/streams/depth_stream.h"
#include "geometry/errors.h"
#include "geometry/little_endian.h"
#include "geometry/text.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace lorica {
namespace {

constexpr std::uint32_t kDepthVersion = 1;
constexpr std::size_t kMostSkipped = 16U << 20;  // bytes in which a header must come: two images of 2048 x 2048
constexpr double kLongestTime = 1e12;            // [s]

/// The numbers of a header after the magic, in its order.
struct DepthHeader {
  std::uint32_t version = kDepthVersion, imageBytes = 0, width = 0, height = 0;
  double time = 0.0;
  DepthLens lens;

  template <typename Visit>
  void each(Visit&& visit) {
    for (std::uint32_t* number : {&version, &imageBytes, &width, &height}) visit(*number);
    for (double* number : {&time, &lens.metresPerUnit, &lens.focalX, &lens.focalY, &lens.centreX, &lens.centreY}) {
      visit(*number);
    }
    for (double& number : lens.distortion) visit(number);
  }
};

}  // namespace

std::array<std::byte, kDepthHeaderBytes> depthHeaderOf(const DepthLens& lens, double time) {
  DepthHeader header;
  header.lens = lens;
  header.time = time;
  header.width = static_cast<std::uint32_t>(lens.width);
  header.height = static_cast<std::uint32_t>(lens.height);
  header.imageBytes = 2 * header.width * header.height;
  std::string bytes(kDepthMagic);
  header.each([&](auto number) { appendLittleEndian(number, bytes); });
  std::array<std::byte, kDepthHeaderBytes> made;
  LORICA_CHECK(bytes.size() == made.size(), "the header of a depth stream has a fixed size");
  std::memcpy(made.data(), bytes.data(), made.size());
  return made;
}

Result<BareDepth> parseBareDepth(std::string_view text) {
  const std::string_view layout = text.substr(0, text.find(','));
  BareDepth bare;
  bare.bigEndian = layout == "gray16be";
  if (!bare.bigEndian && layout != "gray16le") {
    return invalidArgument("found '{}', expected gray16le or gray16be and a camera: gray16le,640x576,fov=75x65,unit=mm",
                           printable(layout, 40));
  }
  LORICA_TRY(bare.lens, parseDepthLens(text.substr(std::min(layout.size() + 1, text.size()))));
  return bare;
}

DepthFrameParser::DepthFrameParser(std::optional<BareDepth> bare) : bare_(bare) {
  if (bare_) lens_ = bare_->lens;
  inImage_ = bare_.has_value();
}

std::span<std::byte> DepthFrameParser::wanted() {
  if (!inImage_) return std::span(header_).subspan(filled_);
  image_.resize(static_cast<std::size_t>(lens_->width) * lens_->height);
  return std::as_writable_bytes(std::span(image_)).subspan(filled_);
}

Result<bool> DepthFrameParser::got(std::size_t bytes) {
  filled_ += bytes;
  if (!inImage_) {
    if (filled_ < header_.size()) return false;
    LORICA_TRY(inImage_, findHeader());
    if (!inImage_) return false;
    LORICA_TRY_DO(readHeader());
    filled_ = 0;
    return false;
  }
  if (filled_ < 2 * image_.size()) return false;
  filled_ = 0;
  inImage_ = bare_.has_value();
  const bool swapped = (std::endian::native == std::endian::big) != (bare_ && bare_->bigEndian);
  if (swapped) {
    for (std::uint16_t& value : image_) value = static_cast<std::uint16_t>(value << 8 | value >> 8);
  }
  return true;
}

/// After an image that broke off, the next header is within what is taken for one.
Result<bool> DepthFrameParser::findHeader() {
  const char* bytes = reinterpret_cast<const char*>(header_.data());
  const std::string_view text(bytes, header_.size());
  const std::size_t last = text.rfind(kDepthMagic);  // another one within a header: that one broke off
  if (last == 0) {
    skipped_ = 0;
    return true;
  }
  if (!lens_ && last == std::string_view::npos) {
    return badFormat(
        "found bytes that start with '{}', expected a depth stream, which starts with {}; of images without headers "
        "say --depth-format",
        printable(text.substr(0, 8)), kDepthMagic);
  }
  std::size_t next = last == std::string_view::npos ? 1 : last;
  while (!kDepthMagic.starts_with(text.substr(next, kDepthMagic.size()))) ++next;  // at the end, nothing starts with it
  skipped_ += next;
  if (skipped_ > kMostSkipped) {
    return badFormat("found no header of an image within {} bytes, expected {}", grouped(skipped_), kDepthMagic);
  }
  filled_ = header_.size() - next;
  std::copy(header_.begin() + static_cast<std::ptrdiff_t>(next), header_.end(), header_.begin());
  return false;
}

Result<void> DepthFrameParser::readHeader() {
  const char* at = reinterpret_cast<const char*>(header_.data()) + kDepthMagic.size();
  DepthHeader header;
  header.each([&]<typename T>(T& number) {
    number = loadLittleEndian<T>(at);
    at += sizeof(T);
  });
  if (header.version != kDepthVersion) {
    return unsupported("found version {} of the depth stream, expected {}", header.version, kDepthVersion);
  }
  constexpr std::uint32_t kMost = 1U << 16;
  header.lens.width = static_cast<int>(std::min(header.width, kMost));
  header.lens.height = static_cast<int>(std::min(header.height, kMost));
  if (std::uint64_t{2} * header.width * header.height != header.imageBytes) {
    return badFormat("found an image of {} bytes, expected {} x {} pixels of 16 bits", header.imageBytes, header.width,
                     header.height);
  }
  if (!(std::abs(header.time) <= kLongestTime)) {
    return badFormat("found an image at {:g} s, expected a time in seconds", header.time);
  }
  if (lens_ && !(*lens_ == header.lens)) {
    return badFormat(
        "found another camera, of {} x {} pixels, in the stream of one with {} x {}: a stream has one camera",
        header.width, header.height, lens_->width, lens_->height);
  }
  if (!lens_) {
    LORICA_TRY(const DepthRectifier usable, DepthRectifier::create(header.lens));
    lens_ = usable.lens();
  }
  time_ = header.time;
  return {};
}

bool DepthFrameParser::restart() {
  const bool broken = within() || (inImage_ && !bare_);
  filled_ = skipped_ = 0;
  inImage_ = bare_.has_value();
  return broken;
}

std::pair<std::size_t, std::size_t> DepthFrameParser::progress() const {
  const std::size_t image = lens_ ? std::size_t{2} * lens_->width * lens_->height : 0;
  const std::size_t header = bare_ ? 0 : kDepthHeaderBytes;
  return {filled_ + (inImage_ ? header : 0), header + image};
}

}  // namespace lorica
