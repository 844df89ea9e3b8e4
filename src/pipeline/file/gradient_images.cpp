// SPDX-License-Identifier: Apache-2.0
#include "pipeline/file/gradient_images.h"

#include <fmt/core.h>

#include <cstring>

#include "base/error.h"
#include "base/parallel.h"
#include "io/io.h"

namespace sg {

DatasetPtr gradient_images(const GradientImagesParams& p, Context& ctx) {
  if (p.path.empty()) fail_usage("path does not name a file", "gradient_images", "path=FILE.nii");
  const Series series = open_series(p.path, {}, ctx);
  const size_t steps = series.times.size();
  DatasetParts out;
  std::byte* bytes = nullptr;
  size_t points = 0, size = 0;
  Array all;
  std::string name = p.field.name;
  for (size_t step = 0; step < steps; ++step) {
    ctx.progress(double(step) / double(steps), "reading volumes");
    ctx.check();
    const DatasetPtr d = single_dataset(series.load(step), "gradient_images");
    const Field* f = name.empty() ? d->fields().active(1) : &d->fields().require(name);
    if (!f || f->components() != 1 || f->association == Association::whole)
      fail_usage(f ? fmt::format("field '{}' has {} components", f->name, f->components()) : "there is no field of one component", p.path,
                 "name one with one component with field=");
    name = f->name;
    if (step == 0) {
      points = f->array.count(), size = element_size(f->array.type());
      all = Array::make_raw(f->array.type(), points, int(steps), &bytes);
      out.mesh = d->mesh(), out.notes = d->notes(), out.point_ghost = d->point_ghost(), out.cell_ghost = d->cell_ghost();
      out.fields.add({"images", f->association, all, f->unit, Role::scalars});
      for (const Field& g : d->fields())
        if (g.association == Association::whole) out.fields.add(g);
    }
    if (f->array.count() != points || element_size(f->array.type()) != size)
      fail_data(fmt::format("step {} has {} values where the first has {}", step, f->array.count(), points), p.path);
    const Array packed = f->array.made_packed();
    parallel_for(points, 1 << 15, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) std::memcpy(bytes + (i * steps + step) * size, packed.raw() + i * size, size);
    });
  }
  return make_dataset(std::move(out));
}

}  // namespace sg
