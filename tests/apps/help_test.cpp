#include "tests/apps/run_command.h"

#include "tests/apps/mannequin_glb.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"

#include <gtest/gtest.h>

#include <sstream>

namespace lorica::test {
namespace {

using testing::TestWithParam;
using Json = nlohmann::json;

class Help : public TestWithParam<const char*> {};

TEST_P(Help, TeachesByExample) {
  const CommandResult result = runLorica({GetParam(), "--help"});
  EXPECT_EQ(result.exitCode, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_TRUE(has(result.out, "Examples:\n  lorica "));
  EXPECT_TRUE(has(result.out, std::string("  lorica ") + GetParam()));
  EXPECT_TRUE(has(result.out, "--json"));
  EXPECT_TRUE(has(result.out, "--threads"));
}

TEST_P(Help, IsThereInShortWithTheNamesOfAllOptions) {
  const std::string all = runLorica({GetParam(), "--help"}).out;
  const CommandResult brief = runLorica({GetParam(), "-h"});
  EXPECT_EQ(brief.exitCode, 0);
  EXPECT_LT(brief.out.size(), all.size());
  std::istringstream help(all);
  int options = 0;
  for (std::string line; std::getline(help, line) && line != "Examples:";) {
    const std::size_t at = line.find("--");
    if (at == std::string::npos || line.substr(0, 3) != "  -") continue;
    ++options;
    EXPECT_TRUE(has(brief.out, line.substr(at, line.find_first_of(" ,", at) - at))) << line;
  }
  EXPECT_GT(options, 5);
}

INSTANTIATE_TEST_SUITE_P(Command, Help,
                         testing::Values("demo", "decompose", "score", "play", "info", "bake", "contacts"),
                         [](const auto& chosen) { return std::string(chosen.param); });

TEST(Command, HelpListsEveryCommand) {
  const CommandResult result = runLorica({"--help"});
  EXPECT_EQ(result.exitCode, 0);
  for (const char* name : {"demo", "decompose", "score", "play", "info", "bake", "contacts"}) {
    EXPECT_TRUE(has(result.out, std::string("\n  ") + name + " "));
  }
}

TEST(Command, HelpSeparatesOptionsFromTheirDescriptions) {
  const std::string help = runLorica({"snapshot", "--help"}).out;
  EXPECT_TRUE(has(help, "  --target X,Y,Z Needs: --eye\n"));
  EXPECT_TRUE(has(help, "  --strip                     Combine"));
}

TEST(Command, HelpFitsTheWidth) {
  for (const char* command : {"play", "live", "decompose", "bake", "contacts"}) {
    std::istringstream help(runLorica({command, "--help"}).out);
    std::string line;
    while (std::getline(help, line) && line != "Examples:") EXPECT_LE(line.size(), 100u) << line;
    EXPECT_EQ(line, "Examples:");
  }
}

TEST(Command, HelpIsACommandToo) {
  EXPECT_EQ(runLorica({"help", "play"}).out, runLorica({"play", "--help"}).out);
  EXPECT_EQ(runLorica({"help"}).out, runLorica({"--help"}).out);
}

TEST(Command, SaysItsVersion) {
  const CommandResult result = runLorica({"--version"});
  EXPECT_EQ(result.exitCode, 0);
  EXPECT_EQ(result.out.rfind("lorica ", 0), 0u) << result.out;
}

TEST(Command, UnknownCommandsOfHelpAreNoFiles) {
  EXPECT_FALSE(has(runLorica({"help", "wlak"}).err, "walk"));
}

/// The head of a PNG file of one bit a pixel, and as many bytes as the smallest file of that size has.
std::string pngHead(std::uint32_t width, std::uint32_t height) {
  std::string png("\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR", 16);
  for (const std::uint32_t side : {width, height}) {
    for (int shift = 24; shift >= 0; shift -= 8) png.push_back(static_cast<char>(side >> shift & 0xFFu));
  }
  png += std::string("\x01\0\0\0\0", 5);
  return png + std::string(width / 8 * height / 1032 + 100, '\0');
}

/// The mannequin with a mesh named Coat: its material has a picture of 2048 x 1024 pixels and one that is none.
GlbWriter dressedMannequin() {
  GlbWriter writer = mannequinWriter(false);
  const auto picture = [&](const std::string& bytes, const char* name) {
    const int view = writer.view(std::vector<char>(bytes.begin(), bytes.end()));
    const int image = writer.add("images", {{"bufferView", view}, {"name", name}});
    return writer.add("textures", {{"source", image}});
  };
  const int cloth = picture(pngHead(2048, 1024), "cloth");
  const int broken = picture("RIFF....WEBPVP8 ", "broken");
  writer.add("materials", {{"name", "wool"},
                           {"alphaMode", "MASK"},
                           {"doubleSided", true},
                           {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", cloth}}}}},
                           {"emissiveTexture", {{"index", broken}}}});
  writer.add("materials", {{"name", "unused"}});
  writer.document["meshes"][0]["name"] = "Coat";
  writer.document["meshes"][0]["primitives"][0]["material"] = 0;
  return writer;
}

TEST(SummaryLook, MaterialsPicturesAndTheirMemoryAreListed) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("dressed.glb", dressedMannequin().glb());
  const Json json = jsonOf({"info", file});
  ASSERT_EQ(json["meshNames"].size(), 1u);
  EXPECT_EQ(json["meshNames"][0]["mesh"], "Coat");
  ASSERT_EQ(json["materials"].size(), 1u) << "one is not used";
  const Json& wool = json["materials"][0];
  EXPECT_EQ(wool["name"], "wool");
  EXPECT_EQ(wool["kind"], "metallic-roughness");
  EXPECT_EQ(wool["alpha"], "masked");
  EXPECT_EQ(wool["doubleSided"], true);
  EXPECT_EQ(wool["triangles"], json["triangles"]);
  EXPECT_EQ(wool["textures"], Json::array({"base colour", "emissive"}));
  ASSERT_EQ(json["pictures"].size(), 2u);
  EXPECT_EQ(json["pictures"][0]["name"], "image 0 'cloth'");
  EXPECT_EQ(json["pictures"][0]["width"], 2048);
  EXPECT_EQ(json["pictures"][0]["height"], 1024);
  EXPECT_EQ(json["pictures"][1]["problem"], "image 1 'broken': a WebP picture of 16 bytes that is damaged or cut off");
  // 4 bytes a pixel, and smaller copies of a quarter, a sixteenth, ... of it.
  const double stored = 4.0 * 2048 * 1024 * 4 / 3;
  EXPECT_NEAR(json["textureBytes"].get<double>(), stored, 16.0);
  EXPECT_EQ(json["reducedTextureBytes"]["textureSize"], 1024);
  EXPECT_NEAR(json["reducedTextureBytes"]["bytes"].get<double>(), stored / 4, 16.0);

  const Json asked = jsonOf({"info", file, "--texture-size", "256"});
  EXPECT_EQ(asked["reducedTextureBytes"]["textureSize"], 256);
  EXPECT_NEAR(asked["reducedTextureBytes"]["bytes"].get<double>(), stored / 64, 16.0);

  const std::string text = runLorica({"info", file}).out;
  for (const char* part : {"mesh names", "Coat", "wool", "masked", "base colour, emissive", "2048    1024",
                           "2 pictures, 11.2 MB on the GPU, 2.8 MB with --texture-size 1024", "a WebP picture"}) {
    EXPECT_NE(text.find(part), std::string::npos) << "no `" << part << "` in: " << text;
  }
}

TEST(SummaryLook, CharactersWithoutMaterialsSaySo) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("bare.glb", mannequinGlb(false));
  EXPECT_TRUE(jsonOf({"info", file})["materials"].empty());
  EXPECT_NE(runLorica({"info", file}).out.find("none: drawn in plain grey"), std::string::npos);
}

}  // namespace
}  // namespace lorica::test
