#include "session/scenes/contact_table.h"

#include "collision/world/strike_limit.h"
#include "geometry/counts.h"
#include "session/scenes/contact_outline.h"

#include <algorithm>
#include <optional>
#include <tuple>

namespace lorica {
namespace {

constexpr double kFirstFrameSeconds = 1.0 / 30.0;
constexpr double kBelow = 0.5;  // how far down the normal of what a foot stands on points; less is a wall

/// Without negative zeros, which would be in tables.
float plain(double x) {
  return static_cast<float>(x) + 0.0F;
}
std::array<float, 3> floats(const Vec3& v) {
  return {plain(v.x()), plain(v.y()), plain(v.z())};
}

/// @param velocity  of the other as seen from the part
void setVelocity(ContactRow& row, const Vec3& velocity) {
  const Vec3 normal(row.normal[0], row.normal[1], row.normal[2]);
  row.velocity = floats(velocity);
  row.slip = static_cast<float>((velocity - velocity.dot(normal) * normal).norm());
}

/// Whether what a foot touches and the foot move against each other at most so fast.
bool isSlow(const ContactOutline& outline, const SessionAvatar& avatar, const ContactRow& row, double speed) {
  const Vec3 velocity(row.velocity[0], row.velocity[1], row.velocity[2]);
  const Vec3 point(row.point[0], row.point[1], row.point[2]);
  return (velocity + outline.noiseOf(avatar, row.bone, point)).norm() <= speed;
}

/// Decides which feet stand, and fills in the phases of the rows.
void moveFeet(const Session& session, std::span<ContactOutline> outlines, std::span<ContactRow> rows) {
  for (int a = 0; a < countOf(outlines); ++a) {
    for (const ContactFoot foot : {ContactFoot::kLeft, ContactFoot::kRight}) {
      bool& stands = outlines[a].standing[foot == ContactFoot::kLeft ? 0 : 1];
      const double height = stands ? ContactTable::kLeaveHeight : ContactTable::kStandHeight;
      const double speed = stands ? ContactTable::kLeaveSpeed : ContactTable::kStandSpeed;
      stands = std::ranges::any_of(rows, [&](const ContactRow& row) {
        const bool below =
            row.kind == ContactKind::kFloor || (row.kind == ContactKind::kProp && row.normal[1] < -kBelow);
        return below && row.avatar == a && row.foot == foot && -row.depth <= height &&
               isSlow(outlines[a], session.avatar(a), row, speed);
      });
    }
  }
  for (ContactRow& row : rows) {
    if (row.foot == ContactFoot::kNone) continue;
    const bool stands = outlines[row.avatar].standing[row.foot == ContactFoot::kLeft ? 0 : 1];
    row.phase = stands ? FootPhase::kStance : FootPhase::kSwing;
  }
}

}  // namespace

/// Makes the rows of a frame.
struct ContactTable::Impl {
  explicit Impl(double nearest) : near(nearest), reach(std::max(nearest, kLeaveHeight)), props(reach) {}

  double near;
  double reach;  ///< to which is searched: at least as far as a foot may rise [m]
  double time = 0.0, seconds = kFirstFrameSeconds;
  std::vector<ContactOutline> outlines;
  std::vector<ContactRow> rows;
  PropMeetings props;
  LivePart ground;  ///< never moves

  void addFloor(const Session& session);
  void addProps(const Session& session);
  void addSelf(const Session& session);
  void addAvatars(const Session& session);
  ContactRow& add(const Session& session, ContactKind kind, int avatar, std::size_t part, const Meeting& meeting);
  void addPair(const Session& session, ContactKind kind, int a, std::size_t p, int b, std::size_t q,
               const Meeting& meeting, std::optional<double> strength);
  Vec3 velocityOf(const Session& session, int avatar, std::size_t part, JointIndex bone, const Vec3& point) const {
    return outlines[avatar].velocityOf(session.avatar(avatar), part, bone, point);
  }
  std::optional<Meeting> measure(const ContactOutline& a, std::size_t first, const ContactOutline& b,
                                 std::size_t second) const;
};

ContactTable::ContactTable(const Session& session, double near) : impl_(std::make_unique<Impl>(near)) {
  impl_->time = session.time();
  for (const SessionAvatar& avatar : session.avatars()) impl_->outlines.emplace_back(avatar);
}

ContactTable::~ContactTable() = default;
ContactTable::ContactTable(ContactTable&&) noexcept = default;
ContactTable& ContactTable::operator=(ContactTable&&) noexcept = default;

std::span<const ContactRow> ContactTable::update(const Session& session) {
  Impl& impl = *impl_;
  impl.seconds =
      session.frameCount() > 1 ? std::max(session.time() - impl.time, kRepeatedFrameSeconds) : kFirstFrameSeconds;
  impl.time = session.time();
  impl.rows.clear();
  for (std::size_t a = 0; a < impl.outlines.size(); ++a) {
    impl.outlines[a].read(session.avatars()[a], impl.time, impl.seconds);
  }
  if (session.world().hasFloor()) impl.addFloor(session);
  impl.addProps(session);
  impl.addSelf(session);
  impl.addAvatars(session);
  moveFeet(session, impl.outlines, impl.rows);
  for (std::size_t a = 0; a < impl.outlines.size(); ++a) impl.outlines[a].remember(session.avatars()[a]);
  std::erase_if(impl.rows, [&](const ContactRow& row) { return row.depth < -impl.near; });
  return impl.rows;
}

std::array<bool, 2> ContactTable::standing(int avatar) const {
  return impl_->outlines[avatar].standing;
}

double ContactTable::lowest(int avatar) const {
  return impl_->outlines[avatar].lowest;
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

void ContactTable::Impl::addFloor(const Session& session) {
  for (int a = 0; a < countOf(outlines); ++a) {
    const ContactOutline& outline = outlines[a];
    for (std::size_t p = 0; p < outline.parts.size(); ++p) {
      const Aabb& box = outline.boxes[p];
      if (box.empty() || box.min.y() > reach) continue;
      for (const ContactFoot foot : {ContactFoot::kNone, ContactFoot::kLeft, ContactFoot::kRight}) {
        const Vec3* lowest = outline.lowestOf(p, foot);
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

void ContactTable::Impl::addProps(const Session& session) {
  for (const PropMeeting& met : props.find(session, outlines)) {
    ContactRow& row = add(session, ContactKind::kProp, met.avatar, met.part, met.meeting);
    const Prop& prop = session.world().props()[met.prop];
    const Vec3 center =
        prop.mesh ? Vec3(prop.worldFromProp * prop.mesh->solid.center) : Vec3(prop.worldFromProp.translation());
    const Vec3 velocity = prop.velocity + prop.angularVelocity.cross(met.meeting.point - center);
    row.prop = met.prop;
    row.strength = static_cast<float>(met.impulse);
    setVelocity(row, velocity - velocityOf(session, met.avatar, met.part, row.bone, met.meeting.point));
  }
}

/// How far two parts are from each other; nothing if that is farther than counts.
std::optional<Meeting> ContactTable::Impl::measure(const ContactOutline& a, std::size_t first, const ContactOutline& b,
                                                   std::size_t second) const {
  if (a.parts[first].shape.degenerate() || b.parts[second].shape.degenerate()) return std::nullopt;
  return measured(a.pointsOf(first), a.boxes[first], b.pointsOf(second), b.boxes[second], 0.0, near);
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
    const ContactOutline& outline = outlines[a];
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
      const ContactOutline &first = outlines[a], &second = outlines[b];
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

}  // namespace lorica
