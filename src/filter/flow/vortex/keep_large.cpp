// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/vortex/keep_large.h"

#include <fmt/core.h>

#include <algorithm>

#include "data/cells/cell_reader.h"
#include "filter/mesh/select/extract.h"

namespace sg {

namespace {

DatasetPtr keep(const DatasetPtr& in, const std::vector<int64_t>& cells, std::string_view who, const Context& context) {
  if (cells.size() == in->cell_count()) return in;
  if (cells.empty()) context.info(fmt::format("{}: no piece is large enough; min_length=0 keeps small ones too", who));
  return extract_cells(in, cells, who);
}

}  // namespace

DatasetPtr long_lines(const DatasetPtr& in, double shortest, std::string_view who, const Context& context) {
  const Field* length = in->fields().find("length", Association::cell);
  if (!length || shortest <= 0) return in;
  std::vector<int64_t> stay;
  for (size_t c = 0; c < length->array.count(); ++c)
    if (length->array.get(c) >= shortest) stay.push_back(int64_t(c));
  return keep(in, stay, who, context);
}

DatasetPtr large_parts(const DatasetPtr& in, double smallest, std::string_view who, const Context& context) {
  const Array number = in->fields().require("component", Association::cell).array;
  std::vector<Box3> boxes;
  CellReader reader(in);
  for (size_t c = 0; c < reader.count(); ++c) {
    const auto part = size_t(std::max(0.0, number.get(c)));
    if (part >= boxes.size()) boxes.resize(part + 1);
    reader.open(c);
    for (const Vec3& x : reader.at()) boxes[part].add(x);
  }
  std::vector<int64_t> stay;
  for (size_t c = 0; c < reader.count(); ++c)
    if (boxes[size_t(std::max(0.0, number.get(c)))].diagonal() >= smallest) stay.push_back(int64_t(c));
  DatasetParts parts = keep(in, stay, who, context)->parts();
  parts.fields.remove("component", Association::cell);
  return make_dataset(std::move(parts));
}

}  // namespace sg
