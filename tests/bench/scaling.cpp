// Scaling of the decomposition time with vertices, parts, keyframes and threads: CSV on standard output, with the
// fitted exponents on lines that start with #.

#include "collision/hulls/keyframes.h"
#include "geometry/files.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/bench/measure.h"
#include "tests/bench/walker.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cmath>
#include <numbers>
#include <sstream>
#include <thread>

namespace lorica::bench {
namespace {

struct Options {
  std::string preset = "fast";
  int threads = 2;
  int repeats = 1;
  int maxVertices = 30000;
  int maxParts = 32;
  int maxKeyframes = 10;
  int maxThreads = 0;  // 0 = as many as the machine has
  bool full = false;
};

/// A torus with bumps; the shape does not depend on the number of vertices.
TriMesh bumpyTorus(int vertexCount) {
  const int minor = std::max(8, static_cast<int>(std::lround(std::sqrt(vertexCount / 2.5))));
  const int major = std::max(12, vertexCount / minor);
  TriMesh mesh;
  for (int i = 0; i < major; ++i) {
    const double u = 2.0 * std::numbers::pi * i / major;
    for (int j = 0; j < minor; ++j) {
      const double v = 2.0 * std::numbers::pi * j / minor;
      const double tube = 0.4 + 0.08 * std::sin(7.0 * u) * std::cos(3.0 * v + 2.0 * u);
      const double r = 1.0 + tube * std::cos(v);
      mesh.vertices.emplace_back(r * std::cos(u), tube * std::sin(v) + 0.15 * std::sin(3.0 * u), r * std::sin(u));
    }
  }
  const auto at = [&](int i, int j) { return (i % major) * minor + j % minor; };
  for (int i = 0; i < major; ++i) {
    for (int j = 0; j < minor; ++j) {
      mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
    }
  }
  return mesh;
}

/// 1, 2, 5, 10, ... or 1, 2, 4, 8, ... from `first` to `last`, which is always included.
std::vector<int> steps(int first, int last, bool decimal) {
  std::vector<int> values;
  for (int v = first, turn = 0; v < last; ++turn) {
    values.push_back(v);
    v = !decimal ? 2 * v : turn % 3 == 1 ? v / 2 * 5 : 2 * v;
  }
  values.push_back(last);
  return values;
}

/// Parameters of one point of a sweep.
struct Point {
  int vertices = 20000;
  int parts = 16;
  int keyframes = 0;  ///< 0 = the torus, otherwise the character in this number of poses
  int threads = 2;
};

Result<std::string> measure(const Point& point, const Options& options) {
  DecomposeSettings settings;
  settings.maxParts = point.parts;
  settings.preset = presetOf(options.preset);
  settings.threads = point.threads;
  TriMesh mesh;
  std::vector<Vec3> positions;
  if (point.keyframes == 0) {
    mesh = bumpyTorus(point.vertices);
    positions = mesh.vertices;
  } else {
    const Character character = makeMannequin();
    Result<std::vector<Vec3>> sampled = sampleKeyframes(character, syntheticMotions(character), point.keyframes);
    if (!sampled) return sampled.error();
    mesh = character.mesh;
    positions = std::move(*sampled);
  }
  const Result<Timed> made =
      timeDecompose(mesh, {positions, static_cast<int>(mesh.vertices.size())}, settings, options.repeats);
  if (!made) return made.error();
  return fmt::format("{:.4f},{:.4f},{:.4f},{},{},{:.1f},{}", made->minSeconds, made->seconds, made->cpuSeconds,
                     mesh.vertices.size(), made->decomposition.parts.size(), peakMemoryMiB(),
                     hexDigits(hashOf(made->decomposition)));
}

/// Measures a point for each value and fits the exponent to those that succeeded.
void sweep(const std::string& name, const std::vector<int>& values, int Point::*member, const Options& options) {
  std::vector<double> x, y, cpu;
  for (const int value : values) {
    Point point;
    point.threads = options.threads;
    if (member == &Point::keyframes) point.parts = 8;
    point.*member = value;
    fmt::print(stderr, "{} {}\n", name, value);
    const Result<std::string> measured = inOwnProcess([&] { return measure(point, options); });
    if (!measured) {
      fmt::print(stderr, "{} {}: {}\n", name, value, measured.error().message);
      continue;
    }
    fmt::print("{},{},{}\n", name, value, *measured);
    std::fflush(stdout);
    std::istringstream fields(*measured);
    std::string min, median, processor;
    std::getline(fields, min, ',');
    std::getline(fields, median, ',');
    std::getline(fields, processor, ',');
    if (member == &Point::parts && value == 1) continue;  // no cuts
    x.push_back(value);
    y.push_back(std::stod(min));
    cpu.push_back(std::stod(processor));
  }
  if (x.size() < 2) return;
  fmt::print("# {}: seconds scale with the power {:.2f}, CPU seconds {:.2f}\n", name, fittedExponent(x, y),
             fittedExponent(x, cpu));
}

int run(Options options) {
  if (options.full) {
    options.maxVertices = 1000000;
    options.maxParts = 256;
    options.maxKeyframes = 100;
  }
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  fmt::print("sweep,value,min_seconds,seconds,cpu_seconds,vertices,parts,peak_mib,hash\n");
  sweep("vertices", steps(1000, options.maxVertices, true), &Point::vertices, options);
  sweep("parts", steps(1, options.maxParts, false), &Point::parts, options);
  sweep("keyframes", steps(1, options.maxKeyframes, true), &Point::keyframes, options);
  sweep("threads", steps(1, options.maxThreads > 0 ? options.maxThreads : cores, false), &Point::threads, options);
  return 0;
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  lorica::bench::Options options;
  CLI::App app("Measures decompositions of increasing size; a quick run by default.");
  app.add_option("--preset", options.preset, "paper, fast or quality [default: fast]")
      ->check(CLI::IsMember({"paper", "fast", "quality"}));
  app.add_option("--max-vertices", options.maxVertices, "From 1,000 to this [default: 30,000]")
      ->check(CLI::Range(1000, 10000000));
  app.add_option("--max-parts", options.maxParts, "From 1 to this [default: 32]")->check(CLI::Range(1, 10000));
  app.add_option("--max-keyframes", options.maxKeyframes, "From 1 to this [default: 10]")->check(CLI::Range(1, 1000));
  app.add_option("--max-threads", options.maxThreads, "From 1 to this [default: as many as the machine has]")
      ->check(CLI::Range(1, 1024));
  app.add_option("--threads", options.threads, "Threads of the other sweeps [default: 2]")->check(CLI::Range(1, 1024));
  app.add_option("--repeats", options.repeats, "Repeats of each point; the minimum counts [default: 1]")
      ->check(CLI::Range(1, 1000));
  app.add_flag("--full", options.full, "Up to 1,000,000 vertices, 256 parts and 100 keyframes: takes hours");
  CLI11_PARSE(app, argc, argv);
  return lorica::bench::run(options);
}
