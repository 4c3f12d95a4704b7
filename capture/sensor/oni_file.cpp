#include "capture/sensor/oni_file.h"

#include "capture/sensor/oni_records.h"
#include "geometry/descriptor.h"
#include "geometry/errors.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

namespace lorica {
namespace {

class FileBytes : public OniBytes {
 public:
  FileBytes(Descriptor file, std::uint64_t size) : file_(std::move(file)), size_(size) {}

  [[nodiscard]] std::uint64_t size() const override { return size_; }
  [[nodiscard]] bool read(std::uint64_t at, std::span<std::uint8_t> out) const override {
    while (!out.empty()) {
      const ssize_t got = ::pread(file_.get(), out.data(), out.size(), at);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return false;
      out = out.subspan(got);
      at += got;
    }
    return true;
  }

 private:
  Descriptor file_;
  std::uint64_t size_;
};

class MemoryBytes : public OniBytes {
 public:
  explicit MemoryBytes(std::string_view bytes) : bytes_(bytes) {}
  [[nodiscard]] std::uint64_t size() const override { return bytes_.size(); }
  [[nodiscard]] bool read(std::uint64_t at, std::span<std::uint8_t> out) const override {
    if (at > bytes_.size() || out.size() > bytes_.size() - at) return false;
    if (!out.empty()) std::memcpy(out.data(), bytes_.data() + at, out.size());
    return true;
  }

 private:
  std::string_view bytes_;
};

}  // namespace

Result<DepthRead> DepthRecording::next(DepthFrame& frame) {
  if (position_ >= about_.frameCount) return DepthRead::kEnd;
  // A damaged frame must not be written partially to the caller's frame, so it is read into another one first.
  LORICA_TRY_DO(read(position_, scratch_));
  std::swap(frame, scratch_);
  ++position_;
  return DepthRead::kFrame;
}

void DepthRecording::seek(int frame) {
  position_ = std::clamp(frame, 0, about_.frameCount);
}

Result<std::unique_ptr<OniBytes>> openBytes(const std::filesystem::path& file) {
  Descriptor opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!opened.valid()) {
    const int why = errno;
    const ErrorCode code = why == ENOENT || why == ENOTDIR ? ErrorCode::kNotFound : ErrorCode::kUnreadable;
    return Error{code, fmt::format("{}: cannot be read: {}", file.string(), std::generic_category().message(why))};
  }
  struct stat status {};
  if (::fstat(opened.get(), &status) != 0 || !S_ISREG(status.st_mode)) {
    return unreadable("{}: found no regular file, expected a recording", file.string());
  }
  return std::unique_ptr<OniBytes>(std::make_unique<FileBytes>(std::move(opened), std::max<off_t>(status.st_size, 0)));
}

std::unique_ptr<OniBytes> bytesInMemory(std::string_view bytes) {
  return std::make_unique<MemoryBytes>(bytes);
}

struct OniFile::Contents {
  std::string name;
  std::unique_ptr<OniBytes> bytes;
  OniIndex index;
  std::vector<std::uint8_t> packed;
  std::vector<std::uint16_t> depths;
  OniDepthDecoder decoder;
};

OniFile::OniFile(std::unique_ptr<Contents> contents, std::string name)
    : DepthRecording(std::move(name), {fmt::format("OpenNI {}", contents->index.info.version),
                                       contents->index.info.device,
                                       {},
                                       contents->index.info.frameCount,
                                       contents->index.info.duration,
                                       contents->index.info.cutOff,
                                       {}}),
      contents_(std::move(contents)) {}
OniFile::OniFile(OniFile&&) noexcept = default;
OniFile& OniFile::operator=(OniFile&&) noexcept = default;
OniFile::~OniFile() = default;

Result<OniFile> OniFile::indexed(std::unique_ptr<OniBytes> bytes, const std::filesystem::path& file) {
  auto contents = std::make_unique<Contents>();
  contents->name = file.string();
  contents->bytes = std::move(bytes);
  LORICA_TRY(contents->index, indexOni(*contents->bytes, contents->name));
  return OniFile(std::move(contents), file.filename().string());
}

Result<OniFile> OniFile::open(const std::filesystem::path& file) {
  LORICA_TRY(std::unique_ptr<OniBytes> bytes, openBytes(file));
  return indexed(std::move(bytes), file);
}

Result<OniFile> OniFile::parse(std::string_view bytes, std::string name) {
  return indexed(bytesInMemory(bytes), name);
}

const OniInfo& OniFile::info() const {
  return contents_->index.info;
}

double OniFile::timeOf(int frame) const {
  LORICA_CHECK(frame >= 0 && frame < info().frameCount, "the frame index must be within the recording");
  return 1e-6 * contents_->index.frames[frame].timeUs;
}

Result<void> OniFile::read(int frame, DepthFrame& out) {
  out.time = timeOf(frame);
  Contents& c = *contents_;
  const OniFrameEntry& entry = c.index.frames[frame];
  const std::size_t width = c.index.info.camera.width;
  const std::size_t height = c.index.info.camera.height;
  const std::size_t recorded = std::size_t{entry.width} * entry.height;

  c.packed.resize(entry.payloadBytes);
  if (!c.bytes->read(entry.payload, c.packed)) {
    return unreadable("{}: depth frame {} can no longer be read, expected {} bytes at byte {}", c.name, frame,
                      entry.payloadBytes, entry.payload);
  }
  c.depths.resize(recorded);
  if (const Result<void> decoded = c.decoder.decode(c.index.info.codec, c.packed, c.depths); !decoded) {
    return prefixed(fmt::format("{}, depth frame {} at byte {}", c.name, frame, entry.payload), decoded);
  }
  if (c.index.tenths) {
    for (std::uint16_t& depth : c.depths) depth = (depth + 5) / 10;
  }

  if (recorded == width * height) {
    std::swap(out.depthMm, c.depths);
  } else {
    out.depthMm.assign(width * height, 0);
    for (std::size_t row = 0; row < entry.height; ++row) {
      std::copy_n(c.depths.begin() + row * entry.width, entry.width,
                  out.depthMm.begin() + ((row + entry.top) * width + entry.left));
    }
  }
  if (entry.mirrored) {
    for (std::size_t row = 0; row < height; ++row) {
      const auto begin = out.depthMm.begin() + row * width;
      std::reverse(begin, begin + width);
    }
  }
  return {};
}

Result<std::unique_ptr<OniFile>> openOni(const std::filesystem::path& file) {
  LORICA_TRY(OniFile opened, OniFile::open(file));
  return std::make_unique<OniFile>(std::move(opened));
}

}  // namespace lorica
