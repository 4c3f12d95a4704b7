#include "export/bake/baker.h"

#include "export/bake/child_process.h"
#include "geometry/files.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

// The order of work, with a script in place of the program that makes items.

/// Stands for `lorica decompose INPUT -o OUT --json REPORT ...` and `lorica export INPUT OUT ...`; the first word of
/// the input says what happens. Notes each run in the folder `runs`.
constexpr const char* kProgram = R"sh(#!/bin/sh
runs=$(dirname "$0")/runs
if [ "$1" = export ]; then cp "$2" "$3"; exit 0; fi
echo run >>"$runs/$(basename "$2")"
failed() { printf '{"failure": {"kind": "%s", "message": "%s"}}' "$1" "$2" >"$LORICA_FAILURE_FILE"; }
case $(cat "$2" 2>/dev/null) in
  good*) ;;
  slow*) sleep 0.3 ;;
  crash*) kill -SEGV $$ ;;
  killed*) kill -KILL $$ ;;
  hang*) sleep 100 ;;
  mute*) exit 1 ;;
  hungry*) failed outOfMemory std::bad_alloc; exit 1 ;;
  full*) failed unwritable "$4: no space"; exit 2 ;;
  fuller*) echo "lorica: $4: no space" >&2; exit 2 ;;
  away*) failed notFound "$2: is not there"; rm "$2"; exit 2 ;;
  forged*) failed badMesh "$2: mesh 'lorica: x: cannot be written: bad_alloc' has no triangles"; exit 2 ;;
  *) failed badFormat "$2: line 1: found no mesh, expected OFF"; exit 2 ;;
esac
cp "$2" "$4"
echo '{"parts": 2, "score": 0.5, "error": 1.0, "threads": 1}' >"$6"
)sh";

struct Studio {
  TemporaryFolder folder;
  BakerSettings settings;
  std::vector<BakeItem> items;

  Studio() {
    settings.item.program = folder.write("program", kProgram);
    settings.memory = std::uint64_t{100} << 30;
    fs::permissions(settings.item.program, fs::perms::owner_all);
    fs::create_directories(folder.path() / "runs");
  }
  void add(const std::string& name, const std::string& content, const BakeSettings& how = {}) {
    items.push_back({folder.write(name, content), how});
  }
  [[nodiscard]] fs::path out() const { return folder.path() / "out"; }
  [[nodiscard]] BakeStore store() const { return BakeStore(out()); }
  Result<BakeOutcome> bake() { return bakeAll(bakeJobs(items), store(), settings); }
  /// How many items are being made, or were when a process was killed.
  [[nodiscard]] std::ptrdiff_t unfinished() const {
    return std::ranges::count_if(folders(),
                                 [](const fs::path& one) { return one.filename().string().starts_with(kBakeWork); });
  }
  /// Of results, and of items that are unfinished.
  [[nodiscard]] std::vector<fs::path> folders() const {
    std::error_code ignored;
    const fs::directory_iterator all(out() / "items", ignored);
    return {begin(all), end(all)};
  }
  [[nodiscard]] std::ptrdiff_t runsOf(const std::string& name) const {
    const Result<std::string> runs = readFile(folder.path() / "runs" / name);
    return runs ? std::count(runs->begin(), runs->end(), '\n') : 0;
  }
  void addSlow(int count) {
    for (int i = 0; i < count; ++i) add("slow" + std::to_string(i) + ".off", "slow" + std::to_string(i));
  }
  /// A member of an item's description, as text; "none" without a result.
  std::string told(std::size_t item, const char* member) {
    const Result<nlohmann::ordered_json> description = store().describe(bakeJobs(items)[item].name);
    if (!description || !description->contains(member)) return "none";
    const nlohmann::ordered_json& value = (*description)[member];
    return value.is_string() ? value.get<std::string>() : value.dump();
  }
};

TEST(Baker, MakesEachItemOnce) {
  Studio studio;
  studio.add("a.off", "good a", {{"export", {"glb", "urdf"}}});
  studio.add("b.off", "good b");
  const BakeOutcome first = valueOf(studio.bake());
  EXPECT_EQ(first.made, 2);
  EXPECT_GT(first.peakMemory, 0u);
  EXPECT_EQ(studio.told(0, "score"), "0.5");
  const fs::path result = studio.store().folderOf(bakeJobs(studio.items)[0].name);
  std::vector<std::string> names;
  const std::vector<BakedFile> made = *bakedFiles(result);
  for (const BakedFile& file : made) names.push_back(file.name);
  EXPECT_EQ(names, (std::vector<std::string>{"a.glb", "a.lorica", "a.urdf"}));

  EXPECT_EQ(studio.unfinished(), 0);

  const BakeOutcome second = valueOf(studio.bake());
  EXPECT_EQ(second.there, 2);
  EXPECT_EQ(studio.runsOf("a.off"), 1);
  studio.folder.write("a.off", "good, changed");
  EXPECT_EQ(studio.bake()->made, 1);
  EXPECT_EQ(studio.runsOf("a.off"), 2);
  EXPECT_EQ(studio.runsOf("b.off"), 1);
}

TEST(Baker, BadItemsGetASentenceAndCostNoOthers) {
  Studio studio;
  studio.settings.item.timeout = 10.0;  // for the others, on a busy machine
  for (const char* kind : {"good", "bad", "crash", "mute", "hungry", "hang", "good too"}) {
    studio.add(std::string(kind) + ".off", kind);
  }
  studio.items.push_back({"missing.off", {}});
  const BakeOutcome outcome = valueOf(studio.bake());
  EXPECT_EQ(outcome.made, 2);
  EXPECT_EQ(outcome.failed, 6);
  const std::string folder = studio.folder.path().string() + "/";
  const std::string crashed = "crash.off: the process that made it was ended by signal 11 (Segmentation fault)";
  EXPECT_EQ(studio.told(1, "failure"), folder + "bad.off: line 1: found no mesh, expected OFF");
  EXPECT_EQ(studio.told(2, "failure"), folder + crashed);
  EXPECT_EQ(studio.told(3, "failure"), folder + "mute.off: exit status 1 without a word");
  EXPECT_TRUE(has(studio.told(4, "failure"), "hungry.off: needs more than the "));
  EXPECT_EQ(studio.told(5, "failure"), folder + "hang.off: took longer than the 10 s of --timeout");
  EXPECT_EQ(studio.told(7, "failure"), "missing.off: line 1: found no mesh, expected OFF");
  EXPECT_EQ(studio.told(1, "files"), "[]");

  EXPECT_EQ(studio.bake()->there, 8) << "failures are results";
  studio.settings.retryFailed = true;
  EXPECT_EQ(studio.bake()->failed, 6);
  EXPECT_EQ(studio.runsOf("bad.off"), 2);
  EXPECT_EQ(studio.runsOf("good.off"), 1);
}

/// A failure must not give up its folder before it is published: another thread begins in one of the same name.
TEST(Baker, FailuresSideBySideKeepTheirFolders) {
  Studio studio;
  studio.settings.jobs = 8;
  for (int i = 0; i < 200; ++i) studio.add("bad" + std::to_string(i) + ".off", "bad" + std::to_string(i));
  EXPECT_EQ(valueOf(studio.bake()).failed, 200);
  EXPECT_EQ(studio.unfinished(), 0);
}

TEST(Baker, AFullDiskAMissingServerOrAKilledProcessIsNoFaultOfTheItem) {
  for (const char* kind : {"full", "fuller", "away", "killed"}) {
    Studio studio;
    studio.add("a.off", kind);
    const Result<BakeOutcome> outcome = studio.bake();
    ASSERT_FALSE(outcome.ok()) << kind;
    studio.folder.write("a.off", kind);
    EXPECT_EQ(studio.told(0, "item"), "none") << kind;
    EXPECT_EQ(studio.unfinished(), 0);
    studio.folder.write("a.off", "good");
    EXPECT_EQ(studio.bake()->made, 1);
  }
}

TEST(Baker, TheTextOfAMessageDecidesNothing) {
  Studio studio;
  studio.add("a.off", "forged");
  ASSERT_TRUE(studio.bake().ok());
  EXPECT_EQ(studio.told(0, "failure"),
            studio.items[0].input + ": mesh 'lorica: x: cannot be written: bad_alloc' has no triangles");
}

TEST(Baker, ANamedPipeIsRefusedAtOnce) {
  Studio studio;
  studio.items.push_back({studio.folder.path() / "pipe.off", {}});
  ASSERT_EQ(::mkfifo(studio.items[0].input.c_str(), 0600), 0);
  ASSERT_EQ(studio.bake()->failed, 1);
  EXPECT_EQ(studio.told(0, "failure"), studio.items[0].input + ": cannot be read: found a named pipe, expected a file");
}

TEST(Baker, ItemsThatDoNotFitTheMemoryAreLeftOut) {
  Studio studio;
  studio.add("a.off", "good");
  studio.add("large.obj", "good" + std::string(20, ' '));
  std::string large = "good";
  for (int i = 0; i < 1000; ++i) large += "\nf 1 2 3";
  studio.folder.write("large.obj", large);
  studio.settings.memory = memoryBound(999);
  const BakeOutcome outcome = valueOf(studio.bake());
  EXPECT_EQ(outcome.made, 1);
  ASSERT_EQ(outcome.tooLarge.size(), 1u);
  EXPECT_TRUE(has(outcome.tooLarge.front(), "large.obj: 1000 triangles may take"));
  EXPECT_EQ(studio.runsOf("large.obj"), 0);
}

TEST(Baker, ItemsRunSideBySideAsFarAsMemoryGoes) {
  Studio studio;
  studio.addSlow(4);
  studio.settings.jobs = 4;
  const auto most = [&studio] {
    std::ptrdiff_t count = 0;
    studio.settings.progress = [&](int, int, double) { count = std::max(count, studio.unfinished()); };
    EXPECT_TRUE(studio.bake().ok());
    return count;
  };
  studio.settings.memory = 2 * memoryBound(0) + 1000;
  EXPECT_EQ(most(), 2);
  fs::remove_all(studio.out());
  studio.settings.memory = 4 * memoryBound(0) + 1000;
  EXPECT_EQ(most(), 4);
}

TEST(Baker, StoppingFinishesWhatHasBegun) {
  Studio studio;
  studio.addSlow(3);
  bool stop = false;
  studio.settings.progress = [&](int, int, double) { stop = studio.unfinished() > 0; };
  studio.settings.stopping = [&] { return stop; };
  const BakeOutcome outcome = valueOf(studio.bake());
  EXPECT_TRUE(outcome.stopped);
  EXPECT_EQ(outcome.made, 1);
  EXPECT_EQ(studio.unfinished(), 0);
}

TEST(Baker, ADamagedResultIsMadeAgain) {
  Studio studio;
  for (const char* name : {"content", "missing", "description", "nothing", "whole"}) {
    studio.add(std::string(name) + ".off", std::string("good ") + name);
  }
  ASSERT_EQ(valueOf(studio.bake()).made, 5);
  const auto folder = [&](std::size_t item) { return studio.store().folderOf(bakeJobs(studio.items)[item].name); };
  ASSERT_TRUE(writeFileAtomically(folder(0) / "content.lorica", "damaged").ok());
  fs::remove(folder(1) / "missing.lorica");
  ASSERT_TRUE(writeFileAtomically(folder(2) / "item.json", "{").ok());
  fs::remove(folder(3) / "item.json");
  const BakeOutcome again = valueOf(studio.bake());
  EXPECT_EQ(again.there, 1);
  EXPECT_EQ(again.made, 4);
  EXPECT_EQ(*readFile(folder(0) / "content.lorica"), "good content");
  EXPECT_EQ(*readFile(folder(1) / "missing.lorica"), "good missing");
  EXPECT_EQ(valueOf(studio.bake()).there, 5);
}

/// Bakes in another process. @return its number
pid_t bakeElsewhere(Studio& studio) {
  const pid_t child = fork();
  if (child == 0) {
    const Result<BakeOutcome> outcome = studio.bake();
    _exit(outcome ? 0 : 1);
  }
  return child;
}

TEST(Baker, SeveralProcessesOnOneListMakeOneResultOfEachItem) {
  Studio studio;
  for (int i = 0; i < 12; ++i) studio.add("i" + std::to_string(i) + ".off", i % 4 == 0 ? "slow" : "good");
  std::vector<pid_t> children;
  for (int p = 0; p < 3; ++p) children.push_back(bakeElsewhere(studio));
  for (const pid_t child : children) {
    int status = -1;
    waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
  }
  for (std::size_t i = 0; i < studio.items.size(); ++i) EXPECT_EQ(studio.told(i, "score"), "0.5");
  EXPECT_EQ(studio.folders().size(), studio.items.size());
  EXPECT_EQ(valueOf(studio.bake()).there, 12);
}

TEST(Baker, WhatAKilledProcessHadIsDoneByTheNext) {
  Studio studio;
  studio.add("good.off", "good");
  studio.add("hang.off", "hang");
  studio.settings.jobs = 2;
  const pid_t child = bakeElsewhere(studio);
  while (studio.runsOf("hang.off") == 0 || !studio.store().has(bakeJobs(studio.items)[0].name)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  // The file keeps its key, but the script no longer hangs.
  const fs::path program = studio.settings.item.program;
  std::string script = *readFile(program);
  script.replace(script.find("hang*) sleep 100"), 16, "hang*)");
  studio.folder.write("program", script);
  const BakeOutcome outcome = valueOf(studio.bake());
  EXPECT_EQ(outcome.there, 1);
  EXPECT_EQ(outcome.made, 1);
  EXPECT_EQ(studio.runsOf("good.off"), 1);
  EXPECT_EQ(studio.runsOf("hang.off"), 2);
  ASSERT_EQ(studio.unfinished(), 1) << "that of the killed process, which may still be at work on another machine";
  for (const fs::path& folder : studio.folders()) {
    fs::last_write_time(folder, fs::last_write_time(folder) - std::chrono::hours(25));
  }
  EXPECT_EQ(valueOf(studio.bake()).there, 2);
  EXPECT_EQ(studio.unfinished(), 0);
}

ProcessOrder shell(const TemporaryFolder& folder, const std::string& script) {
  return {"/bin/sh", {"-c", script}, {{"WORD", "said"}}, folder.path() / "log", 0};
}

ProcessEnd endOf(const ProcessOrder& order) {
  return valueOf(runProgram(order, [] { return true; }));
}

TEST(ChildProcess, SaysHowItEndedAndWhatItPrinted) {
  const TemporaryFolder folder;
  const ProcessEnd end = endOf(shell(folder, "echo $WORD; echo too >&2; exit 3"));
  EXPECT_EQ(end.exitStatus, 3);
  EXPECT_EQ(end.signal, 0);
  EXPECT_FALSE(end.stopped);
  EXPECT_GT(end.peakMemory, 100'000u);
  EXPECT_EQ(*readFile(folder.path() / "log"), "said\ntoo\n");
}

TEST(ChildProcess, ACrashIsASignal) {
  const TemporaryFolder folder;
  EXPECT_EQ(endOf(shell(folder, "kill -SEGV $$")).signal, SIGSEGV);
}

TEST(ChildProcess, MemoryIsLimited) {
  const TemporaryFolder folder;
  // A string that doubles until it is larger than the limit.
  ProcessOrder order = shell(folder, "x=aaaaaaaaaaaaaaaa; while [ ${#x} -lt 400000000 ]; do x=$x$x; done");
  order.memoryBytes = 50'000'000;
  const ProcessEnd end = endOf(order);
  EXPECT_TRUE(end.exitStatus != 0 || end.signal != 0);
  EXPECT_LT(end.peakMemory, 60'000'000u);
}

TEST(ChildProcess, AMissingProgramIsAnError) {
  const TemporaryFolder folder;
  EXPECT_EQ(errorOf(runProgram({"/no/such/program", {}, {}, folder.path() / "log", 0}, [] { return true; })).message,
            "/no/such/program: cannot be started: No such file or directory");
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a process was left behind";
}

/// The number of a process that the program in the folder printed; 0 if it did not yet.
pid_t printedIn(const TemporaryFolder& folder) {
  const Result<std::string> log = readFile(folder.path() / "log");
  return log && log->ends_with('\n') ? std::stoi(*log) : 0;
}

void waitUntilGone(pid_t process) {
  const auto gone = [&] {
    const Result<std::string> stat = readFile("/proc/" + std::to_string(process) + "/stat", NamedBy::kFile);
    return !stat || stat->find(") Z ") != std::string::npos;
  };
  while (!gone()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

TEST(ChildProcess, IsEndedWithItsOwnChildren) {
  const TemporaryFolder folder;
  const auto goOn = [&] { return printedIn(folder) == 0; };
  const ProcessEnd end = valueOf(runProgram(shell(folder, "sleep 100 & echo $!; wait"), goOn));
  EXPECT_TRUE(end.stopped);
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a process was left behind";
  waitUntilGone(printedIn(folder));
}

TEST(ChildProcess, EndsWhenThisProcessIsKilled) {
  const TemporaryFolder folder;
  const pid_t owner = fork();
  if (owner == 0) {
    _exit(runProgram(shell(folder, "echo $$; exec sleep 100"), [] { return true; }).ok() ? 0 : 1);
  }
  while (printedIn(folder) == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  ::kill(owner, SIGKILL);
  ::waitpid(owner, nullptr, 0);
  waitUntilGone(printedIn(folder));
}

}  // namespace
}  // namespace lorica::test
