// SPDX-License-Identifier: Apache-2.0
// validate(): nothing that passes here can make a kernel read outside its arrays.
#include <fmt/core.h>

#include <algorithm>
#include <atomic>

#include "base/parallel.h"
#include "data/cells/cell_topology.h"
#include "data/lattice.h"
#include "data/mesh.h"
#include "data/trusted.h"

namespace sg {

namespace {

void check_points(const Points& p) {
  if (p.xyz.count() == 0) return;
  if (p.xyz.components() != 3) fail_data(fmt::format("points have {} coordinates, not 3", p.xyz.components()));
  if (!is_float(p.xyz.type())) fail_data(fmt::format("points are {}, not f32 or f64", element_name(p.xyz.type())));
}

void check_dims(const std::array<size_t, 3>& d) {
  size_t n = 1;
  for (size_t a : d)
    if (__builtin_mul_overflow(n, std::max<size_t>(a, 1), &n) || n > (size_t(1) << 62)) fail_data("the grid has too many points to count");
}

constexpr size_t no_index = SIZE_MAX;

// The first index for which bad(i) holds, found in parallel; `no_index` when there is no such index.
template <class Bad>
size_t first_bad(size_t n, Bad bad) {
  return parallel_reduce(
      n, 1 << 17, no_index,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
          if (bad(i)) return i;
        return no_index;
      },
      [](size_t a, size_t b) { return std::min(a, b); });
}

template <class T>
size_t first_outside(const T* ids, size_t n, size_t points) {
  using U = std::make_unsigned_t<T>;
  return parallel_reduce(
      n, 1 << 18, no_index,
      [&](size_t begin, size_t end) {
        U most = 0;  // as unsigned, a negative id is a huge one
        for (size_t i = begin; i < end; ++i) most = std::max(most, U(ids[i]));
        if (size_t(most) < points) return no_index;
        for (size_t i = begin; i < end; ++i)
          if (size_t(U(ids[i])) >= points) return i;
        return no_index;
      },
      [](size_t a, size_t b) { return std::min(a, b); });
}

// `listed` is what the numbers in the list refer to (points, faces), `what` names the cells.
void check_cells(const CellArray& a, size_t limit, const char* what) {
  const Array& ids = a.connectivity;
  for (const Array* array : {&a.connectivity, &a.offsets})
    if (!array->empty() && (array->components() != 1 || (array->type() != ElementType::i64 && array->type() != ElementType::i32)))
      fail_data(fmt::format("{}: indices must be i32 or i64", what));
  if (a.fixed > 0) {
    if (ids.count() % size_t(a.fixed)) fail_data(fmt::format("{}: {} indices do not make cells of {} points", what, ids.count(), a.fixed));
  } else if (!a.offsets.empty()) {
    const IndexView at = index_view(a.offsets);
    const size_t n = a.offsets.count();
    if (at[0] != 0) fail_data(fmt::format("{}: the first offset is {}, not 0", what, at[0]));
    if (const size_t i = first_bad(n - 1, [&](size_t k) { return at[k + 1] < at[k]; }); i != no_index)
      fail_data(fmt::format("{}: offsets decrease from {} to {} at cell {}", what, at[i], at[i + 1], i));
    if (size_t(at[n - 1]) > ids.count())
      fail_data(fmt::format("{}: offsets end at {} but there are {} indices", what, at[n - 1], ids.count()));
  }
  if (ids.empty()) return;
  index_view(ids);
  const size_t bad = ids.type() == ElementType::i64 ? first_outside(ids.view<int64_t>().data, ids.count(), limit)
                                                    : first_outside(ids.view<int32_t>().data, ids.count(), limit);
  if (bad != no_index)
    fail_data(fmt::format("{}: point id {} at index {} is not in 0..{}", what, index_view(ids)[bad], bad, int64_t(limit) - 1));
}

void check_axis(const Array& a, char name) {
  if (a.components() != 1 || !is_float(a.type())) fail_data(fmt::format("the {} coordinates must be f32 or f64", name));
  if (a.count() < 2) return;
  const bool up = a.get(a.count() - 1) > a.get(0);
  for (size_t i = 1; i < a.count(); ++i) {
    const double d = a.get(i) - a.get(i - 1);
    if (!(up ? d > 0 : d < 0))
      fail_data(fmt::format("the {} coordinates are not monotone: {} after {} at {}", name, a.get(i), a.get(i - 1), i));
  }
}

// Orders of 0 mean the same along all axes, found from the number of nodes.
void check_orders(const UnstructuredMesh& m) {
  if (m.degrees.empty()) return;
  const size_t n = m.cells.size();
  if (m.degrees.type() != ElementType::u8 || m.degrees.components() != 3 || m.degrees.count() != n)
    fail_data(fmt::format("orders of cells: {} tuples of {} {} for {} cells", m.degrees.count(), m.degrees.components(),
                          element_name(m.degrees.type()), n),
              {}, "they must be 3 u8 per cell");
  const auto order = m.degrees.view<uint8_t>();
  const CellsView cells = cells_view(m.cells);
  auto fits = [&](size_t c) {
    const CellType type = m.type(c), form = linear_type(type);
    const bool has_orders =
        type >= CellType::lagrange_curve && (form == CellType::quad || form == CellType::hexahedron || form == CellType::wedge);
    if (!has_orders || order(c, 0) == 0) return true;
    std::array<int, 3> o{order(c, 0), order(c, 1), form == CellType::quad ? 1 : order(c, 2)};
    for (int k : o)
      if (k < 1 || k > 10) return false;
    const size_t nodes = cells.size(c);
    if (form == CellType::wedge && (o[0] != o[1] || nodes == 21)) return nodes == 21;
    return lattice_nodes(type, o) == nodes;
  };
  if (const size_t c = first_bad(n, [&](size_t i) { return !fits(i); }); c != no_index)
    fail_data(fmt::format("cell {} is a {} of {} points, which do not fit its orders {}, {}, {}", c, cell_type_info(m.type(c)).name,
                          cells.size(c), order(c, 0), order(c, 1), order(c, 2)),
              {}, "orders are 1 to 10 and their lattice has as many points as the cell; the first two of a wedge are equal");
}

void check_weights(const UnstructuredMesh& m) {
  if (m.weights.empty()) return;
  if (m.weights.type() != ElementType::f64 || m.weights.components() != 1 || m.weights.count() != m.points.count())
    fail_data(fmt::format("rational weights: {} tuples of {} {} for {} points", m.weights.count(), m.weights.components(),
                          element_name(m.weights.type()), m.points.count()),
              {}, "they must be one f64 per point");
  const auto weight = m.weights.view<double>();
  if (const size_t p = first_bad(weight.count, [&](size_t i) { return !std::isfinite(weight[i]); }); p != no_index)
    fail_data(fmt::format("the rational weight of point {} is {}", p, weight[p]));
}

struct Checker {
  void operator()(const UniformGrid& g) const {
    check_dims(g.dims);
    for (int a = 0; a < 3; ++a) {
      if (!std::isfinite(g.origin[a])) fail_data("the origin is not finite");
      if (!std::isfinite(g.spacing[a]) || (g.spacing[a] == 0 && g.dims[size_t(a)] > 1))
        fail_data(fmt::format("the spacing along {} is {}", "xyz"[a], g.spacing[a]), {}, "it must be finite and not 0");
    }
    if (const double d = determinant(g.direction); !(std::abs(d) > 1e-12)) fail_data("the direction matrix is singular");
  }
  void operator()(const RectilinearGrid& g) const {
    check_dims(g.dims());
    check_axis(g.x, 'x'), check_axis(g.y, 'y'), check_axis(g.z, 'z');
  }
  void operator()(const CurvilinearGrid& g) const {
    check_dims(g.dims);
    check_points(g.points);
    if (g.points.count() != g.dims[0] * g.dims[1] * g.dims[2])
      fail_data(fmt::format("{} points do not fill a grid of {}x{}x{}", g.points.count(), g.dims[0], g.dims[1], g.dims[2]));
  }
  void operator()(const UnstructuredMesh& m) const {
    check_points(m.points);
    check_cells(m.cells, m.points.count(), "cells");
    const size_t n = m.cells.size();
    if (!m.types.empty() && (m.types.type() != ElementType::u8 || m.types.count() != n || !m.types.packed()))
      fail_data(fmt::format("{} cell types for {} cells", m.types.count(), n));
    bool polyhedra = false;
    auto check_type = [&](size_t c, uint8_t t) {
      const CellTypeInfo* info = cell_type_info(t);
      if (!info) fail_data(fmt::format("cell {} has the unknown type {}", c, t));
      const size_t points = cells_view(m.cells).size(c);
      if (info->points >= 0 && size_t(info->points) != points)
        fail_data(fmt::format("cell {} is a {} of {} points, not {}", c, info->name, points, info->points));
      polyhedra = polyhedra || t == uint8_t(CellType::polyhedron);
    };
    if (n > 0 && m.types.empty()) {
      check_type(0, uint8_t(m.single_type));
      const CellsView v = cells_view(m.cells);
      const int points = cell_type_info(m.single_type).points;
      if (!m.cells.fixed && points >= 0)
        if (const size_t c = first_bad(n, [&](size_t i) { return v.size(i) != size_t(points); }); c != no_index)
          check_type(c, uint8_t(m.single_type));
    } else if (n > 0) {
      // Sizes of every type in one table: one look per cell.
      std::array<int, 256> want{};
      for (int t = 0; t < 256; ++t) want[size_t(t)] = cell_type_info(uint8_t(t)) ? cell_type_info(uint8_t(t))->points : -2;
      const auto types = m.types.view<uint8_t>();
      const CellsView v = cells_view(m.cells);
      const size_t bad = first_bad(n, [&](size_t c) {
        const int w = want[types[c]];
        return w == -2 || (w >= 0 && v.size(c) != size_t(w));
      });
      if (bad != no_index) check_type(bad, types[bad]);
      polyhedra = first_bad(n, [&](size_t c) { return types[c] == uint8_t(CellType::polyhedron); }) != no_index;
    }
    if (polyhedra && m.polyhedron_faces.count() != n + 1) fail_data("the polyhedra have no faces");
    if (m.polyhedron_faces.count() > 0) {
      check_cells(m.faces, m.points.count(), "faces of polyhedra");
      if (m.polyhedron_faces.type() != ElementType::i64 || m.polyhedron_faces.count() != n + 1)
        fail_data("face lists of polyhedra do not fit the cells");
      const auto at = m.polyhedron_faces.view<int64_t>();
      if (at[0] != 0 || size_t(at[n]) > m.faces.size()) fail_data("face lists of polyhedra extend beyond the faces");
      if (const size_t c = first_bad(n, [&](size_t i) { return at[i + 1] < at[i]; }); c != no_index)
        fail_data(fmt::format("offsets of polyhedron faces decrease at cell {}", c));
    }
    check_orders(m);
    check_weights(m);
  }
  void operator()(const SurfaceMesh& m) const {
    check_points(m.points);
    check_cells(m.vertices, m.points.count(), "vertices");
    check_cells(m.lines, m.points.count(), "lines");
    check_cells(m.polygons, m.points.count(), "polygons");
    check_cells(m.strips, m.points.count(), "strips");
  }
  void operator()(const PointCloud& m) const { check_points(m.points); }
  void operator()(const AmrGrid& g) const {
    if (g.dimension != 2 && g.dimension != 3) fail_data(fmt::format("an AMR grid of {} dimensions", g.dimension));
    for (size_t l = 0; l < g.levels.size(); ++l)
      for (const auto& p : g.levels[l].patches)
        for (size_t a = 0; a < 3; ++a)
          if (p.hi[a] < p.lo[a] || p.hi[a] - p.lo[a] > (1ll << 40))
            fail_data(fmt::format("a patch of level {} runs from {} to {}", l, p.lo[a], p.hi[a]));
  }
};

}  // namespace

void validate(const Mesh& mesh) {
  if (detail::mesh_is_trusted()) return;
  std::visit(Checker{}, mesh);
}

}  // namespace sg
