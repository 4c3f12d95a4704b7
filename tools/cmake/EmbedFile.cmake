# cmake -D FILE=<file> -D FUNCTION=<name> -D SOURCE=<file.cpp> -P EmbedFile.cmake
# Writes a source file with a function that returns the bytes of a file: see lorica_embed. They are a string literal, which
# compiles many times faster than a list of numbers.
cmake_minimum_required(VERSION 3.25)

get_filename_component(name ${FILE} NAME)
file(READ ${FILE} bytes HEX)
string(REGEX REPLACE "(..)" "\\\\x\\1" bytes "${bytes}")
file(WRITE ${SOURCE} "// The bytes of ${name}.

#include <cstdint>
#include <span>

namespace lorica {

std::span<const std::uint8_t> ${FUNCTION}();

std::span<const std::uint8_t> ${FUNCTION}() {
  static constexpr char kBytes[] = \"${bytes}\";
  return {reinterpret_cast<const std::uint8_t*>(kBytes), sizeof(kBytes) - 1};
}

}  // namespace lorica
")
