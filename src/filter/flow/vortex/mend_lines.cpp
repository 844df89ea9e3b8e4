// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/vortex/mend_lines.h"

#include <algorithm>
#include <set>

#include "base/union_find.h"

namespace sg::parallel {

namespace {

// The points with one segment, by x.
std::vector<uint32_t> ends_of(const ParallelLines& lines) {
  std::vector<uint8_t> segments(lines.points.size(), 0);
  for (const uint32_t p : lines.segments) segments[p] = uint8_t(std::min(segments[p] + 1, 2));
  std::vector<uint32_t> ends;
  for (uint32_t p = 0; p < segments.size(); ++p)
    if (segments[p] == 1) ends.push_back(p);
  std::stable_sort(ends.begin(), ends.end(), [&](uint32_t a, uint32_t b) { return lines.points[a].at.x < lines.points[b].at.x; });
  return ends;
}

double distance_of(const ParallelLines& lines, uint32_t a, uint32_t b) { return length(lines.points[a].at - lines.points[b].at); }

// Segments that are nothing: their points become one.
void contract(ParallelLines& lines, std::span<const double> reach) {
  UnionFind<> one(lines.points.size());
  for (size_t k = 0; k + 1 < lines.segments.size(); k += 2)
    if (const uint32_t a = lines.segments[k], b = lines.segments[k + 1]; distance_of(lines, a, b) <= std::min(reach[a], reach[b]))
      one.join(a, b);
  std::set<std::pair<uint32_t, uint32_t>> known;
  ParallelLines kept;
  for (size_t s = 0; s < lines.cells.size(); ++s) {
    const uint32_t a = one.root(lines.segments[2 * s]), b = one.root(lines.segments[2 * s + 1]);
    if (a == b || !known.insert(std::minmax(a, b)).second) continue;
    kept.segments.insert(kept.segments.end(), {a, b});
    kept.cells.push_back(lines.cells[s]);
  }
  lines.segments = std::move(kept.segments), lines.cells = std::move(kept.cells);
}

}  // namespace

void mend_lines(ParallelLines& lines, std::span<const double> reach) {
  contract(lines, reach);
  const std::vector<uint32_t> ends = ends_of(lines);
  UnionFind<> line(lines.points.size());
  for (size_t k = 0; k + 1 < lines.segments.size(); k += 2) line.join(lines.segments[k], lines.segments[k + 1]);
  constexpr uint32_t none = uint32_t(-1);
  std::vector<uint32_t> nearest(lines.points.size(), none);
  std::vector<double> distance(lines.points.size(), HUGE_VAL);
  const auto look = [&](uint32_t from, uint32_t to) {
    const double d = distance_of(lines, from, to);
    if (d <= reach[from] && d < distance[from]) nearest[from] = to, distance[from] = d;
  };
  double farthest = 0;
  for (const uint32_t p : ends) farthest = std::max(farthest, reach[p]);
  for (size_t i = 0; i < ends.size(); ++i)
    for (size_t j = i + 1; j < ends.size() && lines.points[ends[j]].at.x - lines.points[ends[i]].at.x <= farthest; ++j)
      if (line.root(ends[i]) != line.root(ends[j])) look(ends[i], ends[j]), look(ends[j], ends[i]);
  for (const uint32_t p : ends)
    if (const uint32_t q = nearest[p]; q != none && p < q && nearest[q] == p && line.root(p) != line.root(q)) {
      line.join(p, q);
      lines.segments.insert(lines.segments.end(), {p, q});
      lines.cells.push_back(std::min(lines.points[p].cell, lines.points[q].cell));
    }
}

}  // namespace sg::parallel
