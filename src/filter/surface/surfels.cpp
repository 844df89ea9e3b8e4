// SPDX-License-Identifier: Apache-2.0
#include "filter/surface/surfels.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "data/field_ops.h"
#include "data/lattice.h"
#include "data/ranks/over_all.h"
#include "data/ranks/part_ranges.h"
#include "filter/field/automatic_values.h"
#include "filter/scalar/contour/lattice/contour_surfels.h"

namespace sg {

namespace {

struct Slab {
  std::vector<float> xyz, normals, radius;
  std::vector<int64_t> cells, corners;  // corners: 8 a surfel, when fields are carried
  std::vector<double> weights;
};

// The eight corners of a cell, x fastest, and what a trilinear function of theirs is at a place in [0,1]^3.
template <class T>
T trilinear(const T* c, Vec3 u) {
  auto mix = [](T a, T b, double t) { return a * (1 - t) + b * t; };
  return mix(mix(mix(c[0], c[1], u.x), mix(c[2], c[3], u.x), u.y), mix(mix(c[4], c[5], u.x), mix(c[6], c[7], u.x), u.y), u.z);
}
template <class T>
std::array<T, 3> slopes(const T* c, Vec3 u) {
  auto square = [](T a, T b, T d, T e, double s, double t) { return (a * (1 - s) + b * s) * (1 - t) + (d * (1 - s) + e * s) * t; };
  return {square(c[1] - c[0], c[3] - c[2], c[5] - c[4], c[7] - c[6], u.y, u.z),
          square(c[2] - c[0], c[3] - c[1], c[6] - c[4], c[7] - c[5], u.x, u.z),
          square(c[4] - c[0], c[5] - c[1], c[6] - c[2], c[7] - c[3], u.x, u.y)};
}

struct Job {
  LatticeView lattice;
  Vec3 origin;
  double value, size;
  bool carry;
  const uint8_t* cell_ghost;
  const uint8_t* point_ghost;
};

// One surfel, unless a sample is missing.
void add_surfel(const Job& job, const double* f, size_t i, size_t j, size_t k, size_t cell, Slab& out) {
  Vec3 at[8];
  size_t id[8];
  for (size_t c = 0; c < 8; ++c) {
    const size_t x = i + (c & 1), y = j + (c >> 1 & 1), z = k + (c >> 2);
    id[c] = job.lattice.id(x, y, z);
    if (std::isnan(f[c]) || (job.point_ghost && (job.point_ghost[id[c]] & ghost_hidden_point))) return;
    at[c] = job.lattice.position(x, y, z);
  }
  Vec3 u(0.5, 0.5, 0.5), g;
  for (int step = 0; step < 2; ++step) {
    const auto s = slopes(f, u);
    g = {s[0], s[1], s[2]};
    const double g2 = dot(g, g);
    if (!(g2 > 0)) break;
    u += g * ((job.value - trilinear(f, u)) / g2);
    for (int a = 0; a < 3; ++a) u[a] = std::clamp(u[a], 0.0, 1.0);
  }
  const auto s = slopes(f, u);
  const auto [dx, dy, dz] = slopes(at, u);
  // Gradient in space: the inverse transpose of the cell's Jacobian times the gradient in the cell; the determinant gives only a sign.
  const Vec3 yz = cross(dy, dz), zx = cross(dz, dx), xy = cross(dx, dy);
  Vec3 n = normalize((yz * s[0] + zx * s[1] + xy * s[2]) * (dot(dx, yz) < 0 ? 1.0 : -1.0));
  if (n == Vec3()) n = normalize(xy);
  const Vec3 p = trilinear(at, u) - job.origin;
  const double r = 0.5 * job.size * std::sqrt(dot(dx, dx) + dot(dy, dy) + dot(dz, dz));
  out.xyz.insert(out.xyz.end(), {float(p.x), float(p.y), float(p.z)});
  out.normals.insert(out.normals.end(), {float(n.x), float(n.y), float(n.z)});
  out.radius.push_back(float(r));
  out.cells.push_back(int64_t(cell));
  if (!job.carry) return;
  for (size_t c = 0; c < 8; ++c) {
    out.corners.push_back(int64_t(id[c]));
    out.weights.push_back((c & 1 ? u.x : 1 - u.x) * (c & 2 ? u.y : 1 - u.y) * (c & 4 ? u.z : 1 - u.z));
  }
}

// Rows of cells between the planes k and k+1: first how many of the four samples at each place of a row are inside, then the cells
// where that is neither none nor all of eight.
template <class T>
void find_in_slab(const Job& job, const T* samples, size_t k, Slab& out) {
  const auto& n = job.lattice.dims;
  std::vector<uint8_t> inside(n[0]);
  uint8_t* const in = inside.data();
  for (size_t j = 0; j + 1 < n[1]; ++j) {
    const T* row[4] = {samples + job.lattice.id(0, j, k), samples + job.lattice.id(0, j + 1, k), samples + job.lattice.id(0, j, k + 1),
                       samples + job.lattice.id(0, j + 1, k + 1)};
    const double v = job.value;
    if constexpr (std::is_same_v<T, float>) {
      // f >= v in double is f >= the smallest float that is >= v.
      float limit = float(v);
      if (double(limit) < v) limit = std::nextafterf(limit, HUGE_VALF);
      for (size_t i = 0; i < n[0]; ++i)
        in[i] = uint8_t((row[0][i] >= limit) + (row[1][i] >= limit) + (row[2][i] >= limit) + (row[3][i] >= limit));
    } else {
      for (size_t i = 0; i < n[0]; ++i)
        in[i] = uint8_t((double(row[0][i]) >= v) + (double(row[1][i]) >= v) + (double(row[2][i]) >= v) + (double(row[3][i]) >= v));
    }
    const size_t first = (n[0] - 1) * (j + (n[1] - 1) * k);
    for (size_t i = 0; i + 1 < n[0]; ++i) {
      // Eight cells at once where nothing is cut.
      if (uint64_t eight; i + 9 <= n[0] && (in[i] == 0 || in[i] == 4) && in[i + 8] == in[i]) {
        std::memcpy(&eight, in + i, 8);
        if (eight == in[i] * 0x0101010101010101u) {
          i += 7;
          continue;
        }
      }
      const unsigned sum = unsigned(in[i]) + in[i + 1];
      if (sum == 0 || sum == 8) continue;
      const size_t cell = first + i;
      if (job.cell_ghost && (job.cell_ghost[cell] & (ghost_duplicate | ghost_refined_cell | ghost_hidden_cell))) continue;
      double f[8];
      for (size_t c = 0; c < 8; ++c) f[c] = double(row[c >> 1][i + (c & 1)]);
      add_surfel(job, f, i, j, k, cell, out);
    }
  }
}

const Field& surfel_field(const Dataset& in, const FieldName& name) {
  const Field* f = name.empty() ? in.fields().active(1) : with_context("surfels", [&] { return &in.fields().require(name.name); });
  if (!f) fail_usage("the mesh has no scalar field", "surfels", "name one: field=NAME");
  if (f->association != Association::point)
    fail_usage(fmt::format("field '{}' is not a point field", f->name), "surfels", "cell_to_point turns cell fields into point fields");
  if (f->components() != 1)
    fail_usage(fmt::format("field '{}' has {} components", f->name, f->components()), "surfels", "take its magnitude or a component first");
  return *f;
}

template <class T>
Array joined(std::vector<Slab>& slabs, std::vector<T> Slab::*member, int components) {
  size_t total = 0;
  for (const Slab& s : slabs) total += (s.*member).size();
  T* to = nullptr;
  Array a = Array::make<T>(total / size_t(components), components, &to);
  for (Slab& s : slabs) {
    to = std::copy((s.*member).begin(), (s.*member).end(), to);
    std::vector<T>().swap(s.*member);
  }
  return a;
}

Array same_number(size_t count, float number) {
  float* to = nullptr;
  const Array a = Array::make<float>(count, 1, &to);
  parallel_for(count, 1 << 16, [&](size_t begin, size_t end) { std::fill(to + begin, to + end, number); });
  return a;
}

// In one of the types that contours read as they are.
Array native_samples(const Array& a) {
  switch (a.type()) {
    case ElementType::u32:
    case ElementType::i32:
    case ElementType::u64:
    case ElementType::i64: return a.converted(ElementType::f64);
    default: return a.made_packed();
  }
}

DatasetPtr assemble(const Dataset& in, const Field& field, double value, Points points, Array normals, Array radius,
                    std::span<const int64_t> cells, std::span<const int64_t> corners, std::span<const double> weights, Context& ctx) {
  const size_t count = normals.count();
  if (count == 0) {
    const Range r = ctx.communicator ? in.range(field) : range_over_all(in, field, -1, ctx);  // not all processes may come here
    if (!met_in_a_part(field, -1, value, ctx))
      ctx.info(fmt::format("surfels: nothing at {} = {}; the field ranges from {} to {}", field.name, short_number(value),
                           short_number(r.lo), short_number(r.hi)));
  }
  DatasetParts out;
  FieldSet rest;
  bool others = false;
  for (const Field& f : in.fields()) {
    if (f.association == Association::point && f.name == field.name) continue;
    rest.add(f);
    others = others || f.association == Association::point;
  }
  out.fields.add(field.with(same_number(count, float(value)), Association::point));
  if (others) carry_combined(out.fields, rest, Association::point, corners, weights, 8, Association::point);
  carry_gathered(out.fields, rest, Association::cell, cells, Association::point);
  carry_whole(out.fields, rest);
  out.fields.add({"Normals", Association::point, std::move(normals), "", Role::normals});
  out.fields.add({"radius", Association::point, std::move(radius), "length", Role::none});
  out.mesh = PointCloud{std::move(points)};
  out.notes = in.notes();
  out.time = in.time();
  return make_dataset(std::move(out));
}

}  // namespace

DatasetPtr surfels(const DatasetPtr& in, const SurfelsParams& p, Context& ctx) {
  if (!is_lattice(in->mesh()))
    fail_usage(fmt::format("surfels come from grids, not from a mesh of kind {}", in->kind()), "surfels",
               "use contour, or resample it first");
  const auto n = lattice_dims(in->mesh());
  if (std::min({n[0], n[1], n[2]}) < 2)
    fail_usage(fmt::format("a grid of {}x{}x{} points has no solid cells", n[0], n[1], n[2]), "surfels", "use isolines for flat grids");
  const Field& field = surfel_field(*in, p.field);
  const double value = p.value ? *p.value : middle_value(*in, field, -1, "surfels", ctx);
  if (!std::isfinite(value)) fail_usage(fmt::format("{} is not a valid isovalue", value), "surfels value", "give a finite number");
  const Lattice lattice(in->mesh());
  const Array cell_ghost = in->cell_ghost().empty() ? Array() : in->cell_ghost().made_packed();
  const Array point_ghost = in->point_ghost().empty() ? Array() : in->point_ghost().made_packed();
  const Box3& box = in->bounds();
  bool others = false;
  for (const Field& f : in->fields()) others = others || (f.association == Association::point && f.name != field.name);
  const double far =
      std::max({std::abs(box.lo.x), std::abs(box.lo.y), std::abs(box.lo.z), std::abs(box.hi.x), std::abs(box.hi.y), std::abs(box.hi.z)});
  const Vec3 origin = far <= 4 * box.diagonal() ? Vec3() : box.center();
  if (!others && cell_ghost.empty() && point_ghost.empty()) {
    bool cells = false;
    for (const Field& f : in->fields()) cells = cells || f.association == Association::cell;
    if (const auto places = contouring::surfel_places(*in, native_samples(field.array), value, origin, cells, ctx)) {
      const double r = 0.5 * p.size *
                       std::sqrt(dot(lattice.view().step[0], lattice.view().step[0]) + dot(lattice.view().step[1], lattice.view().step[1]) +
                                 dot(lattice.view().step[2], lattice.view().step[2]));
      return assemble(*in, field, value, {places->xyz, origin}, places->normals, same_number(places->xyz.count(), float(r)), places->cells,
                      {}, {}, ctx);
    }
  }
  const Job job{lattice.view(),
                origin,
                value,
                p.size,
                others,
                cell_ghost.empty() ? nullptr : cell_ghost.view<uint8_t>().data,
                point_ghost.empty() ? nullptr : point_ghost.view<uint8_t>().data};
  std::vector<Slab> slabs(n[2] - 1);
  dispatch(field.array.made_packed(), [&](auto v) {
    parallel_for(
        slabs.size(), 1, [&](size_t k, size_t) { find_in_slab(job, v.data, k, slabs[k]); }, &ctx);
  });
  const Array cells = joined(slabs, &Slab::cells, 1), corners = joined(slabs, &Slab::corners, 1),
              weights = joined(slabs, &Slab::weights, 1), normals = joined(slabs, &Slab::normals, 3),
              radius = joined(slabs, &Slab::radius, 1);
  return assemble(*in, field, value, {joined(slabs, &Slab::xyz, 3), origin}, normals, radius,
                  std::span(cells.view<int64_t>().data, cells.count()), std::span(corners.view<int64_t>().data, corners.count()),
                  std::span(weights.view<double>().data, weights.count()), ctx);
}

}  // namespace sg
