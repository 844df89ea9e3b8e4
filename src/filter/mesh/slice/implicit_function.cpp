// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/slice/implicit_function.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "data/lattice.h"
#include "data/ranks/over_all.h"
#include "filter/field/calc/calc.h"
#include "filter/mesh/slice/lasso_region.h"
#include "filter/mesh/surface.h"
#include "filter/mesh/surface_builder.h"
#include "index/cell_locator.h"

namespace sg {

namespace {

constexpr size_t block = 2048;

template <class F>
ImplicitFunction by_point(std::string text, F f) {
  ImplicitFunction r;
  r.text = std::move(text);
  r.evaluate = [f](std::span<const Vec3> at, std::span<double> out) {
    for (size_t i = 0; i < at.size(); ++i) out[i] = f(at[i]);
  };
  return r;
}

Vec3 unit(Vec3 n, std::string_view who, std::string_view what) {
  // Dividing by the largest part first keeps tiny and huge directions from vanishing in the square.
  const double largest = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
  if (!(largest > 0) || !std::isfinite(largest))
    fail_usage(fmt::format("the {} is {}", what, largest == 0 ? "zero" : "not finite"), fmt::format("{} {}", who, what),
               fmt::format("give a direction, e.g. {}=0,0,1", what));
  return normalize(n / largest);
}

void need(const std::vector<double>& v, size_t n, std::string_view who, std::string_view what, std::string_view like) {
  if (v.size() != n) fail_usage(fmt::format("needs {} numbers, not {}", n, v.size()), fmt::format("{} {}", who, what), std::string(like));
  for (const double x : v)
    if (!std::isfinite(x)) fail_usage("a number is not finite", fmt::format("{} {}", who, what), std::string(like));
}

double radius(double r, std::string_view who, std::string_view what) {
  if (!(r > 0)) fail_usage(fmt::format("the radius {} is not positive", short_number(r)), fmt::format("{} {}", who, what));
  return r;
}

ImplicitFunction plane_of(const ImplicitParams& p, const Dataset& in, std::string_view who, const Context& ctx) {
  const bool stated = p.origin || p.position;
  const Box3 bounds = stated ? in.bounds() : bounds_over_all(in, ctx);
  const bool shorthand = p.axis != CutAxis::none;
  if (p.position && !shorthand)
    fail_usage("position needs an axis", std::string(who), fmt::format("write axis=z position={}", short_number(*p.position)));
  if (shorthand && p.origin)
    fail_usage("axis and origin are both given", std::string(who), "give either axis and position, or origin and normal");
  Vec3 origin = p.origin.value_or(bounds.empty() ? Vec3() : bounds.center()), normal = p.normal;
  if (shorthand) {
    const int a = axis_number(p.axis);
    normal = {};
    normal[a] = 1;
    if (p.position) origin[a] = *p.position;
  }
  normal = unit(normal, who, "normal");
  for (int a = 0; a < 3; ++a)
    if (!std::isfinite(origin[a])) fail_usage("the plane's position is not finite", std::string(who));
  return plane_function(origin, normal, bounds);
}

ImplicitFunction expression(const std::string& text, const DatasetPtr& in, Context& ctx) {
  CalcParams p;
  p.expr = text;
  p.name = "f";
  p.on = CalcPlace::point;
  auto at_places = [p](std::span<const Vec3> at, std::span<double> out) {
    std::vector<double> xyz;
    for (const Vec3& v : at) xyz.insert(xyz.end(), {v.x, v.y, v.z});
    PointCloud cloud;
    cloud.points.xyz = Array::from_vector(std::move(xyz), 3);
    Context quiet;
    const DatasetPtr r = calc(make_dataset(std::move(cloud)), p, quiet);
    const Array& a = r->fields().require("f", Association::point).array;
    for (size_t i = 0; i < at.size(); ++i) out[i] = a.get(i);
  };
  ImplicitFunction r;
  r.text = "a function";
  try {
    const Vec3 somewhere = in->bounds().empty() ? Vec3(1, 2, 3) : in->bounds().lo;
    double value = 0;
    at_places({&somewhere, 1}, {&value, 1});
    if (in->fields().find("x") || in->fields().find("y") || in->fields().find("z")) throw Error(ErrorKind::usage, "fields come first");
    r.evaluate = at_places;
  } catch (const Error&) {  // it names fields: linear between the points of the mesh
    const DatasetPtr values = calc(in, p, ctx);
    r.known = values->fields().require("f", Association::point).array.converted(ElementType::f64);
    if (r.known.components() != 1) fail_usage("the expression yields a vector", "function", "it must yield a single number, e.g. mag(v)-1");
  }
  return r;
}

// Distance from a closed surface; inside by the parity of crossings along a ray, for solids by their cells.
ImplicitFunction distance_from(const DatasetPtr& mesh, std::string_view who, Context& ctx) {
  if (mesh->cell_count() == 0) fail_usage("the second mesh has no cells", std::string(who));
  if (mesh->as<PointCloud>()) fail_usage("a point cloud has no inside", std::string(who), "give a closed surface or a solid mesh");
  const DatasetPtr skin = surface_of(mesh, ctx);
  const SurfaceMesh* s = skin->as<SurfaceMesh>();
  if (!s || s->polygons.size() + s->strips.size() == 0) fail_usage("the second mesh has no surface", std::string(who));
  auto locator = std::make_shared<CellLocator>(skin, ctx);
  const double size = std::max(skin->bounds().diagonal(), 1e-300);
  ImplicitFunction r;
  r.text = "the second mesh";
  r.evaluate = [locator, size](std::span<const Vec3> at, std::span<double> out) {
    LocatorCursor cursor(*locator);
    const Vec3 d = normalize(Vec3(0.8123, 0.3217, 0.4866));  // along no likely edge or face
    for (size_t i = 0; i < at.size(); ++i) {
      const NearestPlace near = cursor.nearest(at[i]);
      bool inside = false;
      double t = 0;
      for (int hits = 0; hits < 10000; ++hits) {
        const auto hit = cursor.first_hit(at[i], d, t, HUGE_VAL);
        if (!hit) break;
        inside = !inside;
        t = hit->t + 1e-9 * size;
      }
      out[i] = (inside ? -1 : 1) * std::sqrt(std::max(near.distance2, 0.0));
    }
  };
  return r;
}

}  // namespace

ImplicitFunction plane_function(Vec3 origin, Vec3 normal, const Box3& bounds) {
  double reach = 0;
  for (int a = 0; a < 3 && !bounds.empty(); ++a)
    reach = std::max({reach, std::abs(bounds.lo[a] - origin[a]), std::abs(bounds.hi[a] - origin[a]), std::abs(origin[a])});
  // Below this, distances are rounding: the point lies in the plane.
  const double snap = 4 * std::numeric_limits<double>::epsilon() * reach;
  ImplicitFunction r = by_point("a plane", [=](Vec3 x) {
    const double d = dot(normal, x - origin);
    return std::abs(d) <= snap ? 0.0 : d;
  });
  r.plane = true;
  r.origin = origin;
  r.normal = normal;
  r.snap = snap;
  return r;
}

Vec3 ImplicitFunction::gradient(Vec3 p, double step) const {
  if (plane) return normal;
  if (!evaluate) return {};
  Vec3 at[6];
  double v[6];
  for (int a = 0; a < 3; ++a) {
    at[2 * a] = at[2 * a + 1] = p;
    at[2 * a][a] -= step, at[2 * a + 1][a] += step;
  }
  evaluate(at, v);
  return Vec3(v[1] - v[0], v[3] - v[2], v[5] - v[4]) * (0.5 / step);
}

ImplicitFunction implicit_function(const ImplicitParams& p, const DatasetPtr& in, const DatasetPtr& surface, std::string_view who,
                                   Context& ctx) {
  std::vector<std::string> given;
  for (const auto& [name, list] :
       {std::pair{"sphere", &p.sphere}, {"cylinder", &p.cylinder}, {"box", &p.box}, {"lasso", &p.lasso}, {"quadric", &p.quadric}})
    if (!list->empty()) given.push_back(name);
  if (!p.function.empty()) given.push_back("function");
  if (surface) given.push_back("a second mesh");
  if (p.origin || p.position || p.axis != CutAxis::none) given.push_back("a plane");
  if (given.size() > 1) fail_usage(fmt::format("{} and {} are both given", given[0], given[1]), std::string(who), "give only one shape");
  if (surface) return distance_from(surface, who, ctx);
  if (!p.function.empty()) return with_context(fmt::format("{} function", who), [&] { return expression(p.function, in, ctx); });
  if (!p.sphere.empty()) {
    need(p.sphere, 4, who, "sphere", "give x,y,z,radius, e.g. 0,0,0,1");
    const Vec3 c(p.sphere[0], p.sphere[1], p.sphere[2]);
    const double r = radius(p.sphere[3], who, "sphere");
    return by_point("a sphere", [=](Vec3 x) { return length(x - c) - r; });
  }
  if (!p.cylinder.empty()) {
    need(p.cylinder, 7, who, "cylinder", "give x,y,z, direction and radius, e.g. 0,0,0,0,0,1,0.5");
    const Vec3 c(p.cylinder[0], p.cylinder[1], p.cylinder[2]);
    const Vec3 d = unit(Vec3(p.cylinder[3], p.cylinder[4], p.cylinder[5]), who, "direction");
    const double r = radius(p.cylinder[6], who, "cylinder");
    return by_point("a cylinder", [=](Vec3 x) { return length(cross(x - c, d)) - r; });
  }
  if (!p.box.empty()) {
    need(p.box, 6, who, "box", "give x0,x1,y0,y1,z0,z1, e.g. 0,1,0,1,0,1");
    const Vec3 lo(p.box[0], p.box[2], p.box[4]), hi(p.box[1], p.box[3], p.box[5]);
    for (int a = 0; a < 3; ++a)
      if (!(lo[a] < hi[a]))
        fail_usage(fmt::format("the box is empty along {}: {} to {}", "xyz"[a], short_number(lo[a]), short_number(hi[a])),
                   fmt::format("{} box", who), "give the smaller number first: x0,x1,y0,y1,z0,z1");
    return by_point("a box", [=](Vec3 x) {
      Vec3 out;
      double deepest = -HUGE_VAL;
      for (int a = 0; a < 3; ++a) {
        const double d = std::max(lo[a] - x[a], x[a] - hi[a]);
        deepest = std::max(deepest, d);
        out[a] = std::max(d, 0.0);
      }
      return deepest > 0 ? length(out) : deepest;
    });
  }
  if (!p.lasso.empty() || p.lasso_eye) {
    if (p.lasso.empty()) fail_usage("lasso_eye needs a lasso", std::string(who), "give the corners of the outline, too");
    const auto region = std::make_shared<const LassoRegion>(p.lasso, p.lasso_eye, who);
    return by_point("a lasso", [region](Vec3 x) { return region->distance(x); });
  }
  if (!p.quadric.empty()) {
    need(p.quadric, 10, who, "quadric", "give ten numbers: xx,yy,zz,xy,yz,xz,x,y,z,1");
    bool any = false;
    for (size_t i = 0; i < 9; ++i) any = any || p.quadric[i] != 0;
    if (!any) fail_usage("the quadric is constant", fmt::format("{} quadric", who), "one of the first nine numbers must not be zero");
    return by_point("a quadric", [q = p.quadric](Vec3 v) {
      return q[0] * v.x * v.x + q[1] * v.y * v.y + q[2] * v.z * v.z + q[3] * v.x * v.y + q[4] * v.y * v.z + q[5] * v.x * v.z + q[6] * v.x +
             q[7] * v.y + q[8] * v.z + q[9];
    });
  }
  return plane_of(p, *in, who, ctx);
}

Array values_at_points(const ImplicitFunction& f, const DatasetPtr& in, Context& ctx) {
  if (!f.evaluate) return f.known;
  double* out = nullptr;
  const size_t n = in->point_count();
  Array r = Array::make<double>(n, 1, &out);
  auto fill = [&](auto&& at) {
    parallel_for(
        n, 8 * block,
        [&](size_t begin, size_t end) {
          std::vector<Vec3> places(block);
          for (size_t i = begin; i < end; i += block) {
            const size_t count = std::min(block, end - i);
            at(i, count, places.data());
            f.evaluate({places.data(), count}, {out + i, count});
          }
        },
        &ctx);
  };
  if (is_lattice(in->mesh())) {
    const Lattice lattice(in->mesh());
    const LatticeView& v = lattice.view();
    fill([&](size_t first, size_t count, Vec3* to) {
      size_t i = first % v.dims[0], j = first / v.dims[0] % v.dims[1], k = first / (v.dims[0] * v.dims[1]);
      for (size_t c = 0; c < count; ++c) {
        to[c] = v.position(i, j, k);
        if (++i == v.dims[0]) i = 0, ++j;
        if (j == v.dims[1]) j = 0, ++k;
      }
    });
    return r;
  }
  const Points* points = nullptr;
  if (auto* u = in->as<UnstructuredMesh>()) points = &u->points;
  else if (auto* s = in->as<SurfaceMesh>()) points = &s->points;
  else if (auto* c = in->as<PointCloud>()) points = &c->points;
  else fail_internal("values_at_points: an AMR grid has no points of its own");
  const PointReader reader(*points);
  fill([&](size_t first, size_t count, Vec3* to) {
    for (size_t c = 0; c < count; ++c) to[c] = reader[first + c];
  });
  return r;
}

void find_zeros(const ImplicitFunction& f, std::span<const Vec3> from, std::span<const Vec3> to, std::span<double> t) {
  if (!f.evaluate || f.plane) return;
  parallel_for(t.size(), block, [&](size_t begin, size_t end) {
    const size_t n = end - begin;
    std::vector<Vec3> at(n);
    std::vector<double> lo(n, 0.0), hi(n, 1.0), flo(n), fhi(n), x(n), fx(n);
    std::vector<int8_t> side(n, 0);
    f.evaluate(from.subspan(begin, n), flo);
    f.evaluate(to.subspan(begin, n), fhi);
    for (size_t i = 0; i < n; ++i) x[i] = t[begin + i];
    for (int round = 0; round < 60; ++round) {
      bool busy = false;
      for (size_t i = 0; i < n; ++i) at[i] = lerp(from[begin + i], to[begin + i], x[i]);
      f.evaluate(at, fx);
      for (size_t i = 0; i < n; ++i) {
        if (!((flo[i] < 0) != (fhi[i] < 0)) || side[i] == 3) continue;
        if (fx[i] == 0 || !(hi[i] - lo[i] > 4e-16)) {
          side[i] = 3;
          continue;
        }
        const double before = x[i];
        if ((fx[i] < 0) == (flo[i] < 0)) {
          lo[i] = x[i], flo[i] = fx[i];
          if (side[i] == 1) fhi[i] *= 0.5;
          side[i] = 1;
        } else {
          hi[i] = x[i], fhi[i] = fx[i];
          if (side[i] == 2) flo[i] *= 0.5;
          side[i] = 2;
        }
        double next = round < 40 ? lo[i] + (hi[i] - lo[i]) * (flo[i] / (flo[i] - fhi[i])) : 0.5 * (lo[i] + hi[i]);
        if (!(next > lo[i] && next < hi[i])) next = 0.5 * (lo[i] + hi[i]);
        x[i] = next;
        if (std::abs(next - before) <= 1e-16) side[i] = 3;
        else busy = true;
      }
      if (!busy) break;
    }
    for (size_t i = 0; i < n; ++i)
      if (x[i] >= 0 && x[i] <= 1) t[begin + i] = x[i];
  });
}

}  // namespace sg
