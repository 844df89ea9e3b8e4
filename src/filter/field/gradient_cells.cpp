// SPDX-License-Identifier: Apache-2.0
#include "filter/field/gradient_cells.h"

#include <cmath>

#include "base/parallel.h"

namespace sg {

namespace {

// Cells of an unstructured or surface mesh as lists of points with a dimension, numbered as the cell fields are.
struct CellLists {
  struct Part {
    CellsView cells;
    int dimension;  // -1: by type
  };
  const UnstructuredMesh* mesh = nullptr;
  std::vector<Part> parts;

  explicit CellLists(const Mesh& m) {
    if (auto* u = std::get_if<UnstructuredMesh>(&m)) {
      mesh = u;
      parts.push_back({cells_view(u->cells), -1});
    } else {
      const auto& s = std::get<SurfaceMesh>(m);
      parts = {{cells_view(s.vertices), 0}, {cells_view(s.lines), 1}, {cells_view(s.polygons), 2}, {cells_view(s.strips), 2}};
    }
  }
  int dimension(const Part& p, size_t cell) const { return p.dimension >= 0 ? p.dimension : cell_type_info(mesh->type(cell)).dimension; }
};

struct CellAt {
  uint32_t part;
  uint32_t dimension;
  size_t begin, end;  // in the part's connectivity
};

// Eigenvalues and vectors (columns of v) of a symmetric matrix by cyclic Jacobi rotations.
void eigen(double a[3][3], double v[3][3]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) v[i][j] = i == j;
  for (int sweep = 0; sweep < 12; ++sweep)
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) {
        if (a[p][q] == 0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < 3; ++k) {
          const double x = a[k][p], y = a[k][q];
          a[k][p] = c * x - s * y, a[k][q] = s * x + c * y;
        }
        for (int k = 0; k < 3; ++k) {
          const double x = a[p][k], y = a[q][k];
          a[p][k] = c * x - s * y, a[q][k] = s * x + c * y;
        }
        for (int k = 0; k < 3; ++k) {
          const double x = v[k][p], y = v[k][q];
          v[k][p] = c * x - s * y, v[k][q] = s * x + c * y;
        }
      }
}

// The least-norm solution of a x = b; directions that the points do not span get 0.
Vec3 solve(double a[3][3], const double b[3]) {
  double v[3][3];
  const double scale = a[0][0] + a[1][1] + a[2][2];
  eigen(a, v);
  Vec3 x;
  for (int e = 0; e < 3; ++e) {
    if (!(a[e][e] > 1e-11 * scale)) continue;
    const double along = (v[0][e] * b[0] + v[1][e] * b[1] + v[2][e] * b[2]) / a[e][e];
    for (int i = 0; i < 3; ++i) x[i] += along * v[i][e];
  }
  return x;
}

// Sum of the cross products of consecutive corners: twice the area, along the normal.
Vec3 area_vector(const CellsView& cells, const CellAt& at, const Points& points) {
  Vec3 n;
  const Vec3 first = points.at(size_t(cells.connectivity[at.begin]));
  for (size_t k = at.begin + 1; k + 1 < at.end; ++k)
    n += cross(points.at(size_t(cells.connectivity[k])) - first, points.at(size_t(cells.connectivity[k + 1])) - first);
  return n;
}

Vec3 gradient_at(size_t p, std::span<const CellAt> cells, const CellLists& lists, const Points& points, const View<double>& f, int c) {
  double a[3][3] = {}, b[3] = {};
  const Vec3 here = points.at(p);
  const double value = f(p, c);
  uint32_t dimension = 0;
  for (const CellAt& cell : cells) dimension = std::max(dimension, cell.dimension);
  Vec3 normal;
  for (const CellAt& cell : cells)
    if (dimension == 2 && cell.dimension == 2) {
      const Vec3 n = area_vector(lists.parts[cell.part].cells, cell, points);
      normal += dot(n, normal) < 0 ? -n : n;
    }
  normal = normalize(normal);
  size_t neighbours = 0;
  for (const CellAt& cell : cells)
    for (size_t k = cell.begin; k < cell.end; ++k) {
      const size_t q = size_t(lists.parts[cell.part].cells.connectivity[k]);
      const double df = f(q, c) - value;
      Vec3 d = points.at(q) - here;
      if (dimension == 2) d = d - normal * dot(d, normal);
      const double square = dot(d, d);
      if (q == p || !(square > 0) || !std::isfinite(df)) continue;
      ++neighbours;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) a[i][j] += d[i] * d[j] / square;
        b[i] += d[i] * df / square;
      }
    }
  if (neighbours == 0) return Vec3(NAN, NAN, NAN);
  return solve(a, b);
}

}  // namespace

void least_squares_gradients(const Dataset& dataset, std::span<const uint32_t> wanted, const Array& values, double* out,
                             const Context& context) {
  const CellLists lists(dataset.mesh());
  const Points& points = lists.mesh ? lists.mesh->points : std::get<SurfaceMesh>(dataset.mesh()).points;
  const Array& ghost = dataset.cell_ghost();
  const View<uint8_t> hidden = ghost.empty() ? View<uint8_t>{} : ghost.view<uint8_t>();
  constexpr uint32_t none = UINT32_MAX;
  std::vector<uint32_t> slot(points.count(), none);
  for (size_t i = 0; i < wanted.size(); ++i) slot[wanted[i]] = uint32_t(i);

  // Cells at each wanted point, in the order of the cells.
  std::vector<size_t> start(wanted.size() + 1, 0);
  auto each = [&](auto&& f) {
    size_t number = 0;
    for (size_t part = 0; part < lists.parts.size(); ++part) {
      const CellsView& cells = lists.parts[part].cells;
      for (size_t c = 0; c < cells.count; ++c, ++number) {
        if (hidden.count && (hidden[number] & (ghost_hidden_cell | ghost_refined_cell))) continue;
        for (size_t k = cells.begin(c); k < cells.end(c); ++k)
          if (const uint32_t s = slot[size_t(cells.connectivity[k])]; s != none) f(s, part, c);
      }
    }
  };
  each([&](uint32_t s, size_t, size_t) { ++start[s]; });
  exclusive_scan(start);
  std::vector<CellAt> at(start.back());
  std::vector<size_t> next(start.begin(), start.end() - 1);
  each([&](uint32_t s, size_t part, size_t c) {
    const CellsView& cells = lists.parts[part].cells;
    at[next[s]++] = {uint32_t(part), uint32_t(lists.dimension(lists.parts[part], c)), cells.begin(c), cells.end(c)};
  });

  const auto f = values.view<double>();
  parallel_for(
      wanted.size(), 1024,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
          for (int c = 0; c < f.components; ++c) {
            const Vec3 g = std::isnan(f(wanted[i], c))
                               ? Vec3(NAN, NAN, NAN)
                               : gradient_at(wanted[i], {at.data() + start[i], start[i + 1] - start[i]}, lists, points, f, c);
            for (int a = 0; a < 3; ++a) out[(i * size_t(f.components) + size_t(c)) * 3 + size_t(a)] = g[a];
          }
      },
      &context);
}

}  // namespace sg
