// SPDX-License-Identifier: Apache-2.0
#include "data/cells/shape/cell_shape.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <tuple>

#include "base/error.h"
#include "data/cells/cell_topology.h"
#include "data/cells/shape/cell_basis.h"

namespace sg {

namespace {

using Orders = std::array<int, 3>;

basis::Form form_of(CellType base) {
  switch (base) {
    case CellType::triangle:
    case CellType::tetra: return basis::Form::simplex;
    case CellType::wedge: return basis::Form::wedge;
    default: return basis::Form::box;
  }
}

// Orders of the types that are lattices; 0 for the others and for what does not fit.
Orders lattice_orders(CellType type, size_t nodes, Orders asked) {
  using enum CellType;
  switch (type) {
    case quadratic_edge:
    case quadratic_triangle:
    case quadratic_tetra:
    case biquadratic_quad:
    case triquadratic_hexahedron:
    case biquadratic_quadratic_wedge: asked = {2, 2, 2}; break;
    case cubic_line: asked = {3, 3, 3}; break;
    default:
      if (type < lagrange_curve) return {0, 0, 0};
      if (asked[0] == 0) asked.fill(high_order_of(type, nodes));
  }
  // Axes that a form does not have, or has twice.
  const CellType base = linear_type(type);
  const int axes = cell_type_info(base).dimension;
  for (size_t a = size_t(axes); a < 3; ++a) asked[a] = asked[0];
  if (base == triangle || base == tetra) asked.fill(asked[0]);
  if (base == wedge && asked[1] != asked[0]) return {0, 0, 0};
  for (int n : asked)
    if (n < 1 || n > basis::max_order) return {0, 0, 0};
  return lattice_nodes(type, asked) == nodes ? asked : Orders{0, 0, 0};
}

}  // namespace

/// All shapes requested so far.
class CellShapeTable {
 public:
  static const CellShape* find(CellType type, size_t nodes, Orders orders) {
    static CellShapeTable table;
    std::lock_guard lock(table.mutex_);
    const auto key = std::make_tuple(type, nodes, orders);
    auto it = table.known_.find(key);
    if (it == table.known_.end()) it = table.known_.emplace(key, make(type, nodes, orders)).first;
    return it->second.get();
  }

 private:
  static std::unique_ptr<const CellShape> make(CellType type, size_t nodes, Orders orders) {
    const CellTypeInfo* info = cell_type_info(uint8_t(type));
    if (!info) return nullptr;
    auto shape = std::unique_ptr<CellShape>(new CellShape);
    shape->type_ = type, shape->dimension_ = info->dimension, shape->nodes_ = nodes;
    shape->base_ = linear_type(type);
    const std::vector<Vec3> corners = basis::reference_corners(shape->base_);
    if (corners.empty() || (info->points >= 0 && size_t(info->points) != nodes)) return nullptr;
    for (Vec3 p : corners) shape->center_ += p / double(corners.size());
    if (shape->base_ == CellType::pyramid) shape->center_.z = 0.25;
    if (nodes == corners.size() && (type == shape->base_ || is_linear(orders))) {
      shape->at_ = corners;
      return shape;
    }
    if (basis::Space space = basis::space_of(type, nodes, shape->at_); !space.powers.empty()) {
      shape->kind_ = CellShape::Kind::space;
      shape->coefficients_ = basis::nodal_coefficients(space, shape->at_);
      shape->space_ = std::make_shared<const basis::Space>(std::move(space));
      const bool flat = type == CellType::quadratic_linear_quad || type == CellType::quadratic_linear_wedge;
      shape->degree_ = flat ? 1 : 2;
      shape->orders_ = {2, 2, 2};
      return shape;
    }
    if (!make_lattice(*shape, lattice_orders(type, nodes, orders))) return nullptr;
    return shape;
  }

  static bool is_linear(Orders o) { return o[0] <= 1 && o[1] <= 1 && o[2] <= 1; }

  static bool make_lattice(CellShape& shape, Orders n) {
    if (n[0] == 0) return false;
    shape.kind_ = CellShape::Kind::lattice;
    shape.bernstein_ = is_bezier(shape.type_);
    shape.orders_ = n;
    shape.degree_ = std::min({n[0], n[1], n[2]});
    shape.at_.resize(shape.nodes_);
    shape.lattice_.resize(3 * shape.nodes_);
    const basis::Form form = form_of(shape.base_);
    const int d = shape.dimension_;
    for (int k = 0; k <= (d > 2 ? n[2] : 0); ++k)
      for (int j = 0; j <= (d > 1 ? n[1] : 0); ++j)
        for (int i = 0; i <= n[0]; ++i) {
          if (form == basis::Form::simplex && i + j + k > n[0]) continue;
          if (form == basis::Form::wedge && i + j > n[0]) continue;
          const size_t node = lattice_node(shape.type_, n, i, j, k);
          shape.at_[node] = {double(i) / n[0], double(j) / n[1], double(k) / n[2]};
          const int place[3] = {i, j, k};
          for (size_t a = 0; a < 3; ++a) shape.lattice_[3 * node + a] = uint16_t(place[a]);
        }
    return true;
  }

  std::mutex mutex_;
  std::map<std::tuple<CellType, size_t, Orders>, std::unique_ptr<const CellShape>> known_;
};

const CellShape* CellShape::find(CellType type, size_t nodes, std::array<int, 3> orders) {
  return CellShapeTable::find(type, nodes, orders);
}

double CellShape::reference_measure() const {
  switch (base_) {
    case CellType::triangle:
    case CellType::wedge: return 0.5;
    case CellType::tetra: return 1.0 / 6;
    case CellType::pyramid: return 1.0 / 3;
    default: return 1;
  }
}

namespace {

// N = C f for the values, or for the derivatives.
template <class T>
void combine(const std::vector<double>& coefficients, const T* f, size_t n, T* out) {
  for (size_t k = 0; k < n; ++k) {
    T sum{};
    for (size_t i = 0; i < n; ++i)
      if (const double c = coefficients[k * n + i]; c != 0) sum += f[i] * c;
    out[k] = sum;
  }
}

constexpr size_t most_space_nodes = 27;

}  // namespace

void CellShape::values(Vec3 rst, double* n) const {
  if (kind_ == Kind::linear) return basis::linear_functions(base_, rst, n, nullptr);
  if (kind_ == Kind::lattice) return basis::lattice_functions(form_of(base_), bernstein_, dimension_, orders_, lattice_, rst, n, nullptr);
  double f[most_space_nodes];
  basis::space_functions(*space_, rst, f, nullptr);
  combine(coefficients_, f, nodes_, n);
}

void CellShape::derivatives(Vec3 rst, Vec3* dn) const {
  if (kind_ == Kind::linear) return basis::linear_functions(base_, rst, nullptr, dn);
  if (kind_ == Kind::lattice) return basis::lattice_functions(form_of(base_), bernstein_, dimension_, orders_, lattice_, rst, nullptr, dn);
  Vec3 df[most_space_nodes];
  basis::space_functions(*space_, rst, nullptr, df);
  combine(coefficients_, df, nodes_, dn);
}

void CellShape::functions(Vec3 rst, double* n, Vec3* dn) const {
  if (kind_ == Kind::linear) return basis::linear_functions(base_, rst, n, dn);
  if (kind_ == Kind::lattice) return basis::lattice_functions(form_of(base_), bernstein_, dimension_, orders_, lattice_, rst, n, dn);
  double f[most_space_nodes];
  Vec3 df[most_space_nodes];
  basis::space_functions(*space_, rst, f, df);
  combine(coefficients_, f, nodes_, n);
  combine(coefficients_, df, nodes_, dn);
}

double CellShape::outside(Vec3 p) const {
  auto most = [](auto... v) { return std::max({v...}); };
  switch (base_) {
    case CellType::vertex: return 0;
    case CellType::line: return most(-p.x, p.x - 1);
    case CellType::triangle: return most(-p.x, -p.y, p.x + p.y - 1);
    case CellType::tetra: return most(-p.x, -p.y, -p.z, p.x + p.y + p.z - 1);
    case CellType::wedge: return most(-p.x, -p.y, p.x + p.y - 1, -p.z, p.z - 1);
    case CellType::pyramid: {
      const double half = p.z / 2;
      return most(-p.z, half - p.x, half - p.y, p.x - 1 + half, p.y - 1 + half);
    }
    case CellType::pixel:
    case CellType::quad: return most(-p.x, p.x - 1, -p.y, p.y - 1);
    default: return most(-p.x, p.x - 1, -p.y, p.y - 1, -p.z, p.z - 1);
  }
}

namespace {

// The nearest place with x_a >= 0 and sum <= 1: drop the negative ones, then shift the largest ones down to the sum 1.
Vec3 clamped_simplex(Vec3 p, int d) {
  Vec3 q = p;
  double sum = 0;
  for (int a = 0; a < d; ++a) q[a] = std::max(p[a], 0.0), sum += q[a];
  if (!(sum > 1)) return q;
  double sorted[3], shift = 0, total = 0;
  for (int a = 0; a < d; ++a) sorted[a] = p[a];
  std::sort(sorted, sorted + d, [](double a, double b) { return a > b; });
  for (int a = 0; a < d; ++a) {
    total += sorted[a];
    if (const double s = (total - 1) / (a + 1); sorted[a] > s) shift = s;
  }
  for (int a = 0; a < d; ++a) q[a] = std::max(p[a] - shift, 0.0);
  return q;
}

double unit_clamp(double x) { return std::clamp(x, 0.0, 1.0); }

}  // namespace

Vec3 CellShape::clamped(Vec3 p) const {
  switch (base_) {
    case CellType::vertex: return {0, 0, 0};
    case CellType::line: return {unit_clamp(p.x), 0, 0};
    case CellType::triangle: {
      const Vec3 q = clamped_simplex(p, 2);
      return {q.x, q.y, 0};
    }
    case CellType::tetra: return clamped_simplex(p, 3);
    case CellType::wedge: {
      const Vec3 q = clamped_simplex(p, 2);
      return {q.x, q.y, unit_clamp(p.z)};
    }
    case CellType::pyramid: {
      const double t = unit_clamp(p.z), half = t / 2;
      return {std::clamp(p.x, half, 1 - half), std::clamp(p.y, half, 1 - half), t};
    }
    case CellType::pixel:
    case CellType::quad: return {unit_clamp(p.x), unit_clamp(p.y), 0};
    default: return {unit_clamp(p.x), unit_clamp(p.y), unit_clamp(p.z)};
  }
}

}  // namespace sg
