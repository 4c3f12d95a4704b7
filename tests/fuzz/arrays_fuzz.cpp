#include "geometry/arrays/array_file.h"

#include <cstddef>
#include <cstdint>
#include <string_view>

/// Any bytes as .npy or .npz, of which at most a mebibyte is unpacked. What is accepted has as many elements as its
/// shape says.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lorica;
  const auto arrays = parseArrays({reinterpret_cast<const char*>(data), size}, "fuzz", 1U << 20);
  if (!arrays) {
    LORICA_CHECK(arrays.error().message.rfind("fuzz", 0) == 0, "an error that does not name the file");
    LORICA_CHECK(arrays.error().message.find('\n') == std::string::npos, "more than one line");
    return 0;
  }
  for (const NamedArray& array : *arrays) {
    std::size_t count = 1;
    for (const std::size_t extent : array.shape) count *= extent;
    LORICA_CHECK(count == 0 || array.type[1] == 'U' || array.bytes.size() % count == 0, "a shape of other elements");
    const auto numbers = numbersOf(array);
    LORICA_CHECK(!numbers || numbers->size() == count, "a number too many or too few");
  }
  return 0;
}
