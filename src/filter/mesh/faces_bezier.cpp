// SPDX-License-Identifier: Apache-2.0
// A Bezier cell passes through its corners only; its other nodes are control points. Drawing needs the surface, so each node of
// a face or curve is replaced by the value of the Bernstein polynomial at the node's place in parameter space. On an edge only
// the edge's own nodes have weight, so neighbours agree.
#include <map>

#include "data/cell_topology.h"
#include "filter/mesh/faces_impl.h"

namespace sg::detail {

namespace {

double binomial(int n, int k) {
  double r = 1;
  for (int i = 1; i <= k; ++i) r = r * double(n - k + i) / double(i);
  return r;
}
double power(double x, int n) {
  double r = 1;
  while (n-- > 0) r *= x;
  return r;
}
double bernstein(int n, int k, double t) { return binomial(n, k) * power(t, k) * power(1 - t, n - k); }

struct Blend {
  std::vector<int64_t> ids;
  std::vector<double> weights;
};
using Blends = std::map<int64_t, Blend>;

// Adds the blends of the nodes of one curve, triangle or quad that are kept and not yet known.
void add_blends(CellType type, std::span<const int64_t> nodes, std::span<const int64_t> kept, Blends& out) {
  const CellType shape = linear_type(type);
  const int n = high_order_of(type, nodes.size());
  if (n < 2) return;
  std::vector<std::pair<int, int>> places;
  for (int v = 0; v <= (shape == CellType::line ? 0 : n); ++v)
    for (int u = 0; u <= (shape == CellType::triangle ? n - v : n); ++u) places.emplace_back(u, v);
  const size_t corners = shape == CellType::line ? 2 : shape == CellType::triangle ? 3 : 4;
  for (auto [u, v] : places) {
    const uint32_t local = lattice_node(type, n, u, v);
    const int64_t id = nodes[local];
    if (local < corners || out.count(id) || !std::binary_search(kept.begin(), kept.end(), id)) continue;
    Blend& blend = out[id];
    const double s = double(u) / n, t = double(v) / n, w = double(n - u - v) / n;
    for (auto [a, b] : places) {
      double weight = 0;
      if (shape == CellType::line) weight = bernstein(n, a, s);
      else if (shape == CellType::quad) weight = bernstein(n, a, s) * bernstein(n, b, t);
      else weight = binomial(n, a) * binomial(n - a, b) * power(s, a) * power(t, b) * power(w, n - a - b);
      if (weight == 0) continue;
      blend.ids.push_back(nodes[lattice_node(type, n, a, b)]);
      blend.weights.push_back(weight);
    }
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
      for (size_t f = 0; f < n; ++f) add_blends(reader.face_type(f), reader.nodes(f), kept, blends);
      continue;
    }
    ids.clear();
    for (size_t i = view.begin(c); i < view.end(c); ++i) ids.push_back(view.connectivity[i]);
    add_blends(type, ids, kept, blends);
  }
  if (blends.empty()) return r;
  // The mesh's own weights come first; files of VTK carry them as a point field.
  Array rational = mesh.weights;
  if (rational.empty())
    if (const Field* f = in.fields().find("RationalWeights", Association::point); f && f->components() == 1) rational = f->array;
  if (rational.count() != mesh.points.count()) rational = {};
  for (auto& [id, b] : blends) {
    r.width = std::max(r.width, b.ids.size());
    if (rational.empty()) continue;
    double sum = 0;
    for (size_t i = 0; i < b.ids.size(); ++i) sum += b.weights[i] *= rational.get(size_t(b.ids[i]));
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
