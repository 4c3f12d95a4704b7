#include "tests/apps/run_command.h"

#include "geometry/files.h"
#include "session/prepare/file_kinds.h"
#include "tests/apps/mannequin_glb.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

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

/// No word of a parser; conditions are said in the text.
TEST_P(Help, IsMadeOfWords) {
  for (const char* flag : {"-h", "--help"}) {
    const std::string help = runLorica({GetParam(), flag}).out;
    const std::string options = help.substr(0, help.find("\nExamples:"));
    for (const char* word : {"Excludes:", "Needs:", "REQUIRED", "Positionals", " ...\n", ",... ", "TEXT", "[OPTION]"}) {
      EXPECT_FALSE(has(options, word)) << word << " in " << flag;
    }
  }
}

TEST_P(Help, EndsWithWhatAllCommandsHave) {
  const std::string help = runLorica({GetParam(), "--help"}).out;
  const std::size_t last = help.find("\nEvery command:\n");
  ASSERT_NE(last, std::string::npos);
  std::istringstream rest(help.substr(last + 1));
  for (std::string line; std::getline(rest, line) && !line.empty();) {
    EXPECT_TRUE(line.starts_with("  ") || line == "Every command:") << line << " stands behind what is said last";
  }
}

INSTANTIATE_TEST_SUITE_P(Command, Help,
                         testing::Values("demo", "decompose", "score", "play", "info", "bake", "contacts", "live",
                                         "serve", "replay", "snapshot", "export", "convert", "record"),
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
  EXPECT_TRUE(
      has(help, "  --target X,Y,Z              Point that the fixed camera looks at, in metres (with --eye)\n"));
  EXPECT_TRUE(has(help, "  --hide NAME                 Leave out"));
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

TEST(Command, HelpIsOfOneCommand) {
  const CommandResult result = runLorica({"help", "live", "vmc"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_TRUE(has(result.err, "vmc: unexpected argument, expected `lorica help live`")) << result.err;
}

/// Somebody new sees how to follow a webcam or a camera, where it is seen, and not what programmers need.
TEST(Command, ShortHelpOfLiveExplainsWhatIsUsedMost) {
  const std::string help = runLorica({"live", "-h"}).out;
  const std::string explained = help.substr(0, help.find("More, explained by --help:"));
  for (const char* option : {"--character", "--vmc", "--virtual", "--serve", "--window", "--background", "--scene"}) {
    EXPECT_TRUE(has(explained, std::string("\n  ") + option)) << option;
  }
  EXPECT_FALSE(has(explained, "--events"));
  EXPECT_LT(help.find("Where it is seen"), help.find("The parts and hulls")) << "in the order of use";
}

TEST(Command, MisspelledValuesAreNamed) {
  const std::vector<std::pair<std::vector<std::string>, const char*>> all = {
      {{"export", "a.off", "b.obj", "--engine", "unitty"}, "unity"},
      {{"bake", "a.off", "--out", "o", "--engine", "godott"}, "godot"},
      {{"bake", "a.off", "--out", "o", "--preset", "fats"}, "fast"},
      {{"decompose", "a.off", "--preset", "papper"}, "paper"},
      {{"play", "walk", "--walls", "shel"}, "shell"},
      {{"play", "walk", "--smooth", "one-uero"}, "one-euro"},
      {{"snapshot", "walk", "--show", "hull"}, "hulls"},
      {{"snapshot", "walk", "--camera", "frnt"}, "front"},
      {{"live", "--background", "grene"}, "green"},
      {{"live", "--springs", "bodie"}, "body"},
      {{"live", "--vrchat", "127.0.0.1", "--trackers", "wasit"}, "waist"},
      {{"convert", "a.csv", "b.csv", "--format", "utkinekt"}, "utkinect"},
  };
  for (const auto& [words, meant] : all) {
    const CommandResult result = runLorica(words);
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_TRUE(has(result.err, fmt::format("; did you mean \"{}\"?", meant))) << result.err;
  }
}

TEST(Command, SaysItsVersion) {
  const CommandResult result = runLorica({"--version"});
  EXPECT_EQ(result.exitCode, 0);
  EXPECT_EQ(result.out.rfind("lorica ", 0), 0u) << result.out;
}

/// What lorica.desktop names is named by lorica-mime.xml too, and is what `lorica FILE` opens.
TEST(Desktop, ADoubleClickOpensWhatItNames) {
  const std::string entry = valueOf(readFile(sourceFile("tools/packaging/lorica.desktop")));
  const std::string types = valueOf(readFile(sourceFile("tools/packaging/lorica-mime.xml")));
  const std::size_t begin = entry.find("MimeType=") + 9;
  std::istringstream named(entry.substr(begin, entry.find('\n', begin) - begin));
  std::set<std::string> endings;
  for (std::string type; std::getline(named, type, ';');) {
    const std::size_t at = types.find("<mime-type type=\"" + type + "\">");
    ASSERT_NE(at, std::string::npos) << type;
    const std::size_t glob = types.find("pattern=\"*", at) + 10;
    endings.insert(types.substr(glob, types.find('"', glob) - glob));
  }
  EXPECT_EQ(endings, (std::set<std::string>{".bvh", ".glb", ".lsession", ".oni", ".vrm"}));
  for (const std::string& ending : endings) EXPECT_NE(kindOf("hero" + ending), FileKind::kUnknown) << ending;
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
