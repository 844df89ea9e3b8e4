// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/faces/curved_faces.h"

#include "base/parallel.h"
#include "data/cells/cell_topology.h"
#include "filter/mesh/faces/curved_work.h"

namespace sg::detail {

namespace {

constexpr double field_tolerance = 4;  // times the tolerance: colours are coarser than shapes
constexpr size_t edges_per_chunk = 256;

// Whether pictures may interpolate a field. Numberings and weights are not interpolated.
bool blends(const Field& f) {
  return f.association == Association::point && is_float(f.array.type()) && f.role != Role::global_ids && f.role != Role::labels &&
         f.name != "RationalWeights";
}

}  // namespace

CurvedSkin::CurvedSkin(const Dataset& in, const UnstructuredMesh& mesh, std::vector<CurvedChunk> found, double tolerance,
                       const Context& ctx)
    : mesh_(mesh), at_(mesh.points), found_(std::move(found)), points_(mesh.points.count()) {
  const double diagonal = in.bounds().empty() ? 0 : length(in.bounds().hi - in.bounds().lo);
  scale_ = diagonal > 0 ? 1 / (tolerance * diagonal) : 0;
  for (const Field& f : in.fields()) {
    if (!blends(f)) continue;
    double extent = 0, largest = 0;
    for (int c = 0; c < f.components(); ++c) {
      const Range r = in.range(f, c);
      if (r.empty()) continue;
      extent = std::max(extent, r.hi - r.lo), largest = std::max({largest, std::abs(r.lo), std::abs(r.hi)});
    }
    if (extent > 1e-6 * largest && std::isfinite(extent)) fields_.push_back({f.array, 1 / (field_tolerance * tolerance * extent)});
  }
  rational_ = mesh.weights;
  if (const Field* w = in.fields().find("RationalWeights", Association::point); rational_.empty() && w && w->components() == 1)
    rational_ = w->array;

  std::vector<Side> sides;
  edge_nodes_.resize(found_.size());
  for (uint32_t c = 0; c < found_.size(); ++c) add_sides(c, sides);
  join_edges(sides);
  parallel_for(
      edges_.size(), edges_per_chunk,
      [&](size_t begin, size_t end) {
        Work w;
        for (size_t e = begin; e < end; ++e) edges_[e].level = edge_level(edges_[e], w);
      },
      &ctx);
  for (Edge& e : edges_) {
    e.first_point = int64_t(points_);
    if (e.grid) points_ += e.grid->points(e.level);
  }
  parallel_for(found_.size(), 1, [&](size_t c, size_t) {
    Work w;
    CurvedChunk& chunk = found_[c];
    for (Item& f : chunk.items) {
      if (f.is_curve || f.sides == 0) continue;
      const ShapeGrid* g = known_grid(f.type, f.count, f.orders);
      if (!g) continue;
      load({chunk.nodes.data() + f.first_node, f.count}, *g, w);
      f.level = face_level(*g, w);
      for (uint32_t s = 0; s < f.sides; ++s) f.level = std::max(f.level, edges_[chunk.uses[f.first_use + s].edge].level);
    }
  });
  for (uint32_t c = 0; c < found_.size(); ++c)
    for (uint32_t i = 0; i < found_[c].items.size(); ++i) {
      Item& f = found_[c].items[i];
      if (f.level == 0) continue;
      f.first_point = int64_t(points_);
      faces_.push_back({f.first_point, {c, i, 0}});
      points_ += known_grid(f.type, f.count, f.orders)->points(f.level);
    }
  find_bezier_nodes();
}

// The sides of a chunk's faces and curves as curves in canonical direction: from the smaller end.
void CurvedSkin::add_sides(uint32_t c, std::vector<Side>& sides) {
  CurvedChunk& chunk = found_[c];
  std::vector<uint32_t> ring;
  std::vector<int64_t> along;
  for (Item& f : chunk.items) {
    const int64_t* ids = chunk.nodes.data() + f.first_node;
    uint32_t corners = 2;
    if (f.is_curve) {
      curve_order(f.type, f.count, ring);
    } else {
      grid(f.type, f.count, f.orders);
      if (!known_grid(f.type, f.count, f.orders) && f.type != CellType::quadratic_polygon) continue;
      face_outline(f.type, f.count, ring, f.orders);
      corners = f.type == CellType::quadratic_polygon ? f.count / 2 : linear_type(f.type) == CellType::triangle ? 3 : 4;
      ring.push_back(ring.empty() ? 0 : ring.front());
    }
    f.first_use = uint32_t(chunk.uses.size());
    for (size_t begin = 0, end; begin + 1 < ring.size(); begin = end) {
      for (end = begin + 1; end + 1 < ring.size() && ring[end] >= corners;) ++end;
      along.clear();
      for (size_t k = begin; k <= end; ++k) along.push_back(ids[ring[k]]);
      const size_t n = along.size();
      const bool against = along.front() > along.back() || (along.front() == along.back() && n > 2 && along[1] > along[n - 2]);
      if (against) std::reverse(along.begin(), along.end());
      auto& pool = edge_nodes_[c];
      const bool bezier = is_bezier(f.type) && n > 2;
      sides.push_back({c, uint32_t(chunk.uses.size()), bezier, !f.is_curve, uint32_t(pool.size()), uint32_t(n)});
      pool.push_back(along.front());
      pool.push_back(along.back());
      pool.insert(pool.end(), along.begin() + 1, along.end() - 1);
      chunk.uses.push_back({0, against});
      ++f.sides;
      grid(bezier ? CellType::bezier_curve : CellType::lagrange_curve, n, {0, 0, 0});
    }
  }
}

void CurvedSkin::join_edges(std::vector<Side>& sides) {
  auto ids = [&](const Side& s) { return std::span(edge_nodes_[s.chunk].data() + s.first, s.count); };
  auto before = [&](const Side& a, const Side& b) {
    if (a.bezier != b.bezier) return a.bezier < b.bezier;
    const auto x = ids(a), y = ids(b);
    return std::lexicographical_compare(x.begin(), x.end(), y.begin(), y.end());
  };
  std::vector<uint32_t> order(sides.size());
  for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    if (before(sides[a], sides[b])) return true;
    if (before(sides[b], sides[a])) return false;
    return a < b;
  });
  for (size_t k = 0; k < order.size(); ++k) {
    const Side& s = sides[order[k]];
    if (k == 0 || before(sides[order[k - 1]], s)) {
      edges_.push_back({ids(s).data(), s.count, s.bezier, false});
      edges_.back().grid = known_grid(s.bezier ? CellType::bezier_curve : CellType::lagrange_curve, s.count, {0, 0, 0});
    }
    edges_.back().of_face |= s.of_face;
    found_[s.chunk].uses[s.use].edge = uint32_t(edges_.size() - 1);
  }
}

// The number of point i of `segments` on an edge, in its canonical direction; where the edge has fewer, the nearest it has.
int64_t CurvedSkin::edge_point(const Edge& e, int i, int segments) const {
  const int order = int(e.count) - 1, own = order << e.level, k = segments / own;
  const int low = i / k, rest = i % k;  // halves go to the nearer end, so that corners stay simple
  const int at = 2 * rest > k || (2 * rest == k && 2 * i > segments) ? low + 1 : low;
  const int per_node = 1 << e.level;
  if (at == own) return e.nodes[1];
  if (at % per_node == 0) return e.nodes[at == 0 ? 0 : at / per_node + 1];
  return e.first_point + at;
}

void CurvedSkin::emit_curve(const Edge& e, bool reversed, std::vector<int64_t>& out) const {
  const int n = (int(e.count) - 1) << e.level;
  for (int i = 0; i <= n; ++i) out.push_back(edge_point(e, reversed ? n - i : i, n));
}

void CurvedSkin::emit_face(const CurvedChunk& chunk, const Item& f, Work& w, CellList& out) const {
  const int64_t* ids = chunk.nodes.data() + f.first_node;
  auto add = [&](int64_t a, int64_t b, int64_t c) {
    if (a == b || b == c || c == a) return;
    const int64_t tri[3] = {a, f.mirrored ? c : b, f.mirrored ? b : c};
    out.add(tri, f.cell);
  };
  auto use = [&](uint32_t s) { return chunk.uses[f.first_use + s]; };
  std::vector<uint32_t> local;
  std::vector<Vec3> at;
  if (f.type == CellType::quadratic_polygon && f.sides > 0) {
    std::vector<int64_t> ring;
    for (uint32_t s = 0; s < f.sides; ++s) emit_curve(edges_[use(s).edge], use(s).reversed, ring), ring.pop_back();
    std::vector<int64_t> from;
    std::vector<double> share;
    for (int64_t id : ring) {
      from.clear(), share.clear();
      blend(id, from, share);
      at.push_back({0, 0, 0});
      for (size_t k = 0; k < from.size(); ++k) at.back() += at_[size_t(from[k])] * share[k];
    }
    triangulate_polygon(at, local);
    for (size_t t = 0; t + 2 < local.size(); t += 3) add(ring[local[t]], ring[local[t + 1]], ring[local[t + 2]]);
    return;
  }
  if (f.level == 0) {
    for (uint32_t k = 0; k < f.count; ++k) at.push_back(at_[size_t(ids[k])]);
    tessellate_face(f.type, at, local, f.orders);
    for (size_t t = 0; t + 2 < local.size(); t += 3) {
      const int64_t tri[3] = {ids[local[t]], ids[local[t + (f.mirrored ? 2 : 1)]], ids[local[t + (f.mirrored ? 1 : 2)]]};
      out.add(tri, f.cell);
    }
    return;
  }
  const ShapeGrid& g = *known_grid(f.type, f.count, f.orders);
  load({ids, f.count}, g, w);
  evaluate(g, f.level, w);
  const int si = g.step(0, f.level), sj = g.step(1, f.level), m = g.finest[0] / si, n = g.finest[1] / sj;
  auto side_point = [&](uint32_t s, int i, int segments) {
    return edge_point(edges_[use(s).edge], use(s).reversed ? segments - i : i, segments);
  };
  auto number = [&](int i, int j) -> int64_t {
    if (j == 0) return side_point(0, i, m);
    if (g.triangle) {
      if (i + j == m) return side_point(1, j, m);
      if (i == 0) return side_point(2, m - j, m);
    } else {
      if (i == m) return side_point(1, j, n);
      if (j == n) return side_point(2, m - i, m);
      if (i == 0) return side_point(3, n - j, n);
    }
    return f.first_point + i + j * (m + 1);
  };
  auto place = [&](int i, int j) { return w.position(g.index(i * si, j * sj)); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < (g.triangle ? m - j : m); ++i) {
      const int64_t a = number(i, j), b = number(i + 1, j), d = number(i, j + 1);
      if (g.triangle) {
        add(a, b, d);
        if (i + j + 1 < m) add(b, number(i + 1, j + 1), d);
      } else {
        const int64_t c = number(i + 1, j + 1);
        if (first_diagonal_fits(place(i, j), place(i + 1, j), place(i + 1, j + 1), place(i, j + 1))) add(a, b, c), add(a, c, d);
        else add(a, b, d), add(b, c, d);
      }
    }
}

// A list of the chunk with its curved items at their places.
void CurvedSkin::rebuild(const CurvedChunk& chunk, bool curves, CellList& list) const {
  CellList out;
  Work w;
  size_t cell = 0, id = 0;
  std::vector<int64_t> line;
  auto copy_until = [&](size_t end) {
    for (; cell < end; id += list.sizes[cell++]) out.add(std::span(list.ids).subspan(id, list.sizes[cell]), list.sources[cell]);
  };
  bool any = false;
  for (const Item& f : chunk.items) {
    if (f.is_curve != curves) continue;
    any = true;
    copy_until(f.before);
    if (!curves) {
      emit_face(chunk, f, w, out);
      continue;
    }
    line.clear();
    const auto use = chunk.uses[f.first_use];
    emit_curve(edges_[use.edge], use.reversed, line);
    out.add(line, f.cell);
  }
  if (!any) return;
  copy_until(list.sizes.size());
  list = std::move(out);
}

void CurvedSkin::merge(std::vector<SurfaceChunk>& chunks, bool outlines) const {
  SurfaceChunk rims;
  if (outlines) {
    std::vector<std::pair<int64_t, int64_t>> straight;
    auto add = [&](int64_t a, int64_t b) { straight.emplace_back(std::min(a, b), std::max(a, b)); };
    for (const SurfaceChunk& c : chunks) {
      size_t at = 0;
      for (uint32_t n : c.polygons.sizes) {
        for (size_t k = 0; k < n; ++k) add(c.polygons.ids[at + k], c.polygons.ids[at + (k + 1) % n]);
        at += n;
      }
    }
    std::vector<int64_t> line;
    for (const Edge& e : edges_) {
      if (!e.of_face) continue;
      if (e.count == 2) {
        add(e.nodes[0], e.nodes[1]);
        continue;
      }
      line.clear();
      emit_curve(e, false, line);
      rims.outlines.add(line, 0);
    }
    std::sort(straight.begin(), straight.end());
    straight.erase(std::unique(straight.begin(), straight.end()), straight.end());
    for (const auto& [a, b] : straight)
      if (const int64_t ends[2] = {a, b}; a != b) rims.outlines.add(ends, 0);
  }
  parallel_for(chunks.size(), 1, [&](size_t c, size_t) {
    rebuild(found_[c], false, chunks[c].polygons);
    rebuild(found_[c], true, chunks[c].lines);
  });
  if (outlines) chunks.push_back(std::move(rims));
}

// A Bezier cell passes through its corners only; its other nodes are control points, drawn where the Bernstein polynomials have their
// place. On an edge only the edge's own nodes count, so that neighbours agree.
void CurvedSkin::find_bezier_nodes() {
  for (uint32_t e = 0; e < edges_.size(); ++e)
    if (const Edge& edge = edges_[e]; edge.bezier && edge.grid)
      for (uint32_t k = 2; k < edge.count; ++k)
        bezier_nodes_.push_back({edge.nodes[k], {no_chunk, e, size_t(k - 1) << edge.grid->levels[0]}});
  for (uint32_t c = 0; c < found_.size(); ++c)
    for (uint32_t i = 0; i < found_[c].items.size(); ++i) {
      const Item& f = found_[c].items[i];
      if (f.is_curve || f.level > 0 || f.sides == 0 || !is_bezier(f.type)) continue;
      const ShapeGrid& g = *known_grid(f.type, f.count, f.orders);
      for (uint32_t k = f.sides; k < f.count; ++k) {  // as many corners as sides
        const Vec3 at = g.shape->node(k);
        const size_t point = g.index(int(std::lround(at.x * g.finest[0])), int(std::lround(at.y * g.finest[1])));
        bezier_nodes_.push_back({found_[c].nodes[f.first_node + k], {c, i, point}});
      }
    }
  std::stable_sort(bezier_nodes_.begin(), bezier_nodes_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
}

void CurvedSkin::blend(int64_t number, std::vector<int64_t>& ids, std::vector<double>& weights) const {
  Place place{no_chunk, 0, 0};
  if (size_t(number) < mesh_.points.count()) {
    const auto it =
        std::lower_bound(bezier_nodes_.begin(), bezier_nodes_.end(), number, [](const auto& b, int64_t x) { return b.first < x; });
    if (it == bezier_nodes_.end() || it->first != number) {
      ids.push_back(number), weights.push_back(1);
      return;
    }
    place = it->second;
  } else if (!faces_.empty() && number >= faces_.front().first) {
    const auto it = std::upper_bound(faces_.begin(), faces_.end(), number, [](int64_t x, const auto& f) { return x < f.first; }) - 1;
    const Item& f = found_[it->second.chunk].items[it->second.item];
    place = it->second;
    place.at = known_grid(f.type, f.count, f.orders)->index_of(size_t(number - it->first), f.level);
  } else {
    const auto it = std::upper_bound(edges_.begin(), edges_.end(), number, [](int64_t x, const Edge& e) { return x < e.first_point; }) - 1;
    place = {no_chunk, uint32_t(it - edges_.begin()), it->grid->index_of(size_t(number - it->first_point), it->level)};
  }
  std::span<const int64_t> nodes;
  const ShapeGrid* g = nullptr;
  if (place.chunk == no_chunk) {
    nodes = {edges_[place.item].nodes, edges_[place.item].count}, g = edges_[place.item].grid;
  } else {
    const Item& f = found_[place.chunk].items[place.item];
    nodes = {found_[place.chunk].nodes.data() + f.first_node, f.count}, g = known_grid(f.type, f.count, f.orders);
  }
  const double* n = &g->values[place.at * nodes.size()];
  const bool rational = !rational_.empty() && is_bezier(g->shape->type());
  const size_t before = weights.size();
  double sum = 0;
  for (size_t k = 0; k < nodes.size(); ++k) {
    if (n[k] == 0) continue;
    const double share = rational ? n[k] * weight(nodes[k]) : n[k];
    ids.push_back(nodes[k]), weights.push_back(share), sum += share;
  }
  if (rational)
    for (size_t k = before; k < weights.size(); ++k) weights[k] /= sum;
}

}  // namespace sg::detail
