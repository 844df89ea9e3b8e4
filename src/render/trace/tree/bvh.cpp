// SPDX-License-Identifier: Apache-2.0
#include "render/trace/tree/bvh.h"

#include <cmath>

#include "base/error.h"
#include "base/parallel.h"

namespace sg::trace {

namespace {

bool usable(const Box3f& b) {
  for (int a = 0; a < 3; ++a)
    if (!(b.lo[a] <= b.hi[a]) || !std::isfinite(b.lo[a]) || !std::isfinite(b.hi[a])) return false;
  return true;
}

}  // namespace

Bvh::Bvh(std::span<const Box3f> boxes, const TreeLimits& limits, Context& context) {
  if (boxes.size() >= size_t(1) << 31) fail_usage("2^31 primitives or more", "path tracer", "draw a part of the data");
  constexpr size_t grain = 1 << 14;
  const size_t n = boxes.size();
  std::vector<size_t> start(n / grain + 1);
  parallel_for(n, grain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) start[begin / grain] += usable(boxes[i]);
  });
  Plane<TreeRecord> records(exclusive_scan(start));
  parallel_for(n, grain, [&](size_t begin, size_t end) {
    size_t to = start[begin / grain];
    for (size_t i = begin; i < end; ++i) {
      const Box3f& b = boxes[i];
      if (usable(b)) records[to++] = {{b.lo.x, b.lo.y, b.lo.z}, {b.hi.x, b.hi.y, b.hi.z}, uint32_t(i)};
    }
  });
  tree_ = build_box_tree(std::move(records), limits, context);
}

Box3f Bvh::bounds() const {
  if (tree_.nodes.empty()) return {};
  const TreeNode& n = tree_.nodes[0];
  return {{n.lo[0], n.lo[1], n.lo[2]}, {n.hi[0], n.hi[1], n.hi[2]}};
}

double Bvh::expected_cost(const BvhCost& cost) const {
  if (tree_.nodes.empty()) return 0;
  double sum = 0;
  for (size_t i = 0; i < tree_.nodes.size(); ++i)
    if (i != 1) sum += half_area(tree_.nodes[i]) * (tree_.nodes[i].count ? cost.primitive * tree_.nodes[i].count : cost.box * 2);
  const double root = half_area(tree_.nodes[0]);
  return root > 0 ? sum / root : 0;
}

}  // namespace sg::trace
