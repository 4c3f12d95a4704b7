#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/interrupt.h"
#include "geometry/text.h"
#include "skinning/humanoid/humanoid.h"
#include "skinning/import/bind_frames.h"
#include "skinning/import/character_parts.h"
#include "skinning/import/file_scene.h"
#include "skinning/morphs/shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <numbers>
#include <utility>

namespace lorica {

namespace {

constexpr double kSecondsInADay = 86400.0;
constexpr std::size_t kMaxKept = 100'000;  // tracks of joints that a clip does not move, of 0.5 kB each

/// Converts a FileScene to a CharacterFile, phase by phase.
class CharacterBuilder {
 public:
  /// @param hidden  counts for the file's unit alone
  CharacterBuilder(FileScene scene, std::span<const FileMesh> hidden, const std::string& fileName)
      : scene_(std::move(scene)), hidden_(hidden), fileName_(fileName), frames_(findBindFrames(scene_)) {}

  [[nodiscard]] Result<CharacterFile> build() {
    out_.format = scene_.format;
    out_.meshes = scene_.meshCount;
    out_.meshNames = meshNamesOf(scene_);
    out_.primitives = scene_.primitiveCount;
    out_.skins = countOf(scene_.skins);
    out_.morphTargets = scene_.morphTargetCount;
    out_.notes = scene_.notes;
    out_.character.name = std::filesystem::path(fileName_).stem().string();

    placeMeshes();
    chosen_ = movingNodes(scene_);
    LORICA_TRY_DO(chooseUnits());
    addJoints();
    for (const auto step : {&CharacterBuilder::addVertices, &CharacterBuilder::addLook, &CharacterBuilder::addMorphs,
                            &CharacterBuilder::addClips}) {
      if (workStopped()) return cancelled();
      (this->*step)();
    }
    LORICA_TRY_DO(finish());
    return unlessStopped<CharacterFile>(std::move(out_));
  }

 private:
  [[nodiscard]] Error bad(const std::string& what) const { return badFormat(fileName_ + ": " + what); }

  [[nodiscard]] const Affine3& fileFromMesh(const FileMesh& mesh) const {
    return mesh.skin != -1 ? frames_.fileFromSkin[mesh.skin] : frames_.fileFromNode[mesh.node];
  }

  // 1. Vertices in the bind pose, still in the file's units.
  void placeMeshes() {
    std::size_t vertexCount = 0;
    std::size_t triangleCount = 0;
    for (const FileMesh& mesh : scene_.meshes) {
      vertexCount += mesh.positions.size();
      triangleCount += mesh.triangles.size();
    }
    TriMesh& all = out_.character.mesh;
    all.vertices.reserve(vertexCount);
    all.triangles.reserve(triangleCount);
    for (const FileMesh& mesh : scene_.meshes) {
      const Affine3& fileFrom = fileFromMesh(mesh);
      const VertexIndex first = all.vertices.size();
      for (const Vec3& p : mesh.positions) all.vertices.push_back(fileFrom * p);
      // A mirrored mesh is inside out.
      const bool mirrored = fileFrom.linear().determinant() < 0.0;
      for (Triangle triangle : mesh.triangles) {
        for (VertexIndex& v : triangle) v += first;
        if (mirrored) std::swap(triangle[1], triangle[2]);
        all.triangles.push_back(triangle);
      }
    }
    box_ = boundsOf(all.vertices);
  }

  // 2. The file's unit, by the size of its mesh, or of its skeleton.
  [[nodiscard]] Result<void> chooseUnits() {
    Aabb box = box_;
    for (const FileMesh& mesh : hidden_) {
      for (const Vec3& p : mesh.positions) box.extend(fileFromMesh(mesh) * p);
    }
    if (box.empty()) {
      for (const std::size_t i : nodesThatShowSize()) box.extend(frames_.fileFromNode[i].translation());
    }
    const double longest = box.empty() ? 0.0 : (box.max - box.min).maxCoeff();
    if (!std::isfinite(longest)) return bad("its bind pose is not finite");
    UnitGuess guess = guessUnit(longest, scene_.metresPerUnit);
    if (!guess.note.empty()) out_.notes.push_back(std::move(guess.note));
    out_.metresPerUnit = guess.metresPerUnit;
    if (frames_.posedNodes > 0) {
      out_.notes.push_back(
          fmt::format("its nodes are posed, {} in all, by up to {:.0f} degrees and {:.0f} cm from its skin's bind "
                      "pose, which is used",
                      frames_.posedNodes, frames_.posedTurn * 180.0 / std::numbers::pi,
                      100.0 * out_.metresPerUnit * frames_.posedMove));
    }
    if (frames_.scaledNodes > 0) {
      out_.notes.push_back(
          fmt::format("the inverse bind matrices of {} nodes have a scale or shear that the nodes lack: "
                      "the bind pose keeps it",
                      frames_.scaledNodes));
    }
    return {};
  }

  /// For a file with only motion: the animated nodes, if there are any, since a camera may be far away.
  [[nodiscard]] std::vector<std::size_t> nodesThatShowSize() const {
    std::vector<char> moves(scene_.nodes.size(), 0);
    for (const FileClip& clip : scene_.clips) {
      for (const FileTrack& track : clip.tracks) moves[track.node] = 1;
    }
    std::vector<std::size_t> moving;
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < scene_.nodes.size(); ++i) {
      if (chosen_[i] == 0) continue;
      all.push_back(i);
      if (moves[i] != 0) moving.push_back(i);
    }
    return moving.empty() ? all : moving;
  }

  // 3. A joint for each chosen node.
  void addJoints() {
    const std::size_t chosenCount = std::count(chosen_.begin(), chosen_.end(), 1);
    joints_.reserve(chosenCount + 1);
    jointFromFile_.reserve(chosenCount + 1);
    JointTransform modelFromFile;
    modelFromFile.rotation = scene_.modelFromFileAxes;
    modelFromFile.scale.setConstant(out_.metresPerUnit);
    joints_.push_back({"(file)", kNoJoint, modelFromFile, std::nullopt});
    jointFromFile_.push_back(Affine3::Identity());
    jointsOfNode_.resize(scene_.nodes.size());

    int sheared = 0;
    for (const int n : frames_.order) {
      const std::size_t i = n;
      if (chosen_[i] == 0) continue;
      const FileNode& node = scene_.nodes[i];
      JointIndex parent = node.parent == -1 ? 0 : jointsOfNode_[node.parent].front();
      JointTransform local = frames_.local[i];
      if (frames_.inner[i]) {
        ++sheared;
        joints_.push_back({node.name + " (sheared)", parent, local, std::nullopt});
        jointFromFile_.push_back(*frames_.inner[i] * frames_.fileFromNode[i].inverse());
        parent = countOf(joints_) - 1;
        local = {};
        local.rotation = *frames_.inner[i];
      }
      jointsOfNode_[i].push_back(countOf(joints_));
      joints_.push_back({node.name, parent, local, std::nullopt});
      jointFromFile_.push_back(frames_.fileFromNode[i].inverse());
    }
    for (const auto& [bone, node] : scene_.bones) {
      joints_[jointsOfNode_[node].front()].bone = bone;
    }
    if (sheared > 0) {
      out_.notes.push_back(counted(sheared, "node is", "nodes are") + " sheared: each is represented by two joints");
    }
  }

  /// The joint for a node and an inverse bind matrix: the node's own joint, or an additional one.
  [[nodiscard]] JointIndex jointFor(int node, const Affine3& jointFromFile) {
    const std::size_t n = node;
    for (const JointIndex joint : jointsOfNode_[n]) {
      if (carrySame(frames_.fileFromNode[n], jointFromFile, jointFromFile_[joint])) {
        return joint;
      }
    }
    const JointIndex own = jointsOfNode_[n].front();
    const std::string name = fmt::format("{} (bind {})", joints_[own].name, jointsOfNode_[n].size() + 1);
    const JointIndex copy = countOf(joints_);
    joints_.push_back({name, own, {}, std::nullopt});
    jointFromFile_.push_back(jointFromFile);
    jointsOfNode_[n].push_back(copy);
    ++copies_;
    return copy;
  }

  /// Whether two inverse bind matrices map the whole bind pose to the same positions, within the precision of floats.
  [[nodiscard]] bool carrySame(const Affine3& fileFromJoint, const Affine3& a, const Affine3& b) const {
    const Eigen::Matrix<double, 3, 4> difference =
        fileFromJoint.linear() * (a.matrix().topRows<3>() - b.matrix().topRows<3>());
    for (int corner = 0; corner < 8; ++corner) {
      Eigen::Vector4d p(0.0, 0.0, 0.0, 1.0);
      for (int axis = 0; axis < 3; ++axis) p[axis] = (corner >> axis & 1) != 0 ? box_.max[axis] : box_.min[axis];
      if (!((difference * p).norm() <= 2e-6 * box_.diagonal())) return false;
    }
    return true;
  }

  // 4. Vertices and their weights.
  void addVertices() {
    Character& character = out_.character;
    const Affine3 modelFromFile(joints_.front().rest.matrix());
    for (Vec3& p : character.mesh.vertices) p = modelFromFile * p;
    character.influenceBegin.reserve(character.mesh.vertices.size() + 1);
    character.influenceBegin.push_back(0);
    for (const FileMesh& mesh : scene_.meshes) {
      if (mesh.skin == -1) {
        const JointIndex joint = jointsOfNode_[mesh.node].front();
        for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
          character.influences.push_back({joint, 1.0});
          character.influenceBegin.push_back(character.influences.size());
        }
        if (!mesh.positions.empty()) out_.maxInfluences = std::max(out_.maxInfluences, 1);
      } else {
        addSkinned(mesh);
      }
    }
    character.jointFromModel.reserve(joints_.size());
    const Affine3 fileFromModel = modelFromFile.inverse();
    for (const Affine3& jointFromFile : jointFromFile_) {
      character.jointFromModel.emplace_back(jointFromFile * fileFromModel);
    }
    if (out_.repairedVertices > 0) {
      out_.notes.push_back(
          counted(out_.repairedVertices, "vertex", "vertices") +
          " had weights that do not sum to 1, are negative or not finite, or refer to no bone: repaired");
    }
    if (copies_ > 0) {
      out_.notes.push_back(counted(copies_, "joint") + " added for bones with more than one bind matrix");
    }
  }

  void addSkinned(const FileMesh& mesh) {
    Character& character = out_.character;
    const std::size_t s = mesh.skin;
    const FileSkin& skin = scene_.skins[s];
    const Affine3 skinFromFile = frames_.fileFromSkin[s].inverse();
    std::vector<JointIndex> jointOfBone(skin.nodes.size(), kNoJoint);
    const auto jointOf = [&](std::size_t bone) {
      if (jointOfBone[bone] == kNoJoint) {
        jointOfBone[bone] = jointFor(skin.nodes[bone], skin.jointFromMesh[bone] * skinFromFile);
      }
      return jointOfBone[bone];
    };
    const auto inSkin = [&](const FileWeight& w) { return w.bone >= 0 && w.bone < countOf(skin.nodes); };
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const std::size_t begin = character.influences.size();
      const std::span<const FileWeight> weights =
          std::span(mesh.weights).subspan(mesh.weightBegin[v], mesh.weightBegin[v + 1] - mesh.weightBegin[v]);
      bool repaired = false;
      double sum = 0.0;
      for (const FileWeight& w : weights) {
        if (w.weight == 0.0) continue;
        if (!inSkin(w) || !(w.weight > 0.0) || !std::isfinite(w.weight)) {
          repaired = true;
          continue;
        }
        const JointIndex joint = jointOf(w.bone);
        sum += w.weight;
        const auto same = std::find_if(character.influences.begin() + begin, character.influences.end(),
                                       [&](const Influence& i) { return i.joint == joint; });
        if (same != character.influences.end()) {
          same->weight += w.weight;
        } else {
          character.influences.push_back({joint, w.weight});
        }
      }
      if (!(sum > 1e-12) ||
          !std::isfinite(sum)) {  // no valid weight: the first bone that it refers to, else the skin's first
        character.influences.resize(begin);
        const auto named = std::find_if(weights.begin(), weights.end(), inSkin);
        character.influences.push_back(
            {jointOf(named == weights.end() ? 0 : static_cast<std::size_t>(named->bone)), 1.0});
        sum = 1.0;
        repaired = true;
      }
      repaired = repaired || std::abs(sum - 1.0) > 1e-3;
      for (std::size_t i = begin; i < character.influences.size(); ++i) character.influences[i].weight /= sum;
      out_.maxInfluences = std::max(out_.maxInfluences, static_cast<int>(character.influences.size() - begin));
      out_.repairedVertices += repaired ? 1 : 0;
      character.influenceBegin.push_back(character.influences.size());
    }
  }

  // 5. What the surface looks like. A file without materials has no look.
  void addLook() {
    if (scene_.materials.empty() || scene_.meshes.empty()) return;
    LORICA_CHECK(std::all_of(scene_.meshes.begin(), scene_.meshes.end(),
                             [&](const FileMesh& m) { return m.material < countOf(scene_.materials); }),
                 "the format's reader gives meshes materials that exist");
    Look& look = out_.look;
    look.materials = std::move(scene_.materials);
    look.pictures = std::move(scene_.pictures);
    const std::size_t vertexCount = out_.character.mesh.vertices.size();
    const auto any = [&](const auto& list) {
      return std::ranges::any_of(scene_.meshes, [&](const FileMesh& m) { return !std::invoke(list, m).empty(); });
    };
    if (any(&FileMesh::normals)) look.normals.assign(vertexCount, Vec3f::Zero());
    if (any(&FileMesh::tangents)) look.tangents.assign(vertexCount, Eigen::Vector4f::Zero());
    for (std::size_t set = 0; set < 2; ++set) {
      if (any([&](const FileMesh& m) { return std::span(m.uv[set]); })) {
        look.uv[set].assign(vertexCount, Eigen::Vector2f::Zero());
      }
    }
    if (any(&FileMesh::colors)) look.colors.assign(vertexCount, Eigen::Vector4f::Ones());

    const Mat3 modelFromFile = joints_.front().rest.matrix().linear();
    std::size_t vertex = 0;
    std::size_t triangle = 0;
    int plain = -1;               // the material of meshes without one
    std::array<int, 3> mended{};  // meshes, by ContraryNormals
    for (FileMesh& mesh : scene_.meshes) {
      addDirections(mesh, modelFromFile * fileFromMesh(mesh).linear(), vertex);
      for (std::size_t set = 0; set < 2; ++set)
        std::copy(mesh.uv[set].begin(), mesh.uv[set].end(), look.uv[set].begin() + at(vertex, look.uv[set]));
      std::copy(mesh.colors.begin(), mesh.colors.end(), look.colors.begin() + at(vertex, look.colors));
      int material = mesh.material;
      if (material < 0) {
        if (plain == -1) {
          plain = countOf(look.materials);
          look.materials.emplace_back().name = "(none)";
        }
        material = plain;
      }
      look.groups.push_back({mesh.name, material, triangle, mesh.triangles.size(), mesh.normals.empty()});
      if (!mesh.normals.empty()) {
        mendNormals(look.groups.back());
        ++mended[static_cast<std::size_t>(mendContraryNormals(
            out_.character.mesh.vertices,
            std::span(out_.character.mesh.triangles).subspan(triangle, mesh.triangles.size()), look.normals))];
      }
      vertex += mesh.positions.size();
      triangle += mesh.triangles.size();
    }
    const auto note = [&](ContraryNormals kind, const char* what) {
      const int count = mended[static_cast<std::size_t>(kind)];
      if (count > 0)
        out_.notes.push_back(
            fmt::format("in {} of {} {}", count, counted(std::ssize(scene_.meshes), "mesh", "meshes"), what));
    };
    note(ContraryNormals::kNormalsReplaced, "the normals contradict the triangles: recomputed");
    note(ContraryNormals::kTrianglesTurned,
         "the triangles contradict each other and the normals: turned as the normals say");
  }

  /// The position of a vertex in a list that is empty if no vertex has the property.
  template <typename List>
  [[nodiscard]] static std::ptrdiff_t at(std::size_t vertex, const List& list) {
    return list.empty() ? 0 : static_cast<std::ptrdiff_t>(vertex);
  }

  /// Normals and tangents in model space.
  void addDirections(const FileMesh& mesh, const Mat3& modelFromMesh, std::size_t firstVertex) {
    Look& look = out_.look;
    // Proportional to the inverse transpose, and defined for every matrix.
    Mat3 cofactors;
    cofactors.col(0) = modelFromMesh.col(1).cross(modelFromMesh.col(2));
    cofactors.col(1) = modelFromMesh.col(2).cross(modelFromMesh.col(0));
    cofactors.col(2) = modelFromMesh.col(0).cross(modelFromMesh.col(1));
    const double mirror = modelFromMesh.determinant() < 0.0 ? -1.0 : 1.0;
    for (std::size_t v = 0; v < mesh.normals.size(); ++v) {
      const Vec3 normal = mirror * (cofactors * mesh.normals[v].cast<double>());
      look.normals[firstVertex + v] = normal.stableNormalized().cast<float>();
    }
    for (std::size_t v = 0; v < mesh.tangents.size(); ++v) {
      const Vec3 tangent = modelFromMesh * mesh.tangents[v].head<3>().cast<double>();
      look.tangents[firstVertex + v] << tangent.stableNormalized().cast<float>(),
          static_cast<float>(mirror) * mesh.tangents[v].w();
    }
  }

  /// Vertices of smooth groups whose normal has no direction get the mean of their triangles', weighted by area.
  void mendNormals(const LookGroup& group) {
    const TriMesh& mesh = out_.character.mesh;
    std::map<VertexIndex, Vec3> mended;
    const std::span<const Triangle> triangles =
        std::span(mesh.triangles).subspan(group.firstTriangle, group.triangleCount);
    for (const Triangle& t : triangles) {
      for (const VertexIndex v : t) {
        if (!out_.look.normals[v].isZero()) continue;
        mended.emplace(v, Vec3::Zero()).first->second += areaNormal(mesh.vertices, t);
      }
    }
    for (const auto& [v, sum] : mended) {
      out_.look.normals[v] = sum.stableNormalized().cast<float>();
    }
  }

  /// The joint that clips move as a node: of a node that is sheared in the bind pose alone the first of its two.
  [[nodiscard]] JointIndex movedBy(std::size_t node) const {
    const JointIndex own = jointsOfNode_[node].front();
    return frames_.inner[node] && !scene_.nodes[node].inner ? joints_[own].parent : own;
  }

  /// What a clip does not move stays as the file has it, also where its skin's bind pose is another one; but a node
  /// that only its matrix knows the size of stays in the bind pose.
  void keepSaved(Clip& clip) const {
    std::vector<JointTrack*> trackOf(joints_.size(), nullptr);
    clip.tracks.reserve(clip.tracks.size() + joints_.size());  // keeps the pointers
    for (JointTrack& track : clip.tracks) trackOf[track.joint] = &track;
    const auto keep = [&](JointIndex joint, const JointTransform& saved) {
      if (saved.matrix().isApprox(joints_[joint].rest.matrix(), 1e-12)) return;
      if (trackOf[joint] == nullptr) trackOf[joint] = &clip.tracks.emplace_back(JointTrack{joint, {}, {}, {}});
      const auto fill = [](auto& keys, const auto& value) {
        if (!keys) keys = {KeyInterpolation::kStep, {0.0}, {value}};
      };
      fill(trackOf[joint]->translation, saved.translation);
      fill(trackOf[joint]->rotation, saved.rotation);
      fill(trackOf[joint]->scale, saved.scale);
    };
    for (std::size_t n = 0; n < jointsOfNode_.size(); ++n) {
      if (jointsOfNode_[n].empty() || frames_.scaledByMatrix[n] != 0) continue;
      const JointIndex own = jointsOfNode_[n].front();
      const JointIndex first = frames_.inner[n] ? joints_[own].parent : own;
      keep(first, scene_.nodes[n].local);
      JointTransform inner;
      inner.rotation = scene_.nodes[n].inner.value_or(Quat::Identity());
      if (first != own) keep(own, inner);
    }
  }

  // 6. Morph targets, and clips of the existing joints.
  void addMorphs() { out_.morphs = makeMorphs(scene_, frames_, Affine3(joints_.front().rest.matrix())); }
  void addClips() {
    int tooLong = 0;
    std::size_t kept = 0;
    out_.clips.reserve(scene_.clips.size());
    for (const FileClip& from : scene_.clips) {
      Clip clip{from.name, 0.0, {}};
      for (const FileTrack& track : from.tracks) {
        const std::vector<JointIndex>& joints = jointsOfNode_[track.node];
        if (joints.empty()) continue;
        clip.tracks.push_back({movedBy(track.node), track.translation, track.rotation, track.scale});
        const auto last = [&](const auto& keys) {
          if (keys) clip.seconds = std::max(clip.seconds, keys->times.back());
        };
        last(track.translation);
        last(track.rotation);
        last(track.scale);
      }
      for (const MorphWeightTrack& track : from.weights) clip.seconds = std::max(clip.seconds, track.times.back());
      if (clip.seconds > kSecondsInADay) {
        ++tooLong;
      } else if (!clip.tracks.empty() || !from.weights.empty()) {
        if (frames_.posed && !clip.tracks.empty() && kept < kMaxKept) {
          keepSaved(clip);
          kept += joints_.size();
        }
        out_.clips.push_back(std::move(clip));
        out_.morphs.clips.push_back(from.weights);
      }
    }
    if (tooLong > 0) out_.notes.push_back(counted(tooLong, "clip lasts", "clips last") + " longer than a day: skipped");
  }

  // 7. Humanoid bones, size, and the final check.
  [[nodiscard]] Result<void> finish() {
    Character& character = out_.character;
    if (character.mesh.triangles.empty() && out_.clips.empty() && scene_.skins.empty()) {
      return bad("no triangles, no bones and no motion, expected a character");
    }
    out_.nodeOfJoint.assign(joints_.size(), -1);
    for (std::size_t n = 0; n < jointsOfNode_.size(); ++n) {
      if (!jointsOfNode_[n].empty()) out_.nodeOfJoint[jointsOfNode_[n].front()] = n;
    }
    Result<Skeleton> skeleton = Skeleton::create(std::move(joints_));
    if (!skeleton) return bad(skeleton.error().message);
    if (lacksBones(scene_)) {
      const HumanoidGuess guess = guessHumanoid(*skeleton);
      const auto found = std::ranges::count_if(guess.jointOf, [](JointIndex joint) { return joint != kNoJoint; }) -
                         std::ssize(scene_.bones);
      if (scene_.format.starts_with("VRM") && found > 0) {
        out_.notes.push_back(fmt::format(
            "its humanoid maps {} were found by {}",
            scene_.bones.empty() ? fmt::format("no bone: {}", found)
                                 : fmt::format("{}: {} more", counted(countOf(scene_.bones), "bone"), found),
            guess.by));
      }
      for (const BoneDoubt& doubt : guess.doubts) out_.notes.push_back("unsure of " + inWords(doubt));
      character.skeleton = withBones(*skeleton, guess);
    } else {
      character.skeleton = std::move(*skeleton);
    }
    addSprings();
    addFace();
    if (character.mesh.vertices.empty()) return {};

    const Aabb box = boundsOf(character.mesh.vertices);
    character.height = box.max.y() - box.min.y();
    if (std::abs(box.min.y()) > 0.01 * character.height) {
      out_.notes.push_back(
          fmt::format("its lowest point in the bind pose is at y = {:.3f} m, not on the floor", box.min.y()));
    }
    if (addShapes(character, out_.clips, out_.morphs, out_.expressions) == kTooManyShapes) {
      out_.notes.emplace_back(
          "its clips deform it by too many morph targets, bones and keys to follow: the hulls hold all "
          "that they reach");
    }
    out_.nodeOfJoint.resize(character.skeleton.jointCount(), -1);
    if (Result<void> sound = checkCharacter(character); !sound) return bad(sound.error().message);
    return {};
  }

  /// Springs and constraints with joints instead of nodes, and in metres.
  void addSprings() {
    const auto jointOf = [&](int node) { return jointsOfNode_[node].front(); };
    out_.springs = withJoints(scene_.springs, jointOf);
    const Skeleton& skeleton = out_.character.skeleton;
    for (const JointIndex joint : orderConstraints(skeleton, out_.springs.constraints)) {
      out_.notes.push_back(
          fmt::format("springs: the constraint of '{}' depends on itself: skipped", skeleton.joint(joint).name));
    }
    if (const Result<void> sound = checkSprings(skeleton, out_.springs); !sound) {
      out_.notes.push_back("springs: " + sound.error().message + ": all are skipped");
      out_.springs = {};
    }
  }

  void addFace() {
    std::vector<JointIndex> jointOfNode(scene_.nodes.size(), kNoJoint);
    for (std::size_t n = 0; n < jointOfNode.size(); ++n) {
      if (!jointsOfNode_[n].empty()) jointOfNode[n] = jointsOfNode_[n].front();
    }
    out_.expressions = scene_.expressions;
    out_.lookAt = makeLookAt(scene_, out_.character.skeleton, jointOfNode);
  }

  FileScene scene_;  // what is no longer needed is moved out, so that large files do not need twice their memory
  std::span<const FileMesh> hidden_;
  const std::string& fileName_;
  BindFrames frames_;
  CharacterFile out_;
  Aabb box_;                  // bounds of the bind pose, in the file's units and axes
  std::vector<char> chosen_;  // one per node
  std::vector<Joint> joints_;
  std::vector<Affine3> jointFromFile_;                 // one per joint
  std::vector<std::vector<JointIndex>> jointsOfNode_;  // the node's own first, then its copies; empty if not chosen
  int copies_ = 0;
};

}  // namespace

Result<CharacterFile> makeCharacterFile(FileScene scene, const std::string& fileName,
                                        const CharacterFileSettings& settings) {
  LORICA_TRY(const std::vector<FileMesh> hidden, takeHiddenMeshes(scene, settings.hidden, fileName));
  hangFlatBones(scene);
  addRigidSkin(scene);
  return CharacterBuilder(std::move(scene), hidden, fileName).build();
}

}  // namespace lorica
