#include "tests/bench/generators/virtual_clothes.h"

#include "geometry/counts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace lorica {
namespace {

using B = HumanBone;

constexpr int kSegments = 32;  ///< of a ring
/// Lengths below are those of a person of this height, and scale with it [m].
constexpr double kUsualHeight = 1.75;

/// Cross-section of a piece: an ellipse.
struct Ring {
  Vec3 centre = Vec3::Zero();
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();  ///< semi-axes; a x b points to the next ring
};

/// Rises smoothly from 0 at `from` to 1 at `to`, which may be the smaller one.
double smoothly(double from, double to, double value) {
  const double part = std::clamp((value - from) / (to - from), 0.0, 1.0);
  return part * part * (3.0 - 2.0 * part);
}

/// Measures a body in its bind pose and adds pieces to it.
class Tailor {
 public:
  explicit Tailor(const Character& body) : dressed_(body), unit_(body.height / kUsualHeight) {
    const std::size_t jointCount = body.skeleton.jointCount();
    std::vector<std::optional<B>> boneOfJoint(jointCount);
    for (int bone = 0; bone < kHumanBoneCount; ++bone) {
      const JointIndex joint = body.skeleton.jointOf(static_cast<B>(bone));
      if (joint != kNoJoint) boneOfJoint[joint] = static_cast<B>(bone);
    }
    // Joints between two humanoid bones belong to the upper one. Parents precede children.
    for (std::size_t j = 0; j < jointCount; ++j) {
      const JointIndex parent = body.skeleton.joint(j).parent;
      if (!boneOfJoint[j] && parent != kNoJoint) boneOfJoint[j] = boneOfJoint[parent];
    }
    boneOfVertex_.resize(body.mesh.vertices.size());
    for (std::size_t v = 0; v < boneOfVertex_.size(); ++v) {
      double most = 0.0;
      for (std::uint32_t i = body.influenceBegin[v]; i < body.influenceBegin[v + 1]; ++i) {
        if (body.influences[i].weight <= most) continue;
        most = body.influences[i].weight;
        boneOfVertex_[v] = boneOfJoint[body.influences[i].joint];
      }
    }
  }

  [[nodiscard]] Character finished() && { return std::move(dressed_); }

  void add(Clothes piece) {
    switch (piece) {
      case Clothes::kTrousers:
        return addTrousers();
      case Clothes::kSkirt:
        return addSkirt();
      case Clothes::kCoat:
        return addCoat();
      case Clothes::kHair:
        return addHair();
    }
  }

 private:
  [[nodiscard]] bool has(std::initializer_list<B> bones) const {
    return std::all_of(bones.begin(), bones.end(), [&](B bone) { return dressed_.skeleton.jointOf(bone) != kNoJoint; });
  }
  [[nodiscard]] Vec3 at(B bone) const {
    return dressed_.jointFromModel[dressed_.skeleton.jointOf(bone)].inverse().translation();
  }

  /// The ellipse around the body's cross-section at a point.
  /// @param centre  on the axis
  /// @param along   unit direction to the next ring
  /// @param across  unit, perpendicular to it
  /// @param bones   those whose skin is measured
  /// @param ease    distance of the cloth from the skin [m]
  [[nodiscard]] Ring around(const Vec3& centre, const Vec3& along, const Vec3& across, std::initializer_list<B> bones,
                            double ease) const {
    const Vec3 other = along.cross(across);
    Eigen::Vector2d min = Eigen::Vector2d::Constant(1e9), max = -min;
    for (std::size_t v = 0; v < boneOfVertex_.size(); ++v) {
      if (!boneOfVertex_[v] || std::find(bones.begin(), bones.end(), *boneOfVertex_[v]) == bones.end()) continue;
      const Vec3 from = dressed_.mesh.vertices[v] - centre;
      if (std::abs(from.dot(along)) > 0.03 * unit_) continue;
      const Eigen::Vector2d seen(from.dot(across), from.dot(other));
      min = min.cwiseMin(seen);
      max = max.cwiseMax(seen);
    }
    if (min.x() > max.x()) min = Eigen::Vector2d::Constant(-0.04 * unit_), max = -min;
    const Eigen::Vector2d middle = 0.5 * (min + max), half = 0.5 * (max - min);
    return {centre + middle.x() * across + middle.y() * other, (half.x() + ease * unit_) * across,
            (half.y() + ease * unit_) * other};
  }

  /// A level ring around the hips' axis at a height.
  [[nodiscard]] Ring level(double height, std::initializer_list<B> bones, double ease) const {
    return around({at(B::kHips).x(), height, at(B::kHips).z()}, -Vec3::UnitY(), Vec3::UnitX(), bones, ease);
  }

  /// Level rings from the top to the hem, where the distance from the skin is larger by `flare` [m]. After a part of
  /// the way each is at least as wide as the one before: cloth hangs down.
  [[nodiscard]] std::vector<Ring> hanging(int count, double top, double hem, std::initializer_list<B> bones,
                                          double ease, double flare, double from) const {
    std::vector<Ring> rings;
    for (int r = 0; r < count; ++r) {
      const double part = static_cast<double>(r) / (count - 1);
      Ring ring = level(top + part * (hem - top), bones, ease + flare * part);
      if (part > from && ring.a.norm() < rings.back().a.norm()) ring.a = rings.back().a;
      if (part > from && ring.b.norm() < rings.back().b.norm()) ring.b = rings.back().b;
      rings.push_back(ring);
    }
    return rings;
  }

  /// Adds the closed surface through rings. @param weigh  (position, influences to fill)
  template <typename Weigh>
  void addTube(std::span<const Ring> rings, const Weigh& weigh) {
    const auto first = countOf(dressed_.mesh.vertices);
    const auto addVertex = [&](const Vec3& position) {
      dressed_.mesh.vertices.push_back(position);
      std::vector<Influence> weights;
      weigh(position, weights);
      std::erase_if(weights, [](const Influence& one) { return one.weight <= 0.0; });
      double sum = 0.0;
      for (const Influence& one : weights) sum += one.weight;
      for (Influence one : weights) dressed_.influences.push_back({one.joint, one.weight / sum});
      dressed_.influenceBegin.push_back(dressed_.influences.size());
    };
    for (const Ring& ring : rings) {
      for (int k = 0; k < kSegments; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / kSegments;
        addVertex(ring.centre + std::cos(angle) * ring.a + std::sin(angle) * ring.b);
      }
    }
    const auto ringCount = countOf(rings);
    const int begin = first + ringCount * kSegments, end = begin + 1;
    addVertex(rings.front().centre);
    addVertex(rings.back().centre);

    const auto addTriangle = [&](int a, int b, int c) {
      dressed_.mesh.triangles.push_back({a, b, c});
      if (!dressed_.shown.empty()) dressed_.shown.push_back({a, b, c});
    };
    for (int k = 0; k < kSegments; ++k) {
      const int next = (k + 1) % kSegments;
      addTriangle(begin, first + next, first + k);
      for (int r = first; r + kSegments < begin; r += kSegments) {
        addTriangle(r + k, r + next, r + kSegments + next);
        addTriangle(r + k, r + kSegments + next, r + kSegments + k);
      }
      addTriangle(end, begin - kSegments + k, begin - kSegments + next);
    }
  }

  void give(std::vector<Influence>& weights, B bone, double weight) const {
    weights.push_back({dressed_.skeleton.jointOf(bone), weight});
  }

  /// Cloth below the waist: it hangs from the hips and is carried by the thigh on its side.
  void weighBelowWaist(const Vec3& position, double carried, std::vector<Influence>& weights) const {
    const double side = position.x() - at(B::kHips).x();
    const double left = smoothly(-0.08 * unit_, 0.08 * unit_, side);
    const double hip = 0.5 * (at(B::kLeftUpperLeg).y() + at(B::kRightUpperLeg).y());
    const double thighs = carried * smoothly(hip + 0.05 * unit_, hip - 0.2 * unit_, position.y());
    give(weights, B::kHips, 1.0 - thighs);
    give(weights, B::kLeftUpperLeg, thighs * left);
    give(weights, B::kRightUpperLeg, thighs * (1.0 - left));
  }

  /// Bones of the trunk from the hips up, by height.
  void weighTrunk(double height, std::vector<Influence>& weights) const {
    constexpr std::array kTrunk = {B::kHips, B::kSpine, B::kChest, B::kUpperChest, B::kNeck};
    std::vector<B> bones;
    for (const B bone : kTrunk) {
      if (has({bone})) bones.push_back(bone);
    }
    std::size_t above = 0;
    while (above < bones.size() && at(bones[above]).y() <= height) ++above;
    if (above == 0 || above == bones.size()) return give(weights, above == 0 ? bones.front() : bones.back(), 1.0);
    const double low = at(bones[above - 1]).y(), high = at(bones[above]).y();
    const double part = (height - low) / (high - low);
    give(weights, bones[above - 1], 1.0 - part);
    give(weights, bones[above], part);
  }

  /// A sleeve or a leg of trousers along two bones.
  /// @param from,to  part of the first bone's length at which it begins, and of the second at which it ends
  /// @param ease     distance from the skin at its begin and end [m]
  void addLimb(B upper, B lower, B tip, const Vec3& across, double from, double to, double easeFrom, double easeTo,
               B trunk) {
    if (!has({upper, lower, tip, trunk})) return;
    const Vec3 root = at(upper), bend = at(lower), end = at(tip);
    constexpr int kRings = 12;
    const double upperLength = (bend - root).norm(), lowerLength = (end - bend).norm();
    std::vector<Ring> rings;
    rings.reserve(kRings);
    for (int r = 0; r < kRings; ++r) {
      const double part = static_cast<double>(r) / (kRings - 1);
      const double way = from * upperLength + part * (upperLength * (1.0 - from) + to * lowerLength);
      const bool below = way > upperLength;
      const Vec3 along = (below ? end - bend : bend - root).normalized();
      const Vec3 centre = below ? Vec3(bend + (way - upperLength) * along) : Vec3(root + way * along);
      const Vec3 level = (across - across.dot(along) * along).normalized();
      rings.push_back(around(centre, along, level, {upper, lower}, easeFrom + part * (easeTo - easeFrom)));
    }
    const Vec3 first = (bend - root).normalized(), second = (end - bend).normalized();
    addTube(rings, [&](const Vec3& position, std::vector<Influence>& weights) {
      const double past = (position - bend).dot((first + second).normalized());
      const double shin = smoothly(-0.08 * unit_, 0.08 * unit_, past);
      const double hung = 0.4 * smoothly(0.12 * unit_, -0.02 * unit_, (position - root).dot(first));
      give(weights, trunk, hung);
      give(weights, upper, (1.0 - hung) * (1.0 - shin));
      give(weights, lower, (1.0 - hung) * shin);
    });
  }

  void addTrousers() {
    if (!has({B::kHips, B::kLeftUpperLeg, B::kRightUpperLeg})) return;
    const double hip = at(B::kLeftUpperLeg).y();
    std::vector<Ring> rings;
    for (const double y : {0.10, 0.05, 0.0, -0.05, -0.10}) {
      rings.push_back(level(hip + y * unit_, {B::kHips, B::kSpine, B::kLeftUpperLeg, B::kRightUpperLeg}, 0.015));
    }
    addTube(rings,
            [&](const Vec3& position, std::vector<Influence>& weights) { weighBelowWaist(position, 0.6, weights); });
    addLimb(B::kLeftUpperLeg, B::kLeftLowerLeg, B::kLeftFoot, Vec3::UnitX(), 0.05, 0.95, 0.02, 0.06, B::kHips);
    addLimb(B::kRightUpperLeg, B::kRightLowerLeg, B::kRightFoot, Vec3::UnitX(), 0.05, 0.95, 0.02, 0.06, B::kHips);
  }

  void addSkirt() {
    if (!has({B::kHips, B::kLeftUpperLeg, B::kRightUpperLeg, B::kLeftLowerLeg})) return;
    const double waist = at(B::kLeftUpperLeg).y() + 0.12 * unit_;
    const double hem = at(B::kLeftLowerLeg).y() - 0.10 * unit_;
    const std::vector<Ring> rings = hanging(
        12, waist, hem, {B::kHips, B::kSpine, B::kLeftUpperLeg, B::kRightUpperLeg, B::kLeftLowerLeg, B::kRightLowerLeg},
        0.015, 0.11, 0.0);
    addTube(rings,
            [&](const Vec3& position, std::vector<Influence>& weights) { weighBelowWaist(position, 0.85, weights); });
  }

  void addCoat() {
    if (!has({B::kHips, B::kNeck, B::kLeftUpperLeg, B::kRightUpperLeg, B::kLeftLowerLeg})) return;
    const double top = at(B::kNeck).y() - 0.01 * unit_;
    const double hip = at(B::kLeftUpperLeg).y();
    const double hem = at(B::kLeftLowerLeg).y() + 0.10 * unit_;
    // From the chest down it hangs; its shoulders follow the body.
    const std::vector<Ring> rings =
        hanging(24, top, hem, {B::kHips, B::kSpine, B::kChest, B::kUpperChest, B::kLeftUpperLeg, B::kRightUpperLeg},
                0.025, 0.06, 0.25);
    addTube(rings, [&](const Vec3& position, std::vector<Influence>& weights) {
      if (position.y() > hip + 0.05 * unit_) {
        weighTrunk(position.y(), weights);
      } else {
        weighBelowWaist(position, 0.7, weights);
      }
    });
    const B chest = has({B::kUpperChest}) ? B::kUpperChest : has({B::kChest}) ? B::kChest : B::kSpine;
    addLimb(B::kLeftUpperArm, B::kLeftLowerArm, B::kLeftHand, Vec3::UnitZ(), 0.0, 0.95, 0.025, 0.04, chest);
    addLimb(B::kRightUpperArm, B::kRightLowerArm, B::kRightHand, Vec3::UnitZ(), 0.0, 0.95, 0.025, 0.04, chest);
  }

  void addHair() {
    if (!has({B::kHead, B::kNeck, B::kHips})) return;
    const Vec3 head = at(B::kHead), neck = at(B::kNeck);
    double crown = head.y();
    for (std::size_t v = 0; v < boneOfVertex_.size(); ++v) {
      if (boneOfVertex_[v] == B::kHead) crown = std::max(crown, dressed_.mesh.vertices[v].y());
    }
    const double chin = head.y() + 0.02 * unit_, end = neck.y() - 0.18 * unit_;
    constexpr int kRings = 16;
    std::vector<Ring> rings;
    rings.reserve(kRings);
    const Ring widest =
        around({head.x(), 0.6 * crown + 0.4 * head.y(), head.z()}, -Vec3::UnitY(), Vec3::UnitX(), {B::kHead}, 0.0);
    const double top = crown + 0.02 * unit_;
    for (int r = 0; r < kRings; ++r) {
      const double part = static_cast<double>(r) / (kRings - 1);
      // Round at the crown; below, a curtain behind the face, the neck and the back.
      const double y = top + part * (end - top);
      const double dome = std::sqrt(1.0 - std::pow(std::clamp((y - chin) / (top - chin) * 2.0 - 1.0, 0.0, 0.98), 2));
      const double fall = smoothly(chin, end, y);
      Ring ring;
      ring.a = (widest.a.norm() + 0.025 * unit_ + 0.03 * unit_ * fall) * dome * Vec3::UnitX();
      ring.b = ((1.0 - 0.5 * fall) * (widest.b.norm() + 0.005 * unit_)) * dome * Vec3::UnitZ();
      ring.centre = {head.x(), y, widest.centre.z() - (0.035 + 0.05 * fall) * unit_};
      rings.push_back(ring);
    }
    addTube(rings, [&](const Vec3& position, std::vector<Influence>& weights) {
      const double carried = smoothly(chin, end, position.y());
      give(weights, B::kHead, 1.0 - carried);
      std::vector<Influence> back;
      weighTrunk(std::min(position.y(), neck.y() - 0.05 * unit_), back);
      for (const Influence& one : back) weights.push_back({one.joint, carried * one.weight});
    });
  }

  Character dressed_;
  double unit_;  ///< length of a metre of a person of the usual height [m]
  std::vector<std::optional<B>> boneOfVertex_;
};

}  // namespace

std::optional<Clothes> clothesNamed(std::string_view name) {
  const auto at = std::ranges::find(kClothesNames, name) - kClothesNames.begin();
  return at < std::ssize(kClothesNames) ? std::optional(static_cast<Clothes>(at)) : std::nullopt;
}

Character withClothes(const Character& character, std::span<const Clothes> pieces) {
  Tailor tailor(character);
  for (const Clothes piece : pieces) tailor.add(piece);
  return std::move(tailor).finished();
}

}  // namespace lorica
