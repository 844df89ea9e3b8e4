// SPDX-License-Identifier: Apache-2.0
// The tree from boxes. Large nodes are split one after the other by all threads; what is left becomes one task per subtree. Every choice
// depends only on the boxes, so the tree is the same for any number of threads.
#include "index/box_tree.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "base/parallel.h"

namespace sg {

namespace {

using V4 = float __attribute__((vector_size(16)));
using V4i = int32_t __attribute__((vector_size(16)));

constexpr uint32_t task_cells = 32768;  // nodes of more cells are split by all threads
constexpr size_t boxes_per_chunk = 16384;
constexpr int sah_depth = 52;  // deeper nodes are halved: at most 32 more levels, whatever the boxes are
constexpr int max_bins = 32;

inline V4 load(const float* p) {
  V4 v;
  std::memcpy(&v, p, 16);
  return v;
}
inline V4 min4(V4 a, V4 b) { return a < b ? a : b; }
inline V4 max4(V4 a, V4 b) { return a > b ? a : b; }
inline V4 splat(float v) { return V4{v, v, v, v}; }

// lo and hi in the lanes 0 to 2; lane 3 is never looked at, but kept an ordinary number (ids read as floats would be slow denormals).
struct Bounds {
  V4 lo = splat(HUGE_VALF), hi = splat(-HUGE_VALF);
  void add(V4 l, V4 h) { lo = min4(lo, l), hi = max4(hi, h); }
  void add(const Bounds& b) { add(b.lo, b.hi); }
  float half_area() const {
    const V4 d = hi - lo;
    return d[0] >= 0 ? d[0] * d[1] + d[1] * d[2] + d[2] * d[0] : 0.0f;
  }
};
inline V4 xyz(V4 v) {
  constexpr V4i mask = {-1, -1, -1, 0};
  return V4(V4i(v) & mask);
}
inline V4 low(const TreeRecord& r) { return xyz(load(r.lo)); }
inline V4 high(const TreeRecord& r) { return xyz(load(r.hi)); }

struct Bin {
  Bounds box;
  uint32_t count = 0;
};
struct Bins {
  Bin at[3][max_bins];
};

// What a node has to know of its cells before it is split.
struct Extent {
  Bounds box, centers;  // centers: lo + hi, twice the centre
};
Extent extent_of(const TreeRecord* r, size_t n) {
  Extent e;
  for (size_t i = 0; i < n; ++i) {
    const V4 l = low(r[i]), h = high(r[i]);
    e.box.add(l, h);
    e.centers.add(l + h, l + h);
  }
  return e;
}

// Which bin a cell falls into: one formula for binning and partition.
struct Binning {
  V4 from, scale;
  int bins;
  int first_axis = 0, last_axis = 2;
  Binning(const Bounds& centers, size_t n) : from(centers.lo), bins(n < 24 ? 8 : n < task_cells ? 16 : max_bins) {
    const V4 size = centers.hi - centers.lo;
    for (int a = 0; a < 4; ++a) {
      scale[a] = a < 3 && size[a] > 0 ? float(bins) / size[a] : 0.0f;
      if (!(scale[a] < HUGE_VALF)) scale[a] = 0;
    }
    // Large nodes are split across their longest axis: hardly worse, and a third of the work.
    if (n > task_cells) first_axis = last_axis = size[0] >= size[1] ? (size[0] >= size[2] ? 0 : 2) : size[1] >= size[2] ? 1 : 2;
  }
  V4i bin(const TreeRecord& r) const {
    const V4 last = splat(float(bins) - 1);
    return __builtin_convertvector(min4((low(r) + high(r) - from) * scale, last), V4i);
  }
  void fill(const TreeRecord* r, size_t n, Bins& out) const {
    for (size_t i = 0; i < n; ++i) {
      const V4i b = bin(r[i]);
      const V4 l = low(r[i]), h = high(r[i]);
      for (int a = first_axis; a <= last_axis; ++a) {
        Bin& to = out.at[a][b[a]];
        to.box.add(l, h);
        ++to.count;
      }
    }
  }
};

struct Split {
  int axis = -1, bin = 0;  // cells with bin <= `bin` go left
  float cost = HUGE_VALF;  // sum of half area times tests
};
Split best_split(const Bins& bins, const Binning& b, uint32_t at_once) {
  const auto tests = [&](uint32_t n) { return float((n + at_once - 1) / at_once); };
  Split best;
  for (int a = b.first_axis; a <= b.last_axis; ++a) {
    if (!(b.scale[a] > 0)) continue;
    float right_cost[max_bins];
    Bounds box;
    uint32_t n = 0;
    for (int i = b.bins - 1; i > 0; --i) {
      box.add(bins.at[a][i].box);
      n += bins.at[a][i].count;
      right_cost[i] = n ? box.half_area() * tests(n) : HUGE_VALF;
    }
    box = Bounds(), n = 0;
    for (int i = 0; i + 1 < b.bins; ++i) {
      box.add(bins.at[a][i].box);
      n += bins.at[a][i].count;
      if (n == 0) continue;
      const float cost = box.half_area() * tests(n) + right_cost[i + 1];
      if (cost < best.cost) best = {a, i, cost};
    }
  }
  return best;
}

void set_box(TreeNode& n, const Bounds& b) {
  for (int a = 0; a < 3; ++a) n.lo[a] = b.lo[a], n.hi[a] = b.hi[a];
}

// Half of the cells by their centre along the longest axis; ties by number, so that the order is total.
size_t halve(TreeRecord* r, size_t n, const Bounds& centers) {
  const V4 size = centers.hi - centers.lo;
  const int a = size[0] >= size[1] ? (size[0] >= size[2] ? 0 : 2) : size[1] >= size[2] ? 1 : 2;
  std::nth_element(r, r + n / 2, r + n, [a](const TreeRecord& p, const TreeRecord& q) {
    const float u = p.lo[a] + p.hi[a], v = q.lo[a] + q.hi[a];
    return u < v || (!(v < u) && p.cell < q.cell);
  });
  return n / 2;
}

bool worth_splitting(const TreeLimits& limits, const Split& s, float half_area, size_t n) {
  return n > limits.most || s.cost + limits.of_node * half_area < half_area * float(n);
}

struct NodeRange {
  uint32_t begin, end, node;
  int depth;
};

// All of a subtree below nodes[0] by one thread. Children are numbered from 2 on.
void build_subtree(TreeRecord* records, NodeRange root, const TreeLimits& limits, std::vector<TreeNode>& nodes) {
  nodes.assign(2, TreeNode{});
  std::vector<NodeRange> stack{{root.begin, root.end, 0, root.depth}};
  while (!stack.empty()) {
    const NodeRange r = stack.back();
    stack.pop_back();
    TreeRecord* first = records + r.begin;
    const size_t n = r.end - r.begin;
    const Extent e = extent_of(first, n);
    set_box(nodes[r.node], e.box);
    size_t left = 0;
    if (n > limits.least) {
      if (r.depth < sah_depth) {
        const Binning binning(e.centers, n);
        Bins bins;
        binning.fill(first, n, bins);
        const Split s = best_split(bins, binning, limits.at_once);
        if (s.axis >= 0 && worth_splitting(limits, s, e.box.half_area(), n))
          left = size_t(std::partition(first, first + n, [&](const TreeRecord& t) { return binning.bin(t)[s.axis] <= s.bin; }) - first);
      }
      if ((left == 0 || left == n) && n > limits.most) left = halve(first, n, e.centers);
    }
    if (left == 0 || left == n) {
      nodes[r.node].first = r.begin, nodes[r.node].count = uint32_t(n);
      continue;
    }
    const uint32_t child = uint32_t(nodes.size());
    nodes[r.node].first = child, nodes[r.node].count = 0;
    nodes.resize(nodes.size() + 2);
    const uint32_t middle = r.begin + uint32_t(left);
    stack.push_back({middle, r.end, child + 1, r.depth + 1});
    stack.push_back({r.begin, middle, child, r.depth + 1});
  }
}

// std::partition by all threads, in place: each chunk by itself, then the cells on the wrong side change places pairwise. The result
// depends only on chunk borders.
template <class Left>
size_t partition_parallel(TreeRecord* r, size_t n, Left&& is_left) {
  const size_t chunks = (n + boxes_per_chunk - 1) / boxes_per_chunk;
  std::vector<size_t> lefts(chunks);
  parallel_for(n, boxes_per_chunk, [&](size_t begin, size_t end) {
    lefts[begin / boxes_per_chunk] = size_t(std::partition(r + begin, r + end, is_left) - (r + begin));
  });
  size_t total = 0;
  for (size_t l : lefts) total += l;
  struct Run {
    size_t at, count, before;  // `before`: cells on the wrong side in earlier runs
  };
  std::vector<Run> rights, wrong_lefts;  // right cells before `total`, left cells behind it
  size_t nr = 0, nl = 0;
  for (size_t c = 0; c < chunks; ++c) {
    const size_t begin = c * boxes_per_chunk, end = std::min(n, begin + boxes_per_chunk), middle = begin + lefts[c];
    if (middle < std::min(end, total)) rights.push_back({middle, std::min(end, total) - middle, nr}), nr += rights.back().count;
    if (middle > std::max(begin, total)) {
      const size_t from = std::max(begin, total);
      wrong_lefts.push_back({from, middle - from, nl}), nl += wrong_lefts.back().count;
    }
  }
  parallel_for(nr, boxes_per_chunk, [&](size_t begin, size_t end) {
    auto run_of = [&](const std::vector<Run>& runs) {
      return size_t(std::upper_bound(runs.begin(), runs.end(), begin, [](size_t v, const Run& x) { return v < x.before; }) - runs.begin()) -
             1;
    };
    size_t a = run_of(rights), b = run_of(wrong_lefts);
    for (size_t i = begin; i < end;) {
      const Run &x = rights[a], &y = wrong_lefts[b];
      const size_t to = std::min({end, x.before + x.count, y.before + y.count});
      std::swap_ranges(r + x.at + (i - x.before), r + x.at + (to - x.before), r + y.at + (i - y.before));
      i = to;
      if (i == x.before + x.count) ++a;
      if (i == y.before + y.count) ++b;
    }
  });
  return total;
}

// Nodes of many cells, breadth first; ranges that are small enough go to `tasks`, in the order of their nodes.
void build_top(TreeRecord* records, uint32_t count, std::vector<TreeNode>& nodes, std::vector<NodeRange>& tasks, const TreeLimits& limits,
               Context& context) {
  nodes.assign(2, TreeNode{});
  std::vector<NodeRange> queue{{0, count, 0, 0}};
  for (size_t q = 0; q < queue.size(); ++q) {
    const NodeRange r = queue[q];
    const size_t n = r.end - r.begin;
    if (n <= task_cells || r.depth >= sah_depth) {
      tasks.push_back(r);
      continue;
    }
    context.check();
    TreeRecord* first = records + r.begin;
    const Extent e = parallel_reduce(
        n, boxes_per_chunk, Extent{}, [&](size_t begin, size_t end) { return extent_of(first + begin, end - begin); },
        [](Extent a, const Extent& b) {
          a.box.add(b.box), a.centers.add(b.centers);
          return a;
        });
    set_box(nodes[r.node], e.box);
    const Binning binning(e.centers, n);
    const Bins bins = parallel_reduce(
        n, boxes_per_chunk * 4, Bins{},
        [&](size_t begin, size_t end) {
          Bins b;
          binning.fill(first + begin, end - begin, b);
          return b;
        },
        [](Bins a, const Bins& b) {
          for (int axis = 0; axis < 3; ++axis)
            for (int i = 0; i < max_bins; ++i) {
              a.at[axis][i].box.add(b.at[axis][i].box);
              a.at[axis][i].count += b.at[axis][i].count;
            }
          return a;
        });
    const Split s = best_split(bins, binning, limits.at_once);
    size_t left = 0;
    if (s.axis >= 0) left = partition_parallel(first, n, [&](const TreeRecord& t) { return binning.bin(t)[s.axis] <= s.bin; });
    if (left == 0 || left == n) left = halve(first, n, e.centers);
    const uint32_t child = uint32_t(nodes.size());
    nodes[r.node].first = child, nodes[r.node].count = 0;
    nodes.resize(nodes.size() + 2);
    queue.push_back({r.begin, r.begin + uint32_t(left), child, r.depth + 1});
    queue.push_back({r.begin + uint32_t(left), r.end, child + 1, r.depth + 1});
  }
}

}  // namespace

BoxTree build_box_tree(Plane<TreeRecord> records, const TreeLimits& limits, Context& context) {
  BoxTree tree;
  if (records.empty()) return tree;
  std::vector<TreeNode> top;
  std::vector<NodeRange> tasks;
  build_top(records.data(), uint32_t(records.size()), top, tasks, limits, context);
  std::vector<std::vector<TreeNode>> parts(tasks.size());
  parallel_for(
      tasks.size(), 1,
      [&](size_t t, size_t) {
        build_subtree(records.data(), tasks[t], limits, parts[t]);
        parts[t].shrink_to_fit();
      },
      &context);

  tree.order.resize(records.size());
  parallel_for(records.size(), 1 << 16, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) tree.order[i] = records[i].cell;
  });
  records = {};

  // Places 0 and 1 of a part are its root, which lies in `top`, and nothing.
  std::vector<size_t> start(parts.size());
  for (size_t t = 0; t < parts.size(); ++t) start[t] = parts[t].size() - 2;
  const size_t below = exclusive_scan(start);
  tree.nodes.resize(top.size() + below);
  std::copy(top.begin(), top.end(), tree.nodes.begin());
  parallel_for(parts.size(), 1, [&](size_t t, size_t) {
    const uint32_t shift = uint32_t(top.size() + start[t]) - 2;
    std::vector<TreeNode>& part = parts[t];
    for (TreeNode& n : part)
      if (n.count == 0) n.first += shift;
    tree.nodes[tasks[t].node] = part[0];
    std::copy(part.begin() + 2, part.end(), tree.nodes.begin() + ptrdiff_t(part.size() > 2 ? shift + 2 : 0));
    part = {};
  });
  return tree;
}

}  // namespace sg
