// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/tessellate_cells.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <tuple>
#include <unordered_map>

#include "base/error.h"
#include "data/cells/shape/cell_map.h"
#include "data/field_ops.h"
#include "filter/mesh/cell_pattern.h"

namespace sg {

namespace {

using detail::CellPattern;

// Numbers that points of the result are made of (a node's id and weight each): beyond this many, and what two halvings make, edges stay.
constexpr double most_weights = 1 << 23, least_growth = 64;

// A pattern in one kind of curved cell: its shape functions at the pattern's points and middles, `nodes` numbers each.
struct ShapedPattern {
  const CellPattern* pattern = nullptr;
  std::vector<double> at_points, at_middles;
};

// What is shared by the cells around a point on a corner, edge or face: corners of the mesh and their shares.
struct PointKey {
  std::array<std::pair<int64_t, int64_t>, 4> of;
  bool operator==(const PointKey&) const = default;
};
struct PointKeyHash {
  size_t operator()(const PointKey& k) const {
    uint64_t h = 0x9E3779B97F4A7C15u;
    for (const auto& [id, share] : k.of)
      h = (h ^ uint64_t(id)) * 0xFF51AFD7ED558CCDu, h = (h ^ (h >> 32) ^ uint64_t(share)) * 0xC4CEB9FE1A85EC53u;
    return size_t(h ^ (h >> 29));
  }
};

class Tessellation {
 public:
  Tessellation(const DatasetPtr& in, const UnstructuredMesh& mesh, Context& ctx) : in_(in), mesh_(mesh), map_(in), ctx_(ctx) {
    const CellsView v = cells_view(mesh.cells);
    for (size_t c = 0; c < v.count; ++c)
      if (is_high_order(mesh.type(c))) widest_ = std::max(widest_, v.size(c));
  }

  /// Halvings that there is room for, at most `most`.
  int affordable(int most) const {
    std::map<std::pair<CellType, size_t>, double> kinds;
    const CellsView v = cells_view(mesh_.cells);
    for (size_t c = 0; c < v.count; ++c)
      if (is_high_order(mesh_.type(c))) kinds[{linear_type(mesh_.type(c)), v.size(c)}] += 1;
    const auto cost = [&](int level) {
      double sum = 0;
      for (const auto& [kind, count] : kinds) sum += count * double(kind.second) * detail::part_count(kind.first, level);
      return sum;
    };
    int level = 0;
    while (level < most && cost(level + 1) <= std::max(most_weights, least_growth * cost(0))) ++level;
    return level;
  }

  /// Halvings that all cells need, up to `most`; `left` is then the largest deviation (1 = at the tolerance).
  int level(double tolerance, int most, double& left) {
    const Box3& b = in_->bounds();
    const double allowed = tolerance * std::max(length(b.hi - b.lo), 1e-300);
    scaled_.clear();
    for (const Field& f : in_->fields())
      if (f.association == Association::point && is_float(f.array.type())) {
        const Range r = in_->range(f, f.components() == 1 ? 0 : -1);
        if (r.hi > r.lo) scaled_.emplace_back(&f.array, 1 / (tolerance * (r.hi - r.lo)));
      }
    int l = 0;
    left = 0;
    for (size_t c = 0; c < mesh_.cells.size(); ++c) {
      if (!is_high_order(mesh_.type(c))) continue;
      if (c % 1024 == 0) ctx_.check();
      map_.open(c);
      load_nodes(1 / allowed);
      for (;; ++l) {
        const double d = deviation(shaped(l));
        if (d <= 1) break;
        if (l == most) {
          left = std::max(left, d);
          break;
        }
      }
    }
    return l;
  }

  DatasetPtr run(int level) {
    for (auto& [key, s] : shaped_) s.at_middles = {};  // the level has been reported
    for (size_t c = 0; c < mesh_.cells.size(); ++c) {
      if (c % 1024 == 0) ctx_.check();
      map_.open(c);
      if (is_high_order(mesh_.type(c))) add_curved(c, level);
      else add_linear(c);
    }
    return result();
  }

 private:
  const ShapedPattern& shaped(int level) {
    const CellReader& reader = map_.reader();
    const CellType type = reader.type(), base = linear_type(type);
    const size_t nodes = reader.ids().size();
    auto& kept = shaped_[{int(type), int(nodes), reader.orders(), level}];
    if (kept.pattern) return kept;
    auto& pattern = patterns_[{base, level}];
    if (!pattern) pattern = std::make_unique<CellPattern>(detail::cell_pattern(base, level));
    kept.pattern = pattern.get();
    const CellShape& shape = *CellShape::find(type, nodes, reader.orders());  // CellMap has opened it
    const auto fill = [&](const std::vector<Vec3>& at, std::vector<double>& values) {
      values.resize(at.size() * nodes);
      for (size_t i = 0; i < at.size(); ++i) shape.values(at[i], &values[i * nodes]);
    };
    fill(pattern->points, kept.at_points), fill(pattern->middles, kept.at_middles);
    return kept;
  }

  // The open cell's weights where its shape functions have these values.
  std::span<const double> weights(const double* shape) {
    const std::span<const double> rational = map_.reader().weights();
    const size_t n = map_.reader().ids().size();
    if (rational.empty()) return {shape, n};
    weights_.resize(n);
    double sum = 0;
    for (size_t k = 0; k < n; ++k) sum += weights_[k] = shape[k] * rational[k];
    for (double& w : weights_) w /= sum;
    return weights_;
  }

  // Positions and fields of the open cell's nodes, in units of what they may be off: from their mean, so that large numbers lose nothing.
  void load_nodes(double per_length) {
    const auto ids = map_.reader().ids();
    const auto at = map_.reader().at();
    width_ = 3;
    for (const auto& [a, scale] : scaled_) width_ += size_t(a->components());
    nodes_.resize(ids.size() * width_);
    for (size_t k = 0; k < ids.size(); ++k) {
      double* to = &nodes_[k * width_];
      const Vec3 x = (at[k] - at[0]) * per_length;
      *to++ = x.x, *to++ = x.y, *to++ = x.z;
      for (const auto& [a, scale] : scaled_)
        for (int c = 0; c < a->components(); ++c) *to++ = a->get(size_t(ids[k]), c) * scale;
    }
  }

  void evaluate(const std::vector<double>& shapes, std::vector<double>& out) {
    const size_t n = map_.reader().ids().size(), count = shapes.size() / n;
    out.assign(count * width_, 0.0);
    for (size_t i = 0; i < count; ++i) {
      const auto w = weights(&shapes[i * n]);
      double* to = &out[i * width_];
      for (size_t k = 0; k < n; ++k) {
        const double* from = &nodes_[k * width_];
        if (w[k] != 0)
          for (size_t c = 0; c < width_; ++c) to[c] += w[k] * from[c];
      }
    }
  }

  // Largest distance from straight at the middles of the new edges, relative to what it may be (1 = at the tolerance).
  double deviation(const ShapedPattern& s) {
    evaluate(s.at_points, values_), evaluate(s.at_middles, middles_);
    double worst = 0;
    for (const auto& [a, b, m] : s.pattern->spans) {
      const double *x = &values_[a * width_], *y = &values_[b * width_], *mid = &middles_[m * width_];
      double far2 = 0;
      for (size_t c = 0; c < width_; ++c) {
        const double off = std::abs(mid[c] - 0.5 * (x[c] + y[c]));
        if (c < 3) far2 += off * off;
        else if (std::isfinite(off)) worst = std::max(worst, off);
      }
      worst = std::max(worst, std::sqrt(far2));
    }
    return worst;
  }

  // A point of the result: nodes of the mesh and their weights.
  int64_t add_point(Vec3 at, std::span<const int64_t> ids, std::span<const double> w) {
    const auto number = int64_t(xyz_.size() / 3);
    xyz_.insert(xyz_.end(), {at.x, at.y, at.z});
    node_ids_.insert(node_ids_.end(), ids.begin(), ids.end());
    node_ids_.resize(size_t(number + 1) * widest_, ids[0]);
    node_weights_.insert(node_weights_.end(), w.begin(), w.end());
    node_weights_.resize(size_t(number + 1) * widest_, 0.0);
    return number;
  }
  int64_t corner(int64_t id) {
    if (corners_.empty()) corners_.assign(in_->point_count(), -1);
    int64_t& number = corners_[size_t(id)];
    const double one = 1;
    if (number < 0) number = add_point(mesh_.points.at(size_t(id)) - mesh_.points.origin, {&id, 1}, {&one, 1});
    return number;
  }

  void add_cell(CellType t, std::span<const int64_t> ids, size_t from) {
    ids_.insert(ids_.end(), ids.begin(), ids.end());
    offsets_.push_back(int64_t(ids_.size()));
    types_.push_back(uint8_t(t));
    from_.push_back(int64_t(from));
    cell_faces_.push_back(int64_t(face_offsets_.size()) - 1);
  }
  void add_linear(size_t c) {
    const auto ids = map_.reader().ids();
    std::vector<int64_t> mine;
    for (const int64_t id : ids) mine.push_back(corner(id));
    if (mesh_.type(c) == CellType::polyhedron) {
      CellReader reader = map_.reader();
      reader.open(c);
      for (size_t f = 0; f < reader.face_count(); ++f) {
        for (const uint32_t k : reader.face(f)) face_ids_.push_back(mine[k]);
        face_offsets_.push_back(int64_t(face_ids_.size()));
      }
      polyhedra_ = true;
    }
    add_cell(mesh_.type(c), mine, c);
  }
  void add_curved(size_t c, int level) {
    const ShapedPattern& s = shaped(level);
    const CellPattern& p = *s.pattern;
    const auto ids = map_.reader().ids();
    const auto at = map_.reader().at();
    const bool solid = map_.dimension() == 3;
    const auto corners = size_t(cell_type_info(linear_type(mesh_.type(c))).corners);
    std::vector<int64_t> number(p.points.size());
    for (size_t i = 0; i < p.points.size(); ++i) {
      const auto shares = p.shares_of(i);
      if (shares.size() == 1) {  // corners are points of the mesh, which linear cells may share
        number[i] = corner(ids[shares[0].corner]);
        continue;
      }
      if (!solid || shares.size() < corners) {
        PointKey key;
        key.of.fill({-1, 0});
        for (size_t k = 0; k < shares.size(); ++k) key.of[k] = {ids[shares[k].corner], shares[k].weight};
        std::sort(key.of.begin(), key.of.begin() + ptrdiff_t(shares.size()));
        const auto [known, fresh] = shared_.emplace(key, int64_t(xyz_.size() / 3));
        number[i] = known->second;
        if (!fresh) continue;
      }
      const auto w = weights(&s.at_points[i * ids.size()]);
      Vec3 x;
      for (size_t k = 0; k < ids.size(); ++k) x += at[k] * w[k];
      number[i] = add_point(x - mesh_.points.origin, ids, w);
    }
    std::vector<int64_t> mine;
    for (const CellPattern::Part& part : p.parts) {
      mine.clear();
      for (uint32_t k = 0; k < part.count; ++k) mine.push_back(number[p.corners[part.begin + k]]);
      add_cell(part.type, mine, c);
    }
  }

  DatasetPtr result() {
    DatasetParts out;
    UnstructuredMesh m;
    m.points = {Array::from_vector(std::move(xyz_), 3), mesh_.points.origin};
    m.cells = {Array::from_vector(std::move(ids_)), Array::from_vector(std::move(offsets_)), 0};
    m.types = Array::from_vector(std::move(types_));
    if (polyhedra_) {
      m.faces = {Array::from_vector(std::move(face_ids_)), Array::from_vector(std::move(face_offsets_)), 0};
      cell_faces_.insert(cell_faces_.begin(), 0);
      m.polyhedron_faces = Array::from_vector(std::move(cell_faces_));
    }
    out.mesh = std::move(m);
    carry_combined(out.fields, in_->fields(), Association::point, node_ids_, node_weights_, widest_, Association::point);
    carry_gathered(out.fields, in_->fields(), Association::cell, from_, Association::cell);
    carry_whole(out.fields, in_->fields());
    if (!in_->cell_ghost().empty()) out.cell_ghost = gather(in_->cell_ghost(), from_);
    if (!out.fields.find("original_cell", Association::cell))
      out.fields.add({"original_cell", Association::cell, Array::from_vector(std::move(from_)), "", Role::global_ids});
    out.notes = in_->notes();
    out.time = in_->time();
    return make_dataset(std::move(out));
  }

  const DatasetPtr& in_;
  const UnstructuredMesh& mesh_;
  CellMap map_;
  Context& ctx_;
  std::map<std::pair<CellType, int>, std::unique_ptr<CellPattern>> patterns_;
  std::map<std::tuple<int, int, std::array<int, 3>, int>, ShapedPattern> shaped_;
  std::vector<std::pair<const Array*, double>> scaled_;  // fields that count, and their scale to units of their tolerance
  std::vector<double> nodes_, values_, middles_, weights_;
  size_t width_ = 3;
  std::unordered_map<PointKey, int64_t, PointKeyHash> shared_;
  std::vector<int64_t> corners_;  // point of the input -> point of the result
  size_t widest_ = 1;             // nodes of a curved cell at most
  std::vector<double> xyz_, node_weights_;
  std::vector<int64_t> node_ids_;
  std::vector<int64_t> ids_, offsets_{0}, face_ids_, face_offsets_{0}, cell_faces_, from_;
  std::vector<uint8_t> types_;
  bool polyhedra_ = false;
};

}  // namespace

DatasetPtr tessellate(const DatasetPtr& in, const TessellateParams& p, Context& ctx) {
  const auto* mesh = in->as<UnstructuredMesh>();
  bool any = false;
  for (size_t c = 0; mesh && c < mesh->cells.size() && !any; ++c) any = is_high_order(mesh->type(c));
  if (!any) return in;
  for (size_t c = 0; c < mesh->cells.size(); ++c)
    if (mesh->type(c) == CellType::quadratic_polygon)
      fail_usage("quadratic polygons have no shape functions", "tessellate", "remove them first: threshold");
  Tessellation work(in, *mesh, ctx);
  double left = 0;
  const int most = work.affordable(p.max_level), level = work.level(p.tolerance, most, left);
  if (left > 1)
    ctx.info(fmt::format("tessellate: {} leaves a distance of {:.3g} times the tolerance",
                         most < p.max_level ? fmt::format("{} halvings, the most that fit,", most) : "max_level", left));
  return work.run(level);
}

}  // namespace sg
