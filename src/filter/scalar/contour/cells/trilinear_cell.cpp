// SPDX-License-Identifier: Apache-2.0
#include "filter/scalar/contour/cells/trilinear_cell.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/vec.h"

namespace sg {

namespace {

// Loops of fewer edges are filled without an extra point.
constexpr int long_loop = 7;

struct Loops {
  std::array<uint8_t, 12> edges{};  // loop after loop
  std::array<uint8_t, 5> begin{};
  int count = 0;
  int size(int l) const { return begin[size_t(l) + 1] - begin[size_t(l)]; }
  uint8_t edge(int l, int k) const { return edges[size_t(begin[size_t(l)] + k % size(l))]; }
};

// The loops of all patterns and all ways to join the faces' corners.
class LoopTable {
 public:
  LoopTable() {
    const CaseTable& cases = lattice_cases();
    for (uint32_t p = 0; p < 256; ++p) {
      const uint32_t mask = cases.ambiguous(p);
      first_[p] = uint32_t(all_.size());
      uint32_t joined = 0;
      do {
        Loops l;
        for (const auto& loop : cases.loops(p, joined)) {
          std::copy(loop.begin(), loop.end(), l.edges.begin() + l.begin[size_t(l.count)]);
          ++l.count;
          l.begin[size_t(l.count)] = uint8_t(l.begin[size_t(l.count) - 1] + loop.size());
        }
        all_.push_back(l);
        joined = (joined - mask) & mask;
      } while (joined != 0);
    }
  }
  const Loops& at(uint32_t pattern, uint32_t joined) const {
    uint32_t v = first_[pattern], bit = 0;
    for (uint32_t m = lattice_cases().ambiguous(pattern); m; m &= m - 1, ++bit) v += uint32_t((joined & (m & (0u - m))) != 0) << bit;
    return all_[v];
  }

 private:
  std::array<uint32_t, 256> first_{};
  std::vector<Loops> all_;
};

const LoopTable& loop_table() {
  static const LoopTable table;
  return table;
}

double value_at(const double f[8], Vec3 p) {
  auto along_u = [&](int c) { return f[c] + (f[c + 1] - f[c]) * p.x; };
  const double low = along_u(0) + (along_u(2) - along_u(0)) * p.y, high = along_u(4) + (along_u(6) - along_u(4)) * p.y;
  return low + (high - low) * p.z;
}

Vec3 gradient_at(const double f[8], Vec3 p) {
  auto mix = [](double a, double b, double t) { return a + (b - a) * t; };
  Vec3 g;
  g.x = mix(mix(f[1] - f[0], f[3] - f[2], p.y), mix(f[5] - f[4], f[7] - f[6], p.y), p.z);
  g.y = mix(mix(f[2] - f[0], f[3] - f[1], p.x), mix(f[6] - f[4], f[7] - f[5], p.x), p.z);
  g.z = mix(mix(f[4] - f[0], f[5] - f[1], p.x), mix(f[6] - f[2], f[7] - f[3], p.x), p.y);
  return g;
}

struct Cutter {
  const double* f;
  uint32_t pattern = 0, joined = 0;
  const Loops* loops = nullptr;
  TrilinearCell& out;
  std::array<Vec3, 20> place{};  // of all names

  const bool places;

  Cutter(const double values[8], TrilinearCell& result, bool with_places) : f(values), out(result), places(with_places) {
    const CaseShape& shape = lattice_cases().shape();
    for (uint32_t c = 0; c < 8; ++c) pattern |= uint32_t(f[c] >= 0) << c;
    for (uint32_t m = lattice_cases().ambiguous(pattern); m; m &= m - 1) {
      const auto& face = shape.faces[size_t(std::countr_zero(m))];
      joined |= uint32_t(joined_inside(f[face[0]], f[face[1]], f[face[2]], f[face[3]])) << std::countr_zero(m);
    }
    loops = &loop_table().at(pattern, joined);
    for (int l = 0; l < loops->begin[size_t(loops->count)]; ++l) {
      const uint8_t e = loops->edges[size_t(l)];
      const auto [a, b] = shape.edges[e];
      const double t = f[a] / (f[a] - f[b]);
      Vec3 p(a & 1, a >> 1 & 1, a >> 2);
      p[e / 4] = t >= 0 && t <= 1 ? t : 0.5;
      place[e] = p;
    }
  }

  uint8_t add_inner(Vec3 p) {
    for (int a = 0; a < 3; ++a) p[a] = std::clamp(p[a], 1e-6, 1 - 1e-6);
    const uint8_t name = uint8_t(TrilinearCell::first_inner + out.inner_count);
    place[name] = p;
    out.inner[size_t(out.inner_count++)] = {p.x, p.y, p.z};
    return name;
  }
  uint32_t lattice_ambiguous() const { return lattice_cases().ambiguous(pattern); }
  void triangle(uint8_t a, uint8_t b, uint8_t c) { out.triangles[size_t(out.triangle_count++)] = {a, b, c}; }
  double cost(uint8_t a, uint8_t b) const {
    const Vec3 d = place[a] - place[b];
    return dot(d, d);
  }

  void fill(int l);
  void fan(int l);
  void tube_or_discs();
};

// The disc of a short loop: the lattice table's choice of diagonals for this loop only.
void Cutter::fill(int l) {
  const auto all = lattice_cases().triangles(pattern, joined);
  uint32_t mine = 0;
  for (int k = 0; k < loops->size(l); ++k) mine |= 1u << loops->edge(l, k);
  for (size_t t = 0; t < all.size(); t += 3)
    if (mine >> all[t] & 1) triangle(all[t], all[t + 1], all[t + 2]);
}

// The disc of a long loop: a fan round a point of the surface.
void Cutter::fan(int l) {
  const int n = loops->size(l);
  if (!places) {
    out.triangle_count += n, ++out.inner_count;
    return;
  }
  Vec3 mean;
  for (int k = 0; k < n; ++k) mean = mean + place[loops->edge(l, k)] * (1.0 / n);
  Vec3 p = mean;
  for (int step = 0; step < 8; ++step) {
    const Vec3 g = gradient_at(f, p);
    const double v = value_at(f, p), square = dot(g, g);
    if (!(square > 0) || !std::isfinite(v / square)) break;
    const Vec3 q = p - g * (v / square);
    bool in = true;
    for (int a = 0; a < 3; ++a) in = in && q[a] > 0.02 && q[a] < 0.98;
    if (!in) break;
    p = q;
    if (v * v < 1e-18 * square) break;
  }
  const uint8_t center = add_inner(p);
  for (int k = 0; k < n; ++k) triangle(loops->edge(l, k), loops->edge(l, k + 1), center);
}

// Where a line of the hexagon meets the border: a loop, and a place in it (k + a fraction between its points k and k+1).
struct Hit {
  int loop = -1;
  double at = 0;
};

uint8_t edge_at(int axis, int corner) {
  const int low = corner & ~(1 << axis);
  return uint8_t(axis == 0 ? low >> 1 : axis == 1 ? 4 + (low & 1) + (low >> 2 << 1) : 8 + low);
}

// The closed hexagon of straight lines on the surface, and what lies at its sides.
class Hexagon {
 public:
  Hexagon(const Cutter& cutter) : cut_(cutter), f_(cutter.f) {}
  /// Whether it lies in the cell, with two loops at its sides.
  bool find();
  /// Its points along loop `side` (0, 1): places in the loop in its direction, growing; first point and step in `points`.
  struct Ring {
    std::array<double, 6> at;
    std::array<int, 6> point;
  };
  Ring ring(int side) const;
  int loop(int side) const { return pair_[side]; }
  const Vec3& point(int i) const { return p_[size_t(i)]; }

 private:
  bool place_points();
  Hit hit(int axis, int side, Vec3 p) const;
  double turns(int side, bool forward) const;

  const Cutter& cut_;
  const double* f_;
  double raised_[8];
  std::array<Vec3, 6> p_;
  std::array<Hit, 12> hits_;  // two of each point, in the order along a loop that runs like the hexagon
  int pair_[2] = {-1, -1};
};

// The roots of the quadratic whose zeros are the heights where the hyperbola u,v degenerates, and its centres there.
bool Hexagon::place_points() {
  const double* g = raised_;
  const double a0 = g[0], b0 = g[1], c0 = g[3], d0 = g[2];
  const double a1 = g[4] - a0, b1 = g[5] - b0, c1 = g[7] - c0, d1 = g[6] - d0;
  const double q2 = a1 * c1 - b1 * d1, q1 = a0 * c1 + a1 * c0 - b0 * d1 - b1 * d0, q0 = a0 * c0 - b0 * d0;
  const double square = q1 * q1 - 4 * q0 * q2;
  if (!(square > 0)) return false;
  const double t = -0.5 * (q1 + std::copysign(std::sqrt(square), q1));
  const double w[2] = {t / q2, q0 / t};
  double u[2], v[2];
  for (int r = 0; r < 2; ++r) {
    if (!(w[r] > 0 && w[r] < 1)) return false;
    const double a = a0 + a1 * w[r], b = b0 + b1 * w[r], c = c0 + c1 * w[r], d = d0 + d1 * w[r], e = a - b + c - d;
    u[r] = (a - d) / e, v[r] = (a - b) / e;
    if (!(u[r] > 0 && u[r] < 1 && v[r] > 0 && v[r] < 1)) return false;
  }
  p_ = {Vec3(u[0], v[0], w[0]), {u[0], v[1], w[0]}, {u[0], v[1], w[1]}, {u[1], v[1], w[1]}, {u[1], v[0], w[1]}, {u[1], v[0], w[0]}};
  return true;
}

// The surface's arc through p on the face where coordinate `axis` is `side`.
Hit Hexagon::hit(int axis, int side, Vec3 p) const {
  const int s = axis == 0 ? 1 : 0, t = axis == 2 ? 1 : 2, base = side << axis;
  const int corner[4] = {base, base | 1 << s, base | 1 << t, base | 1 << s | 1 << t};  // (0,0) (1,0) (0,1) (1,1)
  uint8_t from = 255, to = 255;
  if (cut_.lattice_ambiguous() >> (2 * axis + side) & 1) {
    const double a = raised_[corner[0]], b = raised_[corner[1]], c = raised_[corner[3]], d = raised_[corner[2]], e = a - b + c - d;
    const double ds = p[s] - (a - d) / e, dt = p[t] - (a - b) / e;
    const bool joined = cut_.joined >> (2 * axis + side) & 1, diagonal = (cut_.pattern >> corner[0] & 1) != uint32_t(joined);
    const int c0 = diagonal ? ds + dt < 0 ? corner[0] : corner[3] : ds - dt > 0 ? corner[1] : corner[2];  // the corner it cuts off
    from = edge_at(s, c0), to = edge_at(t, c0);
  } else {
    for (const uint8_t e : {edge_at(s, corner[0]), edge_at(s, corner[2]), edge_at(t, corner[0]), edge_at(t, corner[1])}) {
      const auto [x, y] = lattice_cases().shape().edges[e];
      if ((cut_.pattern >> x & 1) == (cut_.pattern >> y & 1)) continue;
      (from == 255 ? from : to) = e;
    }
  }
  for (int l = 0; l < cut_.loops->count; ++l)
    for (int k = 0; k < cut_.loops->size(l); ++k) {
      const uint8_t x = cut_.loops->edge(l, k), y = cut_.loops->edge(l, k + 1);
      if (!((x == from && y == to) || (x == to && y == from))) continue;
      const Vec3 chord = cut_.place[y] - cut_.place[x];
      const double f = dot(p - cut_.place[x], chord) / dot(chord, chord);
      return {l, k + (f >= 0 && f <= 1 ? f : 0.5)};
    }
  return {};
}

// How often the hits, in order, run round the loop; 1 in the loop's own direction. Steps back inside one segment are rounding.
double Hexagon::turns(int side, bool forward) const {
  const int n = cut_.loops->size(pair_[side]);
  double sum = 0, last = -1, first = -1;
  auto step = [&](double from, double to) {
    if (int(from) == int(to)) return 0.0;
    const double d = forward ? to - from : from - to;
    return d < 0 ? d + n : d;
  };
  for (int h = 0; h < 12; ++h) {
    const double at = hits_[size_t(h)].at;
    if (hits_[size_t(h)].loop != pair_[side]) continue;
    if (last >= 0) sum += step(last, at);
    else first = at;
    last = at;
  }
  return (sum + step(last, first)) / n;
}

bool Hexagon::find() {
  double largest = 0;
  for (int c = 0; c < 8; ++c) largest = std::max(largest, std::abs(f_[c]));
  for (int c = 0; c < 8; ++c) raised_[c] = f_[c] + std::ldexp(largest, -36);  // ties; far above rounding
  if (!place_points()) return false;
  for (int i = 0; i < 6; ++i) {
    // The lines of the edges that meet here run on to the border, both on the same side of the hexagon.
    const Vec3 &p = p_[size_t(i)], &before = p_[size_t((i + 5) % 6)], &after = p_[size_t((i + 1) % 6)];
    const int in = i % 3, on = (i + 1) % 3;  // axes of the edge before and of the edge after
    hits_[size_t(2 * i)] = hit(on, p[on] > after[on], p);
    hits_[size_t(2 * i + 1)] = hit(in, p[in] > before[in], p);
    if (hits_[size_t(2 * i)].loop != hits_[size_t(2 * i + 1)].loop) return false;
    const int l = hits_[size_t(2 * i)].loop;
    if (l < 0) return false;
    if (pair_[0] < 0) pair_[0] = l;
    else if (l != pair_[0] && pair_[1] < 0) pair_[1] = l;
    else if (l != pair_[0] && l != pair_[1]) return false;
  }
  return pair_[1] >= 0;
}

Hexagon::Ring Hexagon::ring(int side) const {
  const int n = cut_.loops->size(pair_[side]);
  auto off = [&](int s, bool forward) { return std::abs(turns(s, forward) - 1); };
  const bool like_first = off(0, true) + off(1, false) <= off(0, false) + off(1, true);
  const bool forward = like_first == (side == 0);
  // In the loop's direction: each point of this side lies between its two hits, one of the other side between its neighbours' hits.
  std::array<double, 24> at;
  auto known = [&](int h) { return hits_[size_t(h)].loop == pair_[side]; };
  auto order = [&](int h) { return forward ? h % 12 : 11 - h % 12; };
  int start = 0;
  while (!known(order(start)) || known(order(start + 11))) ++start;
  start -= start % 2;
  double last = hits_[size_t(order(start))].at;
  for (int h = 0; h < 12; ++h) {
    const int from = order(start + h);
    if (known(from)) {
      const double to = hits_[size_t(from)].at, now = std::fmod(last, n);
      if (int(to) == int(now)) last += std::max(0.0, to - now);
      else last += to > now ? to - now : to - now + n;
      at[size_t(h)] = last;
    } else {
      at[size_t(h)] = -1;
    }
  }
  const double first = at[0], end = first + n;
  for (double& a : at) a = std::min(a, end);
  Ring r;
  for (int i = 0; i < 6; ++i) {
    r.point[size_t(i)] = order(start + 2 * i) / 2;
    double lo = at[size_t(2 * i)], hi = at[size_t(2 * i + 1)];
    if (lo < 0) {
      for (int h = 2 * i; h >= 0 && lo < 0; --h) lo = at[size_t(h)];
      for (int h = 2 * i; h < 12 && hi < 0; ++h) hi = at[size_t(h)];
      if (hi < 0) hi = end;
    }
    r.at[size_t(i)] = 0.5 * (lo + hi);
  }
  return r;
}

// Triangles between a loop and the hexagon: both run in steps, and the step whose middle comes first goes first.
void strip(Cutter& cut, int l, const Hexagon::Ring& ring, const std::array<uint8_t, 6>& names) {
  const int n = cut.loops->size(l), first = int(std::floor(ring.at[0] + 0.5));
  for (int i = 0, k = 0; i < 6 || k < n;) {
    const double ring_middle = 0.5 * (ring.at[size_t(i % 6)] + (i + 1 < 6 ? ring.at[size_t(i + 1)] : ring.at[size_t((i + 1) % 6)] + n));
    const uint8_t inner = names[size_t(ring.point[size_t(i % 6)])], next = names[size_t(ring.point[size_t((i + 1) % 6)])];
    const uint8_t here = cut.loops->edge(l, first + k), there = cut.loops->edge(l, first + k + 1);
    if (k < n && (i >= 6 || first + k + 0.5 <= ring_middle)) cut.triangle(here, there, inner), ++k;
    else cut.triangle(here, next, inner), ++i;
  }
}

void Cutter::tube_or_discs() {
  Hexagon hexagon(*this);
  out.tube = loops->count > 1 && hexagon.find();
  if (out.tube) {
    if (!places) {
      for (int side = 0; side < 2; ++side) out.triangle_count += loops->size(hexagon.loop(side)) + 6;
      out.inner_count = 6;
    }
    std::array<uint8_t, 6> names;
    for (int i = 0; i < 6 && places; ++i) names[size_t(i)] = add_inner(hexagon.point(i));
    for (int side = 0; side < 2 && places; ++side) strip(*this, hexagon.loop(side), hexagon.ring(side), names);
  }
  for (int l = 0; l < loops->count; ++l) {
    if (out.tube && (l == hexagon.loop(0) || l == hexagon.loop(1))) continue;
    if (loops->size(l) < long_loop) fill(l);
    else fan(l);
  }
}

}  // namespace

void cut_trilinear(const double f[8], TrilinearCell& out, bool places) {
  out.triangle_count = out.inner_count = 0;
  out.tube = false;
  Cutter cutter(f, out, places);
  if (needs_trilinear(cutter.pattern)) return cutter.tube_or_discs();
  for (int l = 0; l < cutter.loops->count; ++l) cutter.fill(l);
}

bool needs_trilinear(uint32_t pattern) {
  static const std::array<bool, 256> needed = [] {
    std::array<bool, 256> r{};
    for (uint32_t p = 0; p < 256; ++p) r[p] = lattice_cases().ambiguous(p) || loop_table().at(p, 0).count > 1;
    return r;
  }();
  return needed[pattern];
}

}  // namespace sg
