// SPDX-License-Identifier: Apache-2.0
// The tree's quality, and what integral geometry says of rays through convex bodies.
#include <algorithm>

#include "render/trace/geometry/solids.h"
#include "trace_support.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;

namespace {

std::vector<Box3f> boxes_of(const TestMesh& m) {
  std::vector<Box3f> boxes;
  for (size_t t = 0; t < m.corners.size() / 3; ++t) {
    Box3f b;
    for (int k = 0; k < 3; ++k) {
      const Vec3f p = m.input().corner(t, k);
      for (int a = 0; a < 3; ++a) b.lo[a] = std::min(b.lo[a], p[a]), b.hi[a] = std::max(b.hi[a], p[a]);
    }
    boxes.push_back(b);
  }
  return boxes;
}

double half_area(const Box3f& b) {
  const Vec3f s = b.hi - b.lo;
  return double(s.x) * s.y + double(s.y) * s.z + double(s.z) * s.x;
}

/// Expected cost, times the root's half area, of a tree that halves the boxes by their centres along the longest axis down to `leaf`.
double median_cost(std::vector<Box3f> boxes, size_t leaf, const BvhCost& cost) {
  Box3f all;
  for (const Box3f& b : boxes)
    for (int a = 0; a < 3; ++a) all.lo[a] = std::min(all.lo[a], b.lo[a]), all.hi[a] = std::max(all.hi[a], b.hi[a]);
  if (boxes.size() <= leaf) return half_area(all) * cost.primitive * double(boxes.size());
  const Vec3f s = all.hi - all.lo;
  const int axis = s.x >= s.y ? (s.x >= s.z ? 0 : 2) : s.y >= s.z ? 1 : 2;
  std::sort(boxes.begin(), boxes.end(), [&](const Box3f& p, const Box3f& q) { return p.lo[axis] + p.hi[axis] < q.lo[axis] + q.hi[axis]; });
  const auto middle = boxes.begin() + ptrdiff_t(boxes.size() / 2);
  return half_area(all) * 2 * cost.box + median_cost({boxes.begin(), middle}, leaf, cost) + median_cost({middle, boxes.end()}, leaf, cost);
}

/// Share of the lines through the ball of radius 2 that meet the body, and the mean length of what they have in it.
struct Lines {
  double share = 0, chord = 0, share_error = 0, chord_error = 0;
};
template <class Nearest>
Lines through(size_t n, Nearest&& nearest) {
  double met = 0, sum = 0, squares = 0;
  for (size_t i = 0; i < n; ++i) {
    Ray r = any_line(11, i, 2);
    Hit in, out;
    if (!nearest(r, in)) continue;
    // The far end from the other side.
    const Ray back{r.origin + r.direction * 8.0f, -r.direction};
    if (!nearest(back, out)) continue;
    const double chord = 8 - double(in.t) - double(out.t);
    ++met, sum += chord, squares += chord * chord;
  }
  Lines l;
  l.share = met / double(n), l.chord = sum / met;
  l.share_error = std::sqrt(l.share * (1 - l.share) / double(n)), l.chord_error = std::sqrt((squares / met - l.chord * l.chord) / met);
  return l;
}

}  // namespace

TEST_CASE("trace: the tree's expected cost is below that of halving, and finer leaves that pay make it lower") {
  Context context;
  const BvhCost cost{1, 1};
  TestMesh uneven = soup(3000, 0.02, 1);
  for (float& v : uneven.xyz) v = v * v * v;  // dense in the middle
  for (const TestMesh& m : {soup(3000, 0.05, 2), uneven, ball_mesh(40)}) {
    const auto boxes = boxes_of(m);
    const Bvh fine(boxes, {.most = 8, .least = 1, .of_node = 2}, context), coarse(boxes, {.most = 8, .least = 8, .of_node = 2}, context);
    Box3f all = fine.bounds();
    CHECK(fine.expected_cost(cost) <= median_cost(boxes, 4, cost) / half_area(all));
    CHECK(coarse.expected_cost(cost) <= median_cost(boxes, 8, cost) / half_area(all));
    CHECK(fine.expected_cost(cost) <= coarse.expected_cost(cost));
  }
}

TEST_CASE("trace: lines through a convex body have the mean length 4 V / S in it, and the share of its surface meets it") {
  constexpr size_t n = 200000;
  Context context;
  SUBCASE("ball") {
    const Solids<Ball> ball({{{0.1f, -0.2f, 0.3f}, 1, 0}}, context);
    const Lines l = through(n, [&](const Ray& r, Hit& h) { return ball.nearest(r, h); });
    CHECK(std::abs(l.chord - 4.0 / 3) < 4 * l.chord_error);
    CHECK(std::abs(l.share - 0.25) < 4 * l.share_error);
  }
  SUBCASE("cube") {
    const Triangles cube = cube_mesh(0.75f).tree();
    const Lines l = through(n, [&](const Ray& r, Hit& h) { return cube.nearest(r, h); });
    CHECK(std::abs(l.chord - 2.0 / 3 * 1.5) < 4 * l.chord_error);
    CHECK(std::abs(l.share - 6 * 1.5 * 1.5 / (16 * std::numbers::pi)) < 4 * l.share_error);
  }
  SUBCASE("capsule of length 1 and radius 1/2: V = 5 pi / 12, S = 2 pi") {
    const Solids<Capsule> capsule({{{-0.5f, 0, 0.2f}, {0.5f, 0, 0.2f}, 0.5f, 0}}, context);
    const Lines l = through(n, [&](const Ray& r, Hit& h) { return capsule.nearest(r, h); });
    CHECK(std::abs(l.chord - 4 * (5.0 / 12) / 2) < 4 * l.chord_error);
    CHECK(std::abs(l.share - 2.0 / 16) < 4 * l.share_error);
  }
  SUBCASE("disc: a line that meets it has no length in it; S = 2 pi r^2") {
    const Solids<Disc> disc({{{0, 0.1f, 0.2f}, normalize(Vec3f(1, 2, 3)), 1, 0}}, context);
    const Lines l = through(n, [&](const Ray& r, Hit& h) { return disc.nearest(r, h); });
    CHECK(std::abs(l.share - 2.0 / 16) < 4 * l.share_error);
  }
}
