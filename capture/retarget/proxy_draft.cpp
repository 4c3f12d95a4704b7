#include "capture/retarget/proxy_draft.h"

#include "capture/retarget/human_rig.h"
#include "skinning/linear_blend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

namespace lorica {
namespace {

constexpr double kShortest = 1e-3;  // [m]

Vec3 middleOf(std::span<const Vec3> points) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

double farthestAlong(std::span<const Vec3> points, const Vec3& from, const Vec3& along) {
  double farthest = 0.0;
  for (const Vec3& p : points) farthest = std::max(farthest, (p - from).dot(along));
  return farthest;
}

constexpr double kNamedNear = 0.15;  // fraction of the height: max distance of a hand or foot found by name from the
                                     // limb's end
constexpr double kPlacedNear = 0.04;
constexpr double kStrayNear = 0.15;    // fraction of the height: max distance of a stray's mesh from a bone
constexpr double kControlNear = 0.06;  // the same of a control on the trunk from the hand or foot whose mesh it carries
constexpr std::array<std::string_view, 4> kHandWords = {"hand", "palm", "wrist", "fist"};
constexpr std::array<std::string_view, 3> kFootWords = {"foot", "feet", "ankle"};
constexpr std::array<std::string_view, 3> kToesWords = {"toe", "toes", "ball"};

bool hasWord(const JointName& name, std::span<const std::string_view> words) {
  return std::any_of(name.words.begin(), name.words.end(), [&](const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
  });
}

}  // namespace

RestMesh::RestMesh(const Character& character)
    : point_(character.mesh.vertices.size()),
      follows_(character.mesh.vertices.size(), kNoJoint),
      carries_(static_cast<std::size_t>(character.skeleton.jointCount()), false) {
  std::vector<Affine3> world(carries_.size());
  computeWorldFromJoint(character.skeleton, restPose(character.skeleton), world);
  computeWorldFromModel(character, world, world);
  skinLinearBlend(character, world, point_);
  for (std::size_t v = 0; v < point_.size(); ++v) {
    double max = 0.0;
    for (std::uint32_t i = character.influenceBegin[v]; i < character.influenceBegin[v + 1]; ++i) {
      if (character.influences[i].weight <= max) continue;
      max = character.influences[i].weight;
      follows_[v] = character.influences[i].joint;
    }
    if (follows_[v] != kNoJoint) carries_[follows_[v]] = true;
  }
}

std::vector<Vec3> RestMesh::pointsOf(const std::vector<bool>& marked) const {
  std::vector<Vec3> points;
  for (std::size_t v = 0; v < point_.size(); ++v) {
    if (follows_[v] != kNoJoint && marked[follows_[v]]) points.push_back(point_[v]);
  }
  return points;
}

bool RestMesh::carriesVertices(JointIndex joint) const {
  return carries_[joint];
}

std::optional<Vec3> armEnd(std::span<const Vec3> points, const Vec3& lastJoint) {
  if (points.empty()) return std::nullopt;
  const Vec3 along = middleOf(points) - lastJoint;
  if (along.norm() < kShortest) return std::nullopt;
  const Vec3 unit = along.normalized();
  return lastJoint + farthestAlong(points, lastJoint, unit) * unit;
}

std::optional<Vec3> legEnd(std::span<const Vec3> points, const Vec3& lastJoint, double above) {
  constexpr double kAnkleHeight = 0.1;     // fraction of the leg
  constexpr double kMostlyDown = 0.7;      // sine: a standing leg
  constexpr double kShaftAbove = 2.0;      // the foot does not protrude higher than this above the sole, in ankle
                                           // heights
  constexpr double kShortestShaft = 0.05;  // fraction of the distance to the sole
  if (points.empty()) return std::nullopt;
  Vec3 along = middleOf(points) - lastJoint;
  if (along.norm() < kShortest) return std::nullopt;
  along.normalize();
  if (along.y() < -kMostlyDown) along = -Vec3::UnitY();
  const double toSole = farthestAlong(points, lastJoint, along);
  const double ankle = std::min(kAnkleHeight * (above + toSole), 0.5 * toSole);

  std::vector<Vec3> shaft;
  for (const Vec3& p : points) {
    if ((p - lastJoint).dot(along) < toSole - kShaftAbove * ankle) shaft.push_back(p);
  }
  Vec3 direction = along;
  if (!shaft.empty()) {
    const Vec3 middle = middleOf(shaft) - lastJoint;
    const double down = middle.dot(along);
    if (down > kShortestShaft * toSole && down > kMostlyDown * middle.norm()) direction = middle / down;
  }
  return lastJoint + (toSole - ankle) * direction;
}

std::vector<Vec3> solePoints(std::span<const Vec3> points) {
  std::vector<Vec3> sole;
  if (points.empty()) return sole;
  std::vector<std::size_t> chosen;
  const auto choose = [&](double tilt, double azimuth) {
    const Vec3 down(std::sin(tilt) * std::cos(azimuth), -std::cos(tilt), std::sin(tilt) * std::sin(azimuth));
    std::size_t best = 0;
    for (std::size_t i = 1; i < points.size(); ++i) {
      if (points[i].dot(down) > points[best].dot(down)) best = i;
    }
    if (std::find(chosen.begin(), chosen.end(), best) == chosen.end()) chosen.push_back(best);
  };
  constexpr int kAzimuths = 8;
  choose(0.0, 0.0);
  for (const double tilt : {0.15, 0.4, 0.8}) {
    for (int a = 0; a < kAzimuths; ++a) choose(tilt, 2.0 * std::numbers::pi * a / kAzimuths);
  }
  sole.reserve(chosen.size());
  for (const std::size_t i : chosen) sole.push_back(points[i]);
  return sole;
}

SkeletonDraft::SkeletonDraft(const Skeleton& skeleton)
    : joints(skeleton.joints().begin(), skeleton.joints().end()), rotation(joints.size()), world(joints.size()) {
  evaluatePose(skeleton, restPose(skeleton), rotation, world);
  for (std::size_t b = 0; b < jointOf.size(); ++b) jointOf[b] = skeleton.jointOf(static_cast<HumanBone>(b));
}

bool SkeletonDraft::isBelowOrSame(JointIndex joint, JointIndex ancestor) const {
  while (joint != kNoJoint && joint != ancestor) joint = joints[joint].parent;
  return joint == ancestor;
}

ProxyDraft::ProxyDraft(const Character& made)
    : SkeletonDraft(made.skeleton), character(made), mesh(made), names(readJointNames(made.skeleton)) {}

void ProxyDraft::name(HumanBone bone, JointIndex joint) {
  jointOf[static_cast<std::size_t>(bone)] = joint;
  joints[joint].bone = bone;
}

JointIndex ProxyDraft::add(HumanBone bone, JointIndex parent, const Vec3& where) {
  const auto joint = static_cast<JointIndex>(joints.size());
  joints.push_back({fmt::format("{} (added)", nameOf(bone)), parent, {}, {}});
  rotation.push_back(rotation[parent]);
  world.push_back(world[parent]);
  world.back().translation() = where;
  name(bone, joint);
  return joint;
}

std::vector<Vec3> ProxyDraft::pointsOf(JointIndex joint) const {
  std::vector<bool> only(character.skeleton.jointCount(), false);
  only[joint] = true;
  return mesh.pointsOf(only);
}

bool ProxyDraft::isOnTrunk(JointIndex joint) const {
  if (!isBelowOrSame(joint, (*this)[HumanBone::kHips])) return false;
  for (const LimbBones& limb : limbs()) {
    if (isBelowOrSame(joint, (*this)[limb.upper])) return false;
  }
  return std::none_of(jointOf.begin(), jointOf.end(),
                      [&](JointIndex bone) { return bone != kNoJoint && isBelowOrSame(bone, joint); });
}

/// The vertices of a joint of the character and of its descendants.
std::vector<Vec3> ProxyDraft::pointsBelow(JointIndex top) const {
  std::vector<bool> marked(character.skeleton.jointCount());
  for (std::size_t j = 0; j < marked.size(); ++j) marked[j] = isBelowOrSame(static_cast<JointIndex>(j), top);
  return mesh.pointsOf(marked);
}

/// The joint that is a limb's hand or foot although it is attached elsewhere; kNoJoint if there is none.
JointIndex ProxyDraft::findEnd(std::size_t limb, JointIndex last, const std::optional<Vec3>& meshEnd) const {
  const bool leg = limb >= kFirstLeg;
  const Side side = limb % 2 == 0 ? Side::kLeft : Side::kRight;
  const JointIndex hips = (*this)[HumanBone::kHips];
  // Without a mesh on the limb, only names are used.
  double nearest = (meshEnd ? kNamedNear : 1.0) * character.height;
  JointIndex found = kNoJoint;
  for (JointIndex j = 0; j < character.skeleton.jointCount(); ++j) {
    if (joints[j].bone || isBelowOrSame(last, j)) continue;
    const JointName& its = names[j];
    const bool named = its.side == side && !isHelper(its) &&
                       hasWord(its, leg ? std::span<const std::string_view>(kFootWords)
                                        : std::span<const std::string_view>(kHandWords));
    const bool outside = !isBelowOrSame(j, hips) || isBelowOrSame(j, last) || isOnTrunk(j);
    if (!named && !(outside && meshEnd && mesh.carriesVertices(j))) continue;
    const double away = (position(j) - meshEnd.value_or(position(last))).norm();
    if (away > nearest || (!named && away > kPlacedNear * character.height)) continue;
    nearest = away;
    found = j;
  }
  return found;
}

bool ProxyDraft::complete(std::size_t i) {
  const LimbBones& limb = limbs()[i];
  const bool leg = i >= kFirstLeg;
  const JointIndex upper = (*this)[limb.upper];
  const JointIndex last = (*this)[limb.lower] == kNoJoint ? upper : (*this)[limb.lower];
  if (last != upper && !isBelowOrSame(last, upper)) return false;
  JointIndex end = (*this)[limb.end];
  if (end != kNoJoint && isBelowOrSame(end, last) && last != upper) return true;

  std::optional<Vec3> meshEnd;
  if (end == kNoJoint) {
    const std::vector<Vec3> points = pointsBelow(last);
    meshEnd = leg ? legEnd(points, position(last), (position(last) - position(upper)).norm())
                  : armEnd(points, position(last));
    end = findEnd(i, last, meshEnd);
    if (end != kNoJoint) {
      name(limb.end, end);
      if (leg) nameToes(i == kFirstLeg ? HumanBone::kLeftToes : HumanBone::kRightToes, end);
    }
  } else if (isBelowOrSame(last, end)) {
    return false;
  }
  if (end == kNoJoint && !meshEnd) return false;
  const Vec3 endPosition = end == kNoJoint ? *meshEnd : position(end);
  JointIndex lower = last;
  if (last == upper) {
    lower = add(limb.lower, upper, 0.5 * (position(upper) + endPosition));
    substitutes.push_back({limb.lower, kNoJoint, upper});
  }
  if (end == kNoJoint) {
    add(limb.end, lower, endPosition);
    substitutes.push_back({limb.end, kNoJoint, last});
  } else if (!isBelowOrSame(end, lower)) {
    if (!isBelowOrSame(end, last)) substitutes.push_back({limb.end, end, last});
    joints[end].parent = lower;
  }
  return true;
}

void ProxyDraft::nameToes(HumanBone toes, JointIndex foot) {
  if ((*this)[toes] != kNoJoint) return;
  for (JointIndex j = 0; j < character.skeleton.jointCount(); ++j) {
    if (j == foot || joints[j].bone || isHelper(names[j])) continue;
    if (!isBelowOrSame(j, foot) || !hasWord(names[j], kToesWords)) continue;
    name(toes, j);
    return;
  }
}

/// The bone whose line to the next one passes nearest to a point; kNoJoint if none is near.
JointIndex ProxyDraft::nearestBone(const Vec3& point) const {
  double nearest = kStrayNear * character.height;
  JointIndex found = kNoJoint;
  for (std::size_t b = 0; b <= static_cast<std::size_t>(HumanBone::kRightHand); ++b) {
    const JointIndex bone = jointOf[b];
    if (bone == kNoJoint) continue;
    double away = (point - position(bone)).norm();
    for (std::size_t next = 0; next <= static_cast<std::size_t>(HumanBone::kRightHand); ++next) {
      if (jointOf[next] == kNoJoint || joints[jointOf[next]].parent != bone) continue;
      const Vec3 line = position(jointOf[next]) - position(bone);
      const double along = std::clamp(line.dot(point - position(bone)) / line.squaredNorm(), 0.0, 1.0);
      if (std::isfinite(along)) away = std::min(away, (point - position(bone) - along * line).norm());
    }
    // Of bones that meet at the nearest point, the one farther from the hips.
    const bool better = away < nearest - 1e-9 || (away <= nearest + 1e-9 && isBelowOrSame(bone, found));
    if (!better) continue;
    nearest = away;
    found = bone;
  }
  return found;
}

/// The hand or foot that carries no vertices itself and is nearest to a control's mesh; kNoJoint if none is near. What
/// hangs on the trunk beside limbs that are whole, such as a skirt or a bag, belongs to the trunk.
JointIndex ProxyDraft::bareEndNear(JointIndex control, const Vec3& point) const {
  double nearest = kControlNear * character.height;
  JointIndex found = kNoJoint;
  for (const LimbBones& limb : limbs()) {
    const JointIndex end = (*this)[limb.end];
    if (end == kNoJoint || end >= character.skeleton.jointCount() || mesh.carriesVertices(end)) continue;
    const double away = std::min((point - position(end)).norm(), (position(control) - position(end)).norm());
    if (away > nearest) continue;
    nearest = away;
    found = end;
  }
  return found;
}

void ProxyDraft::attachStrays() {
  const JointIndex hips = (*this)[HumanBone::kHips];
  for (JointIndex j = 0; j < character.skeleton.jointCount(); ++j) {
    const bool onTrunk = isOnTrunk(j);
    if (!mesh.carriesVertices(j) || (isBelowOrSame(j, hips) && !onTrunk)) continue;
    if (isBelowOrSame(hips, j)) {
      strays.push_back({j, kNoJoint});
      continue;
    }
    const std::vector<Vec3> points = pointsOf(j);
    Vec3 middle = Vec3::Zero();
    for (const Vec3& point : points) middle += point / static_cast<double>(points.size());
    const JointIndex bone = onTrunk ? bareEndNear(j, middle) : nearestBone(middle);
    if (onTrunk && bone == kNoJoint) continue;
    strays.push_back({j, bone});
    if (bone != kNoJoint) joints[j].parent = bone;
  }
}

std::vector<JointIndex> parentsFirst(std::span<const Joint> joints) {
  std::vector<JointIndex> ordered;
  ordered.reserve(joints.size());
  std::vector<bool> placed(joints.size(), false);
  std::vector<JointIndex> above;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    for (auto up = static_cast<JointIndex>(j); up != kNoJoint && !placed[up]; up = joints[up].parent) {
      above.push_back(up);
      placed[up] = true;
    }
    ordered.insert(ordered.end(), above.rbegin(), above.rend());
    above.clear();
  }
  return ordered;
}

}  // namespace lorica
