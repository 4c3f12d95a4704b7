// Prints hashes of parts and live hulls, for tests/arm64/run to compare between kinds of processor: of a mesh, and of
// the mannequin in poses that need no sine, which libraries round differently.

#include "acd/decompose.h"
#include "acd/transfer.h"
#include "collision/live/live_body.h"
#include "geometry/files.h"
#include "geometry/mesh_files.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"

#include <cstdio>

namespace {

using namespace lorica;

template <typename T>
std::uint64_t hashOf(std::span<const T> values, std::uint64_t seed) {
  return contentHash({reinterpret_cast<const char*>(values.data()), values.size_bytes()}, seed);
}

std::uint64_t hashOf(const ConvexHull& hull, std::uint64_t seed) {
  return hashOf(std::span<const Triangle>(hull.triangles), hashOf(std::span<const Vec3>(hull.vertices), seed));
}

int fail(const Error& error) {
  std::fprintf(stderr, "hashes: %s\n", error.message.c_str());
  return 1;
}

/// Every joint turned about an axis and by an angle that differ, all by arithmetic and square roots.
Pose turned(const Skeleton& skeleton, int number) {
  Pose pose = restPose(skeleton);
  for (std::size_t i = 0; i < pose.size(); ++i) {
    const double k = static_cast<double>((i * 7 + static_cast<std::size_t>(number) * 3) % 11) - 5.0;
    Quat turn(20.0, k, 3.0 - k * 0.5, number - 2.0);
    turn.normalize();
    pose[i].rotation = pose[i].rotation * turn;
  }
  return pose;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: hashes MESH\n"), 2;
  const auto mesh = readMesh(argv[1]);
  if (!mesh) return fail(mesh.error());
  const Character character = makeMannequin();
  std::printf("mannequin         %016llx\n",
              static_cast<unsigned long long>(hashOf(std::span<const Vec3>(character.mesh.vertices), 0)));

  std::vector<Vec3> keyframes;
  std::vector<Affine3> joints(static_cast<std::size_t>(character.skeleton.jointCount()));
  const auto poseModel = [&](int number) {
    computeWorldFromJoint(character.skeleton, turned(character.skeleton, number), joints);
    computeWorldFromModel(character, joints, joints);
  };
  const std::size_t vertexCount = character.mesh.vertices.size();
  for (int number = 0; number < 3; ++number) {
    poseModel(number);
    keyframes.resize(keyframes.size() + vertexCount);
    skinLinearBlend(character, joints, std::span(keyframes).last(vertexCount));
  }
  std::printf("skinned           %016llx\n",
              static_cast<unsigned long long>(hashOf(std::span<const Vec3>(keyframes), 0)));

  for (const DecomposePreset preset : {DecomposePreset::kPaper, DecomposePreset::kFast, DecomposePreset::kQuality}) {
    const int number = static_cast<int>(preset);
    const auto chair = decompose(*mesh, {mesh->vertices, countOf(mesh->vertices)}, {.maxParts = 6, .preset = preset});
    if (!chair) return fail(chair.error());
    std::vector<Vec3> points(static_cast<std::size_t>(chair->pointCount()));
    transfer(*chair, mesh->vertices, points);
    std::uint64_t hash = hashOf(*chair);
    for (const Part& part : chair->parts) hash = hashOf(partHull(part, points), hash);
    std::printf("mesh, preset %d    %016llx\n", number, static_cast<unsigned long long>(hash));
  }

  const auto parts = decompose(character.mesh, {keyframes, static_cast<int>(vertexCount)}, {.maxParts = 8});
  if (!parts) return fail(parts.error());
  auto body = LiveBody::create(*parts, character);
  if (!body) return fail(body.error());
  std::uint64_t hash = hashOf(*parts);
  ConvexHull hull;
  for (int number = 0; number < 12; ++number) {
    poseModel(number);
    body->update(joints);
    for (const LivePart& part : body->parts()) {
      worldHull(part, hull);
      hash = hashOf(hull, hash);
    }
  }
  std::printf("live, 12 frames   %016llx\n", static_cast<unsigned long long>(hash));
  return 0;
}
