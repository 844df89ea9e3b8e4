// SPDX-License-Identifier: Apache-2.0
// Frames of a surface with a flow texture: the peers' mesh of a million triangles, their camera and their number of steps.
#include <fmt/core.h>

#include <cmath>

#include "base/parallel.h"
#include "bench.h"
#include "inputs.h"
#include "render/render.h"

namespace sg::bench {

namespace {

constexpr double pi = 3.14159265358979323846;

/// The million triangles with the ABC flow of the peers on their points: one period on [-1, 1]^3.
DatasetPtr surface_in_flow() {
  const DatasetPtr d = surface_mesh(235);
  const Points& points = d->as<SurfaceMesh>()->points;
  const double a = std::sqrt(3.0), b = std::sqrt(2.0), c = 1;
  float* out = nullptr;
  Array v = Array::make<float>(points.count(), 3, &out);
  parallel_for(points.count(), 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3 p = (points.at(i) + Vec3(1, 1, 1)) * pi;
      out[3 * i] = float(a * std::sin(p.z) + c * std::cos(p.y)), out[3 * i + 1] = float(b * std::sin(p.x) + a * std::cos(p.z));
      out[3 * i + 2] = float(c * std::sin(p.y) + b * std::cos(p.x));
    }
  });
  DatasetParts parts = d->parts();
  parts.fields.add({"abc", Association::point, v, "", Role::vectors});
  return make_dataset(std::move(parts));
}

Task surface_texture(const char* label, int steps, double step) {
  return {"surface_lic", "1M triangles, 1024x1024", fmt::format("sightglass:surface lic({})", label), "pixels covered", [=] {
            auto scene = std::make_shared<Scene>();
            SurfaceItem item;
            item.data = surface_in_flow();
            if (steps > 0) {
              item.lic.emplace();
              item.lic->field = "abc", item.lic->steps = steps, item.lic->step = step, item.lic->kernel = LicKernel::box;
            }
            scene->items.emplace_back(std::move(item));
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

}  // namespace

void add_lic_tasks(std::vector<Task>& t) {
  t.push_back(surface_texture("40 steps", 40, 0.4));
  t.push_back(surface_texture("80 steps: the samples of two passes", 80, 0.4));  // ParaView's default convolves twice
  t.push_back(surface_texture("none: the surface alone", 0, 0));
}

}  // namespace sg::bench
