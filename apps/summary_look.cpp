#include "apps/file_summary.h"
#include "geometry/text.h"

#include "skinning/look/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace lorica {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kRowsShown = 12;
constexpr std::size_t kNamesShown = 24;
constexpr int kSuggestedSize = 1024;  // if no texture size is given

const char* nameOf(Shading shading) {
  return shading == Shading::kToon ? "MToon" : shading == Shading::kUnlit ? "unlit" : "metallic-roughness";
}

const char* nameOf(AlphaMode mode) {
  return mode == AlphaMode::kBlend ? "blended" : mode == AlphaMode::kMask ? "masked" : "opaque";
}

/// Material::textures() in words.
constexpr std::array kTextureNames = {"base colour",   "metallic-roughness", "normal", "occlusion", "emissive",
                                      "shade",         "shading shift",      "matcap", "rim",       "outline width",
                                      "animation mask"};

std::vector<std::string> texturesOf(const Material& material) {
  const auto uses = material.textures();
  static_assert(kTextureNames.size() == std::tuple_size_v<decltype(material.textures())>);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    if (uses[i]->given()) names.emplace_back(kTextureNames[i]);
  }
  return names;
}

/// Memory of a texture with its smaller copies, which add a third [bytes].
std::size_t bytesOf(PictureSize size, int textureSize) {
  const PictureSize limited = limitedSize(size, textureSize);
  return static_cast<std::size_t>(limited.width) * limited.height * 4 / 3 * 4;
}

std::string megabytes(std::size_t bytes) {
  return fmt::format("{:.1f} MB", bytes * 1e-6);
}

void describeMaterials(const Look& look, Report& report, Json& json) {
  std::vector<std::size_t> triangles(look.materials.size(), 0);
  for (const LookGroup& group : look.groups) triangles[group.material] += group.triangleCount;
  Table table{{"triangles", "material", "kind", "alpha", "textures"}, {}, 1};
  std::size_t count = 0;
  json["materials"] = Json::array();
  for (std::size_t m = 0; m < look.materials.size(); ++m) {
    if (triangles[m] == 0) continue;
    const Material& material = look.materials[m];
    const std::vector<std::string> textures = texturesOf(material);
    json["materials"].push_back({{"name", material.name},
                                 {"kind", nameOf(material.shading)},
                                 {"alpha", nameOf(material.alpha)},
                                 {"doubleSided", material.doubleSided},
                                 {"triangles", triangles[m]},
                                 {"textures", textures}});
    if (count++ >= kRowsShown) continue;
    table.rows.push_back({grouped(triangles[m]), material.name, nameOf(material.shading), nameOf(material.alpha),
                          fmt::format("{}", fmt::join(textures, ", "))});
  }
  report.line("materials", fmt::format("{}", count));
  report.table(std::move(table));
  if (count > kRowsShown) report.note("The table does not show all materials; --json does.");
}

void describePictures(const Look& look, int textureSize, Report& report, Json& json) {
  json["pictures"] = Json::array();
  if (look.pictures.empty()) return;
  Table table{{"width", "height", "kB in the file", "picture"}, {}, 3};
  const int reduced = textureSize > 0 ? textureSize : kSuggestedSize;
  std::size_t stored = 0;
  std::size_t limited = 0;
  std::size_t broken = 0;
  for (const StoredPicture& picture : look.pictures) {
    const Result<PictureSize> size = readPictureSize(picture.bytes, picture.name);
    Json one = {{"name", picture.name}, {"bytes", picture.bytes.size()}};
    if (size) {
      one["width"] = size->width;
      one["height"] = size->height;
      stored += bytesOf(*size, 0);
      limited += bytesOf(*size, reduced);
    } else {
      one["problem"] = size.error().message;
      if (++broken <= 3) report.note(size.error().message + ".");
    }
    json["pictures"].push_back(std::move(one));
    if (!size || table.rows.size() >= kRowsShown) continue;
    table.rows.push_back({fmt::format("{}", size->width), fmt::format("{}", size->height),
                          fmt::format("{:.0f}", picture.bytes.size() * 1e-3), picture.name});
  }
  json["textureBytes"] = stored;
  json["reducedTextureBytes"] = {{"textureSize", reduced}, {"bytes", limited}};
  std::string memory =
      fmt::format("{}, {} on the GPU", counted(std::ssize(look.pictures), "picture"), megabytes(stored));
  if (limited < stored) memory += fmt::format(", {} with --texture-size {}", megabytes(limited), reduced);
  report.line("textures", memory);
  const std::size_t readable = look.pictures.size() - broken;
  if (!table.rows.empty()) report.table(std::move(table));
  if (readable > kRowsShown) report.note("The table does not show all pictures; --json does.");
  if (broken > 3) report.note(fmt::format("{} pictures cannot be read; --json says why.", broken));
}

}  // namespace

void describeMeshNames(std::span<const MeshName> meshes, Report& report, Json& json) {
  json["meshNames"] = Json::array();
  std::vector<std::string> names;
  for (const MeshName& mesh : meshes) {
    json["meshNames"].push_back({{"node", mesh.node}, {"mesh", mesh.mesh}});
    names.push_back(mesh.text());
  }
  if (names.empty()) return;
  const std::size_t more = names.size() - std::min(names.size(), kNamesShown);
  names.resize(names.size() - more);
  report.line("mesh names",
              fmt::format("{}{}", fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : ""));
}

void describeLook(const Look& look, int textureSize, Report& report, Json& json) {
  if (!look.given()) {
    report.line("materials", "none: drawn in plain grey");
    json["materials"] = Json::array();
    json["pictures"] = Json::array();
    return;
  }
  describeMaterials(look, report, json);
  describePictures(look, textureSize, report, json);
}

}  // namespace lorica
