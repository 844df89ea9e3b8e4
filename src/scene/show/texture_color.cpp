// SPDX-License-Identifier: Apache-2.0
#include "scene/show/texture_color.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "data/field_ops.h"

namespace sg {

std::string texture_field(const Dataset& d, const FieldName& wanted, const std::optional<FieldColor>& color) {
  if (wanted.none()) return "";
  if (!wanted.empty()) {
    const Field& f = d.fields().require(wanted.name, Association::point);
    if (f.components() != 1)
      fail_usage(fmt::format("'{}' has {} components, a texture has one", f.name, f.components()), "texture",
                 "lic and spot_noise make one");
    return f.name;
  }
  for (const Field& f : d.fields())
    if (f.look.texture && f.association == Association::point && f.components() == 1 && !(color && color->field == f.name)) return f.name;
  return "";
}

void apply_texture(SurfaceItem& item, const std::string& texture) {
  if (texture.empty()) return;
  const DatasetPtr d = item.data;
  const Field* f = d->fields().find(texture, Association::point);
  if (!f) return;  // the surface does not carry it
  const Array grey = scalar_of(*f, 0);
  const float* t = grey.view<float>().data;
  const float base = d->range(*f).lo < 0 ? 0.5f : 0.0f;
  const size_t n = d->point_count();
  // Colours of the points without the texture.
  const Field* field = nullptr;
  Array values, direct;
  if (item.color_by) {
    field = &d->fields().require(item.color_by->field, item.color_by->association);
    if (field->association != Association::point) return;
    if (item.color_by->direct) direct = field->array;
    else values = scalar_of(*field, item.color_by->component, ElementType::f64);
  }
  uint8_t* out = nullptr;
  Array colors = Array::make<uint8_t>(n, 4, &out);
  const double per = direct.empty() || is_float(direct.type()) ? 1.0 : 1.0 / 255;
  parallel_for(n, 1 << 13, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Vec4f c{item.color.x, item.color.y, item.color.z, 1};
      if (!direct.empty())
        for (int k = 0; k < direct.components(); ++k) c[k] = float(direct.get(i, k) * per);
      else if (field) c = item.color_by->scale.color(values.view<double>().data[i]);
      const float x = t[i] + base;
      if (x == x) {
        // Half dims to a fifth at black, half lightens towards white.
        const float g = std::clamp(x, 0.0f, 1.0f);
        const float dim = std::min(1.0f, 0.22f + 1.5f * g), bright = std::max(0.0f, g - 0.52f) * 0.85f;
        for (int k = 0; k < 3; ++k) c[k] = c[k] * dim * (1 - bright) + bright;
      }
      for (int k = 0; k < 4; ++k) out[4 * i + size_t(k)] = uint8_t(c[k] > 0 ? std::min(c[k], 1.0f) * 255 + 0.5f : 0.0f);
    }
  });
  DatasetParts parts = d->parts();
  const std::string name = "textured color";
  parts.fields.add({name, Association::point, std::move(colors), "", Role::colors});
  item.data = make_dataset(std::move(parts));
  item.color_by = FieldColor{name, Association::point, -1, {}, true};
}

}  // namespace sg
