#include "session/session_hashes.h"
#include "collision/particles/particles.h"
#include "geometry/files.h"

#include <span>
#include <string_view>
#include <type_traits>

namespace lorica {
namespace {

/// Hashes a sequence of values, each with its length.
class Chain {
 public:
  template <typename Number>
  void number(Number value) {
    static_assert(std::is_arithmetic_v<Number> || std::is_enum_v<Number>);
    bytes(std::string_view(reinterpret_cast<const char*>(&value), sizeof(value)));
  }
  void text(std::string_view value) { bytes(value); }
  void vector(const Vec3& value) { doubles(value.data(), 3); }
  void rotation(const Quat& value) { doubles(value.coeffs().data(), 4); }
  template <typename Transform>
  void transform(const Transform& value) {
    doubles(value.data(), 16);
  }
  void vectors(std::span<const Vec3> values) {
    static_assert(sizeof(Vec3) == 3 * sizeof(double), "no padding may be hashed");
    bytes(std::string_view(reinterpret_cast<const char*>(values.data()), values.size_bytes()));
  }
  void triangles(std::span<const Triangle> values) {
    bytes(std::string_view(reinterpret_cast<const char*>(values.data()), values.size_bytes()));
  }
  [[nodiscard]] std::uint64_t hash() const { return hash_; }

 private:
  void doubles(const double* values, std::size_t count) {
    bytes(std::string_view(reinterpret_cast<const char*>(values), count * sizeof(double)));
  }
  void bytes(std::string_view value) {
    const std::uint64_t size = value.size();
    hash_ = contentHash(std::string_view(reinterpret_cast<const char*>(&size), sizeof(size)), hash_);
    hash_ = contentHash(value, hash_);
  }
  std::uint64_t hash_ = 0;
};

}  // namespace

std::uint64_t hashOf(const Character& character) {
  Chain chain;
  chain.vectors(character.mesh.vertices);
  chain.triangles(character.mesh.triangles);
  for (const Joint& joint : character.skeleton.joints()) {
    chain.text(joint.name);
    chain.number(joint.parent);
    chain.vector(joint.rest.translation);
    chain.rotation(joint.rest.rotation);
    chain.vector(joint.rest.scale);
    chain.number(joint.bone ? static_cast<int>(*joint.bone) : -1);
  }
  for (const Affine3& jointFromModel : character.jointFromModel) chain.transform(jointFromModel);
  for (const Influence& influence : character.influences) {
    chain.number(influence.joint);
    chain.number(influence.weight);
  }
  for (const std::uint32_t begin : character.influenceBegin) chain.number(begin);
  for (const ShapeOffset& shape : character.shapes.offsets) {
    chain.number(shape.joint);
    chain.vector(shape.offset);
  }
  for (const std::uint32_t begin : character.shapes.begin) chain.number(begin);
  chain.number(character.height);
  chain.triangles(character.shown);
  return chain.hash();
}

std::uint64_t hashOf(const SpringBones& springs) {
  Chain chain;
  for (const SpringChain& strand : springs.chains) {
    chain.text(strand.name);
    chain.number(strand.center);
    for (const SpringJoint& joint : strand.joints) {
      chain.number(joint.joint);
      chain.vector(joint.tail);
      chain.vector(joint.gravityDir);
      for (const double value : {joint.stiffness, joint.gravityPower, joint.dragForce, joint.hitRadius}) {
        chain.number(value);
      }
    }
    for (const int group : strand.colliderGroups) chain.number(group);
  }
  for (const SpringCollider& collider : springs.colliders) {
    chain.number(collider.joint);
    chain.number(collider.shape);
    for (const Vec3& value : {collider.offset, collider.tail, collider.normal}) chain.vector(value);
    chain.number(collider.radius);
  }
  for (const std::vector<int>& group : springs.colliderGroups) {
    chain.number(group.size());
    for (const int collider : group) chain.number(collider);
  }
  for (const NodeConstraint& constraint : springs.constraints) {
    chain.number(constraint.kind);
    chain.number(constraint.joint);
    chain.number(constraint.source);
    chain.vector(constraint.axis);
    chain.number(constraint.weight);
  }
  return chain.hash();
}

std::uint64_t hashOf(const std::optional<HullCover>& cover) {
  if (!cover) return 0;
  Chain chain;
  chain.number(cover->maxHullVertices);
  for (const std::vector<CoverPoint>& part : cover->points) {
    chain.number(part.size());
    for (const CoverPoint& point : part) {
      chain.number(point.point);
      chain.vector(point.outward);
    }
  }
  return chain.hash();
}

std::uint64_t hashOf(const std::optional<TrainingRange>& training) {
  if (!training) return 0;
  Chain chain;
  for (const PointIndex probe : training->probes) chain.number(probe);
  chain.vectors(training->positions);
  chain.number(training->knownDistance);
  return chain.hash();
}

std::uint64_t hashOf(const World& world) {
  Chain chain;
  for (const Prop& prop : world.props()) {
    chain.number(prop.shape);
    chain.vector(prop.halfExtents);
    for (const double value : {prop.mass, prop.friction, prop.restitution}) chain.number(value);
    chain.transform(prop.worldFromProp);
    chain.vector(prop.velocity);
    chain.vector(prop.angularVelocity);
    if (!prop.mesh) continue;
    for (const ConvexHull& hull : prop.mesh->hulls) {
      chain.vectors(hull.vertices);
      chain.triangles(hull.triangles);
    }
  }
  if (const Particles* particles = world.particles()) {
    const ParticleSettings& settings = particles->settings();
    chain.number(settings.kind);
    for (const double value : {settings.radius, settings.friction, settings.viscosity, settings.settleSeconds}) {
      chain.number(value);
    }
    for (const Vec3f& position : particles->positions()) chain.vector(position.cast<double>());
    for (const ParticleSettings::Pour& pour : settings.pours) {
      chain.vector(pour.middle);
      chain.vector(pour.velocity);
      for (const double value : {pour.radius, pour.rate, static_cast<double>(pour.count)}) chain.number(value);
    }
  }
  return chain.hash();
}

}  // namespace lorica
