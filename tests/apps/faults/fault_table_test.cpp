// The table of docs/SECURITY.md: what is left behind when something happens to a running command.

#include "acd/decomposition_file.h"
#include "capture/files/joint_csv.h"
#include "capture/sensor/oni_file.h"
#include "geometry/files.h"
#include "session/recording/session_file.h"
#include "tests/apps/faults/faulty_run.h"
#include "tests/support/shared_by_tests.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <optional>
#include <set>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

/// A command that writes files, and one that works until a signal comes.
struct Job {
  std::string name;
  std::vector<std::string> writes;
  std::vector<std::string> works;
  std::set<std::string> files;  ///< that it writes
  bool endsWell = false;        ///< a signal is the usual way to end it: exit status 0
};

/// An address of this process alone.
std::string listenAt() {
  return "127.0.0.1:" + std::to_string(20'000 + getpid() % 20'000);
}

const std::vector<Job>& jobs() {
  static const std::vector<Job> all = {
      {"demo", {"demo", "--headless", "--seconds", "0.05", "--out", "."}, {"demo", "--headless", "--out", "."}, {}},
      {"decompose",
       {"decompose", "box.off", "-o", "o.lorica", "--json", "o.json"},
       {"decompose", "mannequin", "--parts", "200", "-o", "o.lorica", "--json", "o.json"},
       {"o.lorica", "o.json"}},
      {"score",
       {"score", "box.off", "box.obj", "--json", "o.json"},
       {"score", "mannequin", "box.obj", "--json", "o.json"},
       {"o.json"}},
      {"play",
       {"play", "wave", "--frames", "3", "--decomposition", "b.lorica", "--record", "o.lsession", "--json", "o.json"},
       {"play", "walk", "--decomposition", "b.lorica", "--record", "o.lsession", "--json", "o.json"},
       {"o.lsession", "o.json"}},
      {"live",
       {"live", "--virtual", "--headless", "--frames", "2", "--decomposition", "b.lorica", "--record", "o.lsession",
        "--json", "o.json"},
       {"live", "--virtual", "--headless", "--decomposition", "b.lorica", "--record", "o.lsession", "--json", "o.json"},
       {"o.lsession", "o.json"},
       true},
      {"record",
       {"record", "o.oni", "--virtual", "--frames", "2", "--json", "o.json"},
       {"record", "o.oni", "--virtual", "--json", "o.json"},
       {"o.oni", "o.csv", "o.json"},
       true},
      {"replay",
       {"replay", "s.lsession", "--json", "o.json"},
       {"replay", "s.lsession", "--json", "o.json"},
       {"o.json"}},
      {"info", {"info", "box.off", "--json", "o.json"}, {"info", "box.off", "--json", "o.json"}, {"o.json"}},
      {"convert",
       {"convert", "wave", "o.csv", "--json", "o.json"},
       {"convert", "walk", "o.csv", "--json", "o.json"},
       {"o.csv", "o.json"}},
      {"contacts",
       {"contacts", "wave", "-o", "o.npz", "--decomposition", "b.lorica", "--json", "o.json"},
       {"contacts", "walk,wave,walk", "-o", "o.npz", "--decomposition", "b.lorica", "--json", "o.json"},
       {"o.npz", "o.json"}},
      {"export",
       {"export", "box.off", "o.glb", "--json", "o.json"},
       {"export", "mannequin", "o.glb", "--per-bone", "--json", "o.json"},
       {"o.glb", "o.json"}},
      {"stream",
       {"live", "--vmc", listenAt(), "--headless", "--frames", "2", "--decomposition", "b.lorica", "--record",
        "o.lsession", "--json", "o.json"},
       {"live", "--vmc", listenAt(), "--headless", "--decomposition", "b.lorica", "--record", "o.lsession", "--json",
        "o.json"},
       {"o.lsession", "o.json"},
       true},
      {"serve",
       {"serve", "wave", "--frames", "3", "--decomposition", "b.lorica", "--record", "o.lsession", "--json", "o.json"},
       {"serve", "walk", "--decomposition", "b.lorica", "--record", "o.lsession", "--json", "o.json"},
       {"o.lsession", "o.json"},
       true},
      {"snapshot",
       {"snapshot", "wave", "--frame", "1", "-o", "o.png", "--decomposition", "b.lorica", "--json", "o.json"},
       {"snapshot", "walk", "--video", "o.mp4", "--decomposition", "b.lorica", "--json", "o.json"},
       {"o.png", "o.mp4", "o.json"}},
  };
  return all;
}

constexpr const char* kBox =
    "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n"
    "4 0 3 2 1\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";
constexpr const char* kBoxParts =
    "o box\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// Whether a file under its final name is whole.
bool isWhole(const fs::path& file) {
  const std::string extension = file.extension().string();
  if (extension == ".lorica") return readDecomposition(file).ok();
  if (extension == ".lsession") {
    const Result<SessionFile> session = readSession(file);
    return session && session->finished;
  }
  if (extension == ".oni") {
    const Result<OniFile> recording = OniFile::open(file);
    return recording && !recording->info().cutOff;
  }
  if (extension == ".csv") return readJointCsv(file).ok();
  const std::string bytes = readFile(file).value();
  if (extension == ".json") return !nlohmann::json::parse(bytes, nullptr, false).is_discarded();
  if (extension == ".png") return bytes.size() > 20 && bytes.substr(bytes.size() - 8, 4) == "IEND";
  if (extension == ".glb") {
    std::uint32_t size = 0;
    if (bytes.size() > 12) std::memcpy(&size, bytes.data() + 8, sizeof size);
    return bytes.starts_with("glTF") && size == bytes.size();
  }
  if (extension == ".npz") return bytes.size() > 22 && bytes.substr(bytes.size() - 22, 4) == "PK\x05\x06";
  if (extension == ".mp4") return bytes.find("moov") != std::string::npos;
  return false;
}

class FaultTable : public testing::Test {
 protected:
  /// Inputs that all cells share, made by the first test: they run one after the other, each in a process of its own.
  static void SetUpTestSuite() {
    inputs = std::make_unique<TemporaryFolder>();
    const fs::path kept = sharedByTests("faults") / "inputs";
    if (fs::exists(kept)) return fs::copy(kept, inputs->path(), fs::copy_options::recursive);
    inputs->write("box.off", kBox);
    inputs->write("box.obj", kBoxParts);
    const auto make = [](std::vector<std::string> arguments) {
      const FaultyEnd end = runWithFault({std::move(arguments), inputs->path(), inputs->path() / "cache"});
      ASSERT_EQ(end.exitCode, 0) << end.err;
    };
    make({"decompose", "mannequin", "--parts", "3", "--keyframes", "2", "-o", "b.lorica"});
    make({"record", "s.lsession", "walk", "--frames", "300", "--decomposition", "b.lorica"});
    make({"demo", "--headless", "--seconds", "0.01", "--out", "warm"});
    const fs::path copied = kept.parent_path() / "copied";
    fs::remove_all(copied);
    fs::copy(inputs->path(), copied, fs::copy_options::recursive);
    fs::rename(copied, kept);
  }
  static void TearDownTestSuite() { inputs.reset(); }

  /// Runs a cell. @return what it left behind, without what was there before
  static std::set<std::string> left(const Job& job, Fault fault, bool works, FaultyEnd& end) {
    const TemporaryFolder folder;
    return leftIn(folder, job, fault, works, end);
  }
  static std::set<std::string> leftIn(const TemporaryFolder& folder, const Job& job, Fault fault, bool works,
                                      FaultyEnd& end) {
    for (const char* name : {"box.off", "box.obj", "b.lorica", "s.lsession"}) {
      fs::copy_file(inputs->path() / name, folder.path() / name, fs::copy_options::overwrite_existing);
    }
    if (fault == Fault::kDiskFull && onFullDisk) fillDisk(folder.path());
    std::vector<std::string> words = works ? job.works : job.writes;
    if (fault == Fault::kNone) words.emplace_back("--force");  // over what a run with a fault completed
    end = runWithFault({std::move(words), folder.path(), inputs->path() / "cache", fault});
    std::set<std::string> names;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder.path())) {
      const std::string name = entry.path().lexically_relative(folder.path());
      const bool known = fs::exists(inputs->path() / name) && entry.path().parent_path() == folder.path();
      if (known || name == "tmp" || name == kFiller) continue;
      names.insert(name);
      const bool isFinal = job.files.count(name) > 0 ||
                           (job.name == "demo" && !name.starts_with('.') && name.find(".tmp-") == std::string::npos);
      if (isFinal) {
        EXPECT_TRUE(isWhole(entry.path())) << name;
      }
    }
    return names;
  }

  static std::string text(const std::set<std::string>& names) {
    std::string all;
    for (const std::string& name : names) all += name + " ";
    return all;
  }

  static bool onlyFinal(const Job& job, const std::set<std::string>& names) {
    return std::all_of(names.begin(), names.end(), [&](const std::string& name) {
      return job.files.count(name) > 0 ||
             (job.name == "demo" && (name.ends_with(".png") || name.ends_with(".mp4")) && !name.starts_with('.'));
    });
  }

  static std::unique_ptr<TemporaryFolder> inputs;
  static bool onFullDisk;  ///< the folder is on a disk of its own: a full disk is no limit of file sizes
};

std::unique_ptr<TemporaryFolder> FaultTable::inputs;
bool FaultTable::onFullDisk = false;

TEST_F(FaultTable, SignalsLeaveOnlyWholeFilesAndEndWithinASecond) {
  for (const Fault fault : {Fault::kInterrupt, Fault::kTerminate}) {
    const int status = fault == Fault::kInterrupt ? 130 : 143;
    for (const Job& job : jobs()) {
      SCOPED_TRACE(job.name + ", " + nameOf(fault));
      FaultyEnd end;
      const std::set<std::string> names = left(job, fault, true, end);
      EXPECT_TRUE(onlyFinal(job, names)) << text(names);
      if (end.bySignal) {  // on a busy machine, before the command's first line
        EXPECT_EQ(text(names), "");
        continue;
      }
      // Quick commands may be done before the signal.
      EXPECT_TRUE(end.exitCode == status || end.exitCode == 0) << end.exitCode << end.err;
      if (end.exitCode == status) {
        EXPECT_EQ(end.err.find("lorica: cancelled"), end.err.rfind("lorica: cancelled")) << end.err;
        EXPECT_NE(end.err.find("lorica: cancelled\n"), std::string::npos) << end.err;
      }
      EXPECT_LT(end.secondsAfterSignal, 60.0) << "a second, unless the machine is busy";
    }
  }
}

TEST_F(FaultTable, KilledProgramsLeaveNoDamagedFileUnderAFinalName) {
  for (const Job& job : jobs()) {
    SCOPED_TRACE(job.name);
    FaultyEnd end;
    const std::set<std::string> names = left(job, Fault::kKill, true, end);
    for (const std::string& name : names) {
      const bool temporary = name.starts_with("tmp/") || name.find(".tmp-") != std::string::npos ||
                             name.find(".part.") != std::string::npos || name.find(".partial.") != std::string::npos;
      EXPECT_TRUE(temporary || onlyFinal(job, {name})) << name;
    }
  }
}

TEST_F(FaultTable, AFullDiskIsASentenceAndLeavesAtMostARecording) {
  for (const Job& job : jobs()) {
    SCOPED_TRACE(job.name);
    const TemporaryFolder folder;
    const auto expectSentence = [&] {
      FaultyEnd end;
      const std::set<std::string> names = leftIn(folder, job, Fault::kDiskFull, false, end);
      EXPECT_EQ(end.exitCode, 2) << end.err;
      EXPECT_NE(end.err.find(onFullDisk ? ": No space left on device\n" : "lorica: "), std::string::npos) << end.err;
      for (const std::string& name : names) EXPECT_NE(name.find(".part."), std::string::npos) << name;
    };
    const std::optional<bool> onItsOwn = onDiskOfItsOwn(folder.path(), 24, [&] {
      onFullDisk = true;
      expectSentence();
      if (job.name != "play" && job.name != "decompose" && job.name != "snapshot") return;
      FaultyEnd end;
      fs::remove(folder.path() / kFiller);
      (void)leftIn(folder, job, Fault::kNone, false, end);
      EXPECT_EQ(end.exitCode, 0) << "the next run heals it: " << end.err;
    });
    EXPECT_TRUE(onItsOwn.value_or(true));
    if (!onItsOwn) expectSentence();
  }
}

TEST_F(FaultTable, ClosedOutputIsASentenceAndTheFilesAreWhole) {
  for (const Job& job : jobs()) {
    SCOPED_TRACE(job.name);
    FaultyEnd end;
    const std::set<std::string> names = left(job, Fault::kOutputClosed, false, end);
    EXPECT_EQ(end.exitCode, 2) << end.err;
    EXPECT_NE(end.err.find("lorica: standard output: could not write the report"), std::string::npos) << end.err;
    EXPECT_TRUE(onlyFinal(job, names)) << text(names);
    // Nobody is seen in two images, and of the pictures only one kind is written.
    const bool notAll = job.name == "record" || job.name == "snapshot";
    EXPECT_GE(names.size(), job.files.size() - (notAll ? 1 : 0)) << text(names);
  }
}

TEST_F(FaultTable, AReadOnlyFolderIsASentenceAtOnce) {
  for (const Job& job : jobs()) {
    SCOPED_TRACE(job.name);
    FaultyEnd end;
    const std::set<std::string> names = left(job, Fault::kReadOnly, false, end);
    EXPECT_EQ(end.exitCode, 2) << end.err;
    EXPECT_NE(end.err.find("not writable"), std::string::npos) << end.err;
    EXPECT_EQ(text(names), "");
  }
}

TEST_F(FaultTable, AFileServerThatIsAwayIsASentenceAndTheNextRunHealsIt) {
  if (!hasShim()) GTEST_SKIP() << "built without the shim that makes faults";
  for (const Job& job : jobs()) {
    SCOPED_TRACE(job.name);
    const TemporaryFolder folder;
    FaultyEnd end;
    const std::set<std::string> names = leftIn(folder, job, Fault::kServerAway, false, end);
    EXPECT_EQ(end.exitCode, 2) << end.err;
    EXPECT_NE(end.err.find("lorica: "), std::string::npos) << end.err;
    for (const std::string& name : names) EXPECT_NE(name.find(".part."), std::string::npos) << name;
    const std::set<std::string> healed = leftIn(folder, job, Fault::kNone, false, end);
    EXPECT_EQ(end.exitCode, 0) << end.err;
    EXPECT_GE(healed.size(), job.files.size() - (job.files.size() > 2 ? 1 : 0)) << text(healed);
  }
}

TEST_F(FaultTable, AFileServerThatHangsIsLeftOnSigterm) {
  if (!hasShim()) GTEST_SKIP() << "built without the shim that makes faults";
  for (const Job& job : jobs()) {
    SCOPED_TRACE(job.name);
    FaultyEnd end;
    // It may write nothing of its own before it is asked to end, or be at its first byte.
    const std::set<std::string> names = left(job, Fault::kServerHangs, true, end);
    EXPECT_TRUE(end.exitCode == 143 || end.exitCode == 0) << end.exitCode << end.err;
    EXPECT_LT(end.secondsAfterSignal, 60.0) << "a second, unless the machine is busy";
    for (const std::string& name : names) EXPECT_NE(name.find(".part."), std::string::npos) << name;
  }
}

TEST_F(FaultTable, AWrongClockChangesNothing) {
  if (!hasShim()) GTEST_SKIP() << "built without the shim that makes faults";
  for (const Job& job : jobs()) {
    SCOPED_TRACE(job.name);
    FaultyEnd end;
    const std::set<std::string> names = left(job, Fault::kClockWrong, false, end);
    EXPECT_EQ(end.exitCode, 0) << end.err;
    EXPECT_TRUE(onlyFinal(job, names)) << text(names);
  }
}

TEST_F(FaultTable, TheNextRunHealsWhatAKilledOneLeft) {
  for (const Job& job : jobs()) {
    SCOPED_TRACE(job.name);
    const TemporaryFolder folder;
    FaultyEnd end;
    (void)leftIn(folder, job, Fault::kKill, true, end);
    (void)leftIn(folder, job, Fault::kNone, false, end);  // checks that what has a final name is whole
    EXPECT_EQ(end.exitCode, 0) << end.err;
  }
}

// ---- bake

/// Bakes a box and a character with a fault, and again without: the folder must be that of a bake without faults.
class FaultyBake : public testing::TestWithParam<Fault> {
 protected:
  static FaultyEnd run(const TemporaryFolder& folder, std::vector<std::string> more, Fault fault) {
    folder.write("box.off", kBox);
    std::vector<std::string> arguments = {"bake", "box.off", "mannequin", "--parts", "3", "--out", "o"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runWithFault({std::move(arguments), folder.path(), folder.path() / "cache", fault});
  }
  static std::string hashOf(const TemporaryFolder& folder) {
    const FaultyEnd end = run(folder, {"--collect", "--json", "-"}, Fault::kNone);
    EXPECT_EQ(end.exitCode, 0) << end.err;
    const auto json = nlohmann::json::parse(end.out, nullptr, false);
    return json.is_object() ? json.value("hash", "") + std::to_string(json.value("baked", 0)) : "";
  }
};

TEST_P(FaultyBake, IsHealedByTheNextRun) {
  const Fault fault = GetParam();
  const bool shimmed = fault == Fault::kServerAway || fault == Fault::kServerHangs || fault == Fault::kClockWrong;
  if (shimmed && !hasShim()) GTEST_SKIP() << "built without the shim that makes faults";
  static const std::string expected = [] {
    const TemporaryFolder clean;
    EXPECT_EQ(run(clean, {}, Fault::kNone).exitCode, 0);
    return hashOf(clean);
  }();
  const TemporaryFolder folder;
  const FaultyEnd end = run(folder, {}, fault);
  const bool mayBeDone = fault == Fault::kClockWrong || fault == Fault::kOutputClosed || fault == Fault::kInterrupt ||
                         fault == Fault::kTerminate;
  EXPECT_TRUE(mayBeDone || end.exitCode != 0) << end.err;
  EXPECT_TRUE(fault != Fault::kClockWrong || end.exitCode == 0) << end.err;
  // What has its final name is whole, whatever happened: the results of the second run are those of a clean one.
  const FaultyEnd again = run(folder, {}, Fault::kNone);
  EXPECT_EQ(again.exitCode, 0) << again.err;
  EXPECT_EQ(hashOf(folder), expected);
}

INSTANTIATE_TEST_SUITE_P(All, FaultyBake,
                         testing::Values(Fault::kInterrupt, Fault::kTerminate, Fault::kKill, Fault::kDiskFull,
                                         Fault::kOutputClosed, Fault::kReadOnly, Fault::kServerAway,
                                         Fault::kServerHangs, Fault::kClockWrong),
                         [](const testing::TestParamInfo<Fault>& one) {
                           std::string name = nameOf(one.param);
                           std::erase_if(name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; });
                           return name;
                         });

// ---- C and Python: programs that save parts

constexpr const char* kPythonProgram = R"(import os, sys, lorica
vertices, faces = lorica.read_mesh("box.obj")
parts = lorica.decompose(vertices, faces, 4)
while True:
    try:
        parts.save("o.lorica")
    except Exception as error:
        print(error, file=sys.stderr)
        sys.exit(2)
    if "once" in sys.argv: break
)";

constexpr const char* kCProgram = R"(import ctypes, sys
class Mesh(ctypes.Structure):
    _fields_ = [("size", ctypes.c_size_t), ("vertices", ctypes.c_void_p), ("vertex_count", ctypes.c_size_t),
                ("triangles", ctypes.c_void_p), ("triangle_count", ctypes.c_size_t), ("frame_count", ctypes.c_size_t)]
c = ctypes.CDLL(sys.argv[1])
c.lorica_last_error.restype = ctypes.c_char_p
xyz = (ctypes.c_double * 12)(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1)
abc = (ctypes.c_int32 * 12)(0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3)
mesh = Mesh(ctypes.sizeof(Mesh), ctypes.addressof(xyz), 4, ctypes.addressof(abc), 4, 0)
parts = ctypes.c_void_p()
assert c.lorica_decompose(ctypes.byref(mesh), None, ctypes.byref(parts)) == 0
while True:
    if c.lorica_parts_save(parts, b"o.lorica") != 0:
        print(c.lorica_last_error().decode(), file=sys.stderr)
        sys.exit(2)
    if "once" in sys.argv: break
)";

class FaultyProgram : public testing::TestWithParam<const char*> {
 protected:
  /// @param once  it saves its parts one time; else for ever
  static FaultyEnd run(const TemporaryFolder& folder, Fault fault, bool once) {
    const bool python = std::string(GetParam()) == "Python";
    folder.write("box.obj", kBoxParts);
    std::vector<std::string> arguments = {"-I", "-c", python ? kPythonProgram : kCProgram};
    if (python) arguments = {"-c", kPythonProgram};
    if (!python) arguments.push_back(built("lib/liblorica_c.so"));
    if (once) arguments.emplace_back("once");
    FaultyRun faulty{arguments, folder.path(), folder.path() / "cache", fault};
    faulty.program = "/usr/bin/python3";
    faulty.environment = {{"PYTHONPATH", built("python").string()}, {"PYTHONDONTWRITEBYTECODE", "1"}};
    if (!once) faulty.ready = [&] { return fs::exists(folder.path() / "o.lorica"); };
    return runWithFault(faulty);
  }
  static bool isThere() {
    return hasShim() && fs::exists(built("lib/liblorica_c.so")) && fs::exists(built("python/lorica"));
  }
};

TEST_P(FaultyProgram, SavesAWholeFileOrNone) {
  if (!isThere()) GTEST_SKIP() << "built without C and Python";
  for (const Fault fault : {Fault::kInterrupt, Fault::kTerminate, Fault::kKill, Fault::kDiskFull, Fault::kOutputClosed,
                            Fault::kReadOnly, Fault::kServerAway, Fault::kServerHangs, Fault::kClockWrong}) {
    SCOPED_TRACE(nameOf(fault));
    const TemporaryFolder folder;
    const bool signal = fault == Fault::kInterrupt || fault == Fault::kTerminate || fault == Fault::kKill;
    if (fault == Fault::kReadOnly) folder.write("box.obj", kBoxParts);
    const FaultyEnd end = run(folder, fault, !signal);
    if (!signal) {
      const bool unharmed = fault == Fault::kClockWrong || fault == Fault::kOutputClosed;
      EXPECT_EQ(end.exitCode, unharmed ? 0 : fault == Fault::kServerHangs ? 143 : 2) << end.err;
      EXPECT_EQ(fs::exists(folder.path() / "o.lorica"), unharmed);
    }
    for (const fs::directory_entry& entry : fs::directory_iterator(folder.path())) {
      const std::string name = entry.path().filename();
      if (name == "o.lorica") {
        EXPECT_TRUE(isWhole(entry.path()));
      } else if (entry.is_regular_file() && name != "box.obj") {
        EXPECT_TRUE((signal || fault == Fault::kServerHangs) && name.find(".tmp-") != std::string::npos) << name;
      }
    }
    const FaultyEnd again = run(folder, Fault::kNone, true);
    EXPECT_EQ(again.exitCode, 0) << again.err;
    EXPECT_TRUE(isWhole(folder.path() / "o.lorica"));
  }
}

INSTANTIATE_TEST_SUITE_P(Both, FaultyProgram, testing::Values("C", "Python"),
                         [](const testing::TestParamInfo<const char*>& one) { return std::string(one.param); });

}  // namespace
}  // namespace lorica::test
