#include "session/scenes/contact_table.h"

#include "collision/live/hull_distance.h"
#include "collision/live/lifted_point.h"
#include "collision/world/shape_contact.h"
#include "collision/world/strike_limit.h"
#include "geometry/counts.h"
#include "session/part_masses.h"
#include "session/scenes/hit_counter.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>

namespace lorica {
namespace {

constexpr double kFirstFrameSeconds = 1.0 / 30.0;
constexpr double kShortestFrameSeconds = 0.001;  // frames that are closer in time are repeated ones
constexpr double kFootSeconds = 0.033;           // over which a foot's speed is taken: one frame at 30 Hz
constexpr double kMeet = 1e-6;                   // nearer hulls have no direction to speak of: they meet [m]
constexpr int kSides = 32;                       // of a cylinder
constexpr double kBelow = 0.5;  // how far down the normal of what a foot stands on points; less is a wall

bool apart(const Aabb& a, const Aabb& b, double gap) {
  return (a.min.array() > b.max.array() + gap).any() || (b.min.array() > a.max.array() + gap).any();
}

/// Without negative zeros, which would be in tables.
float plain(double x) {
  return static_cast<float>(x) + 0.0F;
}
std::array<float, 3> floats(const Vec3& v) {
  return {plain(v.x()), plain(v.y()), plain(v.z())};
}

/// Two things that overlap or are near, as measured.
struct Meeting {
  double depth = 0.0;  ///< below 0 the distance
  Vec3 point = Vec3::Zero(), normal = Vec3::UnitX();
};

/// Of two things whose hulls meet, by so little that no query has found it.
Meeting touching(const Aabb& first, const Aabb& second) {
  const Vec3 between = second.center() - first.center();
  const Vec3 middle = 0.5 * (first.min.cwiseMax(second.min) + first.max.cwiseMin(second.max));
  return {0.0, middle, between.norm() > 0.0 ? Vec3(between.normalized()) : Vec3(Vec3::UnitX())};
}

/// A convex piece of a prop in world space.
struct Piece {
  std::vector<Vec3> points = {};
  double radius = 0.0;
  Aabb box;  ///< with the radius
};

void addCorners(const Prop& prop, const Vec3& half, Piece& piece) {
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 signs((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1);
    piece.points.emplace_back(prop.worldFromProp * signs.cwiseProduct(half));
  }
}

/// @param hull  index of the piece of a mesh; 0 for other shapes
void setPiece(const Prop& prop, std::size_t hull, Piece& piece) {
  const Vec3& half = prop.halfExtents;
  piece.points.clear();
  piece.radius = 0.0;
  switch (prop.shape) {
    case PropShape::kBox:
      addCorners(prop, half, piece);
      break;
    case PropShape::kSphere:
      piece.radius = half.x();
      piece.points.emplace_back(prop.worldFromProp.translation());
      break;
    case PropShape::kCapsule:
      piece.radius = half.x();
      for (const double end : {-1.0, 1.0}) {
        piece.points.emplace_back(prop.worldFromProp * Vec3(0.0, end * (half.y() - half.x()), 0.0));
      }
      break;
    case PropShape::kCylinder:
      for (int i = 0; i < kSides; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / kSides;
        const Vec3 rim(half.x() * std::cos(angle), half.y(), half.x() * std::sin(angle));
        piece.points.emplace_back(prop.worldFromProp * rim);
        piece.points.emplace_back(prop.worldFromProp * rim.cwiseProduct(Vec3(1.0, -1.0, 1.0)));
      }
      break;
    case PropShape::kMesh:
      for (const Vec3& v : prop.mesh->hulls[hull].vertices) piece.points.emplace_back(prop.worldFromProp * v);
      break;
  }
  piece.box = boundsOf(piece.points);
  piece.box.min.array() -= piece.radius;
  piece.box.max.array() += piece.radius;
}

/// Where an avatar's bones were.
struct Bones {
  double time = 0.0;
  std::vector<Affine3> worldFromJoint = {};
};

/// An avatar's hulls in world space, and its feet.
struct Outline {
  ShapeContactQuery query;
  std::vector<double> masses;
  std::vector<ContactFoot> footOf = {};       ///< of each joint
  std::vector<ContactFoot> footOfPoint = {};  ///< of each point of the decomposition

  std::span<const LivePart> parts = {};  ///< none while it is not there
  std::vector<Vec3> points = {};
  std::vector<std::size_t> first = {};  ///< of each part in `points`, and the end
  std::vector<Aabb> boxes = {};
  Aabb box = {};

  std::vector<Bones> past = {};  ///< oldest first: one that is kFootSeconds ago or more, and those since
  std::size_t known = 0;         ///< of `past`; the rest is memory for more

  std::array<bool, 2> standing{};
  double lowest = kInfinity;

  [[nodiscard]] std::span<const Vec3> pointsOf(std::size_t part) const {
    return std::span(points).subspan(first[part], first[part + 1] - first[part]);
  }
};

Outline outlineOf(const SessionAvatar& avatar) {
  Outline outline{ShapeContactQuery(avatar.body()), partMasses(avatar.body().decomposition(), avatar.character())};
  const Skeleton& skeleton = avatar.character().skeleton;
  for (JointIndex joint = 0; joint < skeleton.jointCount(); ++joint) {
    const HitLimb limb = limbOf(skeleton, joint);
    outline.footOf.push_back(limb == HitLimb::kLeftFoot    ? ContactFoot::kLeft
                             : limb == HitLimb::kRightFoot ? ContactFoot::kRight
                                                           : ContactFoot::kNone);
  }
  for (const LiftedPoint& point : liftPoints(avatar.character(), avatar.body().decomposition())) {
    const auto most = std::ranges::max_element(point, {}, &LiftedTerm::weight);
    outline.footOfPoint.push_back(most == point.end() ? ContactFoot::kNone : outline.footOf[most->joint]);
  }
  return outline;
}

/// The lowest vertex of a part among those of a foot, or of none.
const Vec3* lowestOf(const Outline& outline, std::size_t part, ContactFoot foot) {
  const std::span<const Vec3> points = outline.pointsOf(part);
  const std::vector<VertexIndex>& of = outline.parts[part].shape.pointOfVertex;
  const Vec3* lowest = nullptr;
  for (std::size_t v = 0; v < points.size(); ++v) {
    if (outline.footOfPoint[of[v]] == foot && (lowest == nullptr || points[v].y() < lowest->y())) lowest = &points[v];
  }
  return lowest;
}

/// A prop and a part: measured between hulls, or told by the physics.
struct PropMeeting {
  int avatar = 0, part = 0, prop = 0;
  Meeting meeting;
  double impulse = 0.0;

  [[nodiscard]] auto key() const { return std::tuple(avatar, part, prop); }
};

}  // namespace

struct ContactTable::Impl {
  double near = kNear;
  double reach = kNear;  ///< to which is searched: at least as far as a foot may rise [m]
  double time = 0.0, seconds = kFirstFrameSeconds;
  std::vector<Outline> outlines;
  std::vector<ContactRow> rows;
  std::vector<PropMeeting> props;
  Piece piece;
  LivePart ground;  ///< never moves

  void readHulls(const Session& session);
  void addFloor(const Session& session);
  void addProps(const Session& session);
  void addSelf(const Session& session);
  void addAvatars(const Session& session);
  void findProp(int prop, const Prop& of);
  ContactRow& add(const Session& session, ContactKind kind, int avatar, std::size_t part, const Meeting& meeting);
  void addPair(const Session& session, ContactKind kind, int a, std::size_t p, int b, std::size_t q,
               const Meeting& meeting, std::optional<double> strength);
  Vec3 velocityOf(const Session& session, int avatar, std::size_t part, JointIndex bone, const Vec3& point) const;
  void setVelocity(ContactRow& row, const Vec3& velocity) const;
  std::optional<Meeting> measure(const Outline& a, std::size_t first, const Outline& b, std::size_t second) const;
  bool isSlow(const Session& session, const ContactRow& row, double speed) const;
  void moveFeet(const Session& session);
};

ContactTable::ContactTable(const Session& session, double near) : impl_(std::make_unique<Impl>()) {
  impl_->near = near;
  impl_->reach = std::max(near, kLeaveHeight);
  impl_->time = session.time();
  for (const SessionAvatar& avatar : session.avatars()) impl_->outlines.push_back(outlineOf(avatar));
}

ContactTable::~ContactTable() = default;
ContactTable::ContactTable(ContactTable&&) noexcept = default;
ContactTable& ContactTable::operator=(ContactTable&&) noexcept = default;

std::span<const ContactRow> ContactTable::update(const Session& session) {
  Impl& impl = *impl_;
  impl.seconds =
      session.frameCount() > 1 ? std::max(session.time() - impl.time, kShortestFrameSeconds) : kFirstFrameSeconds;
  impl.time = session.time();
  impl.rows.clear();
  impl.readHulls(session);
  if (session.world().hasFloor()) impl.addFloor(session);
  impl.addProps(session);
  impl.addSelf(session);
  impl.addAvatars(session);
  impl.moveFeet(session);
  for (std::size_t a = 0; a < impl.outlines.size(); ++a) {
    Outline& outline = impl.outlines[a];
    if (outline.parts.empty()) {
      outline.known = 0;
      continue;
    }
    const double since = outline.known > 0 ? impl.time - outline.past[outline.known - 1].time : kInfinity;
    if (since < kShortestFrameSeconds) --outline.known;
    if (outline.known == outline.past.size()) outline.past.emplace_back();
    const std::span<const Affine3> now = session.avatars()[a].worldFromJoint();
    outline.past[outline.known].worldFromJoint.assign(now.begin(), now.end());
    outline.past[outline.known++].time = impl.time;
  }
  std::erase_if(impl.rows, [&](const ContactRow& row) { return row.depth < -impl.near; });
  return impl.rows;
}

std::array<bool, 2> ContactTable::standing(int avatar) const {
  return impl_->outlines[avatar].standing;
}

double ContactTable::lowest(int avatar) const {
  return impl_->outlines[avatar].lowest;
}

void ContactTable::Impl::readHulls(const Session& session) {
  for (std::size_t a = 0; a < outlines.size(); ++a) {
    Outline& outline = outlines[a];
    while (outline.known > 1 && time - outline.past[1].time >= kFootSeconds) {
      std::rotate(outline.past.begin(), outline.past.begin() + 1, outline.past.begin() + outline.known);
      --outline.known;
    }
    outline.parts = session.avatars()[a].partsInWorld();
    outline.points.clear();
    outline.first.assign(1, 0);
    outline.boxes.clear();
    outline.box = Aabb();
    for (const LivePart& part : outline.parts) {
      for (const Vec3& v : part.shape.vertices) outline.points.push_back(part.worldFromPart * v);
      outline.boxes.push_back(boundsOf(std::span(outline.points).subspan(outline.first.back())));
      outline.first.push_back(outline.points.size());
      if (outline.boxes.back().empty()) continue;
      outline.box.extend(outline.boxes.back().min);
      outline.box.extend(outline.boxes.back().max);
    }
    if (!outline.box.empty()) outline.lowest = std::min(outline.lowest, outline.box.min.y());
  }
}

/// A row without velocity and strength.
ContactRow& ContactTable::Impl::add(const Session& session, ContactKind kind, int avatar, std::size_t part,
                                    const Meeting& meeting) {
  ContactRow& row = rows.emplace_back();
  row.time = time;
  row.frame = session.frameCount() - 1;
  row.kind = kind;
  row.avatar = avatar;
  row.part = static_cast<std::int32_t>(part);
  row.bone = session.avatar(avatar).boneAt(row.part, meeting.point);
  if (row.bone != kNoJoint) row.foot = outlines[avatar].footOf[row.bone];
  row.depth = plain(meeting.depth);
  row.point = floats(meeting.point);
  row.normal = floats(meeting.normal);
  return row;
}

/// Velocity of the bone's material at a point since the last frame.
Vec3 ContactTable::Impl::velocityOf(const Session& session, int avatar, std::size_t part, JointIndex bone,
                                    const Vec3& point) const {
  const Outline& outline = outlines[avatar];
  if (outline.known == 0) return Vec3::Zero();
  if (bone == kNoJoint) return velocityAt(outline.parts[part], point, seconds);
  const Vec3 inBone = session.avatar(avatar).worldFromJoint()[bone].inverse() * point;
  return (point - outline.past[outline.known - 1].worldFromJoint[bone] * inBone) / seconds;
}

/// @param velocity  of the other as seen from the part
void ContactTable::Impl::setVelocity(ContactRow& row, const Vec3& velocity) const {
  const Vec3 normal(row.normal[0], row.normal[1], row.normal[2]);
  row.velocity = floats(velocity);
  row.slip = static_cast<float>((velocity - velocity.dot(normal) * normal).norm());
}

void ContactTable::Impl::addFloor(const Session& session) {
  for (int a = 0; a < countOf(outlines); ++a) {
    const Outline& outline = outlines[a];
    for (std::size_t p = 0; p < outline.parts.size(); ++p) {
      const Aabb& box = outline.boxes[p];
      if (box.empty() || box.min.y() > reach) continue;
      for (const ContactFoot foot : {ContactFoot::kNone, ContactFoot::kLeft, ContactFoot::kRight}) {
        const Vec3* lowest = lowestOf(outline, p, foot);
        if (lowest == nullptr || lowest->y() > reach) continue;
        const Vec3 down = -Vec3::UnitY();
        ContactRow& row = add(session, ContactKind::kFloor, a, p, {-lowest->y(), *lowest, down});
        row.foot = foot;
        setVelocity(row, -velocityOf(session, a, p, row.bone, *lowest));
        if (row.depth <= 0.0F) continue;
        const double speed = closingSpeed(outline.parts[p], ground, *lowest, down, seconds);
        row.strength = static_cast<float>(outline.masses[p] * speed);
      }
    }
  }
}

/// Measures a prop against all parts near it.
void ContactTable::Impl::findProp(int prop, const Prop& of) {
  const Vec3 middle = of.worldFromProp.translation(), extent = Vec3::Constant(boundingRadius(of));
  const Aabb around{middle - extent, middle + extent};
  const std::size_t pieces = of.shape == PropShape::kMesh ? of.mesh->hulls.size() : 1;
  for (int a = 0; a < countOf(outlines); ++a) {
    Outline& outline = outlines[a];
    if (outline.box.empty() || apart(outline.box, around, reach)) continue;
    for (std::size_t hull = 0; hull < pieces; ++hull) {
      setPiece(of, hull, piece);
      const std::size_t begin = props.size();
      bool deep = false;
      for (std::size_t p = 0; p < outline.parts.size(); ++p) {
        if (outline.parts[p].shape.degenerate() || apart(outline.boxes[p], piece.box, reach)) continue;
        const HullGap gap = gapOf(outline.pointsOf(p), piece.points);
        const double distance = gap.distance - piece.radius;
        if (distance > reach) continue;
        Meeting meeting{-distance, gap.onHull + 0.5 * distance * gap.normal, gap.normal};
        if (distance <= kMeet) {
          deep = true;
          meeting = touching(outline.boxes[p], piece.box);
        }
        props.push_back({a, static_cast<int>(p), prop, meeting});
      }
      if (!deep) continue;
      for (const ShapeContact& contact : outline.query.find(outline.parts, {piece.points, piece.radius})) {
        const auto found = std::find_if(props.begin() + static_cast<std::ptrdiff_t>(begin), props.end(),
                                        [&](const PropMeeting& one) { return one.part == contact.part; });
        if (found != props.end()) found->meeting = {contact.depth, contact.position, contact.direction};
      }
    }
  }
}

void ContactTable::Impl::addProps(const Session& session) {
  props.clear();
  const std::span<const Prop> all = session.world().props();
  for (int prop = 0; prop < countOf(all); ++prop) findProp(prop, all[prop]);
  for (const Contact& contact : session.world().contacts()) {
    props.push_back(
        {contact.avatar, contact.part, contact.prop, {contact.depth, contact.point, contact.normal}, contact.impulse});
  }
  // Of each pair the deepest, with all impulses.
  std::ranges::sort(props, [](const PropMeeting& a, const PropMeeting& b) {
    return std::tuple(a.key(), -a.meeting.depth) < std::tuple(b.key(), -b.meeting.depth);
  });
  for (std::size_t i = 0; i < props.size();) {
    const PropMeeting& deepest = props[i];
    double impulse = 0.0;
    for (; i < props.size() && props[i].key() == deepest.key(); ++i) impulse += props[i].impulse;
    ContactRow& row = add(session, ContactKind::kProp, deepest.avatar, deepest.part, deepest.meeting);
    const Prop& prop = all[deepest.prop];
    const Vec3 center =
        prop.mesh ? Vec3(prop.worldFromProp * prop.mesh->solid.center) : Vec3(prop.worldFromProp.translation());
    const Vec3 velocity = prop.velocity + prop.angularVelocity.cross(deepest.meeting.point - center);
    row.prop = deepest.prop;
    row.strength = static_cast<float>(impulse);
    setVelocity(row, velocity - velocityOf(session, deepest.avatar, static_cast<std::size_t>(deepest.part), row.bone,
                                           deepest.meeting.point));
  }
}

/// How far two parts are from each other; nothing if that is farther than counts.
std::optional<Meeting> ContactTable::Impl::measure(const Outline& a, std::size_t first, const Outline& b,
                                                   std::size_t second) const {
  if (a.parts[first].shape.degenerate() || b.parts[second].shape.degenerate()) return std::nullopt;
  if (apart(a.boxes[first], b.boxes[second], near)) return std::nullopt;
  const HullGap gap = gapOf(a.pointsOf(first), b.pointsOf(second));
  if (gap.distance > near) return std::nullopt;
  if (gap.distance <= kMeet) return touching(a.boxes[first], b.boxes[second]);
  return Meeting{-gap.distance, gap.onHull + 0.5 * gap.distance * gap.normal, gap.normal};
}

/// @param strength  none = that of two parts, see ContactEvents
void ContactTable::Impl::addPair(const Session& session, ContactKind kind, int a, std::size_t p, int b, std::size_t q,
                                 const Meeting& meeting, std::optional<double> strength) {
  ContactRow& row = add(session, kind, a, p, meeting);
  row.otherAvatar = b;
  row.otherPart = static_cast<std::int32_t>(q);
  row.otherBone = session.avatar(b).boneAt(row.otherPart, meeting.point);
  const LivePart &first = outlines[a].parts[p], &second = outlines[b].parts[q];
  setVelocity(row, velocityOf(session, b, q, row.otherBone, meeting.point) -
                       velocityOf(session, a, p, row.bone, meeting.point));
  if (!(meeting.depth > 0.0)) return;
  const double mass = std::min(outlines[a].masses[p], outlines[b].masses[q]);
  row.strength = static_cast<float>(
      strength ? *strength : mass * closingSpeed(first, second, meeting.point, meeting.normal, seconds));
}

void ContactTable::Impl::addSelf(const Session& session) {
  for (int a = 0; a < countOf(outlines); ++a) {
    const Outline& outline = outlines[a];
    const SessionAvatar& avatar = session.avatar(a);
    const std::span<const SelfContact> overlaps = avatar.selfContacts();
    auto overlap = overlaps.begin();  // sorted as the pairs are
    for (std::size_t p = 0; p < outline.parts.size(); ++p) {
      for (std::size_t q = p + 1; q < outline.parts.size(); ++q) {
        const std::pair pair(static_cast<PartIndex>(p), static_cast<PartIndex>(q));
        if (avatar.areNeighbours(pair.first, pair.second)) continue;
        while (overlap != overlaps.end() && std::pair(overlap->first, overlap->second) < pair) ++overlap;
        const bool found = overlap != overlaps.end() && std::pair(overlap->first, overlap->second) == pair;
        const std::optional<Meeting> meeting =
            found ? Meeting{overlap->depth, overlap->position, overlap->direction} : measure(outline, p, outline, q);
        if (meeting) addPair(session, ContactKind::kSelf, a, p, a, q, *meeting, std::nullopt);
      }
    }
  }
}

void ContactTable::Impl::addAvatars(const Session& session) {
  const std::span<const BodyContact> overlaps = session.avatarContacts();
  const auto key = [](const BodyContact& c) {
    return std::tuple(c.firstBody, c.secondBody, c.firstPart, c.secondPart);
  };
  auto overlap = overlaps.begin();  // sorted as the pairs are
  for (int a = 0; a < countOf(outlines); ++a) {
    for (int b = a + 1; b < countOf(outlines); ++b) {
      const Outline &first = outlines[a], &second = outlines[b];
      if (first.box.empty() || second.box.empty() || apart(first.box, second.box, near)) continue;
      for (std::size_t p = 0; p < first.parts.size(); ++p) {
        for (std::size_t q = 0; q < second.parts.size(); ++q) {
          const std::tuple pair(a, b, static_cast<PartIndex>(p), static_cast<PartIndex>(q));
          while (overlap != overlaps.end() && key(*overlap) < pair) ++overlap;
          const bool found = overlap != overlaps.end() && key(*overlap) == pair;
          const std::optional<Meeting> meeting =
              found ? Meeting{overlap->depth, overlap->position, overlap->direction} : measure(first, p, second, q);
          if (!meeting) continue;
          addPair(session, ContactKind::kAvatar, a, p, b, q, *meeting, found ? overlap->strength : 0.0);
        }
      }
    }
  }
}

/// Whether what a foot touches and the foot move against each other at most so fast. Of fast frames the bone's velocity
/// is the mean of several, since a millimetre of noise is 0.1 m/s at 120 Hz.
bool ContactTable::Impl::isSlow(const Session& session, const ContactRow& row, double speed) const {
  const Outline& outline = outlines[row.avatar];
  Vec3 velocity(row.velocity[0], row.velocity[1], row.velocity[2]);
  if (outline.known > 1 && row.bone != kNoJoint) {
    const Vec3 point(row.point[0], row.point[1], row.point[2]);
    const Vec3 inBone = session.avatar(row.avatar).worldFromJoint()[row.bone].inverse() * point;
    const Bones &first = outline.past.front(), &last = outline.past[outline.known - 1];
    velocity += (point - last.worldFromJoint[row.bone] * inBone) / seconds -
                (point - first.worldFromJoint[row.bone] * inBone) / std::max(time - first.time, kShortestFrameSeconds);
  }
  return velocity.norm() <= speed;
}

void ContactTable::Impl::moveFeet(const Session& session) {
  for (int a = 0; a < countOf(outlines); ++a) {
    for (const ContactFoot foot : {ContactFoot::kLeft, ContactFoot::kRight}) {
      bool& stands = outlines[a].standing[foot == ContactFoot::kLeft ? 0 : 1];
      const double height = stands ? kLeaveHeight : kStandHeight, speed = stands ? kLeaveSpeed : kStandSpeed;
      stands = std::ranges::any_of(rows, [&](const ContactRow& row) {
        const bool below =
            row.kind == ContactKind::kFloor || (row.kind == ContactKind::kProp && row.normal[1] < -kBelow);
        return below && row.avatar == a && row.foot == foot && -row.depth <= height && isSlow(session, row, speed);
      });
    }
  }
  for (ContactRow& row : rows) {
    if (row.foot == ContactFoot::kNone) continue;
    const bool stands = outlines[row.avatar].standing[row.foot == ContactFoot::kLeft ? 0 : 1];
    row.phase = stands ? FootPhase::kStance : FootPhase::kSwing;
  }
}

}  // namespace lorica
