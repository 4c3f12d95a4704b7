#include "collision/hulls/hull_fit.h"

#include "collision/hulls/mesh_subject.h"
#include "collision/hulls/part_hulls.h"
#include "geometry/mesh_files.h"
#include "geometry/random_numbers.h"
#include "session/prepare/subject.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace lorica::test {
namespace {

/// Whichever way a mesh is turned, rounding differs: that is no reason to refuse it.
TEST(HullFit, AMeshTurnedAnyWayGetsHullsThatHoldIt) {
  LORICA_REQUIRE_DATASET(readme, "solids/README.md");
  const std::filesystem::path data = readme.parent_path().parent_path();
  RandomNumbers random(72);
  const auto number = [&] { return random.between(-1.0, 1.0); };
  for (const char* name : {"solids/mpl_palm_rot3.obj", "solids/mpl_palm.obj", "solids/plastic_glass.obj",
                           "solids/coffeemug.obj", "vhacd/Block.off", "vhacd/Sword.off", "vhacd/Torus.off",
                           "vhacd/Fish.off", "strangers/chair_boxes.obj", "coacd/SnowFlake.obj"}) {
    const TriMesh mesh = valueOf(readMesh(data / name));
    for (int turn = 0; turn < 3; ++turn) {
      SCOPED_TRACE(fmt::format("{}, turn {}", name, turn));
      const Quat rotation = turn == 0 ? Quat::Identity() : Quat(number(), number(), number(), number()).normalized();
      std::string text;
      for (const Vec3& p : mesh.vertices) {
        const Vec3 at = rotation * p;
        text += fmt::format("v {} {} {}\n", at.x(), at.y(), at.z());
      }
      for (const Triangle& t : mesh.triangles) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
      const TemporaryFolder folder;
      Host host;
      const Subject subject = valueOf(readSubject(folder.write("turned.obj", text), {}, host));
      const Keyframes keyframes{subject.mesh.vertices, 1, {}, 0.0};
      FitRequest request{subject, keyframes, nullptr, {}, true, {}};
      request.settings.maxConcavity = 0.05 * concavityUnitOf(subject);
      const Fit fit = valueOf(fitHulls(request, host));
      const Result<void> held = checkHullsHold(fit.exported, subject.mesh.vertices, verticesToHold(subject));
      EXPECT_TRUE(held.ok()) << held.error().message;
    }
  }
}

/// Triangles are how a surface is written down: divided in four, it gets the same parts; an open one, whose walls are
/// made first, about as many.
TEST(HullFit, TheSameSurfaceWithOtherTrianglesGetsTheSameParts) {
  LORICA_REQUIRE_DATASET(readme, "solids/README.md");
  const std::filesystem::path data = readme.parent_path().parent_path();
  Host host;
  const auto partsOf = [&](TriMesh mesh) {
    const Subject subject = valueOf(meshSubject("mesh", std::move(mesh), {}, host));
    const Keyframes keyframes{subject.mesh.vertices, 1, {}, 0.0};
    FitRequest request{subject, keyframes, nullptr, {}, true, {.maxParts = 128}};
    request.settings.maxConcavity = 0.05 * concavityUnitOf(subject);
    const Fit fit = valueOf(fitHulls(request, host));
    EXPECT_TRUE(checkHullsHold(fit.exported, subject.mesh.vertices, verticesToHold(subject)).ok());
    return static_cast<double>(fit.made.decomposition.parts.size());
  };
  for (const char* name : {"solids/plastic_glass.obj", "solids/coffeemug.obj", "solids/mpl_palm.obj", "vhacd/Table.off",
                           "vhacd/Torus.off", "coacd/SnowFlake.obj"}) {
    SCOPED_TRACE(name);
    const TriMesh mesh = valueOf(readMesh(data / name));
    EXPECT_EQ(partsOf(divided(mesh)), partsOf(mesh));
  }
  const TriMesh bowl = valueOf(readMesh(data / "solids/bowl.obj"));
  const double parts = partsOf(bowl);
  EXPECT_NEAR(partsOf(divided(bowl)), parts, 0.1 * parts);
}

/// Of open meshes, too, whose bodies are built with voxels: what is thinner than those has parts of its own, not hulls
/// that reach for it.
TEST(HullFit, AnOpenMeshMeetsTheLimit) {
  LORICA_REQUIRE_DATASET(readme, "solids/README.md");
  Host host;
  for (const char* name : {"bowl.obj", "pr2_l_finger.obj"}) {
    SCOPED_TRACE(name);
    const Subject subject = valueOf(readSubject((readme.parent_path() / name).string(), {}, host));
    ASSERT_TRUE(subject.rebuilt);
    const Keyframes keyframes{subject.mesh.vertices, 1, {}, 0.0};
    FitRequest request{subject, keyframes, nullptr, {}, true, {.maxParts = 64}};
    request.settings.maxConcavity = 0.05 * concavityUnitOf(subject);
    const Fit fit = valueOf(fitHulls(request, host));
    EXPECT_TRUE(fit.concavityMet(request.settings)) << fit.concavity->largest / request.settings.maxConcavity;
  }
}

}  // namespace
}  // namespace lorica::test
