// SPDX-License-Identifier: Apache-2.0
#include "pipeline/graph/step_report.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/text/text.h"

namespace sg {

namespace {

std::string counted(size_t n, const char* what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); }

}  // namespace

std::string StopWatch::text() const {
  const std::chrono::duration<double> since = std::chrono::steady_clock::now() - begin_;
  return since.count() < 0.001 ? "below 1 ms"
         : since.count() < 1   ? short_number(since.count() * 1000, 3) + " ms"
                               : short_number(since.count(), 3) + " s";
}

std::string result_text(const Data& data) {
  if (auto* t = std::get_if<TablePtr>(&data)) {
    size_t rows = 0;
    for (const Field& f : (*t)->columns) rows = std::max(rows, f.array.count());
    return fmt::format("table of {} and {}", counted((*t)->columns.size(), "column"), counted(rows, "row"));
  }
  size_t parts = 0, points = 0, cells = 0;
  std::string kind;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) {
    ++parts, points += d->point_count(), cells += d->cell_count();
    kind = std::string(d->kind());
  });
  const std::string sizes = fmt::format("{} and {}", counted(points, "point"), counted(cells, "cell"));
  return std::holds_alternative<DatasetPtr>(data) ? fmt::format("{} of {}", kind, sizes)
                                                  : fmt::format("{} of {} in all", counted(parts, "part"), sizes);
}

}  // namespace sg
