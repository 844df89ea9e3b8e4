// SPDX-License-Identifier: Apache-2.0
// Files of very many arrays.
#include <fmt/core.h>

#include <algorithm>
#include <ctime>

#include "base/file/file.h"
#include "io/io.h"
#include "support/test.h"

using namespace sg;

namespace {

std::string point_with_arrays(int count) {
  std::string s =
      "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"><UnstructuredGrid><Piece NumberOfPoints=\"1\" "
      "NumberOfCells=\"1\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0</DataArray></Points><Cells>"
      "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0</DataArray>"
      "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">1</DataArray>"
      "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">1</DataArray></Cells><PointData>";
  for (int i = 0; i < count; ++i) s += fmt::format("<DataArray type=\"Float32\" Name=\"f{}\" format=\"ascii\">{}</DataArray>", i, i);
  return s + "</PointData></Piece></UnstructuredGrid></VTKFile>";
}

}  // namespace

TEST_CASE("vtk xml: all of many arrays are read, in time that grows with their number and not with its square") {
  const std::string folder = test::fresh_folder("many_arrays");
  double seconds[2];
  const int counts[2] = {2000, 16000};
  for (int k = 0; k < 2; ++k) {
    const std::string path = folder + fmt::format("{}.vtu", counts[k]);
    write_file(path, point_with_arrays(counts[k]));
    Context context;
    const std::clock_t begin = std::clock();
    const DatasetPtr d = single_dataset(read_data(path, {}, context), "test");
    seconds[k] = double(std::clock() - begin) / CLOCKS_PER_SEC;
    REQUIRE(d->fields().size() == size_t(counts[k]));
    CHECK(d->fields().require(fmt::format("f{}", counts[k] - 1)).array.get(0) == counts[k] - 1);
  }
  // Eight times as many: 8 times as long, or 64 times where each is searched for among all.
  CHECK(seconds[1] < 24 * std::max(seconds[0], 0.005));
}
