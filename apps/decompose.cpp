#include "acd/decompose.h"

#include "apps/hull_export.h"
#include "apps/inputs.h"
#include "apps/interrupt.h"
#include "apps/options.h"
#include "apps/quality.h"
#include "apps/training.h"
#include "geometry/files.h"
#include "geometry/mesh_files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <optional>

namespace lorica {
namespace {

constexpr int kCharacterParts = 16;
static_assert(kAuto == kChooseKeyframes, "--keyframes auto is passed on as it is");

struct Options {
  std::string input;
  int parts = 0;             // 0 = not given
  double maxError = 0.0;     // 0 = not given
  double maxDistance = 0.0;  // 0 = not given
  int keyframes = 0;         // 0 = not given, kAuto = to be chosen
  std::vector<std::string> motions;
  std::string preset = "fast";
  int candidates = 0;    // 0 = the preset's
  int orientations = 0;  // 0 = the preset's
  int hullVertices = 0;  // 0 = not given
  std::string output;
  std::string obj;
};

/// Refuses what would only be found out after the work: options that do not fit the input, outputs without a folder.
Result<void> check(const Options& options, const CommonOptions& common, const Subject& subject) {
  if (!subject.character && (options.keyframes != 0 || !options.motions.empty())) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{} is for characters, and {} is a mesh that does not move",
                             options.keyframes != 0 ? "--keyframes" : "--motion", subject.name)};
  }
  if (!options.output.empty()) {
    if (Result<void> fine = checkOutput("--output", options.output, ".lorica"); !fine) return fine;
  }
  if (!options.obj.empty()) {
    if (Result<void> fine = checkOutput("--export-obj", options.obj, ".obj"); !fine) return fine;
    std::error_code ignored;
    if (std::filesystem::equivalent(options.obj, options.input, ignored)) {
      return Error{ErrorCode::kInvalidArgument,
                   fmt::format("--export-obj: {} is the input and would be overwritten", options.obj)};
    }
  }
  std::vector<std::filesystem::path> others(options.motions.begin(), options.motions.end());
  others.insert(others.end(), {options.input, options.output, options.obj});
  return checkJsonOutput(common, others);
}

/// Which of the limits ended the cutting, and how far the hulls stand off the surface where that was limited.
struct Ending {
  const char* by = "parts";  // or "error", "distance", "convex"
  std::optional<double> distance;
};

Ending findEnding(const Options& options, int maxParts, const Decomposition& made, const Quality& quality,
                  PoseView poses) {
  Ending ending;
  if (options.maxDistance > 0.0) {
    ending.distance = measureDistance(made, poses, 0.1 * options.maxDistance);
    // Both are upper bounds; the second one is the tighter one about the limit itself.
    if (*ending.distance > options.maxDistance) {
      ending.distance = std::min(*ending.distance, measureDistance(made, poses, options.maxDistance));
    }
  }
  if (options.maxError > 0.0 && quality.error <= options.maxError) {
    ending.by = "error";
  } else if (ending.distance && *ending.distance <= options.maxDistance) {
    ending.by = "distance";
  } else if (static_cast<int>(made.parts.size()) != maxParts) {
    ending.by = "convex";
  }
  return ending;
}

/// "the 8 parts asked for, before an error of 5.0 % was reached"
std::string sentence(const Options& options, const Ending& ending, int partCount) {
  const std::string by = ending.by;
  std::vector<std::string> limits;
  if (options.maxError > 0.0) limits.push_back("an error of " + percent(options.maxError));
  if (options.maxDistance > 0.0) limits.push_back(fmt::format("a distance of {:g}", options.maxDistance));
  const std::string unmet = fmt::format(", before {} was reached", fmt::join(limits, " or "));
  if (by == "error") return limits.front() + ", which was reached";
  if (by == "distance") return limits.back() + ", which was reached";
  if (by == "parts") return fmt::format("the {} asked for", counted(partCount, "part")) + unmet;
  return "no cut that gains anything is left" + unmet;
}

/// "at most 32 of 2,023, for 2.5 % more volume, 4.4 % in part 7"
std::string sentence(const HullExport& hulls) {
  if (hulls.mostVertices == hulls.mostVerticesBefore) {
    return fmt::format("at most {}: nothing to leave out", grouped(static_cast<long long>(hulls.mostVertices)));
  }
  const auto worst = std::max_element(hulls.growth.begin(), hulls.growth.end());
  return fmt::format("at most {} of {}, for {} more volume, {} in part {}",
                     grouped(static_cast<long long>(hulls.mostVertices)),
                     grouped(static_cast<long long>(hulls.mostVerticesBefore)), percent(hulls.totalGrowth - 1.0),
                     percent(*worst - 1.0), worst - hulls.growth.begin());
}

nlohmann::ordered_json toJson(const Options& options, const Subject& subject, const TimedDecomposition& made,
                              const Quality& quality, const Keyframes& keyframes, const Ending& ending,
                              const HullExport& hulls, int threads) {
  nlohmann::ordered_json json;
  json["input"] = subject.name;
  json["parts"] = made.decomposition.parts.size();
  json["meshVolume"] = quality.meshVolume;
  json["hullVolume"] = quality.hullVolume;
  json["score"] = quality.score;
  json["error"] = quality.error;
  json["endedBy"] = ending.by;
  if (options.maxError > 0.0) json["maxError"] = options.maxError;
  if (options.maxDistance > 0.0) json["maxDistance"] = options.maxDistance;
  if (ending.distance) json["distance"] = *ending.distance;
  json["seconds"] = made.seconds;
  json["threads"] = threads;
  json["vertices"] = subject.mesh.vertices.size();
  if (!subject.mended.empty()) json["mended"] = subject.mended;
  json["hash"] = hexDigits(hashOf(made.decomposition));
  if (subject.character) {
    json["keyframes"] = quality.errorPerKeyframe.size();
    json["errorPerKeyframe"] = quality.errorPerKeyframe;
    for (const ChosenFrame& chosen : keyframes.chosen) {
      json["chosenKeyframes"].push_back(
          {{"recording", chosen.recording}, {"frame", chosen.frame}, {"time", chosen.time}});
    }
  }
  if (options.hullVertices > 0) {
    json["hullVertices"] = options.hullVertices;
    json["hullGrowth"] = hulls.totalGrowth;
    json["hullGrowthPerPart"] = hulls.growth;
  }
  if (!options.output.empty()) json["output"] = options.output;
  if (!options.obj.empty()) json["exportObj"] = options.obj;
  return json;
}

Report toReport(const Options& options, const Subject& subject, const TimedDecomposition& made, const Quality& quality,
                const Keyframes& keyframes, const Ending& ending, const HullExport& hulls, int threads) {
  Report report(fmt::format("{}: {}", subject.name,
                            counted(static_cast<long long>(made.decomposition.parts.size()), "convex part")));
  report.line("mesh", fmt::format("{} vertices, {} triangles", grouped(std::ssize(subject.mesh.vertices)),
                                  grouped(std::ssize(subject.mesh.triangles))));
  if (!subject.mended.empty()) report.line("mended", subject.mended);
  const std::string mean = subject.character ? ", mean over the keyframes" : "";
  report.line("volume", fmt::format("{:.6g}, of the hulls {:.6g}{}", quality.meshVolume, quality.hullVolume, mean));
  report.line("error", fmt::format("{} more volume than the mesh{}", percent(quality.error), mean));
  if (subject.character) {
    const auto [best, worst] = std::minmax_element(quality.errorPerKeyframe.begin(), quality.errorPerKeyframe.end());
    report.line("keyframes", fmt::format("{}, error from {} to {}", quality.errorPerKeyframe.size(), percent(*best),
                                         percent(*worst)));
  }
  if (ending.distance) {
    report.line("distance", fmt::format("{:.4g} at most, from the hulls to the surface of their parts{}",
                                        *ending.distance, subject.character ? ", in the worst keyframe" : ""));
  }
  if (options.maxError > 0.0 || options.maxDistance > 0.0) {
    report.line("ended by", sentence(options, ending, static_cast<int>(made.decomposition.parts.size())));
  }
  report.line("score", fmt::format("{:.4f} (Eq. 17: mesh volume / hull volume, 1 is perfect)", quality.score));
  report.line("time", fmt::format("{:.2f} s on {}", made.seconds, counted(threads, "thread")));
  report.line("hash", hexDigits(hashOf(made.decomposition)));
  if (options.hullVertices > 0)
    report.line("hull vertices", sentence(hulls) + (subject.character ? ", in the bind pose" : ""));
  if (!options.output.empty()) report.line("written", options.output);
  if (!options.obj.empty()) report.line("hulls written", options.obj);
  if (!keyframes.chosen.empty()) {
    Table table{{"frame", "time [s]", "error", "recording"}, {}, 3};
    for (std::size_t k = 0; k < keyframes.chosen.size(); ++k) {
      const auto& [recording, frame, time] = keyframes.chosen[k];
      table.rows.push_back(
          {std::to_string(frame), fmt::format("{:.2f}", time), percent(quality.errorPerKeyframe[k]), recording});
    }
    report.table(std::move(table));
    report.note(
        fmt::format("These keyframes were chosen: every other frame is within {:.2f} m of one (root mean square "
                    "over the body).",
                    keyframes.farthest));
  }
  return report;
}

Result<void> run(const Options& options, const CommonOptions& common) {
  // The input, and whether all that is asked of it makes sense.
  const Result<Subject> subject = readSubject(options.input);
  if (!subject) return subject.error();
  if (Result<void> fine = check(options, common, *subject); !fine) return fine;

  // The poses to fit: a mesh has one, a character those of a motion.
  Keyframes keyframes{subject->mesh.vertices, 1, {}, 0.0};
  if (subject->character) {
    const int count = options.keyframes != 0 ? options.keyframes : kDefaultKeyframes;
    Result<Keyframes> sampled = trainingKeyframes(*subject->character, options.motions, count);
    if (!sampled) return sampled.error();
    keyframes = std::move(*sampled);
  }
  const PoseView poses{keyframes.positions, static_cast<int>(subject->mesh.vertices.size())};

  // The work.
  DecomposeSettings settings;
  const bool limited = options.maxError > 0.0 || options.maxDistance > 0.0;
  settings.maxParts = options.parts > 0 ? options.parts : subject->character && !limited ? kCharacterParts : 0;
  settings.maxError = options.maxError;
  settings.maxDistance = options.maxDistance;
  settings.preset = options.preset == "paper"  ? DecomposePreset::kPaper
                    : options.preset == "fast" ? DecomposePreset::kFast
                                               : DecomposePreset::kQuality;
  settings.candidateEdges = options.candidates;
  settings.planesPerEdge = options.orientations;
  settings.threads = common.threadCount();
  const Result<TimedDecomposition> made = decomposeWithProgress(subject->name, subject->mesh, poses, settings);
  if (!made) return made.error();
  const Quality quality = measureQuality(made->decomposition, subject->mesh, poses);
  const Ending ending = findEnding(options, settings.maxParts, made->decomposition, quality, poses);

  HullExport hulls;
  if (options.hullVertices > 0 || !options.obj.empty()) {
    hulls = exportHulls(made->decomposition, subject->mesh.vertices, options.hullVertices, settings.threads);
  }
  if (interrupted()) return Error{ErrorCode::kCancelled, "cancelled"};

  // The outputs, each written whole or not at all.
  if (!options.output.empty()) {
    const DecompositionFile content =
        fileContent(subject->name, subject->mesh, subject->character ? &*subject->character : nullptr, poses,
                    made->decomposition, quality);
    if (Result<void> written = writeDecomposition(options.output, content); !written) return written;
  }
  if (!options.obj.empty()) {
    if (Result<void> written = writeObjObjects(options.obj, hulls.objects); !written) return written;
  }
  return publish(common, toReport(options, *subject, *made, quality, keyframes, ending, hulls, settings.threads),
                 toJson(options, *subject, *made, quality, keyframes, ending, hulls, settings.threads));
}

}  // namespace

Command addDecompose(CLI::App& parent, CommonOptions& common) {
  const auto options = std::make_shared<Options>();
  CLI::App* app = addSubcommand(parent, common, "decompose",
                                "Cut a closed mesh, or a character in motion, into parts that are almost convex.",
                                "  lorica decompose bunny.off --parts 16\n"
                                "      16 parts; how close their hulls are to the mesh\n"
                                "  lorica decompose bunny.off --parts 16 --export-obj hulls.obj\n"
                                "      also one object (o part_0, ...) for each part's hull, to use elsewhere\n"
                                "  lorica decompose bunny.off --parts 16 --hull-vertices 32 --export-obj hulls.obj\n"
                                "      hulls that an engine takes: larger ones with no more than 32 vertices each\n"
                                "  lorica decompose bunny.off --parts 16 --preset quality\n"
                                "      tighter parts for some seconds more\n"
                                "  lorica decompose bunny.off --max-error 5% --parts 64\n"
                                "      until the hulls have 5 % more volume than the mesh, but at most 64 parts\n"
                                "  lorica decompose bracket.stl\n"
                                "      go on until no concave edge remains (Ctrl-C cancels)\n"
                                "  lorica decompose mannequin -o body.lorica\n"
                                "      16 parts that stay tight in 12 poses of the shipped recordings\n"
                                "  lorica decompose mannequin --parts 24 --motion dance.csv -o dancer.lorica\n"
                                "      trained on a motion of your own\n"
                                "  lorica decompose mannequin --keyframes auto --motion walk --motion dance.csv\n"
                                "      trained on poses of both that differ most\n"
                                "  lorica decompose bunny.off --parts 8 --json - | jq .score\n"
                                "\nFor a character, --export-obj writes its bind pose, and volumes, score and error "
                                "are means over the keyframes.");
  app->add_option("INPUT", options->input, "Closed mesh (.off, .obj, .ply, .stl) or `mannequin`")
      ->required()
      ->type_name("");
  addCount(
      *app, "--parts", options->parts, 1,
      "Stop at so many parts [default: with a limit below none; else a character 16, a mesh when it has no concave "
      "edge left]");
  addShare(*app, "--max-error", options->maxError,
           "Stop when the hulls have at most so much more volume than the mesh: 0.05 or 5%");
  addLength(*app, "--max-distance", options->maxDistance,
            "Stop when no point of the hulls is farther from the surface, in any keyframe. The unit is the mesh's");
  app->add_option("--preset", options->preset,
                  "paper: the algorithm as published; fast: better parts in like time; quality: better still, slower "
                  "[default: fast]")
      ->type_name("NAME")
      ->check(oneOf({"paper", "fast", "quality"}));
  addCountOrAuto(
      *app, "--keyframes", options->keyframes, 1,
      "Poses that a character is trained on, evenly over the motions; `auto`: up to 12 that differ most, and "
      "says which [default: 12]");
  app->add_option("--motion", options->motions,
                  "Take the keyframes from this recording; may be given again [default: those that ship]")
      ->type_name("FILE")
      ->expected(1)
      ->take_all();
  addCount(*app, "--candidates", options->candidates, 1, "Concave edges tried for each cut [default: the preset's, 8]");
  addCount(*app, "--orientations", options->orientations, 1,
           "Planes tried at each of them [default: the preset's, 5 or, fast, 3]");
  addCount(*app, "--hull-vertices", options->hullVertices, 4,
           "Enclose each hull in a larger one of at most so many vertices, say by how much it grows, and export these");
  app->add_option("-o,--output", options->output, "Write the decomposition, for `lorica play`")
      ->type_name("FILE.lorica");
  app->add_option("--export-obj", options->obj, "Write the parts' hulls")->type_name("FILE.obj");
  return {app, [options](const CommonOptions& given) { return run(*options, given); }};
}

}  // namespace lorica
