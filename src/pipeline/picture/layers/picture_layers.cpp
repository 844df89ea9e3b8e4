// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/layers/picture_layers.h"

#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

namespace sg {

namespace {

// Rows of a picture run down, those of a grid up. Nothing where there is no such plane.
template <class T, class From>
void add(FieldSet& fields, const char* name, const From& plane, size_t width, size_t height) {
  const size_t pixels = width * height, each = pixels > 0 ? plane.size() / pixels : 0;
  if (each == 0) return;
  std::vector<T> values(plane.size());
  for (size_t y = 0; y < height; ++y)
    for (size_t i = 0; i < each * width; ++i) {
      auto v = plane[(height - 1 - y) * each * width + i];
      if constexpr (std::is_floating_point_v<T>)
        if (!std::isfinite(v)) v = std::numeric_limits<T>::quiet_NaN();
      values[y * each * width + i] = T(v);
    }
  Field f;
  f.name = name, f.association = Association::point, f.array = Array::from_vector(std::move(values), int(each));
  fields.add(std::move(f));
}

}  // namespace

DatasetPtr layers_of(const Picture& picture) {
  const auto w = size_t(picture.image.width), h = size_t(picture.image.height);
  UniformGrid grid;
  grid.dims = {w, h, 1}, grid.origin = {0.5, 0.5, 0};
  FieldSet fields;
  const Seen& s = picture.seen;
  add<float>(fields, "light", s.rgba, w, h);
  add<uint8_t>(fields, "color", picture.image.pixels, w, h);
  add<float>(fields, "depth", s.depth, w, h);
  add<int32_t>(fields, "show", s.show, w, h);
  add<float>(fields, "error", s.light.error, w, h);
  add<float>(fields, "albedo", s.light.albedo, w, h);
  add<float>(fields, "normal", s.light.normal, w, h);
  return make_dataset(Mesh(std::move(grid)), std::move(fields));
}

}  // namespace sg
