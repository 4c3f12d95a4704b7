// Rays and swept balls against live hulls, beside skinning with Embree's trees refitted in each frame, and Bullet's ray
// and sweep tests of the same hulls. CSV on standard output; times are those of one thread, the quickest of several
// frames.

#include "collision/live/ray_query.h"
#include "geometry/random_numbers.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/bench/measure.h"
#include "tests/bench/walker.h"

#include <btBulletCollisionCommon.h>
#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <utility>
#include <vector>

namespace lorica::bench {
namespace {

constexpr std::size_t kMostRays = 10'000;
constexpr double kBall = 0.05;  ///< radius of what is swept [m]

double microseconds() {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

template <typename Work>
double timeOf(const Work& work) {
  const double begin = microseconds();
  work();
  return microseconds() - begin;
}

/// Copies of the walker in a square grid, out of step.
struct Crowd {
  std::vector<LiveBody> bodies;
  std::vector<std::vector<Affine3>> bones;
  std::vector<std::span<const LivePart>> views;
  double side = 0.0;

  Crowd(const Walker& walker, std::size_t count) : bodies(count, *walker.body), bones(count) {
    for (const LiveBody& body : bodies) views.push_back(body.parts());
    side = std::ceil(std::sqrt(static_cast<double>(count)));
  }
  void pose(const Walker& walker, std::size_t frame) {
    for (std::size_t a = 0; a < bodies.size(); ++a) {
      bones[a] = walker.worldFromModel[(frame + 7 * a) % walker.worldFromModel.size()];
      const double x = std::fmod(static_cast<double>(a), side), z = std::floor(static_cast<double>(a) / side);
      for (Affine3& bone : bones[a]) bone.pretranslate(Vec3(x, 0.0, z));
      bodies[a].update(bones[a]);
    }
  }
};

/// From around the crowd, at points of it.
std::vector<HullRay> raysAt(const Crowd& crowd) {
  RandomNumbers random(48);
  const auto between = [&](double low, double high) { return random.between(low, high); };
  std::vector<HullRay> rays(kMostRays);
  for (HullRay& ray : rays) {
    for (int axis = 0; axis < 3; ++axis)
      ray.origin[axis] = axis == 1 ? between(0.0, 3.0) : between(-3.0, crowd.side + 2.0);
    Vec3 target;
    for (int axis = 0; axis < 3; ++axis) target[axis] = axis == 1 ? between(0.0, 1.8) : between(-0.4, crowd.side - 0.6);
    ray.direction = (target - ray.origin).normalized();
  }
  return rays;
}

/// The skins as Embree's scene, one tree, refitted when they move.
class Embree {
 public:
  explicit Embree(const Crowd& crowd)
      : character_(makeMannequin()), device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_DYNAMIC);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_LOW);
    const std::size_t vertices = character_.mesh.vertices.size();
    skin_.resize(vertices);
    for (std::size_t a = 0; a < crowd.bodies.size(); ++a) {
      RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
      rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
      points_.push_back(static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                                    RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices)));
      auto* corners =
          static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                         3 * sizeof(unsigned), character_.mesh.triangles.size()));
      for (const Triangle& triangle : character_.mesh.triangles) corners = std::copy_n(triangle.begin(), 3, corners);
      rtcAttachGeometry(scene_, geometry);
      geometries_.push_back(geometry);
    }
  }
  ~Embree() {
    for (RTCGeometry geometry : geometries_) rtcReleaseGeometry(geometry);
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  void skin(const Crowd& crowd) {
    for (std::size_t a = 0; a < crowd.bones.size(); ++a) {
      skinLinearBlend(character_, crowd.bones[a], skin_);
      for (std::size_t v = 0; v < skin_.size(); ++v) {
        for (std::size_t axis = 0; axis < 3; ++axis) points_[a][3 * v + axis] = static_cast<float>(skin_[v][axis]);
      }
    }
  }
  void refit() {
    for (RTCGeometry geometry : geometries_) {
      rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
      rtcCommitGeometry(geometry);
    }
    rtcCommitScene(scene_);
  }
  [[nodiscard]] bool hits(const HullRay& ray) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query{};
    query.ray.org_x = static_cast<float>(ray.origin.x());
    query.ray.org_y = static_cast<float>(ray.origin.y());
    query.ray.org_z = static_cast<float>(ray.origin.z());
    query.ray.dir_x = static_cast<float>(ray.direction.x());
    query.ray.dir_y = static_cast<float>(ray.direction.y());
    query.ray.dir_z = static_cast<float>(ray.direction.z());
    query.ray.tfar = 1e9F;
    query.ray.mask = ~0U;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context, &query);
    return query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  }

 private:
  Character character_;
  RTCDevice device_;
  RTCScene scene_;
  std::vector<RTCGeometry> geometries_;
  std::vector<float*> points_;
  std::vector<Vec3> skin_;
};

/// The hulls in a Bullet world.
class Bullet {
 public:
  explicit Bullet(const Crowd& crowd) : dispatcher_(&settings_), world_(&dispatcher_, &broadphase_, &settings_) {
    for (const LiveBody& body : crowd.bodies) {
      for (std::size_t p = 0; p < body.parts().size(); ++p) {
        shapes_.push_back(std::make_unique<btConvexHullShape>());
        shapes_.back()->setMargin(0.0);
        objects_.push_back(std::make_unique<btCollisionObject>());
        objects_.back()->setCollisionShape(shapes_.back().get());
      }
    }
  }
  ~Bullet() {
    for (const auto& object : objects_) world_.removeCollisionObject(object.get());
  }
  Bullet(const Bullet&) = delete;
  Bullet& operator=(const Bullet&) = delete;

  void update(const Crowd& crowd) {
    std::size_t i = 0;
    for (const LiveBody& body : crowd.bodies) {
      for (const LivePart& part : body.parts()) {
        btConvexHullShape& shape = *shapes_[i];
        shape = btConvexHullShape();
        shape.setMargin(0.0);
        for (const Vec3& v : part.shape.vertices) shape.addPoint(btVector3(v.x(), v.y(), v.z()), false);
        shape.recalcLocalAabb();
        btTransform pose;
        const Eigen::Matrix4f matrix = part.worldFromPart.matrix().cast<float>();
        pose.setFromOpenGLMatrix(matrix.data());
        objects_[i]->setWorldTransform(pose);
        if (!added_) world_.addCollisionObject(objects_[i].get());
        ++i;
      }
    }
    added_ = true;
    world_.updateAabbs();
  }
  /// A ball, if the ray has a radius.
  [[nodiscard]] bool hits(const HullRay& ray) const {
    const auto point = [](const Vec3& p) { return btVector3(p.x(), p.y(), p.z()); };
    const btVector3 from = point(ray.origin), to = point(ray.origin + 100.0 * ray.direction);
    if (ray.radius > 0.0) {
      const btSphereShape ball(static_cast<btScalar>(ray.radius));
      const btQuaternion turn = btQuaternion::getIdentity();
      btCollisionWorld::ClosestConvexResultCallback touch(from, to);
      world_.convexSweepTest(&ball, btTransform(turn, from), btTransform(turn, to), touch);
      return touch.hasHit();
    }
    btCollisionWorld::ClosestRayResultCallback result(from, to);
    world_.rayTest(from, to, result);
    return result.hasHit();
  }

 private:
  btDefaultCollisionConfiguration settings_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btCollisionWorld world_;
  std::vector<std::unique_ptr<btConvexHullShape>> shapes_;
  std::vector<std::unique_ptr<btCollisionObject>> objects_;
  bool added_ = false;
};

/// The quickest of several frames, of which each asks all rays; a ray's [us].
struct Quickest {
  double time = kInfinity;
  std::size_t hits = 0;  ///< of the last frame

  template <typename Hits>
  void ask(std::span<const HullRay> rays, const Hits& hitsRay) {
    hits = 0;
    const double whole = timeOf([&] {
      for (const HullRay& ray : rays) hits += hitsRay(ray) ? 1 : 0;
    });
    time = std::min(time, whole / static_cast<double>(rays.size()));
  }
};

void measure(const Walker& walker, int vertices, std::size_t avatars, int frames) {
  Crowd crowd(walker, avatars);
  crowd.pose(walker, 0);
  const std::vector<HullRay> rays = raysAt(crowd);
  std::vector<HullRay> sweeps = rays;
  for (HullRay& ball : sweeps) ball.radius = kBall;
  Embree embree(crowd);
  Bullet bullet(crowd);
  RayQuery query;
  const Character character = makeMannequin();
  std::vector<PosedSkin> skins(avatars, PosedSkin(walker.body->decomposition(), character));
  std::vector<HullHit> hits(rays.size());
  for (const std::size_t count : {std::size_t{1}, std::size_t{100}, kMostRays}) {
    double update = kInfinity, skin = kInfinity, refit = kInfinity, fill = kInfinity;
    Quickest own, ownSkin, skinned, hulls, swept, sweptHulls;
    // A single ray is timed as one of many, or the clock would be measured.
    const std::size_t asked = std::max<std::size_t>(count, 100);
    const std::span<const HullRay> first = std::span(rays).first(asked), balls = std::span(sweeps).first(asked);
    for (int frame = 0; frame < frames; ++frame) {
      crowd.pose(walker, static_cast<std::size_t>(3 * frame));
      update = std::min(update, timeOf([&] { query.update(crowd.views); }));
      own.time = std::min(
          own.time, timeOf([&] { query.nearest(first, std::span(hits).first(asked)); }) / static_cast<double>(asked));
      own.hits = std::ranges::count_if(std::span(hits).first(asked), [](const HullHit& hit) { return bool(hit); });
      for (std::size_t a = 0; a < avatars; ++a) skins[a].update(crowd.bones[a]);
      ownSkin.ask(first, [&](const HullRay& ray) { return bool(query.nearestOnSkin(ray, skins)); });
      swept.ask(balls, [&](const HullRay& ray) { return bool(query.nearest(ray)); });
      skin = std::min(skin, timeOf([&] { embree.skin(crowd); }));
      refit = std::min(refit, timeOf([&] { embree.refit(); }));
      skinned.ask(first, [&](const HullRay& ray) { return embree.hits(ray); });
      fill = std::min(fill, timeOf([&] { bullet.update(crowd); }));
      hulls.ask(first, [&](const HullRay& ray) { return bullet.hits(ray); });
      if (frame == 0 || asked < kMostRays) sweptHulls.ask(balls, [&](const HullRay& ray) { return bullet.hits(ray); });
    }
    fmt::print("{},{},{},{:.1f},{:.1f},{:.1f},{:.1f}", vertices == 0 ? "exact" : fmt::format("{}", vertices), avatars,
               count, update, skin, refit, fill);
    for (const Quickest& each : {own, ownSkin, skinned, hulls, swept, sweptHulls}) {
      fmt::print(",{:.3f},{:.1f}", each.time, 100.0 * static_cast<double>(each.hits) / static_cast<double>(asked));
    }
    fmt::print("\n");
    std::fflush(stdout);
  }
}

int run(int frames) {
  fmt::print("hull_vertices,avatars,rays,update_us,skin_us,refit_us,bullet_update_us");
  for (const char* each : {"ray", "on_skin", "embree", "bullet", "ball", "bullet_ball"}) {
    fmt::print(",{0}_us,{0}_hit_percent", each);
  }
  fmt::print("\n");
  for (const int vertices : {64, 0}) {
    const Result<Walker> walker = makeWalker(16, vertices);
    if (!walker) return fail(walker.error());
    for (const int avatars : {1, 100}) measure(*walker, vertices, avatars, frames);
  }
  return 0;
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  int frames = 20;
  CLI::App app("Rays against live hulls, against skins in Embree, and in Bullet.");
  app.add_option("--frames", frames, "Frames of which the quickest counts")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  return lorica::bench::run(frames);
}
