#include "viewer/vr/headset_window.h"

#include "viewer/renderer/picture_area.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace lorica {
namespace {

constexpr double kBeside = 1.6;                                        // distance to the avatar at first [m]
constexpr double kNearest = 0.05;                                      // of what is drawn [m]
constexpr double kHeadDepth = 0.16;                                    // the same inside: the own head is not [m]
constexpr double kEyesAbove = 0.07, kEyesAhead = 0.09;                 // of the head joint [m]
constexpr double kReach = 0.12;                                        // of a hand, from a prop's sphere [m]
constexpr double kTurn = std::numbers::pi / 6.0;                       // of the stick [rad]
constexpr double kTurns = 0.7, kTurnsAgain = 0.3, kStickRests = 0.15;  // of the stick
constexpr double kLongestFrame = 0.1;                                  // in which the wearer moves [s]
constexpr double kBetweenTouches = 0.1;                                // that are felt [s]
constexpr double kFirmTouch = 2.0;                                     // is felt with full strength [N s]
constexpr double kFastestThrow = 15.0;                                 // [m/s]
constexpr double kLongestThrow = 2.0;                                  // in which its velocity is measured [s]
constexpr double kIdle = 0.05;  // between looks at a headset that is not worn [s]

/// The figure of the avatar that is followed, else the first.
const SceneFigure& followedOf(const Scene& scene, int avatar) {
  const SceneFigure* found = &scene;
  for (const SceneFigure& figure : scene.others) {
    if (figure.number == avatar) found = &figure;
  }
  return *found;
}

std::optional<Vec3> jointAt(const SceneFigure& figure, HumanBone bone) {
  const JointIndex joint = figure.skeleton == nullptr ? kNoJoint : figure.skeleton->jointOf(bone);
  if (joint == kNoJoint || joint >= std::ssize(figure.worldFromJoint)) return std::nullopt;
  return Vec3(figure.worldFromJoint[joint].translation());
}

}  // namespace

Result<std::unique_ptr<HeadsetWindow>> HeadsetWindow::create(const std::function<Result<Window>()>& open) {
  LORICA_TRY(Headset headset, Headset::find());
  LORICA_TRY(Window window, open());
  std::unique_ptr<HeadsetWindow> made(new HeadsetWindow(std::move(headset), std::move(window)));
  LORICA_TRY_DO(made->headset_->start(glFunction));
  return made;
}

HeadsetWindow::~HeadsetWindow() {
  headset_.reset();  // its pictures belong to the window's context
}

void HeadsetWindow::lose(const Error& why) {
  headset_.reset();
  drawFor(nullptr);
  if (hold_) letGo_ = hold_->hand;
  hold_.reset();
  takes_.reset();
  ended_ = fmt::format("{}: the session goes on in the window", why.message);
  problem(ended_);
}

void HeadsetWindow::show(const Scene& scene, const WindowValues& values) {
  if (!headset_) return Window::show(scene, values);
  const bool ran = headset_->running();
  Result<void> alive = headset_->poll();
  if (alive && headset_->running()) alive = headset_->beginFrame();
  if (!alive) {
    lose(alive.error());
    return Window::show(scene, values);
  }
  if (!headset_->running()) {
    if (ran) drawFor(nullptr);
    return Window::show(scene, values);
  }
  if (!ran) {
    drawFor([this](Renderer& renderer, const Scene& drawn, const SceneOptions& options) {
      return drawEyes(renderer, drawn, options);
    });
  }
  const double seconds =
      std::clamp(headset_->frame().time - std::exchange(time_, headset_->frame().time), 0.0, kLongestFrame);
  if (headset_->frame().located) {
    move(seconds);
    findPlace(scene, values);
    holdProps(scene, values);
    feel(scene, values);
  }
  Window::show(scene, values);
  if (!headset_) return;
  if (const Result<void> ended = headset_->endFrame(); !ended) lose(ended.error());
}

bool HeadsetWindow::drawEyes(Renderer& renderer, const Scene& scene, const SceneOptions& options) {
  const HeadsetFrame& frame = headset_->frame();
  if (!frame.drawn || !frame.located) return false;
  Scene around = scene;
  around.inset = nullptr;
  for (const int index : {1, 0}) {  // the window shows the left one
    const HeadsetEye& eye = frame.eyes[index];
    eyes_[index] =
        cameraOf(place_.worldFromStage() * eye.stageFromEye, eye.angles, inside_ == true ? kHeadDepth : kNearest);
    renderer.draw(around, options, eyes_[index], headset_->width(), headset_->height());
    // A failure is reported when the frame ends.
    if (!headset_->take(index, renderer)) return false;
  }
  return true;
}

/// The left stick walks where the head looks, the right one turns. Buttons change between beside and inside, and bring
/// the wearer to the avatar again.
void HeadsetWindow::move(double seconds) {
  const HeadsetFrame& frame = headset_->frame();
  if (frame.hands[0].stick.norm() > kStickRests && inside_ == false) {
    place_.walk(frame.stageFromHead, frame.hands[0].stick, seconds);
  }
  const double x = frame.hands[1].stick.x();
  const double wants = std::abs(x) > kTurns ? std::copysign(1.0, x) : std::abs(x) < kTurnsAgain ? 0.0 : turned_;
  if (wants != 0.0 && wants != turned_) place_.turn(frame.stageFromHead, -wants * kTurn);
  turned_ = wants;
  for (const HeadsetHand& hand : frame.hands) {
    if (hand.recentres) inside_.reset();
    if (!hand.changes) continue;
    WindowChoices changed = choices();
    changed.inside = !changed.inside;
    setChoices(changed);
  }
}

/// Beside the avatar once, looking at it; inside, the eyes are where its eyes are, and turn freely.
void HeadsetWindow::findPlace(const Scene& scene, const WindowValues& values) {
  const SceneFigure& figure = followedOf(scene, values.avatar);
  const std::optional<Vec3> head = jointAt(figure, HumanBone::kHead);
  if (!values.focus || figure.skeleton == nullptr) return;  // nobody is there
  const Isometry3& stageFromHead = headset_->frame().stageFromHead;
  const Vec3 ahead = directionAt(values.facing, 0.0);
  const bool inside = choices().inside && head;
  if (inside_ != inside) {
    if (inside) {
      place_.stand(stageFromHead, *values.focus, ahead);
    } else {
      place_.stand(stageFromHead, *values.focus + kBeside * ahead, -ahead);
    }
    inside_ = inside;
  }
  if (inside) place_.inside(stageFromHead, *head + kEyesAbove * Vec3::UnitY() + kEyesAhead * ahead);
}

Ray HeadsetWindow::aimOf(int hand) const {
  const HeadsetHand& seen = headset_->frame().hands[hand];
  const bool reaches = hold_ && hold_->hand == hand && hold_->reaches;
  const Isometry3 worldFromHand = place_.worldFromStage() * (reaches ? seen.stageFromGrip : seen.stageFromAim);
  return {worldFromHand.translation(), worldFromHand.linear() * (reaches ? hold_->direction : Vec3(-Vec3::UnitZ()))};
}

/// One hand at a time holds a prop: one in its reach, else the first along its ray.
void HeadsetWindow::holdProps(const Scene& scene, const WindowValues& values) {
  const HeadsetFrame& frame = headset_->frame();
  if (hold_ && hold_->asked && (values.holds >> hold_->hand & 1u) == 0) hold_.reset();  // there was none
  for (int index = 0; index < 2; ++index) {
    const HeadsetHand& hand = frame.hands[index];
    const bool before = std::exchange(grabbed_[index], hand.grabs);
    if (hold_ && hold_->hand == index && !hand.grabs) {
      if (hold_->asked) letGo_ = index;
      const double seconds = frame.time - was_[next_].time;
      const Vec3 now = place_.worldFromStage() * hand.stageFromGrip.translation();
      throwsWith_ = seconds < kLongestThrow ? Vec3((now - was_[next_].hands[index]) / std::max(seconds, 1e-3))
                                            : Vec3(Vec3::Zero());
      if (throwsWith_.norm() > kFastestThrow) throwsWith_ *= kFastestThrow / throwsWith_.norm();
      hold_.reset();
      takes_.reset();
    }
    if (hold_ || before || !hand.grabs || !hand.seen || !values.noThrow.empty()) continue;
    hold_ = Hold{index};
    const Isometry3 worldFromGrip = place_.worldFromStage() * hand.stageFromGrip;
    const Vec3 grip = worldFromGrip.translation();
    double nearest = kReach;
    for (const Prop& prop : scene.props) {
      const Vec3 center = prop.worldFromProp.translation();
      const double radius = boundingRadius(prop), distance = (center - grip).norm();
      if (prop.mass == 0.0 || distance - radius >= nearest || distance < 1e-6) continue;
      nearest = distance - radius;
      const Vec3 direction = (center - grip) / distance;
      hold_->reaches = true;
      hold_->direction = worldFromGrip.linear().transpose() * direction;
      // From outside, for a ray that begins within a prop does not meet it.
      takes_ = Ray{center - (radius + kReach) * direction, direction};
    }
    if (!hold_->reaches) takes_ = aimOf(index);
  }
  was_[next_].time = frame.time;
  for (int index = 0; index < 2; ++index) {
    was_[next_].hands[index] = place_.worldFromStage() * frame.hands[index].stageFromGrip.translation();
  }
  next_ = (next_ + 1) % was_.size();
}

/// A hand feels that it holds a prop; inside, the hands feel what those of the avatar touch.
void HeadsetWindow::feel(const Scene& scene, const WindowValues& values) {
  if (time_ - felt_ < kBetweenTouches || scene.skeleton == nullptr || inside_ != true) return;
  const SceneFigure& worn = followedOf(scene, values.avatar);
  for (const Contact& contact : scene.contacts) {
    if (contact.avatar != worn.number || contact.impulse <= 0.0 || contact.bone == kNoJoint) continue;
    for (const int hand : {0, 1}) {
      const HumanBone bone = hand == 0 ? HumanBone::kLeftHand : HumanBone::kRightHand;
      if (worn.skeleton == nullptr || contact.bone != worn.skeleton->jointOf(bone)) continue;
      headset_->pulse(hand, contact.impulse / kFirmTouch);
      felt_ = time_;
    }
  }
}

WindowRequests HeadsetWindow::takeRequests() {
  WindowRequests requests = Window::takeRequests();
  if (const std::optional<int> hand = std::exchange(letGo_, std::nullopt)) {
    requests.hands[*hand].released = true;
    requests.hands[*hand].throwsWith = throwsWith_;
  } else if (takes_) {
    requests.hands[hold_->hand].pressed = std::exchange(takes_, std::nullopt);
    hold_->asked = true;
  }
  return requests;
}

/// What a controller holds stays as far along the ray as it was taken.
HandAim HeadsetWindow::aim(int hand) const {
  if (!headset_ || !hold_ || hold_->hand != hand) return Window::aim(hand);
  const Ray ray = aimOf(hand);
  return {ray, ray.direction};
}

Camera HeadsetWindow::camera() const {
  return headset_ && inside_ ? eyes_[0] : Window::camera();
}

void HeadsetWindow::rest(double seconds) {
  if (!headset_) return Window::rest(seconds);
  if (!headset_->running()) Window::rest(std::min(seconds, kIdle));  // else the headset sets the pace
}

}  // namespace lorica
