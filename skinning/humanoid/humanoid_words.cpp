#include "skinning/humanoid/humanoid_words.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <string_view>

namespace lorica {

namespace {

using Words = std::vector<std::string>;

[[nodiscard]] bool isUpper(char c) {
  return c >= 'A' && c <= 'Z';
}
[[nodiscard]] bool isLower(char c) {
  return c >= 'a' && c <= 'z';
}
[[nodiscard]] bool isDigit(char c) {
  return c >= '0' && c <= '9';
}
/// UTF-8 bytes beyond ASCII count as letters, so that names in other scripts are not split.
[[nodiscard]] bool isWordByte(char c) {
  return isUpper(c) || isLower(c) || isDigit(c) || static_cast<unsigned char>(c) >= 0x80;
}
[[nodiscard]] bool isNumber(const std::string& word) {
  return !word.empty() && std::all_of(word.begin(), word.end(), isDigit);
}

/// "LHipJoint" is l, hip, joint; "Bip01 L Finger0Nub" is bip01, l, finger0, nub.
[[nodiscard]] Words split(std::string_view name) {
  // The text before the last ':' or '|' is a namespace or a path.
  const std::size_t colon = name.find_last_of(":|");
  if (colon != std::string_view::npos && colon + 1 < name.size()) name.remove_prefix(colon + 1);
  Words words;
  std::string word;
  const auto finish = [&] {
    if (!word.empty()) words.push_back(word);
    word.clear();
  };
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    if (!isWordByte(c)) {
      finish();
      continue;
    }
    if (isUpper(c) && !word.empty()) {
      const bool wordEnded = isLower(name[i - 1]) || isDigit(name[i - 1]);
      const bool capitalsEnded = i + 1 < name.size() && isUpper(name[i - 1]) && isLower(name[i + 1]);
      if (wordEnded || capitalsEnded) finish();
    }
    word += isUpper(c) ? static_cast<char>(c - 'A' + 'a') : c;
  }
  finish();
  return words;
}

[[nodiscard]] Side sideOf(const std::string& word) {
  if (word == "l" || word == "left" || word == "lft" || word == "lf") return Side::kLeft;
  if (word == "r" || word == "right" || word == "rgt" || word == "rt") return Side::kRight;
  return Side::kMiddle;
}

/// Removes the side from the words and returns it: a separate word, or attached to one ("lefthand", "armR001").
[[nodiscard]] Side takeSide(Words& words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    const Side side = sideOf(words[i]);
    if (side == Side::kMiddle || words.size() == 1) continue;
    words.erase(words.begin() + i);
    return side;
  }
  for (std::string& word : words) {
    // Blender's "hand.L.001" without its dots. L5 is a vertebra, so a leading zero is required.
    if (word.size() > 2 && (word[0] == 'l' || word[0] == 'r') && word[1] == '0' && isNumber(word.substr(1))) {
      const Side side = sideOf(word.substr(0, 1));
      word.erase(0, 1);
      return side;
    }
    for (const std::string_view marker : {"left", "right"}) {
      if (word.size() <= marker.size()) continue;
      const Side side = marker == "left" ? Side::kLeft : Side::kRight;
      if (word.starts_with(marker)) {
        word.erase(0, marker.size());
        return side;
      }
      if (word.ends_with(marker)) {
        word.erase(word.size() - marker.size());
        return side;
      }
    }
    for (const std::string_view marker : {"左", "右"}) {
      if (word.size() <= marker.size() || !word.starts_with(marker)) continue;
      word.erase(0, marker.size());
      return marker == "左" ? Side::kLeft : Side::kRight;
    }
  }
  return Side::kMiddle;
}

/// Removes running numbers that an exporter appended to each name: "b_Hip_01", "b_Tail01_012".
void dropRunningNumbers(std::vector<Words>& all) {
  std::set<std::string> numbers;
  std::size_t numbered = 0;
  for (const Words& words : all) {
    if (words.size() < 2 || !isNumber(words.back())) continue;
    ++numbered;
    numbers.insert(words.back());
  }
  if (numbered < 8 || numbers.size() < numbered || numbered * 10 < all.size() * 8) return;
  for (Words& words : all) {
    if (words.size() > 1 && isNumber(words.back())) words.pop_back();
  }
}

/// Removes the first or last word if at least half of the joints share it, unless it is "arm" or "leg".
[[nodiscard]] bool dropSharedWord(std::vector<Words>& all, bool first) {
  const auto edge = [&](const Words& words) { return first ? words.front() : words.back(); };
  std::map<std::string, std::size_t> counts;
  std::size_t named = 0;
  for (const Words& words : all) {
    if (words.empty()) continue;
    ++named;
    if (sideOf(edge(words)) == Side::kMiddle && !isNumber(edge(words))) ++counts[edge(words)];
  }
  for (const auto& [word, count] : counts) {
    if (count < 4 || count * 2 < named || word == "arm" || word == "leg") continue;
    bool dropped = false;
    for (Words& words : all) {
      if (words.size() < 2 || edge(words) != word) continue;
      words.erase(first ? words.begin() : words.end() - 1);
      dropped = true;
    }
    return dropped;
  }
  return false;
}

[[nodiscard]] bool isRigWord(const std::string& word) {
  static const std::set<std::string> kWords = {"mixamorig", "def",      "org", "jnt", "jt",    "bn",
                                               "bone",      "skeleton", "bip", "b",   "c",     "j",
                                               "m",         "armature", "rig", "sk",  "bip01", "bip001"};
  if (kWords.contains(word)) return true;
  return word.starts_with("mixamorig") && isNumber(word.substr(9));
}

}  // namespace

std::string JointName::key() const {
  std::string key;
  for (const std::string& word : words) key += word;
  return key;
}

std::vector<JointName> readJointNames(const Skeleton& skeleton) {
  std::vector<Words> all;
  all.reserve(skeleton.joints().size());
  for (const Joint& joint : skeleton.joints()) all.push_back(split(joint.name));
  dropRunningNumbers(all);
  while (dropSharedWord(all, true)) {
  }
  while (dropSharedWord(all, false)) {
  }

  std::vector<JointName> names;
  names.reserve(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    Words& words = all[i];
    JointName name;
    // MakeHuman's BVH puts "__Thumb1_L" between a hand and its Thumb1_L.
    if (skeleton.joints()[i].name.starts_with("__")) name.preference = 3;
    for (const std::string& word : words) {
      if (word == "def") name.preference = 0;
      if (word == "org") name.preference = 2;
    }
    while (words.size() > 1 && isRigWord(words.front())) words.erase(words.begin());
    while (words.size() > 1 && isRigWord(words.back())) words.pop_back();
    name.side = takeSide(words);
    while (words.size() > 1 && isRigWord(words.front())) words.erase(words.begin());
    name.words = std::move(words);
    names.push_back(std::move(name));
  }
  return names;
}

std::string withoutLeadingZeros(const std::string& key) {
  std::size_t number = key.size();
  while (number > 0 && isDigit(key[number - 1])) --number;
  std::size_t end = number;
  while (end + 1 < key.size() && key[end] == '0') ++end;
  return key.substr(0, number) + key.substr(end);
}

bool isHelper(const JointName& name) {
  static const std::set<std::string> kWords = {
      "end",  "nub",   "tip",    "twist",  "roll", "ik",       "fk",   "pole",   "target", "ctrl",   "control",
      "mch",  "tweak", "helper", "socket", "slot", "effector", "goal", "site",   "leaf",   "weapon", "prop",
      "cape", "hair",  "skirt",  "cloth",  "tail", "eye",      "jaw",  "breast", "camera", "hat",    "backpack"};
  return std::any_of(name.words.begin(), name.words.end(), [&](const std::string& word) {
    std::string letters = word;
    while (!letters.empty() && isDigit(letters.back())) letters.pop_back();
    return kWords.contains(letters);
  });
}

}  // namespace lorica
