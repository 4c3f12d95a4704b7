#include "capture/files/bvh_file.h"

#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/files.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace lorica {
namespace {

constexpr double kUnitsPerMetre = 100.0;
/// Joints that translate less than this relative to their parent need no position channels [m].
constexpr double kStill = 1e-6;
constexpr double kUsualStep = 1.0 / 30.0;

std::string wordOf(const std::string& name) {
  std::string out = name.empty() ? "joint" : name;
  for (char& c : out) {
    if (static_cast<unsigned char>(c) <= ' ' || c == '{' || c == '}') c = '_';
  }
  return out;
}

/// One word for each joint. Readers find joints by their names: those that repeat get numbers.
std::vector<std::string> wordsOf(std::span<const Joint> joints) {
  std::vector<std::string> words;
  std::set<std::string> taken;
  for (const Joint& joint : joints) taken.insert(wordOf(joint.name));
  std::set<std::string> used;
  for (const Joint& joint : joints) {
    std::string word = wordOf(joint.name);
    for (int copy = 2; used.contains(word); ++copy) {
      const std::string numbered = fmt::format("{}_{}", wordOf(joint.name), copy);
      if (!taken.contains(numbered)) word = numbered;
    }
    used.insert(word);
    words.push_back(std::move(word));
  }
  return words;
}

/// Angles about Z, X, Y in degrees; the rotation is Rz * Rx * Ry.
Vec3 anglesZxy(const Quat& q) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  const Mat3 m = q.toRotationMatrix();
  const double cosine = std::hypot(m(2, 0), m(2, 2));
  const double x = std::atan2(m(2, 1), cosine);
  if (cosine < 1e-9) return kDegrees * Vec3(std::atan2(m(1, 0), m(0, 0)), x, 0.0);
  return kDegrees * Vec3(std::atan2(-m(0, 1), m(1, 1)), x, std::atan2(-m(2, 0), m(2, 2)));
}

/// World positions and rotations of all joints; scales affect positions only.
struct WorldPose {
  std::vector<Vec3> position;
  std::vector<Quat> rotation;

  void compute(const Skeleton& skeleton, std::span<const JointTransform> pose, std::vector<Affine3>& scratch) {
    scratch.resize(pose.size());
    position.resize(pose.size());
    rotation.resize(pose.size());
    computeWorldFromJoint(skeleton, pose, scratch);
    for (int j = 0; j < countOf(pose); ++j) {
      const JointIndex parent = skeleton.joint(j).parent;
      const Quat above = parent == kNoJoint ? Quat::Identity() : rotation[parent];
      rotation[j] = (above * pose[j].rotation).normalized();
      position[j] = scratch[j].translation();
    }
  }
};

/// A joint as written to the file: its axes are the world's at rest.
struct FileJoint {
  Vec3 offset;  ///< [m]
  bool moves = false;
};

class Writer {
 public:
  explicit Writer(const SkeletalMotion& motion)
      : motion_(motion),
        skeleton_(motion.skeleton),
        count_(skeleton_.jointCount()),
        words_(wordsOf(skeleton_.joints())) {}

  std::string write() {
    const Pose atRest = restPose(skeleton_);
    rest_.compute(skeleton_, atRest, scratch_);
    joints_.resize(count_);
    children_.resize(count_);
    for (int j = 0; j < count_; ++j) {
      const JointIndex parent = parentOf(j);
      joints_[j].moves = parent == kNoJoint;
      joints_[j].offset = parent == kNoJoint ? rest_.position[j] : rest_.position[j] - rest_.position[parent];
      if (parent != kNoJoint) children_[parent].push_back(j);
    }
    for (int f = 0; f < motion_.frameCount(); ++f) {
      world_.compute(skeleton_, motion_.pose(f), scratch_);
      for (int j = 0; j < count_; ++j) {
        joints_[j].moves = joints_[j].moves || (positionInParent(j) - joints_[j].offset).norm() > kStill;
      }
    }
    writeHierarchy();
    writeFrames();
    return std::move(text_);
  }

 private:
  [[nodiscard]] JointIndex parentOf(JointIndex joint) const { return skeleton_.joint(joint).parent; }
  /// worldFromFileJoint rotation: identity at rest.
  [[nodiscard]] Quat turnOf(JointIndex joint) const {
    return world_.rotation[joint] * rest_.rotation[joint].conjugate();
  }
  [[nodiscard]] Vec3 positionInParent(JointIndex joint) const {
    const JointIndex parent = parentOf(joint);
    if (parent == kNoJoint) return world_.position[joint];
    return turnOf(parent).conjugate() * (world_.position[joint] - world_.position[parent]);
  }
  template <typename... Values>
  void print(fmt::format_string<Values...> format, Values&&... values) {
    text_ += fmt::format(format, std::forward<Values>(values)...);
  }
  void printVector(const Vec3& v) { print("{:.6f} {:.6f} {:.6f}", v.x(), v.y(), v.z()); }

  /// Depth first, as the braces require. Uses an explicit stack, because skeletons may be deep.
  void writeHierarchy() {
    struct Open {
      JointIndex joint;
      int nextChild;
    };
    text_ = "HIERARCHY\n";
    std::vector<Open> open;
    const auto begin = [&](JointIndex joint) {
      const std::string indent(open.size(), '\t');
      print("{}{} {}\n{}{{\n{}\tOFFSET ", indent, open.empty() ? "ROOT" : "JOINT", words_[joint], indent, indent);
      printVector(kUnitsPerMetre * joints_[joint].offset);
      print("\n{}\tCHANNELS {} Zrotation Xrotation Yrotation\n", indent,
            joints_[joint].moves ? "6 Xposition Yposition Zposition" : "3");
      if (children_[joint].empty()) {
        print("{}\tEnd Site\n{}\t{{\n{}\t\tOFFSET 0 0 0\n{}\t}}\n", indent, indent, indent, indent);
      }
      order_.push_back(joint);
      open.push_back({joint, 0});
    };
    for (int root = 0; root < count_; ++root) {
      if (parentOf(root) != kNoJoint) continue;
      begin(root);
      while (!open.empty()) {
        Open& top = open.back();
        if (top.nextChild < countOf(children_[top.joint])) {
          begin(children_[top.joint][top.nextChild++]);
        } else {
          open.pop_back();
          print("{}}}\n", std::string(open.size(), '\t'));
        }
      }
    }
  }

  /// The pose at a time, interpolated between the two surrounding frames.
  std::span<const JointTransform> poseAt(double time, int& frame) {
    while (frame + 2 < motion_.frameCount() && motion_.times[frame + 1] <= time) ++frame;
    const double from = motion_.times[frame];
    const double to = frame + 1 < motion_.frameCount() ? motion_.times[frame + 1] : from;
    const double share = to > from ? std::clamp((time - from) / (to - from), 0.0, 1.0) : 0.0;
    constexpr double kSame = 1e-6;
    if (share < kSame) return motion_.pose(frame);
    if (share > 1.0 - kSame) return motion_.pose(frame + 1);
    const std::span<const JointTransform> a = motion_.pose(frame);
    const std::span<const JointTransform> b = motion_.pose(frame + 1);
    between_.resize(count_);
    for (int j = 0; j < count_; ++j) {
      between_[j].translation = a[j].translation + share * (b[j].translation - a[j].translation);
      between_[j].rotation = a[j].rotation.slerp(share, b[j].rotation);
      between_[j].scale = a[j].scale + share * (b[j].scale - a[j].scale);
    }
    return between_;
  }

  void writeFrames() {
    const int frames = motion_.frameCount();
    const double first = motion_.times.front();
    const double step = frames > 1 ? (motion_.times.back() - first) / (frames - 1) : kUsualStep;
    print("MOTION\nFrames: {}\nFrame Time: {:.9f}\n", frames, step);
    int at = 0;
    for (int f = 0; f < frames; ++f) {
      world_.compute(skeleton_, poseAt(first + f * step, at), scratch_);
      for (const JointIndex joint : order_) {
        if (joint != order_.front()) text_ += ' ';
        if (joints_[joint].moves) {
          printVector(kUnitsPerMetre * positionInParent(joint));
          text_ += ' ';
        }
        const JointIndex parent = parentOf(joint);
        const Quat above = parent == kNoJoint ? Quat::Identity() : turnOf(parent);
        printVector(anglesZxy((above.conjugate() * turnOf(joint)).normalized()));
      }
      text_ += '\n';
    }
  }

  const SkeletalMotion& motion_;
  const Skeleton& skeleton_;
  int count_;
  std::vector<std::string> words_;  ///< the joints' names in the file
  std::vector<FileJoint> joints_;
  std::vector<std::vector<JointIndex>> children_;
  std::vector<JointIndex> order_;
  WorldPose rest_;
  WorldPose world_;
  Pose between_;
  std::vector<Affine3> scratch_;
  std::string text_;
};

}  // namespace

Result<void> writeBvh(const std::filesystem::path& file, const SkeletalMotion& motion) {
  const auto joints = static_cast<std::size_t>(motion.skeleton.jointCount());
  if (motion.times.empty() || motion.poses.size() != motion.times.size() * joints) {
    return invalidArgument("{}: the motion has {} joint transforms, expected {} frames of {}, and at least one frame",
                           file.string(), motion.poses.size(), motion.times.size(), joints);
  }
  for (std::size_t i = 0; i < motion.poses.size(); ++i) {
    const JointTransform& t = motion.poses[i];
    if (t.translation.allFinite() && t.rotation.coeffs().allFinite() && t.scale.allFinite()) continue;
    return invalidArgument("{}: frame {}: the pose of joint '{}' is not finite", file.string(), i / joints + 1,
                           motion.skeleton.joint(static_cast<JointIndex>(i % joints)).name);
  }
  return writeFileAtomically(file, Writer(motion).write());
}

}  // namespace lorica
