#pragma once

#include "geometry/errors.h"
#include "viewer/renderer/gl_functions.h"
#include "viewer/vr/headset.h"

#include <array>
#include <string>
#include <vector>

// What openxr_platform.h takes from the headers of X11, GLX and EGL, whose libraries are not linked either.
using Display = void;
using GLXFBConfig = void*;
using GLXDrawable = unsigned long;
using GLXContext = void*;
using EGLDisplay = void*;
using EGLConfig = void*;
using EGLContext = void*;
using EGLenum = unsigned;
using PFNEGLGETPROCADDRESSPROC = void (*(*)(const char*))();
#define XR_NO_PROTOTYPES
#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_PLATFORM_XLIB
#define XR_USE_PLATFORM_EGL
#define XR_USE_TIMESPEC
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

/// The functions of OpenXR that Lorica uses, without "xr". The first is what ends all, also where another is lacking.
// Several a line, which clang-format would each indent further.
// clang-format off
#define LORICA_XR_FUNCTIONS(X)                                                                                     \
  X(DestroyInstance) X(AcquireSwapchainImage) X(ApplyHapticFeedback) X(AttachSessionActionSets) X(BeginFrame)      \
  X(BeginSession) X(CreateAction) X(CreateActionSet) X(CreateActionSpace) X(CreateReferenceSpace) X(CreateSession) \
  X(CreateSwapchain) X(DestroySession) X(EndFrame) X(EndSession) X(EnumerateSwapchainFormats)                      \
  X(EnumerateSwapchainImages) X(EnumerateViewConfigurationViews) X(GetActionStateBoolean) X(GetActionStateFloat)   \
  X(GetActionStateVector2f) X(GetInstanceProperties) X(GetOpenGLGraphicsRequirementsKHR) X(GetSystem)              \
  X(GetSystemProperties) X(LocateSpace) X(LocateViews) X(PollEvent) X(ReleaseSwapchainImage) X(ResultToString)     \
  X(StringToPath) X(SuggestInteractionProfileBindings) X(SyncActions) X(WaitFrame) X(WaitSwapchainImage)
// clang-format on

/// Those of XR_EXT_hand_tracking, where the runtime has it.
#define LORICA_XR_HAND_FUNCTIONS(X) \
  X(CreateHandTrackerEXT)           \
  X(DestroyHandTrackerEXT)          \
  X(LocateHandJointsEXT)

namespace lorica {

inline constexpr XrViewConfigurationType kStereo = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;

template <typename Handle>
Handle null() {
  return XR_NULL_HANDLE;
}

/// A structure of OpenXR whose other members are zero.
template <typename T>
T typed(XrStructureType type) {
  T made{};
  made.type = type;
  return made;
}

struct ControllerProfile;

/// A picture that the runtime shows to an eye: one of several textures at a time.
struct Swapchain {
  XrSwapchain handle = null<XrSwapchain>();
  std::vector<GLuint> textures, framebuffers;
  bool taken = false;       // for this frame
  std::uint32_t image = 0;  // that was taken last
};

/// headset_setup.cpp finds the runtime and prepares the session, headset.cpp runs it.
struct XrHeadset final : Headset {
#define LORICA_XR_MEMBER(name) PFN_xr##name name = nullptr;
  LORICA_XR_FUNCTIONS(LORICA_XR_MEMBER)
  LORICA_XR_HAND_FUNCTIONS(LORICA_XR_MEMBER)
  LORICA_XR_MEMBER(ConvertTimespecTimeToTimeKHR)  // null where the runtime does not tell its clock
#undef LORICA_XR_MEMBER
  GlFunctions gl;
  XrInstance instance = null<XrInstance>();
  XrSystemId system = XR_NULL_SYSTEM_ID;
  XrSession session = null<XrSession>();
  XrSpace stage = null<XrSpace>(), view = null<XrSpace>();
  std::array<XrSpace, 2> grips{}, aims{};
  std::array<XrPath, 2> paths{};
  std::array<XrHandTrackerEXT, 2> trackers{};
  XrActionSet actions = null<XrActionSet>();
  XrAction grip = null<XrAction>(), aim = null<XrAction>(), trigger = null<XrAction>(), squeeze = null<XrAction>();
  XrAction stick = null<XrAction>(), change = null<XrAction>(), open = null<XrAction>(), shake = null<XrAction>();
  std::array<Swapchain, 2> eyes;
  Swapchain panel;
  std::array<int, 2> panelSize{};  // of its picture [pixels]
  XrCompositionLayerQuad panelLayer{};
  std::array<XrView, 2> views{};
  bool egl = false, handTracking = false;
  XrTime displayTime = 0;

  ~XrHeadset() override {
    for (const Swapchain* chain : {&eyes[0], &eyes[1], &panel}) {
      const std::vector<GLuint>& drawn = chain->framebuffers;
      if (!drawn.empty()) gl.DeleteFramebuffers(GLsizei(drawn.size()), drawn.data());
    }
    for (const XrHandTrackerEXT tracker : trackers) {
      if (tracker != null<XrHandTrackerEXT>()) DestroyHandTrackerEXT(tracker);
    }
    if (session != null<XrSession>()) DestroySession(session);  // with all that was made for it
    if (instance != null<XrInstance>() && DestroyInstance != nullptr) DestroyInstance(instance);
  }

  Result<void> start(Renderer::GetProc getProc) override;
  Result<void> poll() override;
  Result<void> beginFrame() override;
  Result<void> take(int eye, Renderer& renderer) override;
  [[nodiscard]] Image picture(int eye) const override;
  Result<void> drawPanel(const Image& image) override;
  void placePanel(const Isometry3& stageFromPanel, double width, double height) override;
  Result<void> endFrame() override;
  void pulse(int hand, double strength) override;

  /// "xrWaitFrame failed: XR_ERROR_SESSION_LOST".
  [[nodiscard]] Result<void> checked(XrResult result, const char* what) const {
    if (XR_SUCCEEDED(result)) return {};
    std::array<char, XR_MAX_RESULT_STRING_SIZE> text{};
    if (ResultToString == nullptr || XR_FAILED(ResultToString(instance, result, text.data()))) text[0] = '\0';
    return noDisplay("the headset's runtime has failed ({}: {})", what, text[0] == '\0' ? "unknown" : text.data());
  }
  [[nodiscard]] Result<void> load();
  [[nodiscard]] Result<void> createActions();
  [[nodiscard]] Result<void> suggest(const ControllerProfile& profile);
  [[nodiscard]] Result<void> createSpaces();
  [[nodiscard]] Result<void> createHandTrackers();
  [[nodiscard]] Result<void> createSwapchains();
  [[nodiscard]] Result<void> createSwapchain(Swapchain& chain, int chainWidth, int chainHeight);
  [[nodiscard]] Result<void> acquire(Swapchain& chain);
  [[nodiscard]] Result<void> enter(XrSessionState state);
  [[nodiscard]] Result<void> locate();
  [[nodiscard]] Result<void> readHands();
  [[nodiscard]] double untilShown() const;
  void readBareHand(std::size_t side);
  [[nodiscard]] bool locateIn(XrSpace space, Isometry3& pose) const;
  [[nodiscard]] XrPath path(const std::string& name) const {
    XrPath made = XR_NULL_PATH;
    StringToPath(instance, name.c_str(), &made);
    return made;
  }
};

/// Within a function that has `checked`: calls a function of OpenXR, or returns what failed.
#define LORICA_XR(name, ...) LORICA_TRY_DO(checked(name(__VA_ARGS__), "xr" #name))

}  // namespace lorica
