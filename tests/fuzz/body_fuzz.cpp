#include "geometry/files.h"
#include "geometry/little_endian.h"
#include "skinning/body/body_file.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

/// Any bytes as a cache's entry of a body, with the right header, checksum and key, which no fuzzer finds, unless they
/// begin like one. What is accepted must be sound.
namespace {

using namespace lorica;

constexpr std::uint64_t kKey = 0;

/// Two joints, and a tetrahedron that the second one moves.
Character tetrahedron() {
  Character made;
  made.skeleton = Skeleton::create({{"root", kNoJoint, {}, {}}, {"tip", 0, {}, {}}}).value();
  made.mesh.vertices = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  made.mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  made.influences.assign(4, {1, 1.0});
  made.influenceBegin = {0, 1, 2, 3, 4};
  made.jointFromModel.assign(2, Affine3::Identity());
  made.height = 1.0;
  return made;
}

std::string entryOf(std::string_view rest) {
  std::string payload;
  appendLittleEndian(kKey, payload);
  payload += rest;
  std::string bytes = "LORBODY\n";
  appendLittleEndian(kBodyVersion, bytes);
  appendLittleEndian(contentHash(payload, kBodyVersion), bytes);
  return bytes + payload;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Character character = tetrahedron();
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const std::string entry = bytes.starts_with("LORBODY\n") ? std::string(bytes) : entryOf(bytes);
  const Result<ClosedBody> body = decodeBody(entry, character, kKey, "fuzz");
  if (!body) {
    LORICA_CHECK(body.error().message.starts_with("fuzz"), "an error that does not name the file");
    return 0;
  }
  LORICA_CHECK(checkCharacter(body->character).ok(), "what is read passes checkCharacter()");
  LORICA_CHECK(body->bodyVertices > 0 && body->bodyVertices <= static_cast<int>(size / 25), "more vertices than bytes");
  return 0;
}
