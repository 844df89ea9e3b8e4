// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/hidden_inside.h"

#include <algorithm>

#include "data/cells/mesh_dimension.h"
#include "data/field_ops.h"
#include "filter/mesh/surface.h"
#include "scene/choose/coloring.h"
#include "scene/choose/telling_field.h"

namespace sg {

bool is_hidden_inside(const DatasetPtr& data, const std::string& field, Context& context) {
  const Dataset& d = *data;
  if (d.as<SurfaceMesh>() || d.as<UniformGrid>() || d.as<RectilinearGrid>() || mesh_dimension(d) != 3) return false;
  const Field* f = field.empty() ? automatic_field(d) : d.fields().find(field);
  if (!f || f->components() != 1 || !is_float(f->array.type()) || f->association == Association::whole) return false;
  const Range all = d.range(*f, 0);
  if (!(all.lo < all.hi) || telling(d, *f) != Telling::values) return false;
  const DatasetPtr skin = surface_of(data, context);
  const Field* seen = skin->fields().find(f->name, f->association);
  if (!seen) return false;
  std::vector<double> values;
  values.reserve(seen->array.count());
  dispatch(seen->array, [&](auto v) {
    for (size_t i = 0; i < v.count; ++i)
      if (const double x = double(v(i, 0)); std::isfinite(x)) values.push_back(x);
  });
  if (values.size() < 100) return false;
  const auto at = [&](double share) {
    const auto place = values.begin() + ptrdiff_t(share * double(values.size() - 1));
    std::nth_element(values.begin(), place, values.end());
    return *place;
  };
  const double width = all.hi - all.lo, lo = at(0.01), hi = at(0.99);
  if (hi - lo >= 0.05 * width) return false;
  size_t other = 0;  // inside: a few spikes would be no more to see than the faces
  dispatch(f->array, [&](auto v) {
    for (size_t i = 0; i < v.count; ++i) {
      const double x = double(v(i, 0));
      other += x < lo - 0.1 * width || x > hi + 0.1 * width;
    }
  });
  return 50 * other > f->array.count();
}

}  // namespace sg
