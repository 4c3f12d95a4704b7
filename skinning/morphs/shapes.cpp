#include "skinning/morphs/shapes.h"

#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/triangle_tree.h"
#include "geometry/work_budgets.h"
#include "skinning/morphs/expressions.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace lorica {
namespace {

constexpr double kFar = 0.02;  // of the mesh's diagonal
// Offsets and keys of shapes, of some 32 bytes each: so many, and so many for each one of the morph targets.
constexpr std::size_t kMostItems = 1'000'000;
constexpr std::size_t kItemsForOne = 4;
constexpr double kNoShare = 1e-9;  // of a corner

/// The joints of one shape: for each bone that moves its vertices.
using JointsOfShape = std::vector<JointIndex>;

std::span<const Influence> influencesAt(const Character& character, std::size_t v) {
  return std::span(character.influences)
      .subspan(character.influenceBegin[v], character.influenceBegin[v + 1] - character.influenceBegin[v]);
}

JointIndex mainJoint(const Character& character, std::size_t v) {
  return std::ranges::max_element(influencesAt(character, v), {}, &Influence::weight)->joint;
}

/// Appends joints and offsets for shapes, in two passes over their vertices.
/// @param targets  null: this one stays as it is
/// @return the joints of each
std::vector<JointsOfShape> appendShapes(Character& character, std::span<const MorphTarget* const> targets) {
  std::vector<Joint> joints(character.skeleton.joints().begin(), character.skeleton.joints().end());
  std::vector<JointsOfShape> made(targets.size());
  std::vector<std::uint32_t>& begin = character.shapes.begin;
  begin.assign(character.mesh.vertices.size() + 1, 0);
  const auto each = [&](const auto& visit) {
    for (std::size_t t = 0; t < targets.size(); ++t) {
      if (targets[t] == nullptr) continue;
      for (const MorphOffset& offset : targets[t]->offsets) {
        if (offset.position.isZero(0.0F)) continue;
        for (const Influence& influence : influencesAt(character, offset.vertex)) visit(t, offset, influence);
      }
    }
  };
  // The joint of each target and bone.
  std::vector<std::pair<std::size_t, JointIndex>> ofBone(joints.size(), {targets.size(), kNoJoint});
  std::vector<JointIndex> jointOfItem;
  each([&](std::size_t t, const MorphOffset& offset, const Influence& influence) {
    auto& [target, joint] = ofBone[influence.joint];
    if (target != t) {
      target = t;
      joint = countOf(joints);
      made[t].push_back(joint);
      joints.push_back({fmt::format("{} (shape {})", joints[influence.joint].name, t), influence.joint, {}, {}});
      character.jointFromModel.push_back(Affine3(character.jointFromModel[influence.joint]));
    }
    jointOfItem.push_back(joint);
    ++begin[offset.vertex + 1];
  });
  for (std::size_t v = 1; v < begin.size(); ++v) begin[v] += begin[v - 1];
  character.shapes.offsets.resize(begin.back());
  std::vector<std::uint32_t> next = begin;
  std::size_t item = 0;
  each([&](std::size_t /*target*/, const MorphOffset& offset, const Influence& influence) {
    character.shapes.offsets[next[offset.vertex]++] = {jointOfItem[item++],
                                                       influence.weight * offset.position.cast<double>()};
  });
  Result<Skeleton> skeleton = Skeleton::create(std::move(joints));
  LORICA_CHECK(skeleton.ok(), "joints without a bone at the end leave a skeleton valid");
  character.skeleton = std::move(*skeleton);
  return made;
}

/// The scale of a shape's joint for the weights of one of a track's targets.
KeyTrack<Vec3> scalesOf(const MorphWeightTrack& track, int target, float defaultWeight) {
  KeyTrack<Vec3> scales{track.interpolation, track.times, {}};
  const std::size_t count = track.targetCount;
  const bool cubic = track.interpolation == KeyInterpolation::kCubicSpline;
  for (std::size_t i = target - track.firstTarget; i < track.values.size(); i += count) {
    const bool tangent = cubic && i / count % 3 != 1;
    const double weight = track.values[i];
    scales.values.emplace_back(Vec3::Constant(tangent ? weight : 1.0 + weight - defaultWeight));
  }
  return scales;
}

}  // namespace

int addShapes(Character& character, std::span<Clip> clips, const Morphs& morphs, const Expressions& expressions) {
  LORICA_CHECK(clips.size() == morphs.clips.size(), "one list of weights for each clip");
  std::vector<const MorphTarget*> moved(morphs.targets.size(), nullptr);
  std::size_t given = 0;  // offsets and keys
  for (const std::vector<MorphWeightTrack>& tracks : morphs.clips) {
    for (const MorphWeightTrack& track : tracks) {
      given += track.values.size();
      for (std::size_t i = 0; i < track.values.size(); ++i) {
        const MorphTarget& target = morphs.targets[track.firstTarget + i % track.targetCount];
        if (track.values[i] != target.defaultWeight) moved[&target - morphs.targets.data()] = &target;
      }
    }
  }
  if (given == 0) return 0;
  const std::vector<float> unset(expressions.list.size(), 0.0F);
  const std::vector<Vec3>& bind = character.mesh.vertices;
  const std::vector<float> sets = usedWeightSets(morphs, expressions, unset);
  if (reachedPositions(morphs, sets, bind, kFar * boundsOf(bind).diagonal()).empty()) return 0;

  // Whether they are worth what they take.
  std::vector<std::size_t> keys(moved.size(), 0);
  for (const std::vector<MorphWeightTrack>& tracks : morphs.clips) {
    for (const MorphWeightTrack& track : tracks) {
      for (int t = 0; t < track.targetCount; ++t)
        keys[track.firstTarget + t] += track.values.size() / track.targetCount;
    }
  }
  std::size_t items = 0, joints = character.jointFromModel.size();
  std::vector<const MorphTarget*> seenBy(joints, nullptr);
  for (std::size_t t = 0; t < moved.size(); ++t) {
    if (moved[t] == nullptr) continue;
    given += moved[t]->offsets.size();
    for (const MorphOffset& offset : moved[t]->offsets) {
      for (const Influence& influence : influencesAt(character, offset.vertex)) {
        ++items;
        if (std::exchange(seenBy[influence.joint], moved[t]) == moved[t]) continue;
        ++joints;
        items += keys[t];
      }
    }
  }
  if (items > kMostItems + kItemsForOne * given || joints > kMaxJoints) return kTooManyShapes;

  const std::vector<JointsOfShape> made = appendShapes(character, moved);
  for (std::size_t c = 0; c < clips.size(); ++c) {
    for (const MorphWeightTrack& track : morphs.clips[c]) {
      for (int t = track.firstTarget; t < track.firstTarget + track.targetCount; ++t) {
        for (const JointIndex joint : made[t]) {
          clips[c].tracks.push_back({joint, {}, {}, scalesOf(track, t, morphs.targets[t].defaultWeight)});
        }
      }
    }
  }
  return static_cast<int>(std::ranges::count_if(made, [](const JointsOfShape& own) { return !own.empty(); }));
}

void carryShapes(const Character& from, std::size_t copiesFrom, Character& body) {
  if (from.shapes.empty()) return;
  const std::vector<bool> used = usedVertices(from.mesh.vertices.size(), from.mesh.triangles);
  std::vector<JointIndex> main(used.size());
  for (std::size_t v = 0; v < main.size(); ++v) main[v] = mainJoint(from, v);
  const TriangleTree tree(from.mesh.vertices, from.mesh.triangles);
  std::size_t copied = 0;
  std::vector<ShapeOffset> blended;
  for (std::size_t v = 0; v < body.mesh.vertices.size(); ++v) {
    if (v >= copiesFrom) {
      while (copied < used.size() && !used[copied]) ++copied;
      if (copied < used.size()) {
        body.shapes.append(from.shapes.of(copied++));
        continue;
      }
    }
    const JointIndex joint = mainJoint(body, v);
    const auto follows = [&](std::int32_t t) {
      return std::ranges::any_of(from.mesh.triangles[t], [&](VertexIndex c) { return main[c] == joint; });
    };
    TriangleTree::Hit hit = tree.nearest(body.mesh.vertices[v], kInfinity, follows);
    if (hit.triangle < 0) hit = tree.nearest(body.mesh.vertices[v]);
    blended.clear();
    for (std::size_t corner = 0; corner < 3; ++corner) {
      if (hit.shares[corner] < kNoShare) continue;
      for (const ShapeOffset& shape : from.shapes.of(from.mesh.triangles[hit.triangle][corner])) {
        const auto same = std::ranges::find(blended, shape.joint, &ShapeOffset::joint);
        if (same == blended.end()) {
          blended.push_back({shape.joint, hit.shares[corner] * shape.offset});
        } else {
          same->offset += hit.shares[corner] * shape.offset;
        }
      }
    }
    body.shapes.append(blended);
  }
}

Result<PlayedMesh> playedMesh(const std::string& name, TriMesh mesh, std::span<const Vec3> frames,
                              std::span<const double> times) {
  const std::size_t vertices = mesh.vertices.size();
  if (vertices == 0 || times.empty() || frames.size() != vertices * times.size()) {
    return invalidArgument("{}: found {} positions for {} frames of {} vertices", name, frames.size(), times.size(),
                           vertices);
  }
  if (times.size() > kMaxJoints) {
    return unsupported("{}: found {} frames, expected at most {}", name, times.size(), kMaxJoints);
  }
  for (std::size_t f = 0; f < times.size(); ++f) {
    if (std::isfinite(times[f]) && times[f] >= 0.0 && (f == 0 || times[f] > times[f - 1])) continue;
    return invalidArgument("{}: frame {} is at {} s, expected times that increase from 0 s or more", name, f, times[f]);
  }
  PlayedMesh made;
  Character& character = made.character;
  character.name = name;
  LORICA_TRY(character.skeleton, Skeleton::create({{"mesh", kNoJoint, {}, {}}}));
  character.jointFromModel.assign(1, Affine3::Identity());
  character.influences.assign(vertices, {0, 1.0});
  for (std::size_t v = 0; v <= vertices; ++v) character.influenceBegin.push_back(static_cast<std::uint32_t>(v));
  const Aabb box = boundsOf(mesh.vertices);
  character.height = box.max.y() - box.min.y();
  character.mesh = std::move(mesh);

  std::vector<MorphTarget> targets(times.size() - 1);
  std::vector<const MorphTarget*> pointers;
  for (std::size_t f = 1; f < times.size(); ++f) {
    MorphTarget& target = targets[f - 1];
    for (std::size_t v = 0; v < vertices; ++v) {
      const Vec3 offset = frames[f * vertices + v] - character.mesh.vertices[v];
      target.offsets.push_back({static_cast<VertexIndex>(v), offset.cast<float>(), Vec3f::Zero()});
    }
    pointers.push_back(&target);
  }
  const std::vector<JointsOfShape> joints = appendShapes(character, pointers);
  made.clip = {name, times.back(), {}};
  for (std::size_t f = 1; f < times.size(); ++f) {
    KeyTrack<Vec3> scale{KeyInterpolation::kLinear, {times[f - 1], times[f]}, {Vec3::Ones(), Vec3::Constant(2.0)}};
    if (f + 1 < times.size()) {
      scale.times.push_back(times[f + 1]);
      scale.values.emplace_back(Vec3::Ones());
    }
    for (const JointIndex joint : joints[f - 1]) made.clip.tracks.push_back({joint, {}, {}, scale});
  }
  LORICA_TRY_DO(checkCharacter(character));
  return made;
}

}  // namespace lorica
