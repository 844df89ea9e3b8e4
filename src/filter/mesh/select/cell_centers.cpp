// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/select/cell_centers.h"

#include "base/parallel.h"
#include "data/cells/cell_reader.h"

namespace sg {

void keep_centers(const DatasetPtr& in, const std::function<bool(Vec3)>& holds, std::vector<uint8_t>& keep, Context& ctx) {
  constexpr size_t cells_per_chunk = 1 << 12;
  const CellReader all(in);
  parallel_for(
      keep.size(), cells_per_chunk,
      [&](size_t begin, size_t end) {
        CellReader reader = all;
        for (size_t c = begin; c < end; ++c) {
          if (!keep[c]) continue;
          reader.open(c);
          Vec3 sum;
          for (const Vec3& x : reader.at()) sum += x;
          keep[c] = !reader.at().empty() && holds(sum / double(reader.at().size()));
        }
      },
      &ctx);
}

}  // namespace sg
