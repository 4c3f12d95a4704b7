#pragma once

#include "skinning/clip.h"
#include "skinning/import/character_file.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <span>
#include <vector>

namespace lorica::test {

/// Random rotations of every joint but those without a node, and a random path of the topmost joints, at uneven times
/// from 5 s on.
[[nodiscard]] SkeletalMotion randomMotion(const CharacterFile& file, int frames, unsigned seed);

/// The farthest distance between a motion and the first clip of a file, in positions of vertices and of joints of the
/// same name and order [m]. Fails the test if they cannot be compared.
[[nodiscard]] double farthestFrom(const CharacterFile& read, const Character& character, const SkeletalMotion& motion);

/// The JSON of a .glb.
[[nodiscard]] nlohmann::json documentOf(const std::filesystem::path& glb);

}  // namespace lorica::test
