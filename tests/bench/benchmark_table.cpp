#include "tests/bench/benchmark_table.h"

#include "geometry/files.h"
#include "geometry/mesh_files.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <charconv>
#include <sstream>
#include <utility>

namespace lorica::bench {
namespace {

namespace fs = std::filesystem;

fs::path fileOf(const fs::path& folder, const std::string& mesh) {
  for (const char* extension : {".off", ".obj", ".ply", ".stl"}) {
    std::error_code ignored;
    if (fs::path file = folder / (mesh + extension); fs::is_regular_file(file, ignored)) return file;
  }
  return {};
}

}  // namespace

void addBenchmark(CLI::App& app, Benchmark& benchmark) {
  app.add_option("FOLDER", benchmark.folder, "Meshes (.off, .obj, .ply, .stl)")
      ->required()
      ->check(CLI::ExistingDirectory);
  app.add_option("TABLE", benchmark.table, "CSV: mesh name, then part counts; see vhacd_counts.csv")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("--only", benchmark.only, "Only these meshes of the table, separated by commas")
      ->delimiter(',')
      ->allow_extra_args(false);
}

Result<std::vector<BenchmarkMesh>> readBenchmark(const Benchmark& benchmark) {
  const auto& [folder, table, only] = benchmark;
  const Result<std::string> text = readFile(table);
  if (!text) return text.error();
  std::vector<BenchmarkMesh> meshes;
  std::istringstream lines(*text);
  std::string line;
  bool headed = false;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (line.ends_with('\r')) line.pop_back();
    if (line.empty() || line[0] == '#') continue;
    if (!std::exchange(headed, true)) continue;  // column names
    std::istringstream fields(line);
    BenchmarkMesh mesh;
    std::getline(fields, mesh.name, ',');
    for (std::string field; std::getline(fields, field, ',');) {
      int count = 0;
      const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), count);
      if (error != std::errc() || end != field.data() + field.size() || count < 1) {
        return Error{ErrorCode::kBadFormat,
                     fmt::format("{}: line {}: found `{}`, expected a part count of at least 1", table, number, field)};
      }
      mesh.counts.push_back(count);
    }
    if (mesh.name.empty() || mesh.counts.empty()) {
      return Error{ErrorCode::kBadFormat, fmt::format("{}: line {}: expected a mesh and part counts", table, number)};
    }
    mesh.file = fileOf(folder, mesh.name);
    meshes.push_back(std::move(mesh));
  }
  if (only.empty()) return meshes;
  for (const std::string& name : only) {
    if (std::ranges::find(meshes, name, &BenchmarkMesh::name) != meshes.end()) continue;
    return Error{ErrorCode::kNotFound, fmt::format("--only: {} is not in {}", name, table)};
  }
  std::erase_if(meshes, [&](const BenchmarkMesh& m) { return std::ranges::count(benchmark.only, m.name) == 0; });
  return meshes;
}

Result<TriMesh> readRepaired(const fs::path& file, std::string* summary) {
  Result<TriMesh> read = readMesh(file);
  if (!read) return read.error();
  Result<MeshRepair> repair = repairClosedMesh(*read);
  if (!repair || !repair->changed()) return read;
  if (summary != nullptr) *summary = repair->summary();
  return std::move(repair->mesh);
}

}  // namespace lorica::bench
