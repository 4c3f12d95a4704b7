#pragma once

#include "geometry/math.h"
#include "viewer/renderer/image.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace lorica::test {

/// What the peers need and this machine lacks, with how to install it; empty if all is there.
[[nodiscard]] std::string missingForPeers();

/// Skips the test with the reason where the peers cannot run.
#define LORICA_REQUIRE_PEERS() \
  if (const std::string missing = ::lorica::test::missingForPeers(); !missing.empty()) GTEST_SKIP() << missing

/// Runs a script of tests/peers with Node and fails the test with the script's own words if that fails.
/// @param script     its file name, such as "render.mjs"
/// @param arguments  passed as they are
/// @return whether it ended well
[[nodiscard]] bool runPeer(const std::string& script, const std::vector<std::string>& arguments);

/// A file that a peer has written.
[[nodiscard]] nlohmann::json readJson(const std::filesystem::path& file);

/// The file tests/peers/shots/<name>.json.
[[nodiscard]] nlohmann::json readShots(const std::string& name);

/// What three.js makes of one shot. Positions in metres, the character facing +Z.
struct PeerShot {
  Image picture;                ///< none if the shot asks for none
  Image mask;                   ///< grey: the share of a pixel that is covered
  nlohmann::json facts;         ///< see README.md: options, joints, nodes, frames, meshes
  std::vector<Vec3f> vertices;  ///< if asked for: of all nodes, primitives and vertices in the file's order
};

/// Draws the shots of a file by three.js. Fails the test, and returns fewer shots, if that fails.
/// @param shots  as in tests/peers/shots
[[nodiscard]] std::map<std::string, PeerShot> shootWithPeer(const std::filesystem::path& character,
                                                            const nlohmann::json& shots);

/// A copy of a GLB or VRM with changed JSON. @param edit  changes the document in place
void writeEdited(const std::filesystem::path& from, const std::filesystem::path& to,
                 const std::function<void(nlohmann::json&)>& edit);

[[nodiscard]] Vec3 vectorOf(const nlohmann::json& numbers);

}  // namespace lorica::test
