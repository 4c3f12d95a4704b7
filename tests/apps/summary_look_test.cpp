#include "tests/apps/mannequin_glb.h"
#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

namespace lorica::test {
namespace {

using Json = nlohmann::json;

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
  const Json json = runLorica({"info", file, "--json", "-"}).json();
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

  const Json asked = runLorica({"info", file, "--texture-size", "256", "--json", "-"}).json();
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
  EXPECT_TRUE(runLorica({"info", file, "--json", "-"}).json()["materials"].empty());
  EXPECT_NE(runLorica({"info", file}).out.find("none: drawn in plain grey"), std::string::npos);
}

}  // namespace
}  // namespace lorica::test
