// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/vortex/core_lines.h"

#include <algorithm>

#include "base/parallel.h"
#include "data/cells/cell_reader.h"
#include "data/fields/known_looks.h"
#include "data/trusted.h"
#include "filter/flow/eigen_general.h"
#include "filter/flow/flow_parts.h"
#include "filter/flow/vortex/keep_large.h"
#include "filter/flow/vortex/measures.h"
#include "filter/flow/vortex/parallel_vectors.h"
#include "filter/flow/vortex/whole_faces.h"

namespace sg {

void describe(Schema& s, VortexCoresParams& p) {
  s("field", p.field, "Velocity field; default: the active vectors.").takes(fields::vectors);
  s("method", p.method, "sujudi_haimes: velocity along the real eigenvector of its gradient. levy: velocity along the vorticity.");
  s("min_swirl", p.min_swirl, "Minimum swirling strength, as a fraction of the largest on any core.").range(0, 1);
  s("max_angle", p.max_angle, "Largest angle between a core and the flow on it; 90 keeps all.").unit("deg").range(0, 90);
  s("min_length", p.min_length, "Minimum length of a core, as a fraction of the mesh's diagonal.").range(0, 1);
}

namespace {

// Of each point of the lines: interpolated velocity and gradient.
struct AtPoint {
  Vec3 u;
  Mat3 j;
};

AtPoint at_point(const ParallelLines& lines, const ParallelPoint& p, std::span<const Vec3> u, const View<double>& g) {
  AtPoint r;
  for (auto& row : r.j.m)
    for (double& e : row) e = 0;
  for (uint32_t k = p.first; k < p.first + p.count; ++k) {
    const double w = lines.weights[k];
    const auto id = size_t(lines.ids[k]);
    r.u += u[id] * w;
    for (int m = 0; m < 9; ++m) r.j.m[m / 3][m % 3] += w * g(id, m);
  }
  return r;
}

double angle_between(Vec3 a, Vec3 b) {
  const double l = length(a) * length(b);
  return l > 0 ? std::acos(std::min(1.0, std::abs(dot(a, b)) / l)) * 180 / 3.14159265358979323846 : 0;
}

DatasetPtr of_mesh(const DatasetPtr& given, const VortexCoresParams& p, Context& context) {
  Field velocity = flow_field_of(*given, p.field.name, "vortex_cores");
  const double nothing = parallel_within(velocity.array.type());
  const DatasetPtr in = with_whole_faces(given, {velocity}, context);
  velocity = flow_field_of(*in, velocity.name, "vortex_cores");
  const std::vector<Vec3> u = point_vectors(in, velocity, context);
  DatasetPtr data = in;
  if (velocity.association == Association::cell) {  // its gradient is wanted at the points too
    std::vector<double> xyz;
    for (const Vec3& v : u) xyz.insert(xyz.end(), {v.x, v.y, v.z});
    DatasetParts parts = in->parts();
    velocity = {velocity.name, Association::point, Array::from_vector(std::move(xyz), 3), velocity.unit, Role::vectors};
    parts.fields.remove(velocity.name, Association::cell);
    parts.fields.add(velocity);
    data = make_dataset(std::move(parts));
  }
  const Array gradients = velocity_gradients(data, velocity, context);
  const View<double> g = gradients.view<double>();
  std::vector<Vec3> w(u.size());
  const bool levy = p.method == CoreMethod::levy;
  parallel_for(u.size(), 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Mat3 j;
      for (int k = 0; k < 9; ++k) j.m[k / 3][k % 3] = g(i, k);
      w[i] = levy ? Vec3(j.m[2][1] - j.m[1][2], j.m[0][2] - j.m[2][0], j.m[1][0] - j.m[0][1]) : j * u[i];
    }
  });
  ParallelLines lines = parallel_lines(data, u, w, context, nothing);

  std::vector<double> swirl(lines.points.size()), angle(lines.points.size(), 0);
  std::vector<AtPoint> at(lines.points.size());
  double strongest = 0;
  for (size_t i = 0; i < swirl.size(); ++i) {
    at[i] = at_point(lines, lines.points[i], u, g);
    const GeneralEigenvalues e = general_eigenvalues(at[i].j);
    swirl[i] = e.complex_pair ? e.im : 0;
    // u must be the eigenvector of the real eigenvalue: with u = ratio * J u, that is 1/ratio.
    if (e.complex_pair && !levy && std::abs(1 / lines.points[i].ratio - e.real[0]) > 1e-3 * (e.im + std::abs(e.real[0]))) {
      const Vec3 along = eigenvector_of(at[i].j, e.real[0]);
      if (angle_between(along, at[i].u) > 5) swirl[i] = 0;
    }
    strongest = std::max(strongest, swirl[i]);
  }
  ParallelLines kept = lines;
  kept.segments.clear(), kept.cells.clear();
  const double least = std::max(p.min_swirl * strongest, 1e-300);
  CellReader reader(data);
  for (size_t s = 0; s < lines.cells.size(); ++s) {
    const uint32_t a = lines.segments[2 * s], b = lines.segments[2 * s + 1];
    const Vec3 along = lines.points[b].at - lines.points[a].at;
    reader.open(size_t(lines.cells[s]));
    // Between points separated only by rounding, as next to a corner within an edge, there is no direction.
    const bool apart = length(along) > 1e3 * nothing * reader.box().diagonal();
    const double turn = apart ? angle_between(along, at[a].u + at[b].u) : 0;
    if (swirl[a] < least || swirl[b] < least || turn > p.max_angle) continue;
    kept.segments.push_back(a), kept.segments.push_back(b), kept.cells.push_back(lines.cells[s]);
    angle[a] = std::max(angle[a], turn), angle[b] = std::max(angle[b], turn);
  }
  const DatasetPtr with = parallel_lines_mesh(in, kept, context, {{"swirling strength", swirl}, {"core angle", angle}});
  const DatasetPtr joined = long_lines(with, p.min_length * in->bounds().diagonal(), "vortex_cores", context);
  DatasetParts parts = joined->parts();
  mark_result(parts.fields, "swirling strength", Association::point);
  return make_trusted_dataset(std::move(parts));
}

}  // namespace

Data vortex_cores(const Data& in, const VortexCoresParams& p, Context& context) {
  std::string field = p.field.name;
  return each_flow_mesh(
      flow_meshes(in, field, "vortex_cores"), [&](const DatasetPtr& d) { return of_mesh(d, p, context); }, context);
}

}  // namespace sg
