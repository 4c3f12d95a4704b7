#include "apps/file_summary.h"
#include "capture/retarget/proxy_skeleton.h"
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

/// "left hand" for leftHand.
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

/// "left foot by Foot.L, as if it hung on LowerLeg.L" or "left hand, where what hand_L carries ends".
std::string inWords(const Skeleton& skeleton, const StandInSkeleton::Substitute& substitute) {
  const std::string bone = inWords(nameOf(substitute.bone));
  const std::string& on = skeleton.joint(substitute.on).name;
  if (substitute.joint != kNoJoint) {
    return fmt::format("{} by {}, as if it hung on {}", bone, skeleton.joint(substitute.joint).name, on);
  }
  const bool end = substitute.bone == HumanBone::kLeftHand || substitute.bone == HumanBone::kRightHand ||
                   substitute.bone == HumanBone::kLeftFoot || substitute.bone == HumanBone::kRightFoot;
  if (end) return fmt::format("{}, where the mesh on {} ends", bone, on);
  return fmt::format("{}, as half of {}, which stays straight", bone, on);
}

void addSkeleton(const Character& character, Facts& facts) {
  const Skeleton& skeleton = character.skeleton;
  const Result<StandInSkeleton> standIn = StandInSkeleton::create(character);
  Json bones = Json::object();
  std::vector<std::string> lacking;
  for (int b = 0; b < kHumanBoneCount; ++b) {
    const auto bone = static_cast<HumanBone>(b);
    const JointIndex joint = skeleton.jointOf(bone);
    if (joint != kNoJoint) bones[std::string(nameOf(bone))] = skeleton.joint(joint).name;
    if (joint != kNoJoint || b >= static_cast<int>(HumanBone::kLeftThumbMetacarpal)) continue;
    if (standIn && standIn->skeleton().jointOf(bone) != kNoJoint) continue;
    lacking.push_back(inWords(nameOf(bone)));
  }
  facts.report.line("joints", fmt::format("{}, {} of them humanoid bones", skeleton.jointCount(), bones.size()));
  if (!bones.empty() && !lacking.empty()) {
    facts.report.line("bones lacking", fmt::format("{}: they stay at rest", fmt::join(lacking, ", ")));
  }
  facts.report.line("motion", standIn ? "performs any humanoid's motion" : "performs motions of its own joints only");
  Json substitutes = Json::array();
  if (standIn && !standIn->substitutes().empty()) {
    std::vector<std::string> words;
    words.reserve(standIn->substitutes().size());
    for (const StandInSkeleton::Substitute& substitute : standIn->substitutes()) {
      words.push_back(inWords(skeleton, substitute));
      Json json = Json::object();
      json["bone"] = std::string(nameOf(substitute.bone));
      if (substitute.joint != kNoJoint) json["joint"] = skeleton.joint(substitute.joint).name;
      json["on"] = skeleton.joint(substitute.on).name;
      substitutes.push_back(std::move(json));
    }
    facts.report.note(
        fmt::format("Bones that are not there, or hang elsewhere, are stood in for: {}.", fmt::join(words, "; ")));
  }
  facts.json["joints"] = skeleton.jointCount();
  facts.json["humanoidBones"] = bones.size();
  facts.json["bones"] = std::move(bones);
  facts.json["retargetable"] = standIn.ok();
  facts.json["standIns"] = std::move(substitutes);
}

void addFile(const CharacterFile& file, Facts& facts) {
  Report& report = facts.report;
  report.line("format", fmt::format("{}: {}, {}, {}", file.format, counted(file.meshes, "mesh", "meshes"),
                                    counted(file.primitives, "primitive"), counted(file.skins, "skin")));
  report.line("unit",
              file.metresPerUnit == 1.0 ? "metres" : fmt::format("{:g} m, taken into account", file.metresPerUnit));
  if (file.morphTargets > 0) report.line("morph targets", fmt::format("{}, at their rest weights", file.morphTargets));
  report.line("weights",
              fmt::format("at most {} a vertex, {}", counted(file.mostInfluences, "bone"),
                          file.mendedVertices == 0 ? "all in order"
                                                   : counted(file.mendedVertices, "vertex", "vertices") + " mended"));
  Json& json = facts.json;
  json["format"] = file.format;
  json["meshes"] = file.meshes;
  json["primitives"] = file.primitives;
  json["skins"] = file.skins;
  json["morphTargets"] = file.morphTargets;
  json["metresPerUnit"] = file.metresPerUnit;
  json["influencesAtMost"] = file.mostInfluences;
  json["verticesMended"] = file.mendedVertices;
}

void addClips(const std::vector<Clip>& clips, Facts& facts) {
  facts.json["clips"] = Json::array();
  for (const Clip& clip : clips) facts.json["clips"].push_back({{"name", clip.name}, {"seconds", clip.seconds}});
  if (clips.empty()) {
    facts.report.line("clips", "none");
    return;
  }
  facts.report.line("clips", fmt::format("{}", clips.size()));
  Table table{{"seconds", "clip"}, {}, 1};
  for (std::size_t i = 0; i < std::min(clips.size(), kClipsShown); ++i) {
    table.rows.push_back({fmt::format("{:.2f}", clips[i].seconds), clips[i].name});
  }
  facts.report.table(std::move(table));
  if (clips.size() > kClipsShown) facts.report.note("The table leaves clips out; --json has all of them.");
}

/// How far what people see and the body are from each other, both ways.
std::string sentence(const BodyDistances& d) {
  return fmt::format(
      "what people see is up to {} outside the body, {} in the mean; the body up to {} off it, {} in the mean",
      millimetres(d.farthestOutside), millimetres(d.meanOutside), millimetres(d.farthestToOriginal),
      millimetres(d.meanToOriginal));
}

Json toJson(const BodyDistances& d) {
  return {{"farthestOutside", d.farthestOutside},
          {"meanOutside", d.meanOutside},
          {"farthestToOriginal", d.farthestToOriginal},
          {"meanToOriginal", d.meanToOriginal}};
}

/// The same over the character's clips: each figure's worst of some poses, spread over all clips; none without clips.
std::optional<BodyDistances> distancesOverClips(const Subject& subject) {
  const Body& body = *subject.body;
  const std::vector<Clip>& clips = subject.file->clips;
  if (!body.made || clips.empty()) return std::nullopt;
  const Character& character = body.character;
  std::vector<Affine3> worldFromModel(static_cast<std::size_t>(character.skeleton.jointCount()));
  BodyDistances worst;
  for (int i = 0; i < kPosesMeasured; ++i) {
    const double at = (i + 0.5) * static_cast<double>(clips.size()) / kPosesMeasured;  // in clips laid end to end
    const Clip& clip = clips[static_cast<std::size_t>(at)];
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

void addBody(const Subject& subject, Facts& facts) {
  const Body& body = *subject.body;
  const std::optional<BodyDistances> posed = distancesOverClips(subject);
  Report& report = facts.report;
  report.line("surface", fmt::format("{}, {}, {}", counted(body.shells, "shell"), counted(body.openEdges, "open edge"),
                                     counted(body.crowdedEdges, "edge") + " of more than two triangles"));
  if (body.made) {
    report.line("body", fmt::format("made, of {} vertices, in voxels of {}: the surface cannot be decomposed as it is",
                                    grouped(body.bodyVertices), millimetres(body.resolution)));
    report.line("in the bind pose", sentence(body.distances));
    if (posed)
      report.line("over its clips",
                  sentence(*posed) + fmt::format(", at worst of {}", counted(kPosesMeasured, "pose")));
  } else {
    report.line("body", "the surface itself: it is closed");
  }
  for (const std::string& note : body.notes) report.note(note);
  Json& json = facts.json["body"];
  json["made"] = body.made;
  json["vertices"] = body.bodyVertices;
  json["resolution"] = body.made ? Json(body.resolution) : Json();
  json["shells"] = body.shells;
  json["openEdges"] = body.openEdges;
  json["crowdedEdges"] = body.crowdedEdges;
  json["bindPose"] = toJson(body.distances);
  json["clips"] = posed ? toJson(*posed) : Json();
  json["notes"] = body.notes;
}

}  // namespace

Facts describeCharacter(const Subject& subject) {
  const Character& character = *subject.character;
  if (!subject.file) {
    Facts facts = describeMesh(subject);
    std::uint32_t most = 0;
    for (std::size_t v = 0; v + 1 < character.influenceBegin.size(); ++v) {
      most = std::max(most, character.influenceBegin[v + 1] - character.influenceBegin[v]);
    }
    facts.report.line("height", fmt::format("{:.3f} m", character.height));
    facts.report.line("influences", fmt::format("at most {} a vertex", most));
    facts.json["height"] = character.height;
    facts.json["influencesAtMost"] = most;
    addSkeleton(character, facts);
    return facts;
  }
  const CharacterFile& file = *subject.file;
  const TriMesh& mesh = file.character.mesh;
  Facts facts{Report(subject.name + ": a character"), {}};
  Json& json = facts.json;
  json["kind"] = "character";
  json["name"] = subject.name;
  json["vertices"] = mesh.vertices.size();
  json["triangles"] = mesh.triangles.size();
  json["height"] = character.height;
  addFile(file, facts);
  facts.report.line("mesh", fmt::format("{} vertices, {} triangles", grouped(std::ssize(mesh.vertices)),
                                        grouped(std::ssize(mesh.triangles))));
  facts.report.line("height", fmt::format("{:.3f} m", character.height));
  addSkeleton(character, facts);
  addBody(subject, facts);
  addClips(file.clips, facts);
  for (const std::string& note : file.notes) facts.report.note(note);
  json["notes"] = file.notes;
  return facts;
}

}  // namespace lorica
