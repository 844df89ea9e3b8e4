// SPDX-License-Identifier: Apache-2.0
// A mesh and its grid functions as Lagrange cells. All spaces are sampled at the equidistant nodes of the highest order among them,
// element by element; nodes of neighbours that lie on the same vertex, edge or face become one point where position and all values
// agree. So periodic meshes open where they must, and discontinuous fields keep their jumps.
#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "io/mfem/mesh_file.h"

namespace sg::mfem {

namespace {

/// One space sampled: values of an element at the nodes of our cell.
class Sampler {
 public:
  Sampler(const Topology& t, const GridFunction& f, int q, const std::string& where) : t_(t), f_(f) {
    const FeCollection& c = f.space.collection;
    for (Geometry g : t.geometry)
      if (matrices_[size_t(g)].nodes == 0) matrices_[size_t(g)] = node_matrix(g, c, q, where);
    if (c.family == Family::h1) numbering_.emplace(t, c.order, where);
    else {
      first_.push_back(0);
      for (Geometry g : t.geometry) first_.push_back(first_.back() + element_dofs(g, c));
    }
  }

  /// Fills nodes x vdim numbers, components together, at stride `width`.
  void sample(size_t e, double* out, size_t width) {
    const NodeMatrix& m = matrices_[size_t(t_.geometry[e])];
    const auto vdim = size_t(f_.space.vdim);
    coefficients_.resize(m.dofs * vdim);
    std::span<const int64_t> ids;
    if (numbering_) ids = numbering_->element(e);
    for (size_t d = 0; d < m.dofs; ++d) {
      const size_t dof = numbering_ ? size_t(ids[d]) : first_[e] + d;
      for (size_t c = 0; c < vdim; ++c) coefficients_[d * vdim + c] = f_.get(dof, int(c));
    }
    for (size_t k = 0; k < m.nodes; ++k) {
      double* o = out + k * width;
      for (size_t c = 0; c < vdim; ++c) o[c] = 0;
      const double* row = m.m.data() + k * m.dofs;
      for (size_t d = 0; d < m.dofs; ++d)
        if (row[d] != 0)
          for (size_t c = 0; c < vdim; ++c) o[c] += row[d] * coefficients_[d * vdim + c];
    }
  }

 private:
  const Topology& t_;
  const GridFunction& f_;
  NodeMatrix matrices_[geometry_count];
  std::optional<Numbering> numbering_;
  std::vector<size_t> first_;
  std::vector<double> coefficients_;
};

/// Points that are found again by the number of their node and their values.
class PointMerger {
 public:
  PointMerger(size_t slots, size_t width, std::vector<double> tolerance)
      : head_(slots, -1), width_(width), tolerance_(std::move(tolerance)) {}

  int64_t find_or_add(size_t slot, const double* values) {
    int64_t last = -1;
    for (int64_t p = head_[slot]; p >= 0; last = p, p = next_[size_t(p)])
      if (same(values_.data() + size_t(p) * width_, values)) return p;
    const auto fresh = int64_t(next_.size());
    values_.insert(values_.end(), values, values + width_);
    next_.push_back(-1);
    (last < 0 ? head_[slot] : next_[size_t(last)]) = fresh;
    return fresh;
  }

  size_t size() const { return next_.size(); }
  /// Final number of each point: in the order of the node numbers, so that a mesh without jumps keeps its vertices' order.
  std::vector<int64_t> order() const {
    std::vector<int64_t> number(size());
    int64_t n = 0;
    for (int64_t h : head_)
      for (int64_t p = h; p >= 0; p = next_[size_t(p)]) number[size_t(p)] = n++;
    return number;
  }
  const double* values(size_t p) const { return values_.data() + p * width_; }

 private:
  bool same(const double* a, const double* b) const {
    for (size_t c = 0; c < width_; ++c)
      if (!(std::fabs(a[c] - b[c]) <= tolerance_[c]) && !(std::isnan(a[c]) && std::isnan(b[c]))) return false;
    return true;
  }
  std::vector<int64_t> head_, next_;
  std::vector<double> values_;
  size_t width_;
  std::vector<double> tolerance_;
};

/// The vertices' coordinates as a space of order 1.
GridFunction vertex_positions(const MeshFile& mesh) {
  GridFunction f;
  f.space.collection = parse_collection("Linear", "");
  f.space.vdim = mesh.space_dimension;
  f.space.by_vdim = true;
  f.values = mesh.coordinates;
  return f;
}

bool constant_on_elements(const GridFunction& f) { return f.space.collection.family == Family::l2 && f.space.collection.order == 0; }

// A vector of the plane gets a third component, so that it is one of space.
size_t stored_components(const GridFunction& f, int space_dimension) {
  return f.space.vdim == 2 && space_dimension == 2 ? 3 : size_t(f.space.vdim);
}

double largest(const GridFunction& f) {
  double m = 0;
  for (double v : f.values)
    if (std::fabs(v) > m && std::fabs(v) <= 1e300) m = std::fabs(v);
  return m;
}

Field make_field(const GridFunction& f, Association association, Array array) {
  Field r;
  r.name = f.name;
  r.association = association;
  r.array = std::move(array);
  if (r.array.components() == 3) r.role = Role::vectors;
  return r;
}

// Of each node of our cell of order q, its place in local_nodes().
std::vector<uint32_t> places_in_local_nodes(Geometry g, int q) {
  const int order = g == Geometry::pyramid ? 1 : q;  // a pyramid of higher order was refused before
  const auto nodes = local_nodes(g, order);
  std::vector<uint32_t> map;
  for (const auto& place : lattice_places(info(g).shape, order))
    map.push_back(uint32_t(std::find_if(nodes.begin(), nodes.end(), [&](const LocalNode& n) { return n.place == place; }) - nodes.begin()));
  return map;
}

// The first `dimension` values of each point are its position.
UnstructuredMesh mesh_of(MixedCells& cells, const PointMerger& merger, const std::vector<int64_t>& number,
                         const std::vector<int64_t>& source, size_t dimension) {
  UnstructuredMesh m;
  cells.finish(m, &number);
  double* xyz = nullptr;
  m.points.xyz = Array::make<double>(number.size(), 3, &xyz);
  for (size_t p = 0; p < number.size(); ++p)
    for (size_t a = 0; a < 3; ++a) xyz[3 * p + a] = a < dimension ? merger.values(size_t(source[p]))[a] : 0;
  return m;
}

// Numbers `from(i, component)` for i < n as a field; a vector of the plane is filled up with 0.
template <class From>
Field stored_field(const GridFunction& f, Association association, int space_dimension, size_t n, From from) {
  const size_t stored = stored_components(f, space_dimension), vdim = size_t(f.space.vdim);
  double* out = nullptr;
  Array a = Array::make<double>(n, int(stored), &out);
  for (size_t i = 0; i < n; ++i)
    for (size_t c = 0; c < stored; ++c) out[i * stored + c] = c < vdim ? from(i, c) : 0;
  return make_field(f, association, std::move(a));
}

}  // namespace

DatasetPtr lagrange_dataset(const MeshFile& mesh, const std::vector<GridFunction>& fields, const std::string& where, Context& context) {
  const Topology& t = mesh.topology;
  const GridFunction positions = mesh.nodes ? *mesh.nodes : vertex_positions(mesh);
  std::vector<const GridFunction*> sampled{&positions};
  int q = std::max(positions.space.collection.order, 1);
  for (const GridFunction& f : fields) {
    if (constant_on_elements(f)) continue;
    sampled.push_back(&f);
    q = std::max(q, f.space.collection.order);
  }
  size_t width = 0;
  std::vector<size_t> at;
  std::vector<double> tolerance;
  std::vector<Sampler> samplers;
  for (const GridFunction* f : sampled) {
    at.push_back(width);
    width += size_t(f->space.vdim);
    tolerance.resize(width, 1e-9 * largest(*f));
    samplers.emplace_back(t, *f, q, where);
  }
  std::vector<uint32_t> to_local[geometry_count];
  for (Geometry g : t.geometry)
    if (to_local[size_t(g)].empty()) to_local[size_t(g)] = places_in_local_nodes(g, q);

  Numbering slots(t, q, where);
  PointMerger merger(slots.size(), width, tolerance);
  MixedCells cells;
  std::vector<double> values;
  std::vector<int64_t> ids;
  for (size_t e = 0; e < t.size(); ++e) {
    if (e % 4096 == 0) context.check();
    const Geometry g = t.geometry[e];
    const auto& map = to_local[size_t(g)];
    values.resize(map.size() * width);
    for (size_t s = 0; s < sampled.size(); ++s) samplers[s].sample(e, values.data() + at[s], width);
    const auto slot = slots.element(e);
    ids.clear();
    for (size_t k = 0; k < map.size(); ++k) ids.push_back(merger.find_or_add(size_t(slot[map[k]]), values.data() + k * width));
    cells.add(lagrange_type(info(g).shape, q), ids);
  }

  const std::vector<int64_t> number = merger.order();
  std::vector<int64_t> source(number.size());
  for (size_t p = 0; p < number.size(); ++p) source[size_t(number[p])] = int64_t(p);
  DatasetParts parts;
  parts.mesh = mesh_of(cells, merger, number, source, size_t(positions.space.vdim));
  size_t s = 1;
  for (const GridFunction& f : fields) {
    if (constant_on_elements(f)) {
      parts.fields.add(
          stored_field(f, Association::cell, mesh.space_dimension, t.size(), [&](size_t e, size_t c) { return f.get(e, int(c)); }));
      continue;
    }
    const size_t first = at[s++];
    parts.fields.add(stored_field(f, Association::point, mesh.space_dimension, number.size(),
                                  [&](size_t p, size_t c) { return merger.values(size_t(source[p]))[first + c]; }));
  }
  parts.fields.add(cell_ids("attribute", t.attribute));
  return make_dataset(std::move(parts));
}

}  // namespace sg::mfem
