#include "export/robots/robot.h"
#include "export/robots/xml_text.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

/// Any text as a robot, MJCF or URDF. Its meshes are not read: each becomes a tetrahedron. What is accepted must be
/// written as XML again, and changed at the geoms alone.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lorica;
  namespace fs = std::filesystem;
  static const fs::path folder = [] {
    std::string name = (fs::temp_directory_path() / "robot-fuzz-XXXXXX").string();
    LORICA_CHECK(mkdtemp(name.data()) != nullptr, "no folder");
    return fs::path(name);
  }();
  const fs::path file = folder / "robot.xml";
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  const RobotReading reading{PathTrust::kBeneath, {{"p", folder}}};
  for (const bool urdf : {false, true}) {
    Result<std::unique_ptr<RobotFile>> read = urdf ? readUrdf(file, reading) : readMjcf(file, reading);
    if (!read) {
      LORICA_CHECK(read.error().message.size() < 2000, "an error that repeats the file");
      continue;
    }
    RobotFile& robot = **read;
    const TriMesh corner{{Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()},
                         {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
    RobotShapes shapes{{robot.meshes.size(), {corner, corner}}, {}};
    if (size % 2 == 1) shapes.capsules.assign(robot.geoms.size(), {{Vec3::Zero(), Vec3::UnitX(), 0.1}});
    const Result<std::vector<RobotOutput>> written = robot.replaced(folder / "out.xml", shapes);
    if (!written) continue;
    for (const RobotOutput& output : *written) {
      if (output.file.extension() != ".xml") continue;
      LORICA_CHECK(output.file.parent_path() == folder, "an output elsewhere");
      const fs::path again = folder / "again.xml";
      std::ofstream(again, std::ios::binary) << output.content;
      LORICA_CHECK(XmlText::read(again, "again", NamedBy::kFile).ok(), "no XML any more");
    }
  }
  return 0;
}
