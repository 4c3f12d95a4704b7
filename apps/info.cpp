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

Result<Facts> describeDecomposition(const fs::path& file) {
  const Result<DecompositionFile> content = readDecomposition(file);
  if (!content) return content.error();
  const Decomposition& made = content->decomposition;
  std::error_code ignored;
  const std::uintmax_t bytes = fs::file_size(file, ignored);
  std::vector<std::size_t> triangles;
  for (const Part& part : made.parts) triangles.push_back(part.triangles.size());

  Facts facts{Report(file.filename().string() + ": a decomposition"), {}};
  Report& report = facts.report;
  report.line("made from", fmt::format("{}: {} vertices, {} triangles", content->source, grouped(made.vertexCount),
                                       grouped(made.triangleCount)));
  report.line("parts", grouped(std::ssize(made.parts)));
  report.line("cut points", grouped(std::ssize(made.cutPoints)));
  report.line("keyframes", grouped(std::ssize(content->errorPerKeyframe)));
  report.line("error", percent(content->meanError) + " more volume than the mesh, mean over the keyframes");
  report.line("triangles", fmt::format("{} in the parts", fmt::join(triangles, ", ")));
  report.line("hash", hexDigits(hashOf(made)));
  report.line("file", fmt::format("{} bytes", grouped(static_cast<long long>(bytes))));

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
  json["trianglesOfParts"] = triangles;
  json["hash"] = hexDigits(hashOf(made));
  json["bytes"] = bytes;
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
  CLI::App* app = addSubcommand(parent, common, "info", "Say what a mesh, decomposition, recording or character holds.",
                                "  lorica info bunny.off          # is it closed? how convex is it?\n"
                                "  lorica info body.lorica        # parts, error, what it was made from\n"
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
