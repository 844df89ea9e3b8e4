// SPDX-License-Identifier: Apache-2.0
// Random volumes on meshes of cells: parallelepipeds as hexahedra or a curvilinear grid with any field, tetrahedra with any field, and
// every kind of mesh with a linear field, which is exact on all of them.
//
// What lights them is the gradient at the points (of quadratic functions their own; else that of the operation gradient, which has tests
// of its own), linear in each tetrahedron; cells of fixed shape are cut into tetrahedra from their lowest point (render/volume/cells/
// tet_mesh.h), which divides a box of a lattice by the order of the fractions of its axes (Kuhn 1960).
#pragma once
#include "filter/field/derivatives/gradient.h"
#include "render/volume/volume_random.h"

namespace sg::test {

inline void take_range(RandomVolume& out, const std::vector<double>& v) {
  const auto [lo, hi] = std::minmax_element(v.begin(), v.end());
  out.lo = *lo, out.hi = *hi;
  out.item.field = "f", out.opaque = true;
  out.box = out.item.data->bounds();
}

/// World gradients of "f" at the points.
inline std::vector<Vec3> point_gradients(const RandomVolume& volume, std::span<const double> values) {
  DatasetParts parts = volume.item.data->parts();
  parts.fields = {};
  // The differences from the first value: offsets take no digits.
  std::vector<double> from_first(values.begin(), values.end());
  for (double& v : from_first) v -= values[0];
  parts.fields.add({"f", Association::point, Array::from_vector(from_first), "", Role::scalars});
  GradientParams p;
  p.field.name = "f", p.as = "g";
  Context context;
  const DatasetPtr found = gradient(make_dataset(std::move(parts)), p, context);
  const Array& g = found->fields().require("g", Association::point).array;
  std::vector<Vec3> out;
  for (size_t i = 0; i < g.count(); ++i) out.emplace_back(g.get(i, 0), g.get(i, 1), g.get(i, 2));
  return out;
}

/// Linear in the six tetrahedra of each box of a lattice: `at` are those of its samples.
inline Vec3 in_tetrahedra(const TrueLattice& l, const std::vector<Vec3>& at, const Vec3& world) {
  std::array<int, 3> c;
  Vec3 f;
  if (!l.locate(l.local(world), c, f)) return {0, 0, 0};
  int axis[3] = {0, 1, 2};
  std::sort(axis, axis + 3, [&](int a, int b) { return f[a] > f[b]; });
  Vec3 sum = at[l.id(c[0], c[1], c[2])] * (1 - f[axis[0]]);
  for (int k = 0; k < 3; ++k) {
    ++c[size_t(axis[k])];
    sum += at[l.id(c[0], c[1], c[2])] * (f[axis[k]] - (k < 2 ? f[axis[k + 1]] : 0.0));
  }
  return sum;
}
/// Where a ray crosses them.
inline std::vector<double> ends_in_tetrahedra(const TrueLattice& l, const Vec3& o, const Vec3& d) {
  std::vector<double> ends = l.ends(o, d), all = ends;
  std::sort(ends.begin(), ends.end());
  for (size_t i = 0; i + 1 < ends.size(); ++i) {
    const double a = ends[i] + 1e-6 * (ends[i + 1] - ends[i]), b = ends[i + 1] - 1e-6 * (ends[i + 1] - ends[i]);
    std::array<int, 3> c;
    Vec3 f, g;
    if (!l.locate(l.local(o + d * a), c, f) || !l.locate(l.local(o + d * b), c, g)) continue;
    for (int k = 0; k < 3; ++k) {
      const double x = f[k] - f[(k + 1) % 3], y = g[k] - g[(k + 1) % 3];
      if ((x < 0) != (y < 0)) all.push_back(a + (b - a) * (x / (x - y)));
    }
  }
  return all;
}

/// A sheared box of bricks.
inline RandomVolume random_bricks(Random& r, const Kinds& kinds, double size, bool curvilinear) {
  RandomVolume out;
  out.words = curvilinear ? "curvilinear " : "hexahedra ";
  auto lattice = std::make_shared<TrueLattice>();
  TrueLattice& l = *lattice;
  l.n = {r.whole(2, 6), r.whole(2, 6), r.whole(2, 6)};
  Mat3 shear;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) shear.m[i][j] = i == j ? r.in(0.6, 1) : r.in(-0.25, 0.25);
  const Mat3 back = inverse(shear);
  for (size_t a = 0; a < 3; ++a)
    for (int i = 0; i < l.n[a]; ++i) {
      double f = double(i) / (l.n[a] - 1);
      if (i > 0 && i + 1 < l.n[a]) f += r.in(-0.3, 0.3) / (l.n[a] - 1);
      l.x[a].push_back(size * (2 * f - 1));
    }
  const auto f = random_function(r, out.words);
  std::vector<double> xyz;
  for (int k = 0; k < l.n[2]; ++k)
    for (int j = 0; j < l.n[1]; ++j)
      for (int i = 0; i < l.n[0]; ++i) {
        const Vec3 p = shear * Vec3{l.x[0][size_t(i)], l.x[1][size_t(j)], l.x[2][size_t(k)]};
        xyz.insert(xyz.end(), {p.x, p.y, p.z});
        l.v.push_back(f(p / size));
      }
  const ElementType type = random_type(r, kinds, l.v, out.words);
  DatasetParts parts;
  double volume = std::abs(determinant(shear));
  for (size_t a = 0; a < 3; ++a) volume *= (l.x[a].back() - l.x[a].front()) / (l.n[a] - 1);
  if (curvilinear) {
    CurvilinearGrid g;
    g.dims = {size_t(l.n[0]), size_t(l.n[1]), size_t(l.n[2])};
    g.points.xyz = Array::from_vector(xyz, 3);
    parts.mesh = std::move(g);
  } else {
    CellList cells;
    cells.xyz = xyz;
    for (int k = 0; k + 1 < l.n[2]; ++k)
      for (int j = 0; j + 1 < l.n[1]; ++j)
        for (int i = 0; i + 1 < l.n[0]; ++i) {
          std::vector<int64_t> c;
          for (const auto& [x, y, z] : {std::array{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}})
            c.push_back(int64_t(l.id(i + x, j + y, k + z)));
          cells.cell(CellType::hexahedron, c);
        }
    parts = cells.dataset()->parts();
  }
  parts.fields.add({"f", Association::point, Array::from_vector(l.v).converted(type), "", Role::scalars});
  out.item.data = make_dataset(std::move(parts));
  take_range(out, l.v);
  out.edge = std::cbrt(2 * volume), out.cell = std::cbrt(volume);
  // The lattice of the box before shearing: values at back * place.
  const auto slopes = std::make_shared<const std::vector<Vec3>>(point_gradients(out, l.v));
  out.along = [lattice, slopes, back](const Vec3& o, const Vec3& d) {
    TrueVolume v;
    const Vec3 p = back * o, q = back * d;
    v.value = [lattice, p, q](double t) { return lattice->value(p + q * t); };
    v.gradient = [lattice, slopes, p, q](double t) { return in_tetrahedra(*lattice, *slopes, p + q * t); };
    v.ends = ends_in_tetrahedra(*lattice, p, q);
    return v;
  };
  return out;
}

/// Six tetrahedra in each brick of a bent box.
inline RandomVolume random_tets(Random& r, const Kinds& kinds, double size) {
  struct Tets {
    std::vector<Vec3> at;
    std::vector<double> v;
    std::vector<Vec3> slopes;
    std::vector<std::array<size_t, 4>> corners;
  };
  RandomVolume out;
  out.words = "tetrahedra ";
  const DatasetPtr mesh = make_dataset(cube(CellType::tetra, size_t(r.whole(1, 5)), bent));
  const UnstructuredMesh& m = *mesh->as<UnstructuredMesh>();
  auto tets = std::make_shared<Tets>();
  const auto f = random_function(r, out.words);
  std::vector<double> xyz;
  const Vec3 stretch{r.in(0.5, 1), r.in(0.5, 1), r.in(0.5, 1)};
  for (size_t i = 0; i < m.points.count(); ++i) {
    const Vec3 p = (m.points.at(i) * 2.0 - Vec3(1, 1, 1)) * stretch * size;
    tets->at.push_back(p), tets->v.push_back(f(p / size));
    xyz.insert(xyz.end(), {p.x, p.y, p.z});
  }
  for (size_t c = 0; c < mesh->cell_count(); ++c) {
    std::array<size_t, 4> v{};
    for (size_t k = 0; k < 4; ++k) v[k] = size_t(m.cells.connectivity.get(4 * c + k));
    tets->corners.push_back(v);
  }
  const ElementType type = random_type(r, kinds, tets->v, out.words);
  DatasetParts parts = mesh->parts();
  std::get<UnstructuredMesh>(parts.mesh).points.xyz = Array::from_vector(xyz, 3);
  parts.fields.add({"f", Association::point, Array::from_vector(tets->v).converted(type), "", Role::scalars});
  out.item.data = make_dataset(std::move(parts));
  take_range(out, tets->v);
  tets->slopes = point_gradients(out, tets->v);
  const double volume = 8 * stretch.x * stretch.y * stretch.z * size * size * size / double(mesh->cell_count());
  out.edge = std::cbrt(2 * volume), out.cell = std::cbrt(6 * volume);
  out.along = [tets, hair = 1e-9 * out.edge](const Vec3& start, const Vec3& d) {
    // A hair beside the ray: where that lies in a face rounding may take it from the cells on both sides.
    const Vec3 o = start + Vec3{0.61, 0.83, -0.47} * hair;
    struct Part {
      double from, to, first, slope;  // value = first + slope t
      Vec3 gradient, bend;            // gradient = that + bend t
    };
    auto parts = std::make_shared<std::vector<Part>>();
    TrueVolume all;
    for (const auto& c : tets->corners) {
      const Vec3 a = tets->at[c[0]], p = tets->at[c[1]] - a, q = tets->at[c[2]] - a, s = tets->at[c[3]] - a;
      const double six = dot(p, cross(q, s));
      const Vec3 weights[3] = {cross(q, s) / six, cross(s, p) / six, cross(p, q) / six};
      // The shares of the corners along the ray: straight lines that must all be positive.
      double from = -HUGE_VAL, to = HUGE_VAL, w0[4], w1[4];
      w0[0] = 1, w1[0] = 0;
      for (int k = 0; k < 3; ++k)
        w0[k + 1] = dot(weights[k], o - a), w1[k + 1] = dot(weights[k], d), w0[0] -= w0[k + 1], w1[0] -= w1[k + 1];
      double first = 0, slope = 0;
      Vec3 gradient, bend;
      for (int k = 0; k < 4; ++k) {
        first += w0[k] * tets->v[c[size_t(k)]], slope += w1[k] * tets->v[c[size_t(k)]];
        gradient += tets->slopes[c[size_t(k)]] * w0[k], bend += tets->slopes[c[size_t(k)]] * w1[k];
        if (w1[k] == 0) {
          if (w0[k] < 0) from = HUGE_VAL;
          continue;
        }
        const double t = -w0[k] / w1[k];
        if (w1[k] > 0) from = std::max(from, t);
        else to = std::min(to, t);
      }
      if (from < to) parts->push_back({from, to, first, slope, gradient, bend}), all.ends.push_back(from), all.ends.push_back(to);
    }
    std::sort(parts->begin(), parts->end(), [](const Part& x, const Part& y) { return x.from < y.from; });
    const auto at = [parts](double t) -> const Part* {
      auto after = std::upper_bound(parts->begin(), parts->end(), t, [](double x, const Part& p) { return x < p.from; });
      return after == parts->begin() || t > (after - 1)->to ? nullptr : &*(after - 1);
    };
    all.value = [at](double t) {
      const Part* p = at(t);
      return p ? p->first + p->slope * t : double(NAN);
    };
    all.gradient = [at](double t) {
      const Part* p = at(t);
      return p ? p->gradient + p->bend * t : Vec3{0, 0, 0};
    };
    return all;
  };
  return out;
}

/// A linear field on any mesh that fills the box.
inline RandomVolume random_linear(Random& r, const Kinds& kinds) {
  RandomVolume out;
  const int which = r.whole(0, kinds.refined ? 9 : 7);
  const Vec3 slope{r.in(-1, 1), r.in(-1, 1), r.in(-1, 1)};
  const double base = r.in(-1, 1);
  DatasetParts parts;
  if (which < 6) {
    const CellType kind = linear_kinds()[size_t(which)];
    const bool flat = kind == CellType::voxel || kind == CellType::polyhedron;
    parts = cube(kind, size_t(r.whole(1, 4)), flat ? Warp(straight) : Warp(bent));
    out.words = std::string(cell_type_info(kind).name) + " linear ";
  } else if (which < 8) {
    // Curved cells: their parts are chords, within 1/512 of the size.
    parts = cube(which == 6 ? CellType::wedge : CellType::hexahedron, size_t(r.whole(1, 4)), straight);
    out.words = "straight linear ";
  } else {
    parts = (which == 8 ? amr() : amr_small())->parts();
    out.words = "AMR linear ";
  }
  if (which < 8) {  // onto [-1, 1]^3
    auto& m = std::get<UnstructuredMesh>(parts.mesh);
    std::vector<double> xyz;
    for (size_t i = 0; i < m.points.count(); ++i)
      for (int a = 0; a < 3; ++a) xyz.push_back(2 * m.points.at(i)[a] - 1);
    m.points.xyz = Array::from_vector(xyz, 3);
  }
  const DatasetPtr bare = make_dataset(parts);
  const Array at = point_positions(bare->mesh());
  std::vector<double> v;
  for (size_t i = 0; i < at.count(); ++i) v.push_back(base + dot(slope, Vec3{at.get(i, 0), at.get(i, 1), at.get(i, 2)}));
  parts.fields.add({"f", Association::point, Array::from_vector(v), "", Role::scalars});
  out.item.data = make_dataset(std::move(parts));
  take_range(out, v);
  size_t cells = 0;
  for (size_t c = 0; c < bare->cell_count(); ++c) cells += bare->cell_ghost().empty() || bare->cell_ghost().get(c) == 0;
  const double volume = bare->bounds().size().x * bare->bounds().size().y * bare->bounds().size().z / double(cells);
  out.edge = std::cbrt(2 * volume), out.cell = std::cbrt(volume);
  const Box3 box = out.box;
  out.along = [=](const Vec3& o, const Vec3& d) {
    TrueVolume all;
    all.value = [=](double t) {
      const Vec3 p = o + d * t;
      for (int a = 0; a < 3; ++a)
        if (p[a] < box.lo[a] || p[a] > box.hi[a]) return double(NAN);
      return base + dot(slope, p);
    };
    all.gradient = [=](double) { return slope; };
    double from = -HUGE_VAL, to = HUGE_VAL;
    for (int a = 0; a < 3; ++a)
      if (d[a] != 0) {
        const double t0 = (box.lo[a] - o[a]) / d[a], t1 = (box.hi[a] - o[a]) / d[a];
        from = std::max(from, std::min(t0, t1)), to = std::min(to, std::max(t0, t1));
      }
    if (from < to)
      for (int i = 0; i <= 8; ++i) all.ends.push_back(from + (to - from) * i / 8);
    return all;
  };
  return out;
}

}  // namespace sg::test
