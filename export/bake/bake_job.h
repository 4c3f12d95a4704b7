#pragma once

#include "export/bake/bake_list.h"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// A file that a result depends on.
struct BakeInput {
  std::string file;
  std::string hash;  ///< of its content, in hexadecimal digits; empty = cannot be read, or ships with Lorica
};

/// An item with what its inputs say before any work.
struct BakeJob {
  BakeItem item;
  std::uint64_t key = 0;  ///< of the inputs' contents and names, the settings and kAlgorithmVersion
  std::string name;       ///< of its result: the input's stem and the key, "bunny-0123456789abcdef"
  std::string stem;       ///< of the files in it: "bunny"
  std::vector<BakeInput> inputs;
  std::string refused;          ///< why nothing is tried: the input is a folder, a named pipe or a device; else empty
  std::uint64_t triangles = 0;  ///< of the input, see trianglesIn()
};

/// Reads every file once, however many items use it, and finds each item's key. Items with the same key are one job.
[[nodiscard]] std::vector<BakeJob> bakeJobs(std::span<const BakeItem> items);

/// One part of a list: `index` of `count`, from 1.
struct Shard {
  int index = 1;
  int count = 1;
};

/// The jobs of one shard: chosen by their keys, so that they do not depend on the order or on the rest of the list.
[[nodiscard]] std::vector<BakeJob> jobsOf(const Shard& shard, std::span<const BakeJob> jobs);

/// Memory that an item takes at most [bytes], as a function of its triangles: docs/BAKE.md says how it was measured.
[[nodiscard]] std::uint64_t memoryBound(std::uint64_t triangles);

/// How many triangles a file has, without reading its geometry: exactly for triangle meshes in OFF, OBJ and STL; of PLY
/// two for each face; of glTF those of all its meshes, each once; of FBX and COLLADA, which say it nowhere, one for
/// every 12 bytes. Files that are no such files have some number.
/// @param ending  of the file's name, in small letters: ".off"
[[nodiscard]] std::uint64_t trianglesIn(std::string_view content, const std::string& ending);

}  // namespace lorica
