#include "apps/cast_choices.h"

#include "apps/depth_motion.h"
#include "apps/file_trust.h"
#include "apps/report.h"
#include "capture/files/joint_stream.h"
#include "session/session_file.h"
#include "skinning/import/character_file.h"

#include <algorithm>
#include <filesystem>

namespace lorica {
namespace {

namespace fs = std::filesystem;

void addClips(const std::vector<Clip>& clips, const std::string& played, CastChoices& choices) {
  if (clips.size() < 2) return;
  for (const Clip& clip : clips) {
    if (lowerCase(clip.name) == lowerCase(played)) choices.clip = static_cast<int>(choices.clips.size());
    choices.clips.push_back(clip.name);
  }
}

void addPeople(const std::vector<int>& people, int followed, CastChoices& choices) {
  if (people.size() < 2) return;
  for (const int person : people) {
    if (person == followed) choices.person = static_cast<int>(choices.people.size());
    choices.people.push_back(std::to_string(person));
  }
  if (followed == kEveryone) choices.person = -1;
}

/// The numbers of the people in a stream of joints or a recorded session.
std::vector<int> peopleIn(const fs::path& file, const std::string& format) {
  const std::string extension = lowerCase(file.extension().string());
  if (extension == ".lsession") {
    const Result<SessionFile> session = readSession(file);
    std::vector<int> people(session ? session->header.avatars.size() : 0);
    for (std::size_t i = 0; i < people.size(); ++i) people[i] = static_cast<int>(i) + 1;
    return people;
  }
  JointStreamSettings settings;
  if (!format.empty()) settings.format = jointFormatNamed(format);
  const Result<JointStream> stream = readJointStream(file, settings);
  return stream ? stream->people : std::vector<int>();
}

}  // namespace

CastChoices choicesOf(const PlaybackInputOptions& input, const OpenedCast& cast) {
  CastChoices choices;
  if (cast.avatars.empty()) return choices;
  const PlaybackInput& first = cast.avatars.front().input;
  const std::string& named = input.motion.empty() ? input.character : input.motion;
  const fs::path shipped = shippedRecording(named);
  const fs::path file = shipped.empty() ? fs::path(named) : shipped;
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return choices;  // several, or a scene's own
  if (first.ownClip) {
    addClips(first.subject.clips(), input.performing.clip, choices);
  } else if (isCharacterFile(file)) {
    const Result<CharacterFile> read = readCharacterFile(file, characterFileSettings());
    if (read) addClips(read->clips, input.performing.clip, choices);
  } else if (lowerCase(file.extension().string()) == ".lsession") {
    addPeople(peopleIn(file, ""), std::max(input.performing.person, 1), choices);
  } else if (!first.motion.joints.empty() && !isDepthRecording(file)) {
    choices.everyone = true;
    const int given = input.performing.person;
    const int followed = given == 0 ? first.motion.joints.front().user : given;
    addPeople(peopleIn(file, input.performing.format), followed, choices);
  }
  return choices;
}

}  // namespace lorica
