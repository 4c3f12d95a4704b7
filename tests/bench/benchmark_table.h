#pragma once

#include "geometry/mesh_repair.h"
#include "geometry/result.h"
#include "geometry/tri_mesh.h"

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace lorica::bench {

/// A mesh of a benchmark and the part counts to cut it into.
struct BenchmarkMesh {
  std::string name;
  std::vector<int> counts;
  std::filesystem::path file;  ///< empty if the folder has no such mesh
};

/// Meshes in a folder, in any format, and a table of their names and part counts.
struct Benchmark {
  std::string folder, table;
  std::vector<std::string> only;  ///< keep only these meshes; empty = all
};
/// FOLDER TABLE [--only NAMES]
void addBenchmark(CLI::App& app, Benchmark& benchmark);

/// @return the meshes, or an error: unreadable table, or a name in `only` that the table does not have
[[nodiscard]] Result<std::vector<BenchmarkMesh>> readBenchmark(const Benchmark& benchmark);

/// Reads a mesh and repairs small faults.
/// @param summary  what was repaired, if not null
[[nodiscard]] Result<TriMesh> readRepaired(const std::filesystem::path& file, std::string* summary = nullptr);

}  // namespace lorica::bench
