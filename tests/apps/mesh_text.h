#pragma once

#include "geometry/mesh_files.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace lorica::test {

/// Writes a mesh as an OBJ file into the folder.
inline std::filesystem::path writeObj(const TemporaryFolder& folder, const std::string& name, const TriMesh& mesh) {
  const std::filesystem::path file = folder.path() / name;
  const Result<void> written = writeObjObjects(file, {{"mesh", mesh}});
  EXPECT_TRUE(written) << (written ? "" : written.error().message);
  return file;
}

}  // namespace lorica::test
