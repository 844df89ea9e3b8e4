// SPDX-License-Identifier: Apache-2.0
#include "simulate/analytic_grid.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/bytes.h"
#include "base/text/text.h"

namespace sg {

void describe_grid(Schema& s, GridParams& p) {
  s("size", p.size, "Points along the longest side.").range(2, 65536);
  s("dims", p.dims, "Points per axis, three numbers; default: from size.").range(1, 65536);
  s("bounds", p.bounds, "Extent of the grid as x0,x1,y0,y1,z0,z1; default: the source's own.");
  s("type", p.type, "Number type of the fields.");
}

UniformGrid analytic_grid(const GridParams& p, const Box3& own, const char* source, const Context& context) {
  Box3 box = own;
  if (!p.bounds.empty()) {
    if (p.bounds.size() != 6)
      fail_usage(fmt::format("{} numbers do not define a box", p.bounds.size()), fmt::format("{} bounds", source),
                 "give x0,x1,y0,y1,z0,z1");
    for (int a = 0; a < 3; ++a) {
      box.lo[a] = p.bounds[size_t(2 * a)], box.hi[a] = p.bounds[size_t(2 * a + 1)];
      if (!(box.lo[a] <= box.hi[a]) || !std::isfinite(box.hi[a] - box.lo[a]))
        fail_usage(fmt::format("the box extends from {} to {} along {}", exact_number(box.lo[a]), exact_number(box.hi[a]), "xyz"[a]),
                   fmt::format("{} bounds", source), "give finite numbers, the lower one first");
    }
  }
  UniformGrid g;
  g.origin = box.lo;
  if (!p.dims.empty() && p.dims.size() != 3)
    fail_usage(fmt::format("{} numbers do not make a grid size", p.dims.size()), fmt::format("{} dims", source),
               "give three numbers like 64,64,32");
  const Vec3 size = box.size();
  const double longest = std::max({size.x, size.y, size.z});
  uint64_t points = 1;
  for (int a = 0; a < 3; ++a) {
    int64_t n = size[a] == 0     ? 1
                : p.dims.empty() ? std::max<int64_t>(2, std::llround(double(p.size - 1) * size[a] / longest) + 1)
                                 : p.dims[size_t(a)];
    if (n < 1) fail_usage(fmt::format("{} points along {}", n, "xyz"[a]), fmt::format("{} dims", source), "give at least 1");
    g.dims[size_t(a)] = size_t(n);
    g.spacing[a] = n > 1 ? size[a] / double(n - 1) : 1.0;
    if (!multiply(points, uint64_t(n), points) || points > (uint64_t(1) << 40))
      fail_usage("the grid has more points than any memory can hold", source, "ask for a smaller size");
  }
  if (context.memory_limit && points * (p.type == FieldType::f64 ? 8 : 4) > context.memory_limit)
    fail_usage(fmt::format("one field of {} needs more than the memory limit of {}",
                           human_bytes(points * (p.type == FieldType::f64 ? 8 : 4)), human_bytes(context.memory_limit)),
               source, "ask for a smaller size");
  return g;
}

}  // namespace sg
