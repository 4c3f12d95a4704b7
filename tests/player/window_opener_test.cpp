#include "player/window_opener.h"

#include "geometry/errors.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
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

/// Files that somebody sent: one that is given up for another, fails or is cancelled is removed, one that was opened is
/// listed behind the user's own and never among them.
TEST(WindowOpener, SentFilesAreKeptOnlyIfTheyAreOpened) {
  const TemporaryFolder folder;
  Listening host;
  std::atomic<bool> waits = true, fails = false;
  WindowOpener opener(CastRequest(), host, "",
                      [&](const std::vector<CastRequest>& attempts, Host& loading) -> Result<Cast> {
                        while (waits && !loading.cancelled()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
                        if (fails) return badFormat("no such thing");
                        Cast cast;
                        cast.request = attempts.front();
                        return cast;
                      });
  const auto taken = [&] {
    for (;;) {
      if (std::optional<Result<Cast>> cast = opener.take()) return cast->ok();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  };
  std::filesystem::create_directory(folder.path() / kSentFolder);
  const auto sent = [&](const std::string& name) {
    return std::filesystem::path(folder.write(std::string(kSentFolder) + "/" + name, name));
  };
  const std::filesystem::path first = sent("1.glb"), second = sent("2.glb"), third = sent("3.bvh"), bad = sent("4.bvh"),
                              late = sent("5.bvh"), own = folder.write("own.glb", "own");
  opener.recordInto(folder.path());
  ASSERT_TRUE(opener.openReceived(first));
  ASSERT_TRUE(opener.openReceived(second));
  EXPECT_FALSE(exists(first)) << "another one took its place";
  waits = false;
  EXPECT_TRUE(taken());
  ASSERT_TRUE(opener.openReceived(third));
  EXPECT_TRUE(taken());
  fails = true;
  ASSERT_TRUE(opener.openReceived(bad));
  EXPECT_FALSE(taken());
  waits = true;
  ASSERT_TRUE(opener.openReceived(late));
  opener.cancel();
  EXPECT_FALSE(taken());
  waits = fails = false;
  ASSERT_TRUE(opener.open({own.string()}));
  EXPECT_TRUE(taken());
  ASSERT_TRUE(opener.open({second.string()})) << "again, from the list";
  EXPECT_TRUE(taken());
  for (const auto& kept : {second, third, own}) EXPECT_TRUE(exists(kept)) << kept;
  for (const auto& removed : {bad, late}) EXPECT_FALSE(exists(removed)) << removed;
  EXPECT_EQ(opener.opened(), std::vector<std::string>{own.string()});
  opener.list({own.string()});
  WindowValues values;
  opener.describe(values);
  EXPECT_EQ(std::vector<std::string>(values.characters.begin(), values.characters.end()),
            (std::vector<std::string>{own.string(), second.string(), "mannequin"}));
  EXPECT_EQ(std::vector<std::string>(values.recent.begin(), values.recent.end()),
            std::vector<std::string>{third.string()});
}

/// Opened once, a file may name others that only --trust-paths lets it have.
TEST(WindowOpener, SentFilesAreNotListedWhereTheyMayNameAnyOther) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / kSentFolder);
  const std::string file = folder.write(std::string(kSentFolder) + "/1.bvh", "1");
  folder.write(std::string(kSentFolder) + "/2.bvh.tmp-1-1", "half of it");
  for (const PathTrust paths : {PathTrust::kBeneath, PathTrust::kAnywhere}) {
    Host host;
    host.paths = paths;
    WindowOpener opener(CastRequest(), host);
    opener.recordInto(folder.path());
    opener.list({});
    WindowValues values;
    opener.describe(values);
    EXPECT_EQ(std::vector<std::string>(values.recent.begin(), values.recent.end()),
              paths == PathTrust::kBeneath ? std::vector<std::string>{file} : std::vector<std::string>());
  }
}

}  // namespace
}  // namespace lorica::test
