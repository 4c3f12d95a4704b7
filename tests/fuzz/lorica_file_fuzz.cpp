#include "acd/decomposition_file.h"
#include "geometry/files.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

/// Any bytes as a .lorica file. The first byte says what the others are: the whole file, or the payload of a version,
/// which gets a header with the right length and checksum, since no fuzzer finds that.
namespace {

void append(std::uint64_t value, int bytes, std::string& out) {
  for (int i = 0; i < bytes; ++i) out += static_cast<char>(value >> (8 * i));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr unsigned kVersions = 2;  // the format, and one that does not exist
  if (size == 0) return 0;
  const std::string_view rest(reinterpret_cast<const char*>(data + 1), size - 1);
  const unsigned version = data[0] % (kVersions + 1);
  std::string file;
  if (version != 0) {
    file = "LORICA\r\n";
    append(version, 4, file);
    append(rest.size(), 8, file);
    append(lorica::contentHash(rest, version), 8, file);
  }
  file += rest;

  // A file that no disk sees: there is no way to read from memory, nor another use for one.
  static const int descriptor = memfd_create("fuzz.lorica", 0);
  static const std::string path = "/proc/self/fd/" + std::to_string(descriptor);
  if (ftruncate(descriptor, 0) != 0 ||
      pwrite(descriptor, file.data(), file.size(), 0) != static_cast<ssize_t>(file.size())) {
    return 0;
  }
  if (const auto content = lorica::readDecomposition(path)) (void)lorica::hashOf(content->decomposition);
  return 0;
}
