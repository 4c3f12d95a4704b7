#include "tests/support/datasets.h"
#include "viewer/vr/headset.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdio>
#include <cstdlib>
#include <string>

namespace lorica::test {
namespace {

/// In a process of its own: the loader keeps what it has loaded.
void expectNoHeadset(const std::string& manifest, const std::string& lacking, const char* expected) {
  EXPECT_EXIT(
      {
        setenv("XR_RUNTIME_JSON", manifest.c_str(), 1);
        setenv("LORICA_TEST_LACKS", lacking.c_str(), 1);
        const Result<std::unique_ptr<Headset>> found = Headset::find();
        std::fputs(found ? "found" : found.error().message.c_str(), stderr);
        std::_Exit(found ? 1 : 0);
      },
      testing::ExitedWithCode(0), expected);
}

TEST(HeadsetRuntime, OneThatLacksAFunctionIsEndedAndNamed) {
  const TemporaryFolder folder;
  const std::string manifest = folder.write("runtime.json", R"({"file_format_version": "1.0.0", "runtime": {
      "library_path": ")" LORICA_INCOMPLETE_RUNTIME R"("}})");
  // The first and the last by name, and one between them.
  for (const std::string lacking : {"xrAcquireSwapchainImage", "xrEndFrame", "xrWaitSwapchainImage"}) {
    const std::string expected = "the instance was destroyed\nthe OpenXR runtime lacks " + lacking;
    expectNoHeadset(manifest, lacking, expected.c_str());
  }
}

TEST(HeadsetRuntime, AManifestIsAFileBeforeTheLoaderReadsIt) {
  const TemporaryFolder folder;
  const std::string pipe = (folder.path() / "pipe").string(), linked = (folder.path() / "link").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::filesystem::create_symlink(pipe, linked);
  expectNoHeadset(pipe, "", "manifest of the OpenXR runtime: .*pipe: .*found a named pipe, expected a file");
  expectNoHeadset(linked, "", "manifest of the OpenXR runtime: .*link: .*found a named pipe");
  expectNoHeadset("/dev/zero", "", "manifest of the OpenXR runtime: /dev/zero: .*found a device");
  expectNoHeadset(folder.path().string(), "", "manifest of the OpenXR runtime: .*: Is a directory");
  // The user's own, where the environment names none.
  std::filesystem::create_directories(folder.path() / "openxr/1");
  std::filesystem::create_symlink(pipe, folder.path() / "openxr/1/active_runtime.json");
  setenv("XDG_CONFIG_HOME", folder.path().c_str(), 1);
  expectNoHeadset("", "", "manifest of the OpenXR runtime: .*active_runtime.json: .*found a named pipe");
  unsetenv("XDG_CONFIG_HOME");
}

}  // namespace
}  // namespace lorica::test
