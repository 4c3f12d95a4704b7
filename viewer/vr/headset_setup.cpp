#include "geometry/files.h"
#include "geometry/text.h"
#include "viewer/vr/headset_impl.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

namespace lorica {

/// The inputs of a kind of controller. Those of the buttons are for the left and the right hand; null = none.
struct ControllerProfile {
  const char* name;
  const char *trigger, *squeeze, *stick;
  std::array<const char*, 2> change, open;
};

namespace {

constexpr double kUsualHeight = 1.6;  // of the head, where the runtime knows no floor [m]

constexpr std::array<ControllerProfile, 5> kProfiles = {
    {{"khr/simple_controller", "select/click", nullptr, nullptr, {"menu/click", "menu/click"}, {}},
     {"oculus/touch_controller",
      "trigger/value",
      "squeeze/value",
      "thumbstick",
      {"x/click", "a/click"},
      {"y/click", "b/click"}},
     {"valve/index_controller",
      "trigger/value",
      "squeeze/value",
      "thumbstick",
      {"a/click", "a/click"},
      {"b/click", "b/click"}},
     {"microsoft/motion_controller",
      "trigger/value",
      "squeeze/click",
      "thumbstick",
      {"menu/click", "menu/click"},
      {"thumbstick/click", "thumbstick/click"}},
     {"htc/vive_controller",
      "trigger/value",
      "squeeze/click",
      "trackpad",
      {"menu/click", "menu/click"},
      {"trackpad/click", "trackpad/click"}}}};

template <std::size_t N>
void copyName(std::string_view name, char (&to)[N]) {
  std::copy_n(name.data(), std::min(name.size(), N - 1), to);
}

constexpr XrPosef kHere = {{0.0f, 0.0f, 0.0f, 1.0f}, {0.0f, 0.0f, 0.0f}};

template <typename F>
F symbol(void* library, const char* name) {
  return library == nullptr ? nullptr : reinterpret_cast<F>(dlsym(library, name));
}

/// The runtime's manifest, where the loader looks for it; empty if there is none.
std::filesystem::path runtimeManifest() {
  if (std::string named = environment("XR_RUNTIME_JSON"); !named.empty()) return named;
  const auto orElse = [](std::string text, const std::string& usual) { return text.empty() ? usual : text; };
  std::string folders = orElse(environment("XDG_CONFIG_HOME"), environment("HOME") + "/.config") + ":" +
                        orElse(environment("XDG_CONFIG_DIRS"), "/etc/xdg") + ":/etc:";
  for (std::size_t end = 0; (end = folders.find(':')) != std::string::npos; folders.erase(0, end + 1)) {
    const std::filesystem::path file = std::filesystem::path(folders.substr(0, end)) / "openxr/1/active_runtime.json";
    std::error_code ignored;
    if (std::filesystem::exists(file, ignored)) return file;
  }
  return {};
}

/// The loader would wait for a named pipe, and read a device until memory ends.
Result<void> checkManifest() {
  constexpr std::uint64_t kMaxManifest = 1 << 20;  // [bytes]
  const std::filesystem::path file = runtimeManifest();
  if (file.empty()) return {};
  const Result<std::string> read = readFile(file, NamedBy::kFile, kMaxManifest);
  if (!read) return noDisplay("the manifest of the OpenXR runtime: {}", read.error().message);
  return {};
}

/// The OpenGL context of this thread, for a session. A library that made one is loaded already.
struct ContextBinding {
  XrGraphicsBindingOpenGLXlibKHR glx = typed<XrGraphicsBindingOpenGLXlibKHR>(XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR);
  XrGraphicsBindingEGLMNDX egl = typed<XrGraphicsBindingEGLMNDX>(XR_TYPE_GRAPHICS_BINDING_EGL_MNDX);

  /// @return what XrSessionCreateInfo::next points to; null if there is no context
  const void* find(bool eglOffered) {
    for (const char* name : {"libGLX.so.0", "libGL.so.1"}) {
      if (findGlx(dlopen(name, RTLD_LAZY | RTLD_NOLOAD))) return &glx;
    }
    return eglOffered && findEgl(dlopen("libEGL.so.1", RTLD_LAZY | RTLD_NOLOAD)) ? &egl : nullptr;
  }

 private:
  bool findGlx(void* library) {
    constexpr int kConfigId = 0x8013, kVisualId = 0x800b, kScreen = 0x800c;
    const auto context = symbol<void* (*)()>(library, "glXGetCurrentContext");
    const auto display = symbol<void* (*)()>(library, "glXGetCurrentDisplay");
    const auto drawable = symbol<GLXDrawable (*)()>(library, "glXGetCurrentDrawable");
    const auto query = symbol<int (*)(void*, void*, int, int*)>(library, "glXQueryContext");
    const auto choose = symbol<void** (*)(void*, int, const int*, int*)>(library, "glXChooseFBConfig");
    const auto attribute = symbol<int (*)(void*, void*, int, int*)>(library, "glXGetFBConfigAttrib");
    if (!context || !display || !drawable || !query || !choose || !attribute || context() == nullptr) return false;
    int id = 0, screen = 0, count = 0, visual = 0;
    query(display(), context(), kConfigId, &id);
    query(display(), context(), kScreen, &screen);
    const std::array<int, 3> wanted = {kConfigId, id, 0};
    void** configs = choose(display(), screen, wanted.data(), &count);
    if (configs == nullptr || count < 1) return false;
    attribute(display(), configs[0], kVisualId, &visual);
    glx.xDisplay = display();
    glx.visualid = visual;
    glx.glxFBConfig = configs[0];
    glx.glxDrawable = drawable();
    glx.glxContext = context();
    return true;
  }

  bool findEgl(void* library) {
    constexpr int kConfigId = 0x3028, kNone = 0x3038;
    const auto context = symbol<void* (*)()>(library, "eglGetCurrentContext");
    const auto display = symbol<void* (*)()>(library, "eglGetCurrentDisplay");
    const auto query = symbol<unsigned (*)(void*, void*, int, int*)>(library, "eglQueryContext");
    const auto choose = symbol<unsigned (*)(void*, const int*, void**, int, int*)>(library, "eglChooseConfig");
    egl.getProcAddress = symbol<PFNEGLGETPROCADDRESSPROC>(library, "eglGetProcAddress");
    if (!context || !display || !query || !choose || !egl.getProcAddress || context() == nullptr) return false;
    int id = 0, count = 0;
    query(display(), context(), kConfigId, &id);
    const std::array<int, 3> wanted = {kConfigId, id, kNone};
    egl.display = display();
    egl.context = context();
    return choose(egl.display, wanted.data(), &egl.config, 1, &count) != 0 && count == 1;
  }
};

}  // namespace

/// Opens the loader, which finds the runtime.
Result<void> XrHeadset::load() {
  LORICA_TRY_DO(checkManifest());
  ::setenv("XR_LOADER_DEBUG", "none", 0);  // it would write to standard error what is said here
  void* library = ::dlopen("libopenxr_loader.so.1", RTLD_NOW | RTLD_LOCAL);
  const auto find = symbol<PFN_xrGetInstanceProcAddr>(library, "xrGetInstanceProcAddr");
  if (find == nullptr) return noDisplay("--vr needs OpenXR's loader: install the Debian package libopenxr-loader1");
  const auto address = [&](const char* name) {
    PFN_xrVoidFunction found = nullptr;
    return XR_SUCCEEDED(find(instance, name, &found)) ? found : nullptr;
  };
  const auto list =
      reinterpret_cast<PFN_xrEnumerateInstanceExtensionProperties>(address("xrEnumerateInstanceExtensionProperties"));
  const auto create = reinterpret_cast<PFN_xrCreateInstance>(address("xrCreateInstance"));
  std::uint32_t count = 0;
  if (list == nullptr || create == nullptr || XR_FAILED(list(nullptr, 0, &count, nullptr))) {
    return noDisplay("no OpenXR runtime is installed and active: start SteamVR, Monado or WiVRn, see docs/VR.md");
  }
  std::vector<XrExtensionProperties> known(count, typed<XrExtensionProperties>(XR_TYPE_EXTENSION_PROPERTIES));
  list(nullptr, count, &count, known.data());
  const auto has = [&](std::string_view name) {
    return std::any_of(known.begin(), known.end(), [&](const auto& one) { return one.extensionName == name; });
  };
  if (!has(XR_KHR_OPENGL_ENABLE_EXTENSION_NAME)) return noDisplay("the OpenXR runtime takes no pictures of OpenGL");
  egl = has(XR_MNDX_EGL_ENABLE_EXTENSION_NAME);
  handTracking = has(XR_EXT_HAND_TRACKING_EXTENSION_NAME);
  const bool clock = has(XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME);
  std::vector<const char*> wanted = {XR_KHR_OPENGL_ENABLE_EXTENSION_NAME};
  if (egl) wanted.push_back(XR_MNDX_EGL_ENABLE_EXTENSION_NAME);
  if (handTracking) wanted.push_back(XR_EXT_HAND_TRACKING_EXTENSION_NAME);
  if (clock) wanted.push_back(XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME);
  auto info = typed<XrInstanceCreateInfo>(XR_TYPE_INSTANCE_CREATE_INFO);
  copyName("Lorica", info.applicationInfo.applicationName);
  info.applicationInfo.apiVersion = XR_MAKE_VERSION(1, 0, 0);
  info.enabledExtensionCount = std::uint32_t(wanted.size());
  info.enabledExtensionNames = wanted.data();
  if (const XrResult made = create(&info, &instance); XR_FAILED(made)) {
    instance = null<XrInstance>();
    return noDisplay("the OpenXR runtime does not answer (error {}): start it first, see docs/VR.md", int(made));
  }
#define LORICA_XR_LOAD(name)                                        \
  this->name = reinterpret_cast<PFN_xr##name>(address("xr" #name)); \
  if (this->name == nullptr) return noDisplay("the OpenXR runtime lacks xr" #name);
  LORICA_XR_FUNCTIONS(LORICA_XR_LOAD)
  if (handTracking) {
    LORICA_XR_HAND_FUNCTIONS(LORICA_XR_LOAD)
  }
  if (clock) {
    LORICA_XR_LOAD(ConvertTimespecTimeToTimeKHR)
  }
#undef LORICA_XR_LOAD
  auto runtime = typed<XrInstanceProperties>(XR_TYPE_INSTANCE_PROPERTIES);
  LORICA_XR(GetInstanceProperties, instance, &runtime);
  auto systemInfo = typed<XrSystemGetInfo>(XR_TYPE_SYSTEM_GET_INFO);
  systemInfo.formFactor = XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY;
  if (XR_FAILED(GetSystem(instance, &systemInfo, &system))) {
    return noDisplay("{} finds no headset: connect it and switch it on", runtime.runtimeName);
  }
  auto properties = typed<XrSystemProperties>(XR_TYPE_SYSTEM_PROPERTIES);
  auto hands = typed<XrSystemHandTrackingPropertiesEXT>(XR_TYPE_SYSTEM_HAND_TRACKING_PROPERTIES_EXT);
  if (handTracking) properties.next = &hands;
  LORICA_XR(GetSystemProperties, instance, system, &properties);
  handTracking = hands.supportsHandTracking != XR_FALSE;
  description_ = fmt::format("{}, {}", runtime.runtimeName, properties.systemName);
  return {};
}

Result<void> XrHeadset::suggest(const ControllerProfile& profile) {
  std::vector<XrActionSuggestedBinding> bindings;
  bindings.reserve(16);
  for (std::size_t hand = 0; hand < 2; ++hand) {
    const std::string user = hand == 0 ? "/user/hand/left/" : "/user/hand/right/";
    const auto bind = [&](XrAction action, const char* input) {
      if (input != nullptr) bindings.push_back({action, path(user + "input/" + input)});
    };
    bind(grip, "grip/pose");
    bind(aim, "aim/pose");
    bind(trigger, profile.trigger);
    bind(squeeze, profile.squeeze);
    bind(stick, profile.stick);
    bind(change, profile.change[hand]);
    bind(open, profile.open[hand]);
    bindings.push_back({shake, path(user + "output/haptic")});
  }
  auto suggestion = typed<XrInteractionProfileSuggestedBinding>(XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING);
  suggestion.interactionProfile = path(std::string("/interaction_profiles/") + profile.name);
  suggestion.countSuggestedBindings = std::uint32_t(bindings.size());
  suggestion.suggestedBindings = bindings.data();
  LORICA_XR(SuggestInteractionProfileBindings, instance, &suggestion);
  return {};
}

Result<void> XrHeadset::createActions() {
  paths = {path("/user/hand/left"), path("/user/hand/right")};
  auto set = typed<XrActionSetCreateInfo>(XR_TYPE_ACTION_SET_CREATE_INFO);
  copyName("hands", set.actionSetName);
  copyName("Hands", set.localizedActionSetName);
  LORICA_XR(CreateActionSet, instance, &set, &actions);
  struct Made {
    XrAction* action;
    const char *name, *text;
    XrActionType type;
  };
  for (const Made& one : {Made{&grip, "grip", "Hand", XR_ACTION_TYPE_POSE_INPUT},
                          {&aim, "aim", "Pointing", XR_ACTION_TYPE_POSE_INPUT},
                          {&trigger, "trigger", "Hold a prop", XR_ACTION_TYPE_FLOAT_INPUT},
                          {&squeeze, "squeeze", "Hold a prop, too", XR_ACTION_TYPE_FLOAT_INPUT},
                          {&stick, "stick", "Walk and turn", XR_ACTION_TYPE_VECTOR2F_INPUT},
                          {&change, "change", "Beside or inside the avatar", XR_ACTION_TYPE_BOOLEAN_INPUT},
                          {&open, "open", "Open or close the panel", XR_ACTION_TYPE_BOOLEAN_INPUT},
                          {&shake, "shake", "Touch", XR_ACTION_TYPE_VIBRATION_OUTPUT}}) {
    auto info = typed<XrActionCreateInfo>(XR_TYPE_ACTION_CREATE_INFO);
    copyName(one.name, info.actionName);
    copyName(one.text, info.localizedActionName);
    info.actionType = one.type;
    info.countSubactionPaths = std::uint32_t(paths.size());
    info.subactionPaths = paths.data();
    LORICA_XR(CreateAction, actions, &info, one.action);
  }
  for (const ControllerProfile& profile : kProfiles) LORICA_TRY_DO(suggest(profile));
  auto attached = typed<XrSessionActionSetsAttachInfo>(XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO);
  attached.countActionSets = 1;
  attached.actionSets = &actions;
  LORICA_XR(AttachSessionActionSets, session, &attached);
  return {};
}

Result<void> XrHeadset::createSpaces() {
  auto info = typed<XrReferenceSpaceCreateInfo>(XR_TYPE_REFERENCE_SPACE_CREATE_INFO);
  info.poseInReferenceSpace = kHere;
  info.referenceSpaceType = XR_REFERENCE_SPACE_TYPE_VIEW;
  LORICA_XR(CreateReferenceSpace, session, &info, &view);
  info.referenceSpaceType = XR_REFERENCE_SPACE_TYPE_STAGE;
  if (XR_FAILED(CreateReferenceSpace(session, &info, &stage))) {  // the runtime knows no floor
    info.referenceSpaceType = XR_REFERENCE_SPACE_TYPE_LOCAL;
    info.poseInReferenceSpace.position.y = -float(kUsualHeight);
    LORICA_XR(CreateReferenceSpace, session, &info, &stage);
  }
  for (std::size_t hand = 0; hand < 2; ++hand) {
    auto space = typed<XrActionSpaceCreateInfo>(XR_TYPE_ACTION_SPACE_CREATE_INFO);
    space.poseInActionSpace = kHere;
    space.subactionPath = paths[hand];
    space.action = grip;
    LORICA_XR(CreateActionSpace, session, &space, &grips[hand]);
    space.action = aim;
    LORICA_XR(CreateActionSpace, session, &space, &aims[hand]);
  }
  return {};
}

Result<void> XrHeadset::createHandTrackers() {
  for (std::size_t side = 0; handTracking && side < trackers.size(); ++side) {
    auto info = typed<XrHandTrackerCreateInfoEXT>(XR_TYPE_HAND_TRACKER_CREATE_INFO_EXT);
    info.hand = side == 0 ? XR_HAND_LEFT_EXT : XR_HAND_RIGHT_EXT;
    info.handJointSet = XR_HAND_JOINT_SET_DEFAULT_EXT;
    LORICA_XR(CreateHandTrackerEXT, session, &info, &trackers[side]);
  }
  return {};
}

/// The renderer's pictures are sRGB, and are copied as they are.
Result<void> XrHeadset::createSwapchains() {
  std::array<XrViewConfigurationView, 2> seen;
  seen.fill(typed<XrViewConfigurationView>(XR_TYPE_VIEW_CONFIGURATION_VIEW));
  std::uint32_t count = 0;
  LORICA_XR(EnumerateViewConfigurationViews, instance, system, kStereo, 2, &count, seen.data());
  width_ = int(seen[0].recommendedImageRectWidth);
  height_ = int(seen[0].recommendedImageRectHeight);
  LORICA_XR(EnumerateSwapchainFormats, session, 0, &count, nullptr);
  std::vector<std::int64_t> formats(count);
  LORICA_XR(EnumerateSwapchainFormats, session, count, &count, formats.data());
  if (std::find(formats.begin(), formats.end(), GL_SRGB8_ALPHA8) == formats.end()) {
    return noDisplay("the headset takes no sRGB pictures of 8 bits");
  }
  for (Swapchain& eye : eyes) LORICA_TRY_DO(createSwapchain(eye, width_, height_));
  LORICA_TRY_DO(createSwapchain(panel, kPanelWidth, kPanelHeight));
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
  return {};
}

Result<void> XrHeadset::createSwapchain(Swapchain& chain, int chainWidth, int chainHeight) {
  auto info = typed<XrSwapchainCreateInfo>(XR_TYPE_SWAPCHAIN_CREATE_INFO);
  info.usageFlags = XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT | XR_SWAPCHAIN_USAGE_SAMPLED_BIT;
  info.format = GL_SRGB8_ALPHA8;
  info.sampleCount = info.faceCount = info.arraySize = info.mipCount = 1;
  info.width = std::uint32_t(chainWidth);
  info.height = std::uint32_t(chainHeight);
  LORICA_XR(CreateSwapchain, session, &info, &chain.handle);
  std::uint32_t count = 0;
  LORICA_XR(EnumerateSwapchainImages, chain.handle, 0, &count, nullptr);
  std::vector<XrSwapchainImageOpenGLKHR> images(count,
                                                typed<XrSwapchainImageOpenGLKHR>(XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_KHR));
  LORICA_XR(EnumerateSwapchainImages, chain.handle, count, &count,
            reinterpret_cast<XrSwapchainImageBaseHeader*>(images.data()));
  chain.framebuffers.resize(count);
  chain.textures.resize(count);
  gl.GenFramebuffers(GLsizei(count), chain.framebuffers.data());
  for (std::size_t i = 0; i < images.size(); ++i) {
    chain.textures[i] = images[i].image;
    gl.BindFramebuffer(GL_FRAMEBUFFER, chain.framebuffers[i]);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, images[i].image, 0);
    const GLenum status = gl.CheckFramebufferStatus(GL_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE) return noDisplay("the headset's pictures cannot be drawn (0x{:x})", status);
  }
  return {};
}

Result<void> XrHeadset::start(Renderer::GetProc getProc) {
  LORICA_TRY(gl, loadGlFunctions(getProc));
  auto needs = typed<XrGraphicsRequirementsOpenGLKHR>(XR_TYPE_GRAPHICS_REQUIREMENTS_OPENGL_KHR);
  LORICA_XR(GetOpenGLGraphicsRequirementsKHR, instance, system, &needs);
  ContextBinding context;
  auto info = typed<XrSessionCreateInfo>(XR_TYPE_SESSION_CREATE_INFO);
  info.next = context.find(egl);
  info.systemId = system;
  if (info.next == nullptr) {
    return noDisplay("{} takes no pictures of this OpenGL; without a display it needs XR_MNDX_egl_enable",
                     description_);
  }
  LORICA_XR(CreateSession, instance, &info, &session);
  LORICA_TRY_DO(createActions());
  LORICA_TRY_DO(createSpaces());
  LORICA_TRY_DO(createHandTrackers());
  return createSwapchains();
}

}  // namespace lorica
