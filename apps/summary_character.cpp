#include "apps/file_summary.h"
#include "apps/report_parts.h"
#include "capture/retarget/proxy_skeleton.h"
#include "geometry/text.h"
#include "prepare/cast.h"
#include "prepare/first_guess.h"
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

using Json = nlohmann::ordered_json;

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

std::string megabytes(std::size_t bytes) {
  return fmt::format("{:.1f} MB", bytes * 1e-6);
}

void describeMaterials(const Look& look, Report& report, Json& json) {
  std::vector<std::size_t> triangles(look.materials.size(), 0);
  for (const LookGroup& group : look.groups) triangles[group.material] += group.triangleCount;
  Table table{{"triangles", "material", "kind", "alpha", "textures"}, {}, 1};
  std::size_t count = 0;
  json["materials"] = Json::array();
  for (std::size_t m = 0; m < look.materials.size(); ++m) {
    if (triangles[m] == 0) continue;
    const Material& material = look.materials[m];
    const std::vector<std::string> textures = texturesOf(material);
    json["materials"].push_back({{"name", material.name},
                                 {"kind", nameOf(material.shading)},
                                 {"alpha", nameOf(material.alpha)},
                                 {"doubleSided", material.doubleSided},
                                 {"triangles", triangles[m]},
                                 {"textures", textures}});
    if (count++ >= kRowsShown) continue;
    table.rows.push_back({grouped(triangles[m]), material.name, nameOf(material.shading), nameOf(material.alpha),
                          fmt::format("{}", fmt::join(textures, ", "))});
  }
  report.line("materials", fmt::format("{}", count));
  report.table(std::move(table));
  if (count > kRowsShown) report.note("The table does not show all materials; --json does.");
}

void describePictures(const Look& look, int textureSize, Report& report, Json& json) {
  json["pictures"] = Json::array();
  if (look.pictures.empty()) return;
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
    json["pictures"].push_back(std::move(one));
    if (!size || table.rows.size() >= kRowsShown) continue;
    table.rows.push_back({fmt::format("{}", size->width), fmt::format("{}", size->height),
                          fmt::format("{:.0f}", picture.bytes.size() * 1e-3), picture.name});
  }
  json["textureBytes"] = stored;
  json["reducedTextureBytes"] = {{"textureSize", reduced}, {"bytes", limited}};
  std::string memory =
      fmt::format("{}, {} on the GPU", counted(std::ssize(look.pictures), "picture"), megabytes(stored));
  if (limited < stored) memory += fmt::format(", {} with --texture-size {}", megabytes(limited), reduced);
  report.line("textures", memory);
  const std::size_t readable = look.pictures.size() - broken;
  if (!table.rows.empty()) report.table(std::move(table));
  if (readable > kRowsShown) report.note("The table does not show all pictures; --json does.");
  if (broken > 3) report.note(fmt::format("{} pictures cannot be read; --json says why.", broken));
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

void describeMeshNames(std::span<const MeshName> meshes, Report& report, Json& json) {
  json["meshNames"] = Json::array();
  std::vector<std::string> names;
  for (const MeshName& mesh : meshes) {
    json["meshNames"].push_back({{"node", mesh.node}, {"mesh", mesh.mesh}});
    names.push_back(mesh.text());
  }
  if (names.empty()) return;
  const std::size_t more = names.size() - std::min(names.size(), kNamesShown);
  names.resize(names.size() - more);
  report.line("mesh names",
              fmt::format("{}{}", fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : ""));
}

void describeLook(const Look& look, int textureSize, Report& report, Json& json) {
  if (!look.given()) {
    report.line("materials", "none: drawn in plain grey");
    json["materials"] = Json::array();
    json["pictures"] = Json::array();
    return;
  }
  describeMaterials(look, report, json);
  describePictures(look, textureSize, report, json);
}

}  // namespace lorica
