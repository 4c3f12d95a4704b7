// The table of docs/SECURITY.md: what is left behind when something happens to a running command.

#include "acd/decomposition_file.h"
#include "capture/files/joint_csv.h"
#include "capture/sensor/oni_file.h"
#include "geometry/files.h"
#include "session/recording/session_file.h"
#include "tests/apps/faults/faulty_run.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
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
  if (extension == ".mp4") return bytes.find("moov") != std::string::npos;
  return false;
}

class FaultTable : public testing::Test {
 protected:
  /// Inputs that all cells share.
  static void SetUpTestSuite() {
    inputs = std::make_unique<TemporaryFolder>();
    inputs->write("box.off", kBox);
    inputs->write("box.obj", kBoxParts);
    const auto make = [](std::vector<std::string> arguments) {
      const FaultyEnd end = runWithFault({std::move(arguments), inputs->path(), inputs->path() / "cache"});
      ASSERT_EQ(end.exitCode, 0) << end.err;
    };
    make({"decompose", "mannequin", "--parts", "3", "--keyframes", "2", "-o", "b.lorica"});
    make({"record", "s.lsession", "walk", "--frames", "300", "--decomposition", "b.lorica"});
    make({"demo", "--headless", "--seconds", "0.01", "--out", "warm"});
  }
  static void TearDownTestSuite() { inputs.reset(); }

  /// Runs a cell. @return what it left behind, without what was there before
  static std::set<std::string> left(const Job& job, Fault fault, bool works, FaultyEnd& end) {
    const TemporaryFolder folder;
    for (const char* name : {"box.off", "box.obj", "b.lorica", "s.lsession"}) {
      fs::copy_file(inputs->path() / name, folder.path() / name);
    }
    end = runWithFault({works ? job.works : job.writes, folder.path(), inputs->path() / "cache", fault});
    std::set<std::string> names;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder.path())) {
      const std::string name = entry.path().lexically_relative(folder.path());
      const bool known = fs::exists(inputs->path() / name) && entry.path().parent_path() == folder.path();
      if (known || name == "tmp") continue;
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
};

std::unique_ptr<TemporaryFolder> FaultTable::inputs;

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
    FaultyEnd end;
    const std::set<std::string> names = left(job, Fault::kDiskFull, false, end);
    EXPECT_EQ(end.exitCode, 2) << end.err;
    EXPECT_NE(end.err.find("lorica: "), std::string::npos) << end.err;
    for (const std::string& name : names) EXPECT_NE(name.find(".part."), std::string::npos) << name;
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

}  // namespace
}  // namespace lorica::test
