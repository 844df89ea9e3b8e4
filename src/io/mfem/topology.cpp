// SPDX-License-Identifier: Apache-2.0
#include "io/mfem/topology.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"

namespace sg::mfem {

namespace {

using Key = std::array<int64_t, 3>;

// Numbers of keys in the order in which they come first: open addressing, twice as many slots as keys.
class Numbers {
 public:
  explicit Numbers(size_t expected) {
    size_t n = 64;
    while (n < 2 * expected) n *= 2;
    slots_.assign(n, -1);
    keys_.reserve(expected);
  }
  int64_t operator()(const Key& key) {
    if (2 * keys_.size() >= slots_.size()) grow();
    int64_t& slot = find(key);
    if (slot < 0) {
      slot = int64_t(keys_.size());
      keys_.push_back(key);
    }
    return slot;
  }
  size_t size() const { return keys_.size(); }

 private:
  int64_t& find(const Key& key) {
    uint64_t h = 0x9e3779b97f4a7c15ull;
    for (int64_t v : key) h = (h ^ uint64_t(v)) * 0xff51afd7ed558ccdull, h ^= h >> 32;
    size_t i = h & (slots_.size() - 1);
    while (slots_[i] >= 0 && keys_[size_t(slots_[i])] != key) i = (i + 1) & (slots_.size() - 1);
    return slots_[i];
  }
  void grow() {
    slots_.assign(slots_.size() * 2, -1);
    for (size_t k = 0; k < keys_.size(); ++k) find(keys_[k]) = int64_t(k);
  }
  std::vector<int64_t> slots_;
  std::vector<Key> keys_;
};

// A face is known by its three smallest vertices, as in MFEM.
Key face_key(std::array<int64_t, 4> v) {
  if (v[3] < 0) v[3] = INT64_MAX;
  std::sort(v.begin(), v.end());
  return {v[0], v[1], v[2]};
}

}  // namespace

int corner_in(std::span<const int64_t> corners, int64_t vertex) {
  for (size_t i = 0; i < corners.size(); ++i)
    if (corners[i] == vertex) return int(i);
  return -1;
}

void number_entities(const Topology& t) {
  if (t.numbered) return;
  t.numbered = true;
  Numbers edges(t.dimension > 1 ? 3 * t.size() : 0), faces(t.dimension > 2 ? 3 * t.size() : 0);
  t.edge_begin.assign(1, 0), t.face_begin.assign(1, 0);
  t.edge.clear(), t.face.clear(), t.face_corners.clear();
  for (size_t e = 0; e < t.size(); ++e) {
    const GeometryInfo& g = info(t.geometry[e]);
    const auto v = t.element(e);
    if (t.dimension > 1)
      for (const auto& [a, b] : g.edges) {
        const int64_t p = v[size_t(a)], q = v[size_t(b)];
        t.edge.push_back(edges({std::min(p, q), std::max(p, q), 0}));
      }
    for (const auto& f : g.faces) {
      std::array<int64_t, 4> corner{-1, -1, -1, -1};
      for (size_t k = 0; k < f.size(); ++k) corner[k] = v[size_t(f[k])];
      t.face.push_back(faces(face_key(corner)));
      if (faces.size() > t.face_corners.size()) t.face_corners.push_back(corner);
    }
    t.edge_begin.push_back(t.edge.size());
    t.face_begin.push_back(t.face.size());
  }
  t.edges = edges.size(), t.faces = faces.size();
}

Numbering::Numbering(const Topology& t, int p, const std::string& where) : t_(t), p_(p), where_(where) {
  const int64_t m = p - 1;
  if (p > 1) number_entities(t);
  int64_t next = t.vertices + int64_t(t.edges) * m;
  edges_ = size_t(t.vertices);
  for (const auto& f : t.face_corners) {
    face_first_.push_back(next);
    next += f[3] < 0 ? m * (m - 1) / 2 : m * m;
  }
  for (int g = 0; g < geometry_count; ++g) nodes_[g] = local_nodes(Geometry(g), p);
  for (size_t e = 0; e < t.size(); ++e) {
    inside_first_.push_back(next);
    const auto& nodes = nodes_[size_t(t.geometry[e])];
    if (!nodes.empty() && nodes.back().kind == LocalNode::inside) next += nodes.back().a + 1;
  }
  size_ = size_t(next);
}

int64_t Numbering::face_node(const Topology& t, size_t e, const LocalNode& n) const {
  const int64_t f = t.face[t.face_begin[e] + n.entity];
  const auto& local = info(t.geometry[e]).faces[n.entity];
  const auto& base = t.face_corners[size_t(f)];
  const size_t corners = base[3] < 0 ? 3 : 4;
  std::array<int64_t, 4> v{};
  for (size_t k = 0; k < local.size(); ++k) v[k] = t.element(e)[size_t(local[k])];
  auto odd = [&]() { fail_data(fmt::format("face {} of element {} does not match the face of its neighbour", int(n.entity), e), where_); };
  if (local.size() != corners) odd();
  const std::span<const int64_t> own(v.data(), corners);
  const int c0 = corner_in(own, base[0]), c1 = corner_in(own, base[1]), c2 = corner_in(own, base[corners - 1]);
  if (c0 < 0 || c1 < 0 || c2 < 0) odd();
  int a = 0, b = 0;
  if (corners == 3) {
    const int weight[3] = {p_ - n.a - n.b, n.a, n.b};
    a = weight[c1], b = weight[c2];
    if (a < 1 || b < 1 || a + b >= p_) odd();
    return face_first_[size_t(f)] + (b - 1) * (2 * p_ - b - 2) / 2 + a - 1;  // rows of p-2, p-3, ... nodes
  }
  // The place in the face's own frame, seen from the base's first corner along its two sides.
  constexpr int cx[4] = {0, 1, 1, 0}, cy[4] = {0, 0, 1, 1};
  const int dx = n.a - p_ * cx[c0], dy = n.b - p_ * cy[c0];
  a = dx * (cx[c1] - cx[c0]) + dy * (cy[c1] - cy[c0]);
  b = dx * (cx[c2] - cx[c0]) + dy * (cy[c2] - cy[c0]);
  if (a < 1 || b < 1 || a >= p_ || b >= p_) odd();
  return face_first_[size_t(f)] + int64_t(b - 1) * (p_ - 1) + a - 1;
}

std::span<const int64_t> Numbering::element(size_t e) {
  const auto& nodes = nodes_[size_t(t_.geometry[e])];
  const auto v = t_.element(e);
  ids_.resize(nodes.size());
  for (size_t k = 0; k < nodes.size(); ++k) {
    const LocalNode& n = nodes[k];
    switch (n.kind) {
      case LocalNode::corner: ids_[k] = v[n.entity]; break;
      case LocalNode::edge: {
        const auto [a, b] = info(t_.geometry[e]).edges[n.entity];
        const int64_t step = v[size_t(a)] < v[size_t(b)] ? n.a - 1 : p_ - 1 - n.a;  // edges run to the larger vertex
        ids_[k] = int64_t(edges_) + t_.edge[t_.edge_begin[e] + n.entity] * (p_ - 1) + step;
        break;
      }
      case LocalNode::face: ids_[k] = face_node(t_, e, n); break;
      case LocalNode::inside: ids_[k] = inside_first_[e] + n.a; break;
    }
  }
  return ids_;
}

}  // namespace sg::mfem
