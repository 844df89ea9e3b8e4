// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/texture/surface/refined_surface.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "base/error.h"
#include "base/parallel.h"
#include "data/field_ops.h"
#include "filter/mesh/surface.h"

namespace sg {

namespace {

constexpr size_t triangles_per_chunk = 1 << 14;
using Triangle = std::array<uint32_t, 3>;

struct Work {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  std::vector<uint32_t> cells;
  FieldSet fields;  // on the points
};

/// Number of the edge (a, b) in a list of pairs in ascending order, or -1.
class EdgeList {
 public:
  EdgeList(std::vector<EdgePoint> edges, size_t points) : edges_(std::move(edges)), begin_(points + 1, 0) {
    for (const EdgePoint& e : edges_) ++begin_[e.a + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  }
  int64_t operator()(uint32_t a, uint32_t b) const {
    if (a > b) std::swap(a, b);
    const auto first = edges_.begin() + ptrdiff_t(begin_[a]), last = edges_.begin() + ptrdiff_t(begin_[a + 1]);
    const auto it = std::lower_bound(first, last, b, [](const EdgePoint& e, uint32_t q) { return e.b < q; });
    return it != last && it->b == b ? it - edges_.begin() : -1;
  }
  const std::vector<EdgePoint>& edges() const { return edges_; }

 private:
  std::vector<EdgePoint> edges_;
  std::vector<size_t> begin_;
};

std::vector<EdgePoint> long_edges(const Work& w, double longest) {
  std::vector<uint64_t> keys;
  for (const Triangle& t : w.triangles)
    for (int k = 0; k < 3; ++k) {
      const uint32_t a = t[size_t(k)], b = t[size_t((k + 1) % 3)];
      if (length(w.points[a] - w.points[b]) > longest) keys.push_back(uint64_t(std::min(a, b)) << 32 | std::max(a, b));
    }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  std::vector<EdgePoint> edges;
  for (const uint64_t k : keys) edges.push_back({uint32_t(k >> 32), uint32_t(k), 0.5f});
  return edges;
}

/// One round: every edge that is too long gets a point in its middle, every triangle is cut to fit.
void split_round(Work& w, EdgeList split) {
  const auto first = uint32_t(w.points.size());
  std::vector<Triangle> out;
  std::vector<uint32_t> cells;
  for (size_t i = 0; i < w.triangles.size(); ++i) {
    Triangle t = w.triangles[i];
    int64_t e[3];  // on the edge behind each corner
    for (size_t k = 0; k < 3; ++k) e[k] = split(t[k], t[(k + 1) % 3]);
    const auto put = [&](uint32_t a, uint32_t b, uint32_t c) { out.push_back({a, b, c}), cells.push_back(w.cells[i]); };
    const int n = (e[0] >= 0) + (e[1] >= 0) + (e[2] >= 0);
    if (n == 0) {
      put(t[0], t[1], t[2]);
      continue;
    }
    // Turned so that with one edge it is the first, with two the last one stays whole.
    while (n == 1 ? e[0] < 0 : n == 2 && e[2] >= 0) std::rotate(t.begin(), t.begin() + 1, t.end()), std::rotate(e, e + 1, e + 3);
    const uint32_t m0 = first + uint32_t(e[0]), m1 = first + uint32_t(e[1]), m2 = first + uint32_t(e[2]);
    if (n == 1) {
      put(t[0], m0, t[2]), put(m0, t[1], t[2]);
    } else if (n == 3) {
      put(t[0], m0, m2), put(m0, t[1], m1), put(m2, m1, t[2]), put(m0, m1, m2);
    } else {
      put(m0, t[1], m1);  // and of the two ways to cut the rest the shorter
      const double a = length(w.points[t[0]] - (w.points[t[1]] + w.points[t[2]]) * 0.5),
                   b = length(w.points[t[2]] - (w.points[t[0]] + w.points[t[1]]) * 0.5);
      if (a < b) put(t[0], m0, m1), put(t[0], m1, t[2]);
      else put(t[0], m0, t[2]), put(m0, m1, t[2]);
    }
  }
  w.triangles = std::move(out), w.cells = std::move(cells);
  const std::vector<EdgePoint>& edges = split.edges();
  std::vector<EdgePoint> all(first + edges.size());
  for (uint32_t p = 0; p < first; ++p) all[p] = {p, p, 0};
  std::copy(edges.begin(), edges.end(), all.begin() + first);
  w.points.reserve(all.size());
  for (const EdgePoint& e : edges) w.points.push_back((w.points[e.a] + w.points[e.b]) * 0.5);
  FieldSet fields;
  carry_interpolated(fields, w.fields, all);
  w.fields = std::move(fields);
}

/// For each point the smallest number of a point at its very place.
std::vector<uint32_t> same_places(const std::vector<Vec3>& points) {
  std::vector<uint32_t> order, same(points.size());
  std::iota(same.begin(), same.end(), 0u);
  for (const uint32_t i : same)
    if (std::isfinite(dot(points[i], points[i]))) order.push_back(i);
  const auto key = [&](uint32_t i) { return std::tie(points[i].x, points[i].y, points[i].z); };
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  for (size_t i = 0; i < order.size(); ++i)
    same[order[i]] = i > 0 && points[order[i]] == points[order[i - 1]] ? same[order[i - 1]] : order[i];
  return same;
}

/// Edges that two triangles share; of those that more share, none is passed.
std::vector<std::array<int32_t, 3>> neighbors(const std::vector<Triangle>& triangles) {
  struct Side {
    uint64_t key;
    uint32_t place;  // 3 * triangle + the corner opposite
  };
  std::vector<Side> sides(3 * triangles.size());
  parallel_for(triangles.size(), triangles_per_chunk, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t a = triangles[i][(k + 1) % 3], b = triangles[i][(k + 2) % 3];
        sides[3 * i + k] = {uint64_t(std::min(a, b)) << 32 | std::max(a, b), uint32_t(3 * i + k)};
      }
  });
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.key != b.key ? a.key < b.key : a.place < b.place; });
  std::vector<std::array<int32_t, 3>> across(triangles.size(), {-1, -1, -1});
  for (size_t i = 0; i < sides.size();) {
    size_t j = i;
    while (j < sides.size() && sides[j].key == sides[i].key) ++j;
    if (j == i + 2) {
      const uint32_t p = sides[i].place, q = sides[i + 1].place;
      across[p / 3][p % 3] = int32_t(q / 3), across[q / 3][q % 3] = int32_t(p / 3);
    }
    i = j;
  }
  return across;
}

Work start(const DatasetPtr& surface, Vec3 origin) {
  const SurfaceMesh& mesh = *surface->as<SurfaceMesh>();
  Work w;
  const Triangles t = triangles_of(mesh);
  w.points.resize(mesh.points.count());
  parallel_for(w.points.size(), triangles_per_chunk, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) w.points[i] = mesh.points.at(i) - origin;
  });
  for (size_t i = 0; i < t.count(); ++i) {
    const Triangle q{t.indices[3 * i], t.indices[3 * i + 1], t.indices[3 * i + 2]};
    const Vec3 n = cross(w.points[q[1]] - w.points[q[0]], w.points[q[2]] - w.points[q[0]]);
    if (!(dot(n, n) > 0 && dot(n, n) < HUGE_VAL)) continue;  // of no area, or without a place
    w.triangles.push_back(q), w.cells.push_back(t.cell(i));
  }
  for (const Field& f : surface->fields())
    if (f.association == Association::point) w.fields.add(f);
  return w;
}

}  // namespace

double textured_edge(const Dataset& surface, double diagonal, std::optional<double> density) {
  if (density) return *density > 0 ? diagonal / *density : 0;
  constexpr double samples = 400, triangles = 150'000;
  const SurfaceMesh& mesh = *surface.as<SurfaceMesh>();
  double area = 0;  // of the faces as fans, and of strips: near enough
  for (const CellArray* list : {&mesh.polygons, &mesh.strips}) {
    const CellsView cells = cells_view(*list);
    for (size_t c = 0; c < cells.count; ++c)
      for (size_t k = 1; k + 1 < cells.size(c); ++k) {
        const size_t first = list == &mesh.strips ? k - 1 : 0;
        const Vec3 o = mesh.points.at(size_t(cells.point(c, first)));
        area += 0.5 * length(cross(mesh.points.at(size_t(cells.point(c, k))) - o, mesh.points.at(size_t(cells.point(c, k + 1))) - o));
      }
  }
  const double longest = diagonal / samples, coarse = std::sqrt(area / (0.3 * triangles));
  return std::isfinite(coarse) ? std::max(longest, coarse) : longest;
}

RefinedSurface refine_surface(const DatasetPtr& surface, double longest, size_t most, Context& context) {
  RefinedSurface r;
  r.origin = surface->as<SurfaceMesh>()->points.origin;
  Work w = start(surface, r.origin);
  if (longest > 0) {
    // Each triangle becomes about its area / (0.3 longest^2).
    double expected = 0;
    for (const Triangle& t : w.triangles)
      expected += 1 + 0.5 * length(cross(w.points[t[1]] - w.points[t[0]], w.points[t[2]] - w.points[t[0]])) / (0.3 * longest * longest);
    const auto refuse = [&](double n) {
      fail_usage(fmt::format("about {:.3g} triangles would be needed", n), "density", "give a smaller density");
    };
    if (expected > double(most)) refuse(expected);
    for (int round = 0; round < 64; ++round) {
      context.check();
      std::vector<EdgePoint> edges = long_edges(w, longest);
      if (edges.empty()) break;
      split_round(w, EdgeList(std::move(edges), w.points.size()));
      if (w.triangles.size() > most) refuse(double(w.triangles.size()));
    }
  }
  SurfaceMesh mesh;
  float* xyz = nullptr;
  mesh.points.xyz = Array::make<float>(w.points.size(), 3, &xyz), mesh.points.origin = r.origin;
  for (size_t i = 0; i < w.points.size(); ++i)
    for (int c = 0; c < 3; ++c) xyz[3 * i + size_t(c)] = float(w.points[i][c]);
  int32_t* corners = nullptr;
  mesh.polygons.connectivity = Array::make<int32_t>(3 * w.triangles.size(), 1, &corners), mesh.polygons.fixed = 3;
  for (size_t i = 0; i < w.triangles.size(); ++i)
    for (size_t k = 0; k < 3; ++k) corners[3 * i + k] = int32_t(w.triangles[i][k]);
  carry_gathered(w.fields, surface->fields(), Association::cell, w.cells, Association::cell);
  carry_whole(w.fields, surface->fields());
  DatasetParts parts;
  parts.mesh = std::move(mesh), parts.fields = std::move(w.fields), parts.time = surface->time(), parts.notes = surface->notes();
  r.dataset = make_dataset(std::move(parts));

  const std::vector<uint32_t> same = same_places(w.points);
  r.points = std::move(w.points), r.triangles = std::move(w.triangles);
  double sum = 0;
  for (Triangle& t : r.triangles) {
    for (uint32_t& p : t) p = same[p];
    for (size_t k = 0; k < 3; ++k) sum += length(r.points[t[k]] - r.points[t[(k + 1) % 3]]);
  }
  r.edge_length = r.triangles.empty() ? 0 : sum / (3 * double(r.triangles.size()));
  r.across = neighbors(r.triangles);
  return r;
}

}  // namespace sg
