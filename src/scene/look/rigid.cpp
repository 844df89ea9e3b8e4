// SPDX-License-Identifier: Apache-2.0
// Tools, moulds and walls beside what is formed: of their values there is but one, and it is no measurement of them.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/text/text.h"
#include "base/union_find.h"
#include "data/cells/cell_reader.h"
#include "scene/look/look_parts.h"
#include "scene/show/surface.h"

namespace sg {

namespace {

// Whether many of the points have the least or the greatest of all values: looking at the pieces takes longer.
bool ends_often(std::span<const DatasetPtr> parts, const std::string& field, const Range& all) {
  constexpr size_t share = 50;
  size_t least = 0, greatest = 0, count = 0;
  for (const DatasetPtr& d : parts)
    dispatch(d->fields().require(field, Association::point).array, [&](auto v) {
      count += v.count;
      for (size_t i = 0; i < v.count; ++i) least += double(v(i)) == all.lo, greatest += double(v(i)) == all.hi;
    });
  return share * std::max(least, greatest) > count;
}

// The connected pieces of all parts, by their values.
struct PiecesByValue {
  Range varying;     ///< of those on which the field varies
  Range one_valued;  ///< of those that have one value each
};

PiecesByValue pieces_by_value(std::span<const DatasetPtr> parts, const std::string& field) {
  PiecesByValue found;
  for (const DatasetPtr& d : parts) {
    const Array& values = d->fields().require(field, Association::point).array;
    UnionFind<size_t> pieces(d->point_count());
    std::vector<char> used(d->point_count(), 0);
    CellReader reader(d);
    for (size_t c = 0; c < reader.count(); ++c) {
      if (reader.hidden(c)) continue;
      reader.open(c);
      for (const int64_t p : reader.ids()) pieces.join(size_t(reader.ids()[0]), size_t(p)), used[size_t(p)] = 1;
    }
    std::vector<Range> of(d->point_count());
    for (size_t p = 0; p < used.size(); ++p)
      if (const double v = values.get(p); used[p] && std::isfinite(v)) of[pieces.root(p)].add({v, v});
    for (const Range& r : of)
      if (!r.empty()) (r.lo < r.hi ? found.varying : found.one_valued).add(r);
  }
  return found;
}

}  // namespace

void show_rigid(Look& look, std::span<const DatasetPtr> parts, const std::string& field, Context& context) {
  constexpr size_t most_cells = 1000000;
  const bool plain = field.empty() && look.filter.empty() && look.shows.size() == 1 && look.shows[0].kind->is<SurfaceShow>();
  const Field* first = plain && !parts.empty() ? automatic_field(*parts[0]) : nullptr;
  if (!first || first->components() != 1 || first->role == Role::labels || context.communicator) return;
  const std::string name = first->name;
  Range all;
  size_t cells = 0;
  for (const DatasetPtr& d : parts) {
    const Field* f = d->fields().find(name, Association::point);
    if (!f || f->components() != 1 || d->as<AmrGrid>()) return;
    all.add(d->range(*f)), cells += d->cell_count();
  }
  if (cells > most_cells || !ends_often(parts, name, all)) return;
  const PiecesByValue found = pieces_by_value(parts, name);
  if (found.varying.empty() || found.one_valued.empty()) return;
  std::string limit;
  if (found.one_valued.lo > found.varying.hi) limit = "min=" + exact_number(found.one_valued.lo);
  else if (found.one_valued.hi < found.varying.lo) limit = "max=" + exact_number(found.one_valued.hi);
  else return;
  look.filter = {"threshold", "field=" + name, limit, "invert=true"};
  look.shows[0].of_input = false;
  SurfaceShow rigid;
  rigid.coloring.color = "#9a9aa2", rigid.opacity = 0.25;
  add_show(look, rigid, false);
  look.shows.back().filter = {"threshold", "field=" + name, limit};
  look.reason += fmt::format("; pieces with one value of '{}' alone, beyond all others, are grey and seen through", name);
}

}  // namespace sg
