#include "collision/lifted_part.h"

#include "collision/lifted_kernel.h"
#include "collision/rigid_fit.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace lorica {
namespace {

constexpr double kStill = 0.25;  // of a step: closer than this to the pose taken last, a pose is the same

using Bones = std::vector<JointIndex>;

Bones bonesOf(const LiftedPoint& point) {
  Bones bones;
  bones.reserve(point.size());
  for (const LiftedTerm& t : point) bones.push_back(t.joint);
  return bones;
}

/// Points by the bones that move them. A few points that would leave most of a block empty join those that follow the
/// same bones and some more.
std::map<Bones, std::vector<std::int32_t>> groupByBones(std::span<const LiftedPoint> points) {
  std::map<Bones, std::vector<std::int32_t>> groups;
  for (std::size_t i = 0; i < points.size(); ++i) groups[bonesOf(points[i])].push_back(static_cast<std::int32_t>(i));
  for (auto small = groups.begin(); small != groups.end();) {
    auto home = groups.end();
    if (small->second.size() <= LiftedPart::Terms::kPoints / 2) {
      for (auto other = groups.begin(); other != groups.end(); ++other) {
        if (other == small ||
            !std::includes(other->first.begin(), other->first.end(), small->first.begin(), small->first.end())) {
          continue;
        }
        if (home == groups.end() || other->first.size() < home->first.size()) home = other;
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

LiftedPart::LiftedPart(std::span<const LiftedPoint> points) {
  CHECK(!points.empty(), "a part has points");
  const double share = 1.0 / static_cast<double>(points.size());

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
    bone = static_cast<std::uint32_t>(bones_.size());
    bones_.emplace_back().joint = joint;
  }
  taken_.resize(bones_.size(), BoneMatrix::Constant(std::numeric_limits<float>::quiet_NaN()));
  next_ = taken_;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const LiftedTerm& t : points[i]) {
      BoneSums& bone = bones_[boneOfJoint[t.joint]];
      const Vec3 offset = bind[i] - bindMean_;
      const Vec3 moment = t.moment - t.weight * bindMean_;
      bone.meanMoment += share * moment;
      bone.meanWeight += share * t.weight;
      bone.spread.topRows<3>() += moment * offset.transpose();
      bone.spread.row(3) += t.weight * offset.transpose();
    }
  }

  // Blocks of points by bone set, moments about the part's mean.
  order_.reserve(points.size());
  for (const auto& [bones, members] : groupByBones(points)) {
    Group group;
    group.firstRow = static_cast<std::uint32_t>(order_.size());
    group.blocks = static_cast<std::uint32_t>((members.size() + Terms::kPoints - 1) / Terms::kPoints);
    group.firstTerms = static_cast<std::uint32_t>(terms_.size());
    group.firstBone = static_cast<std::uint32_t>(groupBones_.size());
    group.bones = static_cast<std::uint32_t>(bones.size());
    terms_.resize(terms_.size() + group.blocks * bones.size());
    for (std::size_t i = 0; i < members.size(); ++i) {
      Terms* block = &terms_[group.firstTerms + i / Terms::kPoints * bones.size()];
      for (const LiftedTerm& t : points[static_cast<std::size_t>(members[i])]) {
        const auto bone = std::lower_bound(bones.begin(), bones.end(), t.joint) - bones.begin();
        const Vec3 moment = t.moment - t.weight * bindMean_;
        const std::size_t lane = i % Terms::kPoints;
        block[bone].x[lane] = static_cast<float>(moment.x());
        block[bone].y[lane] = static_cast<float>(moment.y());
        block[bone].z[lane] = static_cast<float>(moment.z());
        block[bone].weight[lane] = static_cast<float>(t.weight);
      }
      order_.push_back(members[i]);
    }
    for (const JointIndex joint : bones) groupBones_.push_back(boneOfJoint[joint]);
    groups_.push_back(group);
    rowCount_ = std::max(rowCount_, group.firstRow + group.blocks * Terms::kPoints);
  }
}

Isometry3 LiftedPart::place(std::span<const Affine3> worldFromModel, const Mat3& previous) const {
  Vec3 mean = Vec3::Zero();
  for (const BoneSums& bone : bones_) {
    const Affine3& m = worldFromModel[static_cast<std::size_t>(bone.joint)];
    mean += m.linear() * bone.meanMoment + bone.meanWeight * (m * bindMean_);
  }
  // Offsets sum to zero, so the mean drops out of the covariance; without it, digits are kept far from the origin.
  Mat3 covariance = Mat3::Zero();
  for (const BoneSums& bone : bones_) {
    const Affine3& m = worldFromModel[static_cast<std::size_t>(bone.joint)];
    covariance += m.linear() * bone.spread.topRows<3>() + (m * bindMean_ - mean) * bone.spread.row(3);
  }
  Isometry3 worldFromPart = Isometry3::Identity();
  worldFromPart.linear() = fitRotation(covariance, previous);
  worldFromPart.translation() = mean;
  return worldFromPart;
}

bool LiftedPart::take(std::span<const Affine3> worldFromModel, const Isometry3& worldFromPart, double tick) {
  const Mat3 stepsFromWorld = worldFromPart.linear().transpose() / tick;
  // No point lies farther than the radius from the mean in the bind pose, so no entry moves one by more than this.
  const auto reach = static_cast<float>(3.0 * radius_);
  bool moved = false;
  for (std::size_t b = 0; b < bones_.size(); ++b) {
    const Affine3& m = worldFromModel[static_cast<std::size_t>(bones_[b].joint)];
    BoneMatrix& matrix = next_[b];
    matrix.leftCols<3>() = (stepsFromWorld * m.linear()).cast<float>();
    matrix.col(3) = (stepsFromWorld * (m * bindMean_ - worldFromPart.translation())).cast<float>();
    const BoneMatrix change = (matrix - taken_[b]).cwiseAbs();
    const float most = change.leftCols<3>().maxCoeff() * reach + change.col(3).maxCoeff();
    if (!(most <= static_cast<float>(kStill))) moved = true;  // also when nothing was taken yet
  }
  if (moved) std::swap(next_, taken_);
  return moved;
}

float LiftedPart::evaluate(std::span<PointRow> rows) const {
  CHECK(rows.size() >= rowCount_, "the caller sizes rows: rowCount() of them");
  return evaluateLifted(groups_, groupBones_, terms_.data(), taken_.front().data(), rows.data());
}

std::size_t LiftedPart::memory() const {
  return order_.size() * sizeof(order_[0]) + bones_.size() * sizeof(BoneSums) + 2 * taken_.size() * sizeof(BoneMatrix) +
         groups_.size() * sizeof(Group) + groupBones_.size() * sizeof(groupBones_[0]) + terms_.size() * sizeof(Terms);
}

}  // namespace lorica
