#include "apps/cover.h"
#include "apps/inputs.h"
#include "apps/options.h"

#include "acd/decomposition_file.h"
#include "capture/joint_csv.h"
#include "geometry/convex_hull.h"
#include "geometry/files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// What is said about a file, for people and for programs.
struct Facts {
  Report report;
  Json json;
};

std::string point(const Vec3& p) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", p.x(), p.y(), p.z());
}

Facts describeMesh(const Subject& subject) {
  const TriMesh& mesh = subject.mesh;
  const Aabb box = boundsOf(mesh.vertices);
  const double volume = signedVolume(mesh.vertices, mesh.triangles);
  const double hullVolume = convexHullVolume(mesh.vertices);
  const int components = connectedComponents(mesh.vertices.size(), mesh.triangles).count;
  const Result<void> closed = checkClosedTwoManifold(mesh);

  Facts facts{Report(subject.name + (subject.character ? ": a character" : ": a mesh")), {}};
  Report& report = facts.report;
  report.line("vertices", grouped(std::ssize(mesh.vertices)));
  report.line("triangles", grouped(std::ssize(mesh.triangles)));
  report.line("components", grouped(components));
  if (!subject.mended.empty()) report.line("mended", subject.mended);
  report.line("closed", closed ? "yes, it can be decomposed" : "no: " + closed.error().message);
  report.line("volume", fmt::format("{:.6g}", volume));
  report.line("hull volume", fmt::format("{:.6g}", hullVolume));
  const double convexity = hullVolume > 0.0 ? volume / hullVolume : 0.0;
  if (closed && hullVolume > 0.0) report.line("convexity", fmt::format("{:.4f} (volume / hull volume)", convexity));
  if (!box.empty()) {
    report.line("bounding box", fmt::format("{} to {}", point(box.min), point(box.max)));
    report.line("diagonal", fmt::format("{:.6g}", box.diagonal()));
  }

  Json& json = facts.json;
  json["kind"] = subject.character ? "character" : "mesh";
  json["name"] = subject.name;
  json["vertices"] = mesh.vertices.size();
  json["triangles"] = mesh.triangles.size();
  json["components"] = components;
  json["closed"] = closed.ok();
  json["mended"] = subject.mended.empty() ? Json() : Json(subject.mended);
  json["problem"] = closed ? Json() : Json(closed.error().message);
  json["volume"] = volume;
  json["hullVolume"] = hullVolume;
  json["convexity"] = closed && hullVolume > 0.0 ? Json(convexity) : Json();
  json["boundingBox"] =
      box.empty() ? Json() : Json{{box.min.x(), box.min.y(), box.min.z()}, {box.max.x(), box.max.y(), box.max.z()}};
  return facts;
}

Facts describeCharacter(const Subject& subject) {
  const Character& character = *subject.character;
  Facts facts = describeMesh(subject);
  int bones = 0;
  for (const Joint& joint : character.skeleton.joints()) bones += joint.bone ? 1 : 0;
  std::uint32_t most = 0;
  for (std::size_t v = 0; v + 1 < character.influenceBegin.size(); ++v) {
    most = std::max(most, character.influenceBegin[v + 1] - character.influenceBegin[v]);
  }
  facts.report.line("height", fmt::format("{:.3f} m", character.height));
  facts.report.line("joints", fmt::format("{}, {} of them humanoid bones", character.skeleton.jointCount(), bones));
  facts.report.line("influences", fmt::format("at most {} a vertex", most));
  facts.json["height"] = character.height;
  facts.json["joints"] = character.skeleton.jointCount();
  facts.json["humanoidBones"] = bones;
  facts.json["influencesAtMost"] = most;
  return facts;
}

constexpr int kRowsInFull = 32;
constexpr std::size_t kBonesShown = 3;

/// Levels of detail: all of the first 32, then in steps of an eighth, and the last. --json has every one.
Table ladderTable(const std::vector<DetailLevel>& ladder, bool animated) {
  Table table{{"parts", "error", "hull vertices"}, {}};
  if (animated) table.headings.insert(table.headings.begin() + 2, "worst keyframe");
  int next = 1;
  const int all = static_cast<int>(ladder.size());
  for (int n = 1; n <= all; ++n) {
    if (n < next && n != all) continue;
    next = n < kRowsInFull ? n + 1 : n + n / 8;
    const DetailLevel& level = ladder[static_cast<std::size_t>(n) - 1];
    std::vector<std::string> row = {grouped(n), percent(level.meanError), grouped(level.hullVertices)};
    if (animated) row.insert(row.begin() + 2, percent(level.worstError));
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// The mesh triangles that a part came from, ascending: a triangle that was cut has several pieces in it.
std::vector<std::int32_t> sourceTriangles(const Part& part) {
  std::vector<std::int32_t> sources = part.sourceTriangle;
  std::sort(sources.begin(), sources.end());
  sources.erase(std::unique(sources.begin(), sources.end()), sources.end());
  if (!sources.empty() && sources.front() < 0) sources.erase(sources.begin());  // -1, the caps
  return sources;
}

/// "leftUpperArm 62 %, chest 30 %, hips 5 %"
std::string bonesText(const std::vector<BoneShare>& bones) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < std::min(bones.size(), kBonesShown); ++i) {
    words.push_back(fmt::format("{} {:.0f} %", bones[i].bone, 100.0 * bones[i].share));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

/// Where each part came from. Of many parts the first; --json has every one.
Table originTable(const DecompositionFile& content) {
  const std::vector<Part>& parts = content.decomposition.parts;
  Table table{{"part", "source triangles", "triangles"}, {}, 3};
  if (!content.bonesOfPart.empty()) table.headings.push_back("bones, by share of the surface");
  for (std::size_t i = 0; i < std::min<std::size_t>(parts.size(), kRowsInFull); ++i) {
    table.rows.push_back(
        {std::to_string(i), grouped(std::ssize(sourceTriangles(parts[i]))), grouped(std::ssize(parts[i].triangles))});
    if (!content.bonesOfPart.empty()) table.rows.back().push_back(bonesText(content.bonesOfPart[i]));
  }
  return table;
}

Json partsToJson(const DecompositionFile& content) {
  Json parts = Json::array();
  for (std::size_t i = 0; i < content.decomposition.parts.size(); ++i) {
    const Part& part = content.decomposition.parts[i];
    Json json;
    json["splitFrom"] = i == 0 ? Json() : Json(content.decomposition.splitFrom[i - 1]);
    json["triangles"] = part.triangles.size();
    json["sourceTriangles"] = sourceTriangles(part);
    if (!content.bonesOfPart.empty()) {
      json["bones"] = Json::array();
      for (const BoneShare& bone : content.bonesOfPart[i]) {
        json["bones"].push_back({{"name", bone.bone}, {"share", bone.share}});
      }
    }
    parts.push_back(std::move(json));
  }
  return parts;
}

/// What a live body made of it promises, and in which poses it was trained: of what moves.
void addPromise(const DecompositionFile& content, Facts& facts) {
  addCoverTo(facts.report, content.cover);
  addCoverTo(facts.json, content.cover);
  facts.json["training"] = nullptr;
  if (!content.training) {
    facts.report.line("training", "not in the file, which an older Lorica wrote");
    return;
  }
  const TrainingRange& training = *content.training;
  facts.report.line("training", fmt::format("{} in {}; poses up to {:.2f} m from one of these are known",
                                            counted(std::ssize(training.probes), "probe"),
                                            counted(training.keyframeCount, "keyframe"), training.knownDistance));
  facts.json["training"] = {{"probes", training.probes.size()},
                            {"keyframes", training.keyframeCount},
                            {"knownDistance", training.knownDistance}};
}

Result<Facts> describeDecomposition(const fs::path& file) {
  const Result<DecompositionFile> content = readDecomposition(file);
  if (!content) return content.error();
  const Decomposition& made = content->decomposition;
  std::error_code ignored;
  const std::uintmax_t bytes = fs::file_size(file, ignored);
  const bool animated = content->errorPerKeyframe.size() > 1;

  Facts facts{Report(file.filename().string() + ": a decomposition"), {}};
  Report& report = facts.report;
  report.line("made from", fmt::format("{}: {} vertices, {} triangles", content->source, grouped(made.vertexCount),
                                       grouped(made.triangleCount)));
  report.line("parts", grouped(std::ssize(made.parts)));
  report.line("cut points", grouped(std::ssize(made.cutPoints)));
  report.line("keyframes", grouped(std::ssize(content->errorPerKeyframe)));
  report.line("error", fmt::format("{} more volume than the mesh{}", percent(content->meanError),
                                   animated ? ", mean over the keyframes" : ""));
  report.line("hash", hexDigits(hashOf(made)));
  report.line("file", fmt::format("{} bytes", grouped(static_cast<long long>(bytes))));
  if (content->ladder.empty()) {
    report.line("ladder", "not in the file, which an older Lorica wrote");
  } else {
    report.table(ladderTable(content->ladder, animated));
  }
  report.table(originTable(*content));
  if (made.parts.size() > kRowsInFull) report.note("The tables leave rows out; --json has all of them.");

  Json& json = facts.json;
  json["kind"] = "decomposition";
  json["name"] = file.filename().string();
  json["source"] = content->source;
  json["meshHash"] = hexDigits(content->meshHash);
  json["vertices"] = made.vertexCount;
  json["triangles"] = made.triangleCount;
  json["parts"] = made.parts.size();
  json["cutPoints"] = made.cutPoints.size();
  json["error"] = content->meanError;
  json["errorPerKeyframe"] = content->errorPerKeyframe;
  if (animated || content->training || content->cover || !content->bonesOfPart.empty()) addPromise(*content, facts);
  json["hash"] = hexDigits(hashOf(made));
  json["bytes"] = bytes;
  json["ladder"] = Json::array();
  for (std::size_t i = 0; i < content->ladder.size(); ++i) {
    const DetailLevel& level = content->ladder[i];
    json["ladder"].push_back({{"parts", i + 1},
                              {"error", level.meanError},
                              {"worstError", level.worstError},
                              {"hullVertices", level.hullVertices}});
  }
  json["partOrigins"] = partsToJson(*content);
  return facts;
}

Facts describeRecording(const Recording& recording) {
  const std::vector<SkeletonFrame>& frames = recording.frames;
  std::size_t seen = 0, guessed = 0, unknown = 0;
  for (const SkeletonFrame& frame : frames) {
    for (const TrackedJoint& joint : frame.joints) {
      ++(joint.confidence >= 1.0 ? seen : joint.confidence > 0.0 ? guessed : unknown);
    }
  }
  const double all = static_cast<double>(frames.size()) * kBodyJointCount;
  const double seconds = recording.seconds();
  const double rate = seconds > 0.0 ? static_cast<double>(frames.size() - 1) / seconds : 0.0;

  Facts facts{Report(recording.name + ": a recording of joints"), {}};
  facts.report.line("length", fmt::format("{:.2f} s", seconds));
  facts.report.line("frames", fmt::format("{} at {:.1f} a second", grouped(std::ssize(frames)), rate));
  facts.report.line("user", std::to_string(frames.front().user));
  facts.report.line(
      "joints",
      fmt::format("{}: {} seen, {} guessed, {} unknown", kBodyJointCount, percent(static_cast<double>(seen) / all),
                  percent(static_cast<double>(guessed) / all), percent(static_cast<double>(unknown) / all)));
  Json& json = facts.json;
  json["kind"] = "recording";
  json["name"] = recording.name;
  json["seconds"] = seconds;
  json["frames"] = frames.size();
  json["framesPerSecond"] = rate;
  json["user"] = frames.front().user;
  json["jointsSeen"] = static_cast<double>(seen) / all;
  json["jointsGuessed"] = static_cast<double>(guessed) / all;
  json["jointsUnknown"] = static_cast<double>(unknown) / all;
  return facts;
}

/// Whether a word that names neither a file nor a character names a shipped recording.
bool isShippedRecording(const std::string& input) {
  std::error_code ignored;
  const Result<fs::path> folder = recordingsFolder();
  return folder && !fs::exists(input, ignored) && fs::exists(*folder / (input + ".csv"), ignored);
}

Result<Facts> describe(const std::string& input) {
  const fs::path file(input);
  if (file.extension() == ".lorica") return describeDecomposition(file);
  if (file.extension() == ".csv" || isShippedRecording(input)) {
    const Result<Recording> recording = readRecording(input);
    if (!recording) return recording.error();
    return describeRecording(*recording);
  }
  const Result<Subject> subject = readSubject(input);
  if (!subject) return subject.error();
  return subject->character ? describeCharacter(*subject) : describeMesh(*subject);
}

Result<void> run(const std::string& input, const CommonOptions& common) {
  if (Result<void> fine = checkJsonOutput(common, {input}); !fine) return fine;
  const Result<Facts> facts = describe(input);
  if (!facts) return facts.error();
  return publish(common, facts->report, facts->json);
}

}  // namespace

Command addInfo(CLI::App& parent, CommonOptions& common) {
  const auto input = std::make_shared<std::string>();
  CLI::App* app =
      addSubcommand(parent, common, "info", "Say what a mesh, decomposition, recording or character holds.",
                    "  lorica info bunny.off          # is it closed? how convex is it?\n"
                    "  lorica info body.lorica        # parts, error, levels of detail, bones of each part\n"
                    "  lorica info walk               # a shipped recording\n"
                    "  lorica info recording.csv      # joints of your own\n"
                    "  lorica info mannequin          # the built-in character");
  app->add_option("FILE", *input,
                  "Mesh (.off, .obj, .ply, .stl), decomposition (.lorica), recording (.csv), or a shipped name")
      ->required()
      ->type_name("");
  return {app, [input](const CommonOptions& given) { return run(*input, given); }};
}

}  // namespace lorica
