#include "sensor/oni_records.h"

#include "geometry/little_endian.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

namespace lorica {
namespace {

constexpr std::uint64_t kFileHeader = 24;
constexpr std::uint32_t kRecordMagic = 0x0052494e;  // "NIR\0"
constexpr std::uint32_t kCountUnknown = 0xffffffff;
/// What of a record is looked at: its header, a name and a value. Longer ones are tables of the sensor.
constexpr std::size_t kLookedAt = 600;
constexpr std::uint32_t kLongestName = 256;
constexpr std::uint32_t kMostNodes = 64;
/// The largest sensor images are 1600 x 1200.
constexpr std::uint32_t kLargestSide = 2048;
constexpr std::uint64_t kLatestTimeUs = 10'000'000'000'000'000;
constexpr std::uint64_t kPaddingLookedAt = 1 << 16;

enum Record : std::uint32_t {
  kNodeAdded4 = 2,  // of version 1.0.0.4
  kInt = 3,
  kReal = 4,
  kString = 5,
  kGeneral = 6,
  kNodeRemoved = 7,
  kDataBegin = 8,
  kNodeReady = 9,
  kData = 10,
  kEnd = 11,
  kNodeAdded5 = 12,  // of version 1.0.0.5
  kNodeAdded = 13,
  kSeekTable = 14,
};

enum NodeType : std::uint32_t { kDevice = 1, kDepth = 2, kColor = 3, kInfrared = 5 };

// Pixel formats as OniCEnums.h numbers them.
constexpr std::uint64_t kMillimetres = 100;
constexpr std::uint64_t kTenthsOfMillimetres = 101;

struct Node {
  std::uint32_t type = 0;
  bool removed = false;
};

/// Little-endian numbers out of a record, never beyond its end.
class Fields {
 public:
  explicit Fields(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <typename T>
  std::optional<T> take() {
    if (bytes_.size() < sizeof(T)) return std::nullopt;
    const T value = loadLittleEndian<T>(reinterpret_cast<const char*>(bytes_.data()));
    bytes_ = bytes_.subspan(sizeof(T));
    return value;
  }
  std::optional<std::string_view> text(std::size_t bytes) {
    if (bytes_.size() < bytes) return std::nullopt;
    const std::string_view whole(reinterpret_cast<const char*>(bytes_.data()), bytes);
    bytes_ = bytes_.subspan(bytes);
    return whole.substr(0, whole.find('\0'));
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

/// For sentences: what a file says may be anything.
std::string printable(std::string_view text) {
  std::string out;
  for (const char c : text.substr(0, 80)) out += c >= 0x20 && c < 0x7f ? c : '?';
  return out;
}

class Walk {
 public:
  Walk(const OniBytes& bytes, const std::string& name) : bytes_(bytes), name_(name), size_(bytes.size()) {}

  Result<OniIndex> run() {
    if (const Result<void> read = readFileHeader(); !read) return read.error();
    while (!ended_) {
      const Result<void> read = readRecord();
      if (!read) return read.error();
    }
    return finish();
  }

 private:
  [[nodiscard]] Error bad(const std::string& found, const std::string& expected) const {
    return {ErrorCode::kBadFormat, fmt::format("{}, byte {}: found {}, expected {}", name_, at_, found, expected)};
  }

  Result<void> readFileHeader() {
    std::array<std::uint8_t, kFileHeader> raw{};
    if (size_ < kFileHeader || !bytes_.read(0, raw)) {
      return bad(fmt::format("{} bytes", size_), "an .oni recording, which has 24 bytes and more");
    }
    Fields fields(raw);
    const std::string_view magic = *fields.text(4);
    if (magic != "NI10") return bad(fmt::format("\"{}\"", printable(magic)), "\"NI10\", as .oni recordings start");
    const int major = *fields.take<std::uint8_t>();
    const int minor = *fields.take<std::uint8_t>();
    const int maintenance = *fields.take<std::uint16_t>();
    const std::uint32_t build = *fields.take<std::uint32_t>();
    const auto version =
        std::array<std::uint32_t, 4>{static_cast<std::uint32_t>(major), static_cast<std::uint32_t>(minor),
                                     static_cast<std::uint32_t>(maintenance), build};
    index_.info.version = fmt::format("{}.{}.{}.{}", major, minor, maintenance, build);
    constexpr std::array<std::uint32_t, 4> kOldest = {1, 0, 0, 4};
    constexpr std::array<std::uint32_t, 4> kWide = {1, 0, 1, 0};
    if (version < kOldest || version > kWide) {
      return Error{ErrorCode::kUnsupported, fmt::format("{}, byte 4: found version {}, expected 1.0.0.4 to 1.0.1.0",
                                                        name_, index_.info.version)};
    }
    recordHeader_ = version < kWide ? 24 : 28;
    latestUs_ = *fields.take<std::uint64_t>();
    at_ = kFileHeader;
    return {};
  }

  /// A recording that its recorder did not finish: it counts its frames only then.
  [[nodiscard]] bool unfinished() const { return depthNode_ && declaredFrames_ == kCountUnknown; }

  Result<void> cutOff(const std::string& found) {
    if (!unfinished()) return bad(found, "more records up to an end record");
    index_.info.cutOff = true;
    ended_ = true;
    return {};
  }

  [[nodiscard]] bool onlyZeros(std::uint64_t from, std::uint64_t most) const {
    std::vector<std::uint8_t> raw(static_cast<std::size_t>(std::min(most, size_ - from)));
    return bytes_.read(from, raw) && std::all_of(raw.begin(), raw.end(), [](std::uint8_t b) { return b == 0; });
  }

  Result<void> readRecord() {
    if (at_ == size_) return cutOff("the end of the file");
    std::array<std::uint8_t, kLookedAt> raw;
    const std::span<std::uint8_t> whole(raw);
    const auto look = static_cast<std::size_t>(std::min<std::uint64_t>(kLookedAt, size_ - at_));
    if (!bytes_.read(at_, whole.first(look))) {
      return Error{ErrorCode::kUnreadable, fmt::format("{}, byte {}: cannot be read", name_, at_)};
    }
    if (look < recordHeader_) return cutOff(fmt::format("{} bytes before the end of the file", look));
    Fields header(whole.first(recordHeader_));
    const std::uint32_t magic = *header.take<std::uint32_t>();
    if (magic != kRecordMagic) {
      if (magic == 0 && unfinished() && onlyZeros(at_, kPaddingLookedAt)) return cutOff("zeros");
      return bad(fmt::format("0x{:08x}", magic), "0x0052494e, as records start");
    }
    const std::uint32_t type = *header.take<std::uint32_t>();
    const std::uint32_t node = *header.take<std::uint32_t>();
    const std::uint32_t fieldsBytes = *header.take<std::uint32_t>();
    const std::uint32_t payloadBytes = *header.take<std::uint32_t>();
    if (fieldsBytes < recordHeader_) {
      return bad(fmt::format("a record of {} bytes", fieldsBytes), fmt::format("{} or more", recordHeader_));
    }
    const std::uint64_t total = std::uint64_t{fieldsBytes} + payloadBytes;
    if (total > size_ - at_) {
      return cutOff(fmt::format("a record of {} bytes, {} before the end of the file", total, size_ - at_));
    }
    if (payloadBytes != 0 && type != kData && type != kSeekTable) {
      return bad(fmt::format("{} bytes of payload in a record of type {}", payloadBytes, type), "none");
    }
    const std::size_t inSight = std::min<std::size_t>(fieldsBytes, look);
    const Fields fields(whole.subspan(recordHeader_, inSight - recordHeader_));
    const std::uint32_t ownBytes = fieldsBytes - recordHeader_;
    Result<void> handled = handle(type, node, fields, ownBytes, payloadBytes);
    if (!handled) return handled;
    at_ += total;
    if (type == kEnd) return end();
    return {};
  }

  Result<void> handle(std::uint32_t type, std::uint32_t node, Fields fields, std::uint32_t bytes,
                      std::uint32_t payloadBytes) {
    switch (type) {
      case kNodeAdded4:
      case kNodeAdded5:
      case kNodeAdded:
        return addNode(type, node, fields, bytes);
      case kEnd:
        return {};
      case kSeekTable:  // comes when its node is gone already
        return known(node, true);
      case kInt:
      case kReal:
      case kString:
      case kGeneral:
        if (const Result<void> there = known(node, false); !there) return there;
        return property(type, node, fields, bytes);
      case kNodeRemoved:
        if (const Result<void> there = known(node, false); !there) return there;
        nodes_[node].removed = true;
        return {};
      case kNodeReady:
      case kDataBegin:
        return known(node, false);
      case kData:
        if (const Result<void> there = known(node, false); !there) return there;
        return data(node, fields, bytes, payloadBytes);
      default:
        return bad(fmt::format("a record of type {}", type), "2 to 14");
    }
  }

  [[nodiscard]] Result<void> known(std::uint32_t node, bool evenRemoved) const {
    const auto found = nodes_.find(node);
    if (found == nodes_.end()) return bad(fmt::format("a record of node {}", node), "one of a node that was added");
    if (found->second.removed && !evenRemoved) {
      return bad(fmt::format("a record of node {}", node), "none, since the node was removed");
    }
    return {};
  }

  Result<void> addNode(std::uint32_t type, std::uint32_t node, Fields fields, std::uint32_t bytes) {
    const std::uint32_t nameBytes = fields.take<std::uint32_t>().value_or(0);
    if (nameBytes == 0 || nameBytes > kLongestName) {
      return bad(fmt::format("a node's name of {} bytes", nameBytes), "1 to 256");
    }
    const std::optional<std::string_view> name = fields.text(nameBytes);
    const std::optional<std::uint32_t> nodeType = fields.take<std::uint32_t>();
    const std::optional<std::uint32_t> codec = fields.take<std::uint32_t>();
    const std::uint32_t seekBytes = recordHeader_ == 24 ? 4 : 8;
    const std::uint32_t statistics = type == kNodeAdded4 ? 0 : type == kNodeAdded5 ? 20 : 20 + seekBytes;
    if (!name || !codec || bytes < 4 + nameBytes + 8 + statistics) {
      return bad(fmt::format("{} bytes of fields in an added node", bytes), "its name, type, codec and frame count");
    }
    const std::uint32_t frames = type == kNodeAdded4 ? kCountUnknown : fields.take<std::uint32_t>().value_or(0);
    const auto found = nodes_.find(node);
    if (found != nodes_.end() && !found->second.removed) {
      return bad(fmt::format("node {} added again", node), "each node once");
    }
    if (found == nodes_.end() && nodes_.size() >= kMostNodes) {
      return bad(fmt::format("more than {} nodes", kMostNodes), "a device and its streams");
    }
    nodes_[node] = {*nodeType, false};
    if (*nodeType == kDevice && index_.info.device.empty()) index_.info.device = printable(*name);
    if (*nodeType != kDepth || depthNode_) return {};

    depthNode_ = node;
    declaredFrames_ = frames;
    countMustEnd_ = type == kNodeAdded4;
    index_.info.codec = static_cast<OniCodec>(*codec);
    switch (index_.info.codec) {
      case OniCodec::kRaw:
      case OniCodec::kPacked:
      case OniCodec::kTable:
        return {};
    }
    return Error{ErrorCode::kUnsupported,
                 fmt::format("{}, byte {}: found depth packed as 0x{:08x}, expected NONE, 16zP "
                             "or 16zT",
                             name_, at_, *codec)};
  }

  Result<void> property(std::uint32_t type, std::uint32_t node, Fields fields, std::uint32_t bytes) {
    const std::uint32_t nameBytes = fields.take<std::uint32_t>().value_or(0);
    if (nameBytes == 0 || nameBytes > kLongestName) {
      return bad(fmt::format("a property's name of {} bytes", nameBytes), "1 to 256");
    }
    const std::optional<std::string_view> name = fields.text(nameBytes);
    const std::optional<std::uint32_t> valueBytes = fields.take<std::uint32_t>();
    if (!name || !valueBytes || std::uint64_t{8} + nameBytes + *valueBytes != bytes) {
      return bad(fmt::format("{} bytes of fields in a property", bytes), "its name, its size and as many bytes");
    }
    if ((type == kInt || type == kReal) && *valueBytes != 8) {
      return bad(fmt::format("{} bytes of number \"{}\"", *valueBytes, printable(*name)), "8");
    }
    if (type == kString && *valueBytes <= kLongestName && nodes_[node].type == kDevice &&
        (*name == "PhysicalDeviceName" || *name == "DeviceName")) {
      if (const auto text = fields.text(*valueBytes); text && !text->empty()) index_.info.device = printable(*text);
      return {};
    }
    if (depthNode_ != node) return {};
    if (type == kInt) {
      const std::uint64_t value = fields.take<std::uint64_t>().value_or(0);
      if (*name == "xnMirror") mirrored_ = value != 0;
      if (*name == "oniPixelFormat") return setPixelFormat(value);
      return {};
    }
    if (type != kGeneral) return {};
    if (*name == "xnMapOutputMode") return setSize(fields, *valueBytes);
    if (*name == "xnFOV") return setFieldOfView(fields, *valueBytes);
    if (*name == "xnCropping") return setCrop(fields, *valueBytes);
    return {};
  }

  Result<void> setPixelFormat(std::uint64_t format) {
    if (format != kMillimetres && format != kTenthsOfMillimetres) {
      return Error{
          ErrorCode::kUnsupported,
          fmt::format("{}, byte {}: found depth in pixel format {}, expected 100 (millimetres) or 101 (tenths)", name_,
                      at_, format)};
    }
    const bool tenths = format == kTenthsOfMillimetres;
    if (tenths != index_.tenths && !index_.frames.empty()) return bad("another unit of depth", "one for all frames");
    index_.tenths = tenths;
    return {};
  }

  Result<void> setSize(Fields fields, std::uint32_t bytes) {
    const std::uint32_t width = fields.take<std::uint32_t>().value_or(0);
    const std::uint32_t height = fields.take<std::uint32_t>().value_or(0);
    const bool sound = bytes == 12 && width > 0 && width <= kLargestSide && height > 0 && height <= kLargestSide;
    if (!sound) {
      return bad(fmt::format("images of {} x {} in {} bytes", width, height, bytes), "1 to 2048 pixels, in 12 bytes");
    }
    DepthCamera& camera = index_.info.camera;
    if (!index_.frames.empty() && (std::uint32_t(camera.width) != width || std::uint32_t(camera.height) != height)) {
      return Error{ErrorCode::kUnsupported,
                   fmt::format("{}, byte {}: found images of {} x {} behind those of {} x {}, expected one size", name_,
                               at_, width, height, camera.width, camera.height)};
    }
    camera.width = static_cast<int>(width);
    camera.height = static_cast<int>(height);
    sized_ = true;
    return {};
  }

  Result<void> setFieldOfView(Fields fields, std::uint32_t bytes) {
    const double horizontal = fields.take<double>().value_or(0.0);
    const double vertical = fields.take<double>().value_or(0.0);
    const auto sound = [](double angle) { return angle >= 0.1 && angle <= 3.0; };  // false for NaN
    if (bytes != 16 || !sound(horizontal) || !sound(vertical)) {
      return bad(fmt::format("a field of view of {} x {} rad in {} bytes", horizontal, vertical, bytes),
                 "0.1 to 3, in 16 bytes");
    }
    DepthCamera& camera = index_.info.camera;
    if (!index_.frames.empty() && (camera.horizontalFov != horizontal || camera.verticalFov != vertical)) {
      return bad("another field of view", "one for all frames");
    }
    camera.horizontalFov = horizontal;
    camera.verticalFov = vertical;
    return {};
  }

  Result<void> setCrop(Fields fields, std::uint32_t bytes) {
    const bool enabled = fields.take<std::uint32_t>().value_or(0) != 0;
    OniFrameEntry crop;
    crop.left = fields.take<std::uint16_t>().value_or(0);
    crop.top = fields.take<std::uint16_t>().value_or(0);
    crop.width = fields.take<std::uint16_t>().value_or(0);
    crop.height = fields.take<std::uint16_t>().value_or(0);
    if (bytes != 12) return bad(fmt::format("a cropping of {} bytes", bytes), "12");
    crop_ = enabled ? std::optional(crop) : std::nullopt;
    return {};
  }

  Result<void> data(std::uint32_t node, Fields fields, std::uint32_t bytes, std::uint32_t payloadBytes) {
    const std::uint32_t type = nodes_[node].type;
    if (type == kColor) ++index_.info.colorFrameCount;
    if (type == kInfrared) ++index_.info.infraredFrameCount;
    if (depthNode_ != node) return {};

    if (bytes < 12) return bad(fmt::format("{} bytes of fields in a frame", bytes), "its time and number in 12");
    const std::uint64_t timeUs = fields.take<std::uint64_t>().value_or(0);
    const std::uint32_t number = fields.take<std::uint32_t>().value_or(0);
    if (timeUs > kLatestTimeUs || (!unfinished() && latestUs_ != 0 && timeUs > latestUs_)) {
      return bad(fmt::format("a frame at {} us", timeUs), fmt::format("at most {}, the recording's last", latestUs_));
    }
    if (!index_.frames.empty() && (timeUs <= index_.frames.back().timeUs || number <= lastNumber_)) {
      return bad(fmt::format("frame {} at {} us behind frame {} at {} us", number, timeUs, lastNumber_,
                             index_.frames.back().timeUs),
                 "rising numbers and times");
    }
    lastNumber_ = number;
    if (!sized_) return bad("a depth frame", "the images' size before it");

    const auto width = static_cast<std::uint16_t>(index_.info.camera.width);
    const auto height = static_cast<std::uint16_t>(index_.info.camera.height);
    OniFrameEntry entry = crop_.value_or(OniFrameEntry{.width = width, .height = height});
    if (entry.width == 0 || entry.height == 0 || entry.left + entry.width > width ||
        entry.top + entry.height > height) {
      return bad(fmt::format("an image cropped to {} x {} at {}, {}", entry.width, entry.height, entry.left, entry.top),
                 fmt::format("a part of {} x {}", width, height));
    }
    const std::size_t pixels = std::size_t{entry.width} * entry.height;
    const bool fits =
        index_.info.codec == OniCodec::kRaw ? payloadBytes == 2 * pixels : pixels <= kOniPixelsPerByte * payloadBytes;
    if (!fits || payloadBytes > 4 * pixels + (1 << 17) + 4) {
      return bad(fmt::format("{} bytes of depth", payloadBytes), fmt::format("an image of {} pixels", pixels));
    }
    if (index_.frames.size() >= std::size_t{std::numeric_limits<int>::max()}) return bad("too many frames", "2^31");
    entry.timeUs = timeUs;
    entry.payload = at_ + recordHeader_ + bytes;
    entry.payloadBytes = payloadBytes;
    entry.mirrored = mirrored_;
    index_.info.mirrored = index_.info.mirrored || mirrored_;
    index_.frames.push_back(entry);
    return {};
  }

  Result<void> end() {
    ended_ = true;
    // An end record that was none before a bit flipped has records behind it.
    if (at_ < size_ && !onlyZeros(at_, kPaddingLookedAt)) return bad("bytes behind the end record", "none, or zeros");
    if (declaredFrames_ != kCountUnknown && declaredFrames_ != index_.frames.size()) {
      return bad(fmt::format("the end after {} depth frames", index_.frames.size()),
                 fmt::format("{}, as the file says", declaredFrames_));
    }
    return {};
  }

  Result<OniIndex> finish() {
    if (index_.info.cutOff && countMustEnd_) return bad("no end record", "one");
    if (!depthNode_) {
      return Error{ErrorCode::kUnsupported, fmt::format("{}: found no depth stream, expected one", name_)};
    }
    if (index_.frames.empty()) return bad("no whole depth frame", "one or more");
    OniInfo& info = index_.info;
    info.frameCount = static_cast<int>(index_.frames.size());
    info.duration = 1e-6 * static_cast<double>(index_.frames.back().timeUs - index_.frames.front().timeUs);
    info.end = at_;
    return std::move(index_);
  }

  const OniBytes& bytes_;
  const std::string& name_;
  std::uint64_t size_;
  std::uint64_t at_ = 0;
  std::uint32_t recordHeader_ = 28;
  std::uint64_t latestUs_ = 0;
  bool ended_ = false;

  std::map<std::uint32_t, Node> nodes_;
  std::optional<std::uint32_t> depthNode_;
  std::uint32_t declaredFrames_ = kCountUnknown;
  bool countMustEnd_ = false;
  bool sized_ = false;
  bool mirrored_ = false;
  std::uint32_t lastNumber_ = 0;
  std::optional<OniFrameEntry> crop_;
  OniIndex index_;
};

}  // namespace

Result<OniIndex> indexOni(const OniBytes& bytes, const std::string& name) {
  return Walk(bytes, name).run();
}

}  // namespace lorica
