// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/clip/clip_cell.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace sg::clipping {

void CellPieces::clear() {
  names.clear(), inner.clear(), types.clear(), vertices.clear(), face_count.clear(), face_sizes.clear(), face_vertices.clear();
  first.assign(1, 0);
}

uint16_t CellPieces::vertex(uint64_t name) {
  size_t v = 0;
  while (v < names.size() && names[v] != name) ++v;
  if (v == names.size()) names.push_back(name);
  return uint16_t(v);
}

void CellPieces::end_piece(CellType type, uint32_t faces) {
  types.push_back(type);
  first.push_back(uint32_t(vertices.size()));
  face_count.push_back(faces);
}

void CellClipper::begin(std::span<const int64_t> ids, std::span<const double> values) {
  out_.clear();
  value_.assign(values.begin(), values.end());
  for (const int64_t id : ids) out_.names.push_back(edge_name(uint64_t(id), uint64_t(id)));
  out_.corners = ids.size();
}

uint16_t CellClipper::add(uint64_t name, double value) {
  const uint16_t v = out_.vertex(name);
  if (v == value_.size()) value_.push_back(value);
  return v;
}

// The vertex where a level crosses between two others. On an edge of the mesh, or on a diagonal of a face that both cells make, it has a
// name that the neighbours know; else it is this cell's own.
uint16_t CellClipper::cut(uint16_t a, uint16_t b, int level) {
  const uint64_t na = out_.names[a], nb = out_.names[b];
  const double value = level == 0 ? keep_.level : keep_.upper;
  auto high = [](uint64_t n) { return n >> 32; };
  auto low = [](uint64_t n) { return n & 0xffffffffu; };
  auto on_edge = [&](uint64_t point, uint64_t edge) {
    return high(point) == low(point) && (high(edge) == low(point) || low(edge) == low(point));
  };
  uint64_t p = 0, q = 0;
  if (((na | nb) & CellPieces::inner_name) == 0) {
    if (high(na) == low(na) && high(nb) == low(nb)) p = low(na), q = low(nb);
    else if (on_edge(na, nb)) p = high(nb), q = low(nb);
    else if (on_edge(nb, na)) p = high(na), q = low(na);
  }
  if (p != q) return add(level == 0 ? edge_name(std::min(p, q), std::max(p, q)) : edge_name(std::max(p, q), std::min(p, q)), value);
  const double ha = height(a, level), hb = height(b, level);
  for (size_t k = 0; k < out_.inner.size(); ++k) {
    const auto& of = out_.inner[k].of;
    if (out_.inner[k].t >= 0 && ((of[0] == a && of[1] == b) || (of[0] == b && of[1] == a))) return out_.vertex(CellPieces::inner_name + k);
  }
  // From the lower value to the higher one: the same for all cells that have the edge.
  if (value_[a] <= value_[b]) out_.inner.push_back({{a, b}, ha / (ha - hb)});
  else out_.inner.push_back({{b, a}, hb / (hb - ha)});
  return add(CellPieces::inner_name + out_.inner.size() - 1, value);
}

void CurvedFunction::shares(const LinearTopology& cell, uint32_t edges, const double* h, const Vec3* places, double* out) const {
  Vec3 from[12], to[12], at[12];
  double f[12], t[12], last_t[12], last_f[12];
  size_t edge[12], n = 0;
  for (; edges; edges &= edges - 1) {
    const auto e = size_t(std::countr_zero(edges));
    const auto [a, b] = cell.edges[e];
    edge[n] = e, from[n] = places[a], to[n] = places[b], t[n] = h[a] / (h[a] - h[b]);
    const bool first = t[n] < 0.5;
    last_t[n] = first ? 0 : 1, last_f[n] = -h[first ? a : b], ++n;
  }
  // Some steps of the secant method, for all edges at once; where they do not settle, the search that cannot fail.
  constexpr double settled = 1e-9;
  for (int round = 0; round < 6; ++round) {
    for (size_t k = 0; k < n; ++k) at[k] = lerp(from[k], to[k], t[k]);
    evaluate({at, n}, {f, n});
    bool near = true;
    for (size_t k = 0; k < n; ++k) {
      const double next = f[k] == 0 ? t[k] : t[k] - f[k] * (t[k] - last_t[k]) / (f[k] - last_f[k]);
      near = near && std::abs(next - t[k]) < settled;
      last_t[k] = t[k], last_f[k] = f[k];
      out[edge[k]] = t[k] = std::isfinite(next) ? std::clamp(next, 0.0, 1.0) : 0.5;
    }
    if (near) return;
  }
  for (size_t k = 0; k < n; ++k) {
    const auto [a, b] = cell.edges[edge[k]];
    t[k] = h[a] / (h[a] - h[b]);
  }
  refine({from, n}, {to, n}, {t, n});
  for (size_t k = 0; k < n; ++k) out[edge[k]] = t[k];
}

// Only cuts of the mesh's own edges are moved.
bool CellClipper::folds_when_moved(const ClipTable& table, const Sides& sides, const uint16_t* corners, const double* h) const {
  if (!curved_) return false;
  const LinearTopology& topology = table.topology();
  double shares[12];
  uint32_t moved = 0;
  for (uint32_t left = (sides.in.used | sides.out.used) >> first_cut; left; left &= left - 1) {
    const auto e = size_t(std::countr_zero(left));
    const auto [a, b] = topology.edges[e];
    shares[e] = h[a] / (h[a] - h[b]);
    if (corners[a] < out_.corners && corners[b] < out_.corners) moved |= 1u << e;
  }
  if (!moved) return false;
  Vec3 places[8];
  for (size_t c = 0; c < size_t(topology.corners); ++c) {
    if (corners[c] < out_.corners) {
      places[c] = mesh_place_(size_t(out_.names[corners[c]] >> 32));
      continue;
    }
    std::vector<double> w;
    weights(corners[c], w);
    for (size_t k = 0; k < w.size(); ++k)
      if (w[k] != 0) places[c] += mesh_place_(size_t(out_.names[k] >> 32)) * w[k];
  }
  curved_->shares(topology, moved, h, places, shares);
  return table.folded(sides, h, places, shares);
}

void CellClipper::add_region(const ClipTable& table, const uint16_t* corners, int level, bool last, int folded) {
  const LinearTopology& topology = table.topology();
  double h[8];
  uint32_t pattern = 0, zero = 0, joined = 0;
  for (size_t c = 0; c < size_t(topology.corners); ++c) {
    h[c] = height(corners[c], level);
    pattern |= uint32_t(h[c] >= 0) << c;
    zero |= uint32_t(h[c] == 0) << c;
  }
  for (uint32_t left = table.ambiguous(pattern); left; left &= left - 1) {
    const auto f = size_t(std::countr_zero(left));
    const auto face = topology.face(f);
    joined |= uint32_t(joined_across(h[face[0]], h[face[1]], h[face[2]], h[face[3]])) << f;
  }
  const Sides* sides = &own_;
  if (zero == 0) sides = &table.sides(pattern, joined);
  else {
    const auto [it, fresh] = zeros_[&table].try_emplace(pattern | zero << 8 | joined << 16);
    if (fresh) table.sides(pattern, joined, zero, it->second);
    sides = &it->second;
  }
  folded_ = folded > 0 && !keep_.flat;
  if (folded < 0 && !keep_.flat && !sides->cones.empty()) {
    Vec3 places[8];
    for (size_t c = 0; position_ && c < size_t(topology.corners); ++c) places[c] = place(corners[c]);
    folded_ = table.folded(*sides, h, position_ ? places : nullptr) || folds_when_moved(table, *sides, corners, h);
  }
  if (folded_) table.star_sides(pattern, joined, zero, h, own_), sides = &own_;
  const Region& region = kept_outside(level) ? sides->out : sides->in;

  uint16_t at[max_codes];
  for (uint32_t left = region.used; left; left &= left - 1) {
    const auto code = size_t(std::countr_zero(left));
    if (code < first_cut) at[code] = corners[code];
    else {
      const auto e = topology.edges[code - first_cut];
      at[code] = cut(corners[e[0]], corners[e[1]], level);
    }
  }
  for (size_t k = 0; k < region.inner.size(); ++k) {
    const Inner& inner = region.inner[k];
    InnerVertex v{{}, inner.t};
    double value = 0;
    if (inner.t >= 0) {
      if (!(inner.t <= 1)) {  // no cut towards this corner
        at[first_inner + k] = at[first_inner];
        continue;
      }
      const bool corner = inner.of[1] < first_cut;
      v.of = {at[inner.of[0]], corner ? corners[inner.of[1]] : at[inner.of[1]]};
      value = level == 0 ? keep_.level : keep_.upper;
    } else {
      for (const uint8_t code : inner.of) {
        v.of.push_back(code < first_cut ? corners[code] : at[code]);
        value += value_[v.of.back()] / double(inner.of.size());
      }
    }
    out_.inner.push_back(std::move(v));
    at[first_inner + k] = add(CellPieces::inner_name + out_.inner.size() - 1, value);
  }
  for (const Piece& p : region.pieces) {
    if (last) {
      for (int k = 0; k < p.count; ++k) out_.vertices.push_back(at[p.v[k]]);
      out_.end_piece(p.type);
    } else {
      Waiting w{p.type, {}};
      for (int k = 0; k < p.count; ++k) w.v[k] = at[p.v[k]];
      waiting_.push_back(w);
    }
  }
}

const CellPieces& CellClipper::solid(const ClipTable& table, const int64_t* ids, const double* values, int folded) {
  const auto n = size_t(table.topology().corners);
  begin({ids, n}, {values, n});
  split_ = false;
  if (position_ && n > 4) {
    Vec3 places[8];
    for (size_t c = 0; c < n; ++c) places[c] = position_(size_t(ids[c]));
    if (const uint32_t bent = bent_faces(table, ids, values, places, keep_, rounding_)) return split_solid(table, bent), out_;
  }
  const uint16_t corners[8] = {0, 1, 2, 3, 4, 5, 6, 7};
  if (!keep_.between) return add_region(table, corners, 0, true, folded), out_;
  waiting_.clear();
  add_region(table, corners, 0, false);
  for (size_t i = 0; i < waiting_.size(); ++i) {
    const Waiting w = waiting_[i];
    add_region(*clip_table(w.type), w.v, 1, true);
  }
  return out_;
}

void CellClipper::add_weights(uint16_t v, double share, double* out) const {
  if (v < out_.corners) return void(out[v] += share);
  const uint64_t n = out_.names[v];
  if (n & CellPieces::inner_name) {
    const InnerVertex& inner = out_.inner[size_t(n - CellPieces::inner_name)];
    if (inner.t >= 0) return add_weights(inner.of[0], share * (1 - inner.t), out), add_weights(inner.of[1], share * inner.t, out);
    for (const uint16_t k : inner.of) add_weights(k, share / double(inner.of.size()), out);
    return;
  }
  size_t ends[2] = {0, 0};
  for (size_t k = 0; k < out_.corners; ++k) {
    if (out_.names[k] >> 32 == n >> 32) ends[0] = k;
    if (out_.names[k] >> 32 == (n & 0xffffffffu)) ends[1] = k;
  }
  const double level = n >> 32 < (n & 0xffffffffu) ? keep_.level : keep_.upper, va = value_[ends[0]], vb = value_[ends[1]];
  const double t = (level - va) / (vb - va);
  out[ends[0]] += share * (1 - t), out[ends[1]] += share * t;
}

void CellClipper::weights(uint16_t v, std::vector<double>& out) const {
  out.assign(out_.corners, 0.0);
  add_weights(v, 1, out.data());
}

Vec3 CellClipper::place(uint16_t v) const {
  if (v < out_.corners) return position_(size_t(out_.names[v] >> 32));
  std::vector<double> w;
  weights(v, w);
  Vec3 sum;
  for (size_t k = 0; k < w.size(); ++k)
    if (w[k] != 0) sum += position_(size_t(out_.names[k] >> 32)) * w[k];
  return sum;
}

// Which cuts of a many-sided polygon belong together: along the line on which they lie.
std::vector<std::pair<size_t, size_t>> CellClipper::partners(const std::vector<uint16_t>& cuts) const {
  Box3 box;
  std::vector<Vec3> at;
  for (const uint16_t c : cuts) at.push_back(place(c)), box.add(at.back());
  const Vec3 size = box.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::vector<size_t> order(cuts.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return at[a][axis] < at[b][axis]; });
  std::vector<std::pair<size_t, size_t>> r;
  for (size_t i = 0; i + 1 < order.size(); i += 2) r.emplace_back(order[i], order[i + 1]);
  return r;
}

// The part of a polygon on one side; where all is zero, it is inside. `divided`: a face of a solid, whose quads fall into triangles and
// quads as in ClipTable.
void CellClipper::clip_ring(const Ring& ring, int level, bool side, bool divided, std::vector<Ring>& out) {
  const size_t n = ring.size();
  std::vector<double> h(n);
  bool positive = false, negative = false;
  for (size_t k = 0; k < n; ++k) {
    h[k] = height(ring[k], level);
    positive |= h[k] > 0, negative |= h[k] < 0;
  }
  auto in = [&](size_t k) { return (h[k % n] >= 0) == side; };
  auto keep_ring = [&](Ring r) {
    r.erase(std::unique(r.begin(), r.end()), r.end());
    while (r.size() > 1 && r.front() == r.back()) r.pop_back();
    if (r.size() >= 3) out.push_back(std::move(r));
  };
  if (!negative || !positive) {
    if (negative != side) keep_ring(ring);
    return;
  }
  auto crossing = [&](size_t k) {
    const uint16_t a = ring[k % n], b = ring[(k + 1) % n];
    return h[k % n] == 0 ? a : h[(k + 1) % n] == 0 ? b : cut(a, b, level);
  };
  std::vector<size_t> edges;  // that are crossed, in order; enters[i]: from the other side to ours
  for (size_t k = 0; k < n; ++k)
    if (in(k) != in(k + 1)) edges.push_back(k);
  const size_t m = edges.size();
  std::vector<uint16_t> cuts;
  for (const size_t k : edges) cuts.push_back(crossing(k));
  // For each crossing where the outline leaves our side, the one where it continues.
  std::vector<size_t> next(m, 0);
  if (m == 2) next = {1, 0};
  else if (n == 4) {
    const bool joined = joined_across(h[0], h[1], h[2], h[3]) == side;  // are our corners joined?
    for (size_t i = 0; i < m; ++i)
      if (in(edges[i])) next[i] = joined ? (i + 1) % m : (i + m - 1) % m;  // leaving: on to the next entry, or back to where this run began
    if (divided && joined) {
      const size_t s = in(0) ? 0 : 1;
      for (const size_t c : {s, s + 2}) keep_ring({cuts[(c + 3) % 4], ring[c], cuts[c]});
      keep_ring({cuts[(s + 3) % 4], cuts[s], cuts[s + 1], cuts[(s + 2) % 4]});
      return;
    }
  } else {
    for (const auto& [a, b] : partners(cuts)) next[a] = b, next[b] = a;
  }
  std::vector<char> done(m, 0);
  for (size_t first = 0; first < m; ++first) {
    if (done[first] || in(edges[first])) continue;  // start where the outline enters
    Ring r;
    size_t corners = 0;
    for (size_t i = first; !done[i];) {
      done[i] = 1;
      r.push_back(cuts[i]);
      const size_t leave = (i + 1) % m;
      for (size_t k = edges[i] + 1; k % n != (edges[leave] + 1) % n; ++k) r.push_back(ring[k % n]), ++corners;
      r.push_back(cuts[leave]);
      i = next[leave];
      if (in(edges[i])) break;  // crossings that do not pair up: a polygon that is not flat
    }
    if (divided && n == 4 && m == 2 && corners == 3) {
      keep_ring({r[1], r[2], r[3]});
      keep_ring({r[0], r[1], r[3], r[4]});
    } else {
      keep_ring(std::move(r));
    }
  }
}

void CellClipper::add_ring(const Ring& ring) {
  out_.vertices.insert(out_.vertices.end(), ring.begin(), ring.end());
  out_.end_piece(ring.size() == 3 ? CellType::triangle : ring.size() == 4 ? CellType::quad : CellType::polygon);
}

const CellPieces& CellClipper::polygon(std::span<const int64_t> ids, std::span<const double> values) {
  begin(ids, values);
  Ring ring(ids.size());
  for (size_t k = 0; k < ring.size(); ++k) ring[k] = uint16_t(k);
  std::vector<Ring> kept, final;
  clip_ring(ring, 0, !kept_outside(0), false, kept);
  if (keep_.between)
    for (const Ring& r : kept) clip_ring(r, 1, true, false, final);
  for (const Ring& r : keep_.between ? final : kept) add_ring(r);
  return out_;
}

const CellPieces& CellClipper::chain(std::span<const int64_t> ids, std::span<const double> values) {
  begin(ids, values);
  for (size_t k = 0; k + 1 < ids.size(); ++k) {
    uint16_t ends[2] = {uint16_t(k), uint16_t(k + 1)};
    bool gone = false;
    for (int level = 0; level <= int(keep_.between) && !gone; ++level) {
      const double sign = kept_outside(level) ? -1 : 1;
      const double a = sign * height(ends[0], level), b = sign * height(ends[1], level);
      gone = !(a > 0 || b > 0) && !(a == 0 && b == 0 && sign > 0);
      if (gone || (a >= 0 && b >= 0)) continue;
      ends[a < 0 ? 0 : 1] = cut(ends[0], ends[1], level);
    }
    if (gone) continue;
    out_.vertices.insert(out_.vertices.end(), {ends[0], ends[1]});
    out_.end_piece(CellType::line);
  }
  return out_;
}

const CellPieces& CellClipper::dots(std::span<const int64_t> ids, std::span<const double> values) {
  begin(ids, values);
  for (uint16_t k = 0; k < ids.size(); ++k) {
    if ((height(k, 0) >= 0) == keep_.outside || (keep_.between && height(k, 1) < 0)) continue;
    out_.vertices.push_back(k);
    out_.end_piece(CellType::vertex);
  }
  return out_;
}

// The cut surface: closes what the faces of the inside leave open. The same triangles for both sides.
std::vector<CellClipper::Ring> CellClipper::cut_rings(const std::vector<Ring>& in, const std::vector<Ring>& out) const {
  using Edge = std::pair<uint16_t, uint16_t>;
  std::map<Edge, int> open;
  std::vector<Edge> all;
  for (const auto* side : {&in, &out})
    for (const Ring& f : *side)
      for (size_t k = 0; k < f.size(); ++k) {
        const uint16_t a = f[k], b = f[(k + 1) % f.size()];
        all.push_back(std::minmax(a, b));
        if (side == &out) continue;
        const auto partner = open.find({b, a});
        if (partner == open.end()) ++open[{a, b}];
        else if (--partner->second == 0) open.erase(partner);
      }
  std::sort(all.begin(), all.end());
  std::vector<Ring> r;
  while (!open.empty()) {
    Ring loop{open.begin()->first.first};
    uint16_t at = open.begin()->first.second;
    auto take = [&](auto it) {
      if (--it->second == 0) open.erase(it);
    };
    take(open.begin());
    while (at != loop[0]) {
      const auto next = open.lower_bound({at, 0});
      if (next == open.end() || next->first.first != at) break;
      loop.push_back(at);
      at = next->first.second;
      take(next);
    }
    if (loop.size() < 3 || at != loop[0]) continue;
    std::reverse(loop.begin(), loop.end());
    if (loop.size() <= 3 || keep_.flat) {
      r.push_back(std::move(loop));
      continue;
    }
    // Around the vertex with the lowest name, rather one from which no diagonal is an edge of the faces: that would leave nothing there.
    auto rank = [&](size_t v) {
      size_t edges = 0;
      for (size_t k = 2; k + 1 < loop.size(); ++k)
        edges += std::binary_search(all.begin(), all.end(), Edge(std::minmax(loop[v], loop[(v + k) % loop.size()])));
      return std::pair(edges, out_.names[loop[v]]);
    };
    size_t best = 0;
    for (size_t v = 1; v < loop.size(); ++v)
      if (rank(v) < rank(best)) best = v;
    std::rotate(loop.begin(), loop.begin() + ptrdiff_t(best), loop.end());
    for (size_t k = 1; k + 1 < loop.size(); ++k) r.push_back({loop[0], loop[k], loop[k + 1]});
  }
  return r;
}

// Clips the faces and closes what is open. The outside is closed by the cut of the inside, turned round.
std::vector<CellClipper::Ring> CellClipper::clip_faces(const std::vector<Ring>& faces, int level) {
  std::vector<Ring> in, out;
  for (const Ring& f : faces) clip_ring(f, level, true, true, in), clip_ring(f, level, false, true, out);
  const std::vector<Ring> cut = cut_rings(in, out);
  std::vector<Ring>& r = kept_outside(level) ? out : in;
  for (const Ring& f : cut) {
    if (kept_outside(level)) r.emplace_back(f.rbegin(), f.rend());
    else r.push_back(f);
  }
  return std::move(r);
}

const CellPieces& CellClipper::polyhedron(std::span<const int64_t> ids, std::span<const double> values, std::vector<Ring> faces) {
  begin(ids, values);
  // Files promise faces that look outward but do not all keep it: make neighbours agree.
  std::map<std::pair<uint16_t, uint16_t>, std::vector<size_t>> at_edge;
  auto edge = [&](const Ring& f, size_t k) { return std::minmax(f[k], f[(k + 1) % f.size()]); };
  for (size_t f = 0; f < faces.size(); ++f)
    for (size_t k = 0; k < faces[f].size(); ++k) at_edge[edge(faces[f], k)].push_back(f);
  auto forward = [&](size_t f, std::pair<uint16_t, uint16_t> e) {
    for (size_t k = 0; k < faces[f].size(); ++k)
      if (std::pair<uint16_t, uint16_t>(edge(faces[f], k)) == e) return faces[f][k] == e.first;
    return false;
  };
  std::vector<char> seen(faces.size(), 0);
  for (size_t first = 0; first < faces.size(); ++first) {
    if (seen[first]) continue;
    std::vector<size_t> pending{first};
    seen[first] = 1;
    while (!pending.empty()) {
      const size_t f = pending.back();
      pending.pop_back();
      for (size_t k = 0; k < faces[f].size(); ++k) {
        const std::pair<uint16_t, uint16_t> e = edge(faces[f], k);
        for (const size_t g : at_edge[e]) {
          if (seen[g]) continue;
          if (forward(f, e) == forward(g, e)) std::reverse(faces[g].begin(), faces[g].end());
          seen[g] = 1;
          pending.push_back(g);
        }
      }
    }
  }
  std::vector<Ring> kept = clip_faces(flat_faces(std::move(faces)), 0);
  if (keep_.between) kept = clip_faces(kept, 1);
  if (kept.size() < 4) return out_;
  Ring distinct;
  for (const Ring& f : kept) {
    distinct.insert(distinct.end(), f.begin(), f.end());
    out_.face_sizes.push_back(uint32_t(f.size()));
    out_.face_vertices.insert(out_.face_vertices.end(), f.begin(), f.end());
  }
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  out_.vertices = distinct;
  out_.end_piece(CellType::polyhedron, uint32_t(kept.size()));
  return out_;
}

}  // namespace sg::clipping
