// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/merge_points.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>
#include <unordered_map>

#include "base/error.h"
#include "data/cells/cell_reader.h"
#include "data/field_ops.h"
#include "data/lattice.h"
#include "filter/mesh/select/extract.h"

namespace sg {

namespace {

const Points* points_of(const Mesh& m) {
  if (auto* u = std::get_if<UnstructuredMesh>(&m)) return &u->points;
  if (auto* s = std::get_if<SurfaceMesh>(&m)) return &s->points;
  if (auto* c = std::get_if<PointCloud>(&m)) return &c->points;
  return nullptr;
}

// For each point the one that it becomes; never a larger id.
std::vector<int64_t> equal_points(const std::vector<Vec3>& at) {
  std::vector<int64_t> order(at.size()), into(at.size());
  std::iota(order.begin(), order.end(), 0);
  auto less = [&](int64_t a, int64_t b) {
    const Vec3 &p = at[size_t(a)], &q = at[size_t(b)];
    if (p.x != q.x) return p.x < q.x;
    if (p.y != q.y) return p.y < q.y;
    if (p.z != q.z) return p.z < q.z;
    return a < b;
  };
  std::sort(order.begin(), order.end(), less);
  for (size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && at[size_t(order[i])] == at[size_t(order[i - 1])];
    into[size_t(order[i])] = same ? into[size_t(order[i - 1])] : order[i];
  }
  return into;
}

// Points that stay are listed by boxes as wide as the tolerance: a partner lies in the own box or one of the 26 around it.
std::vector<int64_t> near_points(const std::vector<Vec3>& at, double tolerance, Context& ctx) {
  struct Box {
    int64_t i, j, k;
    bool operator==(const Box&) const = default;
  };
  struct Hash {
    size_t operator()(const Box& b) const {
      return size_t(uint64_t(b.i) * 0x9e3779b97f4a7c15u ^ uint64_t(b.j) * 0xc2b2ae3d27d4eb4fu ^ uint64_t(b.k) * 0x165667b19e3779f9u);
    }
  };
  std::unordered_map<Box, std::vector<int64_t>, Hash> stay;
  std::vector<int64_t> into(at.size());
  for (size_t p = 0; p < at.size(); ++p) {
    if (p % 65536 == 0) ctx.check();
    const Box own{int64_t(std::floor(at[p].x / tolerance)), int64_t(std::floor(at[p].y / tolerance)),
                  int64_t(std::floor(at[p].z / tolerance))};
    int64_t best = int64_t(p);
    for (int n = 0; n < 27; ++n) {
      const auto found = stay.find({own.i + n % 3 - 1, own.j + n / 3 % 3 - 1, own.k + n / 9 - 1});
      if (found == stay.end()) continue;
      for (const int64_t q : found->second) {
        const Vec3 d = at[size_t(q)] - at[p];
        if (q < best && dot(d, d) <= tolerance * tolerance) best = q;
      }
    }
    into[p] = best;
    if (best == int64_t(p)) stay[own].push_back(best);
  }
  return into;
}

Array renamed(const Array& ids, const std::vector<int64_t>& into) {
  std::vector<int64_t> out(ids.count());
  const IndexView v = index_view(ids);
  for (size_t i = 0; i < out.size(); ++i) out[i] = into[size_t(v[i])];
  return Array::from_vector(std::move(out));
}

void rename_points(Mesh& mesh, const std::vector<int64_t>& into) {
  if (auto* u = std::get_if<UnstructuredMesh>(&mesh)) {
    u->cells.connectivity = renamed(u->cells.connectivity, into);
    if (!u->faces.connectivity.empty()) u->faces.connectivity = renamed(u->faces.connectivity, into);
  } else if (auto* s = std::get_if<SurfaceMesh>(&mesh)) {
    for (CellArray* a : {&s->vertices, &s->lines, &s->polygons, &s->strips})
      if (!a->connectivity.empty()) a->connectivity = renamed(a->connectivity, into);
  }
}

}  // namespace

DatasetPtr merge_points(const DatasetPtr& in, const MergePointsParams& p, Context& ctx) {
  if (is_lattice(in->mesh())) return in;
  const Points* points = points_of(in->mesh());
  if (!points)
    fail_usage(fmt::format("cannot work on a mesh of kind {}", in->kind()), "merge_points",
               "extract its cells first (threshold), or use resample");
  if (!std::isfinite(p.tolerance)) fail_usage("the tolerance is not finite", "merge_points tolerance");
  std::vector<Vec3> at(points->count());
  for (size_t i = 0; i < at.size(); ++i) at[i] = points->at(i);
  const Box3& box = in->bounds();
  const double size = box.empty() ? 0 : std::max({box.hi.x - box.lo.x, box.hi.y - box.lo.y, box.hi.z - box.lo.z});
  if (p.tolerance > 0 && size / p.tolerance > 1e15)
    fail_usage(fmt::format("{} is below the precision of the coordinates", p.tolerance), "merge_points tolerance",
               "use 0 to merge equal points");
  const std::vector<int64_t> into = p.tolerance > 0 ? near_points(at, p.tolerance, ctx) : equal_points(at);
  if (in->as<PointCloud>()) {
    std::vector<int64_t> kept;
    for (size_t i = 0; i < into.size(); ++i)
      if (into[i] == int64_t(i)) kept.push_back(int64_t(i));
    return extract_cells(in, kept, "merge_points");
  }
  DatasetParts parts = in->parts();
  rename_points(parts.mesh, into);
  const DatasetPtr named = make_dataset(std::move(parts));
  // Extraction keeps the cells that are still cells, and the points that these use.
  CellReader reader(named);
  std::vector<int64_t> cells;
  std::vector<int64_t> distinct;
  for (size_t c = 0; c < reader.count(); ++c) {
    reader.open(c);
    distinct.assign(reader.ids().begin(), reader.ids().end());
    std::sort(distinct.begin(), distinct.end());
    const auto n = size_t(std::unique(distinct.begin(), distinct.end()) - distinct.begin());
    if (n >= std::min<size_t>(size_t(reader.dimension()) + 1, reader.ids().size())) cells.push_back(int64_t(c));
  }
  if (cells.size() < reader.count())
    ctx.info(fmt::format("merge_points: {} cells collapsed and were removed", reader.count() - cells.size()));
  return extract_cells(named, cells, "merge_points");
}

}  // namespace sg
