// What the command refuses, and in which words: a row each. The files are those of the folder below, which stay as they
// are.

#include "geometry/files.h"
#include "tests/apps/mannequin_glb.h"
#include "tests/apps/mesh_text.h"
#include "tests/apps/refusals.h"
#include "tests/skinning/import/small_character.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace lorica::test {
namespace {

struct Sentence {
  std::string command;                  ///< words between spaces; '' is an empty one
  std::vector<std::string_view> words;  ///< of the sentence
};

struct Subject {
  const char* name;
  std::vector<Sentence> sentences;
};

void PrintTo(const Subject& subject, std::ostream* out) {
  *out << subject.name;
}

std::string timesSixtyFive(const std::string& motion) {
  std::string all = motion;
  for (int i = 0; i < 64; ++i) all += "," + motion;
  return all;
}

class Sentences : public testing::TestWithParam<Subject> {};

TEST_P(Sentences, AreSaidAndNothingIsWritten) {
  const TemporaryFolder folder;
  (void)writeObj(folder, "l.obj", makeLShape());
  (void)folder.write("r_meshes", "a file");
  (void)folder.write("mine.csv", "not joints");
  (void)folder.write("hero.glb", mannequinGlb(false));
  GlbWriter box = smallCharacter();
  (void)folder.write("joints.glb", box.glb());  // of nobody
  box.document.erase("skins");
  box.document.erase("animations");
  box.document["nodes"][2].erase("skin");
  (void)folder.write("box.glb", box.glb());
  const std::string hero = *readFile(folder.path() / "hero.glb"), mesh = *readFile(folder.path() / "l.obj");
  for (const Sentence& sentence : GetParam().sentences) {
    SCOPED_TRACE(sentence.command);
    std::istringstream words(sentence.command);
    std::vector<std::string> arguments(std::istream_iterator<std::string>(words), {});
    std::ranges::replace(arguments, std::string("''"), std::string());
    const std::vector<std::string> before = filesIn(folder.path());
    const CommandResult result = runLorica(arguments, {.folder = folder.path()});
    expectRefused(result, sentence.words);
    EXPECT_TRUE(has(result.err, "lorica: "));
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(filesIn(folder.path()), before);
  }
  EXPECT_EQ(*readFile(folder.path() / "hero.glb"), hero);
  EXPECT_EQ(*readFile(folder.path() / "l.obj"), mesh);
}

const Subject kSubjects[] = {
    {"Commands",
     {{"", {"expected one of demo, play, live, serve, replay, snapshot, decompose, export"}},
      {"decompoes bunny.off", {"decompoes: unknown command; did you mean \"decompose\"?"}},
      {"quarterstaff", {"quarterstaff: unknown command, expected one of demo, play, live, "}},
      {"help plya", {"plya: unknown command; did you mean \"play\"?"}},
      {"--versoin", {"--versoin: unknown option; did you mean \"--version\"?"}},
      {"--character hero.glb play walk",
       {"--character: stands before the command, expected `lorica play --character`"}},
      {"wlak", {"wlak: unknown command; did you mean \"walk\"?"}},
      {"manequin", {"; did you mean \"mannequin\"?"}},
      {"info nothing.txt", {"nothing.txt"}},
      {"info wlak", {"wlak", "did you mean \"walk\"?"}}}},
    {"Decompose",
     {{"decompose", {"INPUT"}},
      {"decompose l.obj --parts 0", {"--parts", "`0`", "from 1"}},
      {"decompose l.obj --parts -3", {"--parts", "`-3`", "from 1"}},
      {"decompose l.obj --parts many", {"--parts", "`many`"}},
      {"decompose l.obj --parts 3.5", {"--parts", "`3.5`"}},
      {"decompose l.obj --parts 99999999999", {"--parts", "`99999999999`"}},
      {"decompose l.obj --candidates 0", {"--candidates", "`0`"}},
      {"decompose l.obj --orientations 0", {"--orientations", "`0`"}},
      {"decompose l.obj --max-error 0", {"--max-error", "`0`", "above 0", "5%"}},
      {"decompose l.obj --max-error 5", {"--max-error", "`5`", "below 1", "did you mean \"5%\"?"}},
      {"decompose l.obj --max-concavity 1", {"--max-concavity", "`1`", "below 1"}},
      {"decompose l.obj --max-error %", {"--max-error", "`%`"}},
      {"decompose l.obj --max-error 5%%", {"--max-error", "`5%%`"}},
      {"decompose l.obj --max-error inf", {"--max-error", "`inf`"}},
      {"decompose l.obj --max-distance -1", {"--max-distance", "`-1`", "above 0"}},
      {"decompose l.obj --max-distance 1m", {"--max-distance", "`1m`"}},
      {"decompose l.obj --preset best", {"best", "paper, fast, quality"}},
      {"decompose l.obj --threads 0", {"--threads", "`0`"}},
      {"decompose l.obj --keyframes 3", {"--keyframes", "l.obj", "characters"}},
      {"decompose l.obj --keyframes auto", {"--keyframes is for characters"}},
      {"decompose l.obj --motion walk", {"--motion", "l.obj", "characters"}},
      {"decompose l.obj --hull-vertices 3", {"--hull-vertices", "3"}},
      {"decompose l.obj --hull-vertices 0", {"--hull-vertices", "0"}},
      {"decompose l.obj --hull-vertices -1", {"--hull-vertices", "-1"}},
      {"decompose l.obj --hull-vertices many", {"--hull-vertices", "many"}},
      {"decompose l.obj --hull-vertices 32.5", {"--hull-vertices", "32.5"}},
      {"decompose l.obj --hull-planes 3", {"--hull-planes", "3"}},
      {"decompose mannequin --hull-planes 18", {"--hull-planes 18", "mannequin moves", "--export-obj"}},
      {"decompose mannequin --keyframes 100000", {"--keyframes", "100000"}},
      {"decompose mannequin --keyframes all", {"expected a whole number from 1 to 1000000, or auto"}},
      {"decompose mannequin --keyframes Auto", {"expected a whole number from 1 to 1000000, or auto"}},
      {"decompose mannequin --keyframes -1", {"expected a whole number from 1 to 1000000, or auto"}},
      {"decompose mannequin --keyframes 0", {"expected a whole number from 1 to 1000000, or auto"}},
      {"decompose mannequin --keyframes 12.5", {"expected a whole number from 1 to 1000000, or auto"}},
      {"decompose mannequin --keyframes ''", {"expected a whole number from 1 to 1000000, or auto"}},
      {"decompose mannequin --walls shell", {"mannequin: is one closed piece, which stays solid"}},
      {"decompose mannequin --body always", {}},
      {"decompose hero.glb --thickness 0.01", {"expected --walls auto or shell beside it"}},
      {"decompose l.obj -o /nowhere/l.lorica", {"--output", "/nowhere"}},
      {"decompose l.obj -o l.obj", {"--output", ".lorica"}},
      {"decompose l.obj --export-obj l.obj", {"--export-obj", "overwritten"}},
      {"decompose l.obj --json /nowhere/l.json", {"--json", "/nowhere"}},
      {"decompose l.obj --json ./l.obj", {"--json", "overwritten"}},
      {"decompose l.obj -o a.lorica --json a.lorica", {"--json", "overwritten"}},
      {"decompose l.obj -o a.lorica --json /dev/null", {"--json", "/dev/null"}},
      {"decompose l.obj --prats 3", {"--prats"}},
      {"info l.obj --json l.obj", {"--json", "overwritten"}},
      {"info whole.off --write-map map.json", {"--write-map"}},
      {"score l.obj", {"PARTS.obj"}},
      {"score l.obj parts.obj --json l.obj", {"--json", "overwritten"}}}},
    {"Play",
     {{"play walk --character godzilla", {"godzilla", "mannequin"}},
      {"play walk --every 5", {"--every", "--snapshots"}},
      {"play walk --frames 0", {"--frames", "`0`"}},
      {"play walk --scene bowlin", {"bowlin", "did you mean \"bowling\"?"}},
      {"play wave --camera front", {"--snapshots or --video"}},
      {"play walk --window", {"DISPLAY", "--snapshots"}},
      {"play walk --windw",
       {"lorica: --windw: unknown option; did you mean \"--window\"?\nTry `lorica play --help`.\n"}},
      {"play walk --quarterstaff=3", {"lorica: --quarterstaff: unknown option\nTry `lorica play --help`.\n"}},
      {"play walk --springs both", {"found `both`, expected none, file, body"}},
      {"play walk --map map.json", {"mannequin: --map is for character files"}},
      {"play walk --body-resolution 0.02", {"mannequin: --body-resolution is for character files"}},
      {"play walk --smooth much", {"--smooth", "one-euro"}},
      {"play walk --min-cutoff -1", {"--min-cutoff", "above 0"}},
      {"play hero.glb --character mannequin --smooth one-euro", {"--smooth", "recorded joints"}},
      {"play hero.glb --clip Jump", {"Jump", "Bow, Nod"}},
      {"play walk --record s.txt", {".lsession"}},
      {"play walk --inject late=2", {"expected a fraction of frames from 0 to 1"}},
      {"play walk --events - --json -",
       {"--events and --json cannot both use standard output: give a file for one of them"}},
      {"play walk --events none/e.jsonl", {"--events: "}},
      {"play walk --events .", {"is a folder, expected a file"}},
      {"play walk --events same --json same", {"--events: same is also an input"}},
      {"play walk --vmc-out 39539", {"--vmc-out: the address 39539: expected HOST:PORT"}},
      {"play walk --vmc-out 127.0.0.1:39539 --vmc-bones Hips,Tail", {"--vmc-bones: found 'Tail'"}},
      {"play walk --vmc-bones Hips", {"--vmc-bones requires --vmc-out"}},
      {"play walk --lan", {"--lan requires --serve"}},
      {"play walk --person everyone", {"found `everyone`, expected a whole number from 1, or all"}},
      {"demo --seconds -1", {"--seconds", "`-1`"}},
      {"demo --seconds nan", {"--seconds", "`nan`"}},
      {"demo --window --headless", {"--window", "--headless"}},
      {"demo --window --out demo", {"DISPLAY", "--headless"}},
      {"demo --recordings here", {"--recordings requires --serve"}},
      {"replay", {"SESSION"}},
      {"serve walk --key none.pem", {"--key requires --certificate"}},
      {"serve walk --virtual", {"walk: expected a motion or who is followed, not both"}},
      {"serve walk --certificate c.pem --key k.pem", {"--certificate requires --lan"}},
      {"serve walk --certificate c.pem --lan", {"--certificate requires --key"}},
      {"live me.oni", {"me.oni: unexpected argument; `lorica play me.oni`"}},
      {"live --virtual --port 8500", {"--port requires --serve"}},
      {"live --virtual --headless --events - --json -", {"--events and --json cannot both"}},
      {"live --vmc 99999 --headless", {"--vmc: the address 99999: expected PORT or HOST:PORT"}}}},
    {"Casts",
     {{"play walk --character mannequin,mannequin",
       {"found 2 characters and 1 motion, expected one character for all of them or one for each"}},
      {"play walk,,wave", {"found an empty name in `walk,,wave`"}},
      {"play walk,nothing", {"nothing"}},
      {"play " + timesSixtyFive("walk"), {"found 65 motions, expected at most 64"}},
      {"record x.bvh walk,wave", {"x.bvh: found 2 avatars, expected one: a motion file holds one skeleton"}},
      {"record x.csv --virtual --people 2", {"x.csv: found 2 avatars"}},
      {"record x.oni --virtual --people 2", {"x.oni: --people is for sessions (.lsession)"}},
      {"record x.lsession walk --people 2", {"found a motion and --people, expected only one of them"}},
      {"record x.lsession --virtual --people 7", {"found 7, expected at most 6"}},
      {"record x.lsession --virtual --person all", {"--person all: found a camera"}},
      {"live --virtual --people 7", {"--people, --vmc: found 7, expected at most 6"}},
      {"live --virtual --people 3 --character mannequin,mannequin",
       {"--character: found 2 characters for 3 people, expected one for all or one for each"}}}},
    {"Files",
     {{"record s.txt", {"ends in .oni (depth), .lsession (a session), .bvh or .csv"}},
      {"record s.oni walk", {"MOTION is for sessions"}},
      {"record s.lsession walk --virtual", {"and a camera, expected only one"}},
      {"contacts", {"the motion is missing", "lorica contacts walk.bvh -o walk.npz"}},
      {"contacts walk", {"-o FILE is missing"}},
      {"convert mine.csv mine.csv", {"overwritten"}},
      {"convert mine.csv out.bvh", {"mine.csv", "Lorica opens"}},
      {"convert walk walk.txt", {".txt", ".csv", ".bvh"}},
      {"convert hero.glb out.csv --person 2", {"--person", "recorded joints"}},
      {"convert walk out.csv --camera-frame", {"walk", "--camera-frame", ".oni"}},
      {"convert wave_depth out.bvh --person all", {"out.bvh", "everyone", "OUT.csv"}},
      {"convert walk hero.glb --character hero.glb", {"hero.glb", "overwritten"}},
      {"convert walk walk.glb", {"walk.glb", "--character"}},
      {"convert walk walk.csv --character hero.glb", {".csv", ".glb", ".bvh"}},
      {"convert walk walk.fbx --character hero.glb", {".fbx", ".glb", ".bvh"}},
      {"convert walk walk.glb --character hero.obj", {"hero.obj", ".vrm", "mannequin"}},
      {"convert walk walk.glb --character gone.glb", {"gone.glb"}},
      {"convert walk walk.bvh --map hero.json", {"--map", "--character"}},
      {"convert walk no/walk.glb --character hero.glb", {"no"}},
      {"convert wave_depth x.csv --camera-frame --character hero.glb", {"x.csv", ".glb or .bvh"}},
      {"convert walk walk.glb --character box.glb", {"box", "hips"}},
      {"convert walk walk.glb --character joints.glb", {"joints", "hips"}}}},
    {"Exports",
     {{"export l.obj l.obj", {"l.obj", "overwritten"}},
      {"export l.obj l.usd", {"`.usd`", ".obj", ".glb"}},
      {"export l.obj l", {"extension ``", ".xml"}},
      {"export l.obj h.vrm", {"h.vrm", "springs", "l.obj", ".glb"}},
      {"export l.obj h.stl --per-bone", {"--per-bone", "static mesh"}},
      {"export l.obj h.stl --motion walk --at 1", {"--at", "static mesh"}},
      {"export l.obj h.xml --motion walk --at 1", {"h.xml", "--at", ".ply"}},
      {"export mannequin h.stl --at 1", {"--at", "--motion"}},
      {"export mannequin h.stl --motion walk", {"--motion", "--at"}},
      {"export l.obj h.stl --mocap", {"--mocap", ".xml"}},
      {"export l.obj h.xml --khr", {"--khr", ".glb"}},
      {"export l.obj h.xml --show-colliders", {"--show-colliders", ".glb"}},
      {"export l.obj h.xml --hull-vertices 3", {"--hull-vertices 3", "0 for no limit"}},
      {"export l.obj h.xml --hull-planes 0", {"--hull-planes", "`0`"}},
      {"export l.obj h.xml --engine quake", {"quake", "unity", "godot"}},
      {"export l.obj h.stl --up z", {"--up z", ".urdf", "h.stl"}},
      {"export l.obj h.xml --up x", {"--up", "y, z"}},
      {"export l.obj no/h.xml", {"no"}},
      {"export mannequin h.glb --parts 4", {"--parts", "mannequin", "--decomposition"}},
      {"export l.obj r.urdf", {"r_meshes is a file, expected a folder"}},
      {"export gone.lorica h.glb", {"gone.lorica"}}}},
    {"Pictures",
     {{"snapshot walk --at 1s -o a.png", {"--at", "found `1s`, expected a number"}},
      {"snapshot walk --at 1,5s -o a.png", {"--at", "found `5s`, expected a number"}},
      {"snapshot walk --frame x -o a.png", {"--frame", "found `x`, expected a whole number"}},
      {"snapshot wave --at 1000 -o a.png", {"lasts from 0"}},
      {"snapshot wave --at -1 -o a.png", {"--at"}},
      {"snapshot wave --frame 100000 -o a.png", {"from 0 to"}},
      {"snapshot wave --camera below -o a.png", {"three-quarter"}},
      {"snapshot wave --eye 1,2 -o a.png", {"1.5,1,-3"}},
      {"snapshot wave --eye 1,2,nan --target 0,0,0 -o a.png", {"1.5,1,-3"}},
      {"snapshot wave --eye 1,2,3 -o a.png", {"--target"}},
      {"snapshot wave --eye 1,2,3 --target 1,2,3 -o a.png", {"apart"}},
      {"snapshot wave --show skin,wings -o a.png", {"wings"}},
      {"snapshot wave --video a.avi -o a.png", {"films are MP4 files"}},
      {"snapshot wave --video a.gif -o a.png", {"films are MP4 files"}},
      {"snapshot wave --from 1 -o a.png", {"--video"}},
      {"snapshot wave --size 99999x10", {}}}},
};

INSTANTIATE_TEST_SUITE_P(Of, Sentences, testing::ValuesIn(kSubjects),
                         [](const testing::TestParamInfo<Subject>& subject) {
                           return std::string(subject.param.name);
                         });

}  // namespace
}  // namespace lorica::test
