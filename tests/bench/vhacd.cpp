// The V-HACD benchmark. Input: a folder of meshes and a table of part counts. Output: one CSV row for each mesh, count,
// preset and number of threads, then medians and means on lines that start with #.

#include "acd/score.h"
#include "acd/transfer.h"
#include "geometry/files.h"
#include "tests/bench/benchmark_table.h"
#include "tests/bench/measure.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <sstream>

namespace lorica::bench {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string folder;
  std::string table;
  std::vector<std::string> presets = {"paper", "fast", "quality"};
  std::vector<int> threads = {2};
  std::vector<std::string> only;
  int repeats = 1;
};

struct Row {
  std::string mesh;
  int wanted = 0;
  std::size_t column = 0;  ///< of the table
  std::string preset;
  int threads = 0;
  double score16 = 0.0;
  double score17 = 0.0;
  double distance = 0.0;
  double uncovered = 0.0;
  double seconds = 0.0;
  double cpuSeconds = 0.0;
};

/// Does all work for one row. @return the measured columns as CSV
Result<std::string> measure(const fs::path& file, int parts, DecomposePreset preset, int threads, int repeats) {
  std::string repaired;
  const Result<TriMesh> read = readRepaired(file, &repaired);
  if (!read) return read.error();
  const TriMesh& mesh = *read;
  DecomposeSettings settings;
  settings.maxParts = parts;
  settings.preset = preset;
  settings.threads = threads;
  const PoseView pose{mesh.vertices, static_cast<int>(mesh.vertices.size())};
  const Result<Timed> made = timeDecompose(mesh, pose, settings, repeats);
  if (!made) return made.error();
  const double peak = peakMemoryMiB();  // before scoring, which is not measured

  std::vector<Vec3> points(static_cast<std::size_t>(made->decomposition.pointCount()));
  transfer(made->decomposition, mesh.vertices, points);
  std::vector<TriMesh> hulls;
  for (ConvexHull& hull : partHulls(made->decomposition, points)) {
    hulls.push_back({std::move(hull.vertices), std::move(hull.triangles)});
  }
  const Result<Score> judged = score(mesh, hulls, ScoreSettings());
  if (!judged) return judged.error();
  return fmt::format("{},{:.5f},{:.5f},{:.5f},{:.5f},{:.6f},{:.4f},{:.4f},{:.4f},{:.1f},{},{},{}",
                     made->decomposition.parts.size(), judged->score16, judged->score16StandardError, judged->score17,
                     judged->distancePercentDiagonal, std::max(0.0, judged->uncoveredFraction), made->seconds,
                     made->minSeconds, made->cpuSeconds, peak, hexDigits(hashOf(made->decomposition)),
                     mesh.vertices.size(), csvField(repaired));
}

/// Prints means and medians for each preset and number of threads, in total and for each column of the table.
void summarize(const std::vector<Row>& rows) {
  std::map<std::pair<std::string, int>, std::vector<Row>> groups;
  for (const Row& row : rows) groups[{row.preset, row.threads}].push_back(row);
  const auto print = [](const std::string& name, const std::vector<Row>& group) {
    const auto column = [&](double Row::*member) {
      std::vector<double> values;
      values.reserve(group.size());
      for (const Row& row : group) values.push_back(row.*member);
      return values;
    };
    fmt::print(
        "# {}: rows {}; mean, median of score16 {:.4f}, {:.4f}; score17 {:.4f}, {:.4f}; distance {:.4f}, {:.4f} % of "
        "diagonal; uncovered {:.5f}, {:.5f}; seconds {:.3f}, {:.3f}; CPU seconds {:.3f}, {:.3f}\n",
        name, group.size(), meanOf(column(&Row::score16)), medianOf(column(&Row::score16)),
        meanOf(column(&Row::score17)), medianOf(column(&Row::score17)), meanOf(column(&Row::distance)),
        medianOf(column(&Row::distance)), meanOf(column(&Row::uncovered)), medianOf(column(&Row::uncovered)),
        meanOf(column(&Row::seconds)), medianOf(column(&Row::seconds)), meanOf(column(&Row::cpuSeconds)),
        medianOf(column(&Row::cpuSeconds)));
  };
  for (const auto& [key, group] : groups) {
    const std::string name = fmt::format("{}, threads {}", key.first, key.second);
    print(name, group);
    std::map<std::size_t, std::vector<Row>> columns;
    for (const Row& row : group) columns[row.column].push_back(row);
    for (const auto& [column, some] : columns) print(fmt::format("{}, count {}", name, column + 1), some);
    // Compare each row with the paper's algorithm (differences in the last digits are ties) and with one thread.
    const auto pairWith = [&rows = group](const std::vector<Row>& others, const auto& use) {
      for (const Row& row : rows) {
        for (const Row& other : others) {
          if (other.mesh == row.mesh && other.column == row.column) use(row, other);
        }
      }
    };
    const auto paper = groups.find({"paper", key.second});
    if (key.first != "paper" && paper != groups.end()) {
      std::vector<double> gains;
      pairWith(paper->second, [&](const Row& row, const Row& other) { gains.push_back(row.score17 - other.score17); });
      if (gains.empty()) continue;
      fmt::print("# {}: score17 at least that of paper on {} of {} rows, mean gain {:+.4f}\n", name,
                 std::count_if(gains.begin(), gains.end(), [](double gain) { return gain >= -1e-5; }), gains.size(),
                 meanOf(gains));
    }
    const auto single = groups.find({key.first, 1});
    if (key.second != 1 && single != groups.end()) {
      std::vector<double> speedups;
      pairWith(single->second,
               [&](const Row& row, const Row& other) { speedups.push_back(other.seconds / row.seconds); });
      if (speedups.empty()) continue;
      fmt::print("# {}: {:.2f} times as fast as one thread (median over the rows)\n", name, medianOf(speedups));
    }
  }
}

int run(const Options& options) {
  const Result<std::vector<BenchmarkMesh>> table = readBenchmark(options.folder, options.table, options.only);
  if (!table) return fail(table.error());

  fmt::print(
      "mesh,wanted,preset,threads,parts,score16,score16_se,score17,distance_percent,uncovered,seconds,"
      "min_seconds,cpu_seconds,peak_mib,hash,vertices,repaired,error\n");
  std::vector<Row> rows;
  int failed = 0;
  for (const BenchmarkMesh& wanted : *table) {
    const fs::path& file = wanted.file;
    if (file.empty()) {
      fmt::print(stderr, "{}: no such mesh in {}\n", wanted.name, options.folder);
      ++failed;
      continue;
    }
    for (std::size_t column = 0; column < wanted.counts.size(); ++column) {
      for (const std::string& preset : options.presets) {
        for (const int threads : options.threads) {
          const int count = wanted.counts[column];
          fmt::print(stderr, "{} in {} parts, {}, threads {}\n", wanted.name, count, preset, threads);
          const Result<std::string> measured =
              inOwnProcess([&] { return measure(file, count, presetOf(preset), threads, options.repeats); });
          const std::string start = fmt::format("{},{},{},{}", wanted.name, count, preset, threads);
          if (!measured) {
            fmt::print(stderr, "{}: {}\n", file.filename().string(), measured.error().message);
            fmt::print("{},,,,,,,,,,,,,,{}\n", start, csvField(measured.error().message));
            ++failed;
            continue;
          }
          fmt::print("{},{},\n", start, *measured);
          std::fflush(stdout);
          Row row{wanted.name, count, column, preset, threads};
          std::array<double, 9> number{};
          std::istringstream fields(*measured);
          std::string field;
          for (double& n : number) {
            std::getline(fields, field, ',');
            n = std::stod(field);
          }
          row.score16 = number[1];
          row.score17 = number[3];
          row.distance = number[4];
          row.uncovered = number[5];
          row.seconds = number[6];
          row.cpuSeconds = number[8];
          rows.push_back(row);
        }
      }
    }
  }
  summarize(rows);
  if (failed > 0) fmt::print("# failed: {}\n", failed);
  return failed > 0 ? 1 : 0;
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  lorica::bench::Options options;
  CLI::App app(
      "Decomposes the meshes of a folder and scores the parts: CSV on standard output, progress on standard "
      "error.");
  app.add_option("FOLDER", options.folder, "Meshes (.off, .obj, .ply, .stl)")
      ->required()
      ->check(CLI::ExistingDirectory);
  app.add_option("TABLE", options.table, "CSV: mesh name, then part counts; see vhacd_counts.csv")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("--preset", options.presets, "paper, fast, quality [default: all]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"paper", "fast", "quality"}));
  app.add_option("--threads", options.threads, "One or more numbers of threads [default: 2]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Range(1, 1024));
  app.add_option("--only", options.only, "Only these meshes of the table, separated by commas")
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--repeats", options.repeats, "Number of decompositions for median times")->check(CLI::Range(1, 1000));
  CLI11_PARSE(app, argc, argv);
  return lorica::bench::run(options);
}
