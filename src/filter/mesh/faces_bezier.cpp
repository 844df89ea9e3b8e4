// SPDX-License-Identifier: Apache-2.0
// A Bezier cell passes through its corners only; its other nodes are control points. Drawing needs the surface, so each node of
// a face or curve is replaced by the value of the Bernstein polynomial at the node's place in parameter space. On an edge only
// the edge's own nodes have weight, so neighbours agree.
#include <map>

#include "data/cell_shape.h"
#include "data/cell_topology.h"
#include "filter/mesh/faces_impl.h"

namespace sg::detail {

namespace {

struct Blend {
  std::vector<int64_t> ids;
  std::vector<double> weights;
};
using Blends = std::map<int64_t, Blend>;

// Adds the blends of the nodes of one curve, triangle or quad that are kept and not yet known.
void add_blends(CellType type, std::array<int, 3> orders, std::span<const int64_t> nodes, std::span<const int64_t> kept, Blends& out) {
  const CellShape* shape = CellShape::find(type, nodes.size(), orders);
  if (!shape || !is_bezier(type)) return;
  const size_t corners = size_t(cell_type_info(type).corners);
  std::vector<double> n(nodes.size());
  for (size_t local = corners; local < nodes.size(); ++local) {
    const int64_t id = nodes[local];
    if (out.count(id) || !std::binary_search(kept.begin(), kept.end(), id)) continue;
    Blend& blend = out[id];
    shape->values(shape->node(local), n.data());
    for (size_t k = 0; k < n.size(); ++k)
      if (n[k] != 0) blend.ids.push_back(nodes[k]), blend.weights.push_back(n[k]);
  }
}

}  // namespace

NodeBlend bezier_blend(const Dataset& in, const UnstructuredMesh& mesh, std::span<const int64_t> kept) {
  NodeBlend r;
  const size_t cells = mesh.cells.size();
  const CellsView view = cells_view(mesh.cells);
  CellFaceReader reader(mesh);
  Blends blends;
  std::vector<int64_t> ids;
  for (size_t c = 0; c < cells; ++c) {
    const CellType type = mesh.type(c);
    if (!is_bezier(type)) continue;
    if (cell_type_info(type).dimension == 3) {
      const size_t n = reader.open(c);
      for (size_t f = 0; f < n; ++f) add_blends(reader.face_type(f), reader.face_orders(f), reader.nodes(f), kept, blends);
      continue;
    }
    ids.clear();
    for (size_t i = view.begin(c); i < view.end(c); ++i) ids.push_back(view.connectivity[i]);
    add_blends(type, cell_orders(mesh, c), ids, kept, blends);
  }
  if (blends.empty()) return r;
  const Field* rational = in.fields().find("RationalWeights", Association::point);
  for (auto& [id, b] : blends) {
    r.width = std::max(r.width, b.ids.size());
    const bool listed = !mesh.weights.empty();
    if (!listed && (!rational || rational->components() != 1)) continue;
    double sum = 0;
    for (size_t i = 0; i < b.ids.size(); ++i) sum += b.weights[i] *= (listed ? mesh.weights : rational->array).get(size_t(b.ids[i]));
    for (double& w : b.weights) w /= sum;
  }
  r.ids.resize(kept.size() * r.width);
  r.weights.resize(kept.size() * r.width);
  for (size_t p = 0; p < kept.size(); ++p) {
    const auto it = blends.find(kept[p]);
    for (size_t k = 0; k < r.width; ++k) {
      const bool used = it != blends.end() && k < it->second.ids.size();
      r.ids[p * r.width + k] = used ? it->second.ids[k] : kept[p];
      r.weights[p * r.width + k] = used ? it->second.weights[k] : it == blends.end() && k == 0 ? 1.0 : 0.0;
    }
  }
  return r;
}

}  // namespace sg::detail
