// SPDX-License-Identifier: Apache-2.0
// Streamlines of the ABC flow through a grid and through tetrahedra, with the settings of the peers' stream tracers.
#include <fmt/core.h>

#include <numbers>

#include "base/parallel.h"
#include "bench.h"
#include "data/cells/point_positions.h"
#include "filter/flow/streamlines.h"
#include "inputs.h"

namespace sg::bench {

namespace {

/// One period of the ABC flow on [-1,1]^3 (A = sqrt 3, B = sqrt 2, C = 1).
Vec3 abc_flow(Vec3 p) {
  const double a = std::sqrt(3.0), b = std::sqrt(2.0), c = 1, x = std::numbers::pi * (p.x + 1), y = std::numbers::pi * (p.y + 1),
               z = std::numbers::pi * (p.z + 1);
  return {a * std::sin(z) + c * std::cos(y), b * std::sin(x) + a * std::cos(z), c * std::sin(y) + b * std::cos(x)};
}

Field abc_field(const Mesh& mesh) {
  const Array at = point_positions(mesh);
  const View<double> x = at.view<double>();
  float* v = nullptr;
  Array values = Array::make<float>(x.count, 3, &v);
  parallel_for(x.count, 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3 u = abc_flow({x(i, 0), x(i, 1), x(i, 2)});
      for (int c = 0; c < 3; ++c) v[3 * i + size_t(c)] = float(u[c]);
    }
  });
  return {"abc", Association::point, values, "", Role::vectors};
}

enum class Cells { grid, tets, hexes };

DatasetPtr flow_input(Cells cells) {
  const DatasetPtr plain = cells == Cells::tets ? tetrahedra(55) : cells == Cells::hexes ? hexahedra(100) : nullptr;
  UniformGrid g;
  g.dims = {128, 128, 128};
  g.origin = {-1, -1, -1};
  g.spacing = Vec3(1, 1, 1) * (2.0 / 127);
  const Mesh mesh = plain ? plain->mesh() : Mesh(g);
  FieldSet fields;
  fields.add(abc_field(mesh));
  return make_dataset(mesh, std::move(fields));
}

/// Low-discrepancy points in [-0.9,0.9]^3, as the peers'.
DatasetPtr flow_seeds(size_t n) {
  const double g = 1.22074408460575947536;
  float* xyz = nullptr;
  PointCloud cloud;
  cloud.points.xyz = Array::make<float>(n, 3, &xyz);
  for (size_t i = 0; i < n; ++i)
    for (int a = 0; a < 3; ++a) {
      const double s = 0.5 + double(i + 1) * (a == 0 ? 1 / g : a == 1 ? 1 / (g * g) : 1 / (g * g * g));
      xyz[3 * i + size_t(a)] = float(1.8 * (s - std::floor(s)) - 0.9);
    }
  return make_dataset(std::move(cloud));
}

Task streamlines_task(Cells cells, const char* scheme, const char* label) {
  constexpr size_t seeds = 10000;
  return {"streamlines",
          fmt::format("{} x {} seeds x <=1000 steps",
                      cells == Cells::tets    ? "tet1M"
                      : cells == Cells::hexes ? "hex1M"
                                              : "uniform128",
                      seeds),
          fmt::format("sightglass:streamlines({})", label), "steps", [=] {
            // As for the peers, every run gets a mesh that nothing is known of.
            const DatasetPtr first = flow_input(cells), from = flow_seeds(seeds);
            auto pool = std::make_shared<std::vector<DatasetPtr>>();
            for (int i = 0; i < 16; ++i) pool->push_back(make_dataset(first->parts()));
            return [=] {
              const DatasetPtr input = pool->empty() ? make_dataset(first->parts()) : pool->back();
              if (!pool->empty()) pool->pop_back();
              const double h = 2.0 / 127;
              StreamlinesParams p;
              p.direction = TraceDirection::forward;
              p.integration.integrator = *value_of_word<Scheme>(scheme);
              p.integration.step = 0.5 * h, p.integration.min_step = 0.05 * h, p.integration.max_step = 2 * h;
              p.integration.step_unit = StepUnit::length;
              p.integration.tolerance = 1e-6 / (cells == Cells::tets ? 2.0 / 55 : h);  // theirs is a length
              p.stop.max_steps = 1000, p.stop.min_speed = 1e-12, p.stop.closed = false, p.stop.max_length = 1e6;
              Context context;
              const Data out = streamlines({Data(input), Data(from)}, p, context);
              const auto& lines = *std::get<DatasetPtr>(out)->as<SurfaceMesh>();
              return double(lines.points.count() - lines.lines.size());
            };
          }};
}

}  // namespace

void add_flow_tasks(std::vector<Task>& t) {
  for (const Cells cells : {Cells::grid, Cells::tets, Cells::hexes}) {
    t.push_back(streamlines_task(cells, "rk4", "RK4"));
    t.push_back(streamlines_task(cells, "dormand_prince", "RK45"));
  }
}

}  // namespace sg::bench
