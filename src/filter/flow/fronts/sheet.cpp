// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/fronts/sheet.h"

#include <algorithm>

#include "filter/flow/unsteady/advance_one.h"

namespace sg {

uint32_t Sheet::add(Vec3 x, double t, double seed_parameter) {
  Particle p;
  p.x = x, p.t = t;
  particles.push_back(p), s.push_back(seed_parameter), born.push_back(t);
  return uint32_t(particles.size() - 1);
}

bool Sheet::split(UnsteadyCursor& flow, double t, double longest) {
  using Edge = std::array<uint32_t, 2>;
  const auto edge_of = [](uint32_t a, uint32_t b) { return a < b ? Edge{a, b} : Edge{b, a}; };
  const auto size = [&](const Edge& e) { return length(particles[e[0]].x - particles[e[1]].x); };
  std::vector<Edge> edges;
  for (const auto& tri : triangles)
    for (size_t k = 0; k < 3; ++k) {
      const Edge e = edge_of(tri[k], tri[(k + 1) % 3]);
      if (!particles[e[0]].ended && !particles[e[1]].ended && size(e) > longest) edges.push_back(e);
    }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  constexpr uint32_t none = UINT32_MAX;
  std::vector<uint32_t> middle(edges.size(), none);
  bool any = false;
  for (size_t i = 0; i < edges.size(); ++i) {
    const Particle &a = particles[edges[i][0]], &b = particles[edges[i][1]];
    Particle m;
    m.x = (a.x + b.x) / 2.0, m.t = t, m.steps = std::max(a.steps, b.steps);
    if (!detail::start_particle(flow, m)) continue;  // across a hole: the edge stays, until it is torn
    middle[i] = uint32_t(particles.size());
    const double sa = s[edges[i][0]], sb = s[edges[i][1]], ba = born[edges[i][0]], bb = born[edges[i][1]];
    particles.push_back(m), s.push_back((sa + sb) / 2), born.push_back((ba + bb) / 2);
    any = true;
  }
  if (!any) return false;
  const auto middle_of = [&](uint32_t a, uint32_t b) {
    const auto at = std::lower_bound(edges.begin(), edges.end(), edge_of(a, b));
    return at != edges.end() && *at == edge_of(a, b) ? middle[size_t(at - edges.begin())] : none;
  };
  std::vector<std::array<uint32_t, 3>> out;
  out.reserve(triangles.size() * 2);
  for (const auto& tri : triangles) {
    uint32_t m[3];
    int n = 0;
    for (size_t k = 0; k < 3; ++k) n += (m[k] = middle_of(tri[k], tri[(k + 1) % 3])) != none;
    if (n == 0) {
      out.push_back(tri);
    } else if (n == 3) {
      out.insert(out.end(), {{tri[0], m[0], m[2]}, {m[0], tri[1], m[1]}, {m[2], m[1], tri[2]}, {m[0], m[1], m[2]}});
    } else {
      // Turned so that edge 0 is split and, of two, edge 1 too.
      size_t k = 0;
      while (m[k] == none || (n == 2 && m[(k + 1) % 3] == none)) ++k;
      const uint32_t a = tri[k], b = tri[(k + 1) % 3], c = tri[(k + 2) % 3], p = m[k];
      if (n == 1) {
        out.insert(out.end(), {{a, p, c}, {p, b, c}});
        continue;
      }
      const uint32_t q = m[(k + 1) % 3];
      out.push_back({p, b, q});
      if (length(particles[a].x - particles[q].x) < length(particles[p].x - particles[c].x)) out.insert(out.end(), {{a, p, q}, {a, q, c}});
      else out.insert(out.end(), {{a, p, c}, {p, q, c}});
    }
  }
  triangles = std::move(out);
  return true;
}

void Sheet::refine(UnsteadyCursor& flow, double t, double longest, double tear, size_t most) {
  for (int pass = 0; pass < 8 && particles.size() < most && split(flow, t, longest); ++pass) {
  }
  // Particles rest where they left the flow: with one or two of them a triangle reaches the border, until the others have gone on.
  std::erase_if(triangles, [&](const std::array<uint32_t, 3>& tri) {
    int ended = 0;
    for (size_t k = 0; k < 3; ++k) {
      const Particle &a = particles[tri[k]], &b = particles[tri[(k + 1) % 3]];
      ended += a.ended;
      if (length(a.x - b.x) > (a.ended || b.ended ? 1.5 * longest : tear)) return true;
    }
    return ended == 3;
  });
}

}  // namespace sg
