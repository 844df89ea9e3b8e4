// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/transform/mirror.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text/text.h"
#include "data/field_ops.h"
#include "data/lattice.h"
#include "data/ranks/over_all.h"
#include "filter/mesh/append.h"
#include "filter/mesh/transform/mirror_lattice.h"
#include "filter/mesh/transform/transform.h"

namespace sg {

namespace {

// Two straight lattices that share a layer across one axis: `low` ends where `high` begins.
class JoinedLattice {
 public:
  JoinedLattice(const Dataset& low, const Dataset& high, int axis) : axis_(size_t(axis)), low_(low), high_(high) {
    for (const Dataset* d : {&low, &high}) {
      points_.push_back(lattice_dims(d->mesh()));
      auto& cells = cells_.emplace_back(points_.back());
      for (size_t& n : cells) n = std::max<size_t>(n, 2) - 1;
    }
  }
  DatasetPtr dataset() const {
    DatasetParts out = low_.parts();
    out.mesh = mesh();
    const std::vector<int64_t> points = ids(points_, 1), cells = ids(cells_, 0);
    out.fields = {};
    for (const Field& f : low_.fields()) {
      const Field* other = high_.fields().find(f.name, f.association);
      Field g = f;
      if (other && f.association != Association::whole)
        g.array = gather(both(f.array, other->array), f.association == Association::point ? points : cells);
      out.fields.add(std::move(g));
    }
    if (!out.point_ghost.empty()) out.point_ghost = gather(both(out.point_ghost, high_.parts().point_ghost), points);
    if (!out.cell_ghost.empty()) out.cell_ghost = gather(both(out.cell_ghost, high_.parts().cell_ghost), cells);
    return make_dataset(std::move(out));
  }

 private:
  using Dims = std::array<size_t, 3>;

  Mesh mesh() const {
    const size_t n = points_[0][axis_] + points_[1][axis_] - 1;
    if (auto* u = std::get_if<UniformGrid>(&low_.mesh())) {
      UniformGrid g = *u;
      g.dims[axis_] = n, g.extent_start = {};
      return g;
    }
    RectilinearGrid g = std::get<RectilinearGrid>(low_.mesh());
    const RectilinearGrid& h = std::get<RectilinearGrid>(high_.mesh());
    Array& x = axis_ == 0 ? g.x : axis_ == 1 ? g.y : g.z;
    const Array& more = axis_ == 0 ? h.x : axis_ == 1 ? h.y : h.z;
    std::vector<double> all;
    for (size_t i = 0; i < x.count(); ++i) all.push_back(x.get(i));
    for (size_t i = 1; i < more.count(); ++i) all.push_back(more.get(i));
    x = Array::from_vector(std::move(all)), g.extent_start = {};
    return g;
  }
  // Of samples of the whole, in those of `low` and then those of `high`, whose first `shared` layers are the last of `low`.
  std::vector<int64_t> ids(const std::vector<Dims>& dims, size_t shared) const {
    Dims all = dims[0];
    all[axis_] += dims[1][axis_] - shared;
    const size_t first = dims[0][0] * dims[0][1] * dims[0][2];
    std::vector<int64_t> r;
    r.reserve(all[0] * all[1] * all[2]);
    Dims i;
    for (i[2] = 0; i[2] < all[2]; ++i[2])
      for (i[1] = 0; i[1] < all[1]; ++i[1])
        for (i[0] = 0; i[0] < all[0]; ++i[0]) {
          const bool in_high = i[axis_] >= dims[0][axis_];
          Dims at = i;
          if (in_high) at[axis_] += shared, at[axis_] -= dims[0][axis_];
          const Dims& n = dims[in_high];
          r.push_back(int64_t((in_high ? first : 0) + at[0] + n[0] * (at[1] + n[1] * at[2])));
        }
    return r;
  }
  static Array both(const Array& a, const Array& b) {
    const ElementType type = a.type() == b.type() ? a.type() : ElementType::f64;
    const Array x = a.converted(type).made_packed(), y = b.converted(type).made_packed();
    std::byte* out = nullptr;
    Array r = Array::make_raw(type, x.count() + y.count(), x.components(), &out);
    std::copy_n(static_cast<const std::byte*>(x.raw()), x.bytes(), out);
    std::copy_n(static_cast<const std::byte*>(y.raw()), y.bytes(), out + x.bytes());
    return r;
  }

  size_t axis_;
  const Dataset &low_, &high_;
  std::vector<Dims> points_, cells_;
};

bool along_axes(const UniformGrid& g) { return g.direction == Mat3(); }

const Array& coordinates(const RectilinearGrid& r, int axis) { return axis == 0 ? r.x : axis == 1 ? r.y : r.z; }

// The place of the first or the last layer across the axis; nothing for other meshes, and for grids that are turned.
std::optional<double> end_of(const Mesh& mesh, int axis, bool last) {
  if (auto* u = std::get_if<UniformGrid>(&mesh); u && along_axes(*u) && u->dims[size_t(axis)] > 1)
    return u->origin[axis] + (last ? double(u->dims[size_t(axis)] - 1) * u->spacing[axis] : 0);
  if (auto* r = std::get_if<RectilinearGrid>(&mesh))
    if (const Array& x = coordinates(*r, axis); x.count() > 1) return x.get(last ? x.count() - 1 : 0);
  return {};
}

bool runs_down(const Mesh& mesh, int axis) {
  const auto first = end_of(mesh, axis, false), last = end_of(mesh, axis, true);
  return first && last && *last < *first;
}

// transform() renumbers what it mirrors so that cells keep their sense; here both halves must run the same way along each axis.
DatasetPtr numbered_as(const Dataset& wanted, const DatasetPtr& image) {
  std::array<bool, 3> axes;
  for (int a = 0; a < 3; ++a) axes[size_t(a)] = runs_down(wanted.mesh(), a) != runs_down(image->mesh(), a);
  if (!axes[0] && !axes[1] && !axes[2]) return image;
  DatasetParts parts = image->parts();
  number_backwards(parts, axes);
  return make_dataset(std::move(parts));
}

// The second half of the points is the image of the first: those in the mirror are used twice.
void share_points(Array& connectivity, const std::vector<bool>& in_mirror) {
  if (connectivity.empty()) return;
  std::vector<int64_t> ids(connectivity.count());
  for (size_t i = 0; i < ids.size(); ++i) {
    const auto id = int64_t(connectivity.get(i)), n = int64_t(in_mirror.size());
    ids[i] = id >= n && in_mirror[size_t(id - n)] ? id - n : id;
  }
  connectivity = Array::from_vector(std::move(ids));
}

}  // namespace

DatasetPtr mirror(const DatasetPtr& in, const MirrorParams& p, Context& ctx) {
  if (p.axis == CutAxis::none) fail_usage("no axis is stated", "mirror axis", "write axis=x, y or z");
  const int axis = axis_number(p.axis);
  const Box3 box = bounds_over_all(*in, ctx);
  if (box.empty()) return in;
  const double position = p.position ? *p.position : std::abs(box.hi[axis]) < std::abs(box.lo[axis]) ? box.hi[axis] : box.lo[axis];
  if (!std::isfinite(position)) fail_usage("the position is not finite", "mirror position");
  if (!p.position) ctx.info(fmt::format("mirror: at {} = {}", "xyz"[axis], short_number(position)));
  const double hair = 1e-9 * box.diagonal();
  TransformParams flip;
  flip.scale[axis] = -1;
  flip.center = Vec3();
  (*flip.center)[axis] = position;
  const DatasetPtr image = transform(in, flip, ctx);
  for (const bool last : {true, false})
    if (const auto end = end_of(in->mesh(), axis, last); end && std::abs(*end - position) <= hair && end_of(image->mesh(), axis, last)) {
      const DatasetPtr other = numbered_as(*in, image);
      return last ? JoinedLattice(*in, *other, axis).dataset() : JoinedLattice(*other, *in, axis).dataset();
    }
  AppendParams together;
  together.part = false;
  const DatasetPtr both = append({in, image}, together, ctx);
  if (both->point_count() != 2 * in->point_count()) return both;
  std::vector<bool> in_mirror(in->point_count());
  DatasetParts out = both->parts();
  const auto mark = [&](const Points& points) {
    for (size_t i = 0; i < in_mirror.size(); ++i) in_mirror[i] = std::abs(points.origin[axis] + points.xyz.get(i, axis) - position) <= hair;
  };
  if (auto* m = std::get_if<UnstructuredMesh>(&out.mesh)) {
    mark(m->points);
    share_points(m->cells.connectivity, in_mirror);
    share_points(m->faces.connectivity, in_mirror);
  } else if (auto* s = std::get_if<SurfaceMesh>(&out.mesh)) {
    mark(s->points);
    for (CellArray* cells : {&s->vertices, &s->lines, &s->polygons, &s->strips}) share_points(cells->connectivity, in_mirror);
  } else {
    return both;
  }
  return make_dataset(std::move(out));
}

}  // namespace sg
