#include "collision/live/lifted_part.h"

#include "collision/live/lifted_kernel.h"

#include <algorithm>
#include <limits>
#include <map>
#include <tuple>

namespace lorica {
namespace {

constexpr double kStill = 0.25;          // of a step: a pose closer than this to the last one taken is the same
constexpr double kSamePosition = 1e-12;  // of a metre, and of the distance from the model's origin

/// The bones of a point; points of the same layout can share blocks.
struct Layout {
  std::vector<JointIndex> bones;  ///< ascending
  bool onePosition = false;       ///< each bone moves the same position of the bind pose

  bool operator<(const Layout& other) const {
    return std::tie(bones, onePosition) < std::tie(other.bones, other.onePosition);
  }
};

Layout layoutOf(const LiftedPoint& point) {
  Layout layout;
  layout.bones.reserve(point.size());
  layout.onePosition = true;
  const Vec3 position = bindPositionOf(point);
  for (const LiftedTerm& t : point) {
    layout.bones.push_back(t.joint);
    layout.onePosition =
        layout.onePosition && (t.moment - t.weight * position).norm() <= kSamePosition * (1.0 + position.norm());
  }
  return layout;
}

/// Whether points of one layout can be in blocks of another: unused bones get weight 0.
bool fits(const Layout& small, const Layout& large) {
  return (small.onePosition || !large.onePosition) &&
         std::includes(large.bones.begin(), large.bones.end(), small.bones.begin(), small.bones.end());
}

/// Groups points by layout. A few points that would leave most of a block empty join other groups.
std::map<Layout, std::vector<std::int32_t>> groupByLayout(std::span<const LiftedPoint> points) {
  std::map<Layout, std::vector<std::int32_t>> groups;
  for (std::size_t i = 0; i < points.size(); ++i) groups[layoutOf(points[i])].push_back(i);
  const auto lanesOf = [](const Layout& layout) {
    return LiftedPart::lanesOfBlock(layout.bones.size(), layout.onePosition);
  };
  for (auto small = groups.begin(); small != groups.end();) {
    auto home = groups.end();
    if (small->second.size() <= LiftedPart::kBlock / 2) {
      for (auto other = groups.begin(); other != groups.end(); ++other) {
        if (other == small || !fits(small->first, other->first)) continue;
        if (home == groups.end() || lanesOf(other->first) < lanesOf(home->first)) home = other;
      }
    }
    if (home == groups.end()) {
      ++small;
      continue;
    }
    home->second.insert(home->second.end(), small->second.begin(), small->second.end());
    small = groups.erase(small);
  }
  return groups;
}

}  // namespace

LiftedPart::LiftedPart(std::span<const LiftedPoint> points, std::span<const JointIndex> carriers) {
  LORICA_CHECK(!points.empty(), "a part must have points");
  const double share = 1.0 / points.size();

  // Bind positions and the bones of the whole part.
  std::vector<Vec3> bind(points.size(), Vec3::Zero());
  std::map<JointIndex, std::uint32_t> boneOfJoint;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const LiftedTerm& t : points[i]) {
      bind[i] += t.moment;
      boneOfJoint.emplace(t.joint, 0);
    }
    bindMean_ += share * bind[i];
  }
  for (const Vec3& p : bind) radius_ = std::max(radius_, (p - bindMean_).norm());
  for (auto& [joint, bone] : boneOfJoint) {
    bone = joints_.size();
    joints_.push_back(joint);
  }

  const auto carrierOf = [&](JointIndex joint) { return carriers.empty() ? kNoJoint : carriers[joint]; };
  if (std::ranges::any_of(joints_, [&](JointIndex joint) { return carrierOf(joint) != kNoJoint; })) {
    for (const JointIndex joint : joints_) {
      carriers_.push_back(boneOfJoint.at(carrierOf(joint) == kNoJoint ? joint : carrierOf(joint)));
    }
  }

  // Sums over all points, bone by bone.
  sums_.resize(joints_.size());
  weightMean_ = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 offset = bind[i] - bindMean_;
    for (const LiftedTerm& t : points[i]) {
      FourColumns<double>& sum = sums_[boneOfJoint[t.joint]];
      const Eigen::Vector4d lifted(t.moment.x(), t.moment.y(), t.moment.z(), t.weight);
      for (std::size_t r = 0; r < 4; ++r) {
        const double entry = lifted[r];
        for (std::size_t c = 0; c < 3; ++c) sum.column[c][r] += entry * offset[c];
        sum.column[3][r] += entry * share;
      }
      offsetSum_ += t.weight * offset;
      weightMean_ += t.weight * share;
    }
  }

  // Shapes add their offsets to a point that stands as their carriers have it.
  std::vector<LiftedPoint> standing(points.begin(), points.end());
  for (LiftedPoint& point : standing) {
    for (const LiftedTerm& t : point) {
      if (carrierOf(t.joint) == kNoJoint) continue;
      std::ranges::find(point, carrierOf(t.joint), &LiftedTerm::joint)->moment += t.moment;
    }
  }

  // Blocks of points with the same layout, positions and moments about the part's mean.
  order_.reserve(points.size());
  for (const auto& [layout, members] : groupByLayout(standing)) {
    Group group;
    group.firstRow = order_.size();
    group.blocks = (members.size() + kBlock - 1) / kBlock;
    group.firstLane = lanes_.size();
    group.firstBone = groupBones_.size();
    group.bones = layout.bones.size();
    group.onePosition = layout.onePosition;
    const std::size_t lanesOfOne = lanesOfBlock(group.bones, group.onePosition);
    lanes_.resize(lanes_.size() + group.blocks * lanesOfOne);
    for (std::size_t i = 0; i < members.size(); ++i) {
      Lane* block = &lanes_[group.firstLane + i / kBlock * lanesOfOne];
      const std::size_t lane = i % kBlock;
      const auto write = [&](std::size_t first, const Vec3& v) {
        for (int axis = 0; axis < 3; ++axis) block[first + axis].of[lane] = v[axis];
      };
      const std::size_t member = members[i];
      if (layout.onePosition) write(0, bind[member] - bindMean_);
      for (const LiftedTerm& t : standing[member]) {
        const std::size_t bone =
            std::lower_bound(layout.bones.begin(), layout.bones.end(), t.joint) - layout.bones.begin();
        if (!layout.onePosition) write(4 * bone, t.moment - t.weight * bindMean_);
        block[layout.onePosition ? 3 + bone : 4 * bone + 3].of[lane] = t.weight;
      }
      order_.push_back(members[i]);
    }
    for (const JointIndex joint : layout.bones) {
      groupBones_.push_back(boneOfJoint[joint]);
      group.shapes = group.shapes || carrierOf(joint) != kNoJoint;
    }
    groups_.push_back(group);
    rowCount_ = std::max(rowCount_, group.firstRow + group.blocks * kBlock);
  }
}

LiftedPart::Moments LiftedPart::momentsOf(std::span<const Affine3> worldFromModel) const {
  // Far from the world's origin, working relative to one of the bones keeps precision.
  const Vec3 origin = worldFromModel[joints_.front()].translation();
  const FourColumns<double> sums = sumOverBones(worldFromModel, origin, joints_, sums_);
  const Eigen::Map<const Eigen::Matrix4d> sum(sums.column[0].data());
  // Offsets are from the bind mean, so their sum, and with it the mean, nearly cancels in the covariance.
  const Vec3 mean = sum.col(3).head<3>();
  return {mean + weightMean_ * origin, sum.topLeftCorner<3, 3>() - mean * offsetSum_.transpose()};
}

LiftedPart::TakenPose LiftedPart::noPose() const {
  TakenPose pose(joints_.size() + carriers_.size());
  for (FourColumns<float>& matrix : pose) {
    for (auto& column : matrix.column) column.fill(std::numeric_limits<float>::quiet_NaN());
  }
  return pose;
}

bool LiftedPart::take(std::span<const Affine3> worldFromModel, const Isometry3& worldFromPart, double tick,
                      TakenPose& taken) const {
  const BoneView view{worldFromPart.linear().transpose() / tick, worldFromPart.translation(), bindMean_,
                      static_cast<float>(radius_), static_cast<float>(kStill)};
  const std::size_t bones = joints_.size();
  if (!viewBones(worldFromModel, view, joints_, std::span(taken).first(bones))) return false;
  for (std::size_t b = 0; b < carriers_.size(); ++b) {
    taken[bones + b] = taken[b];
    if (carriers_[b] == b) continue;
    for (std::size_t c = 0; c < 4; ++c) {
      for (std::size_t r = 0; r < 3; ++r) taken[bones + b].column[c][r] -= taken[carriers_[b]].column[c][r];
    }
  }
  return true;
}

float LiftedPart::evaluate(const TakenPose& taken, std::span<PointRow> rows) const {
  LORICA_CHECK(rows.size() >= rowCount_, "rows must have at least rowCount() elements");
  return evaluateLifted(groups_, groupBones_, lanes_.data(), taken.data() + carriers_.size(), rows.data());
}

std::size_t LiftedPart::memory() const {
  return order_.size() * sizeof(order_[0]) + joints_.size() * (sizeof(JointIndex) + sizeof(FourColumns<double>)) +
         carriers_.size() * sizeof(carriers_[0]) + groups_.size() * sizeof(Group) +
         groupBones_.size() * sizeof(groupBones_[0]) + lanes_.size() * sizeof(Lane);
}

}  // namespace lorica
