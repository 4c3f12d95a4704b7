// A ball that is dropped into a vessel of hulls stays in, in MuJoCo; tests/session/prepare/mesh_walls_test.cpp has the
// same in Bullet.
#include "tests/peers/peer.h"
#include "tests/session/prepare/vessels.h"
#include "tests/support/datasets.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace lorica::test {
namespace {

constexpr double kRadius = 0.15;  // of the ball [m]

/// The hulls as fixed geoms, and a ball beside the middle, above them. MuJoCo takes the hulls of the vertices.
std::string modelOf(const std::vector<ConvexHull>& hulls, double height) {
  std::string meshes, geoms;
  for (std::size_t h = 0; h < hulls.size(); ++h) {
    meshes += fmt::format("<mesh name=\"h{}\" vertex=\"", h);
    for (const Vec3& p : hulls[h].vertices) meshes += fmt::format("{} {} {} ", p.x(), p.y(), p.z());
    meshes += "\"/>";
    geoms += fmt::format("<geom type=\"mesh\" mesh=\"h{}\"/>", h);
  }
  return fmt::format(
      "<mujoco><option gravity=\"0 -9.81 0\"/><default><geom condim=\"6\" friction=\"1 0.05 0.05\"/></default>"
      "<asset>{}</asset><worldbody>{}<body name=\"ball\" pos=\"0.2 {} 0.1\"><freejoint/><geom size=\"{}\"/></body>"
      "</worldbody></mujoco>",
      meshes, geoms, height, kRadius);
}

/// Where the ball is after five seconds.
Vec3 restOfABall(const std::vector<ConvexHull>& hulls, double height) {
  const TemporaryFolder folder;
  const std::filesystem::path model = folder.write("vessel.xml", modelOf(hulls, height));
  const nlohmann::json job = {{"model", model.string()}, {"seconds", 5.0}};
  const std::filesystem::path in = folder.write("job.json", job.dump());
  const std::filesystem::path out = folder.path() / "out.json";
  if (!runPeer("mujoco.mjs", {in.string(), out.string()})) return Vec3::Zero();
  const nlohmann::json made = readJson(out);
  EXPECT_EQ(made["warnings"], 0);
  return vectorOf(made["places"]["ball"]);
}

TEST(PeerHollow, ABallStaysInWhereItWasDroppedIn) {
  LORICA_REQUIRE_PEERS();
  struct Vessel {
    const char* name;
    TriMesh sheet;
    double bottom, rim, radius;  // of the sheet: heights, and the bottom's inscribed circle [m]
  };
  const Vessel vessels[] = {{"bowl", makeBowl(), 0.0, 0.7, 0.6},
                            {"box", openBox(0.5), -0.5, 0.5, 0.5},
                            {"mug", revolved({{0, 0}, {0.4, 0}, {0.4, 0.8}}, 24), 0.0, 0.8, 0.4}};
  for (const Vessel& vessel : vessels) {
    SCOPED_TRACE(vessel.name);
    const WallBody walls = wallsOf(vessel.sheet);
    const Vec3 held = restOfABall(hullsOf(walls.mesh, 32), vessel.rim + 0.5);
    // A ball on the bottom, whose upper side is half of the thickness above the sheet; contacts give by 2 mm.
    EXPECT_NEAR(held.y(), vessel.bottom + 0.5 * walls.figures.thickness + kRadius, 0.002);
    EXPECT_LT(std::hypot(held.x(), held.z()), vessel.radius);
    // On the hull of all, it lies above the rim or has fallen down beside it.
    const Vec3 outside = restOfABall(hullsOf(walls.mesh, 1), vessel.rim + 0.5);
    EXPECT_TRUE(outside.y() > vessel.rim || outside.y() < vessel.bottom - kRadius) << outside.transpose();
  }
}

}  // namespace
}  // namespace lorica::test
