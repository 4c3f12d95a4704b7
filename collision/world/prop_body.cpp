#include "collision/world/prop_body.h"

#include "collision/world/bullet_math.h"
#include "geometry/counts.h"
#include "geometry/result.h"

#include <LinearMath/btConvexHullComputer.h>
#include <btBulletCollisionCommon.h>

#include <algorithm>
#include <array>
#include <numbers>

namespace lorica {
namespace {

// Hulls are shrunk by this margin and inflated by it again: distances of shapes that overlap by less are exact. Thin
// hulls shrink by at most the given share of their inner radius.
constexpr btScalar kHullMargin = 0.005f;
constexpr btScalar kMaxShrunk = 0.3f;
constexpr double kLightest = 50.0;  // density of props, for particles [kg/m^3]

/// A hull for Bullet, with edges and corners rounded by at most kHullMargin.
std::unique_ptr<PartShape> hullShape(const ConvexHull& hull, const Isometry3& massFromProp) {
  LORICA_CHECK(!hull.degenerate(), "a mesh prop's hulls need a volume");
  std::vector<Vec3> points;
  points.reserve(hull.vertices.size());
  for (const Vec3& v : hull.vertices) points.emplace_back(massFromProp * v);
  btConvexHullComputer shrunk;
  const btScalar margin =
      shrunk.compute(points[0].data(), 3 * sizeof(double), countOf(points), kHullMargin, kMaxShrunk);
  if (margin > 0.0f && shrunk.vertices.size() >= 4) {
    points.clear();
    points.reserve(shrunk.vertices.size());
    for (int i = 0; i < shrunk.vertices.size(); ++i) points.push_back(fromBullet(shrunk.vertices[i]));
  }
  auto shape = std::make_unique<PartShape>(std::max(margin, btScalar(0.0)));
  shape->setPoints(points);
  return shape;
}

/// The planes of a hull's faces, each once.
ParticleBody::Hull facesOf(const ConvexHull& hull, const Isometry3& massFromProp) {
  ParticleBody::Hull faces;
  faces.reserve(hull.triangles.size());
  for (const Triangle& t : hull.triangles) {
    const Vec3 corner = massFromProp * hull.vertices[t[0]];
    const Vec3 area = (massFromProp * hull.vertices[t[1]] - corner).cross(massFromProp * hull.vertices[t[2]] - corner);
    if (!(area.norm() > 1e-12)) continue;
    const Vec3f normal = area.normalized().cast<float>();
    const Eigen::Vector4f face(normal.x(), normal.y(), normal.z(), normal.dot(corner.cast<float>()));
    const bool known = std::any_of(faces.begin(), faces.end(),
                                   [&](const Eigen::Vector4f& f) { return (f - face).squaredNorm() < 1e-10f; });
    if (!known) faces.push_back(face);
  }
  return faces;
}

std::shared_ptr<const PropHulls> hullsOf(const PropMeshShape& mesh, const Isometry3& massFromProp) {
  auto hulls = std::make_shared<PropHulls>();
  hulls->shapes.reserve(mesh.hulls.size());
  hulls->faces.reserve(mesh.hulls.size());
  for (const ConvexHull& hull : mesh.hulls) {
    hulls->shapes.push_back(hullShape(hull, massFromProp));
    hulls->faces.push_back(facesOf(hull, massFromProp));
  }
  return hulls;
}

/// @return moments of inertia along the axes of the body [kg m^2]
Vec3 takeMesh(const Prop& prop, const PropBody* same, PropBody& body) {
  LORICA_CHECK(prop.mesh != nullptr && !prop.mesh->hulls.empty() && prop.mesh->solid.volume > 0.0,
               "a prop of shape kMesh needs a mesh with hulls and a volume");
  const PropMeshShape& mesh = *prop.mesh;
  const PrincipalInertia principal = principalInertia(mesh.solid.inertia);
  Isometry3 propFromMass = Isometry3::Identity();
  propFromMass.linear() = principal.axes;
  propFromMass.translation() = mesh.solid.center;
  body.massFromProp = propFromMass.inverse();
  body.centered = false;
  body.volume = mesh.solid.volume;
  body.radius = 0.0;
  for (const ConvexHull& hull : mesh.hulls) {
    for (const Vec3& v : hull.vertices) body.radius = std::max(body.radius, (v - mesh.solid.center).norm());
  }
  body.hulls = same != nullptr ? same->hulls : hullsOf(mesh, body.massFromProp);
  auto compound = std::make_unique<btCompoundShape>(true, countOf(mesh.hulls));
  for (const auto& shape : body.hulls->shapes) compound->addChildShape(btTransform::getIdentity(), shape.get());
  body.shape = std::move(compound);
  return principal.moments * (prop.mass / mesh.solid.volume);
}

/// @return moments of inertia along the axes of the body [kg m^2]
btVector3 takeShape(const Prop& prop, const PropBody* same, PropBody& body) {
  const btScalar radius = prop.halfExtents.x();
  const double square = std::numbers::pi * prop.halfExtents.x() * prop.halfExtents.x();
  body.radius = boundingRadius(prop);
  switch (prop.shape) {
    case PropShape::kBox:
      body.volume = 8.0 * prop.halfExtents.prod();
      body.shape = std::make_unique<btBoxShape>(toBullet(prop.halfExtents));
      break;
    case PropShape::kSphere:
      body.volume = 4.0 / 3.0 * square * prop.halfExtents.x();
      body.shape = std::make_unique<btSphereShape>(radius);
      body.round = true;
      break;
    case PropShape::kCapsule: {
      const double straight = 2.0 * (prop.halfExtents.y() - prop.halfExtents.x());
      LORICA_CHECK(straight >= 0.0, "a capsule must be at least as high as wide");
      body.volume = square * (straight + 4.0 / 3.0 * prop.halfExtents.x());
      body.shape = std::make_unique<btCapsuleShape>(radius, static_cast<btScalar>(straight));
      break;
    }
    case PropShape::kCylinder:
      body.volume = 2.0 * square * prop.halfExtents.y();
      body.shape = std::make_unique<btCylinderShape>(
          toBullet(Vec3(prop.halfExtents.x(), prop.halfExtents.y(), prop.halfExtents.x())));
      break;
    case PropShape::kMesh:
      return toBullet(takeMesh(prop, same, body));
  }
  btVector3 inertia(0.0f, 0.0f, 0.0f);
  if (prop.mass > 0.0) body.shape->calculateLocalInertia(prop.mass, inertia);
  return inertia;
}

}  // namespace

void PropBody::read(Prop& prop) const {
  prop.worldFromProp = fromBullet(body->getWorldTransform());
  if (!centered) prop.worldFromProp = prop.worldFromProp * massFromProp;
  prop.velocity = fromBullet(body->getLinearVelocity());
  prop.angularVelocity = fromBullet(body->getAngularVelocity());
}

ParticleBody::Motion PropBody::motion() const {
  return {fromBullet(body->getWorldTransform()), fromBullet(body->getLinearVelocity()),
          fromBullet(body->getAngularVelocity())};
}

ParticleBody PropBody::forParticles(const Prop& prop) const {
  constexpr std::array<ParticleBody::Shape, kPropShapeCount + 1> kShapes = {
      ParticleBody::Shape::kBox, ParticleBody::Shape::kSphere, ParticleBody::Shape::kCapsule,
      ParticleBody::Shape::kCylinder, ParticleBody::Shape::kHulls};
  ParticleBody result;
  result.shape = kShapes[static_cast<std::size_t>(prop.shape)];
  result.halfExtents = prop.halfExtents;
  if (hulls) result.hulls = hulls->faces;
  result.radius = radius;
  // What is lighter answers as if it were not: bubbles would be shot out of the water.
  const double lighter = std::min(1.0, prop.mass / (kLightest * volume));
  result.inverseMass = lighter * body->getInvMass();
  result.inverseInertia = lighter * fromBullet(body->getInvInertiaDiagLocal());
  result.from = result.to = motion();
  return result;
}

void PropBody::move(const ParticleBody::Motion& to) {
  const btTransform world = toBullet(Quat(to.worldFromBody.linear()), to.worldFromBody.translation());
  body->setWorldTransform(world);
  body->setInterpolationWorldTransform(world);
  body->setLinearVelocity(toBullet(to.velocity));
  body->setAngularVelocity(toBullet(to.angularVelocity));
  body->setInterpolationLinearVelocity(body->getLinearVelocity());
  body->setInterpolationAngularVelocity(body->getAngularVelocity());
  body->updateInertiaTensor();
  body->activate();
}

PropBody makePropBody(const Prop& prop, int index, const PropBody* same) {
  LORICA_CHECK(prop.mass >= 0.0 && prop.halfExtents.minCoeff() > 0.0,
               "a prop needs extents above zero and a mass of at least zero");
  PropBody body;
  const btVector3 inertia = takeShape(prop, same, body);
  btRigidBody::btRigidBodyConstructionInfo construction(prop.mass, nullptr, body.shape.get(), inertia);
  construction.m_friction = prop.friction;
  construction.m_restitution = prop.restitution;
  const Isometry3 worldFromMass = prop.worldFromProp * body.massFromProp.inverse();
  construction.m_startWorldTransform = toBullet(Quat(worldFromMass.linear()), worldFromMass.translation());
  // Bullet's default threshold of 0.8 m/s would freeze bodies that still visibly drift.
  construction.m_linearSleepingThreshold = 0.03f;
  construction.m_angularSleepingThreshold = 0.1f;
  if (prop.shape != PropShape::kBox) construction.m_rollingFriction = 0.002f;  // otherwise round props never stop
  body.body = std::make_unique<btRigidBody>(construction);
  body.body->setLinearVelocity(toBullet(prop.velocity));
  body.body->setAngularVelocity(toBullet(prop.angularVelocity));
  body.body->setUserIndex(index);
  return body;
}

}  // namespace lorica
