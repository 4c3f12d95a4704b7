#include "tests/peers/blender.h"

#include "geometry/files.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstdlib>

namespace lorica::test {

using nlohmann::json;

std::string missingForBlender() {
  if (std::system("blender --version >/dev/null 2>&1") == 0) return {};
  return "Blender is missing; scripts/peers installs it and runs these tests";
}

std::vector<std::vector<BlenderJoints>> openWithBlender(const std::vector<BlenderJob>& jobs) {
  const TemporaryFolder folder;
  json list = json::array();
  for (const BlenderJob& job : jobs) list.push_back({{"file", job.file.string()}, {"frames", job.frames}});
  const std::filesystem::path in = folder.write("jobs.json", list.dump());
  const std::filesystem::path out = folder.path() / "out.json";
  const std::filesystem::path log = folder.path() / "log";
  const std::string command = "blender -b --factory-startup --python-exit-code 1 --python '" +
                              built("peers/blender_joints.py").string() + "' -- '" + in.string() + "' '" +
                              out.string() + "' >'" + log.string() + "' 2>&1";
  std::vector<std::vector<BlenderJoints>> all;
  if (std::system(command.c_str()) != 0) {
    ADD_FAILURE() << command << " failed:\n" << readFile(log).value();
    return all;
  }
  for (const json& result : json::parse(readFile(out).value())) {
    std::vector<BlenderJoints>& frames = all.emplace_back();
    for (const json& joints : result) {
      BlenderJoints& frame = frames.emplace_back();
      for (const auto& [name, positions] : joints.items()) {
        for (const json& p : positions) {
          // Blender's Z is up and its figures face -Y.
          frame.emplace(name, Vec3(p.at(0).get<double>(), p.at(2).get<double>(), -p.at(1).get<double>()));
        }
      }
    }
  }
  return all;
}

}  // namespace lorica::test
