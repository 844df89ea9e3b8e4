// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/warp/warp.h"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text/round_number.h"
#include "base/text/text.h"
#include "data/lattice.h"
#include "data/ranks/over_all.h"
#include "filter/mesh/transform/moved_lattice.h"

namespace sg {

namespace {

constexpr size_t points_per_chunk = 1 << 14;

bool is_vector(const Field& f) { return f.components() == 2 || f.components() == 3; }

const Field& displacing_field(const Dataset& d, const FieldName& name) {
  if (!name.empty()) {
    const Field& f = d.fields().require(name.name);
    if (f.association != Association::point)
      fail_usage(fmt::format("field '{}' is not on points", f.name), "warp field", "average it to points before: -f cell_to_point");
    if (!is_vector(f) && f.components() != 1)
      fail_usage(fmt::format("field '{}' has {} components", f.name, f.components()), "warp field", "1, 2 or 3 displace a point");
    return f;
  }
  const Field *vectors = nullptr, *scalar = nullptr;
  for (const Field& f : d.fields()) {
    if (f.association != Association::point || f.role == Role::normals || f.role == Role::colors) continue;
    if (is_vector(f) && to_lower(f.name).starts_with("disp")) return f;
    if (is_vector(f) && (!vectors || (f.role == Role::vectors && vectors->role != Role::vectors))) vectors = &f;
    if (f.components() == 1 && (!scalar || (f.role == Role::scalars && scalar->role != Role::scalars))) scalar = &f;
  }
  if (!vectors && !scalar) fail_usage("no field of points could displace them", "warp", "average one of cells: -f cell_to_point");
  return vectors ? *vectors : *scalar;
}

// A factor that shows the deformation: 1 where the largest displacement is between a fiftieth and half of the size.
double visible_scale(const Dataset& d, const Field& f, const Context& context) {
  const Range r = range_over_all(d, f, -1, context);
  const double size = bounds_over_all(d, context).diagonal();
  const double most = r.empty() ? 0 : is_vector(f) ? r.hi : f.components() == 1 ? r.hi - r.lo : 0;
  if (!(most > 0) || !(size > 0) || (most > 0.02 * size && most < 0.5 * size)) return 1;
  return round_near(0.1 * size / most, 0.03 * size / most);
}

// Scalars: where each point goes by a value of one.
class Directions {
 public:
  Directions(const Dataset& d, const std::optional<Vec3>& stated, const Context& context) {
    if (stated) {
      if (!(length(*stated) > 0)) fail_usage("the direction is zero", "warp direction", "give one, e.g. direction=0,0,1");
      fixed_ = normalize(*stated);
      return;
    }
    const Vec3 s = bounds_over_all(d, context).size();
    const double flat = 1e-6 * std::max({s.x, s.y, s.z});
    for (int a = 2; a >= 0; --a)
      if (s[a] <= flat) {
        fixed_[a] = 1;
        return;
      }
    normals_ = d.fields().with_role(Role::normals);
    if (!normals_ || normals_->association != Association::point || normals_->components() != 3)
      fail_usage("a scalar needs a direction to displace points", "warp",
                 "give one, e.g. direction=0,0,1, or find normals before: -f normals");
  }
  Vec3 at(size_t i) const {
    if (!normals_) return fixed_;
    const Array& a = normals_->array;
    const Vec3 n{a.get(i, 0), a.get(i, 1), a.get(i, 2)};
    return length(n) > 0 ? normalize(n) : Vec3();
  }

 private:
  Vec3 fixed_;
  const Field* normals_ = nullptr;
};

// x' - x of every point; those without a finite value are counted and stay.
class Displacement {
 public:
  Displacement(const Field& f, double scale, const Directions* along) : values_(f.array), scale_(scale), along_(along) {}
  Vec3 operator()(size_t i) const {
    Vec3 u;
    if (along_) {
      u = along_->at(i) * values_.get(i);
    } else {
      for (int c = 0; c < values_.components(); ++c) u[c] = values_.get(i, c);
    }
    u = u * scale_;
    if (std::isfinite(u.x + u.y + u.z)) return u;
    ++still_;
    return {};
  }
  size_t still() const { return still_; }

 private:
  const Array& values_;
  double scale_;
  const Directions* along_;
  mutable std::atomic<size_t> still_ = 0;
};

Points displaced(const Points& in, const Displacement& u) {
  Points r;
  r.origin = in.origin;
  std::byte* out = nullptr;
  r.xyz = Array::make_raw(in.xyz.type(), in.xyz.count(), 3, &out);
  dispatch(in.xyz, [&](auto v) {
    using T = std::remove_cvref_t<decltype(v[0])>;
    T* to = reinterpret_cast<T*>(out);
    parallel_for(v.count, points_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const Vec3 d = u(i);
        for (int c = 0; c < 3; ++c) to[3 * i + size_t(c)] = T(double(v(i, c)) + d[c]);
      }
    });
  });
  return r;
}

Mesh displaced_mesh(const Mesh& mesh, const Displacement& u) {
  return std::visit(
      [&](const auto& m) -> Mesh {
        using M = std::remove_cvref_t<decltype(m)>;
        if constexpr (std::is_same_v<M, AmrGrid>) {
          fail_usage("an AMR grid cannot be bent", "warp", "take faces, a slice or a contour first");
        } else if constexpr (requires { m.points; }) {
          M r = m;
          r.points = displaced(m.points, u);
          return r;
        } else {
          CurvilinearGrid r = moved_lattice(mesh, [&](size_t i, Vec3 p) { return p + u(i); });
          r.extent_start = m.extent_start;
          return r;
        }
      },
      mesh);
}

}  // namespace

double choose_warp_scale(const Dataset& in, const WarpParams& p, const Context& context) {
  const Field& f = displacing_field(in, p.field);
  const double scale = visible_scale(in, f, context);
  context.info(fmt::format("warp: displaced by {} times '{}'", short_number(scale), f.name));
  return scale;
}

DatasetPtr warp(const DatasetPtr& in, const WarpParams& p, Context& context) {
  const Field& f = displacing_field(*in, p.field);
  const bool vectors = is_vector(f);
  if (vectors && p.direction)
    fail_usage(fmt::format("vectors '{}' have directions of their own", f.name), "warp direction", "leave it out");
  const double scale = p.scale ? *p.scale : choose_warp_scale(*in, p, context);
  if (!std::isfinite(scale)) fail_usage("the scale is not finite", "warp scale");
  const std::optional<Directions> along = vectors ? std::nullopt : std::optional<Directions>(std::in_place, *in, p.direction, context);
  const Displacement u(f, scale, along ? &*along : nullptr);
  DatasetParts out = in->parts();
  out.mesh = displaced_mesh(in->mesh(), u);
  if (u.still() > 0) context.warn(fmt::format("warp: {} points without a finite value of '{}' stay where they are", u.still(), f.name));
  FieldSet kept;
  for (const Field& field : out.fields)
    if (field.role != Role::normals) kept.add(field);
  out.fields = std::move(kept);
  return make_dataset(std::move(out));
}

}  // namespace sg
