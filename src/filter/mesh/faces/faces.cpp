// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/faces/faces.h"

#include <optional>

#include "base/parallel.h"
#include "data/field_ops.h"
#include "filter/mesh/faces/faces_impl.h"
#include "filter/mesh/select/extract.h"

namespace sg {

namespace {

// Fields that no blend of values makes sense for take the value of the node with the largest weight.
bool is_picked(const Field& f) {
  return !is_float(f.array.type()) || f.role == Role::labels || f.role == Role::global_ids || f.role == Role::colors;
}

// Points and their fields where some are blends of points of the mesh: new ones, Bezier nodes. New ones become -1 in `kept`.
void blend_points(const Dataset& in, const UnstructuredMesh& mesh, const detail::CurvedSkin& curved, std::vector<int64_t>& kept,
                  DatasetParts& out, SurfaceMesh& surface) {
  const size_t old = size_t(std::lower_bound(kept.begin(), kept.end(), int64_t(mesh.points.count())) - kept.begin());
  if (old == kept.size() && !curved.moves_nodes()) {
    surface.points = points_of(in.mesh(), kept);
    return carry_gathered(out.fields, in.fields(), Association::point, kept, Association::point);
  }
  struct Target {
    const Array* from;
    bool picked;
    std::byte* to = nullptr;
    Array made() { return Array::make_raw(from->type(), count, from->components(), &to); }
    size_t count;
  };
  std::vector<Target> targets{{&mesh.points.xyz, false, nullptr, kept.size()}};
  surface.points = {targets[0].made(), mesh.points.origin};
  for (const Field& f : in.fields()) {
    if (f.association != Association::point) continue;
    Field g = f;
    targets.push_back({&f.array, is_picked(f), nullptr, kept.size()});
    g.array = targets.back().made();
    out.fields.add(std::move(g));
  }
  parallel_for(kept.size(), 1024, [&](size_t begin, size_t end) {
    std::vector<int64_t> ids;
    std::vector<double> weights;
    std::vector<size_t> first{0}, nearest;
    for (size_t p = begin; p < end; ++p) {
      curved.blend(kept[p], ids, weights);
      nearest.push_back(size_t(ids[size_t(std::max_element(weights.begin() + ptrdiff_t(first.back()), weights.end()) - weights.begin())]));
      first.push_back(ids.size());
    }
    for (const Target& t : targets)
      dispatch(*t.from, [&](auto v) {
        using T = std::remove_cvref_t<decltype(v[0])>;
        T* to = reinterpret_cast<T*>(t.to) + begin * size_t(v.components);
        for (size_t p = 0; p < end - begin; ++p)
          for (int c = 0; c < v.components; ++c, ++to) {
            double sum = 0;
            if (t.picked || first[p + 1] - first[p] == 1) {
              *to = v(nearest[p], c);
              continue;
            }
            for (size_t k = first[p]; k < first[p + 1]; ++k) sum += weights[k] * double(v(size_t(ids[k]), c));
            *to = T(sum);
          }
      });
  });
  std::fill(kept.begin() + ptrdiff_t(old), kept.end(), -1);
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
