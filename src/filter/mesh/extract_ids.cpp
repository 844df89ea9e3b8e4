// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/extract_ids.h"

#include <unordered_set>

#include "base/error.h"
#include "data/cell_reader.h"
#include "filter/mesh/extract.h"

namespace sg {

namespace {

// 1 for each chosen cell or point.
std::vector<uint8_t> chosen(const DatasetPtr& in, const ExtractParams& p, size_t count) {
  std::vector<uint8_t> yes(count, 0);
  if (p.by.empty()) {
    for (const int64_t id : p.ids) {
      if (id < 0 || size_t(id) >= count)
        fail_usage(fmt::format("there is no {} {}", p.of, id), "extract ids", count ? fmt::format("0 to {}", count - 1) : "there are none");
      yes[size_t(id)] = 1;
    }
    return yes;
  }
  const Association on = p.of == "cell" && !in->as<PointCloud>() ? Association::cell : Association::point;
  const Field& f = in->fields().require(p.by.name, on);
  if (f.components() != 1)
    fail_usage(fmt::format("field '{}' has {} components", f.name, f.components()), "extract by", "ids are single numbers");
  const std::unordered_set<int64_t> wanted(p.ids.begin(), p.ids.end());
  for (size_t i = 0; i < count; ++i) {
    const double v = f.array.get(i);
    yes[i] = std::isfinite(v) && std::fabs(v) < 9e15 && v == std::floor(v) && wanted.count(int64_t(v)) > 0;
  }
  return yes;
}

}  // namespace

DatasetPtr extract(const DatasetPtr& in, const ExtractParams& p, Context&) {
  if (p.ids.empty()) fail_usage("no numbers are given", "extract ids", "like ids=3,7,12");
  const bool cloud = in->as<PointCloud>();
  const bool by_points = p.of == "point" && !cloud;
  const size_t cells = cloud ? in->point_count() : in->cell_count();
  std::vector<uint8_t> yes = chosen(in, p, by_points ? in->point_count() : cells);
  if (by_points) {
    std::vector<uint8_t> users(cells, 0);
    CellReader reader(in);
    for (size_t c = 0; c < cells; ++c) {
      reader.open(c);
      for (const int64_t id : reader.ids()) users[c] |= yes[size_t(id)];
    }
    yes = std::move(users);
  }
  std::vector<int64_t> kept;
  for (size_t c = 0; c < cells; ++c)
    if ((yes[c] != 0) != p.invert) kept.push_back(int64_t(c));
  return extract_cells(in, kept, "extract");
}

}  // namespace sg
