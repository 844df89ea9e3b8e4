// SPDX-License-Identifier: Apache-2.0
// The operations.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "base/error.h"
#include "filter/mesh/surface.h"
#include "filter/surface/polygons.h"
#include "simulate/fluid/smoke.h"
#include "simulate/run/frames.h"

namespace sg {

namespace {

// A run, and what was given to it, which tells it apart from others while it is kept.
template <class T>
struct SmokeRun : fluid::Smoke<T> {
  DatasetPtr given;

  SmokeRun(const SmokeParams& p, DatasetPtr surface, fluid::TriangleSoup triangles, bool gives_off, const Context& context)
      : fluid::Smoke<T>(p, std::move(triangles), gives_off, context), given(std::move(surface)) {}
};

template <class T>
DatasetPtr frame_of_smoke(const SmokeParams& p, const DatasetPtr& given, bool gives_off, Context& context) {
  const auto begin = [&] {
    fluid::TriangleSoup triangles;
    if (given) {
      const DatasetPtr s = surface::triangle_surface(given, "smoke_round", context);
      const SurfaceMesh& mesh = *s->as<SurfaceMesh>();
      const std::vector<Vec3> at = surface::positions(mesh.points);
      for (const uint32_t i : triangles_of(mesh).indices) triangles.push_back(at[i]);
      if (triangles.empty()) fail_data("the surface has no triangles", "smoke_round", "give a closed surface");
    }
    return std::make_unique<SmokeRun<T>>(p, given, std::move(triangles), gives_off, context);
  };
  GivenData data;
  if (given) data.add(given, {}, gives_off ? "source " : "obstacle ");
  return frame_of_run<SmokeRun<T>>(given ? "smoke_round" : "smoke", p, begin, context, data);
}

DatasetPtr frame_of_any(const SmokeParams& p, const DatasetPtr& given, bool gives_off, Context& context) {
  if (p.advection == fluid::Advection::explicit_euler) context.warn("smoke: explicit advection is unstable and will blow up");
  return p.type == FieldType::f64 ? frame_of_smoke<double>(p, given, gives_off, context)
                                  : frame_of_smoke<float>(p, given, gives_off, context);
}

}  // namespace

void describe(Schema& s, SmokeRoundParams& p) {
  s("role", p.role, "What the surface is: an obstacle, or a source of smoke.");
  describe(s, static_cast<SmokeParams&>(p));
}

DatasetPtr smoke(const SmokeParams& p, Context& context) { return frame_of_any(p, nullptr, false, context); }

RunCost cost_of_smoke(const SmokeParams& p) {
  constexpr double seconds_a_cell = 2e-7;
  const double cells = fluid::smoke_grid(p, Context()).count();
  const size_t number = p.type == FieldType::f64 ? 8 : 4, fields = p.obstacle.empty() ? 6 : 7;
  const double work = (number == 8 ? 2 : 1) * (p.reflect ? 2 : 1);
  return {uint64_t(cells) * fields * number, cells * double(frame_at(p, "smoke")) * work * seconds_a_cell};
}

DatasetPtr smoke_round(const DatasetPtr& surface, const SmokeRoundParams& p, Context& context) {
  SmokeParams with_box = p;
  if (p.bounds.empty()) {  // room for the wake
    const Box3 b = surface->bounds();
    if (b.empty()) fail_data("the surface is empty", "smoke_round", "give a closed surface");
    const Vec3 c = b.center(), size = b.size();
    const double half = std::max({size.x, size.y, size.z});
    const Vec3 up = p.up.value_or(Vec3(0, 0, 1));
    int axis = 2;
    for (int a = 0; a < 2; ++a)
      if (std::abs(up[a]) > std::abs(up[axis])) axis = a;
    for (int a = 0; a < 3; ++a) {
      const double more = a == axis ? half : 0;
      with_box.bounds.push_back(c[a] - half - (up[a] < 0 ? more : 0)), with_box.bounds.push_back(c[a] + half + (up[a] < 0 ? 0 : more));
    }
  }
  return frame_of_any(with_box, surface, p.role == SurfaceRole::source, context);
}

}  // namespace sg
