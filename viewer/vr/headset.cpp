#include "viewer/vr/headset_impl.h"

#include <algorithm>
#include <utility>

namespace lorica {
namespace {

constexpr double kGrabs = 0.6, kLetsGo = 0.4;       // of trigger or squeeze
constexpr double kPinch = 0.02, kUnpinch = 0.04;    // between the tips of thumb and index finger [m]
constexpr double kFist = 0.05, kOpenHand = 0.07;    // from the palm to the tip of the middle finger [m]
constexpr XrDuration kPulse = 40'000'000;           // [ns]
constexpr XrDuration kLongestWait = 1'000'000'000;  // for an image of a swapchain [ns]

Isometry3 isometryOf(const XrPosef& pose) {
  Isometry3 made = Isometry3::Identity();
  made.linear() = Quat(pose.orientation.w, pose.orientation.x, pose.orientation.y, pose.orientation.z)
                      .normalized()
                      .toRotationMatrix();
  made.translation() = Vec3(pose.position.x, pose.position.y, pose.position.z);
  return made;
}

}  // namespace

Result<void> XrHeadset::enter(XrSessionState state) {
  if (state == XR_SESSION_STATE_READY) {
    auto info = typed<XrSessionBeginInfo>(XR_TYPE_SESSION_BEGIN_INFO);
    info.primaryViewConfigurationType = kStereo;
    LORICA_XR(BeginSession, session, &info);
    running_ = true;
  } else if (state == XR_SESSION_STATE_STOPPING) {
    running_ = false;
    LORICA_XR(EndSession, session);
  } else if (state == XR_SESSION_STATE_EXITING) {
    return Error{ErrorCode::kCancelled, "the headset's session was ended there"};
  } else if (state == XR_SESSION_STATE_LOSS_PENDING) {
    return noDisplay("the headset is gone");
  }
  return {};
}

bool XrHeadset::locateIn(XrSpace space, Isometry3& pose) const {
  constexpr XrSpaceLocationFlags kKnown =
      XR_SPACE_LOCATION_POSITION_VALID_BIT | XR_SPACE_LOCATION_ORIENTATION_VALID_BIT;
  auto location = typed<XrSpaceLocation>(XR_TYPE_SPACE_LOCATION);
  if (XR_FAILED(LocateSpace(space, stage, displayTime, &location))) return false;
  if ((location.locationFlags & kKnown) != kKnown) return false;
  pose = isometryOf(location.pose);
  return true;
}

Result<void> XrHeadset::locate() {
  constexpr XrViewStateFlags kKnown = XR_VIEW_STATE_POSITION_VALID_BIT | XR_VIEW_STATE_ORIENTATION_VALID_BIT;
  auto info = typed<XrViewLocateInfo>(XR_TYPE_VIEW_LOCATE_INFO);
  info.viewConfigurationType = kStereo;
  info.displayTime = displayTime;
  info.space = stage;
  auto state = typed<XrViewState>(XR_TYPE_VIEW_STATE);
  views.fill(typed<XrView>(XR_TYPE_VIEW));
  std::uint32_t count = 0;
  LORICA_XR(LocateViews, session, &info, &state, 2, &count, views.data());
  frame_.located = (state.viewStateFlags & kKnown) == kKnown && locateIn(view, frame_.stageFromHead);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const XrFovf& fov = views[eye].fov;
    frame_.eyes[eye] = {isometryOf(views[eye].pose), {fov.angleLeft, fov.angleRight, fov.angleUp, fov.angleDown}};
  }
  return {};
}

/// By the runtime's prediction [s].
double XrHeadset::untilShown() const {
  timespec now{};
  XrTime then = 0;
  if (ConvertTimespecTimeToTimeKHR == nullptr || ::clock_gettime(CLOCK_MONOTONIC, &now) != 0) return 0.0;
  return XR_SUCCEEDED(ConvertTimespecTimeToTimeKHR(instance, &now, &then)) ? 1e-9 * double(displayTime - then) : 0.0;
}

Result<void> XrHeadset::readHands() {
  const XrActiveActionSet active = {actions, XR_NULL_PATH};
  auto sync = typed<XrActionsSyncInfo>(XR_TYPE_ACTIONS_SYNC_INFO);
  sync.countActiveActionSets = 1;
  sync.activeActionSets = &active;
  LORICA_XR(SyncActions, session, &sync);
  for (std::size_t h = 0; h < 2; ++h) {
    HeadsetHand& hand = frame_.hands[h];
    auto info = typed<XrActionStateGetInfo>(XR_TYPE_ACTION_STATE_GET_INFO);
    info.subactionPath = paths[h];
    const auto number = [&](XrAction action) {
      info.action = action;
      auto state = typed<XrActionStateFloat>(XR_TYPE_ACTION_STATE_FLOAT);
      return XR_SUCCEEDED(GetActionStateFloat(session, &info, &state)) && state.isActive ? double(state.currentState)
                                                                                         : 0.0;
    };
    const auto pressed = [&](XrAction action) {
      info.action = action;
      auto state = typed<XrActionStateBoolean>(XR_TYPE_ACTION_STATE_BOOLEAN);
      return XR_SUCCEEDED(GetActionStateBoolean(session, &info, &state)) && state.isActive &&
             state.currentState != XR_FALSE && state.changedSinceLastSync != XR_FALSE;
    };
    hand.seen = locateIn(grips[h], hand.stageFromGrip) && locateIn(aims[h], hand.stageFromAim);
    hand.bare = !hand.seen && trackers[h] != null<XrHandTrackerEXT>();
    if (hand.bare) {
      readBareHand(h);
    } else {
      hand.grabs = std::max(number(trigger), number(squeeze)) > (hand.grabs ? kLetsGo : kGrabs);
    }
    hand.changes = pressed(change);
    hand.opens = pressed(open);
    info.action = stick;
    auto state = typed<XrActionStateVector2f>(XR_TYPE_ACTION_STATE_VECTOR2F);
    const bool moved = XR_SUCCEEDED(GetActionStateVector2f(session, &info, &state)) && state.isActive;
    hand.stick = moved ? Eigen::Vector2d(state.currentState.x, state.currentState.y) : Eigen::Vector2d(0.0, 0.0);
  }
  return {};
}

/// A hand without a controller. Its palm looks along its fingers, with +Y out of its back; it points where they do.
void XrHeadset::readBareHand(std::size_t side) {
  HeadsetHand& hand = frame_.hands[side];
  std::array<XrHandJointLocationEXT, XR_HAND_JOINT_COUNT_EXT> joints;
  auto info = typed<XrHandJointsLocateInfoEXT>(XR_TYPE_HAND_JOINTS_LOCATE_INFO_EXT);
  info.baseSpace = stage;
  info.time = displayTime;
  auto found = typed<XrHandJointLocationsEXT>(XR_TYPE_HAND_JOINT_LOCATIONS_EXT);
  found.jointCount = std::uint32_t(joints.size());
  found.jointLocations = joints.data();
  hand.seen = XR_SUCCEEDED(LocateHandJointsEXT(trackers[side], &info, &found)) && found.isActive != XR_FALSE;
  if (!hand.seen) return;  // and keeps what it holds, for it comes back
  const auto at = [&](XrHandJointEXT joint) { return isometryOf(joints[joint].pose); };
  const auto apart = [&](XrHandJointEXT a, XrHandJointEXT b) {
    return (at(a).translation() - at(b).translation()).norm();
  };
  hand.stageFromAim = at(XR_HAND_JOINT_PALM_EXT);
  // A grip's -Z goes to the thumb, its +Y to the wrist, so its +X out of a left palm and into a right one.
  const double left = side == 0 ? 1.0 : -1.0;
  Mat3 palmFromGrip;
  palmFromGrip << 0.0, 0.0, -left,  //
      -left, 0.0, 0.0,              //
      0.0, 1.0, 0.0;
  hand.stageFromGrip = hand.stageFromAim;
  hand.stageFromGrip.linear() *= palmFromGrip;
  hand.grabs = apart(XR_HAND_JOINT_THUMB_TIP_EXT, XR_HAND_JOINT_INDEX_TIP_EXT) < (hand.grabs ? kUnpinch : kPinch) ||
               apart(XR_HAND_JOINT_PALM_EXT, XR_HAND_JOINT_MIDDLE_TIP_EXT) < (hand.grabs ? kOpenHand : kFist);
}

Result<std::unique_ptr<Headset>> Headset::find() {
  auto made = std::make_unique<XrHeadset>();
  LORICA_TRY_DO(made->load());
  return std::unique_ptr<Headset>(std::move(made));
}

Result<void> XrHeadset::poll() {
  for (;;) {
    auto event = typed<XrEventDataBuffer>(XR_TYPE_EVENT_DATA_BUFFER);
    const XrResult polled = PollEvent(instance, &event);
    LORICA_TRY_DO(checked(polled, "xrPollEvent"));
    if (polled == XR_EVENT_UNAVAILABLE) return {};
    if (event.type == XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING) return noDisplay("the headset's runtime ends");
    if (event.type != XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED) continue;
    LORICA_TRY_DO(enter(reinterpret_cast<const XrEventDataSessionStateChanged&>(event).state));
  }
}

Result<void> XrHeadset::beginFrame() {
  auto state = typed<XrFrameState>(XR_TYPE_FRAME_STATE);
  LORICA_XR(WaitFrame, session, nullptr, &state);
  LORICA_XR(BeginFrame, session, nullptr);
  displayTime = state.predictedDisplayTime;
  frame_.time = 1e-9 * double(state.predictedDisplayTime);
  frame_.period = 1e-9 * double(state.predictedDisplayPeriod);
  frame_.ahead = untilShown();
  frame_.drawn = state.shouldRender != XR_FALSE;
  LORICA_TRY_DO(locate());
  return readHands();
}

Result<void> XrHeadset::acquire(Swapchain& chain) {
  LORICA_XR(AcquireSwapchainImage, chain.handle, nullptr, &chain.image);
  auto wait = typed<XrSwapchainImageWaitInfo>(XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO);
  wait.timeout = kLongestWait;
  LORICA_XR(WaitSwapchainImage, chain.handle, &wait);
  return {};
}

Result<void> XrHeadset::drawPanel(const Image& image) {
  LORICA_TRY_DO(acquire(panel));
  panelSize = {std::min(image.width, kPanelWidth), std::min(image.height, kPanelHeight)};
  gl.BindTexture(GL_TEXTURE_2D, panel.textures[panel.image]);
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  // OpenGL's rows start at the bottom.
  for (int y = 0; y < panelSize[1]; ++y) {
    gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, panelSize[1] - 1 - y, panelSize[0], 1, GL_RGBA, GL_UNSIGNED_BYTE,
                     image.rgba.data() + std::size_t{4} * y * image.width);
  }
  gl.BindTexture(GL_TEXTURE_2D, 0);
  LORICA_XR(ReleaseSwapchainImage, panel.handle, nullptr);
  panel.taken = false;
  return {};
}

void XrHeadset::placePanel(const Isometry3& stageFromPanel, double width, double height) {
  panelLayer = typed<XrCompositionLayerQuad>(XR_TYPE_COMPOSITION_LAYER_QUAD);
  panelLayer.layerFlags = XR_COMPOSITION_LAYER_BLEND_TEXTURE_SOURCE_ALPHA_BIT;
  panelLayer.space = stage;
  panelLayer.eyeVisibility = XR_EYE_VISIBILITY_BOTH;
  panelLayer.subImage = {panel.handle, {{0, 0}, {panelSize[0], panelSize[1]}}, 0};
  const Quat turned(stageFromPanel.linear());
  const Vec3 at = stageFromPanel.translation();
  panelLayer.pose = {{float(turned.x()), float(turned.y()), float(turned.z()), float(turned.w())},
                     {float(at.x()), float(at.y()), float(at.z())}};
  panelLayer.size = {float(width), float(height)};
  panel.taken = panelSize[0] > 0;
}

Result<void> XrHeadset::take(int eye, Renderer& renderer) {
  Swapchain& chain = eyes[eye];
  LORICA_TRY_DO(acquire(chain));
  renderer.present(width_, height_, chain.framebuffers[chain.image]);
  LORICA_XR(ReleaseSwapchainImage, chain.handle, nullptr);
  chain.taken = true;
  return {};
}

Image XrHeadset::picture(int eye) const {
  const Swapchain& chain = eyes[eye];
  return readPixels(gl, chain.framebuffers[chain.image], width_, height_);
}

Result<void> XrHeadset::endFrame() {
  std::array<XrCompositionLayerProjectionView, 2> shown;
  bool both = true;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    shown[eye] = typed<XrCompositionLayerProjectionView>(XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW);
    shown[eye].pose = views[eye].pose;
    shown[eye].fov = views[eye].fov;
    shown[eye].subImage = {eyes[eye].handle, {{0, 0}, {width_, height_}}, 0};
    both = both && std::exchange(eyes[eye].taken, false);
  }
  auto layer = typed<XrCompositionLayerProjection>(XR_TYPE_COMPOSITION_LAYER_PROJECTION);
  layer.space = stage;
  layer.viewCount = std::uint32_t(shown.size());
  layer.views = shown.data();
  const std::array<const XrCompositionLayerBaseHeader*, 2> layers = {
      reinterpret_cast<const XrCompositionLayerBaseHeader*>(&layer),
      reinterpret_cast<const XrCompositionLayerBaseHeader*>(&panelLayer)};
  auto info = typed<XrFrameEndInfo>(XR_TYPE_FRAME_END_INFO);
  info.displayTime = displayTime;
  info.environmentBlendMode = XR_ENVIRONMENT_BLEND_MODE_OPAQUE;
  const bool withPanel = std::exchange(panel.taken, false);
  info.layerCount = !both ? 0 : withPanel ? 2 : 1;
  info.layers = layers.data();
  return checked(EndFrame(session, &info), "xrEndFrame");
}

void XrHeadset::pulse(int hand, double strength) {
  auto which = typed<XrHapticActionInfo>(XR_TYPE_HAPTIC_ACTION_INFO);
  which.action = shake;
  which.subactionPath = paths[hand];
  auto vibration = typed<XrHapticVibration>(XR_TYPE_HAPTIC_VIBRATION);
  vibration.amplitude = float(std::clamp(strength, 0.0, 1.0));
  vibration.duration = kPulse;
  vibration.frequency = XR_FREQUENCY_UNSPECIFIED;
  ApplyHapticFeedback(session, &which, reinterpret_cast<const XrHapticBaseHeader*>(&vibration));
}

}  // namespace lorica
