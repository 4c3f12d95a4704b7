#include "apps/file_summary.h"
#include "apps/report_parts.h"
#include "capture/retarget/proxy_skeleton.h"
#include "geometry/text.h"
#include "prepare/cast.h"
#include "prepare/first_guess.h"
#include "skinning/linear_blend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace lorica {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kClipsShown = 24;
constexpr int kPosesMeasured = 6;
constexpr std::size_t kExpressionsShown = 40;

/// Converts leftHand to "left hand".
std::string inWords(std::string_view bone) {
  std::string words;
  for (const char c : bone) {
    if (c >= 'A' && c <= 'Z') {
      words += ' ';
      words += static_cast<char>(c - 'A' + 'a');
    } else {
      words += c;
    }
  }
  return words;
}

/// "left foot: Foot.L, reattached to LowerLeg.L" or "left hand: end of the mesh on LowerArm.L".
std::string inWords(const Skeleton& skeleton, const ProxySkeleton::Substitute& substitute) {
  const std::string bone = inWords(nameOf(substitute.bone));
  const std::string& on = skeleton.joint(substitute.on).name;
  if (substitute.joint != kNoJoint) {
    return fmt::format("{}: {}, reattached to {}", bone, skeleton.joint(substitute.joint).name, on);
  }
  const bool end = substitute.bone == HumanBone::kLeftHand || substitute.bone == HumanBone::kRightHand ||
                   substitute.bone == HumanBone::kLeftFoot || substitute.bone == HumanBone::kRightFoot;
  if (end) return fmt::format("{}: end of the mesh on {}", bone, on);
  return fmt::format("{}: half of {}, which stays straight", bone, on);
}

void addSkeleton(const Character& character, FileSummary& summary) {
  const Skeleton& skeleton = character.skeleton;
  const Result<ProxySkeleton> proxy = ProxySkeleton::create(character);
  Json bones = Json::object();
  std::vector<std::string> lacking;
  for (int b = 0; b < kHumanBoneCount; ++b) {
    const auto bone = static_cast<HumanBone>(b);
    const JointIndex joint = skeleton.jointOf(bone);
    if (joint != kNoJoint) bones[std::string(nameOf(bone))] = skeleton.joint(joint).name;
    if (joint != kNoJoint || b >= static_cast<int>(HumanBone::kLeftThumbMetacarpal)) continue;
    if (proxy && proxy->skeleton().jointOf(bone) != kNoJoint) continue;
    lacking.push_back(inWords(nameOf(bone)));
  }
  summary.report.line("joints", fmt::format("{}, {} of them humanoid bones", skeleton.jointCount(), bones.size()));
  if (!bones.empty() && !lacking.empty()) {
    summary.report.line("missing bones", fmt::format("{} (they stay at rest)", fmt::join(lacking, ", ")));
  }
  summary.report.line("motion", proxy ? "accepts any humanoid motion" : "accepts only motions of its own joints");
  Json substitutes = Json::array();
  if (proxy && !proxy->substitutes().empty()) {
    std::vector<std::string> words;
    words.reserve(proxy->substitutes().size());
    for (const ProxySkeleton::Substitute& substitute : proxy->substitutes()) {
      words.push_back(inWords(skeleton, substitute));
      Json json = Json::object();
      json["bone"] = std::string(nameOf(substitute.bone));
      if (substitute.joint != kNoJoint) json["joint"] = skeleton.joint(substitute.joint).name;
      json["on"] = skeleton.joint(substitute.on).name;
      substitutes.push_back(std::move(json));
    }
    summary.report.note(
        fmt::format("Substitutes for bones that are missing or attached elsewhere: {}.", fmt::join(words, "; ")));
  }
  for (const std::string& sentence : leftBehind(character)) summary.report.note(sentence);
  summary.json["joints"] = skeleton.jointCount();
  summary.json["humanoidBones"] = bones.size();
  summary.json["bones"] = std::move(bones);
  summary.json["retargetable"] = proxy.ok();
  summary.json["substitutes"] = std::move(substitutes);
}

void addFile(const CharacterFile& file, FileSummary& summary) {
  Report& report = summary.report;
  report.line("format", fmt::format("{}: {}, {}, {}", file.format, counted(file.meshes, "mesh", "meshes"),
                                    counted(file.primitives, "primitive"), counted(file.skins, "skin")));
  report.line("unit", file.metresPerUnit == 1.0 ? "metres" : fmt::format("{:g} m, converted", file.metresPerUnit));
  report.line("weights", fmt::format("at most {} per vertex, {}", counted(file.maxInfluences, "bone"),
                                     file.repairedVertices == 0
                                         ? "all valid"
                                         : counted(file.repairedVertices, "vertex", "vertices") + " repaired"));
  Json& json = summary.json;
  json["format"] = file.format;
  json["meshes"] = file.meshes;
  json["primitives"] = file.primitives;
  json["skins"] = file.skins;
  json["metresPerUnit"] = file.metresPerUnit;
  json["maxInfluences"] = file.maxInfluences;
  json["repairedVertices"] = file.repairedVertices;
}

void addFace(const CharacterFile& file, FileSummary& summary) {
  Report& report = summary.report;
  Json& json = summary.json;
  const std::vector<MorphTarget>& targets = file.morphs.targets;
  json["morphTargets"] = file.morphTargets;
  json["expressions"] = Json::array();
  for (const Expression& expression : file.expressions.list) {
    Json one = {{"name", expression.name}, {"targets", Json::object()}};
    for (const MorphBind& bind : expression.morphs) one["targets"][targets[bind.target].name] = bind.weight;
    json["expressions"].push_back(std::move(one));
  }
  const LookAtKind looks = file.lookAt.kind;
  const char* gaze = looks == LookAtKind::kBone ? "bones" : looks == LookAtKind::kExpression ? "expressions" : "none";
  json["lookAt"] = gaze;
  if (file.morphTargets > 0) {
    const auto clips = std::count_if(file.morphs.clips.begin(), file.morphs.clips.end(),
                                     [](const auto& tracks) { return !tracks.empty(); });
    std::size_t moving = 0;
    for (const MorphTarget& target : targets) moving += target.offsets.empty() ? 0 : 1;
    report.line("morph targets", fmt::format("{}, {} of them move something{}", file.morphTargets, moving,
                                             clips == 0 ? "" : fmt::format("; {} move them", counted(clips, "clip"))));
  }
  if (!file.expressions.list.empty()) report.line("expressions", namesOf(file.expressions, kExpressionsShown));
  if (looks != LookAtKind::kNone) report.line("look-at", fmt::format("by {}", gaze));
}

void addClips(const std::vector<Clip>& clips, FileSummary& summary) {
  summary.json["clips"] = Json::array();
  for (const Clip& clip : clips) summary.json["clips"].push_back({{"name", clip.name}, {"seconds", clip.seconds}});
  if (clips.empty()) {
    summary.report.line("clips", "none");
    return;
  }
  summary.report.line("clips", fmt::format("{}", clips.size()));
  Table table{{"seconds", "clip"}, {}, 1};
  for (std::size_t i = 0; i < std::min(clips.size(), kClipsShown); ++i) {
    table.rows.push_back({fmt::format("{:.2f}", clips[i].seconds), clips[i].name});
  }
  summary.report.table(std::move(table));
  if (clips.size() > kClipsShown) summary.report.note("The table does not show all clips; --json does.");
}

/// Distances between the visible surface and the body, in both directions.
std::string sentence(const BodyDistances& d) {
  return fmt::format(
      "the visible surface lies up to {} outside the body, mean {}; the body is up to {} from it, mean {}",
      millimetres(d.farthestOutside), millimetres(d.meanOutside), millimetres(d.farthestToOriginal),
      millimetres(d.meanToOriginal));
}

Json toJson(const BodyDistances& d) {
  return {{"farthestOutside", d.farthestOutside},
          {"meanOutside", d.meanOutside},
          {"farthestToOriginal", d.farthestToOriginal},
          {"meanToOriginal", d.meanToOriginal}};
}

/// The same for the character's clips: the maximum of each figure over several poses of all clips. None without clips.
std::optional<BodyDistances> distancesOverClips(const Subject& subject) {
  const ClosedBody& body = *subject.body;
  const std::vector<Clip>& clips = subject.file->clips;
  if (!body.made || clips.empty()) return std::nullopt;
  const Character& character = body.character;
  std::vector<Affine3> worldFromModel(character.skeleton.jointCount());
  BodyDistances worst;
  for (int i = 0; i < kPosesMeasured; ++i) {
    const double at = (i + 0.5) * clips.size() / kPosesMeasured;  // in the concatenated clips
    const Clip& clip = clips[at];
    Pose pose = restPose(character.skeleton);
    sampleClip(clip, (at - std::floor(at)) * clip.seconds, pose);
    computeWorldFromJoint(character.skeleton, pose, worldFromModel);
    computeWorldFromModel(character, worldFromModel, worldFromModel);
    const BodyDistances d = distancesInPose(body, worldFromModel);
    worst.farthestOutside = std::max(worst.farthestOutside, d.farthestOutside);
    worst.meanOutside = std::max(worst.meanOutside, d.meanOutside);
    worst.farthestToOriginal = std::max(worst.farthestToOriginal, d.farthestToOriginal);
    worst.meanToOriginal = std::max(worst.meanToOriginal, d.meanToOriginal);
  }
  return worst;
}

void addBody(const Subject& subject, FileSummary& summary) {
  const ClosedBody& body = *subject.body;
  const std::optional<BodyDistances> posed = distancesOverClips(subject);
  Report& report = summary.report;
  report.line("surface", fmt::format("{}, {}, {}", counted(body.shells, "shell"), counted(body.openEdges, "open edge"),
                                     counted(body.nonManifoldEdges, "non-manifold edge")));
  if (body.made) {
    report.line("body", fmt::format("made from voxels of {1}, {0} vertices, because the surface is not closed",
                                    grouped(body.bodyVertices), millimetres(body.resolution)));
    report.line("bind pose", sentence(body.distances));
    if (posed)
      report.line("own clips", sentence(*posed) + fmt::format(" (maximum of {})", counted(kPosesMeasured, "pose")));
  } else {
    report.line("body", "the surface itself, which is closed");
  }
  for (const std::string& note : body.notes) report.note(note);
  Json& json = summary.json["body"];
  json["made"] = body.made;
  json["vertices"] = body.bodyVertices;
  json["resolution"] = body.made ? Json(body.resolution) : Json();
  json["shells"] = body.shells;
  json["openEdges"] = body.openEdges;
  json["nonManifoldEdges"] = body.nonManifoldEdges;
  json["bindPose"] = toJson(body.distances);
  json["clips"] = posed ? toJson(*posed) : Json();
  json["notes"] = body.notes;
}

/// What the character does, in one line.
std::string verdictOf(const Subject& subject) {
  const CharacterFile& file = *subject.file;
  const std::size_t clips = file.clips.size();
  std::vector<std::string> does;
  does.push_back(canPerform(*subject.character) ? "performs all motions"
                 : clips == 0                   ? "stands, since it is no humanoid and has no clips"
                                                : "performs its own " + counted(std::ssize(file.clips), "clip"));
  if (!file.expressions.list.empty()) does.push_back(counted(std::ssize(file.expressions.list), "expression"));
  if (!file.springs.chains.empty()) does.emplace_back("hair or clothes swing");
  if (subject.body->made) does.emplace_back("its hulls are those of a body that was made, since its surface is open");
  return fmt::format("works: {}", fmt::join(does, ", "));
}

}  // namespace

FileSummary describeCharacter(const Subject& subject, int textureSize) {
  const Character& character = *subject.character;
  if (!subject.file) {
    FileSummary summary = describeMesh(subject);
    std::uint32_t max = 0;
    for (std::size_t v = 0; v + 1 < character.influenceBegin.size(); ++v) {
      max = std::max(max, character.influenceBegin[v + 1] - character.influenceBegin[v]);
    }
    summary.report.line("height", fmt::format("{:.3f} m", character.height));
    summary.report.line("influences", fmt::format("at most {} per vertex", max));
    summary.json["height"] = character.height;
    summary.json["maxInfluences"] = max;
    addSkeleton(character, summary);
    return summary;
  }
  const CharacterFile& file = *subject.file;
  const TriMesh& mesh = file.character.mesh;
  FileSummary summary{Report(subject.name + ": a character"), {}};
  Json& json = summary.json;
  json["kind"] = "character";
  json["name"] = subject.name;
  json["vertices"] = mesh.vertices.size();
  json["triangles"] = mesh.triangles.size();
  json["height"] = character.height;
  json["verdict"] = verdictOf(subject);
  summary.report.line("verdict", json["verdict"].get<std::string>());
  addFile(file, summary);
  summary.report.line("mesh", fmt::format("{} vertices, {} triangles", grouped(std::ssize(mesh.vertices)),
                                          grouped(std::ssize(mesh.triangles))));
  summary.report.line("height", fmt::format("{:.3f} m", character.height));
  json["firstGuess"] = firstGuessOf(file);
  summary.report.line("first guess", json["firstGuess"].get<std::string>());
  addSkeleton(character, summary);
  addBody(subject, summary);
  describeSprings(file.springs, summary.report, json);
  addFace(file, summary);
  describeMeshNames(file.meshNames, summary.report, json);
  describeLook(file.look, textureSize, summary.report, json);
  addClips(file.clips, summary);
  for (const std::string& note : file.notes) summary.report.note(note);
  json["notes"] = file.notes;
  return summary;
}

}  // namespace lorica
