#include "skinning/humanoid/humanoid_names.h"
#include "skinning/mannequin/mannequin_skeleton.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

namespace lorica {

namespace {

using enum HumanBone;

enum class Segment { kMetacarpal, kProximal, kIntermediate, kDistal, kNumbered };

struct FingerName {
  int finger = 0;  ///< 0 = thumb to 4 = little finger
  Segment segment = Segment::kNumbered;
};

/// A word split into its letters and the number at its end.
struct LettersAndNumber {
  std::string letters;
  std::string number;
};

[[nodiscard]] LettersAndNumber takeApart(const std::string& word) {
  std::size_t end = word.size();
  while (end > 0 && word[end - 1] >= '0' && word[end - 1] <= '9') --end;
  return {word.substr(0, end), word.substr(end)};
}

[[nodiscard]] std::optional<int> fingerCalled(std::string_view letters) {
  constexpr std::string_view kNames[5][4] = {
      {"thumb", "thb", "", ""}, {"index", "indx", "pointer", "forefinger"}, {"middle", "mid", "", ""},
      {"ring", "", "", ""},     {"little", "pinky", "pinkie", "pink"},
  };
  for (int finger = 0; finger < 5; ++finger) {
    for (const std::string_view name : kNames[finger]) {
      if (!name.empty() && name == letters) return finger;
    }
  }
  return std::nullopt;
}

[[nodiscard]] std::optional<Segment> segmentCalled(std::string_view letters) {
  if (letters == "metacarpal" || letters == "palm" || letters == "in" || letters == "meta") return Segment::kMetacarpal;
  if (letters == "proximal" || letters == "prox") return Segment::kProximal;
  if (letters == "intermediate" || letters == "inter" || letters == "medial") return Segment::kIntermediate;
  if (letters == "distal" || letters == "dist") return Segment::kDistal;
  return std::nullopt;
}

/// Parses names such as "handthumb1", "f, index, 01", "finger1, 2" (MakeHuman's thumb), "finger12" (Biped's index) and
/// "digit2, metacarpal".
/// @param thumbIsZero  whether numbered fingers start at 0
[[nodiscard]] std::optional<FingerName> readFinger(const JointName& name, bool thumbIsZero) {
  if (name.side == Side::kMiddle || name.preference == 3) return std::nullopt;
  std::optional<int> finger;
  FingerName read;
  for (const std::string& word : name.words) {
    auto [letters, number] = takeApart(word);
    if (letters.starts_with("hand") && letters.size() > 4) letters.erase(0, 4);
    if (const std::optional<int> called = fingerCalled(letters)) {
      finger = called;  // for "RingPinky1" the last one
    } else if ((letters == "finger" || letters == "digit") && !number.empty() && !finger) {
      finger = number[0] - '0' - (thumbIsZero ? 0 : 1);
      if (*finger < 0 || *finger > 4) return std::nullopt;
    } else if (const std::optional<Segment> segment = segmentCalled(letters)) {
      read.segment = *segment;
    } else {
      const bool plain = letters.empty() || letters == "hand" || letters == "finger" || letters == "f" ||
                         letters == "phalange" || letters == "phalanx" || letters == "a" || letters == "b" ||
                         letters == "c";
      if (!plain) return std::nullopt;
    }
  }
  if (!finger) return std::nullopt;
  read.finger = *finger;
  return read;
}

constexpr std::array<std::array<HumanBone, 3>, 5> kFingers = {{
    {kLeftThumbMetacarpal, kLeftThumbProximal, kLeftThumbDistal},
    {kLeftIndexProximal, kLeftIndexIntermediate, kLeftIndexDistal},
    {kLeftMiddleProximal, kLeftMiddleIntermediate, kLeftMiddleDistal},
    {kLeftRingProximal, kLeftRingIntermediate, kLeftRingDistal},
    {kLeftLittleProximal, kLeftLittleIntermediate, kLeftLittleDistal},
}};

struct NamedFinger {
  JointIndex joint;
  Segment segment;
};

/// The chain that starts at the first joint: each further joint is below the one before.
[[nodiscard]] std::vector<NamedFinger> chainOf(const JointTree& tree, const std::vector<NamedFinger>& joints) {
  std::vector<NamedFinger> chain;
  // Parents precede children, so the joints are in the order of the chain.
  for (const NamedFinger& next : joints) {
    if (chain.empty() || tree.isBelow(next.joint, chain.back().joint)) chain.push_back(next);
  }
  return chain;
}

void assignFinger(int finger, Side side, std::vector<NamedFinger> chain, BoneJoints& bones) {
  const std::array<HumanBone, 3>& row = kFingers[finger];
  if (finger > 0) std::erase_if(chain, [](const NamedFinger& f) { return f.segment == Segment::kMetacarpal; });
  const bool inWords = std::any_of(chain.begin(), chain.end(), [](const NamedFinger& f) {
    return f.segment == Segment::kProximal || f.segment == Segment::kDistal;
  });
  const bool hasIntermediate =
      std::any_of(chain.begin(), chain.end(), [](const NamedFinger& f) { return f.segment == Segment::kIntermediate; });
  std::size_t next = 0;
  // VRM 1.0 calls a thumb's bones metacarpal, proximal, distal; VRM 0.x proximal, intermediate, distal.
  if (finger == 0 && inWords && !hasIntermediate && chain.front().segment == Segment::kProximal) next = 1;
  for (const NamedFinger& joint : chain) {
    if (next == row.size()) break;
    const HumanBone bone = side == Side::kRight ? mirrored(row[next]) : row[next];
    if (jointOf(bones, bone) == kNoJoint) jointOf(bones, bone) = joint.joint;
    ++next;
  }
}

}  // namespace

void addFingersByNames(const JointTree& tree, std::span<const JointName> names, BoneJoints& bones) {
  const bool thumbIsZero = std::any_of(names.begin(), names.end(), [](const JointName& name) {
    return std::any_of(name.words.begin(), name.words.end(),
                       [](const std::string& word) { return word.starts_with("finger0"); });
  });
  for (const Side side : {Side::kLeft, Side::kRight}) {
    const JointIndex hand = jointOf(bones, side == Side::kLeft ? kLeftHand : kRightHand);
    if (hand == kNoJoint) continue;
    std::array<std::vector<NamedFinger>, 5> found;
    for (JointIndex joint = 0; joint < tree.jointCount(); ++joint) {
      const JointName& name = names[joint];
      if (name.side != side || !tree.isBelow(joint, hand)) continue;
      if (std::find(bones.begin(), bones.end(), joint) != bones.end()) continue;
      const std::optional<FingerName> read = readFinger(name, thumbIsZero);
      if (read) found[read->finger].push_back({joint, read->segment});
    }
    for (int finger = 0; finger < 5; ++finger) {
      const std::vector<NamedFinger> chain = chainOf(tree, found[finger]);
      if (!chain.empty()) assignFinger(finger, side, chain, bones);
    }
  }
}

}  // namespace lorica
