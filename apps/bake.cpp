#include "apps/command_line.h"
#include "apps/interrupt.h"
#include "apps/memory_limit.h"
#include "apps/options.h"
#include "bake/bake_job.h"
#include "bake/bake_report.h"
#include "bake/baker.h"
#include "bake/item_run.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/hard_stop.h"
#include "geometry/mesh_files.h"
#include "geometry/text.h"
#include "player/parts_picture.h"
#include "player/snapshots.h"
#include "viewer/pictures/image_files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace lorica {
namespace {

/// Options of `lorica bake`.
struct BakeOptions {
  std::vector<std::string> lists;
  std::string out;
  std::string shard = "1/1";
  int jobs = 0;              ///< 0 = one for each thread
  std::string memory;        ///< "8G"; empty = what the machine has
  double timeout = 3600.0;   ///< of an item [s]
  double lostAfter = 120.0;  ///< see Claims [s]
  bool retryFailed = false;
  bool collect = false;

  // The usual ones of `lorica decompose`.
  std::string parts, maxError, maxDistance, maxConcavity, preset, cover, hullVertices, body, walls, thickness, engine;
  std::vector<std::string> motions, exports;
  bool exact = false;

  /// The settings of items whose list does not say otherwise; or an error that names the option.
  [[nodiscard]] Result<BakeSettings> defaults() const;
  [[nodiscard]] Shard chosenShard() const;
  /// Memory for all items at a time [bytes].
  [[nodiscard]] std::uint64_t memoryBytes() const;
};

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

namespace fs = std::filesystem;

constexpr int kWidth = 400, kHeight = 300;  // of a picture [pixels]

/// Runs the program to its end. @return whether it succeeded; not if Ctrl-C came
bool runs(const ItemRunSettings& how, std::vector<std::string> arguments, const fs::path& scratch) {
  Result<ChildProcess> process =
      ChildProcess::start({how.program, std::move(arguments), {{"XDG_CACHE_HOME", scratch}}, scratch / "log", 0});
  std::optional<ProcessEnd> end;
  while (process && !interrupted() && !(end = process->ended())) {
    std::this_thread::sleep_for(std::chrono::milliseconds(4));
  }
  return end && end->exitStatus == 0 && end->signal == 0;
}

/// Pictures of an item's hulls, each part in its colour.
class BakePictures {
 public:
  /// @param how  the hulls are exported by processes of this program
  static Result<BakePictures> create(ItemRunSettings how) {
    LORICA_TRY(SnapshotCamera camera, SnapshotCamera::create(kWidth, kHeight));
    return BakePictures(std::move(how), std::move(camera));
  }

  /// The hulls in the pose of the file, as the bytes of a PNG; empty if they cannot be had.
  /// @param lorica   the item's decomposition
  /// @param scratch  folder for temporary files, which exists
  std::string draw(const BakeItem& item, const fs::path& lorica, const fs::path& scratch) {
    const fs::path hulls = scratch / "hulls.obj", png = scratch / "hulls.png";
    if (!runs(how_, exportArguments(item, lorica, hulls, how_), scratch)) return "";
    const Result<std::vector<NamedMesh>> objects = readObjObjects(hulls);
    if (!objects || !writePng(png, drawParts(*objects, camera_))) return "";
    const Result<std::string> bytes = readFile(png, NamedBy::kFile);
    return bytes ? *bytes : "";
  }

 private:
  BakePictures(ItemRunSettings how, SnapshotCamera camera) : how_(std::move(how)), camera_(std::move(camera)) {}
  ItemRunSettings how_;
  SnapshotCamera camera_;
};

using nlohmann::ordered_json;

constexpr std::size_t kFewFailures = 5;  // that are told at the end of a bake

std::string megabytes(std::uint64_t bytes) {
  return grouped((bytes + 999'999) / 1'000'000) + " MB";
}

void pause(std::chrono::milliseconds time) {
  std::this_thread::sleep_for(time);
}

ItemRunSettings howToRun(const BakeOptions& options, const CommonOptions& common, int jobs) {
  std::error_code ignored;
  return {fs::read_symlink("/proc/self/exe", ignored), std::max(1, common.threadCount() / jobs), options.timeout,
          common.trustPaths};
}

/// The jobs of the shard; or why a list or a setting is refused.
Result<std::vector<BakeJob>> readJobs(const BakeOptions& options) {
  LORICA_TRY(const BakeSettings defaults, options.defaults());
  LORICA_TRY(const std::vector<BakeItem> items, readBakeLists(options.lists, defaults));
  return jobsOf(options.chosenShard(), bakeJobs(items));
}

Error notWhole(const BakeCollection& collection, std::size_t jobs) {
  if (!collection.damaged.empty()) {
    return badFormat("{}; remove the folder to have it made again", collection.damaged[0]);
  }
  return notFound("of {} not done yet: {}; `lorica bake` without --collect does the rest", counted(jobs, "item"),
                  collection.missing.size());
}

/// Why items failed. @param most  of them
void addFailures(const BakeCollection& collection, std::size_t most, Report& report) {
  const auto failed = collection.failed();
  if (failed.empty()) return;
  Table table{{"failed because"}, {}, 0};
  for (const ordered_json* result : failed) table.rows.push_back({result->value("failure", "")});
  if (failed.size() > most) {
    table.rows.resize(most);
    table.rows.push_back({fmt::format("and {} more, see bake.jsonl", failed.size() - most)});
  }
  report.table(std::move(table));
}

Report collectionReport(const BakeCollection& collection, std::size_t jobs, const fs::path& out) {
  Report report(fmt::format("{} in {}", counted(jobs, "item"), out.string()));
  report.line("baked", grouped(std::ssize(collection.worstFirst())));
  report.line("failed", grouped(std::ssize(collection.failed())));
  if (!collection.missing.empty()) report.line("not done yet", grouped(std::ssize(collection.missing)));
  if (!collection.damaged.empty()) report.line("damaged", grouped(std::ssize(collection.damaged)));
  report.line("hash", collection.hash());
  report.line("written", fmt::format("{}, {}", (out / "bake.jsonl").string(), (out / "report.html").string()));
  addFailures(collection, collection.failed().size(), report);
  return report;
}

ordered_json toJson(const BakeCollection& collection, std::size_t jobs) {
  ordered_json json;
  json["items"] = jobs;
  json["baked"] = collection.worstFirst().size();
  json["failures"] = ordered_json::array();
  for (const ordered_json* result : collection.failed()) json["failures"].push_back(result->value("failure", ""));
  json["missing"] = collection.missing;
  json["damaged"] = collection.damaged;
  json["hash"] = collection.hash();
  return json;
}

/// A folder for temporary files that goes with this object, or when the program is ended.
class Scratch {
 public:
  explicit Scratch(const fs::path& beside)
      : folder_(beside / fmt::format("pictures.{}", ::getpid())), cleaning_([this] { remove(); }) {
    std::error_code ignored;
    fs::create_directories(folder_, ignored);
  }
  ~Scratch() { remove(); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  [[nodiscard]] const fs::path& folder() const { return folder_; }

 private:
  void remove() const {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  fs::path folder_;
  AtHardStop cleaning_;
};

/// --collect: merges, checks and reports.
Result<void> collectAll(const BakeOptions& options, const CommonOptions& common, const std::vector<BakeJob>& jobs,
                        BakeStore& store) {
  const fs::path out = options.out;
  const BakeCollection collection = collect(jobs, store, true);
  if (collection.missing.size() == jobs.size()) {
    return notFound("{}: nothing is baked there as asked; --collect takes the lists and settings of the bake",
                    options.out);
  }
  std::map<std::string, const BakeJob*> byName;
  for (const BakeJob& job : jobs) byName[job.name] = &job;
  Result<BakePictures> pictures = BakePictures::create(howToRun(options, common, 1));
  if (!pictures) warn("the report has no pictures: " + pictures.error().message);
  const Scratch scratch(out);
  const auto draw = [&](const ordered_json& result) -> std::string {
    if (!pictures || interrupted()) return "";
    const BakeJob& job = *byName.at(result.value("item", ""));
    return pictures->draw(job.item, store.folderOf(job.name) / (job.stem + ".lorica"), scratch.folder());
  };
  const std::string page = htmlReport(collection, draw);
  if (interrupted()) return cancelled();
  LORICA_TRY_DO(writeFileAtomically(out / "bake.jsonl", jsonLines(collection), NamedBy::kLorica));
  LORICA_TRY_DO(writeFileAtomically(out / "report.html", page, NamedBy::kLorica));
  linkResults(collection, jobs, store);
  const Result<void> published =
      publish(common, collectionReport(collection, jobs.size(), out), toJson(collection, jobs.size()));
  if (!published || (collection.missing.empty() && collection.damaged.empty())) return published;
  return notWhole(collection, jobs.size());
}

Report toReport(const BakeOutcome& outcome, const BakeOptions& options) {
  Report report(
      fmt::format("{} of {} baked into {}", grouped(outcome.made), counted(outcome.items, "item"), options.out));
  if (outcome.there > 0) report.line("there already", grouped(outcome.there));
  if (outcome.byOthers > 0) report.line("by other processes", grouped(outcome.byOthers));
  if (outcome.failed > 0) report.line("failed", grouped(outcome.failed));
  if (outcome.made + outcome.failed > 0) {
    report.line("time", fmt::format("{:.1f} s, of processors {:.1f} s; longest item {:.1f} s", outcome.seconds,
                                    outcome.cpuSeconds, outcome.longest));
    report.line("memory", fmt::format("at most {} an item, of {} that it may take", megabytes(outcome.peakMemory),
                                      megabytes(outcome.memoryBound)));
  }
  return report;
}

ordered_json toJson(const BakeOutcome& outcome) {
  ordered_json json;
  json["items"] = outcome.items;
  json["made"] = outcome.made;
  json["failed"] = outcome.failed;
  json["there"] = outcome.there;
  json["byOthers"] = outcome.byOthers;
  json["tooLarge"] = outcome.tooLarge;
  json["seconds"] = outcome.seconds;
  json["cpuSeconds"] = outcome.cpuSeconds;
  json["longestItem"] = outcome.longest;
  json["peakMemory"] = outcome.peakMemory;
  json["memoryBound"] = outcome.memoryBound;
  return json;
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
  settings.progress = [&bar](int done, int total) { bar.update(done, total); };
  return settings;
}

Result<void> run(const BakeOptions& options, const CommonOptions& common, Host& host) {
  LORICA_TRY_DO(checkOutputFolder(common, "--out", options.out));
  LORICA_TRY_DO(checkJsonOutput(common, {fs::path(options.out) / "bake.jsonl"}));
  LORICA_TRY(const std::vector<BakeJob> jobs, readJobs(options));
  FileLayer files;
  BakeStore store(files, options.out, pause);
  if (options.collect) return collectAll(options, common, jobs, store);

  LORICA_TRY(Claims claims, Claims::open(files, options.out, options.lostAfter));
  Result<BakeOutcome> outcome = Error{ErrorCode::kCancelled, ""};
  {
    Task bar(host, "Baking", "items");
    outcome = bakeAll(jobs, store, claims, bakerSettings(options, common, bar));
  }
  if (!outcome) return outcome.error();
  if (outcome->stopped) return cancelled();

  Report report = toReport(*outcome, options);
  // One process of several that share the work cannot merge it.
  if (options.chosenShard().count == 1) {
    const BakeCollection collection = collect(jobs, store, false);
    const fs::path merged = fs::path(options.out) / "bake.jsonl";
    LORICA_TRY_DO(writeFileAtomically(merged, jsonLines(collection), NamedBy::kLorica));
    linkResults(collection, jobs, store);
    addFailures(collection, kFewFailures, report);
  }
  LORICA_TRY_DO(publish(common, report, toJson(*outcome)));
  if (outcome->tooLarge.empty()) return {};
  return invalidArgument("{}; {} left out", outcome->tooLarge.front(), counted(std::ssize(outcome->tooLarge), "item"));
}

}  // namespace

Command addBake(CommandLine& parent, CommonOptions& common) {
  const auto options = std::make_shared<BakeOptions>();
  CommandLine* app = addSubcommand(
      parent, common, "bake", "Decompose and export a whole library, on one machine or many.",
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
  return {app, [options](const CommonOptions& given, Host& host) { return run(*options, given, host); }};
}

}  // namespace lorica
