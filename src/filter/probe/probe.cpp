// SPDX-License-Identifier: Apache-2.0
#include "filter/probe/probe.h"

#include <fmt/core.h>

#include <numeric>

#include "data/fields/axis_notes.h"
#include "data/lattice.h"
#include "filter/mesh/surface_builder.h"
#include "filter/probe/sample.h"

namespace sg {

namespace {

FieldSet sampled_fields(const DatasetPtr& source, size_t count, const std::function<Vec3(size_t)>& point, bool scattered,
                        Context& context) {
  FieldSampler sampler(*source, count);
  sample_points(source, count, point, scattered, sampler, context);
  return sampler.take();
}

void tell_missing(const FieldSet& fields, Context& context) {
  const auto valid = fields.require("valid", Association::point).array.view<uint8_t>();
  size_t n = 0;
  for (size_t i = 0; i < valid.count; ++i) n += valid[i];
  if (n < valid.count) context.info(fmt::format("probe: {} of {} points lie outside the mesh", valid.count - n, valid.count));
}

}  // namespace

DatasetPtr probe(const DatasetPtr& points, const DatasetPtr& source, const ProbeParams& params, Context& context) {
  const size_t count = points->point_count();
  FieldSet sampled;
  if (const Mesh& mesh = points->mesh(); is_lattice(mesh) && count > 0) {
    const Lattice lattice(mesh);
    const LatticeView v = lattice.view();
    if (fits_sample_grid(v)) {
      FieldSampler sampler(*source, count);
      sample_grid(source, v, sampler, context);
      sampled = sampler.take();
    } else {
      const size_t nx = v.dims[0], ny = v.dims[1];
      sampled = sampled_fields(
          source, count, [&](size_t i) { return v.position(i % nx, i / nx % ny, i / nx / ny); }, false, context);
    }
  } else {
    std::vector<int64_t> all;
    if (points->as<AmrGrid>()) {
      all.resize(count);
      std::iota(all.begin(), all.end(), int64_t(0));
    }
    const Points at = points->as<AmrGrid>() ? amr_points(*points->as<AmrGrid>(), all)
                                            : std::visit(
                                                  [](const auto& m) -> Points {
                                                    if constexpr (requires { m.points; }) return m.points;
                                                    else return {};
                                                  },
                                                  points->mesh());
    const PointReader reader(at);
    sampled = sampled_fields(
        source, count, [&](size_t i) { return reader[i]; }, true, context);
  }
  tell_missing(sampled, context);
  DatasetParts parts = points->parts();
  if (!params.keep_fields) parts.fields = {};
  for (const Field& f : sampled) parts.fields.add(f);
  return make_dataset(std::move(parts));
}

DatasetPtr probe_at(const DatasetPtr& source, const ProbeAtParams& p, Context& context) {
  const bool line = p.from || p.to;
  if (line == !p.points.empty())
    fail_usage("either points or a line between two points is needed", "probe_at", "give points=x,y,z,... or from=x,y,z to=x,y,z");
  if (line && !(p.from && p.to)) fail_usage("a line needs two ends", "probe_at", p.from ? "add to=x,y,z" : "add from=x,y,z");
  if (p.points.size() % 3 != 0)
    fail_usage(fmt::format("{} numbers do not make whole points", p.points.size()), "probe_at",
               "give three numbers per point: points=x,y,z,x,y,z");
  double* xyz = nullptr;
  const size_t count = line ? size_t(p.count) : p.points.size() / 3;
  Points points;
  points.xyz = Array::make<double>(count, 3, &xyz);
  auto at = [&](size_t i) {
    if (!line) return Vec3(p.points[3 * i], p.points[3 * i + 1], p.points[3 * i + 2]);
    return i + 1 == count ? *p.to : lerp(*p.from, *p.to, double(i) / double(count - 1));
  };
  for (size_t i = 0; i < count; ++i)
    for (int a = 0; a < 3; ++a) xyz[3 * i + size_t(a)] = at(i)[a];
  DatasetParts parts;
  parts.fields = sampled_fields(source, count, at, !line, context);
  tell_missing(parts.fields, context);
  if (line) {
    double* distance = nullptr;
    Field f{"distance", Association::point, Array::make<double>(count, 1, &distance), length_unit(*source), Role::none};
    for (size_t i = 0; i < count; ++i) distance[i] = length(at(i) - *p.from);
    parts.fields.add(std::move(f));
    SurfaceMesh mesh;
    mesh.points = std::move(points);
    std::vector<int64_t> ids(count);
    std::iota(ids.begin(), ids.end(), int64_t(0));
    mesh.lines.connectivity = Array::from_vector(std::move(ids));
    mesh.lines.offsets = Array::from_vector(std::vector<int64_t>{0, int64_t(count)});
    parts.mesh = std::move(mesh);
  } else {
    parts.mesh = PointCloud{std::move(points)};
  }
  parts.time = source->time();
  return make_dataset(std::move(parts));
}

}  // namespace sg
