// SPDX-License-Identifier: Apache-2.0
#include "filter/scalar/contour/cells/cell_cases.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"

namespace sg {

void CaseShape::find_edges() {
  if (!edges.empty()) return;
  for (const auto& f : faces)
    for (size_t k = 0; k < f.size(); ++k) {
      const uint8_t a = std::min(f[k], f[(k + 1) % f.size()]), b = std::max(f[k], f[(k + 1) % f.size()]);
      if (std::find(edges.begin(), edges.end(), std::array<uint8_t, 2>{a, b}) == edges.end()) edges.push_back({a, b});
    }
}

CaseTable::CaseTable(CaseShape shape) : shape_(std::move(shape)) {
  shape_.find_edges();
  edge_faces_.resize(shape_.edges.size());
  for (size_t f = 0; f < shape_.faces.size(); ++f) {
    const auto& face = shape_.faces[f];
    auto& around = face_edges_.emplace_back();
    for (size_t k = 0; k < face.size(); ++k) {
      const uint8_t a = std::min(face[k], face[(k + 1) % face.size()]), b = std::max(face[k], face[(k + 1) % face.size()]);
      const auto at = std::find(shape_.edges.begin(), shape_.edges.end(), std::array<uint8_t, 2>{a, b});
      around.push_back(uint8_t(at - shape_.edges.begin()));
      edge_faces_[around.back()] |= 1u << f;
    }
  }
  const uint32_t patterns = 1u << shape_.corners;
  begin_.push_back(0);
  for (uint32_t p = 0; p < patterns; ++p) {
    uint32_t mask = 0;
    for (size_t f = 0; f < shape_.faces.size(); ++f) {
      const auto& face = shape_.faces[f];
      auto in = [&](size_t k) { return p >> face[k] & 1; };
      if (face.size() == 4 && in(0) == in(2) && in(1) == in(3) && in(0) != in(1)) mask |= 1u << f;
    }
    ambiguous_.push_back(mask);
    first_.push_back(uint32_t(begin_.size() - 1));
    uint32_t joined = 0;
    do {  // all subsets of mask in the order of packed()
      for (const auto& loop : loops(p, joined)) fill(loop);
      begin_.push_back(uint32_t(edges_.size()));
      joined = (joined - mask) & mask;
    } while (joined != 0);
  }
}

std::vector<std::vector<uint8_t>> CaseTable::loops(uint32_t pattern, uint32_t joined) const {
  constexpr uint8_t none = 255;
  std::vector<uint8_t> next(shape_.edges.size(), none);
  for (size_t f = 0; f < shape_.faces.size(); ++f) {
    // Around the face the boundary enters an inside run at one edge and leaves it at another. The segment that cuts a run off
    // goes from entry to exit; where runs are joined it goes from the entry of the next run to the exit of this one.
    const auto& face = shape_.faces[f];
    std::vector<uint8_t> entry, exit;
    const size_t n = face.size();
    size_t start = 0;
    while (start < n && !(!(pattern >> face[start] & 1) && (pattern >> face[(start + 1) % n] & 1))) ++start;
    if (start == n) continue;
    for (size_t s = 0; s < n; ++s) {
      const size_t k = (start + s) % n;
      const bool a = pattern >> face[k] & 1, b = pattern >> face[(k + 1) % n] & 1;
      if (!a && b) entry.push_back(face_edges_[f][k]);
      if (a && !b) exit.push_back(face_edges_[f][k]);
    }
    const bool join = ambiguous_[pattern] >> f & joined >> f & 1;
    for (size_t r = 0; r < entry.size(); ++r) next[entry[join ? (r + 1) % entry.size() : r]] = exit[r];
  }
  std::vector<std::vector<uint8_t>> r;
  for (size_t e = 0; e < next.size(); ++e) {
    if (next[e] == none) continue;
    auto& loop = r.emplace_back();
    for (uint8_t at = uint8_t(e); next[at] != none;) {
      loop.push_back(at);
      at = std::exchange(next[at], none);
    }
  }
  return r;
}

// Dynamic programming over the diagonals: the best filling of the places a..b for all a < b, short spans first.
std::vector<std::array<uint32_t, 3>> fill_loop(size_t n, const std::function<double(size_t, size_t)>& cost) {
  auto diagonal = [&](size_t a, size_t b) { return b - a == 1 || b - a == n - 1 ? 0.0 : cost(a, b); };
  std::vector<double> best(n * n, 0.0);
  std::vector<size_t> apex(n * n, 0);
  for (size_t span = 2; span < n; ++span)
    for (size_t a = 0; a + span < n; ++a) {
      const size_t b = a + span;
      double& least = best[a * n + b];
      least = HUGE_VAL;
      for (size_t m = a + 1; m < b; ++m) {
        const double c = best[a * n + m] + best[m * n + b] + diagonal(a, m) + diagonal(m, b);
        if (c < least - 1e-9) least = c, apex[a * n + b] = m;
      }
    }
  std::vector<std::array<uint32_t, 3>> r;
  auto emit = [&](auto&& self, size_t a, size_t b) -> void {
    if (b - a < 2) return;
    const size_t m = apex[a * n + b];
    r.push_back({uint32_t(a), uint32_t(m), uint32_t(b)});
    self(self, a, m);
    self(self, m, b);
  };
  if (n >= 3) emit(emit, 0, n - 1);
  return r;
}

// No diagonal along a face, or else from entry to entry; then short ones.
void CaseTable::fill(const std::vector<uint8_t>& loop) {
  const size_t n = loop.size();
  auto middle = [&](uint8_t e, size_t c) {
    return 0.5 * (double(shape_.place[shape_.edges[e][0]][c]) + double(shape_.place[shape_.edges[e][1]][c]));
  };
  auto cost = [&](size_t a, size_t b) {
    const uint32_t face = shared_face(loop[a], loop[b]);
    const bool entries = face == shared_face(loop[a], loop[a + 1]) && face == shared_face(loop[b], loop[(b + 1) % n]);
    double d = face == 0 ? 0.0 : face_penalty(entries);
    for (size_t c = 0; c < 3; ++c) d += std::pow(middle(loop[a], c) - middle(loop[b], c), 2);
    return d;
  };
  for (const auto& t : fill_loop(n, cost)) {
    edges_.insert(edges_.end(), {loop[t[0]], loop[t[1]], loop[t[2]]});
    for (auto [a, b] : {std::pair{t[0], t[1]}, {t[1], t[2]}, {t[0], t[2]}})
      if (b - a > 1 && b - a < n - 1 && cost(a, b) >= face_penalty(false)) ++bad_;
  }
}

const CaseTable& lattice_cases() {
  static const CaseTable table([] {
    CaseShape s;
    s.corners = 8;
    s.faces = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (uint8_t c : {0, 2, 4, 6}) s.edges.push_back({c, uint8_t(c + 1)});
    for (uint8_t c : {0, 1, 4, 5}) s.edges.push_back({c, uint8_t(c + 2)});
    for (uint8_t c : {0, 1, 2, 3}) s.edges.push_back({c, uint8_t(c + 4)});
    for (int c = 0; c < 8; ++c) s.place.push_back({float(c & 1), float(c >> 1 & 1), float(c >> 2)}), s.mirror.push_back(uint8_t(c ^ 4));
    return s;
  }());
  return table;
}

namespace {

// An n-gon and its copy above: corners 0..n-1 below, n..2n-1 above; below is counterclockwise seen from above.
CaseShape prism(int n) {
  CaseShape s;
  s.corners = 2 * n;
  std::vector<uint8_t> below, above;
  for (int c = 0; c < n; ++c) {
    below.push_back(uint8_t(n - 1 - c));
    above.push_back(uint8_t(n + c));
    const uint8_t a = uint8_t(c), b = uint8_t((c + 1) % n);
    s.faces.push_back({a, b, uint8_t(b + n), uint8_t(a + n)});
  }
  s.faces.push_back(below);
  s.faces.push_back(above);
  for (int c = 0; c < 2 * n; ++c) {
    const double angle = 2 * M_PI * double(c % n) / n;
    s.place.push_back({float(std::cos(angle)), float(std::sin(angle)), float(c / n)});
    s.mirror.push_back(uint8_t((c + n) % (2 * n)));
  }
  return s;
}

}  // namespace

const CaseTable* cell_cases(CellType type) {
  switch (type) {
    case CellType::tetra: {
      static const CaseTable t(
          {4, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}, {}, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {1, 0, 2, 3}});
      return &t;
    }
    case CellType::pyramid: {
      static const CaseTable t({5,
                                {{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}},
                                {},
                                {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {.5f, .5f, 1}},
                                {0, 3, 2, 1, 4}});
      return &t;
    }
    case CellType::wedge: {
      static const CaseTable t(prism(3));
      return &t;
    }
    case CellType::hexahedron: {
      static const CaseTable t(prism(4));
      return &t;
    }
    case CellType::voxel: return &lattice_cases();
    case CellType::pentagonal_prism: {
      static const CaseTable t(prism(5));
      return &t;
    }
    case CellType::hexagonal_prism: {
      static const CaseTable t(prism(6));
      return &t;
    }
    default: return nullptr;
  }
}

}  // namespace sg
