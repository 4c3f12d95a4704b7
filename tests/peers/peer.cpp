#include "tests/peers/peer.h"

#include "skinning/import/gltf_document.h"
#include "tests/support/datasets.h"
#include "viewer/pictures/image_files.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <span>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const fs::path kPeers = built("peers");

std::string textOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string quoted(const std::string& argument) {
  std::string out = "'";
  for (const char c : argument) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

Image pngIfThere(const fs::path& file) {
  if (!fs::exists(file)) return {};
  Result<Image> image = readPng(file);
  if (image) return std::move(image).value();
  ADD_FAILURE() << image.error().message;
  return {};
}

}  // namespace

std::string missingForPeers() {
  const std::string install = "; scripts/peers installs it and runs these tests";
  if (std::system("node --version >/dev/null 2>&1") != 0) return "Node.js is missing" + install;
  const char* named = std::getenv("CHROMIUM");
  const fs::path chromium = named != nullptr ? named : "/usr/bin/chromium";
  if (!fs::exists(chromium)) return "Chromium is missing (" + chromium.string() + ")" + install;
  for (const char* package : {"three", "@pixiv/three-vrm", "puppeteer-core", "esbuild", "gltf-validator", "osc",
                              "osc-min", "@mujoco/mujoco", "@gltf-transform/core", "@gltf-transform/extensions",
                              "@dimforge/rapier3d-compat", "jolt-physics", "ajv", "iwer"}) {
    if (!fs::exists(kPeers / "node_modules" / package)) {
      return "the npm package " + std::string(package) + " is missing in " + kPeers.string() + install;
    }
  }
  return {};
}

bool runPeer(const std::string& script, const std::vector<std::string>& arguments) {
  const TemporaryFolder folder;
  const fs::path log = folder.path() / "log";
  std::string command = "node " + quoted((kPeers / script).string());
  for (const std::string& argument : arguments) command += " " + quoted(argument);
  command += " >" + quoted(log.string()) + " 2>&1";
  if (std::system(command.c_str()) == 0) return true;
  ADD_FAILURE() << command << " failed:\n" << textOf(log);
  return false;
}

json readJson(const fs::path& file) {
  return json::parse(textOf(file));
}

json readShots(const std::string& name) {
  return readJson(sourceFile("tests/peers/shots") / (name + ".json"));
}

std::map<std::string, PeerShot> shootWithPeer(const fs::path& character, const json& shots) {
  std::map<std::string, PeerShot> made;
  const TemporaryFolder folder;
  const fs::path list = folder.write("shots.json", shots.dump());
  if (!runPeer("render.mjs", {character.string(), list.string(), folder.path().string()})) return made;
  for (const auto& [name, options] : shots.at("shots").items()) {
    PeerShot& shot = made[name];
    shot.picture = pngIfThere(folder.path() / (name + ".png"));
    shot.mask = pngIfThere(folder.path() / (name + ".mask.png"));
    shot.facts = json::parse(textOf(folder.path() / (name + ".json")));
    const std::string bytes = textOf(folder.path() / (name + ".vertices"));
    shot.vertices.resize(bytes.size() / sizeof(Vec3f));
    std::memcpy(static_cast<void*>(shot.vertices.data()), bytes.data(), shot.vertices.size() * sizeof(Vec3f));
  }
  return made;
}

void writeEdited(const fs::path& from, const fs::path& to, const std::function<void(json&)>& edit) {
  const std::string bytes = textOf(from);
  const Result<GltfParts> parts = splitGltf(std::as_bytes(std::span(bytes)), from.string());
  ASSERT_TRUE(parts.ok() && parts->binary) << from;
  json document = json::parse(parts->json);
  edit(document);
  std::string text = document.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::ofstream out(to, std::ios::binary);
  const auto number = [&](std::size_t n) {
    const auto value = static_cast<std::uint32_t>(n);  // GLB is little-endian, as are all machines that Lorica runs on
    out.write(reinterpret_cast<const char*>(&value), sizeof value);
  };
  const std::span<const std::byte> binary = *parts->binary;
  const std::size_t padded = (binary.size() + 3) / 4 * 4;
  for (const std::size_t n : {std::size_t{0x46546C67}, std::size_t{2}, 12 + 8 + text.size() + 8 + padded, text.size(),
                              std::size_t{0x4E4F534A}}) {
    number(n);
  }
  out << text;
  number(padded);
  number(0x004E4942);
  out.write(reinterpret_cast<const char*>(binary.data()), static_cast<std::streamsize>(binary.size()));
  out << std::string(padded - binary.size(), '\0');
  ASSERT_TRUE(out.good()) << to;
}

Vec3 vectorOf(const json& numbers) {
  return {numbers.at(0).get<double>(), numbers.at(1).get<double>(), numbers.at(2).get<double>()};
}

}  // namespace lorica::test
