// An hour of simulated time with faults, thrown balls and changing scenes, or half an hour with avatars that come and
// go: costs and violations. CSV on standard output; exits with 1 if there are violations.

#include "collision/hulls/keyframes.h"
#include "collision/particles/particles.h"
#include "session/scenes/demo_scene.h"
#include "session/scenes/scene_file.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/bench/measure.h"
#include "tests/session/soak_run.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <numeric>

namespace lorica::bench {

using test::AvatarSoakResult;
using test::AvatarSoakSettings;
using test::SoakResult;
using test::SoakRow;
using test::SoakScene;
using test::SoakSettings;

namespace {

constexpr int kViolated = 1;

/// A bed of particles up to the shins: few enough that an hour takes minutes.
World makeBed(ParticleSettings::Kind kind) {
  ParticleSettings settings;
  settings.kind = kind;
  settings.radius = 0.02;
  settings.walls = Aabb{Vec3(-1.2, 0.0, -1.2), Vec3(1.2, 4.0, 1.2)};
  settings.fills.push_back({Vec3(0.0, 0.1, 0.0), Vec3(2.4, 0.2, 2.4), 4000});
  World world;
  LORICA_CHECK(world.setParticles(settings).ok(), "the settings are in range");
  return world;
}

/// The demo's world with any seed, beds of sand and water, and the scenes of a folder that have only props.
Result<std::vector<SoakScene>> scenesIn(const std::filesystem::path& folder) {
  std::vector<SoakScene> scenes = {{"demo", makeDemoWorld}};
  for (const char* name : {"boxes", "bowling", "curtain"}) {
    Result<SceneFile> read = readScene(folder / fmt::format("{}.json", name));
    if (!read) return read.error();
    const auto file = std::make_shared<const SceneFile>(std::move(*read));
    scenes.push_back({name, [file](std::uint64_t) { return makeWorld(*file).value(); }});
  }
  scenes.push_back({"sand", [](std::uint64_t) { return makeBed(ParticleSettings::Kind::kSand); }});
  scenes.push_back({"water", [](std::uint64_t) { return makeBed(ParticleSettings::Kind::kWater); }});
  return scenes;
}

/// 16 parts of the mannequin, from its bind pose.
Result<Decomposition> sixteenParts() {
  const Character character = makeMannequin();
  DecomposeSettings settings;
  settings.maxParts = 16;
  return decompose(character.mesh, {character.mesh.vertices, static_cast<int>(character.mesh.vertices.size())},
                   settings);
}

void printViolations(const std::vector<std::string>& violations) {
  for (const std::string& violation : violations) fmt::print("# violated: {}\n", violation);
  if (violations.empty()) fmt::print("# no violations\n");
}

void print(const AvatarSoakResult& result, const AvatarSoakSettings& settings) {
  fmt::print("avatars,seconds,frames,cpu_ms_per_frame,mean_there,entries,exits,prop_contacts,avatar_contacts,events\n");
  fmt::print("{},{:.0f},{},{:.2f},{:.2f},{},{},{},{},{}\n", settings.places, result.seconds, result.frames,
             1e3 * result.cpuSeconds / static_cast<double>(std::max(1L, result.frames)), result.meanThere,
             result.entries, result.exits, result.contacts, result.meetings, result.events);
  fmt::print("# memory {:.1f} MiB in the first third after {:.0f} s, {:.1f} MiB in the last third, peak {:.1f} MiB\n",
             result.firstMemory, settings.warmUp, result.lastMemory, result.peakMemory);
  printViolations(result.violations);
}

void print(const SoakResult& result, const SoakSettings& settings) {
  fmt::print("scene,frames,median_ms,p99_ms,worst_ms,most_props,contacts,lowest_m,fastest_m_per_s\n");
  double cpu = 0.0;
  for (const SoakRow& row : result.rows) {
    cpu += std::accumulate(row.frameSeconds.begin(), row.frameSeconds.end(), 0.0);
    fmt::print("{},{},{:.2f},{:.2f},{:.2f},{},{},{:.3f},{:.1f}\n", row.scene, row.frameSeconds.size(),
               1e3 * atRank(row.frameSeconds, 0.5), 1e3 * atRank(row.frameSeconds, 0.99),
               1e3 * atRank(row.frameSeconds, 1.0), row.maxProps, row.contacts, row.lowest, row.fastest);
  }
  fmt::print("# {:.0f} s simulated in {:.0f} s of CPU time: {} frames, {} with faults, {} balls, {} grabs, {} scenes\n",
             result.seconds, cpu, result.frames, result.faultyFrames, result.balls, result.grabs, result.worlds);
  fmt::print("# memory {:.1f} MiB in the first third after {:.0f} s, {:.1f} MiB in the last third, peak {:.1f} MiB\n",
             result.firstMemory, settings.warmUp, result.lastMemory, result.maxMemory);
  fmt::print("# budget {:.1f} ms of CPU time per frame, maximum {:g} times that\n", 1e3 * settings.budget,
             settings.factor);
  printViolations(result.violations);
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  namespace bench = lorica::bench;
  CLI::App app("Soak test: an hour of faults, thrown balls and changing scenes.", "soak");
  bench::SoakSettings settings;
  std::string folder = "scenes";
  bench::AvatarSoakSettings comings;
  bool avatars = false;
  app.add_flag("--avatars", avatars, "Avatars that come and go instead, for half an hour");
  CLI::Option* seconds =
      app.add_option("--seconds", settings.seconds, "Simulated time [s]")->check(CLI::PositiveNumber);
  app.add_option("--seed", settings.seed, "Random seed of faults, balls and scenes");
  app.add_option("--factor", settings.factor, "Maximum CPU time of a frame as a multiple of 1/60 s")
      ->check(CLI::PositiveNumber);
  app.add_option("--scenes", folder, "Folder of the shipped scenes");
  CLI11_PARSE(app, argc, argv);
  const lorica::Result<lorica::Decomposition> parts = bench::sixteenParts();
  if (!parts) return bench::fail(parts.error());
  if (avatars) {
    comings.seed = settings.seed;
    if (seconds->count() > 0) comings.seconds = settings.seconds;
    const bench::AvatarSoakResult result = lorica::test::soakAvatars(*parts, comings);
    bench::print(result, comings);
    return result.violations.empty() ? 0 : bench::kViolated;
  }
  const lorica::Result<std::vector<bench::SoakScene>> scenes = bench::scenesIn(folder);
  if (!scenes) return bench::fail(scenes.error());
  const bench::SoakResult result = lorica::test::soak(*parts, *scenes, settings);
  bench::print(result, settings);
  return result.violations.empty() ? 0 : bench::kViolated;
}
