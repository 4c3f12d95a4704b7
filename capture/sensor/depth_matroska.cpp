#include "capture/sensor/oni_records.h"
#include "capture/sensor/raw_depth.h"
#include "geometry/errors.h"
#include "geometry/interrupt.h"
#include "geometry/json.h"
#include "geometry/little_endian.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

// Matroska: elements of an id, a size and content, inside each other (RFC 8794, RFC 9559). Only what Azure Kinect's and
// Femto's recorders write is read: a track named DEPTH of 16-bit big-endian or PNG images, and calibration.json.

namespace lorica {
namespace {

enum MatroskaId : std::uint32_t {
  kSegment = 0x18538067,
  kInfo = 0x1549a966,
  kTimestampScale = 0x2ad7b1,
  kTracks = 0x1654ae6b,
  kTrackEntry = 0xae,
  kTrackNumber = 0xd7,
  kTrackName = 0x536e,
  kCodec = 0x86,
  kCodecPrivate = 0x63a2,
  kVideo = 0xe0,
  kPixelWidth = 0xb0,
  kPixelHeight = 0xba,
  kCluster = 0x1f43b675,
  kClusterTimestamp = 0xe7,
  kSimpleBlock = 0xa3,
  kBlockGroup = 0xa0,
  kBlock = 0xa1,
  kAttachments = 0x1941a469,
  kAttachedFile = 0x61a7,
  kFileName = 0x466e,
  kFileData = 0x465c,
};

constexpr std::uint64_t kMaxText = 1 << 20;  // bytes of what is read whole: names, a calibration

struct MatroskaBlock {
  double time = 0.0;  ///< in units of the time scale
  std::uint64_t track = 0, at = 0, bytes = 0;
};

struct MatroskaTrack {
  std::uint64_t number = 0, width = 0, height = 0;
  std::string name, codec, fourCc;
};

/// Walks the elements of a file, of which it reads the heads.
class MatroskaFile {
 public:
  MatroskaFile(const OniBytes& bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  /// All elements, one after the other: those that hold others are not left where they end, so a recorder that was
  /// killed before it wrote their sizes does not matter.
  Result<void> walk() {
    const std::uint64_t end = bytes_.size();
    for (std::uint64_t at = 0; at < end;) {
      if (++elements_ > kMaxDepthRecords) {
        return badFormat("{}: found more than {} elements, expected at most that", name_, grouped(kMaxDepthRecords));
      }
      if (workStopped()) return cancelled();
      const std::uint64_t begin = at;
      std::uint64_t id = 0, size = 0;
      int idLength = 0, sizeLength = 0;
      const bool whole = number(at, true, id, idLength) && idLength <= 4 && number(at, false, size, sizeLength);
      const bool open = whole && size == (std::uint64_t{1} << (7 * sizeLength)) - 1;
      if (!whole && end - begin > 12) {
        return badFormat("{}, byte {}: found no element of Matroska, expected one", name_, begin);
      }
      if (whole && holdsElements(static_cast<std::uint32_t>(id))) continue;
      cutOff = !whole || open || size > end - at;
      if (cutOff) return {};
      LORICA_TRY_DO(take(static_cast<std::uint32_t>(id), at, size));
      at += size;
    }
    return {};
  }

  double nanosecondsPerUnit = 1e6;
  std::vector<MatroskaTrack> tracks;
  std::vector<MatroskaBlock> blocks;
  std::string calibration;
  bool cutOff = false;

 private:
  /// A number whose first byte says by its zeros how many there are.
  bool number(std::uint64_t& at, bool keepMark, std::uint64_t& value, int& length) const {
    std::array<std::uint8_t, 8> read{};
    if (!bytes_.read(at, std::span(read).first(1)) || read[0] == 0) return false;
    length = std::countl_zero(read[0]) + 1;
    if (!bytes_.read(at, std::span(read).first(length))) return false;
    value = keepMark ? read[0] : read[0] & (0xffU >> length);
    for (int i = 1; i < length; ++i) value = value << 8 | read[i];
    at += length;
    return true;
  }

  std::string textAt(std::uint64_t at, std::uint64_t size) const {
    std::string text(std::min(size, kMaxText), '\0');
    if (!bytes_.read(at, {reinterpret_cast<std::uint8_t*>(text.data()), text.size()})) return {};
    return text.substr(0, text.find('\0'));
  }

  std::uint64_t wholeAt(std::uint64_t at, std::uint64_t size) const {
    std::uint64_t value = 0;
    std::array<std::uint8_t, 8> read{};
    if (size > read.size() || !bytes_.read(at, std::span(read).first(size))) return 0;
    for (std::uint64_t i = 0; i < size; ++i) value = value << 8 | read[i];
    return value;
  }

  bool holdsElements(std::uint32_t id) {
    constexpr std::array<std::uint32_t, 9> kHolders = {kSegment, kInfo,       kTracks,      kTrackEntry,  kVideo,
                                                       kCluster, kBlockGroup, kAttachments, kAttachedFile};
    if (id == kTrackEntry) tracks.emplace_back();
    return std::ranges::find(kHolders, id) != kHolders.end();
  }

  Result<void> take(std::uint32_t id, std::uint64_t at, std::uint64_t size) {
    if (id == kSimpleBlock || id == kBlock) return block(at, size);
    if (id == kTimestampScale) nanosecondsPerUnit = static_cast<double>(wholeAt(at, size));
    if (id == kClusterTimestamp) cluster_ = static_cast<double>(wholeAt(at, size));
    if (id == kFileName) attached_ = textAt(at, size);
    if (id == kFileData && attached_ == "calibration.json") calibration = textAt(at, size);
    if (tracks.empty()) return {};
    MatroskaTrack& track = tracks.back();
    if (id == kTrackNumber) track.number = wholeAt(at, size);
    if (id == kPixelWidth) track.width = wholeAt(at, size);
    if (id == kPixelHeight) track.height = wholeAt(at, size);
    if (id == kTrackName) track.name = textAt(at, size);
    if (id == kCodec) track.codec = textAt(at, size);
    if (id == kCodecPrivate && size >= 20) track.fourCc = textAt(at + 16, 4);  // of Windows' BITMAPINFOHEADER
    return {};
  }

  Result<void> block(std::uint64_t at, std::uint64_t size) {
    MatroskaBlock block;
    const std::uint64_t end = at + size, begin = at;
    int length = 0;
    std::array<std::uint8_t, 3> head{};
    if (!number(at, false, block.track, length) || end < at + head.size() || !bytes_.read(at, head)) {
      return badFormat("{}, byte {}: found a block of {} bytes, expected a track and a time", name_, begin, size);
    }
    constexpr std::uint8_t kLaced = 0x06;
    if ((head[2] & kLaced) != 0)
      return unsupported("{}, byte {}: found a block of several frames, expected one", name_, begin);
    block.time = cluster_ + static_cast<std::int16_t>(head[0] << 8 | head[1]);
    block.at = at + head.size();
    block.bytes = end - block.at;
    blocks.push_back(block);
    return {};
  }

  const OniBytes& bytes_;
  const std::string& name_;
  std::size_t elements_ = 0;
  double cluster_ = 0.0;
  std::string attached_;
};

/// Which part of the sensor each of the camera's modes shows, and in which size.
struct KinectMode {
  int width, height, sensor, left, top;
};
constexpr std::array kKinectModes = {KinectMode{640, 576, 1024, 192, 180}, KinectMode{320, 288, 512, 96, 90},
                                     KinectMode{1024, 1024, 1024, 0, 0}, KinectMode{512, 512, 512, 0, 0}};

/// The depth camera of a calibration as Azure Kinect's library stores it: cx cy fx fy in widths of the sensor, k1 to
/// k6, two unused, p2, p1.
Result<std::optional<DepthLens>> kinectLens(const std::string& calibration, const std::string& name, int width,
                                            int height) {
  const auto* const mode = std::ranges::find_if(
      kKinectModes, [&](const KinectMode& each) { return each.width == width && each.height == height; });
  if (calibration.empty() || mode == kKinectModes.end()) return std::optional<DepthLens>();
  LORICA_TRY(const nlohmann::json json, parseJson(calibration, name + ": calibration.json"));
  const nlohmann::json none;
  const auto member = [&](const nlohmann::json& in, const char* key) -> const nlohmann::json& {
    const auto found = in.is_object() ? in.find(key) : in.end();
    return found == in.end() ? none : *found;
  };
  for (const nlohmann::json& camera : member(member(json, "CalibrationInformation"), "Cameras")) {
    const nlohmann::json& purpose = member(camera, "Purpose");
    if (!purpose.is_string() || purpose.get_ref<const std::string&>().find("Depth") == std::string::npos) continue;
    std::vector<double> p;
    for (const nlohmann::json& each : member(member(camera, "Intrinsics"), "ModelParameters")) {
      if (each.is_number()) p.push_back(each.get<double>());
    }
    constexpr std::size_t kParameters = 14;
    if (p.size() != kParameters) {
      return badFormat("{}: calibration.json: found {} numbers of the depth camera's lens, expected {}", name, p.size(),
                       kParameters);
    }
    const double side = mode->sensor;
    return std::optional(DepthLens{width,
                                   height,
                                   p[2] * side,
                                   p[3] * side,
                                   p[0] * side - mode->left - 0.5,
                                   p[1] * side - mode->top - 0.5,
                                   {p[4], p[5], p[13], p[12], p[6], p[7], p[8], p[9]},
                                   0.001});
  }
  return std::optional<DepthLens>();
}

}  // namespace

Result<RawDepth> readDepthMatroska(std::shared_ptr<const OniBytes> bytes, const std::string& name,
                                   const GivenLens& lens) {
  MatroskaFile file(*bytes, name);
  LORICA_TRY_DO(file.walk());
  const bool named = std::ranges::any_of(file.tracks, [](const MatroskaTrack& track) { return track.name == "DEPTH"; });
  const auto depth = std::ranges::find_if(
      file.tracks, [&](const MatroskaTrack& track) { return named ? track.name == "DEPTH" : track.fourCc == "b16g"; });
  if (depth == file.tracks.end()) {
    std::string found;
    for (const MatroskaTrack& track : file.tracks) {
      found += (found.empty() ? "" : ", ") + printable(track.name.empty() ? track.codec : track.name, 40);
    }
    return unsupported(
        "{}: found a film (Matroska) of {} ({}), expected a track named DEPTH, as an Azure Kinect's recorder writes",
        name, counted(std::ssize(file.tracks), "track"), found);
  }
  const bool png = depth->fourCc == "MPNG" || depth->codec == "V_PNG";
  if (!png && depth->fourCc != "b16g" && depth->fourCc != "Y16 ") {
    return unsupported("{}: found depth in the codec {} {}, expected 16-bit gray (b16g) or PNG", name,
                       printable(depth->codec, 40), printable(depth->fourCc, 8));
  }
  constexpr std::uint64_t kMost = 1 << 20;
  const int width = static_cast<int>(std::min(depth->width, kMost)),
            height = static_cast<int>(std::min(depth->height, kMost));
  RawDepth raw;
  LORICA_TRY(const std::optional<DepthLens> own, kinectLens(file.calibration, name, width, height));
  if (own) raw.about.lens = "its calibration";
  LORICA_TRY(raw.lens, prefixed(name, lens.lensOf(width, height, own, 0.001, raw.about.lens)));
  raw.about.format = png ? "Matroska, PNG" : "Matroska, 16-bit gray";
  raw.about.cutOff = file.cutOff;
  std::erase_if(file.blocks, [&](const MatroskaBlock& block) { return block.track != depth->number; });
  const std::uint64_t imageBytes = std::uint64_t{2} * static_cast<std::uint64_t>(width) * height;
  for (const MatroskaBlock& block : file.blocks) {
    raw.times.push_back(1e-9 * file.nanosecondsPerUnit * block.time);
    if (!png && block.bytes != imageBytes) {
      return badFormat("{}, byte {}: found an image of {} bytes, expected {} for {} x {}", name, block.at, block.bytes,
                       imageBytes, width, height);
    }
  }
  const std::endian order = depth->fourCc == "Y16 " ? std::endian::little : std::endian::big;
  raw.read = [bytes = std::move(bytes), blocks = std::move(file.blocks), name, width, height, png, order,
              packed = std::string()](int frame, std::span<std::uint16_t> image) mutable -> Result<void> {
    const MatroskaBlock& block = blocks[frame];
    const std::string where = fmt::format("{}, image {} at byte {}", name, frame, block.at);
    constexpr std::uint64_t kMaxPacked = 64 << 20;
    if (block.bytes > kMaxPacked)
      return badFormat("{}: found {} bytes, expected at most {}", where, block.bytes, kMaxPacked);
    packed.resize(block.bytes);
    if (!bytes->read(block.at, {reinterpret_cast<std::uint8_t*>(packed.data()), packed.size()})) {
      return unreadable("{}: can no longer be read", where);
    }
    if (png) return decodeDepthPng(packed, where, width, height, image);
    for (std::size_t i = 0; i < image.size(); ++i) image[i] = loadBytes<std::uint16_t>(packed.data() + 2 * i, order);
    return {};
  };
  return raw;
}

}  // namespace lorica
