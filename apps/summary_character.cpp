#include "apps/file_summary.h"
#include "apps/report_parts.h"
#include "capture/retarget/proxy_skeleton.h"
#include "geometry/text.h"
#include "session/prepare/cast.h"
#include "session/prepare/first_guess.h"
#include "session/prepare/subject.h"
#include "skinning/linear_blend.h"
#include "skinning/look/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace lorica {
namespace {

constexpr std::size_t kRowsShown = 12;
constexpr std::size_t kNamesShown = 24;
constexpr int kSuggestedSize = 1024;  // if no texture size is given

const char* nameOf(Shading shading) {
  return shading == Shading::kToon ? "MToon" : shading == Shading::kUnlit ? "unlit" : "metallic-roughness";
}

const char* nameOf(AlphaMode mode) {
  return mode == AlphaMode::kBlend ? "blended" : mode == AlphaMode::kMask ? "masked" : "opaque";
}

/// Material::textures() in words.
constexpr std::array kTextureNames = {"base colour",   "metallic-roughness", "normal", "occlusion", "emissive",
                                      "shade",         "shading shift",      "matcap", "rim",       "outline width",
                                      "animation mask"};

std::vector<std::string> texturesOf(const Material& material) {
  const auto uses = material.textures();
  static_assert(kTextureNames.size() == std::tuple_size_v<decltype(material.textures())>);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    if (uses[i]->given()) names.emplace_back(kTextureNames[i]);
  }
  return names;
}

/// Memory of a texture with its smaller copies, which add a third [bytes].
std::size_t bytesOf(PictureSize size, int textureSize) {
  const PictureSize limited = limitedSize(size, textureSize);
  return static_cast<std::size_t>(limited.width) * limited.height * 4 / 3 * 4;
}

std::string textureSizeInWords(std::size_t bytes) {
  return fmt::format("{:.1f} MB", bytes * 1e-6);
}

void addMaterials(const Look& look, Report& report) {
  std::vector<std::size_t> triangles(look.materials.size(), 0);
  for (const LookGroup& group : look.groups) triangles[group.material] += group.triangleCount;
  Table table{{"triangles", "material", "kind", "alpha", "textures"}, {}, 1};
  Json json = Json::array();
  for (std::size_t m = 0; m < look.materials.size(); ++m) {
    if (triangles[m] == 0) continue;
    const Material& material = look.materials[m];
    const std::vector<std::string> textures = texturesOf(material);
    json.push_back({{"name", material.name},
                    {"kind", nameOf(material.shading)},
                    {"alpha", nameOf(material.alpha)},
                    {"doubleSided", material.doubleSided},
                    {"triangles", triangles[m]},
                    {"textures", textures}});
    table.rows.push_back({grouped(triangles[m]), material.name, nameOf(material.shading), nameOf(material.alpha),
                          fmt::format("{}", fmt::join(textures, ", "))});
  }
  report.add("materials", "materials", std::move(json), std::to_string(table.rows.size()));
  report.table(std::move(table), kRowsShown, "materials");
}

void addPictures(const Look& look, int textureSize, Report& report) {
  Json json = Json::array();
  if (look.pictures.empty()) return report.add("pictures", std::move(json));
  Table table{{"width", "height", "kB in the file", "picture"}, {}, 3};
  const int reduced = textureSize > 0 ? textureSize : kSuggestedSize;
  std::size_t stored = 0;
  std::size_t limited = 0;
  std::size_t broken = 0;
  for (const StoredPicture& picture : look.pictures) {
    const Result<PictureSize> size = readPictureSize(picture.bytes, picture.name);
    Json one = {{"name", picture.name}, {"bytes", picture.bytes.size()}};
    if (size) {
      one["width"] = size->width;
      one["height"] = size->height;
      stored += bytesOf(*size, 0);
      limited += bytesOf(*size, reduced);
    } else {
      one["problem"] = size.error().message;
      if (++broken <= 3) report.note(size.error().message + ".");
    }
    json.push_back(std::move(one));
    if (!size) continue;
    table.rows.push_back({fmt::format("{}", size->width), fmt::format("{}", size->height),
                          fmt::format("{:.0f}", picture.bytes.size() * 1e-3), picture.name});
  }
  std::string memory =
      fmt::format("{}, {} on the GPU", counted(std::ssize(look.pictures), "picture"), textureSizeInWords(stored));
  if (limited < stored) memory += fmt::format(", {} with --texture-size {}", textureSizeInWords(limited), reduced);
  report.add("pictures", std::move(json));
  report.add("textureBytes", "textures", stored, memory);
  report.add("reducedTextureBytes", {{"textureSize", reduced}, {"bytes", limited}});
  if (!table.rows.empty()) report.table(std::move(table), kRowsShown, "pictures");
  if (broken > 3) report.note(fmt::format("{} pictures cannot be read; --json says why.", broken));
}

/// Materials and pictures, and the memory of the textures.
/// @param textureSize  largest side of textures [pixels]; 0 = as stored
void addLook(const Look& look, int textureSize, Report& report) {
  if (!look.given()) {
    report.add("materials", "materials", Json::array(), "none: drawn in plain grey");
    report.add("pictures", Json::array());
    return;
  }
  addMaterials(look, report);
  addPictures(look, textureSize, report);
}

/// Names of meshes, as --hide takes them.
void addMeshNames(std::span<const MeshName> meshes, Report& report) {
  Json json = Json::array();
  std::vector<std::string> names;
  for (const MeshName& mesh : meshes) {
    json.push_back({{"node", mesh.node}, {"mesh", mesh.mesh}});
    names.push_back(mesh.text());
  }
  const std::size_t more = names.size() - std::min(names.size(), kNamesShown);
  names.resize(names.size() - more);
  report.add("meshNames", "mesh names", std::move(json),
             fmt::format("{}{}", fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : ""));
}

void addSprings(const SpringBones& springs, Report& report) {
  report.add("springs", "springs",
             {{"chains", springs.chains.size()},
              {"joints", springs.springCount()},
              {"colliders", springs.colliders.size()},
              {"constraints", springs.constraints.size()}},
             springs.chains.empty() ? ""
                                    : fmt::format("{} with {}, {}", counted(std::ssize(springs.chains), "strand"),
                                                  counted(springs.springCount(), "joint"),
                                                  counted(std::ssize(springs.colliders), "collider")));
  if (!springs.constraints.empty()) {
    report.line("constraints",
                counted(std::ssize(springs.constraints), "joint follows another", "joints follow others"));
  }
}

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

void addSkeleton(const Character& character, Report& report) {
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
  report.add("joints", "joints", skeleton.jointCount(),
             fmt::format("{}, {}", skeleton.jointCount(),
                         counted(std::int64_t(bones.size()), "of them a humanoid bone", "of them humanoid bones")));
  report.add("humanoidBones", bones.size());
  if (!bones.empty() && !lacking.empty()) {
    report.line("missing bones", fmt::format("{} (they stay at rest)", fmt::join(lacking, ", ")));
  }
  report.add("bones", std::move(bones));
  report.add("retargetable", "motion", proxy.ok(),
             proxy ? "accepts any humanoid motion" : "accepts only motions of its own joints");
  Json substitutes = Json::array();
  if (proxy && !proxy->substitutes().empty()) {
    std::vector<std::string> words;
    words.reserve(proxy->substitutes().size());
    for (const ProxySkeleton::Substitute& substitute : proxy->substitutes()) {
      words.push_back(inWords(skeleton, substitute));
      Json json = {{"bone", nameOf(substitute.bone)}};
      if (substitute.joint != kNoJoint) json["joint"] = skeleton.joint(substitute.joint).name;
      json["on"] = skeleton.joint(substitute.on).name;
      substitutes.push_back(std::move(json));
    }
    report.note(
        fmt::format("Substitutes for bones that are missing or attached elsewhere: {}.", fmt::join(words, "; ")));
  }
  for (const std::string& sentence : leftBehind(character)) report.note(sentence);
  report.add("substitutes", std::move(substitutes));
}

void addFile(const CharacterFile& file, Report& report) {
  report.add("format", "format", file.format,
             fmt::format("{}: {}, {}, {}", file.format, counted(file.meshes, "mesh", "meshes"),
                         counted(file.primitives, "primitive"), counted(file.skins, "skin")));
  report.add("meshes", file.meshes);
  report.add("primitives", file.primitives);
  report.add("skins", file.skins);
  report.add("metresPerUnit", "unit", file.metresPerUnit,
             file.format == kSequence    ? "that of its files, taken for metres"
             : file.metresPerUnit == 1.0 ? "metres"
                                         : fmt::format("{:g} m, converted", file.metresPerUnit));
  report.add(
      "maxInfluences", "weights", file.maxInfluences,
      fmt::format("at most {} per vertex, {}", counted(file.maxInfluences, "bone"),
                  file.repairedVertices == 0 ? "all valid"
                                             : counted(file.repairedVertices, "vertex", "vertices") + " repaired"));
  report.add("repairedVertices", file.repairedVertices);
}

void addFace(const CharacterFile& file, Report& report) {
  const std::vector<MorphTarget>& targets = file.morphs.targets;
  const auto clips = std::ranges::count_if(file.morphs.clips, [](const auto& tracks) { return !tracks.empty(); });
  const auto moving = std::ranges::count_if(targets, [](const auto& target) { return !target.offsets.empty(); });
  report.add(
      "morphTargets", "morph targets", file.morphTargets,
      file.morphTargets == 0
          ? ""
          : fmt::format("{}, {} something{}", file.morphTargets, counted(moving, "of them moves", "of them move"),
                        clips == 0 ? "" : fmt::format("; {} them", counted(clips, "clip moves", "clips move"))));
  Json expressions = Json::array();
  for (const Expression& expression : file.expressions.list) {
    Json one = {{"name", expression.name}, {"targets", Json::object()}};
    for (const MorphBind& bind : expression.morphs) one["targets"][targets[bind.target].name] = bind.weight;
    expressions.push_back(std::move(one));
  }
  report.add("expressions", "expressions", std::move(expressions),
             file.expressions.list.empty() ? "" : namesOf(file.expressions, kExpressionsShown));
  const LookAtKind looks = file.lookAt.kind;
  const char* gaze = looks == LookAtKind::kBone ? "bones" : looks == LookAtKind::kExpression ? "expressions" : "none";
  report.add("lookAt", "look-at", gaze, looks == LookAtKind::kNone ? "" : fmt::format("by {}", gaze));
}

void addClips(const std::vector<Clip>& clips, Report& report) {
  Json json = Json::array();
  Table table{{"seconds", "clip"}, {}, 1};
  for (const Clip& clip : clips) {
    json.push_back({{"name", clip.name}, {"seconds", clip.seconds}});
    table.rows.push_back({fmt::format("{:.2f}", clip.seconds), clip.name});
  }
  report.add("clips", "clips", std::move(json), clips.empty() ? "none" : std::to_string(clips.size()));
  if (!clips.empty()) report.table(std::move(table), kClipsShown, "clips");
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

/// Why a body was made in place of a surface: the first of what is so. Empty if it was only asked for.
std::string whyMade(const ClosedBody& body) {
  if (body.openEdges > 0 || !body.walls.empty()) return ", since its surface is open";
  if (body.nonManifoldEdges > 0) return ", since more than two triangles of its surface meet at an edge";
  return body.shells > 1 ? ", since its shells may lie in each other" : "";
}

void addBody(const Subject& subject, Report& report) {
  const ClosedBody& body = *subject.body;
  const std::optional<BodyDistances> posed = distancesOverClips(subject);
  report.line("surface", fmt::format("{}, {}, {}", counted(body.shells, "shell"), counted(body.openEdges, "open edge"),
                                     counted(body.nonManifoldEdges, "non-manifold edge")));
  if (body.made) {
    report.line("body", fmt::format("{}, {} vertices{}",
                                    body.resolution > 0.0 ? "made from voxels of " + millimetres(body.resolution)
                                                          : std::string("thin walls"),
                                    grouped(body.bodyVertices), whyMade(body)));
    report.line("bind pose", sentence(body.distances));
    if (posed)
      report.line("own clips", sentence(*posed) + fmt::format(" (maximum of {})", counted(kPosesMeasured, "pose")));
  } else {
    report.line("body", "the surface itself, which is closed");
  }
  for (const std::string& note : body.notes) report.note(note);
  report.add("body", {{"made", body.made},
                      {"vertices", body.bodyVertices},
                      {"resolution", body.made ? Json(body.resolution) : Json()},
                      {"shells", body.shells},
                      {"openEdges", body.openEdges},
                      {"nonManifoldEdges", body.nonManifoldEdges},
                      {"bindPose", toJson(body.distances)},
                      {"clips", posed ? toJson(*posed) : Json()},
                      {"notes", body.notes}});
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
  if (subject.body->made) does.push_back("its hulls are those of a body that was made" + whyMade(*subject.body));
  return fmt::format("works: {}", fmt::join(does, ", "));
}

}  // namespace

Report describeCharacter(const Subject& subject, int textureSize) {
  const Character& character = *subject.character;
  const std::string height = fmt::format("{:.3f} m", character.height);
  if (!subject.file) {
    Report report = describeMesh(subject);
    std::uint32_t max = 0;
    for (std::size_t v = 0; v + 1 < character.influenceBegin.size(); ++v) {
      max = std::max(max, character.influenceBegin[v + 1] - character.influenceBegin[v]);
    }
    report.add("height", "height", character.height, height);
    report.add("maxInfluences", "influences", max, fmt::format("at most {} per vertex", max));
    addSkeleton(character, report);
    return report;
  }
  const CharacterFile& file = *subject.file;
  const TriMesh& mesh = file.character.mesh;
  Report report(subject.name + ": a character", "kind name vertices triangles height");
  report.add("kind", "character");
  report.add("name", subject.name);
  report.add("verdict", "verdict", verdictOf(subject));
  addFile(file, report);
  report.add("vertices", "mesh", mesh.vertices.size(),
             fmt::format("{}, {}", counted(std::ssize(mesh.vertices), "vertex", "vertices"),
                         counted(std::ssize(mesh.triangles), "triangle")));
  report.add("triangles", mesh.triangles.size());
  report.add("height", "height", character.height, height);
  report.add("firstGuess", "first guess", firstGuessOf(file));
  addSkeleton(character, report);
  addBody(subject, report);
  addSprings(file.springs, report);
  addFace(file, report);
  addMeshNames(file.meshNames, report);
  addLook(file.look, textureSize, report);
  addClips(file.clips, report);
  for (const std::string& note : file.notes) report.note(note);
  report.add("notes", file.notes);
  return report;
}

}  // namespace lorica
