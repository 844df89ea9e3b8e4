// SPDX-License-Identifier: Apache-2.0
#include "index/cell_tree.h"

#include <cstring>
#include <set>

#include "base/parallel.h"
#include "index/locator_meshes.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

namespace {

std::vector<Box3> random_boxes(size_t n, double size, Vec3 offset = {0, 0, 0}) {
  std::vector<Box3> r(n);
  for (size_t i = 0; i < n; ++i) {
    auto u = [&](size_t k) { return random_unit(3, 8 * i + k); };
    const Vec3 lo = offset + Vec3(u(0), u(1), u(2));
    r[i].lo = lo, r[i].hi = lo + Vec3(u(3), u(4), i % 5 ? u(5) : 0.0) * size;
  }
  return r;
}

// Every cell once, each node in its parent, each cell's box in its leaf; how deep it is.
int check_tree(const CellTree& tree, std::span<const Box3> boxes, size_t expected) {
  std::vector<int> seen(boxes.size(), 0);
  size_t wrong = 0;
  int deepest = 0;
  struct Entry {
    uint32_t node;
    int depth;
  };
  std::vector<Entry> stack;
  if (!tree.nodes().empty()) stack.push_back({0, 1});
  while (!stack.empty()) {
    const Entry e = stack.back();
    stack.pop_back();
    deepest = std::max(deepest, e.depth);
    const TreeNode& n = tree.nodes()[e.node];
    if (n.count > 0) {
      for (uint32_t i = n.first; i < n.first + n.count; ++i) {
        const uint32_t c = tree.order()[i];
        ++seen[c];
        for (int a = 0; a < 3; ++a)
          wrong += !(tree.center()[a] + double(n.lo[a]) <= boxes[c].lo[a] && tree.center()[a] + double(n.hi[a]) >= boxes[c].hi[a]);
      }
    } else {
      wrong += n.first % 2 != 0 || n.first == 0;
      for (uint32_t c : {n.first, n.first + 1}) {
        const TreeNode& m = tree.nodes()[c];
        for (int a = 0; a < 3; ++a) wrong += m.lo[a] < n.lo[a] || m.hi[a] > n.hi[a];
        stack.push_back({c, e.depth + 1});
      }
    }
  }
  CHECK(wrong == 0);
  CHECK(tree.order().size() == expected);
  CHECK(size_t(std::count(seen.begin(), seen.end(), 1)) == expected);
  return deepest;
}

double surface_cost(const CellTree& tree) {
  auto area = [](const TreeNode& n) {
    const double d[3] = {double(n.hi[0]) - n.lo[0], double(n.hi[1]) - n.lo[1], double(n.hi[2]) - n.lo[2]};
    return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
  };
  double cost = 0;
  for (size_t i = 0; i < tree.nodes().size(); ++i)
    if (i != 1) cost += area(tree.nodes()[i]) * (tree.nodes()[i].count ? tree.nodes()[i].count : 1.5);
  return cost / area(tree.nodes()[0]);
}

template <class T>
bool same_bytes(std::span<const T> a, std::span<const T> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

}  // namespace

TEST_CASE("cell tree: holds every box once, in leaves and nodes that enclose it") {
  Context context;
  for (size_t n : {size_t(1), size_t(2), size_t(9), size_t(1000), size_t(100000)}) {
    const auto boxes = random_boxes(n, 0.02);
    const CellTree tree(boxes, context);
    const int depth = check_tree(tree, boxes, n);
    CHECK(depth <= 40);
    CHECK(tree.bytes() < 44 * n + 200);
  }
  CHECK(CellTree(std::span<const Box3>{}, context).nodes().empty());
}

TEST_CASE("cell tree: far from zero, boxes are still enclosed and narrow") {
  Context context;
  const auto boxes = random_boxes(5000, 0.02, {1e7, -1e7, 1e7});
  const CellTree tree(boxes, context);
  check_tree(tree, boxes, boxes.size());
  size_t tested = 0;
  tree.cells_at(boxes[7].center(), 0, [&](uint32_t) { return ++tested, false; });
  CHECK(tested < 60);
}

TEST_CASE("cell tree: empty boxes and NaN are left out, infinite ones are borne") {
  Context context;
  auto boxes = random_boxes(500, 0.1);
  boxes[3] = Box3{};
  boxes[4].lo.x = NAN;
  check_tree(CellTree(boxes, context), boxes, 498);
  boxes[5].lo = {-1e300, -1e300, -1e300}, boxes[5].hi = {1e300, 1e300, 1e300};
  const CellTree tree(boxes, context);
  CHECK(tree.order().size() == 498);
  std::set<uint32_t> found;
  tree.cells_at(boxes[9].center(), 0, [&](uint32_t c) { return found.insert(c), false; });
  CHECK(found.count(9) == 1);
  CHECK(found.count(5) == 1);
}

TEST_CASE("cell tree: boxes that no plane divides, or only at one end, make no deep tree") {
  Context context;
  const std::vector<Box3> same(70000, random_boxes(1, 1)[0]);
  CHECK(check_tree(CellTree(same, context), same, same.size()) <= CellTree::max_depth);
  std::vector<Box3> skewed(40000);
  for (size_t i = 0; i < skewed.size(); ++i) {
    const double x = std::pow(0.5, double(i % 500) / 2.0), y = std::pow(0.7, double(i / 500));
    skewed[i].lo = skewed[i].hi = {x, y, x * y};
  }
  CHECK(check_tree(CellTree(skewed, context), skewed, skewed.size()) <= CellTree::max_depth);
}

TEST_CASE("cell tree: the surface-area heuristic beats a tree over boxes in order of their numbers") {
  Context context;
  const auto boxes = random_boxes(20000, 0.02);
  const CellTree tree(boxes, context);
  // An even tree of the same leaves over n boxes costs about the mean of all levels of a kd-tree with cubic cells.
  double even = 0;
  for (double nodes = 1; nodes < 5000; nodes *= 2) even += nodes * std::pow(std::cbrt(1 / nodes) + 0.02, 2) * 1.5;
  CHECK(surface_cost(tree) < 2 * even);
}

TEST_CASE("cell tree: every traversal finds what a look at every box finds") {
  Context context;
  const auto boxes = random_boxes(3000, 0.1);
  const CellTree tree(boxes, context);
  size_t missed = 0;
  for (size_t q = 0; q < 500; ++q) {
    auto u = [&](size_t k) { return random_unit(17, 8 * q + k); };
    const Vec3 x(u(0) * 1.2 - 0.1, u(1) * 1.2 - 0.1, u(2) * 1.2 - 0.1),
        d = q % 4 ? Vec3(u(3) - .5, u(4) - .5, u(5) - .5) : Vec3(0, q % 8 ? 1 : -1, 0);
    std::set<uint32_t> at, near, ray, box;
    tree.cells_at(x, 0.01, [&](uint32_t c) { return at.insert(c), false; });
    tree.nearest(x, 0.01, [&](uint32_t c) { return near.insert(c), 0.01; });
    tree.along_ray(x, d, 0, 0.7, [&](uint32_t c) { return ray.insert(c), 0.7; });
    const Box3 around{x, x + Vec3(0.05, 0.1, 0.2)};
    tree.overlapping(around, [&](uint32_t c) { box.insert(c); });
    for (uint32_t c = 0; c < boxes.size(); ++c) {
      const Box3& b = boxes[c];
      double d2 = 0, most = 0, t0 = 0, t1 = 0.7;
      bool meets = true;
      for (int a = 0; a < 3; ++a) {
        const double away = std::max({b.lo[a] - x[a], x[a] - b.hi[a], 0.0});
        d2 += away * away, most = std::max(most, away);
        meets = meets && b.lo[a] <= around.hi[a] && b.hi[a] >= around.lo[a];
        if (d[a] == 0) {
          if (away > 0) t1 = -1;
          continue;
        }
        const double p = (b.lo[a] - x[a]) / d[a], r = (b.hi[a] - x[a]) / d[a];
        t0 = std::max(t0, std::min(p, r)), t1 = std::min(t1, std::max(p, r));
      }
      missed += most <= 0.01 && !at.count(c);
      missed += d2 <= 0.01 && !near.count(c);
      missed += t0 <= t1 && !ray.count(c);
      missed += meets && !box.count(c);
    }
    CHECK(at.size() < 600);
  }
  CHECK(missed == 0);
  size_t calls = 0;
  CHECK(tree.cells_at(boxes[0].center(), 0, [&](uint32_t) { return ++calls, true; }));
  CHECK(calls == 1);
}

TEST_CASE("cell tree: hidden cells are not in it, and a mesh's tree is small") {
  Context context;
  const DatasetPtr blanked = curvilinear({9, 8, 7}, true);
  CHECK(CellTree(blanked, context).order().size() == 336 - 48);
  const DatasetPtr tets = block_cells("tetra", 12, 0.2).dataset();
  const CellTree tree(tets, context);
  CHECK(tree.order().size() == tets->cell_count());
  CHECK(tree.bytes() < 25 * tets->cell_count());
  CHECK(CellTree(cloud(100), context).order().size() == 100);
}

TEST_CASE("cell tree: the same bytes with 1 and 8 threads") {
  const auto boxes = random_boxes(200000, 0.01);
  Context context;
  set_thread_count(1);
  const CellTree one(boxes, context);
  set_thread_count(8);
  const CellTree eight(boxes, context);
  set_thread_count(0);
  CHECK(same_bytes(one.order(), eight.order()));
  CHECK(one.nodes().size() == eight.nodes().size());
  size_t different = 0;
  for (size_t i = 0; i < one.nodes().size(); ++i)
    different += i != 1 && std::memcmp(&one.nodes()[i], &eight.nodes()[i], sizeof(TreeNode)) != 0;
  CHECK(different == 0);
}

TEST_CASE("cell tree: stops when it is asked to") {
  Context context;
  context.cancel();
  const auto boxes = random_boxes(100000, 0.01);
  CHECK_THROWS_AS(CellTree(boxes, context), Error);
}
