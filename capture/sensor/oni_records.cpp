#include "capture/sensor/oni_records.h"

#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/interrupt.h"
#include "geometry/little_endian.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <string_view>

namespace lorica {
namespace {

/// The largest sensor images are 1600 x 1200.
constexpr std::uint32_t kLargestSide = 2048;

// Pixel formats as numbered in OniCEnums.h.
constexpr std::uint64_t kMillimetres = 100;
constexpr std::uint64_t kTenthsOfMillimetres = 101;

/// Reads little-endian numbers from a record, never beyond its end.
class OniFields {
 public:
  explicit OniFields(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <typename T>
  std::optional<T> take() {
    if (bytes_.size() < sizeof(T)) return std::nullopt;
    const T value = loadLittleEndian<T>(reinterpret_cast<const char*>(bytes_.data()));
    bytes_ = bytes_.subspan(sizeof(T));
    return value;
  }
  /// @return the bytes up to the first 0
  std::optional<std::string_view> text(std::size_t bytes) {
    if (bytes_.size() < bytes) return std::nullopt;
    const std::string_view whole(reinterpret_cast<const char*>(bytes_.data()), bytes);
    bytes_ = bytes_.subspan(bytes);
    return whole.substr(0, whole.find('\0'));
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

/// Location of a frame's payload in the file.
struct OniPayload {
  std::uint64_t at = 0;
  std::uint32_t bytes = 0;
};

constexpr std::uint64_t kFileHeader = 24;
constexpr std::uint32_t kRecordMagic = 0x0052494e;  // "NIR\0"
constexpr std::uint32_t kCountUnknown = 0xffffffff;
/// Bytes of a record that are inspected: its header, a name and a value. Longer values are tables of the sensor.
constexpr std::size_t kLookedAt = 600;
constexpr std::uint32_t kLongestName = 256;
constexpr std::uint32_t kMaxNodes = 64;
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

struct Node {
  std::uint32_t type = 0;
  bool removed = false;
};

constexpr std::size_t kLongestText = 80;  // in a message [bytes]

class Walk {
 public:
  Walk(const OniBytes& bytes, const std::string& name) : bytes_(bytes), name_(name), size_(bytes.size()) {}

  Result<OniIndex> run() {
    LORICA_TRY_DO(readFileHeader());
    while (!ended_) {
      if (workStopped()) return cancelled();
      LORICA_TRY_DO(readRecord());
    }
    return finish();
  }

 private:
  [[nodiscard]] Error bad(const std::string& found, const std::string& expected) const {
    return badFormat("{}, byte {}: found {}, expected {}", name_, at_, found, expected);
  }

  [[nodiscard]] Error notHandled(const std::string& found, const std::string& expected) const {
    return unsupported("{}, byte {}: found {}, expected {}", name_, at_, found, expected);
  }

  Result<void> readFileHeader() {
    std::array<std::uint8_t, kFileHeader> raw{};
    if (size_ < kFileHeader || !bytes_.read(0, raw)) {
      return bad(fmt::format("{} bytes", size_), "an .oni recording of at least 24 bytes");
    }
    OniFields fields(raw);
    const std::string_view magic = *fields.text(4);
    if (magic != "NI10")
      return bad(fmt::format("\"{}\"", printable(magic, kLongestText)), "\"NI10\" at the start of an .oni recording");
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
      return unsupported("{}, byte 4: found version {}, expected 1.0.0.4 to 1.0.1.0", name_, index_.info.version);
    }
    recordHeader_ = version < kWide ? 24 : 28;
    latestUs_ = *fields.take<std::uint64_t>();
    at_ = kFileHeader;
    return {};
  }

  /// The recorder was killed, or the file is not all of what it wrote: frames before that are whole.
  Result<void> cutOff(const std::string& found) {
    if (index_.frames.empty()) return bad(found, "more records up to an end record");
    index_.info.cutOff = true;
    ended_ = true;
    return {};
  }

  [[nodiscard]] bool onlyZeros(std::uint64_t from, std::uint64_t max) const {
    std::vector<std::uint8_t> raw(std::min(max, size_ - from));
    return bytes_.read(from, raw) && std::all_of(raw.begin(), raw.end(), [](std::uint8_t b) { return b == 0; });
  }

  Result<void> readRecord() {
    if (at_ == size_) return cutOff("the end of the file");
    std::array<std::uint8_t, kLookedAt> raw;
    const std::span<std::uint8_t> whole(raw);
    const std::size_t look = std::min<std::uint64_t>(kLookedAt, size_ - at_);
    if (!bytes_.read(at_, whole.first(look))) {
      return unreadable("{}, byte {}: cannot be read", name_, at_);
    }
    if (look < recordHeader_) return cutOff(fmt::format("only {} bytes before the end of the file", look));
    OniFields header(whole.first(recordHeader_));
    const std::uint32_t magic = *header.take<std::uint32_t>();
    if (magic != kRecordMagic) {
      if (magic == 0 && onlyZeros(at_, kPaddingLookedAt)) return cutOff("zeros");
      return bad(fmt::format("0x{:08x}", magic), "0x0052494e at the start of a record");
    }
    const std::uint32_t type = *header.take<std::uint32_t>();
    const std::uint32_t node = *header.take<std::uint32_t>();
    const std::uint32_t fieldsBytes = *header.take<std::uint32_t>();
    const std::uint32_t payloadBytes = *header.take<std::uint32_t>();
    if (fieldsBytes < recordHeader_) {
      return bad(fmt::format("a record of {} bytes", fieldsBytes), fmt::format("at least {}", recordHeader_));
    }
    const std::uint64_t total = std::uint64_t{fieldsBytes} + payloadBytes;
    if (total > size_ - at_) {
      return cutOff(fmt::format("a record of {} bytes, {} before the end of the file", total, size_ - at_));
    }
    if (payloadBytes != 0 && type != kData && type != kSeekTable) {
      return bad(fmt::format("{} bytes of payload in a record of type {}", payloadBytes, type), "none");
    }
    const std::size_t inSight = std::min<std::size_t>(fieldsBytes, look);
    const OniFields fields(whole.subspan(recordHeader_, inSight - recordHeader_));
    const std::uint32_t ownBytes = fieldsBytes - recordHeader_;
    LORICA_TRY_DO(handle(type, node, fields, ownBytes, payloadBytes));
    at_ += total;
    if (type == kEnd) return end();
    return {};
  }

  Result<void> handle(std::uint32_t type, std::uint32_t node, OniFields fields, std::uint32_t bytes,
                      std::uint32_t payloadBytes) {
    switch (type) {
      case kNodeAdded4:
      case kNodeAdded5:
      case kNodeAdded:
        return addNode(type, node, fields, bytes);
      case kEnd:
        return {};
      case kSeekTable:  // may come after its node was removed
        return known(node, true);
      case kInt:
      case kReal:
      case kString:
      case kGeneral:
        LORICA_TRY_DO(known(node, false));
        return property(type, node, fields, bytes);
      case kNodeRemoved:
        LORICA_TRY_DO(known(node, false));
        nodes_[node].removed = true;
        return {};
      case kNodeReady:
      case kDataBegin:
        return known(node, false);
      case kData:
        LORICA_TRY_DO(known(node, false));
        return data(node, fields, bytes, payloadBytes);
      default:
        return bad(fmt::format("a record of type {}", type), "2 to 14");
    }
  }

  [[nodiscard]] Result<void> known(std::uint32_t node, bool evenRemoved) const {
    const auto found = nodes_.find(node);
    if (found == nodes_.end()) return bad(fmt::format("a record of node {}", node), "one of a node that was added");
    if (found->second.removed && !evenRemoved) {
      return bad(fmt::format("a record of node {}", node), "none, because the node was removed");
    }
    return {};
  }

  Result<void> addNode(std::uint32_t type, std::uint32_t node, OniFields fields, std::uint32_t bytes) {
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
      return bad(fmt::format("node {} added again", node), "each node only once");
    }
    if (found == nodes_.end() && nodes_.size() >= kMaxNodes) {
      return bad(fmt::format("more than {} nodes", kMaxNodes), "a device and its streams");
    }
    nodes_[node] = {*nodeType, false};
    if (*nodeType == kDevice && index_.info.device.empty()) index_.info.device = printable(*name, kLongestText);
    if (*nodeType != kDepth || depthNode_) return {};

    depthNode_ = node;
    declaredFrames_ = frames;
    return setCodec(*codec);
  }

  Result<void> property(std::uint32_t type, std::uint32_t node, OniFields fields, std::uint32_t bytes) {
    const std::uint32_t nameBytes = fields.take<std::uint32_t>().value_or(0);
    if (nameBytes == 0 || nameBytes > kLongestName) {
      return bad(fmt::format("a property's name of {} bytes", nameBytes), "1 to 256");
    }
    const std::optional<std::string_view> name = fields.text(nameBytes);
    const std::optional<std::uint32_t> valueBytes = fields.take<std::uint32_t>();
    if (!name || !valueBytes || std::uint64_t{8} + nameBytes + *valueBytes != bytes) {
      return bad(fmt::format("{} bytes of fields in a property", bytes), "its name, its size and that many bytes");
    }
    if ((type == kInt || type == kReal) && *valueBytes != 8) {
      return bad(fmt::format("{} bytes of number \"{}\"", *valueBytes, printable(*name, kLongestText)), "8");
    }
    if (type == kString && *valueBytes <= kLongestName && nodes_[node].type == kDevice &&
        (*name == "PhysicalDeviceName" || *name == "DeviceName")) {
      if (const auto text = fields.text(*valueBytes); text && !text->empty())
        index_.info.device = printable(*text, kLongestText);
      return {};
    }
    if (depthNode_ != node) return {};
    if (type == kInt) return setNumber(*name, fields.take<std::uint64_t>().value_or(0));
    if (type == kGeneral) return setGeneral(*name, fields, *valueBytes);
    return {};
  }

  Result<void> data(std::uint32_t node, OniFields fields, std::uint32_t bytes, std::uint32_t payloadBytes) {
    const std::uint32_t type = nodes_[node].type;
    if (type == kColor) ++index_.info.colorFrameCount;
    if (type == kInfrared) ++index_.info.infraredFrameCount;
    if (depthNode_ != node) return {};
    const bool bounded = declaredFrames_ != kCountUnknown && latestUs_ != 0;
    const std::uint64_t latestUs = bounded ? std::min(latestUs_, kLatestTimeUs) : kLatestTimeUs;
    return addFrame(fields, {at_ + recordHeader_ + bytes, payloadBytes}, latestUs);
  }

  // Properties and frames of the depth node.

  Result<void> setCodec(std::uint32_t codec) {
    index_.info.codec = static_cast<OniCodec>(codec);
    switch (index_.info.codec) {
      case OniCodec::kRaw:
      case OniCodec::kPacked:
      case OniCodec::kTable:
        return {};
    }
    return notHandled(fmt::format("depth codec 0x{:08x}", codec), "NONE, 16zP or 16zT");
  }

  Result<void> setNumber(std::string_view name, std::uint64_t value) {
    if (name == "xnMirror") mirrored_ = value != 0;
    if (name == "oniPixelFormat") return setPixelFormat(value);
    return {};
  }

  /// @param bytes  size of the value according to the record
  Result<void> setGeneral(std::string_view name, OniFields value, std::uint32_t bytes) {
    if (name == "xnMapOutputMode") return setSize(value, bytes);
    if (name == "xnFOV") return setFieldOfView(value, bytes);
    if (name == "xnCropping") return setCrop(value, bytes);
    return {};
  }

  Result<void> setPixelFormat(std::uint64_t format) {
    if (format != kMillimetres && format != kTenthsOfMillimetres) {
      return notHandled(fmt::format("depth in pixel format {}", format), "100 (millimetres) or 101 (tenths)");
    }
    const bool tenths = format == kTenthsOfMillimetres;
    if (tenths != index_.tenths && !index_.frames.empty())
      return bad("a different depth unit", "the same for all frames");
    index_.tenths = tenths;
    return {};
  }

  Result<void> setSize(OniFields value, std::uint32_t bytes) {
    const std::uint32_t width = value.take<std::uint32_t>().value_or(0);
    const std::uint32_t height = value.take<std::uint32_t>().value_or(0);
    const bool sound = bytes == 12 && width > 0 && width <= kLargestSide && height > 0 && height <= kLargestSide;
    if (!sound) {
      return bad(fmt::format("images of {} x {} in {} bytes", width, height, bytes), "1 to 2048 pixels, in 12 bytes");
    }
    DepthCamera& camera = index_.info.camera;
    const bool same =
        static_cast<std::uint32_t>(camera.width) == width && static_cast<std::uint32_t>(camera.height) == height;
    if (!index_.frames.empty() && !same) {
      return notHandled(
          fmt::format("images of {} x {} after images of {} x {}", width, height, camera.width, camera.height),
          "the same size");
    }
    camera.width = width;
    camera.height = height;
    sized_ = true;
    return {};
  }

  Result<void> setFieldOfView(OniFields value, std::uint32_t bytes) {
    const double horizontal = value.take<double>().value_or(0.0);
    const double vertical = value.take<double>().value_or(0.0);
    const auto sound = [](double angle) { return angle >= 0.1 && angle <= 3.0; };  // false for NaN
    if (bytes != 16 || !sound(horizontal) || !sound(vertical)) {
      return bad(fmt::format("a field of view of {} x {} rad in {} bytes", horizontal, vertical, bytes),
                 "0.1 to 3, in 16 bytes");
    }
    DepthCamera& camera = index_.info.camera;
    if (!index_.frames.empty() && (camera.horizontalFov != horizontal || camera.verticalFov != vertical)) {
      return bad("a different field of view", "the same for all frames");
    }
    camera.horizontalFov = horizontal;
    camera.verticalFov = vertical;
    return {};
  }

  Result<void> setCrop(OniFields value, std::uint32_t bytes) {
    const bool enabled = value.take<std::uint32_t>().value_or(0) != 0;
    OniFrameEntry crop;
    crop.left = value.take<std::uint16_t>().value_or(0);
    crop.top = value.take<std::uint16_t>().value_or(0);
    crop.width = value.take<std::uint16_t>().value_or(0);
    crop.height = value.take<std::uint16_t>().value_or(0);
    if (bytes != 12) return bad(fmt::format("a cropping property of {} bytes", bytes), "12");
    crop_ = enabled ? std::optional(crop) : std::nullopt;
    return {};
  }

  /// @param fields    time and number
  /// @param latestUs  max time of a frame
  Result<void> addFrame(OniFields fields, OniPayload payload, std::uint64_t latestUs) {
    const std::optional<std::uint64_t> timeUs = fields.take<std::uint64_t>();
    const std::optional<std::uint32_t> number = fields.take<std::uint32_t>();
    if (!timeUs || !number) return bad("a frame with fewer than 12 bytes of fields", "its time and number");
    if (*timeUs > latestUs) return bad(fmt::format("a frame at {} us", *timeUs), fmt::format("at most {}", latestUs));
    if (!index_.frames.empty() && (*timeUs <= index_.frames.back().timeUs || *number <= lastNumber_)) {
      return bad(fmt::format("frame {} at {} us after frame {} at {} us", *number, *timeUs, lastNumber_,
                             index_.frames.back().timeUs),
                 "increasing numbers and times");
    }
    lastNumber_ = *number;
    if (!sized_) return bad("a depth frame", "the image size before it");

    const std::uint16_t width = index_.info.camera.width;
    const std::uint16_t height = index_.info.camera.height;
    OniFrameEntry entry = crop_.value_or(OniFrameEntry{.width = width, .height = height});
    if (entry.width == 0 || entry.height == 0 || entry.left + entry.width > width ||
        entry.top + entry.height > height) {
      return bad(fmt::format("an image cropped to {} x {} at {}, {}", entry.width, entry.height, entry.left, entry.top),
                 fmt::format("a region within {} x {}", width, height));
    }
    const std::size_t pixels = std::size_t{entry.width} * entry.height;
    const bool fits =
        index_.info.codec == OniCodec::kRaw ? payload.bytes == 2 * pixels : pixels <= kOniPixelsPerByte * payload.bytes;
    constexpr std::size_t kLargestTable = 2 + (1 << 17);
    if (!fits || payload.bytes > 4 * pixels + kLargestTable) {
      return bad(fmt::format("{} bytes of depth", payload.bytes), fmt::format("an image of {} pixels", pixels));
    }
    if (index_.frames.size() >= std::size_t{std::numeric_limits<int>::max()})
      return bad("too many frames", "at most 2^31");
    entry.timeUs = *timeUs;
    entry.payload = payload.at;
    entry.payloadBytes = payload.bytes;
    entry.mirrored = mirrored_;
    index_.info.mirrored = index_.info.mirrored || mirrored_;
    index_.frames.push_back(entry);
    return {};
  }

  Result<void> end() {
    ended_ = true;
    // After a bit flip a record can look like an end record; then other records follow.
    if (at_ < size_ && !onlyZeros(at_, kPaddingLookedAt)) return bad("bytes after the end record", "none, or zeros");
    if (declaredFrames_ != kCountUnknown && declaredFrames_ != index_.frames.size()) {
      return bad(fmt::format("the end after {} depth frames", index_.frames.size()),
                 fmt::format("{}, as declared in the file", declaredFrames_));
    }
    return {};
  }

  Result<OniIndex> finish() {
    if (!depthNode_) {
      return unsupported("{}: found no depth stream, expected one", name_);
    }
    if (index_.frames.empty()) return bad("no complete depth frame", "at least one");
    OniInfo& info = index_.info;
    info.frameCount = countOf(index_.frames);
    info.duration = 1e-6 * (index_.frames.back().timeUs - index_.frames.front().timeUs);
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
  OniIndex index_;

  // Of the depth node.
  bool sized_ = false;
  bool mirrored_ = false;
  std::uint32_t lastNumber_ = 0;
  std::optional<OniFrameEntry> crop_;
};

}  // namespace

Result<OniIndex> indexOni(const OniBytes& bytes, const std::string& name) {
  return Walk(bytes, name).run();
}

}  // namespace lorica
