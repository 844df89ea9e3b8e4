// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/clip/clip_cases.h"

#include <algorithm>
#include <bit>

#include "base/vec.h"

namespace sg::clipping {

namespace {

using Polygon = std::vector<uint8_t>;
using Edge = std::pair<uint8_t, uint8_t>;

void add_reduced(std::vector<Polygon>& to, Polygon p) {
  p.erase(std::unique(p.begin(), p.end()), p.end());
  while (p.size() > 1 && p.front() == p.back()) p.pop_back();
  if (p.size() >= 3) to.push_back(std::move(p));
}

std::vector<std::array<double, 3>> places_of(CellType type) {
  switch (type) {
    case CellType::tetra: return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    case CellType::pyramid: return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {.5, .5, 1}};
    case CellType::wedge: return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    case CellType::voxel: return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
    default: return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  }
}

// Groups of polygons that are connected by edges.
std::vector<std::vector<const Polygon*>> components(const std::vector<Polygon>& polygons) {
  std::vector<std::vector<const Polygon*>> r;
  std::vector<char> seen(polygons.size());
  auto joined = [](const Polygon& a, const Polygon& b) {
    for (size_t i = 0; i < a.size(); ++i)
      for (size_t k = 0; k < b.size(); ++k)
        if (a[i] == b[(k + 1) % b.size()] && a[(i + 1) % a.size()] == b[k]) return true;
    return false;
  };
  for (size_t s = 0; s < polygons.size(); ++s) {
    if (seen[s]) continue;
    seen[s] = 1;
    std::vector<size_t> group{s};
    for (size_t g = 0; g < group.size(); ++g)
      for (size_t o = 0; o < polygons.size(); ++o)
        if (!seen[o] && joined(polygons[group[g]], polygons[o])) seen[o] = 1, group.push_back(o);
    std::sort(group.begin(), group.end());
    auto& c = r.emplace_back();
    for (size_t g : group) c.push_back(&polygons[g]);
  }
  return r;
}

// The vertex that a polygon edge leads to from v, other than along `base`.
uint8_t above(const std::vector<const Polygon*>& polygons, const Polygon& base, uint8_t v) {
  for (const Polygon* p : polygons)
    for (size_t i = 0; i < p->size(); ++i) {
      const uint8_t next = (*p)[(i + 1) % p->size()];
      if ((*p)[i] == v && std::find(base.begin(), base.end(), next) == base.end()) return next;
    }
  return 255;
}

void add_piece(Region& out, CellType type, std::initializer_list<uint8_t> v) {
  Piece p{type, uint8_t(v.size()), {}};
  std::copy(v.begin(), v.end(), p.v);
  out.pieces.push_back(p);
  out.ids += p.count;
}

void add_cone(const Polygon& p, uint8_t apex, Region& out) {
  if (p.size() == 4) add_piece(out, CellType::pyramid, {p[0], p[3], p[2], p[1], apex});
  else add_piece(out, CellType::tetra, {p[0], p[2], p[1], apex});
}

// Whether the polyhedron is a standard cell. Its faces look outward.
bool standard_cell(const std::vector<const Polygon*>& polygons, size_t vertices, Piece& out) {
  size_t quads = 0;
  for (const Polygon* p : polygons) quads += p->size() == 4;
  const size_t triangles = polygons.size() - quads;
  const Polygon* base = polygons[0];
  if (triangles == 4 && quads == 0 && vertices == 4) out.type = CellType::tetra;
  else if (triangles == 4 && quads == 1 && vertices == 5) out.type = CellType::pyramid;
  else if (triangles == 2 && quads == 3 && vertices == 6) out.type = CellType::wedge;
  else if (triangles == 0 && quads == 6 && vertices == 8) out.type = CellType::hexahedron;
  else return false;
  const size_t sides = out.type == CellType::pyramid || out.type == CellType::hexahedron ? 4 : 3;
  for (const Polygon* p : polygons)
    if (p->size() == sides) {
      base = p;
      break;
    }
  uint8_t n = 0;
  for (size_t i = 0; i < sides; ++i) out.v[n++] = (*base)[(sides - i) % sides];  // counter-clockwise seen from the top
  const size_t top = out.type == CellType::tetra || out.type == CellType::pyramid ? 1 : sides;
  for (size_t i = 0; i < top; ++i) {
    out.v[n] = above(polygons, *base, out.v[i]);
    if (out.v[n++] == 255) return false;
  }
  out.count = n;
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < i; ++k)
      if (out.v[i] == out.v[k]) return false;
  // As many triangles, quads and vertices do not make the same cell: two triangles can share an edge.
  const LinearTopology& t = *linear_topology(out.type);
  auto has_face = [&](auto face) {
    for (const Polygon* p : polygons)
      for (size_t s = 0; s < p->size() && p->size() == face.size(); ++s) {
        size_t k = 0;
        while (k < face.size() && (*p)[(s + k) % face.size()] == out.v[face[k]]) ++k;
        if (k == face.size()) return true;
      }
    return false;
  };
  for (size_t f = 0; f < t.face_count(); ++f)
    if (!has_face(t.face(f))) return false;
  return true;
}

// Closed polyhedra, whose faces look outward, as cells.
void fill(const std::vector<Polygon>& polygons, Region& out) {
  for (const auto& group : components(polygons)) {
    Polygon vertices;
    for (const Polygon* p : group) vertices.insert(vertices.end(), p->begin(), p->end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    if (vertices.size() < 4 || group.size() < 4) continue;  // folded flat
    for (const uint8_t v : vertices) out.used |= 1u << v;
    Piece piece{};
    if (standard_cell(group, vertices.size(), piece)) {
      out.pieces.push_back(piece);
      out.ids += piece.count;
      continue;
    }
    const auto middle = uint8_t(first_inner + out.inner.size());
    out.inner.push_back({vertices});
    for (const Polygon* p : group) add_cone(*p, middle, out);
  }
}

}  // namespace

// Divides one face, counter-clockwise seen from outside.
void ClipTable::divide(std::span<const uint8_t> face, uint32_t pattern, bool joined, uint32_t zero, Faces& faces) const {
  const size_t n = face.size();
  auto in = [&](size_t k) { return (pattern >> face[k % n] & 1) != 0; };
  auto cut = [&](size_t k) {  // between corners k and k + 1
    const uint8_t a = face[k % n], b = face[(k + 1) % n];
    if (zero >> a & 1) return a;
    if (zero >> b & 1) return b;
    return uint8_t(first_cut + edge(a, b));
  };
  bool positive = false, negative = false;
  for (size_t k = 0; k < n; ++k) {
    positive |= in(k) && !(zero >> face[k] & 1);
    negative |= !in(k);
  }
  const Polygon whole(face.begin(), face.end());
  if (!negative) return add_reduced(faces.in, whole);
  if (!positive) return add_reduced(faces.out, whole);
  if (n == 4 && in(0) == in(2) && in(1) == in(3)) {
    const size_t s = in(0) ? 0 : 1;  // inside: s and s + 2
    auto& band = joined ? faces.in : faces.out;
    const size_t t = joined ? s : s + 1;
    for (size_t k = 0; k < 4; ++k) add_reduced(in(k) ? faces.in : faces.out, {cut(k + 3), face[k], cut(k)});
    add_reduced(band, {cut(t + 3), cut(t), cut(t + 1), cut(t + 2)});
    return;
  }
  for (const bool side : {true, false}) {
    size_t s = 0, r = 0;
    while (!(in(s) == side && in(s + n - 1) != side)) ++s;
    while (in(s + r) == side) ++r;
    auto& to = side ? faces.in : faces.out;
    Polygon p{cut(s + n - 1), face[s % n]};
    if (r == 3) add_reduced(to, {face[s % n], face[(s + 1) % n], face[(s + 2) % n]});
    if (r > 1) p.push_back(face[(s + r - 1) % n]);
    p.push_back(cut(s + r - 1));
    add_reduced(to, std::move(p));
  }
}

namespace {

// Chains of edges that have no partner. Where corners are zero a chain can return to a point: each round trip is a loop of its own.
std::vector<Polygon> open_loops(const std::vector<Polygon>& polygons) {
  std::vector<Edge> open;
  for (const Polygon& p : polygons)
    for (size_t i = 0; i < p.size(); ++i) {
      const Edge e{p[i], p[(i + 1) % p.size()]};
      const auto partner = std::find(open.begin(), open.end(), Edge{e.second, e.first});
      if (partner != open.end()) open.erase(partner);
      else open.push_back(e);
    }
  std::vector<Polygon> loops;
  while (!open.empty()) {
    Polygon chain{open[0].first};
    while (!chain.empty()) {
      const auto next = std::find_if(open.begin(), open.end(), [&](const Edge& e) { return e.first == chain.back(); });
      if (next == open.end()) break;
      const uint8_t to = next->second;
      open.erase(next);
      const auto before = std::find(chain.begin(), chain.end(), to);
      if (before == chain.end()) chain.push_back(to);
      else {
        if (chain.end() - before >= 3) loops.emplace_back(before, chain.end());
        chain.erase(before + (before == chain.begin() ? 0 : 1), chain.end());
      }
    }
  }
  return loops;
}

}  // namespace

Vec3 ClipTable::middle_of(uint8_t code) const {
  auto at = [&](size_t c) { return Vec3(place_[c][0], place_[c][1], place_[c][2]); };
  if (code < first_cut) return at(code);
  const auto e = topology_->edges[size_t(code - first_cut)];
  return (at(e[0]) + at(e[1])) * 0.5;
}

uint32_t ClipTable::faces_of(uint8_t code) const {
  if (code < first_cut) return corner_faces_[code];
  const auto e = topology_->edges[size_t(code - first_cut)];
  return corner_faces_[e[0]] & corner_faces_[e[1]];
}

// Loops of three or four vertices stay whole; longer ones become triangles by short diagonals that lie in no face of the cell.
void ClipTable::divide_loop(const Polygon& loop, std::vector<Polygon>& out) const {
  const size_t n = loop.size();
  if (n <= 4) return out.push_back(loop);
  auto cost = [&](size_t a, size_t b) {
    if (b - a == 1 || b - a == n - 1) return 0.0;
    const Vec3 d = middle_of(loop[a]) - middle_of(loop[b]);
    return dot(d, d) + (faces_of(loop[a]) & faces_of(loop[b]) ? 1e3 : 0.0);
  };
  std::vector<double> best(n * n, 0.0);
  std::vector<size_t> apex(n * n, 0);
  for (size_t span = 2; span < n; ++span)
    for (size_t a = 0; a + span < n; ++a) {
      const size_t b = a + span;
      best[a * n + b] = HUGE_VAL;
      for (size_t m = a + 1; m < b; ++m) {
        const double c = best[a * n + m] + best[m * n + b] + cost(a, m) + cost(m, b);
        if (c < best[a * n + b] - 1e-9) best[a * n + b] = c, apex[a * n + b] = m;
      }
    }
  std::vector<std::pair<size_t, size_t>> pending{{0, n - 1}};
  while (!pending.empty()) {
    const auto [a, b] = pending.back();
    pending.pop_back();
    if (b - a < 2) continue;
    const size_t m = apex[a * n + b];
    out.push_back({loop[a], loop[m], loop[b]});
    pending.emplace_back(a, m);
    pending.emplace_back(m, b);
  }
}

ClipTable::Faces ClipTable::divided_faces(uint32_t pattern, uint32_t joined, uint32_t zero) const {
  Faces faces;
  for (size_t f = 0; f < topology_->face_count(); ++f) divide(topology_->face(f), pattern, joined >> f & 1, zero, faces);
  return faces;
}

// Closes what the faces leave open on the inside; the outside gets the same polygons the other way round.
void ClipTable::add_cut(Faces faces, uint32_t zero, Sides& out) const {
  std::vector<Polygon> cut;
  auto has_edge = [&](uint8_t a, uint8_t b) {
    for (const auto* side : {&faces.in, &faces.out})
      for (const Polygon& p : *side)
        for (size_t i = 0; i < p.size(); ++i)
          if (p[i] == a && p[(i + 1) % p.size()] == b) return true;
    return false;
  };
  for (const Polygon& loop : open_loops(faces.in)) {
    // Four points around a kept edge of the cell, or one of its faces' parts, leave a tetrahedron there: the other diagonal cuts it off.
    const bool low = loop.size() == 4 && (has_edge(loop[0], loop[2]) || has_edge(loop[2], loop[0]));
    const bool high = loop.size() == 4 && (has_edge(loop[1], loop[3]) || has_edge(loop[3], loop[1]));
    if (low != high) {
      const size_t s = low ? 1 : 0;
      cut.push_back({loop[s], loop[s + 1], loop[s + 2]});
      cut.push_back({loop[s], loop[s + 2], loop[(s + 3) % 4]});
    } else {
      divide_loop(loop, cut);
    }
  }
  for (const Polygon& p : cut) {
    faces.out.push_back(p);
    faces.in.emplace_back(p.rbegin(), p.rend());
  }
  out = {};
  fill(faces.in, out.in);
  fill(faces.out, out.out);
  find_cones(zero, out);
}

ClipTable::ClipTable(CellType type) : topology_(linear_topology(type)), place_(places_of(type)) {
  for (auto& row : edge_of_) row.fill(-1);
  for (size_t e = 0; e < topology_->edges.size(); ++e) {
    const auto [a, b] = topology_->edges[e];
    edge_of_[a][b] = edge_of_[b][a] = int8_t(e);
  }
  for (size_t f = 0; f < topology_->face_count(); ++f)
    for (const uint8_t c : topology_->face(f)) corner_faces_[c] |= 1u << f;
  size_t n = 0;
  for (uint8_t c = 1; c < uint8_t(topology_->corners); ++c)
    if (edge(0, c) >= 0) beside_[n++] = c;
  const auto at = [&](uint8_t c) { return middle_of(c) - middle_of(0); };
  if (dot(cross(at(beside_[0]), at(beside_[1])), at(beside_[2])) < 0) std::swap(beside_[0], beside_[1]);
  for (uint32_t p = 0; p < 1u << topology_->corners; ++p) {
    uint32_t mask = 0;
    for (size_t f = 0; f < topology_->face_count(); ++f) {
      const auto face = topology_->face(f);
      auto in = [&](size_t k) { return p >> face[k] & 1; };
      if (face.size() == 4 && in(0) == in(2) && in(1) == in(3) && in(0) != in(1)) mask |= 1u << f;
    }
    ambiguous_.push_back(mask);
    loops_.push_back(open_loops(divided_faces(p, 0, 0).in));
    first_.push_back(uint32_t(sides_.size()));
    uint32_t joined = 0;
    do {
      add_cut(divided_faces(p, joined, 0), 0, sides_.emplace_back());
      joined = (joined - mask) & mask;
    } while (joined != 0);
  }
}

uint32_t ClipTable::variant(uint32_t pattern, uint32_t joined) const {
  uint32_t at = 0, place = 0;
  for (uint32_t mask = ambiguous_[pattern]; mask; mask &= mask - 1, ++place) at |= uint32_t((joined & (mask & (0u - mask))) != 0) << place;
  return first_[pattern] + at;
}

void ClipTable::sides(uint32_t pattern, uint32_t joined, uint32_t zero, Sides& out) const {
  add_cut(divided_faces(pattern, joined, zero), zero, out);
}

// Which corners have a share in inner points, and cones that are not for certain over a part of the cell's own faces.
void ClipTable::find_cones(uint32_t zero, Sides& s) const {
  for (Region* r : {&s.in, &s.out}) {
    for (Inner& inner : r->inner)
      for (const uint8_t v : inner.of) {
        if (v < first_cut) inner.corners |= uint8_t(1u << v);
        else
          for (const uint8_t c : topology_->edges[size_t(v - first_cut)]) inner.corners |= uint8_t(1u << c);
      }
    for (const Piece& p : r->pieces) {
      if (p.v[p.count - 1] < first_inner) continue;
      uint32_t faces = ~0u;
      bool corner = false;  // one that the cut surface cannot have
      for (int k = 0; k + 1 < p.count; ++k) faces &= faces_of(p.v[k]), corner = corner || p.v[k] < first_cut;
      if (!zero && faces && corner) continue;
      Cone c{uint8_t(p.count - 1), {}, p.v[p.count - 1], r == &s.in};
      std::copy(p.v, p.v + c.count, c.v);
      s.cones.push_back(c);
    }
  }
}

bool ClipTable::folded(const Sides& sides, const double* h, const Vec3* places, const double* shares) const {
  if (sides.cones.empty()) return false;
  double at[max_codes][3], moved[max_codes][3];
  for (size_t c = 0; c < place_.size(); ++c)
    for (size_t a = 0; a < 3; ++a) at[c][a] = places ? places[c][int(a)] - places[0][int(a)] : place_[c][a];
  auto volume = [](const double* p, const double* q, const double* r, const double* s) {
    const double a[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, b[3] = {r[0] - p[0], r[1] - p[1], r[2] - p[2]};
    return (a[1] * b[2] - a[2] * b[1]) * (s[0] - p[0]) + (a[2] * b[0] - a[0] * b[2]) * (s[1] - p[1]) +
           (a[0] * b[1] - a[1] * b[0]) * (s[2] - p[2]);
  };
  // Flat pieces stay: what rounding makes of them is far less than the cell. Cells turned the other way keep their turn.
  const double whole = volume(at[0], at[beside_[0]], at[beside_[1]], at[beside_[2]]);
  const double turn = whole < 0 ? -1 : 1, nothing = -1e-14 * std::abs(whole);
  for (uint32_t left = (sides.in.used | sides.out.used) >> first_cut; left; left &= left - 1) {
    const auto e = size_t(std::countr_zero(left));
    const auto [a, b] = topology_->edges[e];
    const double t = h[a] / (h[a] - h[b]);
    for (size_t k = 0; k < 3; ++k) {
      at[first_cut + e][k] = at[a][k] + (at[b][k] - at[a][k]) * t;
      if (shares) moved[first_cut + e][k] = at[a][k] + (at[b][k] - at[a][k]) * shares[e];
    }
  }
  uint8_t apex = 0;
  bool side = false;
  for (const Cone& c : sides.cones) {
    double* top = at[c.apex];
    if (c.apex != apex || c.inside != side) {
      apex = c.apex, side = c.inside;
      const Inner& inner = (side ? sides.in : sides.out).inner[size_t(apex - first_inner)];
      top[0] = top[1] = top[2] = 0;
      for (const uint8_t v : inner.of)
        for (size_t k = 0; k < 3; ++k) top[k] += at[v][k];
      const double share = 1 / double(inner.of.size());
      for (size_t k = 0; k < 3; ++k) top[k] *= share;
    }
    const auto place = [&](int i) { return shares && c.v[i] >= first_cut && c.v[i] < first_inner ? moved[c.v[i]] : at[c.v[i]]; };
    auto negative = [&](int i, int j, int k) { return turn * volume(place(i), place(j), place(k), top) < nothing; };
    if (negative(0, 1, 2)) return true;
    if (c.count == 4 && (negative(0, 2, 3) || negative(0, 1, 3) || negative(1, 2, 3))) return true;
  }
  return false;
}

// From the middle of the cell the function is linear along each ray to a face, so that it changes sign once at most.
void ClipTable::star_sides(uint32_t pattern, uint32_t joined, uint32_t zero, const double* h, Sides& out) const {
  const auto corners = uint8_t(topology_->corners);
  Faces faces = divided_faces(pattern, joined, zero);
  double value = 0;
  for (size_t c = 0; c < corners; ++c) value += h[c] / double(corners);
  const bool middle_in = value >= 0;
  std::vector<Polygon>&near = middle_in ? faces.in : faces.out, &far = middle_in ? faces.out : faces.in;
  out = {};
  Region &around = middle_in ? out.in : out.out, &rest = middle_in ? out.out : out.in;
  Inner middle{{}};
  for (uint8_t c = 0; c < corners; ++c) middle.of.push_back(c);
  around.inner.push_back(middle), rest.inner.push_back(middle);
  for (uint8_t c = 0; c < corners; ++c) {
    const Inner cut{{first_inner, c}, value / (value - h[c])};
    around.inner.push_back(cut), rest.inner.push_back(cut);
  }
  auto image = [&](uint8_t v) { return v < first_cut && !(zero >> v & 1) ? uint8_t(first_inner + 1 + v) : v; };
  for (const Polygon& p : near) add_cone(p, first_inner, around);
  for (const Polygon& p : far) {
    Polygon top = p;
    for (uint8_t& v : top) v = image(v);
    const size_t n = p.size();
    size_t free = 0, s = 0;
    for (size_t k = 0; k < n; ++k) free += top[k] != p[k];
    if (free > 0 && free < n)  // the free vertices follow one another: 0, 1, ...
      while (!(top[s % n] != p[s % n] && top[(s + n - 1) % n] == p[(s + n - 1) % n])) ++s;
    auto v = [&](size_t k) { return p[(s + k) % n]; };
    auto w = [&](size_t k) { return top[(s + k) % n]; };
    if (n == 4 && (free == 1 || free == 3)) {  // a corner where the value is zero: from the middle one of those that are not
      const size_t m = free / 2;
      add_cone({w(m), w(m + 1), w(m + 2)}, first_inner, around);
      add_cone({w(m), w(m + 2), w(m + 3)}, first_inner, around);
      add_cone(p, w(m), rest);
      if (free == 3) add_piece(rest, CellType::tetra, {v(3), w(0), v(0), w(1)}), add_piece(rest, CellType::tetra, {v(3), v(2), w(2), w(1)});
      continue;
    }
    if (n == 4 && free == 2 && top[s % n] != p[s % n] && top[(s + 2) % n] != p[(s + 2) % n]) {  // opposite corners are zero: the same
      add_cone({w(0), w(1), w(2)}, first_inner, around);
      add_cone({w(0), w(2), w(3)}, first_inner, around);
      add_cone(p, w(0), rest);
      add_piece(rest, CellType::tetra, {v(1), v(2), w(2), w(0)});
      add_piece(rest, CellType::tetra, {v(2), v(3), w(2), w(0)});
      continue;
    }
    add_cone(top, first_inner, around);
    if (free == n && n == 3) add_piece(rest, CellType::wedge, {w(0), w(1), w(2), v(0), v(1), v(2)});
    else if (free == 4) add_piece(rest, CellType::hexahedron, {w(0), w(1), w(2), w(3), v(0), v(1), v(2), v(3)});
    else if (n == 4 && free == 2) add_piece(rest, CellType::wedge, {v(3), v(0), w(0), v(2), v(1), w(1)});
    else if (free == 2) add_piece(rest, CellType::pyramid, {v(0), v(1), w(1), w(0), v(2)});
    else if (free == 1) add_piece(rest, CellType::tetra, {w(0), v(1), v(2), v(0)});
  }
  for (Region* r : {&out.in, &out.out})
    for (const Piece& p : r->pieces)
      for (int k = 0; k < p.count; ++k)
        if (p.v[k] < first_inner) r->used |= 1u << p.v[k];
}

const ClipTable* clip_table(CellType type) {
  switch (type) {
    case CellType::tetra: {
      static const ClipTable t(type);
      return &t;
    }
    case CellType::pyramid: {
      static const ClipTable t(type);
      return &t;
    }
    case CellType::wedge: {
      static const ClipTable t(type);
      return &t;
    }
    case CellType::voxel: {
      static const ClipTable t(type);
      return &t;
    }
    case CellType::hexahedron: {
      static const ClipTable t(type);
      return &t;
    }
    default: return nullptr;
  }
}

}  // namespace sg::clipping
