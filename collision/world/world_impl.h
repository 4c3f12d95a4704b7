#pragma once

#include "collision/world/dynamics_world.h"
#include "collision/world/part_dispatcher.h"
#include "collision/world/part_shape.h"
#include "collision/world/prop_body.h"
#include "collision/world/world.h"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

namespace lorica {

/// A part's motion within one frame: the origin moves on a straight line, the rotation has a fixed axis and constant
/// speed. Internal.
struct Sweep {
  Vec3 origin = Vec3::Zero();
  Quat rotation = Quat::Identity();
  Vec3 travel = Vec3::Zero();  ///< over the whole frame [m]
  Vec3 axis = Vec3::UnitX();   ///< world, unit
  double angle = 0.0;          ///< over the whole frame [rad]
  double radius = 0.0;         ///< of the part around its origin [m]
  double strength = 1.0;       ///< share of the velocity that is transferred to props

  [[nodiscard]] btTransform at(double fraction) const;
};

struct PartCollider {
  explicit PartCollider(btScalar margin) : shape(margin) {}
  PartShape shape;
  std::unique_ptr<btRigidBody> body;
  bool inWorld = false;
  bool reshaped = false;
  Sweep sweep;
};

/// The joint that holds a prop.
struct GrabAnchor {
  int prop = 0;
  Vec3 target = Vec3::Zero();  ///< requested position
  Vec3 drawn = Vec3::Zero();   ///< where the joint pulls the prop now, on the way to the target
  btVector3 inBody{0, 0, 0};   ///< held point in the body's frame
  std::unique_ptr<btPoint2PointConstraint> joint;
};

/// Keeps the number of pairs that the broad phase reports within bounds: further pairs pass through each other until
/// they part. Pairs with parts of the avatar have twice the room.
class PairLimit : public btOverlapFilterCallback {
 public:
  explicit PairLimit(const btOverlappingPairCache& pairs) : pairs_(pairs) {}
  bool needBroadphaseCollision(btBroadphaseProxy* a, btBroadphaseProxy* b) const override;

 private:
  const btOverlappingPairCache& pairs_;
};

struct World::Impl {
  // The sweep-and-prune grid. Bodies outside are still handled, but less efficiently.
  static constexpr btScalar kGridHalfSize = 64.0f;
  static constexpr unsigned short kMaxBodies = 32'500;

  Settings settings;
  btDefaultCollisionConfiguration configuration;
  PartDispatcher dispatcher{&configuration};
  // Not the usual btDbvtBroadphase: it balances its tree by comparing addresses, so the order of contacts, and thus the
  // motion, would differ from run to run.
  btAxisSweep3 broadphase{btVector3(-kGridHalfSize, -kGridHalfSize, -kGridHalfSize),
                          btVector3(kGridHalfSize, kGridHalfSize, kGridHalfSize), kMaxBodies, nullptr, true};
  PairLimit pairLimit{*broadphase.getOverlappingPairCache()};
  ContactSolver solver;
  DynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  btStaticPlaneShape floorShape{btVector3(0, 1, 0), 0};
  std::unique_ptr<btRigidBody> floor;
  std::vector<std::vector<std::unique_ptr<PartCollider>>> avatars;  ///< the parts of each
  /// Props that parts can move, by their least x, as balls that hold them during the frame. Empty if all parts count.
  struct Reach {
    double begin = 0.0;  ///< least x [m]
    Vec3 center = Vec3::Zero();
    double radius = 0.0;
    int prop = 0;
    [[nodiscard]] bool operator<(const Reach& other) const { return begin < other.begin; }
  };
  std::vector<Reach> reaches;
  double widestReach = 0.0;  ///< greatest radius of `reaches`
  bool crowded = false;      ///< parts far from all props are left out in this frame
  std::vector<PropBody> propBodies;
  std::vector<std::unique_ptr<btTypedConstraint>> links;
  std::vector<Prop> props;
  std::vector<Contact> contacts;
  std::deque<int> thrown;  ///< oldest first
  std::optional<GrabAnchor> grabbed;
  bool overlapsResolved = false;

  explicit Impl(const Settings& s);
  ~Impl();
  void addProp(const Prop& prop);
  void replaceProp(int index, const Prop& prop);
  void addBody(const PropBody& body, bool isStatic);
  void addLink(int a, int b, const Vec3& position);
  [[nodiscard]] bool isProp(int index) const { return index >= 0 && index < static_cast<int>(props.size()); }
  void release();
  void drawGrabbed(double seconds);
  void resolveInitialOverlaps(std::span<const std::span<const LivePart>> avatars);
  void setPartCounts(std::span<const std::span<const LivePart>> present);
  void setPartCount(std::size_t avatar, std::size_t count);
  void findReaches(double seconds);
  /// Calls visit(reach) for those that overlap a ball, until it returns false.
  template <typename Visit>
  void eachReach(const Vec3& center, double radius, const Visit& visit) const {
    Reach first;
    first.begin = center.x() - radius - 2.0 * widestReach;
    for (auto reach = std::lower_bound(reaches.begin(), reaches.end(), first);
         reach != reaches.end() && reach->begin <= center.x() + radius; ++reach) {
      const double both = radius + reach->radius;
      if ((reach->center - center).squaredNorm() <= both * both && !visit(*reach)) return;
    }
  }
  [[nodiscard]] bool isFar(const Sweep& sweep) const;
  void takePart(PartCollider& body, const LivePart& part, double seconds);
  void followSurfaces();
  [[nodiscard]] double longestSubstep(double fraction, double usual, double seconds) const;
  void moveParts(double fraction, double seconds);
  void collectContacts();
  void keepAboveFloor();
  void noteContact(const Contact& contact);
  void readProps();
};

enum CollisionGroup : int { kFloorGroup = 1, kPropGroup = 2, kPartGroup = 4 };

}  // namespace lorica
