#include "capture/sensor/oni_records.h"
#include "capture/sensor/raw_depth.h"
#include "geometry/byte_reader.h"
#include "geometry/errors.h"
#include "geometry/interrupt.h"
#include "geometry/little_endian.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>

// ROS 1's bag 2.0: records of a header, which is fields NAME=VALUE, and data. Messages lie in chunks, which may be
// packed; the index after each chunk says where in it they begin.

namespace lorica {
namespace {

enum class BagOp : std::uint8_t { kMessage = 2, kBag = 3, kIndex = 4, kChunk = 5, kChunkInfo = 6, kConnection = 7 };

constexpr std::uint32_t kMaxBagHeader = 1 << 20;  // bytes
constexpr std::uint32_t kMaxChunk = 1 << 28;      // bytes, unpacked
constexpr std::size_t kMaxConnections = 10'000;

using BagFields = std::map<std::string, std::string, std::less<>>;

/// Fields of a header: the length of each, then NAME=VALUE.
Result<BagFields> bagFields(std::string_view header, const std::string& where) {
  BagFields fields;
  while (!header.empty()) {
    const std::uint32_t size = header.size() < 4 ? ~0U : loadLittleEndian<std::uint32_t>(header.data());
    if (size > header.size() - std::min<std::size_t>(4, header.size())) {
      return badFormat("{}: found a field of {} bytes, expected at most {}", where, size, header.size());
    }
    const std::string_view field = header.substr(4, size);
    const std::size_t equals = field.find('=');
    if (equals == std::string_view::npos) return badFormat("{}: found a field without '='", where);
    fields.emplace(field.substr(0, equals), field.substr(equals + 1));
    header.remove_prefix(4 + size);
  }
  return fields;
}

template <typename T>
T fieldOf(const BagFields& fields, std::string_view name) {
  const auto found = fields.find(name);
  return found != fields.end() && found->second.size() == sizeof(T) ? loadLittleEndian<T>(found->second.data()) : T{};
}

std::string textOf(const BagFields& fields, std::string_view name) {
  const auto found = fields.find(name);
  return found != fields.end() ? found->second : std::string();
}

struct BagChunk {
  std::uint64_t at = 0;
  std::uint32_t bytes = 0, unpacked = 0;
  std::string packing;  ///< "none", "bz2", "lz4"
};
struct BagMessage {
  double time = 0.0;  ///< when it was received [s]
  std::uint32_t chunk = 0, at = 0;
};
struct BagConnection {
  std::string topic, type;
  std::vector<BagMessage> messages;
};

// Debian's libraries, loaded on first use. `out` has the size of what was packed.
template <typename Function>
Function* loaded(const char* library, const char* name) {
  void* const handle = dlopen(library, RTLD_NOW | RTLD_LOCAL);
  return handle == nullptr ? nullptr : reinterpret_cast<Function*>(dlsym(handle, name));
}

/// An LZ4 frame. Says whether it makes exactly `out`.
Result<bool> unpackLz4(std::string_view from, std::string& out, const std::string& where) {
  constexpr const char* kLibrary = "liblz4.so.1";
  constexpr unsigned kVersion = 100;  // LZ4F_VERSION
  static auto* const begin = loaded<std::size_t(void**, unsigned)>(kLibrary, "LZ4F_createDecompressionContext");
  static auto* const end = loaded<std::size_t(void*)>(kLibrary, "LZ4F_freeDecompressionContext");
  static auto* const unpack = loaded<std::size_t(void*, void*, std::size_t*, const void*, std::size_t*, const void*)>(
      kLibrary, "LZ4F_decompress");
  void* state = nullptr;
  if (begin == nullptr || end == nullptr || unpack == nullptr || begin(&state, kVersion) != 0) {
    return unsupported("{}: is packed by LZ4, expected {} (package liblz4-1)", where, kLibrary);
  }
  std::size_t read = from.size(), written = out.size();
  const bool whole = unpack(state, out.data(), &written, from.data(), &read, nullptr) == 0;
  end(state);
  return whole && written == out.size();
}

Result<bool> unpackBz2(std::string_view from, std::string& out, const std::string& where) {
  constexpr const char* kLibrary = "libbz2.so.1.0";
  static auto* const unpack =
      loaded<int(char*, unsigned*, char*, unsigned, int, int)>(kLibrary, "BZ2_bzBuffToBuffDecompress");
  if (unpack == nullptr) {
    return unsupported("{}: is packed by bzip2, expected {} (package libbz2-1.0)", where, kLibrary);
  }
  auto size = static_cast<unsigned>(out.size());
  const bool whole =
      unpack(out.data(), &size, const_cast<char*>(from.data()), static_cast<unsigned>(from.size()), 0, 0) == 0;
  return whole && size == out.size();
}

class BagFile {
 public:
  BagFile(std::shared_ptr<const OniBytes> bytes, std::string name) : bytes_(std::move(bytes)), name_(std::move(name)) {}

  std::map<std::uint32_t, BagConnection> connections;

  /// Reads the heads of all records.
  Result<void> walk() {
    std::uint64_t at = std::strlen("#ROSBAG V2.0\n");
    std::size_t records = 0;
    std::optional<std::uint32_t> chunk;
    while (at < bytes_->size()) {
      if (++records > kMaxDepthRecords)
        return badFormat("{}: found more than {} records", name_, grouped(kMaxDepthRecords));
      if (workStopped()) return cancelled();
      LORICA_TRY(const Record record, recordAt(at));
      at = record.end;
      const BagOp op{fieldOf<std::uint8_t>(record.fields, "op")};
      if (op == BagOp::kBag) {
        if (fieldOf<std::uint64_t>(record.fields, "index_pos") == 0) {
          return unsupported("{}: its recorder was killed, so it has no index: `rosbag reindex` makes one", name_);
        }
      } else if (op == BagOp::kChunk) {
        chunk = static_cast<std::uint32_t>(chunks_.size());
        chunks_.push_back({record.data, record.bytes, fieldOf<std::uint32_t>(record.fields, "size"),
                           textOf(record.fields, "compression")});
        if (std::max(chunks_.back().bytes, chunks_.back().unpacked) > kMaxChunk) {
          return badFormat("{}, byte {}: found a chunk of {} bytes, expected at most {}", name_, record.data,
                           std::max(chunks_.back().bytes, chunks_.back().unpacked), kMaxChunk);
        }
      } else if (op == BagOp::kIndex && chunk) {
        LORICA_TRY_DO(index(record, *chunk));
      } else if (op == BagOp::kConnection) {
        LORICA_TRY_DO(connection(record));
      }
    }
    return {};
  }

  /// A message's bytes, until the next call.
  Result<std::string_view> message(const BagMessage& message) {
    const BagChunk& chunk = chunks_[message.chunk];
    const std::string where = fmt::format("{}, chunk at byte {}", name_, chunk.at);
    if (loaded_ != message.chunk) LORICA_TRY_DO(load(message.chunk, where));
    const std::string_view content =
        std::string_view(content_).substr(std::min<std::size_t>(message.at, content_.size()));
    const auto part = [&](std::size_t at) -> std::optional<std::string_view> {
      if (at > content.size() || content.size() - at < 4) return std::nullopt;
      const std::uint32_t size = loadLittleEndian<std::uint32_t>(content.data() + at);
      return size <= content.size() - at - 4 ? std::optional(content.substr(at + 4, size)) : std::nullopt;
    };
    const std::optional<std::string_view> header = part(0);
    const std::optional<std::string_view> data = header ? part(4 + header->size()) : std::nullopt;
    if (!data) return badFormat("{}: found no message at {} of {} bytes", where, message.at, content_.size());
    return *data;
  }

 private:
  struct Record {
    BagFields fields;
    std::uint64_t data = 0, end = 0;
    std::uint32_t bytes = 0;
  };

  Result<Record> recordAt(std::uint64_t at) {
    const std::string where = fmt::format("{}, byte {}", name_, at);
    const auto size = [&](std::uint64_t from, std::uint64_t most) -> Result<std::uint32_t> {
      std::array<std::uint8_t, 4> read{};
      const bool there = bytes_->read(from, read);
      const auto value = loadLittleEndian<std::uint32_t>(reinterpret_cast<const char*>(read.data()));
      if (!there || value > most || value > bytes_->size() - from - 4) {
        return badFormat("{}: found a record that reaches beyond the file's {} bytes", where, bytes_->size());
      }
      return value;
    };
    Record record;
    LORICA_TRY(const std::uint32_t header, size(at, kMaxBagHeader));
    std::string content(header, '\0');
    if (!bytes_->read(at + 4, {reinterpret_cast<std::uint8_t*>(content.data()), content.size()})) {
      return unreadable("{}: cannot be read", where);
    }
    LORICA_TRY(record.fields, bagFields(content, where));
    LORICA_TRY(record.bytes, size(at + 4 + header, ~0U));
    record.data = at + 8 + header;
    record.end = record.data + record.bytes;
    return record;
  }

  Result<std::string> dataOf(const Record& record) {
    std::string data(record.bytes, '\0');
    if (!bytes_->read(record.data, {reinterpret_cast<std::uint8_t*>(data.data()), data.size()})) {
      return unreadable("{}, byte {}: cannot be read", name_, record.data);
    }
    return data;
  }

  Result<void> index(const Record& record, std::uint32_t chunk) {
    constexpr std::size_t kEntry = 12;  // seconds, nanoseconds, place in the chunk
    LORICA_TRY(const std::string data, dataOf(record));
    const auto count = fieldOf<std::uint32_t>(record.fields, "count");
    if (data.size() != count * kEntry) {
      return badFormat("{}, byte {}: found an index of {} bytes, expected {} messages", name_, record.data, data.size(),
                       count);
    }
    messages_ += count;
    if (messages_ > kMaxDepthRecords)
      return badFormat("{}: found more than {} messages", name_, grouped(kMaxDepthRecords));
    LORICA_TRY(BagConnection* const to, connectionOf(record));
    for (std::size_t i = 0; i < count; ++i) {
      const char* at = data.data() + i * kEntry;
      to->messages.push_back({loadLittleEndian<std::uint32_t>(at) + 1e-9 * loadLittleEndian<std::uint32_t>(at + 4),
                              chunk, loadLittleEndian<std::uint32_t>(at + 8)});
    }
    return {};
  }

  Result<void> connection(const Record& record) {
    if (record.bytes > kMaxBagHeader)
      return badFormat("{}, byte {}: found a connection of {} bytes", name_, record.data, record.bytes);
    LORICA_TRY(const std::string data, dataOf(record));
    LORICA_TRY(const BagFields fields, bagFields(data, fmt::format("{}, byte {}", name_, record.data)));
    LORICA_TRY(BagConnection* const to, connectionOf(record));
    to->topic = textOf(record.fields, "topic");
    to->type = textOf(fields, "type");
    return {};
  }

  Result<BagConnection*> connectionOf(const Record& record) {
    BagConnection& found = connections[fieldOf<std::uint32_t>(record.fields, "conn")];
    if (connections.size() > kMaxConnections) return badFormat("{}: found more than {} topics", name_, kMaxConnections);
    return &found;
  }

  Result<void> load(std::uint32_t number, const std::string& where) {
    const BagChunk& chunk = chunks_[number];
    loaded_.reset();
    packed_.resize(chunk.bytes);
    if (!bytes_->read(chunk.at, {reinterpret_cast<std::uint8_t*>(packed_.data()), packed_.size()})) {
      return unreadable("{}: can no longer be read", where);
    }
    content_.resize(chunk.unpacked);
    Result<bool> whole = true;
    if (chunk.packing == "none") {
      std::swap(content_, packed_);
    } else if (chunk.packing == "lz4") {
      whole = unpackLz4(packed_, content_, where);
    } else if (chunk.packing == "bz2") {
      whole = unpackBz2(packed_, content_, where);
    } else {
      return unsupported("{}: found the packing {}, expected none, bz2 or lz4", where, printable(chunk.packing, 40));
    }
    if (!whole) return whole.error();
    if (!*whole) return badFormat("{}: its {} is damaged", where, chunk.packing);
    loaded_ = number;
    return {};
  }

  std::shared_ptr<const OniBytes> bytes_;
  std::string name_;
  std::vector<BagChunk> chunks_;
  std::size_t messages_ = 0;
  std::optional<std::uint32_t> loaded_;
  std::string packed_, content_;
};

/// sensor_msgs/Image, whose pixels stay where they are.
struct BagImage {
  double time = 0.0;  ///< when it was taken [s]
  std::uint32_t width = 0, height = 0, step = 0;
  std::string encoding;
  bool bigEndian = false;
  std::string_view pixels;
};

std::string takeBagText(ByteReader& reader, const char* what) {
  return reader.takeText(reader.takeCount(what, 1));
}

double takeBagHeader(ByteReader& reader) {
  reader.take<std::uint32_t>("a number");
  const double seconds = reader.take<std::uint32_t>("seconds");
  const double time = seconds + 1e-9 * reader.take<std::uint32_t>("nanoseconds");
  takeBagText(reader, "the name of a frame");
  return time;
}

Result<BagImage> bagImage(std::string_view bytes, const std::string& where) {
  ByteReader reader(bytes, 0, where);
  BagImage image;
  image.time = takeBagHeader(reader);
  image.height = reader.take<std::uint32_t>("the height");
  image.width = reader.take<std::uint32_t>("the width");
  image.encoding = takeBagText(reader, "the encoding");
  image.bigEndian = reader.take<std::uint8_t>("the order of bytes") != 0;
  image.step = reader.take<std::uint32_t>("the bytes of a row");
  const std::size_t size = reader.takeCount("the bytes of the image", 1);
  if (!reader.ok()) return reader.error();
  image.pixels = reader.rest().substr(0, size);
  if (image.step < std::uint64_t{2} * image.width || size < std::uint64_t{image.step} * image.height) {
    return badFormat("{}: found {} bytes, expected {} rows of {}, of {} pixels", where, size, image.height, image.step,
                     image.width);
  }
  return image;
}

bool isDepthEncoding(const std::string& encoding) {
  return encoding == "16UC1" || encoding == "mono16";
}

/// sensor_msgs/CameraInfo: the lens of a raw image, or of a rectified one.
Result<DepthLens> bagLens(std::string_view bytes, const std::string& where, bool rectified) {
  ByteReader reader(bytes, 0, where);
  takeBagHeader(reader);
  DepthLens lens;
  lens.height = static_cast<int>(std::min(reader.take<std::uint32_t>("the height"), 1U << 20));
  lens.width = static_cast<int>(std::min(reader.take<std::uint32_t>("the width"), 1U << 20));
  const std::string model = takeBagText(reader, "the model of the distortion");
  std::vector<double> bent(reader.takeCount("the distortion", 8));
  for (double& each : bent) each = reader.take<double>("the distortion");
  std::array<double, 9> k{}, r{};
  std::array<double, 12> p{};
  for (double& each : k) each = reader.take<double>("K");
  for (double& each : r) each = reader.take<double>("R");
  for (double& each : p) each = reader.take<double>("P");
  if (!reader.ok()) return reader.error();
  if (rectified && p[0] > 0.0) {
    lens.focalX = p[0], lens.focalY = p[5], lens.centreX = p[2], lens.centreY = p[6];
    return lens;
  }
  lens.focalX = k[0], lens.focalY = k[4], lens.centreX = k[2], lens.centreY = k[5];
  const bool none = std::ranges::all_of(bent, [](double each) { return each == 0.0; });
  if (!none && model != "plumb_bob" && model != "rational_polynomial" && model != "Brown Conrady") {
    return unsupported("{}: found the distortion {}, expected plumb_bob or rational_polynomial", where,
                       printable(model, 40));
  }
  std::copy_n(bent.begin(), std::min(bent.size(), lens.distortion.size()), lens.distortion.begin());
  return lens;
}

std::size_t sameBegin(std::string_view a, std::string_view b) {
  std::size_t same = 0;
  while (same < std::min(a.size(), b.size()) && a[same] == b[same]) ++same;
  return same;
}

}  // namespace

Result<RawDepth> readDepthBag(std::shared_ptr<const OniBytes> bytes, const std::string& name, const GivenLens& given) {
  const auto bag = std::make_shared<BagFile>(std::move(bytes), name);
  LORICA_TRY_DO(bag->walk());

  // The first topic with depth in its name whose images are of 16 bits.
  const BagConnection* images = nullptr;
  BagImage first;
  std::string topics;
  for (const auto& [number, connection] : bag->connections) {
    topics += (topics.empty() ? "" : ", ") + printable(connection.topic, 60);
    if (images != nullptr || connection.type != "sensor_msgs/Image" || connection.messages.empty()) continue;
    if (lowerCase(connection.topic).find("depth") == std::string::npos) continue;
    LORICA_TRY(const std::string_view message, bag->message(connection.messages.front()));
    LORICA_TRY(const BagImage image, bagImage(message, name + ": " + printable(connection.topic, 100)));
    if (!isDepthEncoding(image.encoding)) continue;
    images = &connection;
    first = image;
  }
  if (images == nullptr) {
    return unsupported("{}: found {}{}, expected one of sensor_msgs/Image with depth in its name, in 16UC1 or mono16",
                       name, topics.empty() ? "no topic" : "the topics ", printable(topics, 400));
  }
  const int width = static_cast<int>(std::min(first.width, 1U << 20)),
            height = static_cast<int>(std::min(first.height, 1U << 20));

  // Its camera is described by the topic whose name is most alike.
  const BagConnection *info = nullptr, *units = nullptr;
  for (const auto& [number, connection] : bag->connections) {
    if (connection.messages.empty()) continue;
    if (connection.type == "std_msgs/Float32" && connection.topic.find("Depth Units") != std::string::npos)
      units = &connection;
    if (connection.type != "sensor_msgs/CameraInfo") continue;
    if (info == nullptr || sameBegin(connection.topic, images->topic) > sameBegin(info->topic, images->topic))
      info = &connection;
  }
  RawDepth raw;
  double unit = 0.001;
  if (units != nullptr) {  // RealSense's recorder writes it
    LORICA_TRY(const std::string_view message, bag->message(units->messages.front()));
    if (message.size() == sizeof(float)) unit = loadLittleEndian<float>(message.data());
  }
  std::optional<DepthLens> own;
  if (info != nullptr) {
    LORICA_TRY(const std::string_view message, bag->message(info->messages.front()));
    LORICA_TRY(own, bagLens(message, name + ": " + printable(info->topic, 100),
                            images->topic.find("rect") != std::string::npos));
    own->metresPerUnit = unit;
    raw.about.lens = "the topic " + printable(info->topic, 200);
    if (own->width != width || own->height != height) own.reset();
  }
  LORICA_TRY(raw.lens, prefixed(name, given.lensOf(width, height, own, unit, raw.about.lens)));
  raw.about.format = "ROS bag";
  raw.about.device = printable(images->topic, 200);

  // Images that came twice, or late, are left out.
  std::vector<BagMessage> messages = images->messages;
  std::stable_sort(messages.begin(), messages.end(),
                   [](const BagMessage& a, const BagMessage& b) { return a.time < b.time; });
  const auto sameTime = [](const BagMessage& a, const BagMessage& b) { return a.time == b.time; };
  messages.erase(std::unique(messages.begin(), messages.end(), sameTime), messages.end());
  for (const BagMessage& message : messages) raw.times.push_back(message.time);
  raw.read = [bag, messages = std::move(messages), name, width, height](int frame,
                                                                        std::span<std::uint16_t> out) -> Result<void> {
    LORICA_TRY(const std::string_view message, bag->message(messages[frame]));
    const std::string where = fmt::format("{}, image {}", name, frame);
    LORICA_TRY(const BagImage image, bagImage(message, where));
    if (static_cast<int>(image.width) != width || static_cast<int>(image.height) != height ||
        !isDepthEncoding(image.encoding)) {
      return badFormat("{}: found {} x {} in {}, expected {} x {} as the first", where, image.width, image.height,
                       printable(image.encoding, 40), width, height);
    }
    const std::endian order = image.bigEndian ? std::endian::big : std::endian::little;
    for (int row = 0; row < height; ++row) {
      const char* at = image.pixels.data() + static_cast<std::size_t>(row) * image.step;
      for (int column = 0; column < width; ++column) {
        out[static_cast<std::size_t>(row) * width + column] = loadBytes<std::uint16_t>(at + 2 * column, order);
      }
    }
    return {};
  };
  return raw;
}

}  // namespace lorica
