// SPDX-License-Identifier: Apache-2.0
// The operations.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "filter/mesh/surface.h"
#include "filter/surface/polygons.h"
#include "simulate/fluid/smoke.h"
#include "simulate/fluid/sources/field_source.h"
#include "simulate/run/frames.h"

namespace sg {

namespace {

// A run, and what was given to it, which tells it apart from others while it is kept.
template <class T>
struct SmokeRun : fluid::Smoke<T> {
  DatasetPtr given;

  SmokeRun(const SmokeParams& p, DatasetPtr data, fluid::SmokeInput input, const Context& context)
      : fluid::Smoke<T>(p, std::move(input), context), given(std::move(data)) {}
};

// `input` makes what is given to the air of `data`, if any.
template <class Params>
DatasetPtr frame_of_any(const std::string& who, const Params& p, const DatasetPtr& data, const GivenData& given,
                        const std::function<fluid::SmokeInput()>& input, Context& context) {
  if (p.advection == fluid::Advection::explicit_euler) context.warn("smoke: explicit advection is unstable and will blow up");
  const auto frame = [&]<class T>(T) {
    return frame_of_run<SmokeRun<T>>(
        who, p, [&] { return std::make_unique<SmokeRun<T>>(p, data, input(), context); }, context, given);
  };
  return p.type == FieldType::f64 ? frame(double()) : frame(float());
}

fluid::TriangleSoup triangles_in(const DatasetPtr& data, Context& context) {
  fluid::TriangleSoup triangles;
  const DatasetPtr s = surface::triangle_surface(data, "smoke_round", context);
  const SurfaceMesh& mesh = *s->as<SurfaceMesh>();
  const std::vector<Vec3> at = surface::positions(mesh.points);
  for (const uint32_t i : triangles_of(mesh).indices) triangles.push_back(at[i]);
  if (triangles.empty()) fail_data("the surface has no triangles", "smoke_round", "give a closed surface");
  return triangles;
}

// Room for the wake: twice as wide as the data, and three times as high.
std::vector<double> room_about(const Box3& data, const std::optional<Vec3>& up_asked, bool flat) {
  const Vec3 c = data.center(), size = data.size(), up = up_asked.value_or(flat ? Vec3(0, 1, 0) : Vec3(0, 0, 1));
  const double half = std::max({size.x, size.y, size.z});
  int axis = flat ? 1 : 2;
  for (int a = 0; a < (flat ? 2 : 3); ++a)
    if (std::abs(up[a]) > std::abs(up[axis])) axis = a;
  std::vector<double> bounds;
  for (int a = 0; a < 3; ++a) {
    const double more = a == axis ? half : 0, wide = flat && a == 2 ? 0 : half;
    bounds.push_back(c[a] - wide - (up[a] < 0 ? more : 0)), bounds.push_back(c[a] + wide + (up[a] < 0 ? 0 : more));
  }
  return bounds;
}

}  // namespace

void describe(Schema& s, SmokeRoundParams& p) {
  s("role", p.role, "What the surface is: an obstacle, or a source of smoke.");
  describe(s, static_cast<SmokeParams&>(p));
}

void describe(Schema& s, SmokeFromParams& p) {
  s("field", p.field, "Scalar field of points or cells, of which the sources have 'density' times the value; default: the active scalar.")
      .takes(fields::scalars);
  s("temperature_field", p.temperature_field,
    "Scalar field of whose values they have 'temperature' times as much; default: of those of 'field'.")
      .takes(fields::scalars);
  describe(s, static_cast<SmokeParams&>(p));
}

DatasetPtr smoke(const SmokeParams& p, Context& context) {
  return frame_of_any(
      "smoke", p, nullptr, {}, [] { return fluid::SmokeInput(); }, context);
}

namespace {

// What `push` makes of air or dust that is moved by it through half of the room, or what comes in at the sides.
double likely_speed(const SmokeParams& p, const fluid::MacGrid& g, double push) {
  const Vec3 up = p.up.value_or(g.flat() ? Vec3(0, 1, 0) : Vec3(0, 0, 1));
  double speed = std::max({length(p.jet), length(p.obstacle_velocity), std::sqrt(push * 0.5 * g.h * double(g.cells[g.flat() ? 1 : 2]))});
  for (const fluid::Side& s : fluid::sides_of(p, g, up)) speed = std::max(speed, length(s.velocity));
  return speed;
}

RunCost cost_of_air(const SmokeParams& p, const std::string& who, double more_push, double more_seconds) {
  constexpr double seconds_a_cell = 2e-7;
  const fluid::MacGrid g = fluid::smoke_grid(p, Context());
  const double cells = double(g.count());
  const size_t number = p.type == FieldType::f64 ? 8 : 4, fields = p.obstacle.empty() ? 6 : 7;
  const double work = (number == 8 ? 2 : 1) * (p.reflect ? 2 : 1);
  const double push = std::abs(p.lift * p.temperature) + std::abs(p.weight * p.density) + more_push;
  return cost_of_flow(p, who, uint64_t(cells) * fields * number, cells * work * seconds_a_cell + more_seconds, p.cfl, g.h,
                      likely_speed(p, g, push));
}

}  // namespace

RunCost cost_of_smoke(const SmokeParams& p) { return cost_of_air(p, "smoke", 0, 0); }

RunCost cost_of_dusty_smoke(const DustySmokeParams& p) {
  constexpr double seconds_a_particle = 4e-6;  // with some ten iterations
  const double particles = p.dust + p.dust_rate * p.time;
  RunCost cost = cost_of_air(p, "dusty_smoke", 0, particles * seconds_a_particle);
  cost.bytes = p.show == DustShow::particles ? uint64_t(particles) * 56 : cost.bytes * 7 / 6;
  return cost;
}

namespace {

// About data whose size nobody knows yet: in a box as it is made about them.
SmokeParams about_data(SmokeParams p) {
  if (p.bounds.empty()) p.bounds = {0, 2, 0, 2, 0, 3};
  return p;
}

}  // namespace

RunCost cost_of_smoke_round(const SmokeRoundParams& p) { return cost_of_smoke(about_data(p)); }
RunCost cost_of_smoke_from(const SmokeFromParams& p) { return cost_of_smoke(about_data(p)); }

DatasetPtr dusty_smoke(const DustySmokeParams& p, Context& context) {
  const auto input = [&] {
    fluid::SmokeInput given;
    given.dust = static_cast<const DustParams&>(p);
    return given;
  };
  return frame_of_any("dusty_smoke", p, nullptr, {}, input, context);
}

DatasetPtr smoke_round(const DatasetPtr& surface, const SmokeRoundParams& p, Context& context) {
  SmokeParams with_box = p;
  if (p.bounds.empty()) {
    if (surface->bounds().empty()) fail_data("the surface is empty", "smoke_round", "give a closed surface");
    with_box.bounds = room_about(surface->bounds(), p.up, false);
  }
  GivenData given;
  given.add(surface, {}, p.role == SurfaceRole::source ? "source " : "obstacle ");
  const auto input = [&] { return fluid::SmokeInput{triangles_in(surface, context), p.role, {}, {}, {}}; };
  return frame_of_any("smoke_round", with_box, surface, given, input, context);
}

DatasetPtr smoke_from(const DatasetPtr& data, const SmokeFromParams& p, Context& context) {
  SmokeParams with_box = p;
  const Box3 box = data->bounds();
  if (data->cell_count() == 0 || data->as<PointCloud>()) fail_usage("points alone have no inside", "smoke_from", "give a mesh with cells");
  if (box.empty()) fail_data("the mesh lies nowhere", "smoke_from");
  if (p.bounds.empty()) with_box.bounds = room_about(box, p.up, box.size().z == 0);
  const fluid::SourceFields fields = fluid::source_fields(*data, p);
  GivenData given;
  given.add(data, {fields.density, fields.temperature});
  const auto input = [&] { return fluid::field_source(data, fields, fluid::smoke_grid(with_box, context), context); };
  return frame_of_any("smoke_from", with_box, data, given, input, context);
}

}  // namespace sg
