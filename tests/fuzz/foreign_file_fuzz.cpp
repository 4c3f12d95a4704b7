#include "skinning/import/character_file.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

/// Any bytes as FBX (first byte even) or COLLADA through the process that reads them: LORICA_CHARACTER_READER, see
/// README.md. Whatever happens in there is an error of one line here.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lorica;
  if (size == 0) return 0;
  static const char* const program = std::getenv("LORICA_CHARACTER_READER");
  LORICA_CHECK(program != nullptr, "LORICA_CHARACTER_READER is not set");
  CharacterFileSettings settings;
  settings.isolated = IsolatedReader{program, {}};
  const std::string start = data[0] % 2 == 0 ? "; FBX 7.3.0 project file\n" : "<COLLADA>";
  const std::string content = start + std::string(reinterpret_cast<const char*>(data + 1), size - 1);
  const Result<CharacterFile> file = parseCharacterFile(std::as_bytes(std::span(content)), "fuzz", settings);
  if (!file) {
    LORICA_CHECK(file.error().message.rfind("fuzz", 0) == 0, "an error that does not name the file");
    LORICA_CHECK(file.error().message.find('\n') == std::string::npos, "more than one line");
    LORICA_CHECK(file.error().code != ErrorCode::kUnreadable, "the reader could not be started");
  }
  return 0;
}
