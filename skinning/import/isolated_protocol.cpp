#include "skinning/import/isolated_protocol.h"

#include "geometry/byte_reader.h"
#include "geometry/little_endian.h"
#include "skinning/import/scene_bytes.h"

#include <algorithm>
#include <cstdint>

namespace lorica::isolated {

namespace {

constexpr std::size_t kLongestMessage = 10'000;  // [bytes]

enum class Kind : std::uint8_t { kScene, kError };

void appendText(const std::string& text, std::string& bytes) {
  appendLittleEndian(static_cast<std::uint32_t>(text.size()), bytes);
  bytes += text;
}

}  // namespace

std::string encodeHead(AssimpFormat format, const std::string& name, const NamedFiles& files) {
  std::string bytes;
  appendLittleEndian(static_cast<std::uint8_t>(format), bytes);
  appendLittleEndian(static_cast<std::uint8_t>(files.trust), bytes);
  appendText(name, bytes);
  appendText(files.folder.string(), bytes);
  return bytes;
}

Result<Head> decodeHead(std::string_view& question) {
  ByteReader in(question, 0, "question");
  Head head;
  head.format = static_cast<AssimpFormat>(in.take<std::uint8_t>() == 1);
  head.files.trust = static_cast<PathTrust>(in.take<std::uint8_t>() == 1);
  head.name = in.takeText(in.takeCount("a length", 1));
  head.files.folder = in.takeText(in.takeCount("a length", 1));
  if (!in.ok()) return in.error();
  question = in.rest();
  return head;
}

std::string encodeAnswer(const Result<FileScene>& answer) {
  std::string bytes;
  if (answer) {
    appendLittleEndian(static_cast<std::uint8_t>(Kind::kScene), bytes);
    bytes += encodeScene(*answer);
  } else {
    appendLittleEndian(static_cast<std::uint8_t>(Kind::kError), bytes);
    appendLittleEndian(static_cast<std::uint8_t>(answer.error().code), bytes);
    appendText(answer.error().message.substr(0, kLongestMessage), bytes);
  }
  return bytes;
}

Result<FileScene> decodeAnswer(std::string_view answer, const std::string& name) {
  ByteReader in(answer, 0, name + ": the answer of its reader");
  const auto kind = in.take<std::uint8_t>();
  if (in.ok() && kind == static_cast<std::uint8_t>(Kind::kScene)) return decodeScene(in.rest(), name);
  const auto code = in.take<std::uint8_t>();
  std::string message = in.takeText(std::min(in.takeCount("a length", 1), kLongestMessage));
  if (in.ok() && kind != static_cast<std::uint8_t>(Kind::kError)) in.fail(0, "found neither a scene nor an error");
  if (!in.ok()) return in.error();
  const bool missing = code == static_cast<std::uint8_t>(ErrorCode::kUnsupported);
  return Error{missing ? ErrorCode::kUnsupported : ErrorCode::kBadFormat, std::move(message)};
}

}  // namespace lorica::isolated
