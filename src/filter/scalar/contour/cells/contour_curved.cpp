// SPDX-License-Identifier: Apache-2.0
#include "filter/scalar/contour/cells/contour_curved.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>

#include "base/parallel.h"
#include "data/cells/cell_topology.h"
#include "data/field_ops.h"
#include "filter/scalar/contour/cells/curved_simplices.h"

namespace sg::contouring {

namespace {

// A place on an edge of a simplex, between its corners a and b there.
struct OnEdge {
  uint64_t key;
  uint32_t cell;
  Vec3 from, to;  // reference places of the lower and the higher point
};

struct Part {
  std::vector<OnEdge> edges;  // one for each cut edge and cell, by key and order of the simplices
  std::vector<size_t> first;  // of each point in edges; one more at the end
  std::vector<int32_t> lines, triangles;
  std::vector<uint32_t> line_cells, triangle_cells;
  std::vector<Vec3> rst;  // of the points, in the cell of their first edge
};

// Cut edges of a simplex in the order of the corners of its triangles.
void cut(const Simplex& s, const std::vector<CurvedSimplices::Point>& points, double value, std::vector<std::array<uint8_t, 2>>& lines,
         std::vector<std::array<uint8_t, 2>>& triangles) {
  uint32_t in = 0;
  for (size_t k = 0; k < s.corners; ++k) in |= uint32_t(points[s.v[k]].f >= value) << k;
  const uint32_t all = (1u << s.corners) - 1;
  if (in == 0 || in == all) return;
  const int n = std::popcount(in);
  if (s.corners == 3) {  // inside on the left
    const bool one = n == 1;
    const auto k = uint8_t(std::countr_zero(one ? in : all ^ in)), a = uint8_t((k + 1) % 3), b = uint8_t((k + 2) % 3);
    if (one) lines.insert(lines.end(), {{k, a}, {k, b}});
    else lines.insert(lines.end(), {{k, b}, {k, a}});
    return;
  }
  auto triangle = [&](std::array<uint8_t, 2> a, std::array<uint8_t, 2> b, std::array<uint8_t, 2> c) {
    if (s.flipped) std::swap(b, c);
    triangles.insert(triangles.end(), {a, b, c});
  };
  if (n == 2) {
    const auto a = uint8_t(std::countr_zero(in)), b = uint8_t(std::countr_zero(in & (in - 1)));
    const uint32_t rest = all ^ in;
    auto c = uint8_t(std::countr_zero(rest)), d = uint8_t(std::countr_zero(rest & (rest - 1)));
    if ((a == 0 && b == 2) || (a == 1 && b == 3)) std::swap(c, d);  // now (a, b, c, d) turns like (0, 1, 2, 3)
    triangle({a, c}, {b, d}, {b, c});
    triangle({a, c}, {a, d}, {b, d});
    return;
  }
  static constexpr uint8_t others[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  const auto k = uint8_t(std::countr_zero(n == 1 ? in : all ^ in));
  const uint8_t* q = others[k];
  if (n == 1) triangle({k, q[0]}, {k, q[1]}, {k, q[2]});
  else triangle({k, q[0]}, {k, q[2]}, {k, q[1]});
}

Part find(const CurvedSimplices& cells, double value) {
  struct Use {
    OnEdge edge;
    uint32_t place;  // in the list of line and triangle corners
  };
  std::vector<Use> uses;
  Part part;
  size_t line_corners = 0;
  for (bool solid : {false, true}) {
    std::vector<std::array<uint8_t, 2>> lines, triangles;
    for (const Simplex& s : cells.simplices()) {
      lines.clear(), triangles.clear();
      cut(s, cells.points(), value, lines, triangles);
      const auto& list = solid ? triangles : lines;
      for (auto [a, b] : list) {
        if (s.v[a] > s.v[b]) std::swap(a, b);
        uses.push_back({{uint64_t(s.v[a]) << 32 | s.v[b], s.cell, s.rst[a], s.rst[b]}, uint32_t(uses.size())});
      }
      if (solid) part.triangle_cells.insert(part.triangle_cells.end(), list.size() / 3, s.cell);
      else part.line_cells.insert(part.line_cells.end(), list.size() / 2, s.cell);
    }
    if (!solid) line_corners = uses.size();
  }
  std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) {
    return std::tie(a.edge.key, a.edge.cell, a.place) < std::tie(b.edge.key, b.edge.cell, b.place);
  });
  std::vector<int32_t> number(uses.size());
  for (size_t i = 0; i < uses.size(); ++i) {
    if (i == 0 || uses[i].edge.key != uses[i - 1].edge.key) part.first.push_back(part.edges.size());
    if (i == 0 || uses[i].edge.key != uses[i - 1].edge.key || uses[i].edge.cell != uses[i - 1].edge.cell)
      part.edges.push_back(uses[i].edge);
    number[uses[i].place] = int32_t(part.first.size() - 1);
  }
  part.first.push_back(part.edges.size());
  part.lines.assign(number.begin(), number.begin() + ptrdiff_t(line_corners));
  part.triangles.assign(number.begin() + ptrdiff_t(line_corners), number.end());
  return part;
}

// Where the field takes the value between two places of the open cell: false position that halves the weight of an end that stays.
double root(CellField& field, const OnEdge& e, double value, double fa, double fb) {
  double a = 0, b = 1;
  fa -= value, fb -= value;
  const double small = 1e-14 * (std::abs(fa) + std::abs(fb));
  if (fa == 0) return 0;
  int side = 0;
  double t = fa / (fa - fb);
  for (int i = 0; i < 60; ++i) {
    const double f = field.value(e.from + (e.to - e.from) * t) - value;
    if (std::abs(f) <= small || b - a < 1e-14) break;
    if ((f >= 0) == (fb >= 0)) {
      b = t, fb = f;
      if (side == 1) fa *= 0.5;
      side = 1;
    } else {
      a = t, fa = f;
      if (side == -1) fb *= 0.5;
      side = -1;
    }
    t = fa == fb ? 0.5 * (a + b) : (a * fb - b * fa) / (fb - fa);
    if (!(t >= a && t <= b)) t = 0.5 * (a + b);
  }
  return t;
}

class Surface {
 public:
  Surface(const DatasetPtr& input, View<double> f, Vec3 origin, Context& context)
      : input_(input), f_(f), origin_(origin), context_(context) {
    for (const Field& field : input->fields())
      if (field.association == Association::point) fields_.push_back(&field);
    columns_.resize(fields_.size());
  }

  void add(const CurvedSimplices& cells, double value, bool normals) {
    Part part = find(cells, value);
    const size_t n = part.first.size() - 1, before = xyz_.size() / 3;
    if (before + n > size_t(INT32_MAX)) fail_usage("the surface has more than 2^31 points", "contour", "use a larger tolerance");
    xyz_.resize((before + n) * 3);
    if (normals) normals_.resize((before + n) * 3);
    for (size_t i = 0; i < fields_.size(); ++i) columns_[i].resize((before + n) * size_t(fields_[i]->components()));
    parallel_for(
        n, 256,
        [&](size_t begin, size_t end) {
          CellField field(input_, f_);
          for (size_t v = begin; v < end; ++v) point(part, v, before + v, cells.points(), value, normals, field);
        },
        &context_);
    for (int32_t k : part.lines) lines_.push_back(int32_t(before) + k);
    for (int32_t k : part.triangles) triangles_.push_back(int32_t(before) + k);
    line_cells_.insert(line_cells_.end(), part.line_cells.begin(), part.line_cells.end());
    triangle_cells_.insert(triangle_cells_.end(), part.triangle_cells.begin(), part.triangle_cells.end());
    line_values_.resize(line_cells_.size(), value), triangle_values_.resize(triangle_cells_.size(), value);
    point_values_.resize(before + n, value);
  }

  DatasetPtr result(const Field& contoured, bool several, bool normals) {
    SurfaceMesh mesh;
    mesh.points = {Array::from_vector(std::move(xyz_), 3), origin_};
    if (!lines_.empty()) mesh.lines = {Array::from_vector(std::move(lines_)), {}, 2};
    mesh.polygons = {Array::from_vector(std::move(triangles_)), {}, 3};
    DatasetParts out;
    for (size_t i = 0; i < fields_.size(); ++i) {
      const Field& f = *fields_[i];
      auto& values = f.name == contoured.name && f.components() == 1 ? point_values_ : columns_[i];
      const ElementType t = f.array.type();
      const bool wide = element_size(t) == 8;
      Array a = Array::from_vector(std::vector<double>(values), f.components());
      out.fields.add(f.with(wide ? a : a.converted(ElementType::f32)));
    }
    if (normals) out.fields.add({"Normals", Association::point, Array::from_vector(std::move(normals_), 3), "", Role::normals});
    std::vector<uint32_t> from = line_cells_;
    from.insert(from.end(), triangle_cells_.begin(), triangle_cells_.end());
    carry_gathered(out.fields, input_->fields(), Association::cell, std::span<const uint32_t>(from), Association::cell);
    if (several) {
      line_values_.insert(line_values_.end(), triangle_values_.begin(), triangle_values_.end());
      out.fields.add({"contour value", Association::cell, Array::from_vector(std::move(line_values_)), contoured.unit, Role::none});
    }
    carry_whole(out.fields, input_->fields());
    out.mesh = std::move(mesh);
    out.notes = input_->notes();
    out.time = input_->time();
    return make_dataset(std::move(out));
  }
  bool empty() const { return lines_.empty() && triangles_.empty(); }

 private:
  void point(const Part& part, size_t v, size_t place, const std::vector<CurvedSimplices::Point>& points, double value, bool normals,
             CellField& field) {
    const OnEdge& e = part.edges[part.first[v]];
    const CellMap& map = field.open(e.cell);
    const double t = root(field, e, value, points[e.key >> 32].f, points[uint32_t(e.key)].f);
    const Vec3 rst = e.from + (e.to - e.from) * t, x = field.position(rst) - origin_;
    for (int c = 0; c < 3; ++c) xyz_[3 * place + size_t(c)] = float(x[c]);
    const auto& w = field.weights(rst);
    const auto ids = map.reader().ids();
    for (size_t i = 0; i < fields_.size(); ++i) {
      const Array& a = fields_[i]->array;
      for (int c = 0; c < a.components(); ++c) {
        double s = 0;
        for (size_t k = 0; k < ids.size(); ++k) s += w[k] * a.get(size_t(ids[k]), c);
        columns_[i][place * size_t(a.components()) + size_t(c)] = s;
      }
    }
    if (!normals) return;
    Vec3 g;
    for (size_t k = part.first[v]; k < part.first[v + 1]; ++k) {
      const OnEdge& other = part.edges[k];
      field.open(other.cell);
      g += field.gradient(other.from + (other.to - other.from) * t);
    }
    const double square = dot(g, g);
    const double scale = square > 0 && std::isfinite(square) ? -1 / std::sqrt(square) : 0;
    for (int c = 0; c < 3; ++c) normals_[3 * place + size_t(c)] = scale != 0 ? float(g[c] * scale) : 0.0f;
  }

  const DatasetPtr& input_;
  View<double> f_;
  Vec3 origin_;
  Context& context_;
  std::vector<const Field*> fields_;
  std::vector<std::vector<double>> columns_;
  std::vector<float> xyz_, normals_;
  std::vector<int32_t> lines_, triangles_;
  std::vector<uint32_t> line_cells_, triangle_cells_;
  std::vector<double> line_values_, triangle_values_, point_values_;
};

}  // namespace

bool has_curved_cells(const Dataset& dataset) {
  const auto* mesh = dataset.as<UnstructuredMesh>();
  if (!mesh) return false;
  if (mesh->types.empty()) return mesh->cells.size() > 0 && is_high_order(mesh->single_type);
  bool curved[256];
  for (int t = 0; t < 256; ++t) curved[t] = cell_type_info(uint8_t(t)) && is_high_order(CellType(t));
  for (size_t c = 0; c < mesh->cells.size(); ++c)
    if (curved[uint8_t(mesh->type(c))]) return true;
  return false;
}

DatasetPtr contour_curved(const DatasetPtr& input, const Field& field, const Array& samples, const std::vector<double>& values,
                          double tolerance, bool normals, Vec3 origin, Context& context) {
  const Array numbers = samples.converted(ElementType::f64);
  Surface surface(input, numbers.view<double>(), origin, context);
  const double length = tolerance * input->bounds().diagonal();
  for (double v : values) surface.add(CurvedSimplices(input, numbers.view<double>(), v, length, context), v, normals);
  if (surface.empty()) context.info(fmt::format("contour: field '{}' does not reach the value", field.name));
  return surface.result(field, values.size() > 1, normals);
}

}  // namespace sg::contouring
