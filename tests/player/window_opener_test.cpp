#include "player/window_opener.h"

#include "tests/skinning/import/small_character.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace lorica::test {
namespace {

struct Listening final : Host {
  std::vector<std::string> warnings;
  void warn(const std::string& sentence) override { warnings.push_back(sentence); }
};

Result<Cast> openedBy(WindowOpener& opener, const std::filesystem::path& file) {
  LORICA_TRY_DO(opener.open({file.string()}));
  while (true) {
    if (std::optional<Result<Cast>> cast = opener.take()) return std::move(*cast);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

TEST(WindowOpener, OptionsForOneCharacterYieldToAnother) {
  const TemporaryFolder folder;
  const std::filesystem::path box = folder.write("box.glb", smallCharacter().glb());
  Listening host;
  CastRequest present;
  present.reading.expressions = {"Joy=1"};
  present.performing.clip = "Nod";
  WindowOpener opener(present, host);
  const Result<Cast> cast = openedBy(opener, box);
  ASSERT_TRUE(cast) << cast.error().message;
  EXPECT_EQ(cast->avatars.front().character().name, "box");
  EXPECT_TRUE(cast->request.reading.expressions.empty());
  EXPECT_EQ(host.warnings,
            std::vector<std::string>{"--expression and --clip do not fit what was opened and are left out"});
}

TEST(WindowOpener, WhatItDoesNotOpenIsNamed) {
  const TemporaryFolder folder;
  Listening host;
  CastRequest present;
  present.motion = "walk";
  WindowOpener opener(present, host);
  const Result<Cast> cast = openedBy(opener, folder.write("photo.jpg", "\xff\xd8\xff\xe0"));
  ASSERT_FALSE(cast);
  EXPECT_NE(cast.error().message.find("found a JPEG picture; Lorica opens characters"), std::string::npos);
  EXPECT_TRUE(host.warnings.empty());
}

}  // namespace
}  // namespace lorica::test
