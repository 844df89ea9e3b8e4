// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/faces.h"

#include "data/field_ops.h"
#include "filter/mesh/extract.h"
#include "filter/mesh/faces_impl.h"

namespace sg {

namespace {

// The assembled surface with its points, fields, notes and time.
DatasetPtr finish(const Dataset& in, AssembledSurface s, const FacesParams& p) {
  DatasetParts out;
  detail::NodeBlend blend;
  if (auto* m = in.as<UnstructuredMesh>()) blend = detail::bezier_blend(in, *m, s.points);
  if (blend.width > 0) {
    const Points& points = in.as<UnstructuredMesh>()->points;
    s.mesh.points = {combine(points.xyz, blend.ids, blend.weights, blend.width), points.origin};
    carry_combined(out.fields, in.fields(), Association::point, blend.ids, blend.weights, blend.width, Association::point);
  } else {
    s.mesh.points = points_of(in.mesh(), s.points);
    carry_gathered(out.fields, in.fields(), Association::point, s.points, Association::point);
  }
  if (!in.as<PointCloud>()) carry_gathered(out.fields, in.fields(), Association::cell, s.cells, Association::cell);
  carry_whole(out.fields, in.fields());
  if (p.original_cell && !in.as<PointCloud>()) out.fields.add(id_field("original_cell", Association::cell, std::move(s.cells)));
  if (p.original_point) out.fields.add(id_field("original_point", Association::point, std::move(s.points)));
  out.mesh = std::move(s.mesh);
  out.notes = in.notes();
  out.time = in.time();
  return make_dataset(std::move(out));
}

// Every point a vertex, except hidden and duplicate ones.
std::vector<SurfaceChunk> cloud_vertices(const Dataset& in) {
  SurfaceChunk all;
  const Array& ghost = in.point_ghost();
  for (size_t i = 0; i < in.point_count(); ++i) {
    if (!ghost.empty() && ghost.view<uint8_t>()[i] & (ghost_duplicate | ghost_hidden_point)) continue;
    const auto id = int64_t(i);
    all.vertices.add(std::span(&id, 1), id);
  }
  std::vector<SurfaceChunk> r;
  r.push_back(std::move(all));
  return r;
}

}  // namespace

DatasetPtr faces(const DatasetPtr& in, const FacesParams& p, Context& ctx) {
  const std::vector<uint8_t> states = cell_states(*in);
  if (in->as<SurfaceMesh>()) {
    if (states.empty()) return in;
    std::vector<int64_t> visible;
    for (size_t c = 0; c < states.size(); ++c)
      if (states[c] == cell_visible) visible.push_back(int64_t(c));
    return extract_cells(in, visible, "faces");
  }
  std::vector<SurfaceChunk> chunks;
  if (auto* m = in->as<UnstructuredMesh>()) chunks = detail::unstructured_faces(*m, states, ctx);
  else if (auto* g = in->as<AmrGrid>()) chunks = detail::amr_faces(*in, *g, states, ctx);
  else if (in->as<PointCloud>()) chunks = cloud_vertices(*in);
  else chunks = detail::lattice_faces(in->mesh(), states, ctx);
  return finish(*in, assemble(chunks, in->point_count()), p);
}

}  // namespace sg
