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
  Benchmark benchmark;
  std::vector<std::string> presets = {"paper", "fast", "quality"};
  std::vector<int> threads = {2};
  int repeats = 1;
};

struct Row {
  std::string mesh;
  std::size_t column = 0;  ///< of the table
  std::string preset;
  int threads = 0;
  std::array<double, 9> numbers{};  ///< the first of measure()
};
constexpr std::size_t kScore16 = 1, kScore17 = 3, kDistance = 4, kUncovered = 5, kSeconds = 6, kCpuSeconds = 8;

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
    const auto both = [&](std::size_t column, int digits) {
      std::vector<double> values;
      for (const Row& row : group) values.push_back(row.numbers[column]);
      return fmt::format("{:.{}f}, {:.{}f}", meanOf(values), digits, medianOf(values), digits);
    };
    fmt::print(
        "# {}: rows {}; mean, median of score16 {}; score17 {}; distance {} % of diagonal; uncovered {}; seconds {}; "
        "CPU "
        "seconds {}\n",
        name, group.size(), both(kScore16, 4), both(kScore17, 4), both(kDistance, 4), both(kUncovered, 5),
        both(kSeconds, 3), both(kCpuSeconds, 3));
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
      pairWith(paper->second, [&](const Row& row, const Row& other) {
        gains.push_back(row.numbers[kScore17] - other.numbers[kScore17]);
      });
      if (gains.empty()) continue;
      fmt::print("# {}: score17 at least that of paper on {} of {} rows, mean gain {:+.4f}\n", name,
                 std::count_if(gains.begin(), gains.end(), [](double gain) { return gain >= -1e-5; }), gains.size(),
                 meanOf(gains));
    }
    const auto single = groups.find({key.first, 1});
    if (key.second != 1 && single != groups.end()) {
      std::vector<double> speedups;
      pairWith(single->second, [&](const Row& row, const Row& other) {
        speedups.push_back(other.numbers[kSeconds] / row.numbers[kSeconds]);
      });
      if (speedups.empty()) continue;
      fmt::print("# {}: {:.2f} times as fast as one thread (median over the rows)\n", name, medianOf(speedups));
    }
  }
}

int run(const Options& options) {
  const Result<std::vector<BenchmarkMesh>> table = readBenchmark(options.benchmark);
  if (!table) return fail(table.error());

  fmt::print(
      "mesh,wanted,preset,threads,parts,score16,score16_se,score17,distance_percent,uncovered,seconds,"
      "min_seconds,cpu_seconds,peak_mib,hash,vertices,repaired,error\n");
  std::vector<Row> rows;
  int failed = 0;
  for (const BenchmarkMesh& wanted : *table) {
    const fs::path& file = wanted.file;
    if (file.empty()) {
      fmt::print(stderr, "{}: no such mesh in {}\n", wanted.name, options.benchmark.folder);
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
          Row& row = rows.emplace_back(Row{wanted.name, column, preset, threads, {}});
          std::istringstream fields(*measured);
          std::string field;
          for (double& number : row.numbers) {
            std::getline(fields, field, ',');
            number = std::stod(field);
          }
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
  lorica::bench::addBenchmark(app, options.benchmark);
  app.add_option("--preset", options.presets, "paper, fast, quality [default: all]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"paper", "fast", "quality"}));
  app.add_option("--threads", options.threads, "One or more numbers of threads [default: 2]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Range(1, 1024));
  app.add_option("--repeats", options.repeats, "Number of decompositions for median times")->check(CLI::Range(1, 1000));
  CLI11_PARSE(app, argc, argv);
  return lorica::bench::run(options);
}
