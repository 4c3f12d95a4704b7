#include "session/scenes/contact_table.h"

#include "capture/files/joint_csv.h"
#include "geometry/counts.h"
#include "geometry/random_numbers.h"
#include "geometry/triangle_tree.h"
#include "session/contact_events.h"
#include "session/treated_source.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/session/haired_box.h"
#include "tests/session/small_session.h"
#include "tests/support/allocations.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

namespace lorica::test {
namespace {

/// How a ContactTable compares with the skin that its hulls stand for.
struct SkinComparison {
  long frames = 0, rows = 0;
  long floors = 0, props = 0, pairs = 0;  ///< overlaps of each kind
  long deep = 0;                          ///< overlaps of the skin by more than kDeep
  long missed = 0;                        ///< those without a row whose depth is above 0
  double floorError = 0.0;                ///< largest difference of a part's depth in the floor from its skin's [m]
  double gapError = 0.0;                  ///< largest by which a distance exceeds that of the skins [m]
  std::vector<double> apart;              ///< for each overlap how far the skins are apart; 0 if they overlap [m]
  std::vector<double> standOff;           ///< for each overlap how far its hulls stand off their skins at most [m]
  double beyond = 0.0;                    ///< largest by which `apart` exceeds `standOff` [m]
};

inline constexpr double kDeep = 0.005;  ///< [m]

constexpr double kAlike = 1e-6;  // [m]; rows are in single precision

/// A part's skin in one frame. Trees are made when they are needed.
class Skin {
 public:
  Skin(const Session& session, PartIndex part)
      : points_(session.points()),
        part_(session.body().decomposition().parts[part]),
        live_(session.body().parts()[part]) {
    for (std::size_t t = 0; t < part_.triangles.size(); ++t) {
      if (part_.sourceTriangle[t] < 0) continue;  // a cap
      surface_.push_back(part_.triangles[t]);
      for (const VertexIndex v : part_.triangles[t]) corners_.push_back(v);
    }
    std::ranges::sort(corners_);
    corners_.erase(std::unique(corners_.begin(), corners_.end()), corners_.end());
    for (const VertexIndex v : corners_) box_.extend(points_[v]);
  }

  [[nodiscard]] const Aabb& box() const { return box_; }
  [[nodiscard]] bool bare() const { return surface_.empty(); }
  [[nodiscard]] double distance(const Vec3& p) const {
    if (!tree_) tree_ = std::make_unique<TriangleTree>(points_, surface_);
    return tree_->distance(p);
  }
  /// Above 0 outside.
  [[nodiscard]] double signedDistance(const Vec3& p) const {
    if (!closed_) closed_ = std::make_unique<TriangleTree>(points_, part_.triangles);
    return closed_->windingNumber(p) > 0.5 ? -distance(p) : distance(p);
  }
  /// Least signed distance of its corners from another's skin.
  [[nodiscard]] double above(const Skin& other) const {
    double least = kInfinity;
    for (const VertexIndex v : corners_) {
      if (least > 0.0 && distanceSqToBox(points_[v], other.box_) >= least * least) continue;
      least = std::min(least, other.signedDistance(points_[v]));
    }
    return least;
  }
  /// Largest distance of its hull from the skin, looked at in all corners, edges and faces.
  [[nodiscard]] double standOff() const {
    if (standOff_ >= 0.0) return standOff_;
    const std::vector<Vec3>& v = live_.shape.vertices;
    for (const Triangle& t : live_.shape.triangles) {
      for (int i = 0; i < 3; ++i) look(0.5 * (v[t[i]] + v[t[(i + 1) % 3]]));
      look((v[t[0]] + v[t[1]] + v[t[2]]) / 3.0);
    }
    return standOff_;
  }

 private:
  void look(const Vec3& inPart) const { standOff_ = std::max(standOff_, distance(live_.worldFromPart * inPart)); }

  std::span<const Vec3> points_;
  const Part& part_;
  const LivePart& live_;
  std::vector<Triangle> surface_;
  std::vector<VertexIndex> corners_;
  Aabb box_;
  mutable std::unique_ptr<TriangleTree> tree_, closed_;
  mutable double standOff_ = -1.0;
};

/// One pair: what the table says, and the skins' distance.
void add(const ContactRow* row, double skins, double standOff, SkinComparison& sum) {
  const bool overlaps = row != nullptr && row->depth > 0.0F;
  if (skins < -kDeep) {
    ++sum.deep;
    if (!overlaps) ++sum.missed;
  }
  if (row == nullptr) return;
  if (!overlaps) {
    sum.gapError = std::max(sum.gapError, -static_cast<double>(row->depth) - std::max(skins, 0.0) - kAlike);
    return;
  }
  sum.apart.push_back(std::max(skins, 0.0));
  sum.standOff.push_back(standOff);
  sum.beyond = std::max(sum.beyond, skins - standOff);
}

/// Compares the rows of a session's last frame by brute force: the skinned triangles of each part of the first avatar
/// against the floor, the balls among the props, and those of its other parts that are no neighbours.
void compareWithSkin(const Session& session, std::span<const ContactRow> rows, SkinComparison& sum) {
  ++sum.frames;
  sum.rows += std::ssize(rows);
  std::vector<Skin> skins;
  const int count = countOf(session.body().parts());
  for (int p = 0; p < count; ++p) skins.emplace_back(session, p);
  const auto rowOf = [&](ContactKind kind, int part, int other) -> const ContactRow* {
    const ContactRow* deepest = nullptr;  // on the floor a part may have several
    for (const ContactRow& row : rows) {
      const int its = kind == ContactKind::kProp ? row.prop : row.otherPart;
      if (row.kind != kind || row.part != part || (kind != ContactKind::kFloor && its != other)) continue;
      if (deepest == nullptr || row.depth > deepest->depth) deepest = &row;
    }
    return deepest;
  };
  for (int p = 0; p < count; ++p) {
    if (skins[p].bare()) continue;
    const double low = skins[p].box().min.y();
    const ContactRow* floor = rowOf(ContactKind::kFloor, p, -1);
    sum.floors += floor != nullptr && floor->depth > 0.0F ? 1 : 0;
    sum.deep += low < -kDeep ? 1 : 0;
    sum.missed += low < -kDeep && (floor == nullptr || floor->depth <= 0.0F) ? 1 : 0;
    if (floor != nullptr) sum.floorError = std::max(sum.floorError, std::abs(floor->depth + low));
    const std::span<const Prop> props = session.world().props();
    for (int b = 0; b < countOf(props); ++b) {
      const ContactRow* row = rowOf(ContactKind::kProp, p, b);
      const double gap = skins[p].distance(props[b].worldFromProp.translation()) - props[b].halfExtents.x();
      if (row == nullptr && gap > -kDeep) continue;
      sum.props += row != nullptr && row->depth > 0.0F ? 1 : 0;
      add(row, gap, skins[p].standOff(), sum);
    }
    for (int q = p + 1; q < count; ++q) {
      if (skins[q].bare() || session.avatar().areNeighbours(p, q)) continue;
      const ContactRow* row = rowOf(ContactKind::kSelf, p, q);
      const Aabb &a = skins[p].box(), &b = skins[q].box();
      const bool apart = (a.min.array() > b.max.array()).any() || (b.min.array() > a.max.array()).any();
      if (row == nullptr && apart) continue;
      sum.pairs += row != nullptr && row->depth > 0.0F ? 1 : 0;
      const double gap = std::min(skins[p].above(skins[q]), skins[q].above(skins[p]));
      add(row, gap, skins[p].standOff() + skins[q].standOff(), sum);
    }
  }
}

/// Four fixed balls where hands, hips, knees and feet pass.
World fixedBalls() {
  World world;
  for (const auto& [x, y, z, radius] : {std::array{0.4, 1.0, 0.25, 0.15}, std::array{-0.4, 0.9, 0.3, 0.15},
                                        std::array{0.0, 0.5, 0.4, 0.2}, std::array{0.2, 0.05, 0.15, 0.12}}) {
    Prop ball;
    ball.shape = PropShape::kSphere;
    ball.halfExtents = Vec3::Constant(radius);
    ball.mass = 0.0;
    ball.worldFromProp.translation() = Vec3(x, y, z);
    world.addProp(ball);
  }
  return world;
}

constexpr double kFrame = 1.0 / 60.0;

Vec3 vec(const std::array<float, 3>& v) {
  return {v[0], v[1], v[2]};
}

/// The box of 0.4 x 1 x 0.4 m about (0, 1, 0), which moves by so much in each frame.
Session boxMoving(const Vec3& perFrame, int frames, World world) {
  const auto place = [perFrame](double time) {
    JointTransform joint;
    joint.translation = time / kFrame * perFrame;
    return joint;
  };
  return Session::create(test::hairedBox(), test::hairedBoxParts(),
                         makeMotionPoseSource(test::hairedBoxMotion(frames, place)), std::move(world))
      .value();
}

std::vector<ContactRow> rowsOf(std::span<const ContactRow> rows, ContactKind kind, int part) {
  std::vector<ContactRow> found;
  std::ranges::copy_if(rows, std::back_inserter(found),
                       [&](const ContactRow& row) { return row.kind == kind && row.part == part; });
  return found;
}

/// It sinks by 2 cm and slides by 1 cm a frame; its lower side starts at 0.5 m, so it is 6 cm above the floor in frame
/// 22, and the frame after within 5 cm.
TEST(ContactTable, TheFloorIsAsFarAsTheLowestPoint) {
  Session session = boxMoving(Vec3(0.01, -0.02, 0.0), 40, World());
  ContactTable table(session);
  const ContactEvents masses(session);
  for (int frame = 0; session.step().value(); ++frame) {
    const std::vector<ContactRow> rows = rowsOf(table.update(session), ContactKind::kFloor, 0);
    const double depth = 0.02 * frame - 0.5;
    ASSERT_EQ(rows.size(), depth > -0.0501 ? 1U : 0U) << frame;
    if (rows.empty()) continue;
    const ContactRow& row = rows.front();
    EXPECT_EQ(row.frame, frame);
    EXPECT_DOUBLE_EQ(row.time, session.time());
    EXPECT_NEAR(row.depth, depth, kAlike);
    EXPECT_NEAR(row.point[1], -depth, kAlike);
    EXPECT_EQ(vec(row.normal), -Vec3::UnitY());
    EXPECT_LT((vec(row.velocity) - Vec3(-0.01, 0.02, 0.0) / kFrame).norm(), 1e-4);
    EXPECT_NEAR(row.slip, 0.01 / kFrame, 1e-4);
    EXPECT_NEAR(row.strength, depth > 1e-9 ? masses.massOf(0) * 0.02 / kFrame : 0.0, 0.01) << frame;
    EXPECT_EQ(row.foot, ContactFoot::kNone);
    EXPECT_EQ(row.phase, FootPhase::kNone);
  }
  EXPECT_NEAR(table.lowest(0), 0.5 - 39 * 0.02, 1e-6);
}

TEST(ContactTable, WithoutAFloorNothingTouchesIt) {
  Session session = boxMoving(Vec3(0.0, -0.1, 0.0), 10, World({.floor = false}));
  ContactTable table(session);
  while (session.step().value()) EXPECT_TRUE(rowsOf(table.update(session), ContactKind::kFloor, 0).empty());
}

Prop fixed(PropShape shape, const Vec3& half, const Vec3& at) {
  Prop prop;
  prop.shape = shape;
  prop.halfExtents = half;
  prop.mass = 0.0;
  prop.worldFromProp.translation() = at;
  return prop;
}

/// Its side at x = -0.2 nears props of every shape at the same distance.
TEST(ContactTable, FixedPropsOfEveryShapeAreAsFarAsTheyAre) {
  World world;
  const double side = -0.23;  // of the props, 3 cm from the box
  world.addProp(fixed(PropShape::kBox, Vec3(0.1, 0.05, 0.05), Vec3(side - 0.1, 1.0, 0.0)));
  world.addProp(fixed(PropShape::kSphere, Vec3::Constant(0.1), Vec3(side - 0.1, 1.3, 0.0)));
  world.addProp(fixed(PropShape::kCapsule, Vec3(0.05, 0.12, 0.05), Vec3(side - 0.05, 0.7, 0.1)));
  world.addProp(fixed(PropShape::kCylinder, Vec3(0.08, 0.1, 0.08), Vec3(side - 0.08, 0.7, -0.1)));
  auto mesh = std::make_shared<PropMeshShape>();
  const TriMesh cube = test::makeBox(Vec3::Constant(-0.05), Vec3::Constant(0.05));
  mesh->hulls.push_back(convexHull(cube.vertices));
  mesh->shown = cube;
  mesh->solid = massProperties(cube.vertices, cube.triangles);
  Prop shaped = meshProp(mesh);
  shaped.mass = 0.0;
  shaped.worldFromProp.translation() = Vec3(side - 0.05, 1.3, 0.3);
  shaped.worldFromProp.translation().z() = 0.15;
  world.addProp(shaped);
  world.addProp(fixed(PropShape::kBox, Vec3::Constant(0.1), Vec3(-1.0, 1.0, 0.0)));  // far away
  Session session = boxMoving(Vec3(-0.02, 0.0, 0.0), 4, std::move(world));
  ContactTable table(session);
  for (int frame = 0; session.step().value(); ++frame) {
    const std::vector<ContactRow> rows = rowsOf(table.update(session), ContactKind::kProp, 0);
    ASSERT_EQ(rows.size(), 5U) << frame;
    const double depth = 0.02 * frame - 0.03;
    for (int prop = 0; prop < 5; ++prop) {
      const ContactRow& row = rows[prop];
      EXPECT_EQ(row.prop, prop);
      EXPECT_NEAR(row.depth, depth, depth > 0.0 ? 3e-4 : 1e-6) << "prop " << prop << ", frame " << frame;
      EXPECT_LT((vec(row.normal) + Vec3::UnitX()).norm(), depth > 0.0 ? 0.02 : 1e-6) << prop;
      const double middle = 0.5 * (side - 0.2 - 0.02 * frame);
      EXPECT_NEAR(row.point[0], middle, 2e-3) << "prop " << prop << ", frame " << frame;
      EXPECT_LT((vec(row.velocity) - Vec3(frame == 0 ? 0.0 : 0.02 / kFrame, 0.0, 0.0)).norm(), 1e-4);
      EXPECT_EQ(row.strength, 0.0F) << "nothing moves it";
    }
  }
}

TEST(ContactTable, APropThatIsHitHasTheImpulseOfThePhysics) {
  World world({.gravity = Vec3::Zero()});
  Prop ball = fixed(PropShape::kSphere, Vec3::Constant(0.1), Vec3(-0.35, 1.0, 0.0));
  ball.mass = 0.5;
  ball.restitution = 0.0;
  world.addProp(ball);
  Session session = boxMoving(Vec3(-0.02, 0.0, 0.0), 12, std::move(world));
  ContactTable table(session);
  double impulse = 0.0, told = 0.0;
  while (session.step().value()) {
    for (const ContactRow& row : rowsOf(table.update(session), ContactKind::kProp, 0)) impulse += row.strength;
    for (const Contact& contact : session.world().contacts()) told += contact.impulse;
  }
  EXPECT_NEAR(impulse, told, 1e-6);
  EXPECT_NEAR(impulse, 0.5 * 0.02 / kFrame, 0.05);
}

/// The hair's side is 4 cm from the box and moves by 3 cm a frame.
TEST(ContactTable, OwnPartsAreNearThenTouch) {
  SkeletalMotion motion = test::hairedBoxMotion(4, [](double) { return JointTransform(); });
  const auto joints = static_cast<std::size_t>(motion.skeleton.jointCount());
  for (std::size_t frame = 0; frame < 4; ++frame) {
    motion.poses[frame * joints + 1].translation.x() -= 0.03 * static_cast<double>(frame);
  }
  Session session =
      Session::create(test::hairedBox(), test::hairedBoxParts(), makeMotionPoseSource(motion), World()).value();
  ContactTable table(session);
  for (int frame = 0; session.step().value(); ++frame) {
    const std::vector<ContactRow> rows = rowsOf(table.update(session), ContactKind::kSelf, 0);
    ASSERT_EQ(rows.size(), 1U);
    const ContactRow& row = rows.front();
    EXPECT_NEAR(row.depth, 0.03 * frame - 0.04, 3e-4);
    EXPECT_EQ(row.otherPart, 1);
    EXPECT_EQ(row.otherAvatar, 0);
    EXPECT_EQ(session.character().skeleton.joint(row.otherBone).name.substr(0, 4), "hair");
    EXPECT_TRUE(vec(row.normal).isApprox(Vec3::UnitX(), 0.02));
    EXPECT_NEAR(row.velocity[0], frame == 0 ? 0.0 : -0.03 / kFrame, 1e-3);
    EXPECT_NEAR(row.strength, frame < 2 ? 0.0 : 0.03 / kFrame * 0.24, 0.01);
  }
}

Session walk(World world, std::size_t frames) {
  return Session::create(makeMannequin(), test::eightParts(),
                         makeTreatedSource(makeMannequin(), makeRecordedSource(test::shippedFrames("walk", frames)),
                                           {nullptr, {}, {}})
                             .value(),
                         std::move(world))
      .value();
}

TEST(ContactTable, FindsAllThatTheSkinTouchesAndNothingBeyondTheStandOffOfTheHulls) {
  Session session = walk(test::fixedBalls(), 60);
  ContactTable table(session);
  test::SkinComparison sum;
  while (session.step().value()) {
    const std::span<const ContactRow> rows = table.update(session);
    test::compareWithSkin(session, rows, sum);
  }
  EXPECT_EQ(sum.frames, 60);
  EXPECT_GT(sum.props, 30);
  EXPECT_GT(sum.deep, 30);
  EXPECT_EQ(sum.missed, 0);
  EXPECT_LT(sum.floorError, 1e-6);
  EXPECT_LE(sum.gapError, 0.0);
  EXPECT_LT(sum.beyond, 0.002);
}

JointIndex ankleOf(const Character& character, std::size_t foot) {
  const HumanBone bone = foot == 0 ? HumanBone::kLeftFoot : HumanBone::kRightFoot;
  const std::span<const Joint> joints = character.skeleton.joints();
  return std::ranges::find_if(joints, [&](const Joint& joint) { return joint.bone == bone; }) - joints.begin();
}

/// Each foot of a walker stands, then swings, and neither flickers: it begins to stand as often as its ankle was
/// lifted.
TEST(ContactTable, TheFeetOfAWalkerStandInTurn) {
  Session session = walk(World(), 300);
  ContactTable table(session);
  std::array<int, 2> begins{}, stands{}, lifts{};
  std::array<bool, 2> up{};
  std::array<double, 2> rest{};
  std::array<bool, 2> before{};
  int frames = 0, none = 0;
  for (; session.step().value(); ++frames) {
    const std::span<const ContactRow> rows = table.update(session);
    const std::array<bool, 2> now = table.standing(0);
    for (std::size_t foot = 0; foot < 2; ++foot) {
      begins[foot] += now[foot] && !before[foot] ? 1 : 0;
      stands[foot] += now[foot] ? 1 : 0;
      const JointIndex ankle = ankleOf(session.character(), foot);
      const double height = session.worldFromJoint()[ankle].translation().y();
      if (frames == 0) rest[foot] = height;
      if (!up[foot] && height > rest[foot] + 0.06) ++lifts[foot];
      up[foot] = height > rest[foot] + (up[foot] ? 0.03 : 0.06);
      for (const ContactRow& row : rows) {
        if (row.foot != (foot == 0 ? ContactFoot::kLeft : ContactFoot::kRight)) continue;
        EXPECT_EQ(row.phase, now[foot] ? FootPhase::kStance : FootPhase::kSwing);
      }
    }
    none += now[0] || now[1] ? 0 : 1;
    before = now;
  }
  for (std::size_t foot = 0; foot < 2; ++foot) {
    EXPECT_GE(lifts[foot], 5);
    EXPECT_NEAR(begins[foot], lifts[foot], 1);
    EXPECT_GT(stands[foot], 0.45 * frames);
    EXPECT_LT(stands[foot], 0.9 * frames);
  }
  EXPECT_LT(none, 0.05 * frames);
}

/// How long and how often a walker's feet stand.
struct Stance {
  std::array<double, 2> share{};
  std::array<int, 2> begins{};
};
Stance stanceOf(Session session) {
  ContactTable table(session);
  Stance stance;
  std::array<bool, 2> before{};
  while (session.step().value()) {
    (void)table.update(session);
    const std::array<bool, 2> now = table.standing(0);
    for (std::size_t foot = 0; foot < 2; ++foot) {
      stance.begins[foot] += now[foot] && !before[foot] ? 1 : 0;
      stance.share[foot] += now[foot] ? 1.0 : 0.0;
    }
    before = now;
  }
  for (double& share : stance.share) share /= session.frameCount();
  return stance;
}

TEST(ContactTable, FeetStandAsLongAtAnyRateAndWithNoise) {
  // The walk at its own rate of 30 Hz, then at others, with noise of 1 mm in each axis, which is 0.3 m/s at 120 Hz.
  Session session = walk(World(), 300);
  SkeletalMotion slow{"walk", session.character().skeleton, {}, {}};
  while (session.step().value()) {
    slow.times.push_back(session.time());
    const std::span<const Affine3> world = session.worldFromJoint();
    for (JointIndex j = 0; j < slow.skeleton.jointCount(); ++j) {
      const JointIndex parent = slow.skeleton.joint(j).parent;
      const Affine3 local = parent == kNoJoint ? world[j] : world[parent].inverse() * world[j];
      JointTransform& joint = slow.poses.emplace_back();
      joint.translation = local.translation();
      joint.rotation = Quat(local.rotation());
    }
  }
  const Stance expected = stanceOf(walk(World(), 300));
  RandomNumbers random(48);
  for (const double rate : {60.0, 120.0, 240.0}) {
    SkeletalMotion fast{"walk", slow.skeleton, {}, {}};
    Pose pose = restPose(slow.skeleton);
    for (double time = slow.times.front(); time <= slow.times.back(); time += 1.0 / rate) {
      poseAt(slow, time, pose);
      for (int axis = 0; axis < 3; ++axis) {
        pose[0].translation[axis] += 0.001 * std::sqrt(3.0) * random.between(-1.0, 1.0);
      }
      fast.times.push_back(time);
      fast.poses.insert(fast.poses.end(), pose.begin(), pose.end());
    }
    const Stance found = stanceOf(
        Session::create(makeMannequin(), test::eightParts(), makeMotionPoseSource(std::move(fast)), World()).value());
    for (std::size_t foot = 0; foot < 2; ++foot) {
      EXPECT_NEAR(found.share[foot], expected.share[foot], 0.03) << rate;
      EXPECT_NEAR(found.begins[foot], expected.begins[foot], 1) << rate;
    }
  }
}

TEST(ContactTable, AFrameAllocatesNothing) {
  Session session = walk(test::fixedBalls(), 120);
  ContactTable table(session);
  long most = 0;
  for (int frame = 0; session.step().value(); ++frame) {
    (void)session.selfContacts();
    const long before = test::allocationCount();
    (void)table.update(session);
    if (frame >= 60) most = std::max(most, test::allocationCount() - before);
  }
  EXPECT_EQ(most, 0);
}

}  // namespace
}  // namespace lorica::test
