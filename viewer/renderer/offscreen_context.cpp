#include "geometry/errors.h"
#include "geometry/text.h"
#include "viewer/renderer/renderer.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <cstdint>

namespace lorica {
namespace {

// The few types and constants of osmesa.h and egl.h that are used, so that neither header is needed to build.
constexpr int kOsMesaFormat = 0x22, kOsMesaRgba = 0x1908, kOsMesaDepthBits = 0x30, kOsMesaProfile = 0x33;
constexpr int kOsMesaCoreProfile = 0x34, kOsMesaMajor = 0x36, kOsMesaMinor = 0x37;
constexpr unsigned kGlUnsignedByte = 0x1401, kGlVersion = 0x1F02;
constexpr unsigned kEglPlatformSurfaceless = 0x31DD, kEglOpenGlApi = 0x30A2;
constexpr int kEglNone = 0x3038, kEglSurfaceType = 0x3033, kEglRenderableType = 0x3040, kEglOpenGlBit = 0x0008;
constexpr int kEglMajor = 0x3098, kEglMinor = 0x30FB, kEglProfileMask = 0x30FD, kEglCoreProfileBit = 1;

using AnyFunction = void (*)();
using GlGetString = const unsigned char* (*)(unsigned);

// Both libraries stay loaded until the program ends: they contain LLVM and thread-local state, which cannot be
// unloaded. RTLD_LOCAL keeps the 1,300 gl* symbols of libOSMesa separate from a libGL that GLFW may load.
struct OsMesa {
  void* library = nullptr;
  void* (*createContextAttribs)(const int*, void*) = nullptr;
  void (*destroyContext)(void*) = nullptr;
  unsigned char (*makeCurrent)(void*, void*, unsigned, int, int) = nullptr;
  AnyFunction (*getProcAddress)(const char*) = nullptr;
};

struct Egl {
  void* library = nullptr;
  AnyFunction (*getProcAddress)(const char*) = nullptr;
  void* (*getPlatformDisplay)(unsigned, void*, const std::intptr_t*) = nullptr;
  unsigned (*initialize)(void*, int*, int*) = nullptr;
  unsigned (*bindApi)(unsigned) = nullptr;
  unsigned (*chooseConfig)(void*, const int*, void**, int, int*) = nullptr;
  void* (*createContext)(void*, void*, void*, const int*) = nullptr;
  unsigned (*destroyContext)(void*, void*) = nullptr;
  unsigned (*makeCurrent)(void*, void*, void*, void*) = nullptr;
  int (*getError)() = nullptr;
};

template <typename Function>
bool find(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(dlsym(library, name));
  return function != nullptr;
}

const OsMesa& osMesa() {
  static const OsMesa api = [] {
    OsMesa a;
    for (const char* name : {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"}) {
      a.library = dlopen(name, RTLD_LAZY | RTLD_LOCAL);
      if (a.library != nullptr) break;
    }
    if (a.library == nullptr) return a;
    const bool complete = find(a.library, "OSMesaCreateContextAttribs", a.createContextAttribs) &&
                          find(a.library, "OSMesaDestroyContext", a.destroyContext) &&
                          find(a.library, "OSMesaMakeCurrent", a.makeCurrent) &&
                          find(a.library, "OSMesaGetProcAddress", a.getProcAddress);
    return complete ? a : OsMesa{};
  }();
  return api;
}

const Egl& egl() {
  static const Egl api = [] {
    Egl a;
    a.library = dlopen("libEGL.so.1", RTLD_LAZY | RTLD_LOCAL);
    if (a.library == nullptr) return a;
    const bool complete =
        find(a.library, "eglGetProcAddress", a.getProcAddress) &&
        find(a.library, "eglGetPlatformDisplay", a.getPlatformDisplay) &&
        find(a.library, "eglInitialize", a.initialize) && find(a.library, "eglBindAPI", a.bindApi) &&
        find(a.library, "eglChooseConfig", a.chooseConfig) && find(a.library, "eglCreateContext", a.createContext) &&
        find(a.library, "eglDestroyContext", a.destroyContext) && find(a.library, "eglMakeCurrent", a.makeCurrent) &&
        find(a.library, "eglGetError", a.getError);
    return complete ? a : Egl{};
  }();
  return api;
}

void* osMesaProc(const char* name) {
  return reinterpret_cast<void*>(osMesa().getProcAddress(name));
}
void* eglProc(const char* name) {
  return reinterpret_cast<void*>(egl().getProcAddress(name));
}

std::string glVersion(OffscreenContext::GetProc getProc) {
  const auto getString = reinterpret_cast<GlGetString>(getProc("glGetString"));
  const unsigned char* text = getString == nullptr ? nullptr : getString(kGlVersion);
  return text == nullptr ? "unknown version" : reinterpret_cast<const char*>(text);
}

}  // namespace

struct OffscreenContext::Impl {
  void* osMesaContext = nullptr;
  std::array<unsigned char, 16 * 16 * 4> osMesaPixels{};  // OSMesa requires a buffer; nothing is drawn there
  void* eglDisplay = nullptr;
  void* eglContext = nullptr;
  std::string description;
  GetProc getProc = nullptr;

  ~Impl() {
    if (osMesaContext != nullptr) {
      osMesa().makeCurrent(nullptr, nullptr, 0, 0, 0);
      osMesa().destroyContext(osMesaContext);
    }
    if (eglContext != nullptr) {
      egl().makeCurrent(eglDisplay, nullptr, nullptr, nullptr);
      egl().destroyContext(eglDisplay, eglContext);
    }
  }

  /// @return empty on success, otherwise the reason of the failure
  std::string openOsMesa() {
    if (osMesa().library == nullptr) return "libOSMesa is not installed";
    const int attributes[] = {kOsMesaFormat,
                              kOsMesaRgba,
                              kOsMesaDepthBits,
                              24,
                              kOsMesaProfile,
                              kOsMesaCoreProfile,
                              kOsMesaMajor,
                              3,
                              kOsMesaMinor,
                              3,
                              0};
    osMesaContext = osMesa().createContextAttribs(attributes, nullptr);
    if (osMesaContext == nullptr) return "libOSMesa has no OpenGL 3.3 core context";
    if (!osMesa().makeCurrent(osMesaContext, osMesaPixels.data(), kGlUnsignedByte, 16, 16)) {
      osMesa().destroyContext(osMesaContext);
      osMesaContext = nullptr;
      return "OSMesaMakeCurrent failed";
    }
    getProc = osMesaProc;
    description = "OSMesa, OpenGL " + glVersion(getProc);
    return {};
  }

  std::string openEgl() {
    const Egl& api = egl();
    if (api.library == nullptr) return "libEGL is not installed";
    eglDisplay = api.getPlatformDisplay(kEglPlatformSurfaceless, nullptr, nullptr);
    int major = 0, minor = 0;
    if (eglDisplay == nullptr || !api.initialize(eglDisplay, &major, &minor)) {
      return fmt::format("EGL has no surfaceless display (error 0x{:x})", api.getError());
    }
    if (!api.bindApi(kEglOpenGlApi)) return "EGL offers no desktop OpenGL";
    const int wanted[] = {kEglSurfaceType, 0, kEglRenderableType, kEglOpenGlBit, kEglNone};
    void* config = nullptr;
    int count = 0;
    if (!api.chooseConfig(eglDisplay, wanted, &config, 1, &count) || count < 1) {
      return "EGL has no configuration for OpenGL";
    }
    const int attributes[] = {kEglMajor, 3, kEglMinor, 3, kEglProfileMask, kEglCoreProfileBit, kEglNone};
    eglContext = api.createContext(eglDisplay, config, nullptr, attributes);
    if (eglContext == nullptr) {
      return fmt::format("EGL has no OpenGL 3.3 core context (error 0x{:x})", api.getError());
    }
    if (!api.makeCurrent(eglDisplay, nullptr, nullptr, eglContext)) {
      return fmt::format("eglMakeCurrent failed (error 0x{:x})", api.getError());
    }
    getProc = eglProc;
    description = fmt::format("EGL {}.{} surfaceless, OpenGL {}", major, minor, glVersion(getProc));
    return {};
  }
};

OffscreenContext::OffscreenContext(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
OffscreenContext::~OffscreenContext() = default;
OffscreenContext::OffscreenContext(OffscreenContext&&) noexcept = default;
OffscreenContext& OffscreenContext::operator=(OffscreenContext&&) noexcept = default;

Result<OffscreenContext> OffscreenContext::create(bool eglOnly) {
  const std::string forced = eglOnly ? "egl" : environment("LORICA_OFFSCREEN");
  if (!forced.empty() && forced != "osmesa" && forced != "egl") {
    return invalidArgument("LORICA_OFFSCREEN is '{}', expected 'osmesa' or 'egl'", forced);
  }
  std::string tried;
  for (const auto& [other, open] : {std::pair("egl", &Impl::openOsMesa), {"osmesa", &Impl::openEgl}}) {
    if (forced == other) continue;
    auto impl = std::make_unique<Impl>();
    const std::string why = (*impl.*open)();
    if (why.empty()) return OffscreenContext(std::move(impl));
    tried += (tried.empty() ? "" : "; ") + why;
  }
  return noDisplay(
      eglOnly ? fmt::format("no surfaceless OpenGL ({}): install the Debian package libegl1", tried)
              : fmt::format("no off-screen OpenGL ({}): install the Debian package libosmesa6 or libegl1", tried));
}

std::string OffscreenContext::description() const {
  return impl_->description;
}
OffscreenContext::GetProc OffscreenContext::getProc() const {
  return impl_->getProc;
}

}  // namespace lorica
