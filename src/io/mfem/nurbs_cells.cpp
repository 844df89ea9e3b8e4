// SPDX-License-Identifier: Apache-2.0
// NURBS patches as rational Bezier cells, one per box of knot spans. The control points of a span are values of the blossom (polar
// form) of the spline [Ramshaw 1987]: point j of the span [a, b] is f(a, ..., a, b, ..., b) with j times b. All cells get the highest
// order of the mesh: raising the degree of a Bezier curve changes nothing about it.
#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "base/bytes.h"
#include "base/error.h"
#include "io/mfem/element.h"
#include "io/mfem/mesh_file.h"

namespace sg::mfem {

namespace {

/// Edges by their two vertices, the smaller one first.
std::map<std::pair<int64_t, int64_t>, size_t> known_edges(const NurbsMesh& n) {
  std::map<std::pair<int64_t, int64_t>, size_t> r;
  for (size_t e = 0; e < n.edge_vertices.size(); ++e) {
    const auto [a, b] = n.edge_vertices[e];
    r.try_emplace({std::min(a, b), std::max(a, b)}, e);
  }
  return r;
}

/// Global numbers of a lattice of points on every patch, shared along vertices, edges and faces. `points` is their number along each
/// knot vector.
class PatchNumbering {
 public:
  PatchNumbering(const MeshFile& mesh, const std::vector<size_t>& points, const std::string& where)
      : t_(mesh.topology), n_(*mesh.nurbs), points_(points), where_(where) {
    uint64_t next = uint64_t(t_.vertices);
    for (size_t e = 0; e < n_.edge_knots.size(); ++e)
      if (n_.edge_knots[e] < 0 || size_t(n_.edge_knots[e]) >= points_.size())
        fail_data(fmt::format("edge {} has knot vector {}, but there are {}", e, n_.edge_knots[e], points_.size()), where_);
    if (t_.dimension > 1)
      for (size_t e = 0; e < n_.edge_knots.size(); ++e) edge_first_.push_back(int64_t(next)), advance(next, along(e) - 2, 1, 1);
    face_first_.assign(t_.faces, -1);
    face_size_.resize(t_.faces);
    patch_edges_.resize(t_.size());
    for (size_t e = 0; e < t_.size(); ++e) find_edges(e);
    for (size_t e = 0; e < t_.size(); ++e)
      for (size_t f = t_.face_begin[e]; f < t_.face_begin[e + 1]; ++f) {
        const auto id = size_t(t_.face[f]);
        if (face_first_[id] >= 0) continue;
        const auto& v = info(t_.geometry[e]).faces[f - t_.face_begin[e]];
        face_first_[id] = int64_t(next);
        face_size_[id] = {sizes(e)[size_t(axis(e, v[0], v[1]))] - 2, sizes(e)[size_t(axis(e, v[0], v[3]))] - 2};
        advance(next, face_size_[id][0], face_size_[id][1], 1);
      }
    for (size_t e = 0; e < t_.size(); ++e) {
      const auto s = sizes(e);
      inside_first_.push_back(int64_t(next));
      advance(next, s[0] - 2, t_.dimension > 1 ? s[1] - 2 : 1, t_.dimension > 2 ? s[2] - 2 : 1);
    }
    size_ = size_t(next);
  }

  size_t size() const { return size_; }
  /// Points along the axes of a patch (1 where it has none).
  std::array<size_t, 3> sizes(size_t e) const {
    std::array<size_t, 3> s{1, 1, 1};
    for (int a = 0; a < t_.dimension; ++a) s[size_t(a)] = along(axis_edge(e, a));
    return s;
  }
  /// The edge of a patch from its first corner along an axis, and whether the edge's knots run the other way.
  size_t axis_edge(size_t e, int a) const { return patch_edges_[e][axis_local_edge(a)]; }
  bool reversed(size_t e, int a) const {
    const int from = info(t_.geometry[e]).edges[axis_local_edge(a)][0];
    return n_.edge_vertices[axis_edge(e, a)][0] != t_.element(e)[size_t(from)];
  }
  void ids(size_t e, std::vector<int64_t>& out) const;

 private:
  size_t along(size_t edge) const { return points_[size_t(n_.edge_knots[edge])]; }
  void advance(uint64_t& next, uint64_t a, uint64_t b, uint64_t c) const {
    uint64_t n = 0;
    if (!multiply(a, b, n) || !multiply(n, c, n) || !add(next, n, next) || next > (uint64_t(1) << 40))
      fail_data("the knot vectors need more than 2^40 control points", where_);
  }
  /// Edges 0-1, 0-3 and 0-4 of squares and cubes.
  static size_t axis_local_edge(int a) { return a == 0 ? 0 : a == 1 ? 3 : 8; }
  int axis(size_t e, int from, int to) const {
    const auto& place = info(t_.geometry[e]).corner_place;
    for (int a = 0; a < 3; ++a)
      if (place[size_t(from)][size_t(a)] != place[size_t(to)][size_t(a)]) return a;
    return 0;
  }
  void find_edges(size_t e) {
    for (const auto& [a, b] : info(t_.geometry[e]).edges) {
      const int64_t p = t_.element(e)[size_t(a)], q = t_.element(e)[size_t(b)];
      const auto it = edge_of_.find({std::min(p, q), std::max(p, q)});
      if (it == edge_of_.end()) fail_data(fmt::format("patch {} has an edge {} {} that is not in the list of edges", e, p, q), where_);
      patch_edges_[e].push_back(it->second);
    }
    for (size_t k = 0; k < patch_edges_[e].size(); ++k) {
      const auto [a, b] = info(t_.geometry[e]).edges[k];
      if (along(patch_edges_[e][k]) != along(axis_edge(e, axis(e, a, b))))
        fail_data(fmt::format("opposite edges of patch {} have different numbers of control points", e), where_);
    }
  }

  const Topology& t_;
  const NurbsMesh& n_;
  std::vector<size_t> points_;
  std::string where_;
  std::map<std::pair<int64_t, int64_t>, size_t> edge_of_ = known_edges(n_);
  std::vector<std::vector<size_t>> patch_edges_;
  std::vector<int64_t> edge_first_, face_first_, inside_first_;
  std::vector<std::array<size_t, 2>> face_size_;
  size_t size_ = 0;
};

void PatchNumbering::ids(size_t e, std::vector<int64_t>& out) const {
  const GeometryInfo& g = info(t_.geometry[e]);
  const auto v = t_.element(e);
  const auto s = sizes(e);
  out.assign(s[0] * s[1] * s[2], -1);
  using Place = std::array<int64_t, 3>;
  auto slot = [&](const Place& p) -> int64_t& { return out[size_t(p[0]) + s[0] * (size_t(p[1]) + s[1] * size_t(p[2]))]; };
  auto corner = [&](int c) {
    Place p;
    for (size_t a = 0; a < 3; ++a) p[a] = g.corner_place[size_t(c)][a] * int64_t(s[a] - 1);
    return p;
  };
  auto step = [&](int from, int to) {
    Place d;
    for (size_t a = 0; a < 3; ++a) d[a] = g.corner_place[size_t(to)][a] - g.corner_place[size_t(from)][a];
    return d;
  };
  auto moved = [](Place p, const Place& d, int64_t n) {
    for (size_t a = 0; a < 3; ++a) p[a] += d[a] * n;
    return p;
  };
  for (int c = 0; c < g.corners; ++c) slot(corner(c)) = v[size_t(c)];
  if (t_.dimension > 1)
    for (size_t k = 0; k < g.edges.size(); ++k) {
      const auto [a, b] = g.edges[k];
      const size_t id = patch_edges_[e][k];
      const auto n = int64_t(along(id)) - 2;
      for (int64_t i = 1; i <= n; ++i)  // numbered towards the larger vertex
        slot(moved(corner(a), step(a, b), i)) = edge_first_[id] + (v[size_t(a)] < v[size_t(b)] ? i - 1 : n - i);
    }
  for (size_t f = 0; f < g.faces.size(); ++f) {
    const auto id = size_t(t_.face[t_.face_begin[e] + f]);
    const auto& base = t_.face_corners[id];
    std::array<int64_t, 4> own{};
    for (size_t k = 0; k < 4; ++k) own[k] = v[size_t(g.faces[f][k])];
    const int c0 = corner_in(own, base[0]), c1 = corner_in(own, base[1]), c3 = corner_in(own, base[3]);
    if (c0 < 0 || c1 < 0 || c3 < 0 || (c0 + c1) % 2 == 0 || (c0 + c3) % 2 == 0)
      fail_data(fmt::format("face {} of patch {} does not match the face of its neighbour", f, e), where_);
    const int p0 = g.faces[f][size_t(c0)], p1 = g.faces[f][size_t(c1)], p3 = g.faces[f][size_t(c3)];
    const std::array<size_t, 2> n{s[size_t(axis(e, p0, p1))] - 2, s[size_t(axis(e, p0, p3))] - 2};
    if (n != face_size_[id]) fail_data(fmt::format("face {} of patch {} has different control points from its neighbour's", f, e), where_);
    for (int64_t j = 1; j <= int64_t(n[1]); ++j)
      for (int64_t i = 1; i <= int64_t(n[0]); ++i)
        slot(moved(moved(corner(p0), step(p0, p1), i), step(p0, p3), j)) = face_first_[id] + (j - 1) * int64_t(n[0]) + i - 1;
  }
  int64_t next = inside_first_[e];
  for (int64_t& id : out)
    if (id < 0) id = next++;
}

/// Values of a spline's control points -> those of its Bezier pieces of order `order`, as weights of the order + 1 points before.
struct Extraction {
  size_t spans = 0;
  struct Row {
    size_t first = 0;  ///< control point of the first weight
    std::array<double, 11> weight{};
  };
  std::vector<Row> rows;  ///< spans * order + 1
  int from = 1;           ///< order of the spline: from + 1 weights count
};

Extraction extract(const KnotVector& k, int order) {
  Extraction r;
  const int p = r.from = k.order;
  const auto& u = k.knots;
  for (size_t i = size_t(p); i + size_t(p) + 1 < u.size(); ++i) {
    if (!(u[i] < u[i + 1])) continue;
    std::array<std::array<double, 11>, 11> bezier{};  // of point j: weights of control points i-p .. i
    for (int j = 0; j <= p; ++j) {
      std::array<std::array<double, 11>, 11> d{};
      for (size_t c = 0; c <= size_t(p); ++c) d[c][c] = 1;
      for (int s = 1; s <= p; ++s) {
        const double at = s <= p - j ? u[i] : u[i + 1];
        for (int c = p; c >= s; --c) {
          const size_t m = i - size_t(p) + size_t(c);
          const double lo = u[m], hi = u[m + size_t(p - s + 1)], a = (at - lo) / (hi - lo);
          for (size_t w = 0; w <= size_t(p); ++w) d[size_t(c)][w] = (1 - a) * d[size_t(c) - 1][w] + a * d[size_t(c)][w];
        }
      }
      bezier[size_t(j)] = d[size_t(p)];
    }
    for (int j = r.spans == 0 ? 0 : 1; j <= order; ++j) {
      Extraction::Row row;
      row.first = i - size_t(p);
      for (int l = std::max(0, j - (order - p)); l <= std::min(p, j); ++l) {
        const double f = binomial(p, l) * binomial(order - p, j - l) / binomial(order, j);
        for (size_t w = 0; w <= size_t(p); ++w) row.weight[w] += f * bezier[size_t(l)][w];
      }
      r.rows.push_back(row);
    }
    ++r.spans;
  }
  return r;
}

/// The lattice of one patch with all its numbers, taken to Bezier form along one axis.
std::vector<double> apply(const Extraction& x, const std::vector<double>& in, std::array<size_t, 3>& size, size_t axis, size_t width) {
  std::array<size_t, 3> to = size;
  to[axis] = x.rows.size();
  std::vector<double> out(to[0] * to[1] * to[2] * width, 0.0);
  for (size_t k = 0; k < to[2]; ++k)
    for (size_t j = 0; j < to[1]; ++j)
      for (size_t i = 0; i < to[0]; ++i) {
        std::array<size_t, 3> at{i, j, k};
        const Extraction::Row& row = x.rows[at[axis]];
        double* o = out.data() + (i + to[0] * (j + to[1] * k)) * width;
        for (size_t w = 0; w <= size_t(x.from); ++w) {
          at[axis] = row.first + w;
          const double* from = in.data() + (at[0] + size[0] * (at[1] + size[1] * at[2])) * width;
          for (size_t c = 0; c < width; ++c) o[c] += row.weight[w] * from[c];
        }
      }
  size = to;
  return out;
}

/// Knot vectors by number; those of meshes with patches are collected from them.
std::vector<KnotVector> knot_vectors(const MeshFile& mesh, const std::string& where) {
  const NurbsMesh& n = *mesh.nurbs;
  if (n.patches.empty()) return n.knots;
  std::vector<KnotVector> r;
  const Topology& t = mesh.topology;
  const auto edge_of = known_edges(n);
  for (size_t e = 0; e < t.size(); ++e) {
    const GeometryInfo& g = info(t.geometry[e]);
    for (const auto& [a, b] : g.edges) {
      const int64_t p = t.element(e)[size_t(a)], q = t.element(e)[size_t(b)];
      const auto it = edge_of.find({std::min(p, q), std::max(p, q)});
      if (it == edge_of.end()) continue;  // PatchNumbering refuses it
      const auto id = size_t(n.edge_knots[it->second]);
      if (id >= n.edge_knots.size())
        fail_data(fmt::format("edge {} has knot vector {}, but there are {} edges", it->second, id, n.edge_knots.size()), where);
      if (r.size() <= id) r.resize(id + 1, KnotVector{0, {}});
      size_t axis = 0;
      while (g.corner_place[size_t(a)][axis] == g.corner_place[size_t(b)][axis]) ++axis;
      if (r[id].knots.empty()) r[id] = n.patches[e].knots[axis];
    }
  }
  for (KnotVector& k : r)
    if (k.knots.empty()) k = {1, {0, 0, 1, 1}};  // of no edge
  return r;
}

KnotVector turned(KnotVector k) {
  const double sum = k.knots.front() + k.knots.back();
  std::reverse(k.knots.begin(), k.knots.end());
  for (double& u : k.knots) u = sum - u;
  return k;
}

std::vector<size_t> control_points(const std::vector<KnotVector>& knots) {
  std::vector<size_t> n;
  for (const KnotVector& k : knots) n.push_back(k.control_points());
  return n;
}

// All Bezier points of a mesh in homogeneous form, and the cells on them.
struct BezierNet {
  size_t width = 4;         ///< x y z w and the fields, all but w times w
  std::vector<double> all;  ///< width numbers per point; NaN = a point of no patch
  MixedCells cells;
  std::vector<int32_t> attribute;
};

// Control points of one patch, times their weights.
std::vector<double> patch_points(const MeshFile& mesh, const std::vector<GridFunction>& fields, size_t e, const std::vector<int64_t>& ids,
                                 size_t width, const std::string& where) {
  const NurbsMesh& n = *mesh.nurbs;
  const auto d = size_t(mesh.space_dimension);
  std::vector<double> h(ids.size() * width, 0.0);
  for (size_t i = 0; i < ids.size(); ++i) {
    double* o = h.data() + i * width;
    const auto id = size_t(ids[i]);
    const double* listed = n.patches.empty() ? nullptr : n.patches[e].points.data() + i * (d + 1);
    const double w = listed ? listed[d] : n.weights[id];
    if (!(w > 0)) fail_data(fmt::format("control point {} has the weight {}", id, w), where, "weights must be positive");
    for (size_t a = 0; a < d; ++a) o[a] = w * (listed ? listed[a] : mesh.nodes->get(id, int(a)));
    o[3] = w;
    size_t c = 4;
    for (const GridFunction& f : fields)
      for (int k = 0; k < f.space.vdim; ++k) o[c++] = w * f.get(id, k);
  }
  return h;
}

void add_cells(const MeshFile& mesh, size_t e, int order, const std::vector<int64_t>& ids, std::array<size_t, 3> size,
               std::array<size_t, 3> spans, BezierNet& net) {
  const CellType shape = info(mesh.topology.geometry[e]).shape;
  const auto places = lattice_places(shape, order);
  const auto q = size_t(order);
  std::vector<int64_t> point;
  for (size_t k = 0; k < spans[2]; ++k)
    for (size_t j = 0; j < spans[1]; ++j)
      for (size_t i = 0; i < spans[0]; ++i) {
        point.clear();
        for (const auto& p : places)
          point.push_back(ids[i * q + size_t(p[0]) + size[0] * (j * q + size_t(p[1]) + size[1] * (k * q + size_t(p[2])))]);
        net.cells.add(bezier_type(shape), point);
        net.attribute.push_back(mesh.topology.attribute[e]);
      }
}

DatasetPtr finish(const MeshFile& mesh, const std::vector<GridFunction>& fields, int order, BezierNet net) {
  DatasetParts parts;
  UnstructuredMesh m;
  const size_t width = net.width;
  // Numbers of vertices that no patch has are left out.
  std::vector<int64_t> number(net.all.size() / width, -1);
  int64_t points = 0;
  for (size_t p = 0; p < number.size(); ++p)
    if (!std::isnan(net.all[p * width + 3])) number[p] = points++;
  net.cells.finish(m, &number);
  double *xyz = nullptr, *weight = nullptr;
  m.points.xyz = Array::make<double>(size_t(points), 3, &xyz);
  Array weights = Array::make<double>(size_t(points), 1, &weight);
  bool rational = false;
  for (size_t p = 0; p < number.size(); ++p) {
    if (number[p] < 0) continue;
    const double* h = net.all.data() + p * width;
    for (size_t a = 0; a < 3; ++a) xyz[size_t(number[p]) * 3 + a] = h[a] / h[3];
    weight[number[p]] = h[3];
    rational = rational || std::fabs(h[3] - 1) > 1e-14;
  }
  if (rational) m.weights = weights;
  if (!rational && order == 1) m.single_type = info(mesh.topology.geometry[0]).shape;
  parts.mesh = std::move(m);
  size_t at = 4;
  for (const GridFunction& f : fields) {
    const size_t vdim = size_t(f.space.vdim), stored = vdim == 2 && mesh.space_dimension == 2 ? 3 : vdim;
    double* out = nullptr;
    Array a = Array::make<double>(size_t(points), int(stored), &out);
    for (size_t p = 0; p < number.size(); ++p)
      for (size_t c = 0; c < stored && number[p] >= 0; ++c)
        out[size_t(number[p]) * stored + c] = c < vdim ? net.all[p * width + at + c] / net.all[p * width + 3] : 0;
    Field field;
    field.name = f.name;
    field.array = std::move(a);
    if (stored == 3) field.role = Role::vectors;
    parts.fields.add(std::move(field));
    at += vdim;
  }
  parts.fields.add(cell_ids("attribute", std::move(net.attribute)));
  return make_dataset(std::move(parts));
}

}  // namespace

size_t nurbs_size(const MeshFile& mesh, const std::string& where) {
  return PatchNumbering(mesh, control_points(mesh.nurbs->knots), where).size();
}

DatasetPtr nurbs_dataset(const MeshFile& mesh, const std::vector<GridFunction>& fields, const std::string& where) {
  const Topology& t = mesh.topology;
  const NurbsMesh& n = *mesh.nurbs;
  const bool listed = !n.patches.empty();
  const std::vector<KnotVector> knots = knot_vectors(mesh, where);
  int order = 1;
  for (const KnotVector& k : knots) order = std::max(order, k.order);
  std::vector<size_t> along;
  for (const KnotVector& k : knots) along.push_back(extract(k, order).rows.size());
  if (listed && !fields.empty()) fail_data("fields on a NURBS mesh that lists its patches are not supported", where);
  const PatchNumbering from(mesh, control_points(knots), where), to(mesh, along, where);
  if (to.size() > 100 * from.size() + 1000000)
    fail_data(fmt::format("{} control points become {} at order {}", from.size(), to.size(), order), where,
              "use orders that differ less, or fewer knot spans");
  BezierNet net;
  for (const GridFunction& f : fields) {
    if (f.space.collection.family != Family::nurbs)
      fail_data(fmt::format("a field of the space '{}' on a NURBS mesh is not supported", f.space.collection.name), where,
                "NURBS fields are supported");
    net.width += size_t(f.space.vdim);
  }
  net.all.assign(to.size() * net.width, std::nan(""));
  std::vector<int64_t> ids;
  for (size_t e = 0; e < t.size(); ++e) {
    std::array<size_t, 3> size = from.sizes(e), spans{1, 1, 1};
    if (listed && n.patches[e].points.size() != size[0] * size[1] * size[2] * size_t(mesh.space_dimension + 1))
      fail_data(fmt::format("patch {} has different knot vectors from its edges", e), where);
    from.ids(e, ids);
    std::vector<double> h = patch_points(mesh, fields, e, ids, net.width, where);
    for (int a = 0; a < t.dimension; ++a) {
      KnotVector k = listed ? n.patches[e].knots[size_t(a)] : knots[size_t(n.edge_knots[from.axis_edge(e, a)])];
      if (!listed && from.reversed(e, a)) k = turned(k);
      const Extraction x = extract(k, order);
      spans[size_t(a)] = x.spans;
      h = apply(x, h, size, size_t(a), net.width);
    }
    if (size != to.sizes(e)) fail_data(fmt::format("patch {} has different knot spans from its edges", e), where);
    to.ids(e, ids);
    for (size_t i = 0; i < ids.size(); ++i)
      if (std::isnan(net.all[size_t(ids[i]) * net.width + 3]))
        std::copy_n(h.begin() + ptrdiff_t(i * net.width), net.width, net.all.begin() + ptrdiff_t(size_t(ids[i]) * net.width));
    add_cells(mesh, e, order, ids, size, spans, net);
  }
  return finish(mesh, fields, order, std::move(net));
}

}  // namespace sg::mfem
