// SPDX-License-Identifier: Apache-2.0
#include "filter/scalar/contour/contour_amr.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/parallel.h"
#include "data/field_ops.h"
#include "filter/field/automatic_values.h"
#include "filter/scalar/contour/amr_leaves.h"
#include "filter/scalar/contour/amr_outline.h"

namespace sg::contouring {

namespace {

using Leaf = AmrLeaves::Leaf;
using Place = AmrLeaves::Place;

struct PlaceHash {
  size_t operator()(const Place& p) const {
    uint64_t h = 0;
    for (int64_t x : p) h = (h ^ uint64_t(x)) * 0x9E3779B97F4A7C15ull, h ^= h >> 29;
    return size_t(h);
  }
};

// Solves a x = b for the symmetric matrix of a plane fit; directions in which nothing varies get 0.
Vec3 solve_plane(double a[3][3], double b[3]) {
  Vec3 x;
  bool done[3] = {};
  int order[3], rank = 0;
  const double scale = std::max({a[0][0], a[1][1], a[2][2], 1e-300});
  for (int step = 0; step < 3; ++step) {  // Gauss with diagonal pivots
    int p = -1;
    for (int i = 0; i < 3; ++i)
      if (!done[i] && (p < 0 || a[i][i] > a[p][p])) p = i;
    if (!(a[p][p] > 1e-9 * scale)) break;
    done[p] = true, order[rank++] = p;
    for (int i = 0; i < 3; ++i) {
      if (done[i]) continue;
      const double f = a[i][p] / a[p][p];
      for (int j = 0; j < 3; ++j) a[i][j] -= f * a[p][j];
      b[i] -= f * b[p];
    }
  }
  for (int k = rank; k-- > 0;) {
    double s = b[order[k]];
    for (int m = k + 1; m < rank; ++m) s -= a[order[k]][order[m]] * x[order[m]];
    x[order[k]] = s / a[order[k]][order[k]];
  }
  return x;
}

class Builder {
 public:
  Builder(const DatasetPtr& input, const Field& field, int component, const std::vector<double>& values, Context& context)
      : input_(input), field_(field), values_(values), context_(context), leaves_(*input), flat_(leaves_.dimension() == 2) {
    numbers_ = scalar_of(field, field.components() == 1 ? 0 : component, ElementType::f64);
    f_ = numbers_.view<double>();
    of_cells_ = field.association == Association::cell;
  }

  DatasetPtr run() {
    std::vector<Leaf> near = leaves_near();
    std::unordered_map<int64_t, uint32_t> taken;
    std::vector<Leaf> ring;
    size_t checked = 0;
    for (const Leaf& leaf : near) {
      if (++checked % 1024 == 0) context_.check();
      if (!is_cut(leaf)) continue;
      if (taken[leaf.cell]++ == 0) ring.push_back(leaf);
      // All that touch its corners, whose gradients make the normals.
      for (const Place& corner : outline_.corners)
        each_around(corner, [&](const Leaf& other) {
          if (taken[other.cell]++ == 0) ring.push_back(other);
        });
    }
    std::sort(ring.begin(), ring.end(), [](const Leaf& a, const Leaf& b) { return a.cell < b.cell; });
    for (const Leaf& leaf : ring) {
      if (++checked % 1024 == 0) context_.check();
      add(leaf);
    }
    return result();
  }

 private:
  // ---- which leaves ----

  bool crosses(double lo, double hi) const {
    if (values_.empty()) return true;
    for (double v : values_)
      if (lo <= v && v <= hi) return true;
    return false;
  }

  // Leaves in whose neighbourhood the field reaches a value; those next to finer ones always.
  std::vector<Leaf> leaves_near() const {
    struct Row {
      uint32_t level, patch;
      size_t first, count;
    };
    std::vector<Row> rows;
    const AmrGrid& g = leaves_.grid();
    for (size_t l = 0; l < g.levels.size(); ++l)
      for (size_t p = 0; p < g.levels[l].patches.size(); ++p) {
        const auto n = g.levels[l].patches[p].cells();
        for (size_t r = 0; r < n[1] * n[2]; ++r) rows.push_back({uint32_t(l), uint32_t(p), r * n[0], n[0]});
      }
    constexpr size_t grain = 64;
    std::vector<std::vector<Leaf>> parts(rows.size() / grain + 1);
    parallel_for(
        rows.size(), grain,
        [&](size_t begin, size_t end) {
          for (size_t r = begin; r < end; ++r)
            for (size_t k = rows[r].first; k < rows[r].first + rows[r].count; ++k) {
              const Leaf leaf = leaves_.leaf(rows[r].level, rows[r].patch, k);
              if (leaves_.is_leaf(leaf.cell) && (!of_cells_ || may_cross(leaf))) parts[begin / grain].push_back(leaf);
            }
        },
        &context_);
    std::vector<Leaf> r;
    for (const auto& p : parts) r.insert(r.end(), p.begin(), p.end());
    return r;
  }

  bool may_cross(const Leaf& leaf) const {
    double lo = HUGE_VAL, hi = -HUGE_VAL;
    bool finer = false;
    each_neighbour(leaf, [&](const Leaf& other) {
      finer = finer || other.level > leaf.level;
      const double x = f_[size_t(other.cell)];
      lo = std::min(lo, x), hi = std::max(hi, x);
    });
    const double own = f_[size_t(leaf.cell)];
    lo = std::min(lo, own), hi = std::max(hi, own);
    return finer || crosses(lo - (hi - lo), hi + (hi - lo));  // planes may reach beyond the values around
  }

  // f(leaf) for what lies across the corners, edges and faces: 26 places, each named once for each.
  template <class F>
  void each_neighbour(const Leaf& leaf, F&& f) const {
    const Place& s = leaves_.size(leaf.level);
    for (int z = flat_ ? 0 : -1; z <= (flat_ ? 0 : 1); ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
          if (x == 0 && y == 0 && z == 0) continue;
          const int d[3] = {x, y, z};
          Place at = leaf.lo;
          for (size_t a = 0; a < 3; ++a) at[a] += d[a] < 0 ? -1 : d[a] > 0 ? s[a] : s[a] / 2;
          const Leaf other = leaves_.at(at);
          if (other.cell >= 0) f(other);
        }
  }

  // f(leaf) for each octant (2D: quadrant) at a corner.
  template <class F>
  void each_around(const Place& corner, F&& f) const {
    for (int o = 0; o < (flat_ ? 4 : 8); ++o) {
      const Place at{corner[0] - (o & 1), corner[1] - (o >> 1 & 1), corner[2] - (o >> 2 & 1)};
      const Leaf leaf = leaves_.at(at);
      if (leaf.cell >= 0) f(leaf);
    }
  }

  // ---- values at corners ----

  Vec3 gradient(const Leaf& leaf) {
    const auto known = gradients_.find(leaf.cell);
    if (known != gradients_.end()) return known->second;
    double a[3][3] = {}, b[3] = {};
    const Vec3 here = leaves_.center(leaf);
    const double own = f_[size_t(leaf.cell)];
    std::vector<int64_t> seen;
    each_neighbour(leaf, [&](const Leaf& other) {
      if (std::find(seen.begin(), seen.end(), other.cell) != seen.end()) return;
      seen.push_back(other.cell);
      const double df = f_[size_t(other.cell)] - own;
      const Vec3 d = leaves_.center(other) - here;
      const double w = 1 / dot(d, d);
      if (!std::isfinite(df)) return;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) a[i][j] += w * d[i] * d[j];
        b[i] += w * d[i] * df;
      }
    });
    return gradients_[leaf.cell] = solve_plane(a, b);
  }

  struct Corner {
    double value;
    int64_t source;  // point of the input; -1 for fields of cells
    int64_t number = -1;
  };

  Corner& corner(const Place& at) {
    const auto [found, fresh] = corners_known_.try_emplace(at);
    Corner& c = found->second;
    if (!fresh) return c;
    std::array<Leaf, 8> around;
    size_t n = 0;
    each_around(at, [&](const Leaf& l) { around[n++] = l; });
    c.source = -1;
    if (!of_cells_) {
      const Leaf* finest = nullptr;
      for (size_t i = 0; i < n; ++i)
        if (!finest || around[i].level > finest->level) finest = &around[i];
      c.source = point_of(*finest, at);
      c.value = f_[size_t(c.source)];
      return c;
    }
    bool regular = n == (flat_ ? 4u : 8u);
    for (size_t i = 1; i < n; ++i) regular = regular && around[i].level == around[0].level;
    double sum = 0, count = 0;
    for (size_t i = 0; i < n; ++i) {
      const double x = f_[size_t(around[i].cell)];
      regular = regular && std::isfinite(x);
    }
    const Vec3 place = leaves_.position(at);
    for (size_t i = 0; i < n; ++i) {
      const double x = f_[size_t(around[i].cell)];
      if (std::isnan(x)) continue;
      sum += x, ++count;
      if (!regular && std::isfinite(x)) {
        Vec3 d = place - leaves_.center(around[i]);
        if (flat_) d.z = 0;
        sum += dot(gradient(around[i]), d);
      }
    }
    c.value = count > 0 ? sum / count : std::nan("");
    return c;
  }

  int64_t point_of(const Leaf& leaf, const Place& at) const {
    const auto& p = leaves_.grid().levels[leaf.level].patches[leaf.patch];
    const Place& s = leaves_.size(leaf.level);
    const auto n = p.cells();
    int64_t i[3];
    for (size_t a = 0; a < 3; ++a) i[a] = (at[a] - p.lo[a] * s[a]) / s[a];
    if (flat_) i[2] = 0;
    return int64_t(p.point_offset) + i[0] + int64_t(n[0] + 1) * (i[1] + int64_t(n[1] + 1) * i[2]);
  }

  // ---- cells ----

  bool usable(const Leaf& leaf) const { return !of_cells_ || !std::isnan(f_[size_t(leaf.cell)]); }

  bool is_cut(const Leaf& leaf) {
    outline_.open(leaf);
    if (!usable(leaf)) return false;
    double lo = HUGE_VAL, hi = -HUGE_VAL;
    for (const Place& at : outline_.corners) {
      const double x = corner(at).value;
      if (std::isnan(x)) return false;
      lo = std::min(lo, x), hi = std::max(hi, x);
    }
    return crosses(lo, hi);
  }

  void add(const Leaf& leaf) {
    outline_.open(leaf);
    if (!usable(leaf)) return;
    auto number = [&](const Place& at) {
      Corner& c = corner(at);
      if (c.number < 0) {
        c.number = int64_t(point_values_.size());
        point_values_.push_back(c.value);
        sources_.push_back(c.source);
        const Vec3 x = leaves_.position(at) - leaves_.grid().origin;
        xyz_.insert(xyz_.end(), {x.x, x.y, x.z});
      }
      return c.number;
    };
    const bool plain = flat_ ? outline_.corners.size() == 4 : outline_.corners.size() == 8;
    if (plain || !flat_)  // voxels and pixels list their corners x fastest
      std::sort(outline_.corners.begin(), outline_.corners.end(),
                [](const Place& a, const Place& b) { return std::tie(a[2], a[1], a[0]) < std::tie(b[2], b[1], b[0]); });
    if (flat_ && !plain)
      for (const Place& at : outline_.faces[0]) ids_.push_back(number(at));
    else
      for (const Place& at : outline_.corners) ids_.push_back(number(at));
    offsets_.push_back(int64_t(ids_.size()));
    types_.push_back(uint8_t(flat_ ? plain ? CellType::pixel : CellType::polygon : plain ? CellType::voxel : CellType::polyhedron));
    if (!flat_ && !plain)
      for (const auto& face : outline_.faces) {
        for (const Place& at : face) face_ids_.push_back(number(at));
        face_offsets_.push_back(int64_t(face_ids_.size()));
      }
    cell_faces_.push_back(int64_t(face_offsets_.size()) - 1);
    from_.push_back(leaf.cell);
  }

  DatasetPtr result() {
    UnstructuredMesh m;
    m.points = {Array::from_vector(std::move(xyz_), 3), leaves_.grid().origin};
    m.cells = {Array::from_vector(std::move(ids_)), Array::from_vector(std::move(offsets_)), 0};
    m.types = Array::from_vector(std::move(types_));
    if (face_offsets_.size() > 1) {
      m.faces = {Array::from_vector(std::move(face_ids_)), Array::from_vector(std::move(face_offsets_)), 0};
      m.polyhedron_faces = Array::from_vector(std::move(cell_faces_));
    }
    DatasetParts out;
    out.mesh = std::move(m);
    if (of_cells_) {
      Array values = Array::from_vector(std::move(point_values_));
      if (!(field_.array.type() == ElementType::f64)) values = values.converted(ElementType::f32);
      out.fields.add({field_.name, Association::point, std::move(values), field_.unit, Role::scalars});
    } else {
      carry_gathered(out.fields, input_->fields(), Association::point, std::span<const int64_t>(sources_), Association::point);
    }
    carry_gathered(out.fields, input_->fields(), Association::cell, std::span<const int64_t>(from_), Association::cell);
    carry_whole(out.fields, input_->fields());
    out.notes = input_->notes();
    out.time = input_->time();
    return make_dataset(std::move(out));
  }

  const DatasetPtr& input_;
  const Field& field_;
  const std::vector<double>& values_;
  Context& context_;
  AmrLeaves leaves_;
  bool flat_, of_cells_ = true;
  Array numbers_;
  View<double> f_;
  std::unordered_map<int64_t, Vec3> gradients_;
  std::unordered_map<Place, Corner, PlaceHash> corners_known_;
  AmrOutline outline_{leaves_};
  std::vector<double> xyz_, point_values_;
  std::vector<int64_t> sources_, ids_, offsets_{0}, face_ids_, face_offsets_{0}, cell_faces_{0}, from_;
  std::vector<uint8_t> types_;
};

}  // namespace

DatasetPtr amr_cells_near(const DatasetPtr& input, const Field& field, int component, const std::vector<double>& values, Context& context) {
  return Builder(input, field, component, values, context).run();
}

const Field& field_of_amr(const Dataset& input, const FieldName& name) {
  const Field* field = nullptr;
  if (!name.empty()) {
    field = &input.fields().require(name.name);
    if (const Field* point = input.fields().find(name.name, Association::point)) field = point;
  } else {
    field = input.fields().active(1);
    for (const Field& f : input.fields())
      if (!field && f.components() == 1 && f.association != Association::whole) field = &f;
  }
  if (!field) fail_usage("the grid has no field to contour", "contour");
  if (field->association == Association::whole)
    fail_usage(fmt::format("field '{}' belongs to the whole mesh; a contour needs values at the points", field->name), "contour");
  return *field;
}

DatasetPtr contour_amr(const DatasetPtr& input, const ContourParams& params, int (*component_of)(const Field&, const std::string&),
                       Context& context) {
  const Field& field = field_of_amr(*input, params.field);
  const int component = component_of(field, params.component);
  ContourParams flat = params;
  if (flat.values.empty()) flat.values = automatic_values(*input, field, component, params.count, "contour", context);
  for (double v : flat.values)
    if (!std::isfinite(v)) fail_usage(fmt::format("{} is not a valid isovalue", v), "contour values", "give finite numbers");
  flat.field.name = field.name;
  flat.from_cells = false;
  if (field.association == Association::cell) flat.component.clear();
  return contour(amr_cells_near(input, field, component, flat.values, context), flat, context);
}

}  // namespace sg::contouring
