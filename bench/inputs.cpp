// SPDX-License-Identifier: Apache-2.0
// Inputs of the benchmarks: the formulas stand in the README of the peers' scripts. Files that exist are left alone, so that
// peers and we read the same ones.
#include "inputs.h"

#include <sys/stat.h>

#include <cmath>
#include <numbers>

#include "base/file/file.h"
#include "base/parallel.h"
#include "bench.h"
#include "filter/scalar/contour/contour.h"
#include "io/io.h"

namespace sg::bench {

DatasetPtr field_grid(size_t n) {
  float* f = nullptr;
  Array values = Array::make<float>(n * n * n, 1, &f);
  std::vector<double> s(n), c(n), q(n);
  for (size_t i = 0; i < n; ++i) {
    const double x = double(float(-1 + 2 * double(i) / double(n - 1)));
    s[i] = std::sin(2 * std::numbers::pi * x), c[i] = std::cos(2 * std::numbers::pi * x), q[i] = x * x;
  }
  parallel_for(n, 1, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k)
      for (size_t j = 0; j < n; ++j)
        for (size_t i = 0; i < n; ++i) f[i + n * (j + n * k)] = float(s[i] * c[j] + q[i] + q[j] - 0.8 + s[j] * c[k] + s[k] * c[i] + q[k]);
  });
  UniformGrid g;
  g.dims = {n, n, n};
  g.origin = {-1, -1, -1};
  g.spacing = Vec3(1, 1, 1) * (2.0 / double(n - 1));
  FieldSet fields;
  fields.add({"f", Association::point, values, "", Role::scalars});
  return make_dataset(g, fields);
}

DatasetPtr surface_mesh(size_t n) {
  Context context;
  ContourParams p;
  p.values = {0};
  return contour(field_grid(n), p, context);
}

namespace {

double field_at(double x, double y, double z) {
  constexpr double w = 2 * std::numbers::pi;
  return std::sin(w * x) * std::cos(w * y) + std::sin(w * y) * std::cos(w * z) + std::sin(w * z) * std::cos(w * x) + x * x + y * y + z * z -
         0.8;
}

// The cube of n^3 smoothly displaced hexahedra cut into cells that are given by their corners (bits: x, y, z).
DatasetPtr displaced_cube(size_t n, CellType type, std::span<const int> corners, int corners_per_cell) {
  const size_t m = n + 1;
  std::vector<float> xyz(m * m * m * 3), f(m * m * m);
  for (size_t k = 0, p = 0; k < m; ++k)
    for (size_t j = 0; j < m; ++j)
      for (size_t i = 0; i < m; ++i, ++p) {
        const double x = -1 + 2 * double(i) / double(n), y = -1 + 2 * double(j) / double(n), z = -1 + 2 * double(k) / double(n);
        const double w = 0.08 * (1 - x * x) * (1 - y * y) * (1 - z * z);
        xyz[3 * p] = float(x + w * std::sin(5 * y + 3 * z));
        xyz[3 * p + 1] = float(y + w * std::sin(5 * z + 3 * x));
        xyz[3 * p + 2] = float(z + w * std::sin(5 * x + 3 * y));
        f[p] = float(field_at(double(xyz[3 * p]), double(xyz[3 * p + 1]), double(xyz[3 * p + 2])));
      }
  std::vector<int64_t> ids;
  ids.reserve(corners.size() * n * n * n);
  for (size_t k = 0; k < n; ++k)
    for (size_t j = 0; j < n; ++j)
      for (size_t i = 0; i < n; ++i)
        for (int corner : corners)
          ids.push_back(int64_t(i + size_t(corner & 1) + m * (j + size_t(corner >> 1 & 1) + m * (k + size_t(corner >> 2)))));
  UnstructuredMesh mesh;
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  mesh.cells.fixed = corners_per_cell;
  mesh.cells.connectivity = Array::from_vector(std::move(ids));
  mesh.single_type = type;
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(std::move(f)), "", Role::scalars});
  return make_dataset(std::move(mesh), fields);
}

}  // namespace

DatasetPtr tetrahedra(size_t n) {
  constexpr int kuhn[] = {0, 1, 3, 7, 0, 3, 2, 7, 0, 2, 6, 7, 0, 6, 4, 7, 0, 4, 5, 7, 0, 5, 1, 7};
  return displaced_cube(n, CellType::tetra, kuhn, 4);
}

DatasetPtr hexahedra(size_t n) {
  constexpr int cube[] = {0, 1, 3, 2, 4, 5, 7, 6};
  return displaced_cube(n, CellType::hexahedron, cube, 8);
}

void make_inputs(const std::string& folder) {
  ::mkdir(folder.c_str(), 0777);
  Context context;
  auto write = [&](const std::string& name, auto&& make, const char* compression = "none") {
    const std::string path = folder + "/" + name;
    if (file_exists(path)) return;
    WriteOptions options;
    options.compression = value_of_word<Compression>(compression);
    write_data(path, make(), options, context);
  };
  write("f256_raw.vti", [] { return field_grid(256); });
  write(
      "f256_zlib.vti", [] { return field_grid(256); }, "zlib");
  write("tet1M_raw.vtu", [] { return tetrahedra(55); });
  for (const char* name : {"mesh1M_binary.stl", "mesh1M_binary.ply", "mesh1M.obj", "mesh1M_raw.vtp"})
    write(name, [] { return surface_mesh(235); });
}

}  // namespace sg::bench
