// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/questions/probed_cell.h"

#include <algorithm>
#include <vector>

#include "base/parallel.h"
#include "data/cells/cell_reader.h"
#include "filter/mesh/select/extract.h"
#include "index/cell_locator.h"

namespace sg::serve {

namespace {

constexpr size_t cells_per_chunk = 1 << 13;

// Cells whose boxes, grown by a hair, hold the place. Without an index: it would take longer to make than this takes.
std::vector<int64_t> cells_around(const DatasetPtr& d, Vec3 at, Context& context) {
  const double hair = 1e-3 * d->bounds().diagonal();
  const CellReader all(d);
  return parallel_reduce(
      d->cell_count(), cells_per_chunk, std::vector<int64_t>(),
      [&](size_t begin, size_t end) {
        std::vector<int64_t> found;
        CellReader reader = all;
        for (size_t c = begin; c < end; ++c) {
          if (reader.hidden(c)) continue;
          reader.open(c);
          const Box3 box = reader.box();
          bool inside = !box.empty();
          for (int a = 0; a < 3; ++a) inside = inside && at[a] >= box.lo[a] - hair && at[a] <= box.hi[a] + hair;
          if (inside) found.push_back(int64_t(c));
        }
        return found;
      },
      [](std::vector<int64_t> a, const std::vector<int64_t>& b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
      },
      &context);
}

}  // namespace

std::optional<size_t> probed_cell(const DatasetPtr& d, Vec3 at, Context& context) {
  if (d->cell_count() == 0) return std::nullopt;
  if (d->as<UniformGrid>() || d->as<RectilinearGrid>() || d->as<AmrGrid>()) {
    const Box3& b = d->bounds();
    for (int a = 0; a < 3; ++a) at[a] = std::clamp(at[a], b.lo[a], b.hi[a]);
    const CellLocator locator(d, context);
    const int64_t cell = LocatorCursor(locator).find(at);
    return cell >= 0 ? std::optional(size_t(cell)) : std::nullopt;
  }
  const std::vector<int64_t> around = cells_around(d, at, context);
  if (around.empty()) return std::nullopt;
  const DatasetPtr few = extract_cells(d, around, "probe");
  const CellLocator locator(few, context);
  LocatorCursor cursor(locator);
  int64_t cell = cursor.find(at);
  if (cell < 0) cell = cursor.nearest(at).cell;
  return cell >= 0 ? std::optional(size_t(around[size_t(cell)])) : std::nullopt;
}

}  // namespace sg::serve
