// SPDX-License-Identifier: Apache-2.0
#include "data/ranks/over_all.h"

#include "base/all_ranks.h"

namespace sg {

Range over_all(const Range& mine, const Context& context) {
  const double ends[] = {mine.lo, mine.hi};
  Range r;
  for (const std::vector<double>& of : all_gathered(std::span<const double>(ends), context.communicator)) r.add({of[0], of[1]});
  return context.communicator ? r : mine;
}

Box3 over_all(const Box3& mine, const Context& context) {
  if (!context.communicator) return mine;
  const double ends[] = {mine.lo.x, mine.lo.y, mine.lo.z, mine.hi.x, mine.hi.y, mine.hi.z};
  Box3 r;
  for (const std::vector<double>& of : all_gathered(std::span<const double>(ends), context.communicator))
    r.add(Box3{{of[0], of[1], of[2]}, {of[3], of[4], of[5]}});
  return r;
}

Range range_over_all(const Dataset& data, const Field& field, int component, const Context& context) {
  Range r = data.range(field, component);
  if (context.parts)
    for (const DatasetPtr& part : *context.parts) {
      const Field* f = part->fields().find(field.name, field.association);
      if (!f) f = part->fields().find(field.name);  // of cells, where ours was carried to the points
      if (f && f->components() == field.components()) r.add(part->range(*f, component));
    }
  return over_all(r, context);
}

Box3 bounds_over_all(const Dataset& data, const Context& context) {
  Box3 b = data.bounds();
  if (context.parts)
    for (const DatasetPtr& part : *context.parts) b.add(part->bounds());
  return over_all(b, context);
}

}  // namespace sg
