#include "apps/bake_options.h"

#include "apps/memory_limit.h"
#include "apps/options.h"

#include <fmt/format.h>
#include <unistd.h>

#include <charconv>
#include <optional>
#include <utility>

namespace lorica {
namespace {

/// "2/10" as the second of ten.
std::optional<Shard> shardIn(const std::string& text) {
  Shard shard;
  const char* end = text.data() + text.size();
  const auto [slash, error] = std::from_chars(text.data(), end, shard.index);
  if (error != std::errc() || slash == end || *slash != '/') return std::nullopt;
  const auto [stopped, countError] = std::from_chars(slash + 1, end, shard.count);
  const bool whole = countError == std::errc() && stopped == end;
  if (!whole || shard.count < 1 || shard.index < 1 || shard.index > shard.count) return std::nullopt;
  return shard;
}

}  // namespace

Result<BakeSettings> BakeOptions::defaults() const {
  BakeSettings settings;
  const std::pair<const char*, std::string> given[] = {
      {"parts", parts},
      {"max-error", maxError},
      {"max-distance", maxDistance},
      {"max-concavity", maxConcavity},
      {"exact", exact ? "yes" : ""},
      {"preset", preset},
      {"cover", cover},
      {"hull-vertices", hullVertices},
      {"body", body},
      {"walls", walls},
      {"thickness", thickness},
      {"engine", engine},
      {"motion", fmt::format("{}", fmt::join(motions, ";"))},
      {"export", fmt::format("{}", fmt::join(exports, ";"))},
  };
  for (const auto& [name, value] : given) {
    if (value.empty()) continue;
    if (Result<void> set = setBakeSetting(settings, name, value, ""); !set) {
      return Error{set.error().code, "--" + set.error().message};
    }
  }
  return settings;
}

Shard BakeOptions::chosenShard() const {
  return shardIn(shard).value_or(Shard());
}

std::uint64_t BakeOptions::memoryBytes() const {
  if (const std::optional<std::uint64_t> given = bytesIn(memory)) return *given;
  return static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) * ::sysconf(_SC_PAGESIZE);
}

void addBakeOptions(CommandLine& app, BakeOptions& options) {
  app.addOption("LIST", options.lists,
                "Meshes, characters, folders, patterns in quotes, or lists of them: a path on each line, .csv with the "
                "column `input`, .jsonl with \"input\"; other columns are settings, such as `parts`")
      ->required();
  app.addOption("--out", options.out, "Folder of the results; several processes may share it", "DIR")->required();
  const auto add = [&app](const char* name, std::string& value, const char* description, const char* type) {
    app.addOption(name, value, description, type);
  };
  add("--parts", options.parts, "Maximum number of parts of each item, as for `lorica decompose`", "N");
  add("--max-error", options.maxError, "Stop when the hulls have at most this much extra volume", "E");
  add("--max-concavity", options.maxConcavity,
      "Stop when no part is more concave than this, as CoACD measures it [default: 0.05 for meshes without another "
      "limit]",
      "C");
  add("--max-distance", options.maxDistance, "Stop when no point of the hulls is farther from the surface", "METRES");
  app.addFlag("--exact", options.exact, "Cut until every part is convex: can take thousands of parts");
  add("--preset", options.preset, "paper, fast or quality [default: fast]", "NAME");
  add("--cover", options.cover, "Hull cover of characters: exact, or a tolerance [default: exact]", "exact|METRES");
  add("--hull-vertices", options.hullVertices, "Hulls of at most N vertices", "N");
  add("--walls", options.walls, "Open surfaces: auto, solid or shell [default: auto; of a character solid]", "WHAT");
  add("--thickness", options.thickness, "Thickness of thin walls, in the mesh's unit", "LENGTH");
  add("--body", options.body, "Closed bodies: auto, never or always [default: auto]", "WHEN");
  app.addOption("--motion", options.motions, "Train characters on this motion; may be repeated", "FILE")->repeatable();
  app.addOption("--export", options.exports,
                "Also write hulls with these endings, separated by commas: obj, stl, ply, xml, urdf, glb, vrm",
                "ENDING,...")
      ->separatedBy(',');
  add("--engine", options.engine, "Engine of the exports, which limits the vertices of hulls", "NAME");
  app.addOption("--shard", options.shard,
                "Do the I-th of N shares of the list, which are chosen by content [default: all]", "I/N")
      ->check([](std::string& text) -> std::string {
        return shardIn(text) ? "" : fmt::format("found `{}`, expected I/N with I from 1 to N, such as 2/10", text);
      });
  addCount(app, "--jobs", options.jobs, 1, "Items at a time, which share the threads [default: one for each thread]");
  app.addOption("--memory", options.memory, "Memory for all items at a time [default: what the machine has]", "SIZE")
      ->check(memorySize());
  addSeconds(app, "--timeout", options.timeout, "Give an item up after this time [default: 3600]");
  addSeconds(app, "--lost-after", options.lostAfter,
             "Take over the items of a process on another machine that says nothing for so long [default: 120]");
  app.addFlag("--retry-failed", options.retryFailed, "Do items again that have failed");
  app.addFlag("--collect", options.collect,
              "Do nothing; check every file, and write DIR/bake.jsonl and DIR/report.html with pictures");
}

}  // namespace lorica
