// SPDX-License-Identifier: Apache-2.0
#include "io/mfem/vector_element.h"

#include <fmt/core.h>

#include "base/error.h"
#include "io/mfem/polynomials.h"
#include "io/text/mesh_text.h"

namespace sg::mfem {

namespace {

constexpr int most_vector_order = 6;

std::vector<double> open_points(int n) { return n > 0 ? basis_points(Basis::gauss_legendre, n - 1) : std::vector<double>{}; }
std::vector<double> closed_points(int p) { return basis_points(Basis::gauss_lobatto, p); }

// Calls f(x, y) for the places of a triangle with n open points along its sides, x fastest.
template <class F>
void for_open_triangle(int n, F f) {
  const std::vector<double> o = open_points(n);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i + j < n; ++i) {
      const double a = o[size_t(i)], b = o[size_t(j)], w = a + b + o[size_t(n - 1 - i - j)];
      f(a / w, b / w);
    }
}

void inside_of_triangle(const FeCollection& c, std::vector<VectorDof>& out) {
  const bool rt = c.family == Family::rt;
  const Vec3 first = rt ? Vec3(0, -1, 0) : Vec3(1, 0, 0), second = rt ? Vec3(-1, 0, 0) : Vec3(0, 1, 0);
  for_open_triangle(vector_degree(c) - 1, [&](double x, double y) {
    out.push_back({{x, y, 0}, first});
    out.push_back({{x, y, 0}, second});
  });
}

void inside_of_tetrahedron(const FeCollection& c, std::vector<VectorDof>& out) {
  const double sign = c.family == Family::rt ? -1 : 1;
  const int n = c.family == Family::rt ? c.order : c.order - 2;
  const std::vector<double> o = open_points(n);
  for (int k = 0; k < n; ++k)
    for (int j = 0; j + k < n; ++j)
      for (int i = 0; i + j + k < n; ++i) {
        const Vec3 at(o[size_t(i)], o[size_t(j)], o[size_t(k)]);
        const double w = at.x + at.y + at.z + o[size_t(n - 1 - i - j - k)];
        for (int a = 0; a < 3; ++a) {
          Vec3 direction;
          direction[a] = sign;
          out.push_back({at / w, direction});
        }
      }
}

// Squares and cubes: component by component, x fastest. RT: closed points along the component's own axis, open ones across; ND: the
// other way round. RT's directions point away from the middle; where there is a middle plane (order odd) the square and the cube differ.
void inside_of_box(int dimension, const FeCollection& c, std::vector<VectorDof>& out) {
  const bool rt = c.family == Family::rt;
  const int degree = vector_degree(c), p = c.order;
  const std::vector<double> o = open_points(degree), l = closed_points(degree);
  for (int a = 0; a < dimension; ++a) {
    int first[3] = {0, 0, 0}, end[3] = {1, 1, 1};
    const std::vector<double>* points[3] = {};
    for (int b = 0; b < dimension; ++b) {
      const bool closed = (a == b) == rt;
      points[b] = closed ? &l : &o;
      first[b] = closed ? 1 : 0, end[b] = degree;
    }
    for (int k = first[2]; k < end[2]; ++k)
      for (int j = first[1]; j < end[1]; ++j)
        for (int i = first[0]; i < end[0]; ++i) {
          const int at[3] = {i, j, k};
          VectorDof d{};
          for (int b = 0; b < dimension; ++b) d.at[b] = (*points[b])[size_t(at[b])];
          bool negative = rt && at[a] <= p / 2;
          if (rt && dimension == 2 && p % 2 == 1 && at[a] == p / 2 + 1) negative = a == 0 ? j > p / 2 : i <= p / 2;
          d.direction[a] = negative ? -1 : 1;
          out.push_back(d);
        }
  }
}

void inside_of_prism(const FeCollection& c, std::vector<VectorDof>& out) {
  const bool rt = c.family == Family::rt;
  const int degree = vector_degree(c);
  const std::vector<double> o = open_points(degree), l = closed_points(degree);
  const auto along = [&](double x, double y, double z) { out.push_back({{x, y, z}, {0, 0, 1}}); };
  std::vector<VectorDof> flat;
  inside_of_triangle(c, flat);
  const auto across = [&](double z) {
    for (VectorDof d : flat) d.at.z = z, out.push_back(d);
  };
  if (rt) {
    for (const double z : o) across(z);
    for (int k = 1; k < degree; ++k) for_open_triangle(degree, [&](double x, double y) { along(x, y, l[size_t(k)]); });
    return;
  }
  for (int k = 1; k < degree; ++k) across(l[size_t(k)]);
  for (const double z : o)
    for (int j = 1; j < degree; ++j)
      for (int i = 1; i + j < degree; ++i) {
        const double x = l[size_t(i)], y = l[size_t(j)], w = x + y + l[size_t(degree - i - j)];
        along(x / w, y / w, z);
      }
}

void inside_dofs(Geometry g, const FeCollection& c, std::vector<VectorDof>& out) {
  switch (g) {
    case Geometry::triangle: return inside_of_triangle(c, out);
    case Geometry::square: return inside_of_box(2, c, out);
    case Geometry::tetrahedron: return inside_of_tetrahedron(c, out);
    case Geometry::cube: return inside_of_box(3, c, out);
    case Geometry::prism: return inside_of_prism(c, out);
    default: return;
  }
}

// The fields that span the element's space, at x.
class Modes {
 public:
  Modes(Geometry g, const FeCollection& c) : g_(g), rt_(c.family == Family::rt), degree_(vector_degree(c)) {}

  std::vector<Vec3> at(Vec3 x) {
    for (int a = 0; a < 3; ++a)
      for (int n = 0; n <= degree_; ++n) l_[a][n] = legendre(n, 2 * x[a] - 1).first;
    out_.clear();
    if (g_ == Geometry::square || g_ == Geometry::cube) box(g_ == Geometry::cube ? 3 : 2);
    else if (g_ == Geometry::tetrahedron) tetrahedron(x - Vec3(0.25, 0.25, 0.25));
    else triangle(x - Vec3(1, 1, 0) / 3);
    return out_;
  }

 private:
  // Of each component: degree d along its axis and d - 1 across for RT, the other way round for ND.
  void box(int dimension) {
    for (int a = 0; a < dimension; ++a) {
      int n[3] = {1, 1, 1};
      for (int b = 0; b < dimension; ++b) n[b] = (a == b) == rt_ ? degree_ + 1 : degree_;
      for (int k = 0; k < n[2]; ++k)
        for (int j = 0; j < n[1]; ++j)
          for (int i = 0; i < n[0]; ++i) {
            Vec3 v;
            v[a] = l_[0][i] * l_[1][j] * (dimension > 2 ? l_[2][k] : 1);
            out_.push_back(v);
          }
    }
  }
  // [P_(d-1)]^3, and x times homogeneous polynomials (RT) or x times them turned (ND), y from the middle: s y, or s (y x e).
  void tetrahedron(Vec3 y) {
    const int d = degree_ - 1;
    for (int k = 0; k <= d; ++k)
      for (int j = 0; j + k <= d; ++j)
        for (int i = 0; i + j + k <= d; ++i) {
          const double s = l_[0][i] * l_[1][j] * l_[2][k];
          out_.insert(out_.end(), {{s, 0, 0}, {0, s, 0}, {0, 0, s}});
        }
    for (int k = 0; k <= d; ++k)
      for (int j = 0; j + k <= d; ++j) {
        const double s = l_[0][d - j - k] * l_[1][j] * l_[2][k];
        if (rt_) out_.push_back(y * s);
        else out_.insert(out_.end(), {Vec3(y.y, -y.x, 0) * s, Vec3(y.z, 0, -y.x) * s});
      }
    for (int k = 0; k <= d && !rt_; ++k) out_.push_back(Vec3(0, y.z, -y.y) * (l_[1][d - k] * l_[2][k]));
  }
  // Triangles, and prisms: the triangle's fields times polynomials along z, and polynomials of the triangle along z.
  void triangle(Vec3 y) {
    const int d = degree_ - 1, layers = g_ == Geometry::triangle ? 1 : rt_ ? d + 1 : d + 2;
    const auto z = [&](int k) { return g_ == Geometry::triangle ? 1 : l_[2][k]; };
    for (int k = 0; k < layers; ++k)
      for (int j = 0; j <= d; ++j) {
        for (int i = 0; i + j <= d; ++i) {
          const double s = l_[0][i] * l_[1][j] * z(k);
          out_.insert(out_.end(), {{s, 0, 0}, {0, s, 0}});
        }
        const double s = l_[0][d - j] * l_[1][j] * z(k);
        out_.push_back(rt_ ? Vec3(y.x, y.y, 0) * s : Vec3(y.y, -y.x, 0) * s);
      }
    if (g_ == Geometry::triangle) return;
    const int flat = rt_ ? d : d + 1, tall = rt_ ? d + 1 : d;
    for (int k = 0; k <= tall; ++k)
      for (int j = 0; j <= flat; ++j)
        for (int i = 0; i + j <= flat; ++i) out_.push_back({0, 0, l_[0][i] * l_[1][j] * l_[2][k]});
  }

  Geometry g_;
  bool rt_;
  int degree_;
  double l_[3][most_vector_order + 2] = {};
  std::vector<Vec3> out_;
};

}  // namespace

int vector_degree(const FeCollection& c) { return c.family == Family::rt ? c.order + 1 : c.order; }

std::vector<VectorDof> entity_dofs(const FeCollection& c, int corners, int dimension) {
  std::vector<VectorDof> out;
  const int n = vector_degree(c);
  const std::vector<double> o = open_points(n);
  if (c.family == Family::rt) {
    if (corners == 2 && dimension == 2)
      for (const double x : o) out.push_back({{x, 0, 0}, {0, 0, 1}});
    if (corners == 3) for_open_triangle(n, [&](double x, double y) { out.push_back({{x, y, 0}, {0, 0, 1}}); });
    if (corners == 4)
      for (const double y : o)
        for (const double x : o) out.push_back({{x, y, 0}, {0, 0, 1}});
    return out;
  }
  if (corners == 2)
    for (const double x : o) out.push_back({{x, 0, 0}, {1, 0, 0}});
  if (corners == 3)
    for_open_triangle(n - 1, [&](double x, double y) {
      out.push_back({{x, y, 0}, {1, 0, 0}});
      out.push_back({{x, y, 0}, {0, 1, 0}});
    });
  if (corners == 4) {
    const std::vector<double> l = closed_points(n);
    for (int j = 1; j < n; ++j)
      for (const double x : o) out.push_back({{x, l[size_t(j)], 0}, {1, 0, 0}});
    for (const double y : o)
      for (int i = 1; i < n; ++i) out.push_back({{l[size_t(i)], y, 0}, {0, 1, 0}});
  }
  return out;
}

std::vector<VectorDof> vector_dofs(Geometry g, const FeCollection& c) {
  const GeometryInfo& e = info(g);
  std::vector<VectorDof> out;
  const auto corner = [&](int k) {
    const auto& p = e.corner_place[size_t(k)];
    return Vec3(p[0], p[1], p[2]);
  };
  const auto add = [&](Vec3 origin, Vec3 x, Vec3 y, Vec3 across, int corners) {
    for (const VectorDof& d : entity_dofs(c, corners, e.dimension))
      out.push_back({origin + x * d.at.x + y * d.at.y, x * d.direction.x + y * d.direction.y + across * d.direction.z});
  };
  for (const auto& [a, b] : e.edges) {
    const Vec3 t = corner(b) - corner(a);
    add(corner(a), t, Vec3(), Vec3(t.y, -t.x, 0), 2);
  }
  for (const auto& f : e.faces) {
    const Vec3 x = corner(f[1]) - corner(f[0]), y = corner(f.back()) - corner(f[0]);
    add(corner(f[0]), x, y, cross(x, y), int(f.size()));
  }
  inside_dofs(g, c, out);
  return out;
}

size_t inside_vector_dofs(Geometry g, const FeCollection& c) {
  std::vector<VectorDof> out;
  inside_dofs(g, c, out);
  return out.size();
}

NodeMatrix vector_matrix(Geometry g, const FeCollection& c, int q, const std::string& where) {
  if (info(g).dimension < 2 || g == Geometry::pyramid)
    fail_data(fmt::format("the vector-valued collection '{}' lies on {}", c.name, g == Geometry::pyramid ? "pyramids" : "segments"), where,
              "it is read on triangles, squares, tetrahedra, cubes and prisms; project it onto an L2 space of several components");
  if (c.order > most_vector_order)
    fail_data(fmt::format("the vector-valued collection '{}' has order {}", c.name, c.order), where,
              fmt::format("orders up to {} are supported", most_vector_order));
  const std::vector<VectorDof> dofs = vector_dofs(g, c);
  const auto places = lattice_places(info(g).shape, q);
  Modes modes(g, c);
  NodeMatrix r;
  r.nodes = places.size(), r.dofs = dofs.size();
  const size_t n = dofs.size(), columns = 3 * places.size();
  std::vector<double> v(n * n), b(n * columns);
  for (size_t d = 0; d < n; ++d) {  // V^T N = phi, solved for all nodes and components at once
    const std::vector<Vec3> phi = modes.at(dofs[d].at);
    if (phi.size() != n) fail_internal(fmt::format("mfem: {} fields for {} degrees of freedom", phi.size(), n));
    for (size_t k = 0; k < n; ++k) v[k * n + d] = dot(phi[k], dofs[d].direction);
  }
  for (size_t s = 0; s < places.size(); ++s) {
    const std::vector<Vec3> phi = modes.at(Vec3(places[s][0], places[s][1], places[s][2]) / q);
    for (size_t k = 0; k < n; ++k)
      for (int a = 0; a < 3; ++a) b[k * columns + 3 * s + size_t(a)] = phi[k][a];
  }
  solve(v, b, n, columns);
  r.m.resize(columns * n);
  for (size_t s = 0; s < columns; ++s)
    for (size_t d = 0; d < n; ++d) r.m[s * n + d] = std::fabs(b[d * columns + s]) < 1e-13 ? 0 : b[d * columns + s];
  return r;
}

}  // namespace sg::mfem
