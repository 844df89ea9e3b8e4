// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/faces.h"

#include <optional>

#include "base/parallel.h"
#include "data/field_ops.h"
#include "filter/mesh/extract.h"
#include "filter/mesh/faces_impl.h"

namespace sg {

namespace {

// Fields that no blend of values makes sense for take the value of the node with the largest weight.
bool is_picked(const Field& f) {
  return !is_float(f.array.type()) || f.role == Role::labels || f.role == Role::global_ids || f.role == Role::colors;
}

// Points and their fields where some are blends of points of the mesh: new ones, Bezier nodes.
void blend_points(const Dataset& in, const UnstructuredMesh& mesh, const detail::CurvedSkin& curved, std::vector<int64_t>& kept,
                  DatasetParts& out, SurfaceMesh& surface) {
  const size_t old = size_t(std::lower_bound(kept.begin(), kept.end(), int64_t(mesh.points.count())) - kept.begin());
  const detail::NodeBlend nodes = detail::bezier_blend(in, mesh, std::span(kept).first(old));
  if (old == kept.size() && nodes.width == 0) {
    surface.points = points_of(in.mesh(), kept);
    return carry_gathered(out.fields, in.fields(), Association::point, kept, Association::point);
  }
  const size_t made = kept.size() - old, chunks = (made + 4095) / 4096;
  struct Blends {
    std::vector<int64_t> ids;
    std::vector<double> weights;
    std::vector<size_t> end;
  };
  std::vector<Blends> found(chunks);
  parallel_for(made, 4096, [&](size_t begin, size_t end) {
    Blends& b = found[begin / 4096];
    for (size_t i = begin; i < end; ++i) {
      std::vector<int64_t> ids;
      std::vector<double> weights;
      curved.blend(kept[old + i], ids, weights);
      b.ids.insert(b.ids.end(), ids.begin(), ids.end());
      b.weights.insert(b.weights.end(), weights.begin(), weights.end());
      b.end.push_back(b.ids.size());
    }
  });
  size_t width = std::max<size_t>(nodes.width, 1);
  for (const Blends& b : found)
    for (size_t i = 0; i < b.end.size(); ++i) width = std::max(width, b.end[i] - (i ? b.end[i - 1] : 0));
  std::vector<int64_t> ids(kept.size() * width), nearest(kept.size());
  std::vector<double> weights(kept.size() * width, 0.0);
  parallel_for(kept.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      std::span<const int64_t> from;
      std::span<const double> share;
      const double one = 1;
      if (p < old) {
        from = nodes.width ? std::span(nodes.ids).subspan(p * nodes.width, nodes.width) : std::span<const int64_t>(&kept[p], 1);
        share = nodes.width ? std::span(nodes.weights).subspan(p * nodes.width, nodes.width) : std::span<const double>(&one, 1);
      } else {
        const Blends& b = found[(p - old) / 4096];
        const size_t i = (p - old) % 4096, first = i ? b.end[i - 1] : 0;
        from = std::span(b.ids).subspan(first, b.end[i] - first), share = std::span(b.weights).subspan(first, from.size());
      }
      size_t best = 0;
      for (size_t k = 0; k < width; ++k) {
        ids[p * width + k] = from[k < from.size() ? k : 0];
        if (k < from.size()) weights[p * width + k] = share[k];
        if (k < from.size() && share[k] > share[best]) best = k;
      }
      nearest[p] = from[best];
    }
  });
  surface.points = {combine(mesh.points.xyz, ids, weights, width), mesh.points.origin};
  for (const Field& f : in.fields()) {
    if (f.association != Association::point) continue;
    Field g = f;
    g.array = is_picked(f) ? gather(f.array, nearest) : combine(f.array, ids, weights, width);
    out.fields.add(std::move(g));
  }
  for (size_t p = old; p < kept.size(); ++p) kept[p] = -1;
}

// The assembled surface with its points, fields, notes and time.
Skin finish(const Dataset& in, AssembledSurface s, const FacesParams& p, const detail::CurvedSkin* curved) {
  DatasetParts out;
  Skin skin;
  if (curved) {
    blend_points(in, *in.as<UnstructuredMesh>(), *curved, s.points, out, s.mesh);
  } else {
    s.mesh.points = points_of(in.mesh(), s.points);
    carry_gathered(out.fields, in.fields(), Association::point, s.points, Association::point);
  }
  if (s.outlines.size() > 0) {
    SurfaceMesh edges;
    edges.points = s.mesh.points, edges.lines = std::move(s.outlines);
    skin.edges = make_dataset(std::move(edges));
  }
  if (!in.as<PointCloud>()) carry_gathered(out.fields, in.fields(), Association::cell, s.cells, Association::cell);
  carry_whole(out.fields, in.fields());
  if (p.original_cell && !in.as<PointCloud>()) out.fields.add(id_field("original_cell", Association::cell, std::move(s.cells)));
  if (p.original_point) out.fields.add(id_field("original_point", Association::point, std::move(s.points)));
  out.mesh = std::move(s.mesh);
  out.notes = in.notes();
  out.time = in.time();
  skin.surface = make_dataset(std::move(out));
  return skin;
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

Skin make_skin(const DatasetPtr& in, const FacesParams& p, bool edges, Context& ctx) {
  const std::vector<uint8_t> states = cell_states(*in);
  if (in->as<SurfaceMesh>()) {
    if (states.empty()) return {in, nullptr};
    std::vector<int64_t> visible;
    for (size_t c = 0; c < states.size(); ++c)
      if (states[c] == cell_visible) visible.push_back(int64_t(c));
    return {extract_cells(in, visible, "faces"), nullptr};
  }
  std::vector<SurfaceChunk> chunks;
  std::optional<detail::CurvedSkin> curved;
  if (auto* m = in->as<UnstructuredMesh>()) {
    std::vector<detail::CurvedChunk> found;
    chunks = detail::unstructured_faces(*m, states, found, ctx);
    bool any = false, any_face = false;
    for (const auto& c : found) any = any || !c.items.empty();
    for (const auto& c : found)
      for (const auto& f : c.items) any_face = any_face || !f.is_curve;
    if (any) {
      curved.emplace(*in, *m, std::move(found), p.tolerance, ctx);
      curved->merge(chunks, edges && any_face);
    }
  } else if (auto* g = in->as<AmrGrid>()) {
    chunks = detail::amr_faces(*in, *g, states, ctx);
  } else if (in->as<PointCloud>()) {
    chunks = cloud_vertices(*in);
  } else {
    chunks = detail::lattice_faces(in->mesh(), states, ctx);
  }
  return finish(*in, assemble(chunks, curved ? curved->point_count() : in->point_count()), p, curved ? &*curved : nullptr);
}

}  // namespace

DatasetPtr faces(const DatasetPtr& in, const FacesParams& p, Context& ctx) { return make_skin(in, p, false, ctx).surface; }

Skin faces_and_edges(const DatasetPtr& in, const FacesParams& p, Context& ctx) { return make_skin(in, p, true, ctx); }

}  // namespace sg
