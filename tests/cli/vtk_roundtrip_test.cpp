// SPDX-License-Identifier: Apache-2.0
// tools/vtk_roundtrip on a handful of files: VTK reads what sightglass writes, number for number.
#include <sys/wait.h>

#include <cstdio>

#include "base/file/file.h"
#include "support/test.h"

using namespace sg;

namespace {

bool cannot_run() { return test::no_data() || !file_exists("/usr/lib/python3/dist-packages/vtkmodules"); }

struct Done {
  int status = -1;
  std::string out;
};

Done roundtrip(const std::string& arguments) {
  const std::string command = std::string("'") + test::source_folder() + "/tools/vtk_roundtrip' --program '" + test::build_folder() +
                              "/sightglass' --data '" + test::data_folder() + "' " + arguments + " 2>&1";
  Done done;
  std::FILE* pipe = ::popen(command.c_str(), "r");
  REQUIRE(pipe);
  char buffer[4096];
  while (const size_t n = std::fread(buffer, 1, sizeof buffer, pipe)) done.out.append(buffer, n);
  const int status = ::pclose(pipe);
  done.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  return done;
}

}  // namespace

TEST_CASE("vtk: VTK reads the conversion of each kind of mesh as it reads the original" * doctest::skip(cannot_run())) {
  // Uniform, rectilinear, curvilinear, polyhedra, surface, AMR, blocks, pieces; each with zlib, and some as text and base64.
  const Done all = roundtrip(
      "BuiltInExample1.vti cth.vtr StructuredGrid.vts polyhedron2pieces.vtu teapotWithStrips .vthb ex-blow_5.vtm T0000000500.pvtu "
      "QuadraticTetra.vtu chombo3d.vtm");
  CHECK_MESSAGE(all.status == 0, all.out);
  CHECK_MESSAGE(all.out.find("10 sets: 9 the same to the last number, 1 agree") != std::string::npos, all.out);
  for (const char* encoding :
       {"ascii --compression none", "base64 --compression lz4", "base64 --compression none", "appended --compression lzma"}) {
    const Done done = roundtrip(std::string("--encoding ") + encoding + " polyhedron2pieces.vtu StructuredGrid.vts");
    CHECK_MESSAGE(done.status == 0, done.out);
    CHECK_MESSAGE(done.out.find("2 the same to the last number") != std::string::npos, done.out);
  }
}

TEST_CASE("vtk: VTK's parallel readers read our pieces of each kind of mesh as the whole" * doctest::skip(cannot_run())) {
  const Done done = roundtrip("--pieces BuiltInExample1.vti cth.vtr StructuredGrid.vts cells/Tetra.vtu teapotWithStrips square-disc-nurbs");
  CHECK_MESSAGE(done.status == 0, done.out);
  CHECK_MESSAGE(done.out.find("6 sets: 0 the same to the last number, 6 agree") != std::string::npos, done.out);
}

TEST_CASE("vtk: what our other writers write is read back as it was" * doctest::skip(cannot_run())) {
  const Done done = roundtrip("--writers square-disc-nurbs brainImageSmooth SyntheticPolyline 00_image texThres");
  CHECK_MESSAGE(done.status == 0, done.out);
  CHECK_MESSAGE(done.out.find("5 agree") != std::string::npos, done.out);
}
