// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/seeds/random_places.h"

#include <algorithm>
#include <optional>

#include "base/parallel.h"
#include "base/random.h"
#include "data/cells/mesh_dimension.h"
#include "index/cell_locator.h"

namespace sg {

namespace {

// The cells of several meshes with the sums of their sizes.
struct Sizes {
  std::vector<DatasetPtr> meshes;
  std::vector<size_t> begin{0};   // first cell of each mesh in `before`
  std::vector<double> before{0};  // cells + 1
};

Sizes measure_cells(const std::vector<DatasetPtr>& meshes, int dimension, Context& context) {
  Sizes out;
  out.meshes = meshes;
  for (const DatasetPtr& d : meshes) {
    std::vector<double> size(d->cell_count());
    const CellMap shared(d);
    parallel_for(
        size.size(), 4096,
        [&](size_t begin, size_t end) {
          CellMap map = shared;
          for (size_t c = begin; c < end; ++c) {
            if (map.reader().hidden(c)) continue;
            map.open(c);
            if (map.dimension() != dimension) continue;
            const double m = std::abs(map.measure());
            if (std::isfinite(m)) size[c] = m;
          }
        },
        &context);
    for (const double s : size) out.before.push_back(out.before.back() + s);
    out.begin.push_back(out.before.size() - 1);
  }
  return out;
}

// Uniform in the reference element's box; false outside the element.
bool reference_place(const CellMap& map, double a, double b, double c, Vec3& rst) {
  rst = {a, map.dimension() > 1 ? b : 0, map.dimension() > 2 ? c : 0};
  const CellReader& r = map.reader();
  const CellShape* shape = CellShape::find(r.type(), r.ids().size(), r.orders());
  return !shape || shape->outside(rst) <= 0;
}

// A place in the open cell from three numbers in [0, 1): false when they miss it.
bool place_in_cell(CellMap& map, double a, double b, double c, Vec3& x) {
  const CellReader& r = map.reader();
  const auto at = r.at();
  if (map.dimension() == 3) {
    const Box3 box = r.box();
    x = box.lo + box.size() * Vec3(a, b, c);
    CellPlace place;
    return map.locate(x, place);
  }
  if (CellShape::find(r.type(), at.size(), r.orders())) {
    Vec3 rst;
    if (!reference_place(map, a, b, c, rst)) return false;
    x = map.position(rst);
    return true;
  }
  if (map.dimension() == 1) {  // a poly-line: its pieces by length
    double total = 0;
    for (size_t k = 1; k < at.size(); ++k) total += length(at[k] - at[k - 1]);
    double left = a * total;
    for (size_t k = 1; k < at.size(); ++k) {
      const double l = length(at[k] - at[k - 1]);
      if (left <= l && l > 0) {
        x = lerp(at[k - 1], at[k], left / l);
        return true;
      }
      left -= l;
    }
    return false;
  }
  // Polygons and strips: in the box of their plane's axes, on the cell by its map.
  const Box3 box = r.box();
  const Vec3 y = box.lo + box.size() * Vec3(a, b, c);
  CellPlace place;
  map.nearest(y, place);
  x = place.nearest;
  return length(x - y) < 0.2 * box.diagonal();
}

}  // namespace

std::vector<Vec3> random_places(const std::vector<DatasetPtr>& meshes, size_t count, uint64_t seed, const std::function<bool(Vec3)>& inside,
                                Context& context) {
  int dimension = 0;
  for (const DatasetPtr& d : meshes) dimension = std::max(dimension, mesh_dimension(*d));
  std::vector<DatasetPtr> used;
  Box3 box;
  for (const DatasetPtr& d : meshes)
    if (mesh_dimension(*d) == dimension && d->cell_count() > 0) used.push_back(d), box.add(d->bounds());
  std::vector<Vec3> out;
  if (used.empty() || box.empty() || count == 0) return out;

  // Without an inside test: locators.
  std::vector<std::unique_ptr<const CellLocator>> locators;
  std::vector<LocatorCursor> cursors;
  std::function<bool(Vec3)> held = inside;
  const bool solid = dimension == 3;
  if (!held && solid) {
    for (const DatasetPtr& d : used)
      locators.push_back(std::make_unique<const CellLocator>(d, context)), cursors.emplace_back(*locators.back());
    held = [&](Vec3 x) {
      for (LocatorCursor& c : cursors)
        if (c.find(x) >= 0) return true;
      return false;
    };
  }
  const size_t tries = 100 * count + 1000;
  const auto unit = [&](size_t i, int k) { return random_unit(seed, 4 * i + uint64_t(k)); };
  if (solid)
    for (size_t i = 0; i < tries && out.size() < count; ++i) {
      if (i % 16 == 0) context.check();
      const Vec3 x = box.lo + box.size() * Vec3(unit(i, 0), unit(i, 1), unit(i, 2));
      if (held(x)) out.push_back(x);
      if (i == tries / 5 && out.size() < count / 20) break;  // thin in its box
    }
  if (out.size() == count || (solid && out.size() * 2 > count)) return out;

  out.clear();
  const Sizes sizes = measure_cells(used, dimension, context);
  const double total = sizes.before.back();
  if (!(total > 0)) return out;
  std::vector<CellMap> maps;
  for (const DatasetPtr& d : used) maps.emplace_back(d);
  // Cells that are inside out may contain no point at all, and those of many nodes take long to show it.
  size_t missed = 0, placed = 0;
  for (size_t i = 0; i < tries && out.size() < count && (placed > 0 || missed < 256); ++i) {
    context.check();
    const double target = random_unit(seed + 1, i) * total;
    const size_t c = size_t(std::upper_bound(sizes.before.begin() + 1, sizes.before.end() - 1, target) - sizes.before.begin()) - 1;
    const size_t m = size_t(std::upper_bound(sizes.begin.begin(), sizes.begin.end(), c) - sizes.begin.begin()) - 1;
    CellMap& map = maps[m];
    map.open(c - sizes.begin[m]);
    Vec3 x;
    bool found = false;
    for (int k = 0; k < 64 && !found; ++k) {
      const size_t n = i * 64 + size_t(k);
      found = place_in_cell(map, unit(n, 0), unit(n, 1), unit(n, 2), x);
    }
    found ? ++placed : missed += map.reader().ids().size() > 8 ? 16 : 1;
    if (found && (!inside || inside(x))) out.push_back(x);
  }
  return out;
}

}  // namespace sg
