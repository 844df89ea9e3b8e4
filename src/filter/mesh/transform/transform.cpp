// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/transform/transform.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "base/space/affine.h"
#include "data/lattice.h"
#include "filter/mesh/transform/mirror_cells.h"
#include "filter/mesh/transform/mirror_lattice.h"
#include "filter/mesh/transform/moved_lattice.h"

namespace sg {

namespace {

constexpr size_t points_per_chunk = 1 << 14;

bool is_diagonal(const Mat3& a) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (i != j && a.m[i][j] != 0) return false;
  return true;
}

Affine affine_of(const TransformParams& p) {
  Affine r;
  if (!p.matrix.empty()) {
    if (p.matrix.size() != 16)
      fail_usage(fmt::format("the matrix has {} numbers", p.matrix.size()), "transform matrix", "give 16, row by row");
    if (p.matrix[12] != 0 || p.matrix[13] != 0 || p.matrix[14] != 0 || p.matrix[15] != 1)
      fail_usage("the last row of the matrix is not 0,0,0,1", "transform matrix", "perspective is a property of the camera");
    for (size_t i = 0; i < 3; ++i) {
      for (size_t j = 0; j < 3; ++j) r.linear.m[i][j] = p.matrix[4 * i + j];
      r.shift[int(i)] = p.matrix[4 * i + 3];
    }
  } else {
    const Mat3 turn = with_context("transform", [&] { return turn_about(p.axis, p.angle); });
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) r.linear.m[i][j] = turn.m[i][j] * p.scale[j];
    const Vec3 center = p.center.value_or(Vec3());
    r.shift = center - r.linear * center + p.translate;
  }
  if (!is_invertible(r)) fail_usage("the transform flattens the mesh", "transform", "scale factors must not be 0, nor the matrix singular");
  return r;
}

// The double origin moves to where the old one goes, so the stored numbers stay small offsets.
Points moved_points(const Points& in, const Affine& t) {
  Points r;
  r.origin = t(in.origin);
  std::byte* out = nullptr;
  r.xyz = Array::make_raw(is_float(in.xyz.type()) ? in.xyz.type() : ElementType::f32, in.xyz.count(), 3, &out);
  if (in.xyz.empty()) return r;
  // Without an origin the shift goes into f64 numbers; f32 numbers keep it separate when it is large for them.
  const bool wide = in.xyz.type() == ElementType::f64;
  Vec3 inside;
  if (wide && in.origin == Vec3()) inside = r.origin, r.origin = {};
  dispatch(in.xyz, [&](auto v) {
    using T = std::remove_cvref_t<decltype(v[0])>;
    if constexpr (std::is_floating_point_v<T>) {
      T* to = reinterpret_cast<T*>(out);
      parallel_for(v.count, points_per_chunk, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          const Vec3 p = t.linear * Vec3(double(v(i, 0)), double(v(i, 1)), double(v(i, 2))) + inside;
          for (int c = 0; c < 3; ++c) to[3 * i + size_t(c)] = T(p[c]);
        }
      });
    }
  });
  return r;
}

Array moved_axis(const Array& a, double factor, double shift) {
  double* to = nullptr;
  Array r = Array::make<double>(a.count(), 1, &to);
  for (size_t i = 0; i < a.count(); ++i) to[i] = a.get(i) * factor + shift;
  return r;
}

struct Mover {
  const Affine& t;
  const Mesh& whole;

  Mesh operator()(const UniformGrid& g) const {
    // The images of the axes must stay at right angles; directions are kept as unit columns, lengths (and the sign of the spacing)
    // separately.
    UniformGrid r = g;
    r.origin = t(g.origin);
    Vec3 column[3];
    double size[3];
    for (int a = 0; a < 3; ++a) {
      column[a] = t.linear * g.direction.column(a);
      size[a] = length(column[a]);
    }
    const bool was_skew = [&] {
      for (int a = 0; a < 3; ++a)
        if (std::abs(dot(g.direction.column(a), g.direction.column((a + 1) % 3))) > 1e-12) return true;
      return false;
    }();
    for (int a = 0; a < 3; ++a)
      if (!was_skew && std::abs(dot(column[a], column[(a + 1) % 3])) > 1e-12 * size[a] * size[(a + 1) % 3]) {
        CurvilinearGrid c = moved_lattice(whole, [&](size_t, Vec3 p) { return t(p); });
        c.extent_start = g.extent_start;
        return c;
      }
    // A pure scaling along the grid's own axes changes only the spacing; a mirrored axis keeps its direction and gets a negative spacing.
    for (int a = 0; a < 3; ++a) {
      const Vec3 old = g.direction.column(a);
      const double old_size = length(old);
      const bool flipped = length(column[a] / size[a] + old / old_size) < 1e-12;
      const bool same = length(column[a] / size[a] - old / old_size) < 1e-12;
      r.spacing[a] = g.spacing[a] * (flipped ? -size[a] : size[a]) / old_size;
      for (int i = 0; i < 3; ++i)
        if (!same && !flipped) r.direction.m[i][a] = column[a][i] / size[a] * old_size;
    }
    return r;
  }
  Mesh operator()(const RectilinearGrid& g) const {
    if (!is_diagonal(t.linear)) {
      CurvilinearGrid c = moved_lattice(whole, [&](size_t, Vec3 p) { return t(p); });
      c.extent_start = g.extent_start;
      return c;
    }
    RectilinearGrid r = g;
    r.x = moved_axis(g.x, t.linear.m[0][0], t.shift.x);
    r.y = moved_axis(g.y, t.linear.m[1][1], t.shift.y);
    r.z = moved_axis(g.z, t.linear.m[2][2], t.shift.z);
    return r;
  }
  Mesh operator()(const AmrGrid& g) const {
    if (!is_diagonal(t.linear))
      fail_usage("an AMR grid cannot be rotated or sheared", "transform", "rotate the camera, or take faces, a slice or a contour first");
    AmrGrid r = g;
    r.origin = t(g.origin);
    for (auto& level : r.levels)
      for (int a = 0; a < 3; ++a) level.spacing[a] *= t.linear.m[a][a];
    return r;
  }
  template <class M>
  Mesh operator()(const M& m) const {
    M r = m;
    r.points = moved_points(m.points, t);
    return r;
  }
};

}  // namespace

DatasetPtr transform(const DatasetPtr& in, const TransformParams& p, Context& ctx) {
  const Affine t = affine_of(p);
  DatasetParts out = in->parts();
  out.mesh = std::visit(Mover{t, in->mesh()}, in->mesh());
  if (out.mesh.index() != in->mesh().index()) ctx.info(fmt::format("transform: the {} grid becomes {}", in->kind(), mesh_kind(out.mesh)));
  // Turned or scaled, a patient's left is not where the frame says.
  if (!(t.linear == Mat3())) std::erase_if(out.notes, [](const auto& n) { return n.first == "space"; });
  if (p.vectors) transform_fields(*in, t.linear, p.fields, out.fields, ctx);
  if (determinant(t.linear) < 0) turn_mirrored_cells(out, ctx);
  else ascend_amr(out);
  return make_dataset(std::move(out));
}

}  // namespace sg
