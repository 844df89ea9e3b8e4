// SPDX-License-Identifier: Apache-2.0
// The vectors of a texture, as the kernels want them.
#include <fmt/core.h>

#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "render/prepare/prepared.h"

namespace sg {

namespace raster {

namespace {

constexpr size_t numbers_per_chunk = 1 << 15;

Array packed_vectors(const Field& f) {
  if (f.components() == 3 && f.array.type() == ElementType::f32 && f.array.packed()) return f.array;
  float* out = nullptr;
  Array a = Array::make<float>(f.array.count(), 3, &out);
  dispatch(f.array, [&](auto v) {
    parallel_for(v.count, numbers_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        for (int c = 0; c < 3; ++c) out[3 * i + size_t(c)] = c < f.components() ? float(v(i, c)) : 0.0f;
    });
  });
  return a;
}

/// Largest finite component.
float largest_of(const Array& a) {
  const View<float> v = a.view<float>();
  return parallel_reduce<float>(
      v.count, numbers_per_chunk, 0.0f,
      [&](size_t begin, size_t end) {
        float most = 0;
        for (size_t i = begin; i < end; ++i)
          for (int c = 0; c < 3; ++c) {
            const float q = std::abs(v(i, c));
            if (q > most && q <= 3e38f) most = q;
          }
        return most;
      },
      [](float x, float y) { return std::max(x, y); });
}

}  // namespace

void take_texture(const SurfaceTexture& t, PreparedItem& item) {
  if (t.association == Association::whole) fail_usage("a texture needs vectors on points or cells, not of the whole dataset", "lic");
  const Field& f = with_context("lic", [&]() -> const Field& { return item.data->fields().require(t.field, t.association); });
  if (f.components() != 3 && f.components() != 2)
    fail_usage(
        fmt::format("field '{}' has {} component{}, so no vectors to follow", f.name, f.components(), f.components() == 1 ? "" : "s"),
        "lic", "name a field of 3 components, or 2 in the xy plane");
  if (t.steps < 1 || t.steps > 1000) fail_usage(fmt::format("{} steps", t.steps), "lic", "give 1 to 1000 in each direction");
  if (!(t.step > 0 && t.step <= 1)) fail_usage(fmt::format("steps of {} pixels", t.step), "lic", "give more than 0, at most 1");
  if (!(t.grain >= 0.5 && t.grain <= 100)) fail_usage(fmt::format("grains of {} pixels", t.grain), "lic", "give 0.5 to 100");
  struct Vectors {
    Array values;
    float largest = 0;
    size_t bytes() const { return values.bytes(); }
  };
  const auto v = derived(item.data, fmt::format("lic/{}/{}", f.name, int(f.association)), [&] {
    Vectors r{packed_vectors(f), 0};
    r.largest = largest_of(r.values);
    return r;
  });
  item.lic = t, item.lic_vectors = v->values, item.lic_least = 1e-6f * v->largest;
}

}  // namespace raster

bool PreparedScene::textured() const {
  return std::any_of(items.begin(), items.end(), [](const raster::PreparedItem& i) { return i.lic.has_value(); });
}

}  // namespace sg
