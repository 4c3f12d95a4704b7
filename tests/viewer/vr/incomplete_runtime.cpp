#include <openxr/openxr.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>

// A runtime of headsets that lacks the function that LORICA_TEST_LACKS names, as a library for the OpenXR loader.
// Beyond an instance it does nothing.

namespace {

/// What the loader hands over: loader_interfaces.h of its source, which no package has.
struct RuntimeRequest {
  std::uint32_t structType, structVersion;
  std::size_t structSize;
  std::uint32_t runtimeInterfaceVersion;
  XrVersion runtimeApiVersion;
  PFN_xrGetInstanceProcAddr getInstanceProcAddr;
};

XrResult XRAPI_CALL extensions(const char*, std::uint32_t capacity, std::uint32_t* count, XrExtensionProperties* list) {
  *count = 1;
  if (capacity > 0) std::strcpy(list[0].extensionName, "XR_KHR_opengl_enable");
  return XR_SUCCESS;
}

XrResult XRAPI_CALL createInstance(const XrInstanceCreateInfo*, XrInstance* made) {
  *made = reinterpret_cast<XrInstance>(std::uintptr_t{42});
  return XR_SUCCESS;
}

XrResult XRAPI_CALL destroyInstance(XrInstance) {
  std::fputs("the instance was destroyed\n", stderr);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL nothing() {
  return XR_ERROR_FUNCTION_UNSUPPORTED;
}

XrResult XRAPI_CALL find(XrInstance, const char* name, PFN_xrVoidFunction* function) {
  const std::string_view asked = name;
  const char* lacking = std::getenv("LORICA_TEST_LACKS");
  *function = asked == "xrEnumerateInstanceExtensionProperties" ? reinterpret_cast<PFN_xrVoidFunction>(extensions)
              : asked == "xrCreateInstance"                     ? reinterpret_cast<PFN_xrVoidFunction>(createInstance)
              : asked == "xrDestroyInstance"                    ? reinterpret_cast<PFN_xrVoidFunction>(destroyInstance)
              : asked == "xrGetInstanceProcAddr"                ? reinterpret_cast<PFN_xrVoidFunction>(find)
                                                                : reinterpret_cast<PFN_xrVoidFunction>(nothing);
  if (lacking != nullptr && asked == lacking) *function = nullptr;
  return *function == nullptr ? XR_ERROR_FUNCTION_UNSUPPORTED : XR_SUCCESS;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) XrResult xrNegotiateLoaderRuntimeInterface(const void*,
                                                                                             RuntimeRequest* request) {
  request->runtimeInterfaceVersion = 1;
  request->runtimeApiVersion = XR_MAKE_VERSION(1, 0, 20);
  request->getInstanceProcAddr = find;
  return XR_SUCCESS;
}
