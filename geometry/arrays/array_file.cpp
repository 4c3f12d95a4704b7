#include "geometry/arrays/array_file.h"

#include "geometry/byte_reader.h"
#include "geometry/errors.h"
#include "geometry/interrupt.h"
#include "geometry/little_endian.h"
#include "geometry/text.h"

#include <fmt/ranges.h>
#include <zip.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <deque>
#include <memory>
#include <optional>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::string_view kEnding = ".npy";
constexpr std::size_t kHeadBytes = 256;   // in which an array's type stands
constexpr std::size_t kPiece = 1U << 20;  // bytes that are unpacked or written at a time

/// What stands behind a key of a header, which is a dict of Python: {'descr': '<f4', 'fortran_order': False, ...}
std::string_view valueOf(std::string_view header, std::string_view key) {
  const std::size_t at = header.find(key);
  if (at == std::string_view::npos) return {};
  header.remove_prefix(at + key.size());
  header.remove_prefix(std::min(header.find_first_not_of(" :"), header.size()));
  return header;
}

/// Bytes of an element; none for types that are not read: of other machines, complex, of several fields, objects.
std::optional<std::size_t> sizeOf(std::string_view type) {
  std::size_t size = 0;
  if (type.size() < 3 || (type[0] != '<' && type[0] != '|')) return std::nullopt;
  const auto [end, failed] = std::from_chars(type.data() + 2, type.data() + type.size(), size);
  if (failed != std::errc() || end != type.data() + type.size() || size > kMaxArrayBytes) return std::nullopt;
  if (type[1] == 'U') return 4 * size;
  const bool number = std::string_view("fiub").find(type[1]) != std::string_view::npos;
  return number && size >= 1 && size <= 8 && (size == 1 || type[0] == '<') ? std::optional(size) : std::nullopt;
}

/// (3, 4), or (3,), or ().
std::optional<std::vector<std::size_t>> shapeOf(std::string_view text) {
  const std::size_t end = text.find(')');
  if (!text.starts_with('(') || end == std::string_view::npos) return std::nullopt;
  std::vector<std::size_t> shape;
  for (const char* at = text.data() + 1; at != text.data() + end;) {
    const auto [after, failed] = std::from_chars(at, text.data() + end, shape.emplace_back());
    if (failed != std::errc()) return std::nullopt;
    for (at = after; *at == ',' || *at == ' '; ++at) {
    }
  }
  return shape;
}

/// @param where  of errors
Result<NamedArray> parseArray(std::string_view bytes, const std::string& where) {
  if (!bytes.starts_with(kMagic)) return badFormat("{}: found no array of numpy, expected .npy or .npz", where);
  ByteReader reader(bytes, kMagic.size(), where);
  const auto version = reader.take<std::uint8_t>("the version");
  reader.take<std::uint8_t>("the version");
  const std::size_t length = version == 1 ? reader.take<std::uint16_t>("the length of the header")
                                          : reader.take<std::uint32_t>("the length of the header");
  if (!reader.ok()) return reader.error();
  if (version < 1 || version > 3) return badFormat("{}: found version {} of .npy, expected 1 to 3", where, version);
  if (length > reader.left()) {
    return badFormat("{}: found {} bytes, expected a header of {}", where, reader.left(), length);
  }
  const std::string_view header = reader.rest().substr(0, length);
  NamedArray array;
  const std::string_view type = valueOf(header, "'descr'"), order = valueOf(header, "'fortran_order'");
  if (type.starts_with('\'')) array.type = type.substr(1, type.find('\'', 1) - 1);
  const std::optional<std::size_t> size = sizeOf(array.type);
  if (!size) {
    return unsupported("{}: found elements of type {}, expected little-endian numbers such as '<f4'", where,
                       printable(type.substr(0, type.find_first_of(",}")), 40));
  }
  if (!order.starts_with("False")) {
    return unsupported("{}: found the order of Fortran, expected that of C: numpy.ascontiguousarray()", where);
  }
  std::optional<std::vector<std::size_t>> shape = shapeOf(valueOf(header, "'shape'"));
  if (!shape) return badFormat("{}: found a header without a shape, expected one such as (100, 3)", where);
  array.bytes = reader.rest().substr(length);
  std::size_t expected = *size;
  for (const std::size_t count : *shape) {
    if (expected != 0 && count > kMaxArrayBytes / expected) {
      return badFormat("{}: found the shape ({}), expected at most {} bytes", where, fmt::join(*shape, ", "),
                       kMaxArrayBytes);
    }
    expected *= count;
  }
  if (array.bytes.size() != expected) {
    return badFormat("{}: found {} bytes of elements, expected {} for the shape ({})", where, array.bytes.size(),
                     expected, fmt::join(*shape, ", "));
  }
  array.shape = std::move(*shape);
  return array;
}

/// What libzip says of its last failure.
class ZipError {
 public:
  ZipError() { zip_error_init(&error_); }
  ~ZipError() { zip_error_fini(&error_); }
  ZipError(const ZipError&) = delete;
  ZipError& operator=(const ZipError&) = delete;
  operator zip_error_t*() { return &error_; }
  [[nodiscard]] std::string words() { return zip_error_strerror(&error_); }

 private:
  zip_error_t error_{};
};

struct Discard {
  void operator()(zip_t* archive) const { zip_discard(archive); }
  void operator()(zip_source_t* source) const { zip_source_free(source); }
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};
template <typename T>
using Owned = std::unique_ptr<T, Discard>;

Result<std::vector<NamedArray>> parseArchive(std::string_view bytes, const std::string& where, std::uint64_t most) {
  ZipError error;
  Owned<zip_source_t> source(zip_source_buffer_create(bytes.data(), bytes.size(), 0, error));
  const Owned<zip_t> archive(source ? zip_open_from_source(source.get(), ZIP_RDONLY, error) : nullptr);
  if (!archive) return badFormat("{}: its archive is broken: {}", where, error.words());
  (void)source.release();  // the archive has it
  const zip_int64_t count = zip_get_num_entries(archive.get(), 0);
  if (count <= 0) return badFormat("{}: found an empty archive, expected arrays", where);
  std::vector<NamedArray> arrays;
  std::size_t unpacked = 0;
  for (zip_int64_t i = 0; i < count; ++i) {
    const char* called = zip_get_name(archive.get(), i, 0);
    const std::string name = called == nullptr ? "" : called;
    const std::string place = fmt::format("{}: {}", where, printable(name, 100));
    if (!name.ends_with(kEnding)) return badFormat("{}: found a file in the archive, expected arrays (.npy)", place);
    const Owned<zip_file_t> packed(zip_fopen_index(archive.get(), i, 0));
    std::string content;
    for (std::size_t size = kPiece; size != 0;) {
      const std::size_t before = content.size();
      content.resize(before + kPiece);
      const zip_int64_t got = packed ? zip_fread(packed.get(), content.data() + before, kPiece) : -1;
      if (workStopped()) return cancelled();
      if (got < 0) {
        return badFormat("{}: cannot be unpacked: {}", place,
                         packed ? zip_file_strerror(packed.get()) : zip_strerror(archive.get()));
      }
      size = static_cast<std::size_t>(got);
      content.resize(before + size);
      unpacked += size;
      if (unpacked > most) return badFormat("{}: unpacks to more than {} bytes, expected at most that", where, most);
    }
    if (std::string_view(content).substr(0, kHeadBytes).find("'|O'") != std::string_view::npos &&
        (i + 1 < count || !arrays.empty()))
      continue;
    LORICA_TRY(NamedArray array, parseArray(content, place));
    array.name = name.substr(0, name.size() - kEnding.size());
    arrays.push_back(std::move(array));
  }
  return arrays;
}

/// What stands before the elements in a .npy: format 1.0.
std::string headOf(const NamedArray& array) {
  std::string shape;
  for (const std::size_t count : array.shape) shape += fmt::format("{},", count);
  std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", array.type, shape);
  constexpr std::size_t kBefore = 10, kAligned = 64;
  header.resize((kBefore + header.size() + 1 + kAligned - 1) / kAligned * kAligned - kBefore, ' ');
  header.back() = '\n';
  std::string bytes = std::string(kMagic) + std::string("\x01\x00", 2);
  appendLittleEndian(static_cast<std::uint16_t>(header.size()), bytes);
  return bytes + header;
}

template <typename T>
std::vector<double> numbersAs(const std::string& bytes) {
  std::vector<double> numbers(bytes.size() / sizeof(T));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    numbers[i] = static_cast<double>(loadLittleEndian<T>(bytes.data() + i * sizeof(T)));
  }
  return numbers;
}

}  // namespace

Result<std::vector<NamedArray>> parseArrays(std::string_view bytes, const fs::path& file, std::uint64_t most) {
  if (bytes.starts_with("PK")) return parseArchive(bytes, file.string(), most);
  LORICA_TRY(NamedArray array, parseArray(bytes, file.string()));
  array.name = file.stem().string();
  std::vector<NamedArray> arrays;
  arrays.push_back(std::move(array));
  return arrays;
}

Result<std::vector<NamedArray>> readArrays(const fs::path& file, NamedBy by) {
  LORICA_TRY(const std::string bytes, readFile(file, by, kMaxArrayBytes));
  return parseArrays(bytes, file);
}

Result<std::vector<double>> numbersOf(const NamedArray& array) {
  using Reader = std::vector<double> (*)(const std::string&);
  constexpr std::array<std::pair<std::string_view, Reader>, 10> kReaders = {{{"<f4", numbersAs<float>},
                                                                             {"<f8", numbersAs<double>},
                                                                             {"|i1", numbersAs<std::int8_t>},
                                                                             {"|u1", numbersAs<std::uint8_t>},
                                                                             {"<i2", numbersAs<std::int16_t>},
                                                                             {"<u2", numbersAs<std::uint16_t>},
                                                                             {"<i4", numbersAs<std::int32_t>},
                                                                             {"<u4", numbersAs<std::uint32_t>},
                                                                             {"<i8", numbersAs<std::int64_t>},
                                                                             {"<u8", numbersAs<std::uint64_t>}}};
  for (const auto& [type, read] : kReaders) {
    if (array.type == type) return read(array.bytes);
  }
  return unsupported("{}: found elements of type '{}', expected '<f4', '<f8' or whole numbers", printable(array.name),
                     array.type);
}

std::vector<std::string> arrayNames(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return {};
  const Owned<zip_t> archive(zip_open(file.c_str(), ZIP_RDONLY, nullptr));
  std::vector<std::string> names;
  const zip_int64_t count = archive ? zip_get_num_entries(archive.get(), 0) : 0;
  for (zip_int64_t i = 0; i < count; ++i) {
    const char* name = zip_get_name(archive.get(), i, 0);
    if (name == nullptr || !std::string_view(name).ends_with(kEnding)) continue;
    names.emplace_back(name, std::string_view(name).size() - kEnding.size());
  }
  return names;
}

Result<void> writeArrays(std::span<const NamedArray> arrays, NewFile& file) {
  ZipError error;
  const Owned<zip_source_t> packed(zip_source_buffer_create(nullptr, 0, 0, error));
  Owned<zip_t> archive(packed ? zip_open_from_source(packed.get(), ZIP_CREATE | ZIP_TRUNCATE, error) : nullptr);
  if (!archive) return unwritable("arrays: cannot be packed: {}", error.words());
  zip_source_keep(packed.get());  // the archive has it, and it is read below
  const auto failed = [&] { return unwritable("arrays: cannot be packed: {}", zip_strerror(archive.get())); };
  std::deque<std::string> heads;
  const auto piece = [](const std::string& bytes) {
    return zip_buffer_fragment_t{reinterpret_cast<zip_uint8_t*>(const_cast<char*>(bytes.data())), bytes.size()};
  };
  for (const NamedArray& array : arrays) {
    const std::array<zip_buffer_fragment_t, 2> pieces = {piece(heads.emplace_back(headOf(array))), piece(array.bytes)};
    Owned<zip_source_t> source(zip_source_buffer_fragment(archive.get(), pieces.data(), pieces.size(), 0));
    const zip_int64_t index = !source ? -1
                                      : zip_file_add(archive.get(), (array.name + std::string(kEnding)).c_str(),
                                                     source.get(), ZIP_FL_ENC_UTF_8);
    if (index < 0) return failed();
    (void)source.release();
    constexpr zip_uint16_t kMidnight = 0, kFirstDay = 0x21;  // 1 January 1980: the same bytes whenever they are written
    if (zip_set_file_compression(archive.get(), index, ZIP_CM_STORE, 0) != 0 ||
        zip_file_set_dostime(archive.get(), index, kMidnight, kFirstDay, 0) != 0) {
      return failed();
    }
  }
  if (zip_close(archive.get()) != 0) return failed();
  (void)archive.release();
  if (zip_source_open(packed.get()) != 0) return unwritable("arrays: cannot be packed");
  std::string bytes(kPiece, '\0');
  for (zip_int64_t got = 1; got > 0;) {
    got = zip_source_read(packed.get(), bytes.data(), bytes.size());
    if (got < 0) return unwritable("arrays: cannot be packed");
    LORICA_TRY_DO(file.write({bytes.data(), static_cast<std::size_t>(got)}));
  }
  return {};
}

}  // namespace lorica
