// Prints the hashes of what the core makes of the mannequin, to be compared between builds of it: parts of three
// keyframes, and the live hulls of 60 poses that need no sine.

#include "acd/decompose.h"
#include "collision/live/live_body.h"
#include "geometry/files.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"

#include <cstdint>
#include <cstdio>
#include <span>
#include <string_view>
#include <vector>

using namespace lorica;

namespace {

constexpr int kKeyframes = 3;
constexpr int kFrames = 60;

template <typename T>
std::uint64_t hashOfRange(std::span<const T> values, std::uint64_t seed) {
  return contentHash({reinterpret_cast<const char*>(values.data()), values.size_bytes()}, seed);
}

/// Arms and legs turn about an axis, by angles whose half has this tangent.
std::vector<Affine3> bonesAt(const Character& character, double tangent) {
  Pose pose = restPose(character.skeleton);
  for (const HumanBone bone : {HumanBone::kLeftUpperArm, HumanBone::kRightUpperLeg, HumanBone::kLeftLowerLeg}) {
    pose[character.skeleton.jointOf(bone)].rotation = Quat(1.0, 0.6 * tangent, 0.0, 0.8 * tangent).normalized();
  }
  std::vector<Affine3> bones(pose.size());
  computeWorldFromJoint(character.skeleton, pose, bones);
  computeWorldFromModel(character, bones, bones);
  return bones;
}

}  // namespace

int main() {
  const Character character = makeMannequin();
  const std::size_t count = character.mesh.vertices.size();
  std::vector<Vec3> keyframes(kKeyframes * count);
  for (int k = 0; k < kKeyframes; ++k) {
    skinLinearBlend(character, bonesAt(character, 0.25 * k), std::span(keyframes).subspan(k * count, count));
  }
  Result<Decomposition> parts = decompose(character.mesh, {keyframes, static_cast<int>(count)}, {.maxParts = 12});
  if (!parts) return std::puts(parts.error().message.c_str()), 1;
  std::printf("parts %016llx\n", static_cast<unsigned long long>(hashOf(*parts)));
  Result<LiveBody> body = LiveBody::create(std::move(*parts), character);
  if (!body) return std::puts(body.error().message.c_str()), 1;
  std::uint64_t hulls = 0;
  for (int f = 0; f < kFrames; ++f) {
    body->update(bonesAt(character, 0.01 * f));
    for (const LivePart& part : body->parts()) {
      hulls = hashOfRange(std::span<const Vec3>(part.shape.vertices), hulls);
      hulls = hashOfRange(std::span<const Triangle>(part.shape.triangles), hulls);
    }
  }
  std::printf("hulls %016llx\n", static_cast<unsigned long long>(hulls));
  return 0;
}
