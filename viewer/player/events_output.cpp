#include "viewer/player/events_output.h"

#include "geometry/descriptor.h"
#include "geometry/errors.h"
#include "geometry/hard_stop.h"
#include "geometry/new_file.h"
#include "session/contact_events.h"

#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <iterator>
#include <mutex>
#include <optional>
#include <system_error>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

using Text = fmt::memory_buffer;

void put(const char* name, const Vec3& v, Text& text) {
  fmt::format_to(std::back_inserter(text), R"(,"{}":[{:.6g},{:.6g},{:.6g}])", name, v.x(), v.y(), v.z());
}

/// To microseconds: sums of times are printed with few digits.
double rounded(double seconds) {
  return std::round(1e6 * seconds) / 1e6;
}

/// The name of each joint as JSON.
std::vector<std::string> quotedNames(const Skeleton& skeleton) {
  std::vector<std::string> names;
  names.reserve(skeleton.jointCount());
  for (JointIndex joint = 0; joint < skeleton.jointCount(); ++joint) {
    names.push_back(
        nlohmann::json(skeleton.joint(joint).name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  }
  return names;
}

/// The contacts of all avatars, as lines of JSON.
class EventLines {
 public:
  explicit EventLines(const Session& session) : events_(session) {
    for (const SessionAvatar& avatar : session.avatars()) bones_.push_back(quotedNames(avatar.character().skeleton));
  }

  void add(const Session& session, Text& text) { put(events_.update(session), text); }
  void endAll(Text& text) { put(events_.endAll(), text); }

 private:
  [[nodiscard]] const char* bone(int avatar, JointIndex joint) const {
    return joint == kNoJoint ? "null" : bones_[avatar][joint].c_str();
  }

  void put(std::span<const ContactEvent> events, Text& text) const {
    constexpr const char* kPhases[] = {"begin", "stay", "end"};
    constexpr const char* kKinds[] = {"prop", "self", "avatars"};
    for (const ContactEvent& event : events) {
      const Touch& touch = event.touch;
      const TouchPair& pair = touch.pair;
      const auto out = std::back_inserter(text);
      fmt::format_to(out, R"({{"time":{},"event":"{}","kind":"{}","avatar":{},"part":{},"bone":{})",
                     rounded(event.time), kPhases[static_cast<int>(event.phase)], kKinds[static_cast<int>(pair.kind)],
                     pair.avatar, pair.part, bone(pair.avatar, touch.bone));
      if (pair.kind == TouchKind::kProp) {
        fmt::format_to(out, R"(,"prop":{})", pair.other);
      } else {
        if (pair.kind == TouchKind::kAvatars) fmt::format_to(out, R"(,"otherAvatar":{})", pair.otherAvatar);
        fmt::format_to(out, R"(,"otherPart":{},"otherBone":{})", pair.other, bone(pair.otherAvatar, touch.otherBone));
      }
      lorica::put("point", touch.point, text);
      lorica::put("normal", touch.normal, text);
      fmt::format_to(out, ",\"depth\":{:.6g},\"strength\":{:.6g},\"began\":{},\"touched\":{}}}\n", touch.depth,
                     touch.strength, rounded(event.began), rounded(event.touched));
    }
  }

  ContactEvents events_;
  std::vector<std::vector<std::string>> bones_;  // names of each avatar's joints
};

class EventsWriter final : public EventsOutput {
 public:
  /// @param part  that `descriptor` writes to; empty = standard output
  EventsWriter(fs::path file, fs::path part, int descriptor, std::shared_ptr<StepWatcher> next)
      : file_(std::move(file)), part_(std::move(part)), descriptor_(descriptor), next_(std::move(next)) {}
  ~EventsWriter() override { (void)finish(); }
  EventsWriter(const EventsWriter&) = delete;
  EventsWriter& operator=(const EventsWriter&) = delete;

  void beforeStep(Session& session) override {
    if (!lines_) lines_.emplace(session);
    if (next_) next_->beforeStep(session);
  }

  Result<void> afterStep(const Session& session, std::span<const WorldAction> done) override {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      lines_->add(session, text_);
      LORICA_TRY_DO(write());
    }
    return next_ ? next_->afterStep(session, done) : Result<void>();
  }

  void sessionChanged() override {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (lines_) lines_->endAll(text_);
      lines_.reset();
    }
    if (next_) next_->sessionChanged();
  }

  Result<void> finish() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (descriptor_ < 0) return {};
    if (lines_) lines_->endAll(text_);
    const Result<void> written = write();
    const int descriptor = std::exchange(descriptor_, -1);
    if (part_.empty()) return written;
    ::close(descriptor);
    if (failed_ || !written) return written;  // what could be written stays under the name of the part
    std::error_code error;
    fs::rename(part_, file_, error);
    return error ? cannotWrite(error.value()) : Result<void>();
  }

 private:
  [[nodiscard]] Error cannotWrite(int error) const {
    return unwritable("--events: {}: cannot be written: {}", part_.empty() ? "standard output" : part_.string(),
                      std::generic_category().message(error));
  }

  [[nodiscard]] Result<void> write() {
    if (descriptor_ >= 0 && !failed_) {
      const int error = writeAll(descriptor_, {text_.data(), text_.size()});
      failed_ = error != 0;
      if (failed_) return cannotWrite(error);
    }
    text_.clear();
    return {};
  }

  fs::path file_, part_;
  int descriptor_;
  std::shared_ptr<StepWatcher> next_;
  std::mutex mutex_;  ///< of the lines and the descriptor
  std::optional<EventLines> lines_;
  Text text_;
  bool failed_ = false;  ///< nothing more can be written
  AtHardStop finishing_{[this] { (void)finish(); }};
};

}  // namespace

Result<std::shared_ptr<EventsOutput>> makeEventsOutput(const std::string& to, std::shared_ptr<StepWatcher> next,
                                                       Host& host) {
  using Output = std::shared_ptr<EventsOutput>;
  if (to.empty()) return Output();
  if (to == "-") return Output(std::make_shared<EventsWriter>("", "", STDOUT_FILENO, std::move(next)));
  const fs::path file = to;
  const fs::path part = file.parent_path() / (file.stem().string() + ".part" + file.extension().string());
  LORICA_TRY(const std::optional<fs::path> found, prefixed("--events", keepFound(part)));
  if (found) host.warn(fmt::format("found events that were not finished; kept as {}", found->string()));
  LORICA_TRY(const int descriptor, prefixed("--events", createPart(part)));
  return Output(std::make_shared<EventsWriter>(file, part, descriptor, std::move(next)));
}

}  // namespace lorica
