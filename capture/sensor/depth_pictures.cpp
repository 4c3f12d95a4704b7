#include "capture/sensor/raw_depth.h"
#include "geometry/arrays/array_file.h"
#include "geometry/arrays/mesh_sequence.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/interrupt.h"
#include "geometry/little_endian.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <memory>
#include <system_error>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxDepthPicture = 64 << 20;  // bytes: 2048 x 2048 that do not compress take 8 MB
constexpr double kPictureRate = 30.0;                 // of pictures without times [1/s]

// ---- PNG ----

/// What libpng reads from, and what it says when it gives up.
struct DepthPng {
  std::string_view bytes;
  char message[200] = {};
  png_structp png = nullptr;
  png_infop info = nullptr;
  ~DepthPng() { png_destroy_read_struct(&png, &info, nullptr); }
};

[[noreturn]] void onDepthError(png_structp png, png_const_charp message) {
  auto* reader = static_cast<DepthPng*>(png_get_error_ptr(png));
  std::strncpy(reader->message, message, sizeof(reader->message) - 1);
  png_longjmp(png, 1);
}

void onDepthWarning(png_structp /*png*/, png_const_charp /*message*/) {}

void onDepthRead(png_structp png, png_bytep out, std::size_t count) {
  auto* reader = static_cast<DepthPng*>(png_get_io_ptr(png));
  if (count > reader->bytes.size()) png_error(png, "the file ends early");
  std::memcpy(out, reader->bytes.data(), count);
  reader->bytes.remove_prefix(count);
}

/// libpng leaves it by longjmp, which runs no destructors: nothing in it may have one.
bool readDepthRows(DepthPng& reader, png_bytep rows, std::size_t rowBytes, int height) {
  png_structp png = reader.png;
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_read_fn(png, &reader, onDepthRead);
  png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
  png_read_info(png, reader.info);
  if (std::endian::native == std::endian::little) png_set_swap(png);
  const int passes = png_set_interlace_handling(png);
  png_read_update_info(png, reader.info);
  if (png_get_rowbytes(png, reader.info) != rowBytes) png_error(png, "its rows have another length");
  for (int pass = 0; pass < passes; ++pass) {
    for (int y = 0; y < height; ++y) png_read_row(png, rows + y * rowBytes, nullptr);
  }
  png_read_end(png, nullptr);
  return true;
}

std::uint32_t bigEndianAt(std::string_view bytes, std::size_t at) {
  return loadBytes<std::uint32_t>(bytes.data() + at, std::endian::big);
}

// ---- folders ----

struct TimedFile {
  double time = 0.0;
  fs::path file;
};

/// The number that a text is; none if it is more.
std::optional<double> numberIn(std::string_view text) {
  double value = 0.0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  return failed == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// The files of TUM's list: a time and a name in each line; # begins a comment.
Result<std::vector<TimedFile>> listedPictures(const fs::path& folder, const fs::path& list) {
  LORICA_TRY(const std::string text, readFile(list, NamedBy::kFile));
  std::vector<TimedFile> files;
  int number = 0;
  for (std::string_view rest = text; !rest.empty();) {
    std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    ++number;
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty() || line.starts_with('#')) continue;
    const std::size_t gap = std::min(line.find_first_of(" \t"), line.size());
    const std::optional<double> time = numberIn(line.substr(0, gap));
    line.remove_prefix(std::min(line.find_first_not_of(" \t", gap), line.size()));
    const fs::path name(line);
    const bool inside = !name.empty() && name.is_relative() && std::ranges::find(name, fs::path("..")) == name.end();
    if (!time || !inside) {
      return badFormat("{}:{}: expected a time and a picture below the folder, such as `1305031453.374112 depth/1.png`",
                       list.string(), number);
    }
    files.push_back({*time, folder / name});
  }
  return files;
}

/// The pictures of a folder, or of a folder `depth` in it, in the order of their names.
Result<std::vector<TimedFile>> picturesIn(const fs::path& folder) {
  std::vector<TimedFile> files;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (lowerCase(at->path().extension().string()) == ".png") files.push_back({0.0, at->path()});
    if (workStopped()) return cancelled();
  }
  if (error) return unreadable("{}: cannot be read: {}", folder.string(), error.message());
  // Names such as 1305031453.374112 are times.
  bool times = true;
  for (TimedFile& file : files) {
    const std::string stem = file.file.stem().string();
    const std::optional<double> time = stem.find('.') == std::string::npos ? std::nullopt : numberIn(stem);
    times = times && time;
    file.time = time.value_or(0.0);
  }
  std::ranges::sort(files, [&](const TimedFile& a, const TimedFile& b) {
    return times ? a.time < b.time : comesBefore(a.file.filename().string(), b.file.filename().string());
  });
  for (std::size_t i = 0; i < files.size() && !times; ++i) files[i].time = i / kPictureRate;
  return files;
}

// ---- arrays ----

const NamedArray* arrayOf(const std::vector<NamedArray>& arrays, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    const auto found = std::ranges::find(arrays, name, &NamedArray::name);
    if (found != arrays.end()) return &*found;
  }
  return nullptr;
}

template <typename T>
void numbersInto(const char* from, double scale, std::span<std::uint16_t> to) {
  for (std::size_t i = 0; i < to.size(); ++i) {
    const double value = scale * static_cast<double>(loadLittleEndian<T>(from + i * sizeof(T)));
    to[i] = value >= 0.5 && value < 65535.5 ? static_cast<std::uint16_t>(std::lround(value)) : 0;
  }
}

}  // namespace

Result<std::pair<int, int>> depthPngSize(std::string_view bytes, const std::string& name) {
  constexpr std::size_t kWidth = 16, kHeight = 20, kBits = 24, kColours = 25, kHead = 33;
  if (bytes.size() < kHead || !bytes.starts_with("\x89PNG\r\n\x1a\n") || bytes.substr(12, 4) != "IHDR") {
    return badFormat("{}: found no PNG picture, expected one", name);
  }
  if (bytes[kBits] != 16 || bytes[kColours] != 0) {
    return unsupported("{}: found a PNG picture of {} bits in {}, expected 16 bits of gray: depth", name,
                       static_cast<int>(bytes[kBits]), bytes[kColours] == 0 ? "gray" : "colour");
  }
  const std::uint32_t width = bigEndianAt(bytes, kWidth), height = bigEndianAt(bytes, kHeight);
  return std::pair(static_cast<int>(std::min(width, 1U << 20)), static_cast<int>(std::min(height, 1U << 20)));
}

Result<void> decodeDepthPng(std::string_view bytes, const std::string& name, int width, int height,
                            std::span<std::uint16_t> image) {
  LORICA_TRY(const auto size, depthPngSize(bytes, name));
  if (size != std::pair(width, height)) {
    return badFormat("{}: found a picture of {} x {}, expected {} x {} as the first", name, size.first, size.second,
                     width, height);
  }
  DepthPng reader{bytes};
  reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, onDepthError, onDepthWarning);
  if (reader.png != nullptr) reader.info = png_create_info_struct(reader.png);
  if (reader.info == nullptr) return unreadable("{}: libpng cannot be used", name);
  if (!readDepthRows(reader, reinterpret_cast<png_bytep>(image.data()), std::size_t{2} * width, height)) {
    return badFormat("{}: a damaged PNG picture: {}", name, reader.message);
  }
  return {};
}

Result<RawDepth> readDepthPictures(const fs::path& folder, const std::string& lens) {
  std::error_code ignored;
  RawDepth raw;
  const bool tum = fs::exists(folder / "depth.txt", ignored);
  const fs::path below = fs::is_directory(folder / "depth", ignored) ? folder / "depth" : folder;
  LORICA_TRY(std::vector<TimedFile> files, tum ? listedPictures(folder, folder / "depth.txt") : picturesIn(below));
  if (files.empty()) return badFormat("{}: found no PNG picture, expected depth images", folder.string());
  if (files.size() > kMaxStreamFrames) {
    return badFormat("{}: found {} pictures, expected at most {}", folder.string(), files.size(), kMaxStreamFrames);
  }
  const auto content = [](const fs::path& file) { return readFile(file, NamedBy::kFile, kMaxDepthPicture); };
  LORICA_TRY(const std::string first, content(files.front().file));
  LORICA_TRY(const auto size, depthPngSize(first, files.front().file.string()));
  fs::path beside = folder.has_filename() ? folder : folder.parent_path();
  beside += ".json";
  LORICA_TRY(const GivenLens given,
             GivenLens::find(lens, {folder / "camera.json", folder / "intrinsics.json", beside}));
  constexpr double kTumUnit = 1.0 / 5000.0;
  std::optional<DepthLens> own;
  if (tum && size == std::pair(640, 480)) own = DepthLens{640, 480, 525.0, 525.0, 319.5, 239.5, {}, kTumUnit};
  if (own) raw.about.lens = "TUM's usual camera";
  LORICA_TRY(raw.lens, prefixed(folder.string(),
                                given.lensOf(size.first, size.second, own, tum ? kTumUnit : 0.001, raw.about.lens)));
  raw.about.format = tum ? "16-bit PNG pictures, as TUM's" : "16-bit PNG pictures";
  raw.times.reserve(files.size());
  for (const TimedFile& file : files) raw.times.push_back(file.time);
  raw.read = [files = std::move(files), content, size](int frame, std::span<std::uint16_t> image) -> Result<void> {
    LORICA_TRY(const std::string bytes, content(files[frame].file));
    return decodeDepthPng(bytes, files[frame].file.string(), size.first, size.second, image);
  };
  return raw;
}

Result<RawDepth> readDepthArrays(const fs::path& file, const std::string& lens) {
  LORICA_TRY(std::vector<NamedArray> read, readArrays(file));
  const auto arrays = std::make_shared<const std::vector<NamedArray>>(std::move(read));
  const NamedArray* found = arrays->size() == 1 ? &arrays->front() : arrayOf(*arrays, {"depth"});
  if (found == nullptr || found->shape.size() != 3 || found->shape[0] == 0) {
    return badFormat("{}: found no array of (frames, height, width), expected one, named depth where there are several",
                     file.string());
  }
  const std::size_t frames = found->shape[0], height = found->shape[1], width = found->shape[2];
  struct Kind {
    std::string_view type;
    std::size_t bytes;
    void (*read)(const char*, double, std::span<std::uint16_t>);
    double scale;  ///< to millimetres of numbers that are not whole, which are metres
  };
  static constexpr std::array<Kind, 5> kKinds = {{{"<u2", 2, numbersInto<std::uint16_t>, 1.0},
                                                  {"<i2", 2, numbersInto<std::int16_t>, 1.0},
                                                  {"<i4", 4, numbersInto<std::int32_t>, 1.0},
                                                  {"<f4", 4, numbersInto<float>, 1000.0},
                                                  {"<f8", 8, numbersInto<double>, 1000.0}}};
  const auto* const kind = std::ranges::find(kKinds, found->type, &Kind::type);
  if (kind == kKinds.end()) {
    return unsupported("{}: found elements of type '{}', expected '<u2' in millimetres or '<f4' in metres",
                       file.string(), found->type);
  }
  if (height > 1U << 20 || width > 1U << 20 || frames > kMaxStreamFrames) {
    return badFormat("{}: found {} images of {} x {}, expected at most {} of 2048 x 2048", file.string(), frames, width,
                     height, kMaxStreamFrames);
  }
  RawDepth raw;
  LORICA_TRY(const GivenLens given, GivenLens::find(lens, {fs::path(file).replace_extension(".json")}));
  std::optional<DepthLens> own;
  if (const NamedArray* k = arrayOf(*arrays, {"intrinsics", "K"})) {
    LORICA_TRY(const std::vector<double> m, numbersOf(*k));
    if (m.size() == 9) own = DepthLens{int(width), int(height), m[0], m[4], m[2], m[5], {}, 0.001};
  }
  LORICA_TRY(raw.lens, prefixed(file.string(), given.lensOf(int(width), int(height), own, 0.001, raw.about.lens)));
  raw.about.format = "arrays of numpy";
  double rate = kPictureRate;
  if (const NamedArray* fps = arrayOf(*arrays, {"fps"})) {
    LORICA_TRY(const std::vector<double> value, numbersOf(*fps));
    if (value.size() == 1 && value[0] > 0.0) rate = value[0];
  }
  for (std::size_t i = 0; i < frames; ++i) raw.times.push_back(static_cast<double>(i) / rate);
  if (const NamedArray* times = arrayOf(*arrays, {"times", "timestamps"})) {
    LORICA_TRY(raw.times, numbersOf(*times));
    if (raw.times.size() != frames) {
      return badFormat("{}: found {} times, expected {}, one for each image", file.string(), raw.times.size(), frames);
    }
  }
  // A room is no hundred metres deep: then they are millimetres, too.
  double scale = kind->scale;
  std::vector<std::uint16_t> first(width * height);
  if (scale > 1.0) kind->read(found->bytes.data(), 1.0, first);
  if (std::ranges::any_of(first, [](std::uint16_t depth) { return depth > 100; })) scale = 1.0;
  raw.read = [arrays, found, kind, scale](int frame, std::span<std::uint16_t> image) -> Result<void> {
    kind->read(found->bytes.data() + frame * image.size() * kind->bytes, scale, image);
    return {};
  };
  return raw;
}

}  // namespace lorica
