// SPDX-License-Identifier: Apache-2.0
// .bpt: Bezier patches as text. The number of patches; for each its degrees "u v" and (u+1)(v+1) control points, v fastest.
// Patches become Bezier quads that share nothing; degrees may differ.
#include <fmt/core.h>

#include "base/file/file.h"
#include "data/cells/cell_topology.h"
#include "io/formats.h"
#include "io/text/mesh_text.h"

namespace sg {

namespace {

constexpr size_t highest_degree = 10;  ///< as high as cells go

}  // namespace

Data read_bpt(const std::string& path, const ReadOptions&, Context&) {
  const MappedFile file(path);
  TextCursor in(file.text(), path, '#');
  const size_t patches = in.count("the number of patches", 28);  // two degrees and four points of three numbers, with blanks
  if (patches == 0) in.fail("has no patches");
  std::vector<double> xyz;
  std::vector<int64_t> ids, offsets{0};
  std::vector<uint8_t> degrees;
  for (size_t p = 0; p < patches; ++p) {
    size_t n[2] = {};
    for (size_t& v : n) {
      v = in.count("a degree", 1);
      if (v < 1 || v > highest_degree) in.fail(fmt::format("a patch of degree {}; 1 to {} are supported", v, highest_degree));
    }
    const size_t first = xyz.size() / 3, count = (n[0] + 1) * (n[1] + 1);
    for (size_t k = 0; k < 3 * count; ++k) {
      const double x = in.number("a coordinate");
      if (!std::isfinite(x)) in.fail("a coordinate that is not finite");
      xyz.push_back(x);
    }
    ids.resize(ids.size() + count);
    // The file's columns run along the cell's first axis.
    const std::array<int, 3> orders{int(n[1]), int(n[0]), 0};
    for (int j = 0; j <= orders[1]; ++j)
      for (int i = 0; i <= orders[0]; ++i)
        ids[size_t(offsets.back()) + lattice_node(CellType::bezier_quad, orders, i, j, 0)] =
            int64_t(first + size_t(j) * (n[1] + 1) + size_t(i));
    offsets.push_back(int64_t(ids.size()));
    degrees.insert(degrees.end(), {uint8_t(n[1]), uint8_t(n[0]), 0});
  }
  UnstructuredMesh mesh;
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  mesh.cells.connectivity = Array::from_vector(std::move(ids));
  mesh.cells.offsets = Array::from_vector(std::move(offsets));
  mesh.single_type = CellType::bezier_quad;
  mesh.degrees = Array::from_vector(std::move(degrees), 3);
  return make_dataset(std::move(mesh));
}

}  // namespace sg
