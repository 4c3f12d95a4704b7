#include "geometry/counts.h"
#include "geometry/text.h"
#include "prepare/cast.h"

#include <algorithm>
#include <filesystem>

namespace lorica {
namespace {

void addClips(const std::vector<std::string>& clips, const std::string& played, CastChoices& choices) {
  if (clips.size() < 2) return;
  choices.clips = clips;
  const auto same = [&](const std::string& clip) { return lowerCase(clip) == lowerCase(played); };
  const auto found = std::find_if(clips.begin(), clips.end(), same);
  if (found != clips.end()) choices.clip = found - clips.begin();
}

void addPeople(const std::vector<int>& people, int followed, CastChoices& choices) {
  if (people.size() < 2) return;
  for (const int person : people) {
    if (person == followed) choices.person = countOf(choices.people);
    choices.people.push_back(std::to_string(person));
  }
  if (followed == kEveryone) choices.person = -1;
}

/// Who is followed in a recording of several people.
int followedIn(const Motion& motion, bool session, int given) {
  if (given != 0) return given;
  return session ? 1 : motion.joints.front().user;
}

}  // namespace

CastChoices choicesOf(const CastRequest& request, std::span<const PreparedAvatar> avatars) {
  CastChoices choices;
  const int person = request.performing.person;
  const bool named = !request.motion.empty() || !request.character.empty();
  if (!named || avatars.empty() || (avatars.size() > 1 && person != kEveryone)) return choices;
  const PreparedAvatar& first = avatars.front();
  std::vector<std::string> clips = first.motion->clips;
  if (first.ownClip && first.subject.file) {
    for (const Clip& clip : first.subject.file->clips) clips.push_back(clip.name);
  }
  addClips(clips, request.performing.clip, choices);
  if (first.motion->people.empty()) return choices;
  const bool session = lowerCase(std::filesystem::path(request.motion).extension().string()) == ".lsession";
  addPeople(first.motion->people, followedIn(*first.motion, session, person), choices);
  choices.everyone = !session;
  return choices;
}

}  // namespace lorica
