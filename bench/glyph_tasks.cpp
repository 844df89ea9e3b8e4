// SPDX-License-Identifier: Apache-2.0
// Glyphs: a hundred thousand arrows as a picture and as geometry, under the names of the peers' records.
#include <fmt/core.h>

#include "bench.h"
#include "filter/glyph/geometry.h"
#include "filter/glyph/shapes.h"
#include "render/render.h"

namespace sg::bench {

namespace {

// Low-discrepancy places in [-0.9, 0.9]^3 (the R3 sequence) with the ABC flow at them: as in the peers' scripts.
DatasetPtr flow_places(size_t n) {
  const double g = 1.22074408460575947536, step[3] = {1 / g, 1 / (g * g), 1 / (g * g * g)}, pi = 3.14159265358979323846;
  std::vector<float> xyz, v;
  for (size_t i = 1; i <= n; ++i) {
    double p[3];
    for (int c = 0; c < 3; ++c) {
      const double u = 0.5 + double(i) * step[c];
      xyz.push_back(float(1.8 * (u - std::floor(u)) - 0.9));
      p[c] = pi * (double(xyz.back()) + 1);
    }
    const double a = std::sqrt(3.0), b = std::sqrt(2.0), e = 1;
    v.push_back(float(a * std::sin(p[2]) + e * std::cos(p[1])));
    v.push_back(float(b * std::sin(p[0]) + a * std::cos(p[2])));
    v.push_back(float(e * std::sin(p[1]) + b * std::cos(p[0])));
  }
  FieldSet fields;
  fields.add({"abc", Association::point, Array::from_vector(std::move(v), 3), "", Role::vectors});
  return make_dataset(Mesh(PointCloud{{Array::from_vector(std::move(xyz), 3), {}}}), std::move(fields));
}

GlyphsItem arrows(size_t n) {
  Context context;
  GlyphShapeParams shape;
  shape.sides = 6, shape.tip_radius = 0.1, shape.shaft_radius = 0.03;  // the peer's arrow
  GlyphsItem g;
  g.data = flow_places(n), g.shapes = {glyph_shape_mesh(shape, context)};
  g.rule.vectors = "abc", g.rule.size = GlyphRule::Size::length, g.rule.scale = 0.02;
  return g;
}

Task frame(const char* label, size_t n) {
  return {"glyphs_100k_render", fmt::format("{} arrows, 1024x1024", n), label, "pixels covered", [=] {
            auto scene = std::make_shared<Scene>();
            scene->items.emplace_back(arrows(n));
            auto turn = std::make_shared<double>(0);
            return [=] {
              Context context;
              *turn += 2;
              RenderOptions o;
              o.width = o.height = 1024, o.samples = 1;
              const Frame f = render(*scene, peers_camera(*turn), o, context);
              return double(std::count_if(f.ids.begin(), f.ids.end(), [](uint32_t id) { return id > 0; }));
            };
          }};
}

Task geometry() {
  return {"glyphs_100k", "100000 arrows", "sightglass:glyphs", "cells", [] {
            auto item = std::make_shared<GlyphsItem>(arrows(100000));
            return [=] {
              Context context;
              const DatasetPtr fresh = make_dataset(item->data->parts());  // knows nothing from the run before
              return double(glyph_geometry(fresh, item->rule, item->shapes, context)->cell_count());
            };
          }};
}

}  // namespace

void add_glyph_tasks(std::vector<Task>& t) {
  t.push_back(frame("sightglass:glyphs", 100000));
  t.push_back(frame("sightglass:glyphs", 1000000));
  t.push_back(geometry());
}

}  // namespace sg::bench
