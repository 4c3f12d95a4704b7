#include "apps/interrupt.h"
#include "apps/memory_limit.h"
#include "apps/option_groups.h"
#include "apps/options.h"
#include "export/bake/bake_job.h"
#include "export/bake/bake_report.h"
#include "export/bake/baker.h"
#include "export/bake/child_process.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/hard_stop.h"
#include "geometry/mesh_files.h"
#include "geometry/text.h"
#include "skinning/import/character_file.h"
#include "viewer/pictures/image_files.h"
#include "viewer/player/parts_picture.h"
#include "viewer/player/snapshots.h"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lorica {
namespace {

/// Options of `lorica bake`.
struct BakeOptions {
  std::vector<std::string> lists;
  std::string out;
  Shard shard;
  int jobs = 0;             ///< 0 = one for each thread
  std::string memory;       ///< "8G"; empty = what the machine has
  double timeout = 3600.0;  ///< of an item [s]
  bool retryFailed = false;
  bool collect = false;
  bool exact = false;
  BakeSettings defaults;  ///< of items whose list does not say otherwise

  /// Memory for all items at a time [bytes].
  [[nodiscard]] std::uint64_t memoryBytes() const;
};

/// "2/10" as the second of ten.
std::optional<Shard> shardIn(const std::string& text) {
  Shard shard;
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos || !parseWhole(text.substr(0, slash), shard.index)) return std::nullopt;
  const bool whole = parseWhole(text.substr(slash + 1), shard.count);
  if (!whole || shard.count < 1 || shard.index < 1 || shard.index > shard.count) return std::nullopt;
  return shard;
}

std::uint64_t BakeOptions::memoryBytes() const {
  if (const std::optional<std::uint64_t> given = bytesIn(memory)) return *given;
  return static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) * ::sysconf(_SC_PAGESIZE);
}

void addBakeOptions(CLI::App& app, BakeOptions& options) {
  app.add_option("LIST", options.lists,
                 "Meshes, characters, folders, patterns in quotes, or lists of them: a path on each line, .csv with "
                 "the column `input`, .jsonl with \"input\"; other columns are settings, such as `parts`")
      ->required();
  addOption(app, "--out", options.out, "DIR", "Folder of the results; several processes may share it")->required();
  // The usual ones of `lorica decompose` and `lorica export`, checked as in a list.
  const auto add = [&](const std::string& name, const char* description, const char* type) {
    const auto read = [&options, name](const std::string& text) -> std::string {
      const Result<std::vector<std::string>> values = bakeSetting(name, text, "");
      if (!values) return values.error().message.substr(name.size() + 2);  // behind "parts: "
      std::vector<std::string>& all = options.defaults[name];
      all.insert(all.end(), values->begin(), values->end());
      return "";
    };
    return addReader(app, "--" + name, read, type, description);
  };
  add("parts", "Maximum number of parts of each item, as for `lorica decompose`", "N");
  add("max-error", "Stop when the hulls have at most this much extra volume", "E");
  add("max-concavity",
      "Stop when no part is more concave than this, as CoACD measures it [default: 0.05 for meshes without another "
      "limit]",
      "C");
  add("max-distance", "Stop when no point of the hulls is farther from the surface", "METRES");
  app.add_flag("--exact", options.exact, "Cut until every part is convex: can take thousands of parts");
  add("preset", "paper, fast or quality [default: fast]", "NAME");
  add("cover", "Hull cover of characters: exact, or a tolerance [default: exact]", "exact|METRES");
  add("hull-vertices", "Hulls of at most N vertices", "N");
  add("walls", "Open surfaces: auto, solid or shell [default: auto; of a character solid, unless all of it is sheets]",
      "WHAT");
  add("thickness", "Thickness of thin walls, in the mesh's unit", "LENGTH");
  add("body", "Closed bodies: auto, never or always [default: auto]", "WHEN");
  add("motion", "Train characters on this motion; may be repeated", "FILE")->expected(1)->take_all();
  add("export", "Also write hulls with these endings, separated by commas: obj, stl, ply, xml, urdf, glb, vrm",
      "ENDINGS")
      ->delimiter(',')
      ->expected(1, CLI::detail::expected_max_vector_size);
  add("engine", "Engine of the exports, which limits the vertices of hulls", "NAME")->transform(anEngine());
  const auto readShard = [&options](const std::string& text) -> std::string {
    const std::optional<Shard> shard = shardIn(text);
    options.shard = shard.value_or(Shard());
    return shard ? "" : fmt::format("found `{}`, expected I/N with I from 1 to N, such as 2/10", text);
  };
  addReader(app, "--shard", readShard, "I/N",
            "Do the I-th of N shares of the list, which are chosen by content [default: all]");
  addCount(app, "--jobs", options.jobs, 1, "Items at a time, which share the threads [default: one for each thread]");
  addOption(app, "--memory", options.memory, "SIZE", "Memory for all items at a time [default: what the machine has]")
      ->transform(memorySize());
  addSeconds(app, "--timeout", options.timeout, "Give an item up after this time [default: 3600]");
  app.add_flag("--retry-failed", options.retryFailed, "Do items again that have failed");
  app.add_flag("--collect", options.collect,
               "Do nothing; check every file, and write DIR/bake.jsonl and DIR/report.html with pictures");
}

namespace fs = std::filesystem;

constexpr int kWidth = 400, kHeight = 300;  // of a picture [pixels]

/// The hulls of an item in the pose of the file, each part in its colour, as the bytes of a PNG; empty if they cannot
/// be had.
/// @param lorica   the item's decomposition
/// @param scratch  folder for temporary files, which exists
std::string pictureOf(const BakeItem& item, const fs::path& lorica, const fs::path& scratch, const ItemSettings& how,
                      SnapshotCamera& camera) {
  const fs::path hulls = scratch / "hulls.obj", png = scratch / "hulls.png";
  const ProcessOrder order{
      how.program, exportArguments(item, lorica, hulls, how), {{"XDG_CACHE_HOME", scratch}}, scratch / "log", 0};
  const Result<ProcessEnd> end = runProgram(order, [] { return !interrupted(); });
  if (!end || end->exitStatus != 0 || end->signal != 0) return "";
  const Result<std::vector<NamedMesh>> objects = readObjObjects(hulls);
  if (!objects) return "";
  const UpAxis up = isCharacterFile(item.input) ? UpAxis::kY : likelyUp(*objects);
  if (!writePng(png, drawParts(*objects, up, camera))) return "";
  const Result<std::string> bytes = readFile(png, NamedBy::kFile);
  return bytes ? *bytes : "";
}

constexpr std::size_t kFewFailures = 5;  // that are told at the end of a bake

std::string megabytes(std::uint64_t bytes) {
  return grouped((bytes + 999'999) / 1'000'000) + " MB";
}

ItemSettings howToRun(const BakeOptions& options, const CommonOptions& common, int jobs) {
  std::error_code ignored;
  return {fs::read_symlink("/proc/self/exe", ignored), std::max(1, common.threadCount() / jobs), options.timeout,
          common.trustPaths};
}

/// The jobs of the shard; or why a list or a setting is refused.
Result<std::vector<BakeJob>> readJobs(const BakeOptions& options) {
  BakeSettings defaults = options.defaults;
  if (options.exact) defaults["exact"] = {"yes"};
  LORICA_TRY(const std::vector<BakeItem> items, readBakeLists(options.lists, defaults));
  return jobsOf(options.shard, bakeJobs(items));
}

Error notWhole(const BakeCollection& collection, std::size_t jobs) {
  if (!collection.damaged.empty()) {
    return badFormat("{}; `lorica bake` without --collect makes it again", collection.damaged[0]);
  }
  return notFound("of {} not done yet: {}; `lorica bake` without --collect does the rest", counted(jobs, "item"),
                  collection.missing.size());
}

/// Why items failed. @param most  of them
void addFailures(const BakeCollection& collection, std::size_t most, Report& report) {
  const auto failed = collection.failed();
  if (failed.empty()) return;
  Table table{{"failed because"}, {}, 0};
  for (const Json* result : failed) table.rows.push_back({result->value("failure", "")});
  if (failed.size() > most) {
    table.rows.resize(most);
    table.rows.push_back({fmt::format("and {} more, see bake.jsonl", failed.size() - most)});
  }
  report.table(std::move(table));
}

Report collectionReport(const BakeCollection& collection, std::size_t jobs, const fs::path& out) {
  const auto some = [](const auto& list) { return list.empty() ? "" : grouped(std::ssize(list)); };
  Report report(fmt::format("{} in {}", counted(jobs, "item"), out.string()));
  report.add("items", jobs);
  report.add("baked", "baked", collection.worstFirst().size());
  Json failures = Json::array();
  for (const Json* result : collection.failed()) failures.push_back(result->value("failure", ""));
  report.add("failures", "failed", failures, grouped(std::ssize(failures)));
  report.add("missing", "not done yet", collection.missing, some(collection.missing));
  report.add("damaged", "damaged", collection.damaged, some(collection.damaged));
  report.add("hash", "hash", collection.hash());
  report.line("written", fmt::format("{}, {}", (out / "bake.jsonl").string(), (out / "report.html").string()));
  addFailures(collection, failures.size(), report);
  return report;
}

/// --collect: merges, checks and reports.
Result<void> collectAll(const BakeOptions& options, const CommonOptions& common, const std::vector<BakeJob>& jobs,
                        const BakeStore& store) {
  const fs::path out = options.out;
  const BakeCollection collection = collect(jobs, store, true);
  if (collection.missing.size() == jobs.size()) {
    return notFound("{}: nothing is baked there as asked; --collect takes the lists and settings of the bake",
                    options.out);
  }
  std::map<std::string, const BakeJob*> byName;
  for (const BakeJob& job : jobs) byName[job.name] = &job;
  Result<SnapshotCamera> camera = SnapshotCamera::create(kWidth, kHeight);
  if (!camera) warn("the report has no pictures: " + camera.error().message);
  LORICA_TRY(const fs::path scratch, store.begin());
  const auto clean = [scratch] {
    std::error_code ignored;
    fs::remove_all(scratch, ignored);
  };
  const AtHardStop cleaning(clean);
  const auto draw = [&](const Json& result) -> std::string {
    const auto found = byName.find(result.value("item", ""));
    if (!camera || found == byName.end() || interrupted()) return "";
    const auto& [name, job] = *found;
    return pictureOf(job->item, store.folderOf(name) / (job->stem + ".lorica"), scratch, howToRun(options, common, 1),
                     *camera);
  };
  const std::string page = htmlReport(collection, draw);
  clean();
  if (interrupted()) return cancelled();
  LORICA_TRY_DO(writeFileAtomically(out / "bake.jsonl", jsonLines(collection), NamedBy::kLorica));
  LORICA_TRY_DO(writeFileAtomically(out / "report.html", page, NamedBy::kLorica));
  linkResults(collection, jobs, out);
  const Result<void> published = publish(common, collectionReport(collection, jobs.size(), out));
  if (!published || (collection.missing.empty() && collection.damaged.empty())) return published;
  return notWhole(collection, jobs.size());
}

Report bakeReport(const BakeOutcome& outcome, const BakeOptions& options) {
  const auto some = [](int count) { return count > 0 ? grouped(count) : ""; };
  const bool worked = outcome.made + outcome.failed > 0;
  Report report(
      fmt::format("{} of {} baked into {}", grouped(outcome.made), counted(outcome.items, "item"), options.out),
      "items made failed");
  report.add("items", outcome.items);
  report.add("made", outcome.made);
  report.add("there", "there already", outcome.there, some(outcome.there));
  report.add("byOthers", "by other processes", outcome.byOthers, some(outcome.byOthers));
  report.add("failed", "failed", outcome.failed, some(outcome.failed));
  report.add("tooLarge", outcome.tooLarge);
  report.add("seconds", "time", outcome.seconds,
             worked ? fmt::format("{:.1f} s, of processors {:.1f} s; longest item {:.1f} s", outcome.seconds,
                                  outcome.cpuSeconds, outcome.longest)
                    : "");
  report.add("cpuSeconds", outcome.cpuSeconds);
  report.add("longestItem", outcome.longest);
  report.add("peakMemory", "memory", outcome.peakMemory,
             worked ? fmt::format("at most {} an item, of {} that it may take", megabytes(outcome.peakMemory),
                                  megabytes(outcome.memoryBound))
                    : "");
  report.add("memoryBound", outcome.memoryBound);
  return report;
}

BakerSettings bakerSettings(const BakeOptions& options, const CommonOptions& common, Task& bar) {
  BakerSettings settings;
  settings.jobs = options.jobs > 0 ? options.jobs : common.threadCount();
  settings.item = howToRun(options, common, settings.jobs);
  settings.memory = options.memoryBytes();
  settings.retryFailed = options.retryFailed;
  settings.stopping = [said = false]() mutable {
    if (interrupted() && !said) {
      said = true;
      answerInterrupt();
      say("\nlorica: finishing the items in progress; Ctrl-C again drops them\n");
    }
    return interrupted();
  };
  settings.progress = [&bar](int done, int total, double share) { bar.update(done, total, share); };
  return settings;
}

Result<void> runBake(const BakeOptions& options, const CommonOptions& common, Host& host) {
  liftUsualLimit();
  LORICA_TRY_DO(checkOutputFolder(common, "--out", options.out));
  LORICA_TRY_DO(checkJsonOutput(common, {fs::path(options.out) / "bake.jsonl"}));
  LORICA_TRY(const std::vector<BakeJob> jobs, readJobs(options));
  const BakeStore store(options.out);
  if (options.collect) return collectAll(options, common, jobs, store);
  Result<BakeOutcome> outcome = Error{ErrorCode::kCancelled, ""};
  {
    Task bar(host, "Baking", "items");
    outcome = bakeAll(jobs, store, bakerSettings(options, common, bar));
  }
  if (!outcome) return outcome.error();
  if (outcome->stopped) return cancelled();

  Report report = bakeReport(*outcome, options);
  // One process of several that share the work cannot merge it.
  if (options.shard.count == 1) {
    const BakeCollection collection = collect(jobs, store, false);
    const fs::path merged = fs::path(options.out) / "bake.jsonl";
    LORICA_TRY_DO(writeFileAtomically(merged, jsonLines(collection), NamedBy::kLorica));
    linkResults(collection, jobs, options.out);
    addFailures(collection, kFewFailures, report);
  }
  LORICA_TRY_DO(publish(common, report));
  if (outcome->tooLarge.empty()) return {};
  return invalidArgument("{}; {} left out", outcome->tooLarge.front(), counted(std::ssize(outcome->tooLarge), "item"));
}

}  // namespace

Command addBake(CLI::App& parent, CommonOptions& common) {
  const auto options = std::make_shared<BakeOptions>();
  CLI::App* app = addSubcommand(
      parent, common, "bake",
      "Decompose and export a whole library of meshes and characters, on all cores or many machines.",
      "  lorica bake meshes/ --out baked --parts 16\n"
      "      every mesh and character of a folder; run it again to do only what is new or changed\n"
      "  lorica bake list.csv --out baked --export glb,urdf\n"
      "      a list with settings for each item: input,parts,motion,...\n"
      "  lorica bake list.csv --out baked --memory 8G --jobs 4\n"
      "      four items at a time, as far as 8 GB go\n"
      "  lorica bake list.csv --out baked --shard 3/50\n"
      "      a fiftieth of the list, for engines that run one command for each number\n"
      "  lorica bake list.csv --out baked --collect\n"
      "      check every file and write baked/bake.jsonl and baked/report.html\n"
      "\nThe results are baked/hero.lorica, baked/hero.glb and so on: links into baked/items/NAME-KEY/, folders that\n"
      "appear whole or not at all; KEY is a hash of the input's content, the settings and the algorithm. An input "
      "that\n"
      "cannot be baked, crashes or takes too much costs only its own item: its result is a sentence, and the exit\n"
      "status is 0. Ctrl-C finishes the items in progress, a second one drops them. Slurm and other engines: "
      "docs/BAKE.md.");
  addBakeOptions(*app, *options);
  return {app, [options](const CommonOptions& given, Host& host) { return runBake(*options, given, host); }};
}

}  // namespace lorica
