# cmake -D FILE=<file> -D FUNCTION=<name> -D SOURCE=<file.cpp> -P EmbedFile.cmake
# Writes a source file with a function that returns the bytes of a file: see lorica_embed.
cmake_minimum_required(VERSION 3.25)

get_filename_component(name ${FILE} NAME)
file(READ ${FILE} bytes HEX)
string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
if(bytes STREQUAL "")
  set(body "return {};")
else()
  set(body "static constexpr std::uint8_t kBytes[] = {${bytes}};
  return kBytes;")
endif()
file(WRITE ${SOURCE} "// The bytes of ${name}.

#include <cstdint>
#include <span>

namespace lorica {

std::span<const std::uint8_t> ${FUNCTION}();

std::span<const std::uint8_t> ${FUNCTION}() {
  ${body}
}

}  // namespace lorica
")
