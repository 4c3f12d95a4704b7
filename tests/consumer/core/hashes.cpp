// Prints the hashes of what the core makes of the mannequin, to be compared between builds of it and systems: twelve
// decompositions, the live hulls of 300 poses that need no sine, and a thousand rays.

#include "acd/decompose.h"
#include "collision/live/live_body.h"
#include "collision/live/ray_query.h"
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
constexpr int kFrames = 300;
constexpr int kRays = 1000;

template <typename T>
std::uint64_t hashOfRange(std::span<const T> values, std::uint64_t seed) {
  return contentHash({reinterpret_cast<const char*>(values.data()), values.size_bytes()}, seed);
}

void print(const char* name, std::uint64_t hash) {
  std::printf("%s %016llx\n", name, static_cast<unsigned long long>(hash));
}

/// Between 0 and 1, the same everywhere.
double random(std::uint64_t& state) {
  state = state * 6364136223846793005U + 1442695040888963407U;
  return static_cast<double>(state >> 11U) * 0x1p-53;
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
  std::uint64_t all = 0;
  Decomposition last;
  for (const DecomposePreset preset : {DecomposePreset::kFast, DecomposePreset::kPaper, DecomposePreset::kQuality}) {
    for (const int frames : {1, kKeyframes}) {
      for (const int wanted : {5, 12}) {
        const PoseView view = {std::span<const Vec3>(keyframes).first(frames * count), static_cast<int>(count)};
        Result<Decomposition> parts = decompose(character.mesh, view, {.maxParts = wanted, .preset = preset});
        if (!parts) return std::puts(parts.error().message.c_str()), 1;
        const std::uint64_t hash = hashOf(*parts);
        all = hashOfRange(std::span(&hash, 1), all);
        last = std::move(*parts);
      }
    }
  }
  print("parts", all);
  Result<LiveBody> body = LiveBody::create(std::move(last), character);
  if (!body) return std::puts(body.error().message.c_str()), 1;
  std::uint64_t hulls = 0, hits = 0, state = 71;
  RayQuery query;
  for (int f = 0; f < kFrames; ++f) {
    body->update(bonesAt(character, 0.002 * f));
    for (const LivePart& part : body->parts()) {
      hulls = hashOfRange(std::span<const Vec3>(part.shape.vertices), hulls);
      hulls = hashOfRange(std::span<const Triangle>(part.shape.triangles), hulls);
    }
    const std::span<const LivePart> parts = body->parts();
    query.update({&parts, 1});
    for (int r = f * kRays / kFrames; r < (f + 1) * kRays / kFrames; ++r) {
      double numbers[4];  // arguments of a call have no order
      for (double& number : numbers) number = random(state);
      const Vec3 origin(4.0 * numbers[0] - 2.0, 2.0 * numbers[1], 3.0);
      const Vec3 target(numbers[2] - 0.5, 1.8 * numbers[3], 0.0);
      const HullHit hit = query.nearest({origin, target - origin});
      const double found[] = {hit ? hit.distance : -1.0, hit ? hit.position.x() : 0.0, hit ? hit.normal.y() : 0.0};
      hits = hashOfRange(std::span<const double>(found), hits);
    }
  }
  print("hulls", hulls);
  print("rays", hits);
  return 0;
}
