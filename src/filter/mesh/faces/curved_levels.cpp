// SPDX-License-Identifier: Apache-2.0
// How finely CurvedSkin splits faces and curves: their shape functions on a grid, halved until straight pieces are near enough.
#include <climits>

#include "data/cells/cell_topology.h"
#include "filter/mesh/faces/curved_work.h"

namespace sg::detail {

namespace {

constexpr int most_segments = 32;
constexpr double shortest = 4;  // tolerances: what is smaller is not split

int halvings(int order) {
  if (order < 2) return 0;  // a straight side: its neighbour may be a linear cell
  int n = 0;
  while (order << (n + 1) <= most_segments) ++n;
  return n;
}

}  // namespace

const ShapeGrid* CurvedSkin::known_grid(CellType type, size_t nodes, std::array<int, 3> orders) const {
  const auto it = grids_.find({int(type), int(nodes), orders[0], orders[1], orders[2]});
  return it == grids_.end() ? nullptr : it->second.get();
}

const ShapeGrid* CurvedSkin::grid(CellType type, size_t nodes, std::array<int, 3> orders) {
  auto& kept = grids_[{int(type), int(nodes), orders[0], orders[1], orders[2]}];
  if (kept) return kept.get();
  const CellShape* shape = CellShape::find(type, nodes, orders);
  if (!shape) return nullptr;
  auto g = std::make_unique<ShapeGrid>();
  g->shape = shape;
  g->triangle = shape->base() == CellType::triangle;
  g->order = {shape->orders()[0], shape->dimension() == 2 ? shape->orders()[g->triangle ? 0 : 1] : 0};
  if (type == CellType::quadratic_linear_quad) g->order = {2, 1};
  for (size_t a = 0; a < 2; ++a) g->levels[a] = halvings(g->order[a]), g->finest[a] = g->order[a] << g->levels[a];
  for (int j = 0; j <= g->finest[1]; ++j)
    for (int i = 0; i <= g->finest[0] - (g->triangle ? j : 0); ++i) {
      const size_t at = g->values.size();
      g->values.resize(at + nodes);
      shape->values({double(i) / g->finest[0], g->finest[1] > 0 ? double(j) / g->finest[1] : 0, 0}, &g->values[at]);
    }
  kept = std::move(g);
  return kept.get();
}

double CurvedSkin::weight(int64_t id) const { return rational_.empty() ? 1 : rational_.get(size_t(id)); }

// The nodes of a face or curve with their weights; its grid still has no values.
void CurvedSkin::load(std::span<const int64_t> ids, const ShapeGrid& g, Work& w) const {
  w.width = 3;
  for (const Scaled& f : fields_) w.width += size_t(f.array.components());
  w.nodes.resize(ids.size() * w.width);
  w.points.resize(g.values.size() / ids.size() * w.width);
  w.known = -1;
  w.shares.clear();
  const Vec3 first = at_[size_t(ids[0])];
  double* to = w.nodes.data();
  for (int64_t id : ids) {
    const Vec3 p = (at_[size_t(id)] - first) * scale_;
    *to++ = p.x, *to++ = p.y, *to++ = p.z;
    for (const Scaled& f : fields_)
      for (int c = 0; c < f.array.components(); ++c) *to++ = f.array.get(size_t(id), c) * f.scale;
    if (!rational_.empty() && is_bezier(g.shape->type())) w.shares.push_back(weight(id));
  }
}

// Values at the points of the grid that is halved `level` times.
void CurvedSkin::evaluate(const ShapeGrid& g, int level, Work& w) const {
  const size_t n = g.shape->nodes();
  auto at = [&](size_t p) {
    const double* shape = &g.values[p * n];
    double* to = &w.points[p * w.width];
    std::fill(to, to + w.width, 0.0);
    double sum = 0;
    for (size_t k = 0; k < n; ++k) {
      const double share = w.shares.empty() ? shape[k] : shape[k] * w.shares[k];
      sum += share;
      if (share == 0) continue;
      for (size_t c = 0; c < w.width; ++c) to[c] += share * w.nodes[k * w.width + c];
    }
    if (!w.shares.empty())
      for (size_t c = 0; c < w.width; ++c) to[c] /= sum;
  };
  const int si = g.step(0, level), sj = g.step(1, level), known = w.known;
  const int ki = known < 0 ? INT_MAX : g.step(0, known), kj = known < 0 ? INT_MAX : g.step(1, known);
  for (int j = 0; j <= g.finest[1]; j += sj)
    for (int i = 0; i <= g.finest[0] - (g.triangle ? j : 0); i += si)
      if (known < 0 || i % ki != 0 || j % kj != 0) at(g.index(i, j));
  w.known = std::max(known, level);
}

int CurvedSkin::edge_level(const Edge& e, Work& w) const {
  const ShapeGrid* g = e.grid;
  if (!g || g->levels[0] == 0) return 0;
  load({e.nodes, e.count}, *g, w);
  for (int level = 0; level < g->levels[0]; ++level) {
    const int step = g->step(0, level);
    evaluate(*g, level + 1, w);
    bool fine = true;
    for (int i = 0; i < g->finest[0] && fine; i += step)
      fine = !(w.bend(size_t(i), size_t(i + step), size_t(i + step / 2)) > 1 && w.apart(size_t(i), size_t(i + step)) > shortest);
    if (fine) return level;
  }
  return g->levels[0];
}

int CurvedSkin::face_level(const ShapeGrid& g, Work& w) const {
  const int top = std::max(g.levels[0], g.levels[1]);
  auto bent = [&](int i, int j, int k, int l) {  // between two points of the grid
    if ((i + k) % 2 || (j + l) % 2) return false;
    const size_t a = g.index(i, j), b = g.index(k, l);
    return w.bend(a, b, g.index((i + k) / 2, (j + l) / 2)) > 1 && w.apart(a, b) > shortest;
  };
  for (int level = 0; level < top; ++level) {
    const int si = g.step(0, level), sj = g.step(1, level);
    evaluate(g, level + 1, w);
    bool fine = true;
    for (int j = 0; j <= g.finest[1] && fine; j += sj)
      for (int i = 0; i <= g.finest[0] - (g.triangle ? j : 0) && fine; i += si) {
        const bool right = i + si <= g.finest[0] - (g.triangle ? j : 0), up = j + sj <= g.finest[1] - (g.triangle ? i : 0);
        fine = !(right && bent(i, j, i + si, j)) && !(up && bent(i, j, i, j + sj));
        if (g.triangle) fine = fine && !(right && up && bent(i + si, j, i, j + sj));
        else if (fine && right && up && si % 2 == 0 && sj % 2 == 0)
          fine = !(w.bend4(g.index(i, j), g.index(i + si, j), g.index(i, j + sj), g.index(i + si, j + sj),
                           g.index(i + si / 2, j + sj / 2)) > 1 &&
                   w.apart(g.index(i, j), g.index(i + si, j + sj)) > shortest);
      }
    if (fine) return level;
  }
  return top;
}

}  // namespace sg::detail
