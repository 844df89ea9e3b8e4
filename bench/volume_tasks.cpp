// SPDX-License-Identifier: Apache-2.0
// Frames of volumes: lattices of two sizes and types in the peers' four scenes, and a transfer function that changes.
#include <fmt/core.h>

#include "base/parallel.h"
#include "bench.h"
#include "data/memory/memo.h"
#include "inputs.h"
#include "render/progressive.h"
#include "render/volume/sources/lattice/lattice_volume.h"

namespace sg::bench {

namespace {

/// The peers' uint8 field: [-3, 4] on 0..255.
constexpr double field_lo = -3, field_hi = 4;
DatasetPtr field_u8(size_t n) {
  const DatasetPtr f = field_grid(n);
  const View<float> in = f->fields()[0].array.view<float>();
  uint8_t* out = nullptr;
  Array a = Array::make<uint8_t>(in.count, 1, &out);
  parallel_for(in.count, 65536, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      out[i] = uint8_t(std::clamp(std::nearbyint((double(in[i]) - field_lo) * (255 / (field_hi - field_lo))), 0.0, 255.0));
  });
  FieldSet fields;
  fields.add({"f", Association::point, a, "", Role::scalars});
  return make_dataset(f->mesh(), fields);
}

enum class Look { composite, shaded, maximum, fog };

VolumeItem volume_item(Look look, size_t n, bool bytes) {
  VolumeItem item;
  item.data = bytes ? field_u8(n) : field_grid(n);
  item.field = "f";
  item.color.map = find_colormap("sight");
  item.color.lo = field_lo, item.color.hi = field_hi;
  item.opacity.points = {{-3, 0}, {-.9, 0}, {-.6, .15}, {-.3, 0}, {.2, 0}, {.5, .3}, {.8, 0}, {1.6, 0}, {2, .8}, {4, .8}};
  if (look == Look::fog) item.opacity.points = {{-3, .002}, {4, .01}};
  if (look == Look::maximum) item.mode = VolumeItem::Mode::maximum, item.opacity.points = {{-3, 0}, {4, 1}};
  if (bytes) {
    const auto stored = [](double v) { return (v - field_lo) * 255 / (field_hi - field_lo); };
    for (Vec2& p : item.opacity.points) p.x = stored(p.x);
    item.color.lo = 0, item.color.hi = 255;
  }
  item.unit_distance = 2.0 / 255;
  item.sampling.step = 1.0 / double(n - 1);
  item.shaded = look == Look::shaded;
  item.light.ambient = 0.2, item.light.diffuse = 0.7, item.light.specular = 0.3, item.light.power = 20;  // the peers'
  return item;
}

/// tolerance 0: fixed half-voxel steps, as the peers.
Task volume(const char* label, Look look, size_t n, bool bytes, double tolerance = 0) {
  return {"volume_render", fmt::format("{} {}^3, 1024x1024", bytes ? "uint8" : "float32", n),
          fmt::format("sightglass:raycast({}{})", label, tolerance > 0 ? ",tolerance" : ""), "pixels covered", [=] {
            Scene scene;
            VolumeItem item = volume_item(look, n, bytes);
            if (tolerance > 0) item.sampling.step = 0, item.sampling.tolerance = tolerance;
            scene.items.emplace_back(std::move(item));
            scene.lights = {{{0, 0, 1}, true, 1}};  // the peers' headlight
            auto turn = std::make_shared<double>(0);
            auto shared = std::make_shared<Scene>(std::move(scene));
            return [=] {
              Context context;
              *turn += 2;
              RenderOptions o;
              o.width = o.height = 1024, o.samples = 1;
              const Frame f = render(*shared, peers_camera(*turn), o, context);
              return double(f.pixels());
            };
          }};
}

/// A picture of one ray for 16 x 16 pixels: what progressive rendering shows first.
Task first_progressive(size_t n) {
  return {
      "volume_progressive_first", fmt::format("float32 {}^3, 1024x1024", n), "sightglass:progressive", "pixels", [=] {
        Scene scene;
        VolumeItem item = volume_item(Look::shaded, n, false);
        item.sampling.step = 0;
        scene.items.emplace_back(std::move(item));
        auto shared = std::make_shared<Scene>(std::move(scene));
        auto turn = std::make_shared<double>(0);
        return [=] {
          Context context;
          *turn += 2;
          RenderOptions o;
          o.width = o.height = 1024, o.samples = 1;
          return double(render_progressively(*shared, peers_camera(*turn), o, context, [](const Frame&, int) { return false; }).pixels());
        };
      }};
}

/// What a new transfer function costs before rays start: its table and the map of the empty bricks.
Task new_transfer_function(size_t n) {
  return {"volume_transfer_change", fmt::format("float32 {}^3", n), "sightglass:prepare", "empty bricks", [=] {
            auto item = std::make_shared<VolumeItem>(volume_item(Look::composite, n, false));
            volume::prepare(*item, 1, {});
            return [=] {
              item->opacity.points[3].x -= 1e-3;
              const volume::Volume v = volume::prepare(*item, 1, {});
              return double(v.fine().size() - size_t(std::count(v.distance.begin(), v.distance.end(), 0)));
            };
          }};
}

}  // namespace

void add_volume_tasks(std::vector<Task>& t) {
  for (const size_t n : {256, 512})
    for (const bool bytes : {true, false}) {
      t.push_back(volume("composite", Look::composite, n, bytes));
      t.push_back(volume("composite,shaded", Look::shaded, n, bytes));
      if (!bytes) {
        t.push_back(volume("composite", Look::composite, n, bytes, 1.0 / 512));
        t.push_back(volume("composite,shaded", Look::shaded, n, bytes, 1.0 / 512));
        t.push_back(volume("composite,fog(no skipping)", Look::fog, n, bytes, 1.0 / 512));
      }
      t.push_back(volume("MIP", Look::maximum, n, bytes));
      if (!bytes) t.push_back(volume("composite,fog(no skipping)", Look::fog, n, bytes));
    }
  t.push_back(first_progressive(512));
  t.push_back(new_transfer_function(256));
  t.push_back(new_transfer_function(512));
}

}  // namespace sg::bench
