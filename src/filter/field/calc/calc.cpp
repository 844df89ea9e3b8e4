// SPDX-License-Identifier: Apache-2.0
#include "filter/field/calc/calc.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cells/cell_reader.h"
#include "data/fields/known_looks.h"
#include "data/lattice.h"
#include "filter/field/calc/calc_program.h"

namespace sg {

namespace {

using calc_detail::Instruction;
using calc_detail::Op;
using calc_detail::Program;

constexpr size_t block = 256;  // tuples that are computed together: registers stay in the cache

// Positions of points, or middles of cells, [begin, begin + n), three numbers each.
class Positions {
 public:
  Positions(const DatasetPtr& d, Association on) : data_(d), on_(on) {
    if (is_lattice(d->mesh())) lattice_.emplace(d->mesh());
    else if (auto* u = d->as<UnstructuredMesh>()) points_ = &u->points;
    else if (auto* s = d->as<SurfaceMesh>()) points_ = &s->points;
    else if (auto* c = d->as<PointCloud>()) points_ = &c->points;
    if (!lattice_ && !points_ && on == Association::point)
      fail_usage("the point positions of an AMR grid cannot be used in expressions", "calc", "compute on cells: on=cell");
  }
  void fill(size_t begin, size_t n, double* out) const {
    if (on_ == Association::cell) {
      CellReader reader(data_);
      for (size_t i = 0; i < n; ++i) {
        reader.open(begin + i);
        Vec3 sum{0, 0, 0};
        for (const Vec3& p : reader.at()) sum = sum + p;
        put(sum * (1.0 / double(std::max<size_t>(reader.at().size(), 1))), out + 3 * i);
      }
    } else if (lattice_) {
      const LatticeView& v = lattice_->view();
      for (size_t i = 0; i < n; ++i) {
        const size_t p = begin + i;
        put(v.position(p % v.dims[0], p / v.dims[0] % v.dims[1], p / (v.dims[0] * v.dims[1])), out + 3 * i);
      }
    } else {
      for (size_t i = 0; i < n; ++i) put(points_->at(begin + i), out + 3 * i);
    }
  }

 private:
  static void put(Vec3 p, double* out) { out[0] = p.x, out[1] = p.y, out[2] = p.z; }
  DatasetPtr data_;
  Association on_;
  std::optional<Lattice> lattice_;
  const Points* points_ = nullptr;
};

void load(const Array& a, size_t begin, size_t n, double* out) {
  const int m = a.components();
  dispatch(a, [&](const auto& v) {
    for (size_t i = 0; i < n; ++i)
      for (int c = 0; c < m; ++c) out[i * size_t(m) + size_t(c)] = double(v(begin + i, c));
  });
}

double modulo(double a, double b) { return a - b * std::floor(a / b); }  // the sign of b: angles wrap as one expects

double det3(const double* m) {
  return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
}

// One number from two or three.
double combine(Op op, double a, double b, double c) {
  switch (op) {
    case Op::add: return a + b;
    case Op::subtract: return a - b;
    case Op::multiply: return a * b;
    case Op::divide: return a / b;
    case Op::modulo: return modulo(a, b);
    case Op::power: return b == 2 ? a * a : std::pow(a, b);
    case Op::less: return a < b;
    case Op::less_equal: return a <= b;
    case Op::greater: return a > b;
    case Op::greater_equal: return a >= b;
    case Op::equal: return a == b;
    case Op::not_equal: return a != b;
    case Op::logical_and: return a != 0 && b != 0;
    case Op::logical_or: return a != 0 || b != 0;
    case Op::choose: return a != 0 ? b : c;
    case Op::minimum: return std::isnan(a) || a < b ? a : b;
    case Op::maximum: return std::isnan(a) || a > b ? a : b;
    case Op::atan2: return std::atan2(a, b);
    case Op::hypot: return std::hypot(a, b);
    case Op::clamp: return a < b ? b : a > c ? c : a;
    default: return 0;
  }
}

class Machine {
 public:
  Machine(const Program& program, const std::vector<Array>& fields, const Positions* positions)
      : program_(program), fields_(fields), positions_(positions), registers_(program.code.size()) {
    for (size_t i = 0; i < registers_.size(); ++i) registers_[i].resize(block * size_t(program.code[i].components));
  }
  /// Tuples [begin, begin + n); the result lies in the last register.
  const double* run(size_t begin, size_t n) {
    for (size_t i = 0; i < program_.code.size(); ++i) step(program_.code[i], registers_[i].data(), begin, n);
    return registers_.back().data();
  }

 private:
  const double* in(int r) const { return registers_[size_t(r)].data(); }
  size_t width(int r) const { return r < 0 ? 1 : size_t(program_.code[size_t(r)].components); }

  void step(const Instruction& s, double* out, size_t begin, size_t n) {
    const auto m = size_t(s.components);
    const double* a = s.a >= 0 ? in(s.a) : nullptr;
    const double* b = s.b >= 0 ? in(s.b) : nullptr;
    const double* c = s.c >= 0 ? in(s.c) : nullptr;
    const size_t wa = width(s.a);
    switch (s.op) {
      case Op::constant: std::fill_n(out, n, s.value); return;
      case Op::field: load(fields_[s.field], begin, n, out); return;
      case Op::position: positions_->fill(begin, n, out); return;
      case Op::negate:
        for (size_t i = 0; i < n * m; ++i) out[i] = -a[i];
        return;
      case Op::logical_not:
        for (size_t i = 0; i < n * m; ++i) out[i] = a[i] == 0;
        return;
      case Op::call1:
        for (size_t i = 0; i < n * m; ++i) out[i] = s.function(a[i]);
        return;
      case Op::component:
        for (size_t i = 0; i < n; ++i) out[i] = a[i * wa + size_t(s.value)];
        return;
      case Op::mag:
      case Op::sum:
      case Op::norm:
      case Op::trace:
      case Op::det:
      case Op::dot:
      case Op::cross: vectors(s, out, a, b, n, wa); return;
      case Op::vec:
        if (s.b < 0) std::copy_n(a, n * m, out);  // a copy
        else
          for (size_t i = 0; i < n; ++i) out[3 * i] = a[i], out[3 * i + 1] = b[i], out[3 * i + 2] = c[i];
        return;
      default: break;
    }
    const size_t wb = width(s.b), wc = width(s.c);
    for (size_t i = 0; i < n; ++i)
      for (size_t k = 0; k < m; ++k)
        out[i * m + k] = combine(s.op, a[wa == 1 ? i : i * wa + k], b[wb == 1 ? i : i * wb + k], c ? c[wc == 1 ? i : i * wc + k] : 0);
  }

  static void vectors(const Instruction& s, double* out, const double* a, const double* b, size_t n, size_t w) {
    for (size_t i = 0; i < n; ++i) {
      const double* v = a + i * w;
      double sum = 0;
      switch (s.op) {
        case Op::mag:
          for (size_t k = 0; k < w; ++k) sum += v[k] * v[k];
          out[i] = std::sqrt(sum);
          break;
        case Op::norm:
          for (size_t k = 0; k < w; ++k) sum += v[k] * v[k];
          for (size_t k = 0; k < w; ++k) out[i * w + k] = sum == 0 ? 0 : v[k] / std::sqrt(sum);
          break;
        case Op::sum:
          for (size_t k = 0; k < w; ++k) sum += v[k];
          out[i] = sum;
          break;
        case Op::dot:
          for (size_t k = 0; k < w; ++k) sum += v[k] * b[i * w + k];
          out[i] = sum;
          break;
        case Op::trace: out[i] = v[0] + v[4] + v[8]; break;
        case Op::det: out[i] = det3(v); break;
        default: {
          const double* u = b + 3 * i;
          out[3 * i] = v[1] * u[2] - v[2] * u[1];
          out[3 * i + 1] = v[2] * u[0] - v[0] * u[2];
          out[3 * i + 2] = v[0] * u[1] - v[1] * u[0];
        }
      }
    }
  }

  const Program& program_;
  const std::vector<Array>& fields_;
  const Positions* positions_;
  std::vector<std::vector<double>> registers_;
};

// Where the expression is computed: where its fields are.
Association place_of(const DatasetPtr& in, const Program& program, std::optional<CalcPlace> on) {
  std::optional<Association> found;
  if (on) found = *on == CalcPlace::cell ? Association::cell : Association::point;
  for (const std::string& name : program.fields) {
    const bool at_points = in->fields().find(name, Association::point), at_cells = in->fields().find(name, Association::cell);
    if (found && (*found == Association::point ? at_points : at_cells)) continue;
    if (found)
      fail_usage(fmt::format("field '{}' is not on the {}s", name, association_name(*found)), "calc expr",
                 "convert it first with point_to_cell or cell_to_point");
    found = at_points ? Association::point : Association::cell;
  }
  return found.value_or(Association::point);
}

bool fits_float(ElementType t) { return t == ElementType::f32 || element_size(t) < 4; }

template <class T>
Array compute(const Program& program, const std::vector<Array>& fields, const Positions* positions, size_t n, Context& ctx) {
  const int m = program.code.back().components;
  T* out = nullptr;
  Array result = Array::make<T>(n, m, &out);
  parallel_for(
      n, 32 * block,
      [&](size_t begin, size_t end) {
        Machine machine(program, fields, positions);
        for (size_t i = begin; i < end; i += block) {
          const size_t count = std::min(block, end - i);
          const double* v = machine.run(i, count);
          for (size_t k = 0; k < count * size_t(m); ++k) out[i * size_t(m) + k] = T(v[k]);
        }
      },
      &ctx);
  return result;
}

}  // namespace

DatasetPtr calc(const DatasetPtr& in, const CalcParams& p, Context& ctx) {
  if (p.expr.empty()) fail_usage("the expression is empty", "calc expr", "write e.g. expr=mag(velocity)*rho");
  if (p.name.empty()) fail_usage("the new field has no name", "calc name");
  const Program program = calc_detail::parse(
      p.expr,
      [&](std::string_view name) -> calc_detail::Symbol {
        for (const Association a : {p.on == CalcPlace::cell ? Association::cell : Association::point,
                                    p.on == CalcPlace::cell ? Association::point : Association::cell})
          if (const Field* f = in->fields().find(name, a)) return {true, f->components(), Unit::of(f->unit)};
        return {};
      },
      in->fields().names(), in->time().value_or(0));
  const Association on = place_of(in, program, p.on);
  std::vector<Array> fields;
  bool single = !program.fields.empty();
  for (const std::string& name : program.fields) {
    fields.push_back(in->fields().require(name, on).array);
    single = single && fits_float(fields.back().type());
  }
  std::optional<Positions> positions;
  if (program.needs_position) positions.emplace(in, on);
  if (!program.note.empty()) ctx.warn("calc: " + program.note);
  const size_t n = on == Association::point ? in->point_count() : in->cell_count();
  const Positions* where = positions ? &*positions : nullptr;
  Array values = single ? compute<float>(program, fields, where, n, ctx) : compute<double>(program, fields, where, n, ctx);
  const int m = values.components();
  const Role role = m == 1 ? Role::scalars : m == 3 ? Role::vectors : Role::none;
  return with_result(in, {p.name, on, std::move(values), program.unit.text(), role, known_look(p.name)});
}

}  // namespace sg
