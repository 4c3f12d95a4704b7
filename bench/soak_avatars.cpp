#include "bench/soak_avatars.h"

#include "bench/memory_watch.h"
#include "capture/synthetic/synthetic_motion.h"
#include "geometry/random_numbers.h"
#include "session/contact_events.h"
#include "session/scenes/demo_scene.h"
#include "session/session.h"
#include "session/treated_source.h"
#include "skinning/mannequin/mannequin.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <memory>
#include <utility>

namespace lorica::bench {
namespace {

constexpr std::size_t kMaxViolations = 20;
constexpr double kRate = 30.0;   ///< frames/s
constexpr double kAround = 1.2;  ///< how far from the middle people perform [m]

using Motions = std::vector<std::vector<SkeletonFrame>>;

double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The joints of a place before a camera where people come and go.
class Visitors final : public SkeletonSource {
 public:
  Visitors(std::shared_ptr<const Motions> motions, std::uint64_t seed, double seconds)
      : motions_(std::move(motions)), random_(seed), end_(static_cast<long>(kRate * seconds)) {}

  Result<std::optional<SkeletonFrame>> next() override {
    if (number_ >= end_) return std::optional<SkeletonFrame>();
    if (number_ >= until_) change();
    SkeletonFrame frame;
    frame.user = kNobody;
    if (there_) {
      const std::vector<SkeletonFrame>& motion = (*motions_)[motion_];
      frame = motion[static_cast<std::size_t>(first_ + number_) % motion.size()];
      for (TrackedJoint& joint : frame.joints) joint.position += place_;
    }
    frame.time = static_cast<double>(number_++) / kRate;
    return std::optional(frame);
  }

 private:
  void change() {
    there_ = !there_;
    until_ = number_ + static_cast<long>(kRate * (there_ ? random_.between(2.0, 8.0) : random_.between(1.0, 5.0)));
    motion_ = static_cast<std::size_t>(random_.bits() % motions_->size());
    first_ = static_cast<long>(random_.bits() % 300);
    const double x = random_.between(-kAround, kAround);
    place_ = Vec3(x, 0.0, random_.between(-kAround, kAround));
  }

  std::shared_ptr<const Motions> motions_;
  RandomNumbers random_;
  long number_ = 0, end_, until_ = 0, first_ = 0;
  std::size_t motion_ = 0;
  bool there_ = false;
  Vec3 place_ = Vec3::Zero();
};

Session sessionOf(const Decomposition& parts, const AvatarSoakSettings& settings) {
  auto motions = std::make_shared<Motions>();
  for (int m = 0; m < kSyntheticMotionCount; ++m) motions->push_back(synthesizeMotion(static_cast<SyntheticMotion>(m)));
  const Character character = makeMannequin();
  Session session(makeDemoWorld(settings.seed));
  std::optional<SessionAvatar> kind;
  for (int place = 0; place < settings.places; ++place) {
    const std::uint64_t seed = settings.seed + 1000 * static_cast<std::uint64_t>(place);
    std::unique_ptr<PoseSource> source =
        makeTreatedSource(character, std::make_unique<Visitors>(motions, seed, settings.seconds), SourceTreatment())
            .value();
    if (!kind) kind = SessionAvatar::create(character, parts, makeMotionPoseSource({})).value();
    session.addAvatar(kind->another(std::move(source)));
  }
  return session;
}

class AvatarSoak {
 public:
  AvatarSoak(const Decomposition& parts, const AvatarSoakSettings& settings)
      : settings_(settings),
        session_(sessionOf(parts, settings)),
        events_(session_),
        memory_(settings.warmUp),
        there_(session_.avatars().size(), false) {}

  AvatarSoakResult run() {
    const double begin = cpuSeconds();
    while (true) {
      const Result<bool> more = session_.step();
      if (!more) violation(more.error().message);
      if (!more || !*more) break;
      watch();
    }
    result_.cpuSeconds = cpuSeconds() - begin;
    result_.meanThere /= static_cast<double>(std::max(1L, result_.frames));
    judgeMemory();
    return std::move(result_);
  }

 private:
  void violation(const std::string& what) {
    if (result_.violations.size() >= kMaxViolations) return;
    result_.violations.push_back(fmt::format("{:.2f} s: {}", session_.time(), what));
  }

  void watch() {
    ++result_.frames;
    result_.seconds = session_.time();
    for (std::size_t a = 0; a < there_.size(); ++a) watchAvatar(a);
    result_.contacts += std::ssize(session_.world().contacts());
    for (const Contact& contact : session_.world().contacts()) {
      if (!there_[static_cast<std::size_t>(contact.avatar)]) violation("a prop touches an avatar that is away");
    }
    result_.meetings += std::ssize(session_.avatarContacts());
    for (const BodyContact& contact : session_.avatarContacts()) {
      const bool both =
          there_[static_cast<std::size_t>(contact.firstBody)] && there_[static_cast<std::size_t>(contact.secondBody)];
      if (!both) violation("an avatar touches one that is away");
    }
    result_.events += std::ssize(events_.update(session_));
    memory_.watch(session_.time());
  }

  void watchAvatar(std::size_t index) {
    const SessionAvatar& avatar = session_.avatars()[index];
    const bool was = there_[index];
    there_[index] = avatar.present();
    result_.entries += !was && avatar.present() ? 1 : 0;
    result_.exits += was && !avatar.present() ? 1 : 0;
    result_.meanThere += avatar.present() ? 1.0 : 0.0;
    for (const LivePart& part : avatar.partsInWorld()) {
      if (!part.worldFromPart.matrix().allFinite()) violation(fmt::format("avatar {} is not finite", index));
    }
  }

  void judgeMemory() {
    result_.peakMemory = memory_.peak();
    if (!memory_.hasThirds()) return;
    result_.firstMemory = memory_.firstThird();
    result_.lastMemory = memory_.lastThird();
    if (result_.lastMemory - result_.firstMemory <= settings_.memoryGrowth) return;
    violation(fmt::format("memory grew from {:.1f} to {:.1f} MiB, by more than {:g}", result_.firstMemory,
                          result_.lastMemory, settings_.memoryGrowth));
  }

  AvatarSoakSettings settings_;
  Session session_;
  ContactEvents events_;
  MemoryWatch memory_;
  std::vector<bool> there_;
  AvatarSoakResult result_;
};

}  // namespace

AvatarSoakResult soakAvatars(const Decomposition& parts, const AvatarSoakSettings& settings) {
  return AvatarSoak(parts, settings).run();
}

}  // namespace lorica::bench
