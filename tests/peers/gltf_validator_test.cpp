// The rules of glTF as gltf-validator has them: what it calls an error Lorica refuses or notes, and the other way
// round.
#include "skinning/look/avatar.h"
#include "tests/peers/peer.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/datasets.h"
#include "viewer/pictures/image_files.h"

#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <set>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::GlbWriter;

std::string pngOfOnePixel() {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(writePng(folder.path() / "p.png", Image{1, 1, {200, 100, 50, 255}}));
  std::ifstream stream(folder.path() / "p.png", std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The small character with a texture, a morph target and the bounds that glTF requires: a file without a fault.
GlbWriter faultless() {
  GlbWriter w = test::smallCharacter();
  json& d = w.document;
  const auto bounds = [&](int accessor, const std::vector<float>& least, const std::vector<float>& greatest) {
    d["accessors"][accessor]["min"] = least;
    d["accessors"][accessor]["max"] = greatest;
  };
  bounds(0, {-0.2F, 0.0F, -0.2F}, {0.2F, 2.0F, 0.2F});
  bounds(5, {0.0F}, {2.0F});
  json& primitive = d["meshes"][0]["primitives"][0];
  primitive["attributes"]["TEXCOORD_0"] = w.add(
      "accessors",
      {{"bufferView", w.view(std::vector<float>(16, 0.5F))}, {"componentType", 5126}, {"count", 8}, {"type", "VEC2"}});
  const int target = w.accessor(std::vector<float>(24, 0.25F), "VEC3");
  bounds(target, {0.25F, 0.25F, 0.25F}, {0.25F, 0.25F, 0.25F});
  primitive["targets"] = {{{"POSITION", target}}};
  d["meshes"][0]["weights"] = {0.0};
  primitive["material"] = 0;
  const std::string png = pngOfOnePixel();
  const int view = w.view(std::vector<std::uint8_t>(png.begin(), png.end()));
  d["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}}};
  d["samplers"] = {{{"magFilter", 9729}, {"wrapS", 33071}}};
  d["textures"] = {{{"sampler", 0}, {"source", 0}}};
  d["materials"] = {{{"alphaMode", "MASK"},
                     {"alphaCutoff", 0.25},
                     {"doubleSided", true},
                     {"pbrMetallicRoughness",
                      {{"baseColorFactor", {1, 1, 1, 1}},
                       {"metallicFactor", 0.5},
                       {"baseColorTexture", {{"index", 0}, {"texCoord", 0}}}}},
                     {"normalTexture", {{"index", 0}, {"scale", 1.5}}},
                     {"emissiveFactor", {0, 0.5, 0}}}};
  d["scene"] = 0;
  return w;
}

constexpr const char* kFaultless = "faultless";

struct Variant {
  std::string name;  ///< what is wrong
  std::string glb;
};

/// One file for each value of the document and each way to spoil it.
void spoilDocument(std::vector<Variant>& variants) {
  const GlbWriter whole = faultless();
  const json flat = whole.document.flatten();
  for (const auto& [pointer, value] : flat.items()) {
    const json::json_pointer at(pointer);
    std::vector<std::pair<std::string, json>> spoilt = {{"text", "x"}, {"null", nullptr}, {"list", json::array()}};
    if (value.is_number()) {
      spoilt.insert(spoilt.end(), {{"-1", -1}, {"0.5", 0.5}, {"7", 7}, {"4000000000", 4000000000U}});
    } else {
      spoilt.emplace_back("1", 1);
    }
    for (const auto& [how, bad] : spoilt) {
      GlbWriter w = whole;
      if (w.document[at] == bad) continue;
      w.document[at] = bad;
      variants.push_back({pointer + " = " + how, w.glb()});
    }
    GlbWriter w = whole;
    json& parent = w.document[at.parent_pointer()];
    if (parent.is_object()) {
      parent.erase(at.back());
      variants.push_back({pointer + " removed", w.glb()});
    }
  }
}

/// Faults in numbers and pixels.
void spoilBinary(std::vector<Variant>& variants) {
  const GlbWriter whole = faultless();
  const auto change = [&](const std::string& name, int accessor, std::size_t byte, auto value) {
    GlbWriter w = whole;
    const int view = w.document["accessors"][accessor]["bufferView"];
    const std::size_t begin = w.document["bufferViews"][view]["byteOffset"];
    std::memcpy(w.binary.data() + begin + byte, &value, sizeof(value));
    variants.push_back({name, w.glb()});
  };
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  change("position is not a number", 0, 16, nan);
  change("position is infinite", 0, 16, infinity);
  change("position beyond max", 0, 12, 0.75F);
  change("index of no vertex", 1, 8, std::uint32_t{8});
  change("index of primitive restart", 1, 8, std::uint32_t{0xffffffffU});
  change("triangle without area", 1, 4, std::uint32_t{0});
  change("vertex of a joint that the skin lacks", 2, 4, std::uint8_t{2});
  change("negative weight", 3, 0, -0.5F);
  change("weights sum to 2", 3, 4, 1.0F);
  change("weights are all zero", 3, 0, 0.0F);
  change("weight is not a number", 3, 0, nan);
  change("inverse bind matrix is infinite", 4, 64, infinity);
  change("last row of an inverse bind matrix", 4, 12, 0.5F);
  change("time is not a number", 5, 4, nan);
  change("times do not rise", 5, 0, 2.0F);
  change("negative time", 5, 0, -1.0F);
  change("rotation is not of unit length", 6, 12, 2.0F);
  change("rotation is not a number", 6, 12, nan);
  change("texture coordinate is infinite", 7, 0, infinity);
  change("morph is not a number", 8, 0, nan);

  const std::string png = pngOfOnePixel();
  const auto picture = [&](const std::string& name, const std::string& bytes, const std::string& mime) {
    GlbWriter w = whole;
    w.document["images"][0]["bufferView"] = w.view(std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
    w.document["images"][0]["mimeType"] = mime;
    variants.push_back({name, w.glb()});
  };
  picture("picture is no picture", "no picture at all, only words", "image/png");
  picture("picture is cut", png.substr(0, 30), "image/png");
  picture("picture of another kind", png, "image/jpeg");
  picture("picture of an unknown kind", "RIFF....WEBPVP8 ", "image/webp");
  picture("picture without pixels", png.substr(0, 16) + std::string(4, '\0') + png.substr(20), "image/png");

  const std::string glb = whole.glb();
  for (const std::size_t length : {0, 3, 12, 19, 20, 100})
    variants.push_back({"cut after " + std::to_string(length) + " bytes", glb.substr(0, length)});
  variants.push_back({"cut by 4 bytes", glb.substr(0, glb.size() - 4)});
  variants.push_back({"followed by 4 bytes", glb + std::string(4, '\0')});
  variants.push_back({"JSON with a comma too many", test::glbOf("{\"asset\":{\"version\":\"2.0\"},}", "")});
}

/// Where the two differ for a reason.
struct Difference {
  const char* pattern;  ///< of "variant: CODE /pointer"
  const char* reason;
};

/// What gltf-validator calls an error and Lorica reads without a word.
constexpr Difference kRead[] = {
    {".*: ACCESSOR_(MIN|MAX)_MISMATCH .*", "bounds of accessors are not read but computed"},
    {".*: ACCESSOR_ELEMENT_OUT_OF_(MIN|MAX)_BOUND .*", "the same"},
    {".*: ARRAY_TYPE_MISMATCH /accessors/[0-9]+/(min|max)", "the same"},
    {".*: [A-Z_]+_ACCESSOR_WITHOUT_BOUNDS .*", "the same"},
    {".*: TYPE_MISMATCH .*/name", "names are for people; what is no text is no name"},
    {"/bufferViews/.*: ACCESSOR_TOTAL_OFFSET_ALIGNMENT .*", "numbers are copied byte by byte"},
    {".*/bufferView = 7: BUFFER_VIEW_TARGET_OVERRIDE .*", "how a GPU would use a view does not matter"},
    {"/accessors/2/bufferView = 7: .*", "the same, and joints of weight 0 are not read"},
    {".*: ACCESSOR_ANIMATION_SAMPLER_OUTPUT_NON_NORMALIZED_QUATERNION .*", "rotations are normalised"},
    {".*: ACCESSOR_ANIMATION_INPUT_NEGATIVE .*", "a key before the beginning leads to the next one"},
    {"/bufferViews/5/byteOffset removed: ACCESSOR_ANIMATION_INPUT_NON_INCREASING .*",
     "the keys rise; they count as falling because the first is negative"},
    {".*: UNSATISFIED_DEPENDENCY /nodes/2/skin", "a skin without a mesh moves nothing"},
    {"/meshes/0/primitives/0/targets/0/POSITION removed: .*", "a morph target may move nothing"},
    {".*: (IMAGE|TEXTURE)_[A-Z_]*MIME_TYPE_INVALID .*", "the kind of a picture is found from its bytes"},
    {".*: TEXTURE_INVALID_IMAGE_MIME_TYPE .*", "the same"},
    {"/images/0/mimeType .*: (TYPE_MISMATCH|UNSATISFIED_DEPENDENCY) .*", "the same"},
    {".*: VALUE_NOT_IN_RANGE /materials/.*", "materials are drawn with the numbers that they have"},
    {".* = null: TYPE_MISMATCH /materials/.*", "null counts as not given"},
    {".*: TYPE_MISMATCH /materials/.*/texCoord", "what is no number of a set of coordinates is the first set"},
    {".*: TYPE_MISMATCH /samplers/.*", "textures are sampled in the usual way unless another one is well given"},
    {".*: [A-Z_]+ /textures/0/sampler", "the same"},
    {".*: MESH_PRIMITIVE_TOO_FEW_TEXCOORDS .*", "vertices without texture coordinates have (0, 0)"},
};

/// What Lorica refuses and gltf-validator does not call an error.
constexpr Difference kRefused[] = {
    {"/accessors/1/bufferView removed: ", "indices that are all zero draw nothing; nobody writes them"},
};

/// The first difference whose pattern fits; its use is counted.
bool isExpected(std::span<const Difference> differences, const std::string& what, std::set<std::string>& used) {
  for (const Difference& difference : differences) {
    if (!std::regex_match(what, std::regex(difference.pattern))) continue;
    used.insert(difference.pattern);
    return true;
  }
  return false;
}

/// What Lorica says of a file that it did not say of the faultless one; empty if nothing.
std::string wordsOf(const Variant& variant, std::set<std::string>& usual) {
  const Result<CharacterFile> file = parseCharacterFile(std::as_bytes(std::span(variant.glb)), "hero.glb");
  if (!file) return "refused: " + file.error().message;
  std::vector<std::string> notes = file.value().notes;
  const Result<MadeAvatar> avatar = makeAvatar(file.value().character, file.value().look);
  if (!avatar) return "refused: " + avatar.error().message;
  notes.insert(notes.end(), avatar.value().notes.begin(), avatar.value().notes.end());
  if (variant.name == kFaultless) usual.insert(notes.begin(), notes.end());
  std::string words;
  for (const std::string& note : notes) {
    if (!usual.contains(note)) words += (words.empty() ? "" : "; ") + note;
  }
  return words;
}

TEST(GltfValidator, CallsWrongWhatLoricaRefusesOrNotes) {
  LORICA_REQUIRE_PEERS();
  std::vector<Variant> variants = {{kFaultless, faultless().glb()}};
  spoilDocument(variants);
  spoilBinary(variants);
  const test::TemporaryFolder folder;
  fs::create_directory(folder.path() / "files");
  const auto fileOf = [](std::size_t i) { return std::to_string(i) + ".glb"; };
  for (std::size_t i = 0; i < variants.size(); ++i) (void)folder.write("files/" + fileOf(i), variants[i].glb);
  const fs::path out = folder.path() / "report.json";
  ASSERT_TRUE(test::runPeer("validate.mjs", {(folder.path() / "files").string(), out.string()}));
  std::ifstream stream(out);
  const json report = json::parse(stream);

  const fs::path kept = test::built("peers/gltf_validator.txt");
  std::ofstream table(kept);
  std::set<std::string> usual, used;
  int faulty = 0, told = 0;
  for (std::size_t i = 0; i < variants.size(); ++i) {
    const Variant& variant = variants[i];
    const std::string words = wordsOf(variant, usual);
    std::string codes, unexpected;
    for (const json& issue : report.at(fileOf(i))) {
      if (issue.at("severity") != 0) continue;
      const std::string code = issue.at("code").get<std::string>() + " " + issue.at("pointer").get<std::string>();
      codes += (codes.empty() ? "" : "; ") + code;
      if (words.empty() && !isExpected(kRead, variant.name + ": " + code, used)) unexpected += "\n  " + code;
    }
    EXPECT_EQ(unexpected, "") << variant.name << ": read without a word";
    if (codes.empty() && words.starts_with("refused")) {
      EXPECT_TRUE(isExpected(kRefused, variant.name + ": ", used)) << variant.name << ": " << words;
    }
    EXPECT_TRUE(i > 0 || (codes + words).empty()) << variant.name << ": " << codes << words;
    faulty += codes.empty() ? 0 : 1;
    told += !codes.empty() && !words.empty() ? 1 : 0;
    table << variant.name << "\t" << codes << "\t" << words << "\n";
  }
  EXPECT_EQ(used.size(), std::size(kRead) + std::size(kRefused)) << "some of the known differences are no more";
  for (const Difference& d : kRead) EXPECT_TRUE(used.contains(d.pattern)) << d.pattern;
  std::printf("%zu files, %d of them faulty to gltf-validator; Lorica refuses or notes %d of these. %s\n",
              variants.size(), faulty, told, kept.c_str());
}

}  // namespace
}  // namespace lorica
