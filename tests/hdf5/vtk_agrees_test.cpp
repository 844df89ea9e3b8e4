// SPDX-License-Identifier: Apache-2.0
// What VTK's own reader makes of our files; needs python3-vtk9.
#include <fmt/core.h>

#include <cstdio>
#include <cstdlib>

#include "base/text/text.h"
#include "samples.h"

using namespace sg;

namespace {

bool no_vtk() {
  static const bool none = std::system("/usr/bin/python3 -c 'import vtkmodules.vtkIOHDF' >/dev/null 2>&1") != 0;
  return none;
}

// Points, cells, bounds, and for each array its name, components, range and sum.
constexpr const char* script = R"(
import sys
from vtkmodules.vtkIOHDF import vtkHDFReader
import vtkmodules.vtkCommonDataModel
r = vtkHDFReader()
r.SetFileName(sys.argv[1])
r.Update()
d = r.GetOutputDataObject(0)
print(d.GetNumberOfPoints(), d.GetNumberOfCells(), *d.GetBounds())
for data in (d.GetPointData(), d.GetCellData()):
    for i in range(data.GetNumberOfArrays()):
        a = data.GetArray(i)
        n = a.GetNumberOfComponents()
        print(a.GetName(), n, repr(sum(a.GetComponent(t, c) * (t % 7 + 1) for t in range(a.GetNumberOfTuples()) for c in range(n))))
for c in range(0, d.GetNumberOfCells(), 5):
    cell = d.GetCell(c)
    print(d.GetCellType(c), *[cell.GetPointId(k) for k in range(cell.GetNumberOfPoints())])
)";

std::vector<std::string> lines_of(const std::string& path) {
  const std::string program = test::temp_file("read.py", script);
  std::FILE* p = ::popen(fmt::format("/usr/bin/python3 '{}' '{}' 2>/dev/null", program, path).c_str(), "r");
  REQUIRE(p);
  std::string text;
  char part[4096];
  while (const size_t n = std::fread(part, 1, sizeof part, p)) text.append(part, n);
  ::pclose(p);
  std::vector<std::string> lines;
  for (const std::string_view l : split(text, '\n'))
    if (!l.empty()) lines.emplace_back(l);
  return lines;
}

double weighted_sum(const Array& a) {
  double sum = 0;
  for (size_t t = 0; t < a.count(); ++t)
    for (int c = 0; c < a.components(); ++c) sum += a.get(t, c) * double(t % 7 + 1);
  return sum;
}

void check_head(const Dataset& d, const std::vector<std::string>& lines) {
  REQUIRE(!lines.empty());
  CAPTURE(lines[0]);
  const auto head = words(lines[0]);
  REQUIRE(head.size() == 8);
  CHECK(parse_double(head[0]) == double(d.point_count()));
  CHECK(parse_double(head[1]) == double(d.cell_count()));
  for (int a = 0; a < 3; ++a) {
    CHECK(parse_double(head[size_t(2 + 2 * a)]).value_or(NAN) == doctest::Approx(d.bounds().lo[a]));
    CHECK(parse_double(head[size_t(3 + 2 * a)]).value_or(NAN) == doctest::Approx(d.bounds().hi[a]));
  }
  for (const Field& f : d.fields()) {
    bool found = false;
    for (const std::string& l : lines)
      if (const auto w = words(l); w.size() == 3 && w[0] == f.name) {
        found = true;
        CHECK(parse_int(w[1]) == f.components());
        CHECK(parse_double(w[2]).value_or(NAN) == doctest::Approx(weighted_sum(f.array)).epsilon(1e-12));
      }
    CHECK(found);
  }
}

Array ramp(size_t n, int components) {
  std::vector<float> v(n * size_t(components));
  for (size_t i = 0; i < v.size(); ++i) v[i] = float(i % 101);
  return Array::from_vector(std::move(v), components);
}

}  // namespace

TEST_CASE("vtkhdf: VTK reads the images and the cells that we write" * doctest::skip(no_vtk())) {
  Context context;
  for (const char* compression : {"none", "zlib"}) {
    WriteOptions o;
    o.compression = value_of_word<Compression>(compression);
    UniformGrid g;
    g.dims = {21, 11, 13};
    g.origin = {1, 2, 3}, g.spacing = {0.5, 0.25, 2};
    FieldSet f;
    f.add({"p", Association::point, ramp(21 * 11 * 13, 1), "K", Role::scalars});
    f.add({"v", Association::point, ramp(21 * 11 * 13, 3), {}, Role::vectors});
    // No cell fields: VTK 9.1 asks for as many cells as there are points, and fails on every file that has some.
    const DatasetPtr image = make_dataset(Mesh(g), f);
    const std::string path = test::temp_folder() + "for_vtk.vtkhdf";
    write_data(path, image, o, context);
    check_head(*image, lines_of(path));

    UnstructuredMesh m;  // tetrahedra and lines in turn
    const size_t n = 1000;
    m.points.xyz = ramp(n, 3);
    std::vector<int64_t> ids, offsets{0};
    std::vector<uint8_t> types;
    for (size_t i = 0; i < n / 2; ++i) {
      const int k = i % 2 ? 2 : 4;
      for (int j = 0; j < k; ++j) ids.push_back(int64_t((i * 7 + size_t(j) * 13) % n));
      offsets.push_back(int64_t(ids.size()));
      types.push_back(uint8_t(i % 2 ? CellType::line : CellType::tetra));
    }
    m.cells = {Array::from_vector(ids), Array::from_vector(offsets), 0};
    m.types = Array::from_vector(types);
    FieldSet h;
    h.add({"p", Association::point, ramp(n, 2), {}, Role::none});
    h.add({"c", Association::cell, ramp(n / 2, 9), {}, Role::tensors});
    const DatasetPtr cells = make_dataset(Mesh(m), h);
    write_data(path, cells, o, context);
    const auto lines = lines_of(path);
    check_head(*cells, lines);
    REQUIRE(lines.size() == 3 + n / 10);
    for (size_t i = 0; i < n / 10; ++i) {
      const size_t c = 5 * i;
      std::string want = std::to_string(int(types[c]));
      for (int64_t k = offsets[c]; k < offsets[c + 1]; ++k) want += " " + std::to_string(ids[size_t(k)]);
      CHECK(lines[3 + i] == want);
    }
  }
}
