// Whether the decomposition depends on how a mesh lies. Input: a folder of meshes and a table of part counts. Output:
// one CSV row for each mesh, count and preset, with the score (Eq. 17) as shipped and over random rotations; then means
// on lines that start with #. With --up-to it tries every count, and tells where more parts score less than fewer.

#include "acd/transfer.h"
#include "bench/benchmark_table.h"
#include "bench/measure.h"
#include "geometry/random_numbers.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <map>
#include <numeric>

namespace lorica::bench {
namespace {

struct Options {
  std::string folder;
  std::string table;
  std::vector<std::string> presets = {"fast", "quality"};
  std::vector<std::string> only;
  int rotations = 8;
  int upTo = 0;  // 0 = the counts of the table
};

/// A rotation from a uniform distribution; number 0 is the identity.
Mat3 rotationNumber(int number) {
  if (number == 0) return Mat3::Identity();
  RandomNumbers random(static_cast<std::uint64_t>(number));
  while (true) {
    Eigen::Vector4d q;
    for (double& x : q) x = random.between(-1.0, 1.0);
    const double length = q.norm();
    if (length > 1.0 || length < 0.1) continue;
    return Eigen::Quaterniond(q / length).toRotationMatrix();
  }
}

struct Judged {
  double score = 0.0;
  double cpuSeconds = 0.0;
};

Result<Judged> judge(TriMesh mesh, int parts, DecomposePreset preset, int rotation) {
  const Mat3 turn = rotationNumber(rotation);
  for (Vec3& v : mesh.vertices) v = turn * v;
  DecomposeSettings settings;
  settings.maxParts = parts;
  settings.preset = preset;
  settings.threads = 1;
  const PoseView pose{mesh.vertices, static_cast<int>(mesh.vertices.size())};
  const Result<Timed> made = timeDecompose(mesh, pose, settings, 1);
  if (!made) return made.error();
  std::vector<Vec3> points(static_cast<std::size_t>(made->decomposition.pointCount()));
  transfer(made->decomposition, mesh.vertices, points);
  double hullVolume = 0.0;
  for (const ConvexHull& hull : partHulls(made->decomposition, points)) hullVolume += hull.volume;
  return Judged{signedVolume(mesh.vertices, mesh.triangles) / hullVolume, made->cpuSeconds};
}

struct Row {
  double shipped = 0.0, median = 0.0, worst = 0.0, best = 0.0, cpuSeconds = 0.0;
};

Result<Row> judgeAll(const TriMesh& mesh, int parts, DecomposePreset preset, int rotations) {
  Row row;
  std::vector<double> scores, seconds;
  for (int i = 0; i <= rotations; ++i) {
    const Result<Judged> judged = judge(mesh, parts, preset, i);
    if (!judged) return judged.error();
    seconds.push_back(judged->cpuSeconds);
    (i == 0 ? row.shipped : scores.emplace_back()) = judged->score;
  }
  row.cpuSeconds = medianOf(seconds);
  if (scores.empty()) scores.push_back(row.shipped);
  row.median = medianOf(scores);
  row.worst = std::ranges::min(scores);
  row.best = std::ranges::max(scores);
  return row;
}

void summarize(const std::string& name, const std::vector<Row>& rows) {
  const auto column = [&](double Row::*member) {
    std::vector<double> values;
    for (const Row& row : rows) values.push_back(row.*member);
    return values;
  };
  std::vector<double> spreads;
  for (const Row& row : rows) spreads.push_back(row.best - row.worst);
  fmt::print(
      "# {}: rows {}; mean of shipped {:.4f}, median {:.4f}, worst {:.4f}; spread median {:.4f}, largest {:.4f};"
      " CPU seconds median {:.3f}, sum {:.1f}\n",
      name, rows.size(), meanOf(column(&Row::shipped)), meanOf(column(&Row::median)), meanOf(column(&Row::worst)),
      medianOf(spreads), std::ranges::max(spreads), medianOf(column(&Row::cpuSeconds)),
      meanOf(column(&Row::cpuSeconds)) * static_cast<double>(rows.size()));
}

// Smaller differences between scores do not count.
constexpr double kSame = 0.002;

/// How often, and by how much at most, a score is less than one that it should at least reach.
struct Falls {
  int pairs = 0, falls = 0;
  double deepest = 0.0;

  void compare(double score, double least) {
    ++pairs;
    if (score < least - kSame) ++falls;
    deepest = std::max(deepest, least - score);
  }
  void print(const std::string& what) const {
    fmt::print("# {}: {} of {} by more than {:g}; largest fall {:.4f}\n", what, falls, pairs, kSame, deepest);
  }
};

std::vector<int> countsOf(const BenchmarkMesh& entry, const Options& options) {
  if (options.upTo == 0) return entry.counts;
  std::vector<int> counts(static_cast<std::size_t>(options.upTo));
  std::iota(counts.begin(), counts.end(), 1);
  return counts;
}

int run(const Options& options) {
  Result<std::vector<BenchmarkMesh>> table = readBenchmark(options.folder, options.table, options.only);
  if (!table) return fail(table.error());
  fmt::print("mesh,parts,preset,shipped,median,worst,best,cpu_seconds\n");
  std::map<std::string, std::vector<Row>> rows;
  std::map<std::string, Falls> moreParts;
  Falls moreWork;
  for (const BenchmarkMesh& entry : *table) {
    if (entry.file.empty()) {
      return fail({ErrorCode::kNotFound, fmt::format("{}: no such mesh in {}", entry.name, options.folder)});
    }
    const Result<TriMesh> mesh = readRepaired(entry.file);
    if (!mesh) return fail(mesh.error());
    std::map<std::string, double> fewer;  // median with one part less
    for (const int parts : countsOf(entry, options)) {
      std::map<std::string, double> medians;
      for (const std::string& preset : options.presets) {
        const Result<Row> row = judgeAll(*mesh, parts, presetOf(preset), options.rotations);
        if (!row) return fail(row.error());
        fmt::print("{},{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.3f}\n", entry.name, parts, preset, row->shipped,
                   row->median, row->worst, row->best, row->cpuSeconds);
        std::fflush(stdout);
        rows[preset].push_back(*row);
        medians[preset] = row->median;
        if (options.upTo > 0 && parts > 1) moreParts[preset].compare(row->median, fewer[preset]);
      }
      if (medians.contains("fast") && medians.contains("quality")) {
        moreWork.compare(medians["quality"], medians["fast"]);
      }
      fewer = medians;
    }
  }
  for (const auto& [preset, falls] : moreParts) falls.print(preset + " with one part more");
  if (moreWork.pairs > 0) moreWork.print("quality against fast");
  for (const auto& [preset, some] : rows) summarize(preset, some);
  return 0;
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  lorica::bench::Options options;
  CLI::App app("Decomposes meshes as they are and randomly rotated, at one thread: CSV on standard output.");
  app.add_option("FOLDER", options.folder, "Meshes (.off, .obj, .ply, .stl)")
      ->required()
      ->check(CLI::ExistingDirectory);
  app.add_option("TABLE", options.table, "CSV: mesh name, then part counts; see vhacd_counts.csv")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("--preset", options.presets, "paper, fast, quality [default: fast,quality]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"paper", "fast", "quality"}));
  app.add_option("--only", options.only, "Only these meshes of the table, separated by commas")
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--rotations", options.rotations, "Number of random rotations [default: 8]")
      ->check(CLI::Range(0, 1000));
  app.add_option("--up-to", options.upTo, "Every part count from 1 to this, in place of those of the table")
      ->check(CLI::Range(1, 1000));
  CLI11_PARSE(app, argc, argv);
  return lorica::bench::run(options);
}
