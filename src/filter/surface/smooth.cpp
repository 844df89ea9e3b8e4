// SPDX-License-Identifier: Apache-2.0
#include "filter/surface/smooth.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "filter/surface/polygons.h"

namespace sg {

namespace {

using namespace surface;

// Whom each point follows.
struct Neighbors {
  std::vector<size_t> begin;
  std::vector<uint32_t> list;
};

Neighbors neighbors(const CellsView& polygons, const Edges& edges, const std::vector<Vec3>& at, const SmoothParams& p) {
  const std::vector<Vec3> area = vector_areas(polygons, at);
  const double cosine = std::cos(p.feature_angle * 3.14159265358979323846 / 180);
  std::vector<uint8_t> firm(edges.size(), 0);  // open, sharp or many-sided
  std::vector<uint32_t> lines(at.size(), 0);   // such edges at a point
  std::vector<uint8_t> fixed(at.size(), 0);
  for (size_t e = 0; e < edges.size(); ++e) {
    const auto u = edges.of(e);
    if (u.size() == 2) {
      const double sign = u[0].forward == u[1].forward ? -1 : 1;
      const Vec3 m = normalize(area[u[0].polygon]), n = normalize(area[u[1].polygon]) * sign;
      firm[e] = p.feature_angle < 180 && dot(m, n) < cosine - 1e-12 && m != Vec3() && n != Vec3();
    } else {
      firm[e] = 1;
      if (!p.border && u.size() == 1) fixed[edges.lo[e]] = fixed[edges.hi[e]] = 1;
    }
    if (firm[e]) ++lines[edges.lo[e]], ++lines[edges.hi[e]];
  }
  for (size_t i = 0; i < at.size(); ++i) fixed[i] = fixed[i] || (lines[i] != 0 && lines[i] != 2);
  auto follows = [&](uint32_t point, size_t e) { return !fixed[point] && (lines[point] == 0 || firm[e]); };
  Neighbors r;
  r.begin.assign(at.size() + 1, 0);
  for (size_t e = 0; e < edges.size(); ++e)
    r.begin[edges.lo[e]] += follows(edges.lo[e], e), r.begin[edges.hi[e]] += follows(edges.hi[e], e);
  r.list.resize(exclusive_scan(r.begin));
  std::vector<size_t> next = r.begin;
  for (size_t e = 0; e < edges.size(); ++e) {
    if (follows(edges.lo[e], e)) r.list[next[edges.lo[e]]++] = edges.hi[e];
    if (follows(edges.hi[e], e)) r.list[next[edges.hi[e]]++] = edges.lo[e];
  }
  return r;
}

void step(const Neighbors& n, const std::vector<Vec3>& from, std::vector<Vec3>& to, double factor, const Context& ctx) {
  parallel_for(
      from.size(), 1 << 13,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          to[i] = from[i];
          const size_t b = n.begin[i], e = n.begin[i + 1];
          if (b == e) continue;
          Vec3 sum;
          for (size_t k = b; k < e; ++k) sum += from[n.list[k]];
          to[i] += (sum / double(e - b) - from[i]) * factor;
        }
      },
      &ctx);
}

struct Body {
  double volume = 0;
  Vec3 moment;
};

// Volume and first moment of each component about `o`.
std::vector<Body> bodies(const CellsView& polygons, const Orientation& r, const std::vector<Vec3>& at, Vec3 o) {
  std::vector<Body> b(r.closed.size());
  for (size_t c = 0; c < polygons.count; ++c)
    for (size_t k = polygons.begin(c) + 1; k + 1 < polygons.end(c); ++k) {
      auto p = [&](size_t i) { return at[size_t(polygons.connectivity[i])] - o; };
      const Vec3 x = p(polygons.begin(c)), y = p(k), z = p(k + 1);
      const double v = (r.flip[c] ? -1 : 1) * dot(x, cross(y, z)) / 6;
      b[r.component[c]].volume += v;
      b[r.component[c]].moment += (x + y + z) * (v / 4);
    }
  return b;
}

// Closed components get back the volume that they had.
void restore_volumes(const CellsView& polygons, const Edges& edges, const std::vector<Vec3>& before, std::vector<Vec3>& at) {
  const Orientation r = orientation(polygons, edges, before, false);
  const Vec3 o = before.empty() ? Vec3() : before[0];
  const std::vector<Body> was = bodies(polygons, r, before, o), is = bodies(polygons, r, at, o);
  std::vector<uint32_t> owner(at.size(), UINT32_MAX);
  for (size_t c = 0; c < polygons.count; ++c)
    for (size_t k = polygons.begin(c); k < polygons.end(c); ++k) owner[size_t(polygons.connectivity[k])] = r.component[c];
  for (size_t i = 0; i < at.size(); ++i) {
    const uint32_t k = owner[i];
    if (k == UINT32_MAX || !r.closed[k] || !(was[k].volume * is[k].volume > 0)) continue;
    const Vec3 center = is[k].moment / is[k].volume + o;
    at[i] = center + (at[i] - center) * std::cbrt(was[k].volume / is[k].volume);
  }
}

}  // namespace

DatasetPtr smooth(const DatasetPtr& in, const SmoothParams& p, Context& ctx) {
  if (!(p.lambda > 0) || !(p.pass_band < 1 / p.lambda))
    fail_usage(fmt::format("pass_band {} is not below 1/lambda = {}", p.pass_band, p.lambda > 0 ? 1 / p.lambda : HUGE_VAL), "smooth",
               "choose lambda between 0 and 1, pass_band about 0.1");
  const DatasetPtr s = polygon_surface(in, "smooth", ctx);
  SurfaceMesh mesh = *s->as<SurfaceMesh>();
  std::vector<Vec3> at = positions(mesh.points);
  const std::vector<uint32_t> same = equal_places(at);
  std::vector<int32_t> ids(mesh.polygons.connectivity.count());
  const IndexView v = index_view(mesh.polygons.connectivity);
  for (size_t k = 0; k < ids.size(); ++k) ids[k] = int32_t(same[size_t(v[k])]);
  const CellArray joined{Array::from_vector(std::move(ids)), mesh.polygons.offsets, mesh.polygons.fixed};
  const CellsView polygons = cells_view(joined);
  const Edges edges = edges_of_polygons(polygons, at.size());
  const Neighbors n = neighbors(polygons, edges, at, p);
  const double mu = 1 / (p.pass_band - 1 / p.lambda);
  const std::vector<Vec3> before = at;
  std::vector<Vec3> other(at.size());
  for (int i = 0; i < p.iterations; ++i) {
    step(n, at, other, p.lambda, ctx);
    step(n, other, at, mu, ctx);
  }
  if (p.keep_volume && p.iterations > 0) restore_volumes(polygons, edges, before, at);
  DatasetParts out = s->parts();
  // Positions keep their type and origin.
  auto write = [&]<class T>(T*) {
    T* to = nullptr;
    Array a = Array::make<T>(at.size(), 3, &to);
    for (size_t i = 0; i < at.size(); ++i)
      for (int c = 0; c < 3; ++c) to[3 * i + size_t(c)] = T(at[same[i]][c] - mesh.points.origin[c]);
    mesh.points.xyz = a;
  };
  if (mesh.points.xyz.type() == ElementType::f32) write(static_cast<float*>(nullptr));
  else write(static_cast<double*>(nullptr));
  while (const Field* f = out.fields.with_role(Role::normals)) {
    ctx.info(fmt::format("smooth: field '{}' is no longer valid and is dropped", f->name));
    out.fields.remove(std::string(f->name), f->association);
  }
  out.mesh = std::move(mesh);
  return make_dataset(std::move(out));
}

}  // namespace sg
