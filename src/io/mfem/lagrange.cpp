// SPDX-License-Identifier: Apache-2.0
// A mesh and its grid functions as Lagrange cells. All spaces are sampled at the equidistant nodes of the highest order among them,
// element by element; nodes of neighbours that lie on the same vertex, edge or face become one point where position and all values
// agree. So periodic meshes open where they must, and discontinuous fields keep their jumps.
#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cells/shape/cell_shape.h"
#include "io/mfem/mesh_file.h"
#include "io/mfem/vector_numbering.h"

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

/// A vector-valued space sampled. The reference field û becomes one of space by Piola's transformations, with J the columns of
/// derivatives of the positions: u = J û / det J for RT, u = J^-T û for ND.
class VectorSampler {
 public:
  VectorSampler(const Topology& t, const GridFunction& f, int q, const std::string& where)
      : t_(t), f_(f), rt_(f.space.collection.family == Family::rt), numbering_(t, f.space.collection, where) {
    for (const Geometry g : t.geometry)
      if (Kind& kind = kinds_[size_t(g)]; kind.matrix.nodes == 0) {
        kind.matrix = vector_matrix(g, f.space.collection, q, where);
        const size_t n = kind.matrix.nodes;
        const CellShape* shape = CellShape::find(lagrange_type(info(g).shape, q), n);
        kind.derivatives.resize(n * n);
        for (size_t k = 0; k < n; ++k) shape->derivatives(shape->node(k), kind.derivatives.data() + k * n);
      }
  }

  /// Fills nodes x space_dimension numbers at stride `width`, from the positions at the same stride.
  void sample(size_t e, const double* positions, double* out, size_t width, size_t space_dimension) {
    const Kind& kind = kinds_[size_t(t_.geometry[e])];
    const size_t n = kind.matrix.nodes, dofs = kind.matrix.dofs;
    const VectorNumbering::Shares& shares = numbering_.element(e);
    coefficients_.assign(dofs, 0);
    for (size_t d = 0; d < dofs; ++d)
      for (uint32_t i = shares.begin[d]; i < shares.begin[d + 1]; ++i)
        coefficients_[d] += shares.shares[i].factor * f_.get(shares.shares[i].dof, 0);
    for (size_t k = 0; k < n; ++k) {
      Vec3 reference, column[3];
      for (size_t a = 0; a < 3; ++a)
        for (size_t d = 0; d < dofs; ++d) reference[int(a)] += kind.matrix.m[(3 * k + a) * dofs + d] * coefficients_[d];
      for (size_t j = 0; j < n; ++j) {
        Vec3 x;
        for (size_t a = 0; a < space_dimension; ++a) x[int(a)] = positions[j * width + a];
        for (int a = 0; a < 3; ++a) column[a] += x * kind.derivatives[k * n + j][a];
      }
      const Vec3 u = mapped(reference, column, space_dimension);
      for (size_t a = 0; a < space_dimension; ++a) out[k * width + a] = u[int(a)];
    }
  }

 private:
  struct Kind {
    NodeMatrix matrix;
    std::vector<Vec3> derivatives;  // of the cell's functions at its nodes: nodes x nodes
  };

  Vec3 mapped(Vec3 v, Vec3 (&j)[3], size_t space_dimension) const {
    if (t_.dimension == 2) j[2] = cross(j[0], j[1]);  // across the surface, where v is zero
    const Vec3 a = cross(j[1], j[2]), b = cross(j[2], j[0]), c = cross(j[0], j[1]);
    if (!rt_) return (a * v.x + b * v.y + c * v.z) / dot(j[0], a);
    const double area = t_.dimension == 2 && space_dimension == 2 ? j[2].z : length(j[2]);  // det J has a sign in the plane
    return (j[0] * v.x + j[1] * v.y + j[2] * v.z) / (t_.dimension == 2 ? area : dot(j[0], a));
  }

  const Topology& t_;
  const GridFunction& f_;
  bool rt_;
  VectorNumbering numbering_;
  Kind kinds_[geometry_count];
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

size_t components_of(const GridFunction& f, int space_dimension) {
  return size_t(is_vector_valued(f.space.collection) ? space_dimension : f.space.vdim);
}

bool constant_on_elements(const GridFunction& f) { return f.space.collection.family == Family::l2 && f.space.collection.order == 0; }

// A vector of the plane gets a third component, so that it is one of space.
size_t stored_components(size_t components, int space_dimension) { return components == 2 && space_dimension == 2 ? 3 : components; }

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
  const size_t vdim = components_of(f, space_dimension), stored = stored_components(vdim, space_dimension);
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
    q = std::max(q, is_vector_valued(f.space.collection) ? vector_degree(f.space.collection) : f.space.collection.order);
  }
  size_t width = 0;
  std::vector<size_t> at;
  std::vector<double> tolerance;
  const auto space_dimension = size_t(positions.space.vdim);
  std::vector<std::variant<Sampler, VectorSampler>> samplers;
  for (const GridFunction* f : sampled) {
    at.push_back(width);
    width += components_of(*f, mesh.space_dimension);
    const bool is_vector = is_vector_valued(f->space.collection);
    tolerance.resize(width, is_vector ? 0 : 1e-9 * largest(*f));
    if (is_vector) samplers.emplace_back(std::in_place_type<VectorSampler>, t, *f, q, where);
    else samplers.emplace_back(std::in_place_type<Sampler>, t, *f, q, where);
  }
  std::vector<uint32_t> to_local[geometry_count];
  for (Geometry g : t.geometry)
    if (to_local[size_t(g)].empty()) to_local[size_t(g)] = places_in_local_nodes(g, q);

  std::vector<double> values;  // of the nodes of one element
  const auto sample = [&](size_t e) {
    if (e % 4096 == 0) context.check();
    values.resize(to_local[size_t(t.geometry[e])].size() * width);
    for (size_t s = 0; s < sampled.size(); ++s)
      if (auto* scalar = std::get_if<Sampler>(&samplers[s])) scalar->sample(e, values.data() + at[s], width);
      else std::get<VectorSampler>(samplers[s]).sample(e, values.data(), values.data() + at[s], width, space_dimension);
  };
  // How large a vector-valued field is its degrees of freedom do not tell, as they grow with the elements.
  const auto is_vector = [](const auto& s) { return std::holds_alternative<VectorSampler>(s); };
  for (size_t e = 0; e < t.size() && std::any_of(samplers.begin(), samplers.end(), is_vector); ++e) {
    sample(e);
    for (size_t s = 0; s < sampled.size(); ++s)
      for (size_t i = at[s]; is_vector(samplers[s]) && i < values.size(); i += width)
        for (size_t c = 0; c < space_dimension; ++c)
          if (const double v = 1e-9 * std::fabs(values[i + c]); v > tolerance[at[s]] && v < 1e300)
            std::fill_n(tolerance.begin() + ptrdiff_t(at[s]), space_dimension, v);
  }

  Numbering slots(t, q, where);
  PointMerger merger(slots.size(), width, tolerance);
  MixedCells cells;
  std::vector<int64_t> ids;
  for (size_t e = 0; e < t.size(); ++e) {
    sample(e);
    const auto& map = to_local[size_t(t.geometry[e])];
    const auto slot = slots.element(e);
    ids.clear();
    for (size_t k = 0; k < map.size(); ++k) ids.push_back(merger.find_or_add(size_t(slot[map[k]]), values.data() + k * width));
    cells.add(lagrange_type(info(t.geometry[e]).shape, q), ids);
  }

  const std::vector<int64_t> number = merger.order();
  std::vector<int64_t> source(number.size());
  for (size_t p = 0; p < number.size(); ++p) source[size_t(number[p])] = int64_t(p);
  DatasetParts parts;
  parts.mesh = mesh_of(cells, merger, number, source, space_dimension);
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
