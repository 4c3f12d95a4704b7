#include "bake/triangle_count.h"

#include "geometry/json.h"

#include <algorithm>
#include <charconv>
#include <cstring>

namespace lorica {
namespace {

using nlohmann::json;

constexpr bool isSpace(char c) {
  return c == ' ' || c == '\n' || c == '\t' || c == '\r';
}

/// Takes the next word off the text; empty at its end.
std::string_view nextWord(std::string_view& text) {
  const auto begin = std::ranges::find_if_not(text, isSpace);
  const auto end = std::find_if(begin, text.end(), isSpace);
  const std::string_view word(begin, end);
  text.remove_prefix(end - text.begin());
  return word;
}

std::uint64_t numberIn(std::string_view word) {
  std::uint64_t number = 0;
  (void)std::from_chars(word.data(), word.data() + word.size(), number);
  return number;
}

std::uint64_t wordsIn(std::string_view text) {
  std::uint64_t count = 0;
  bool inWord = false;
  for (const char c : text) {
    count += !isSpace(c) && !inWord;
    inWord = !isSpace(c);
  }
  return count;
}

/// A face of k corners has k + 1 words and k - 2 triangles; colours make this too large.
std::uint64_t trianglesInOff(std::string_view text) {
  std::string_view word = nextWord(text);
  if (word.ends_with("OFF")) word = nextWord(text);
  while (word.starts_with('#')) {
    text.remove_prefix(std::min(text.find('\n'), text.size()));
    word = nextWord(text);
  }
  const std::uint64_t vertices = numberIn(word);
  const std::uint64_t faces = numberIn(nextWord(text));
  nextWord(text);  // edges
  const std::uint64_t words = wordsIn(text);
  return words > 3 * (vertices + faces) ? words - 3 * (vertices + faces) : faces;
}

std::uint64_t trianglesInObj(std::string_view text) {
  std::uint64_t count = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    if (line.starts_with("f ")) count += std::max<std::uint64_t>(wordsIn(line), 4) - 3;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return count;
}

std::uint64_t trianglesInStl(std::string_view content) {
  constexpr std::size_t kHeader = 84;
  constexpr std::size_t kFacet = 50;
  if (content.size() >= kHeader) {
    std::uint32_t count = 0;
    std::memcpy(&count, content.data() + kHeader - sizeof(count), sizeof(count));
    if (content.size() >= kHeader + kFacet * std::uint64_t{count} && !content.starts_with("solid")) return count;
  }
  std::uint64_t count = 0;
  constexpr std::string_view kEnd = "endfacet";
  for (std::size_t at = 0; (at = content.find(kEnd, at)) != std::string_view::npos; at += kEnd.size()) ++count;
  return count > 0 ? count : (content.size() - std::min(content.size(), kHeader)) / kFacet;
}

std::uint64_t trianglesInPly(std::string_view content) {
  constexpr std::string_view kFaces = "element face ";
  const std::size_t at = content.find(kFaces);
  return at == std::string_view::npos ? 0 : 2 * numberIn(content.substr(at + kFaces.size()));
}

/// A value of an object; null if it is not there.
const json& member(const json& value, const char* name) {
  static const json kNull;
  return value.is_object() && value.contains(name) ? value[name] : kNull;
}

/// A value of a list; null if it is not there.
const json& element(const json& value, const json& index) {
  static const json kNull;
  return value.is_array() && index.is_number_unsigned() && index.get<std::uint64_t>() < value.size()
             ? value[index.get<std::size_t>()]
             : kNull;
}

std::uint64_t trianglesInGltf(std::string_view content) {
  constexpr std::size_t kGlbHeader = 20;
  if (content.starts_with("glTF") && content.size() > kGlbHeader) {
    std::uint32_t length = 0;
    std::memcpy(&length, content.data() + 12, sizeof(length));
    content = content.substr(kGlbHeader, length);
  }
  const Result<json> parsed = parseJson(content, "");
  if (!parsed) return 0;
  const json& document = *parsed;
  std::uint64_t corners = 0;
  for (const json& mesh : member(document, "meshes")) {
    for (const json& primitive : member(mesh, "primitives")) {
      const json& indices = member(primitive, "indices");
      const json& accessor = indices.is_null() ? member(member(primitive, "attributes"), "POSITION") : indices;
      const json& count = member(element(member(document, "accessors"), accessor), "count");
      if (count.is_number_unsigned()) corners += count.get<std::uint64_t>();
    }
  }
  return corners / 3;
}

}  // namespace

std::uint64_t trianglesIn(std::string_view content, const std::string& ending) {
  constexpr std::uint64_t kBytesPerTriangle = 12;
  if (ending == ".off") return trianglesInOff(content);
  if (ending == ".obj") return trianglesInObj(content);
  if (ending == ".stl") return trianglesInStl(content);
  if (ending == ".ply") return trianglesInPly(content);
  if (ending == ".glb" || ending == ".gltf" || ending == ".vrm") return trianglesInGltf(content);
  return content.size() / kBytesPerTriangle;
}

}  // namespace lorica
