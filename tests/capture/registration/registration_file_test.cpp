#include "capture/registration/registration_file.h"

#include "geometry/files.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace lorica {
namespace {

Registration sample() {
  Registration registration;
  registration.yaw = -3.0 / 7.0;
  registration.translation = Vec3(1.0 / 3.0, -1e-17, -2.7182818284590452);
  registration.headInHeadset = Vec3(0.003, -0.07, 0.1);
  registration.lag = 0.0625;
  registration.residual = 0.026;
  registration.yawDeviation = 0.001;
  registration.levelDeviation = 0.004;
  registration.heightDeviation = 0.011;
  return registration;
}

TEST(RegistrationFile, IsReadAsItWasWritten) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "lorica" / "registrations" / "camera.json";
  EXPECT_EQ(loadRegistration(file).error().code, ErrorCode::kNotFound);
  Registration other = sample();
  other.lag = 0.1;
  ASSERT_TRUE(saveRegistration(file, other).ok());
  const Registration saved = sample();
  ASSERT_TRUE(saveRegistration(file, saved).ok()) << "the second replaces the first";
  const Registration loaded = test::valueOf(loadRegistration(file));
  EXPECT_EQ(loaded.yaw, saved.yaw);
  EXPECT_EQ(loaded.translation, saved.translation);
  EXPECT_EQ(loaded.headInHeadset, saved.headInHeadset);
  EXPECT_EQ(loaded.lag, saved.lag);
  EXPECT_EQ(loaded.residual, saved.residual);
  EXPECT_EQ(loaded.yawDeviation, saved.yawDeviation);
  EXPECT_EQ(loaded.levelDeviation, saved.levelDeviation);
  EXPECT_EQ(loaded.heightDeviation, saved.heightDeviation);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(file.parent_path()), {}), 1) << "nothing is left beside";
}

TEST(RegistrationFile, WhatCannotBeIsASentence) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "lorica" / "camera.json";
  ASSERT_TRUE(saveRegistration(file, sample()).ok());
  const std::string fine = test::valueOf(readFile(file));
  const auto refusal = [&](const std::string& text) {
    const std::filesystem::path damaged = folder.write("damaged.json", text);
    const Result<Registration> loaded = loadRegistration(damaged);
    EXPECT_FALSE(loaded.ok()) << text;
    if (loaded.ok()) return std::string();
    EXPECT_TRUE(test::has(loaded.error().message, damaged.string()));
    return loaded.error().message;
  };
  const auto with = [&](std::string_view from, std::string_view to) {
    std::string text = fine;
    EXPECT_NE(text.find(from), std::string::npos) << from;
    return text.replace(text.find(from), from.size(), to);
  };
  test::expectAll(refusal(with("lorica registration 1", "lorica registration 2")), {"format", "found", "expected"});
  test::expectAll(refusal(with("0.0625", "0.4")), {"lag: found 0.4, expected a number from 0 to 0.2"});
  test::expectAll(refusal(with("0.0625", "\"soon\"")), {"lag: found \"soon\""});
  test::expectAll(refusal(with("\"lag\"", "\"log\"")), {"lag: found null"});
  test::expectAll(refusal(with("-2.718281828459045", "-27182.0")), {"translation: found", "three numbers from -10000"});
  test::expectAll(refusal(with("-2.718281828459045", "[]")), {"translation: found"});
  test::expectAll(refusal(with("\"yaw\"", "\"more\": 1, \"yaw\"")), {"found 10 entries, expected 9"});
  for (const std::string& text :
       {std::string(), std::string("[]"), std::string("null"), std::string("7"), std::string("\xff\xfe"),
        with("0.0625", "NaN"), with("0.0625", "1e999"), with("0.0625", "-1e-9"), with("0.0625", "null"),
        with("0.001", "0.5"), with("-2.718281828459045", "1, 2"), std::string(1000, '['), fine + fine}) {
    EXPECT_NE(refusal(text), "");
  }
  for (std::size_t length = 0; length + 2 < fine.size(); ++length) refusal(fine.substr(0, length));
  test::expectAll(refusal(fine + std::string(1 << 20, ' ')), {"1048904 bytes, expected at most 65536"});
  EXPECT_FALSE(loadRegistration(folder.path()).ok()) << "a folder";
  EXPECT_FALSE(saveRegistration(folder.path() / "damaged.json" / "camera.json", sample()).ok())
      << "a file is no folder";
}

TEST(RegistrationFile, EachCameraHasOneInTheUsersConfigurationFolder) {
  const char* before = std::getenv("XDG_CONFIG_HOME");
  const std::string kept = before == nullptr ? "" : before;
  setenv("XDG_CONFIG_HOME", "/somewhere", 1);
  const std::filesystem::path file = registrationFile("usb:/../1-2");
  EXPECT_EQ(file.parent_path(), "/somewhere/lorica/registrations");
  EXPECT_EQ(file.extension(), ".json");
  EXPECT_EQ(registrationFile("usb:/../1-2"), file);
  EXPECT_NE(registrationFile("usb:/../1-3"), file);
  setenv("XDG_CONFIG_HOME", "relative", 1);
  setenv("HOME", "/home/someone", 1);
  EXPECT_EQ(registrationFile("").parent_path(), "/home/someone/.config/lorica/registrations");
  setenv("XDG_CONFIG_HOME", kept.c_str(), 1);
}

}  // namespace
}  // namespace lorica
