// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/tessellate_cells.h"

#include <unordered_map>

#include "base/error.h"
#include "data/cell_map.h"
#include "data/field_ops.h"

namespace sg {

namespace {

// A linear part of a reference element: corners as lattice places, coordinates counted in 1/n.
struct Part {
  CellType type;
  std::vector<std::array<int, 3>> at;
};

std::array<int, 3> middle(const std::array<int, 3>& a, const std::array<int, 3>& b) {
  return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
}

// Halves all edges. Coordinates are even, so that middles are whole.
void halve(const Part& p, std::vector<Part>& out) {
  const auto& a = p.at;
  auto m = [&](int i, int j) { return middle(a[size_t(i)], a[size_t(j)]); };
  auto corners = [&](CellType t, std::vector<std::array<int, 3>> at) { out.push_back({t, std::move(at)}); };
  // Boxes by their corners in lattice order: part (x,y,z) spans from corner o with half the edges.
  auto boxes = [&](int axes) {
    const auto half = [&](int k) {
      return std::array<int, 3>{k == 0 ? (a[1][0] - a[0][0]) / 2 : 0, k == 1 ? (a[axes > 1 ? 3 : 0][1] - a[0][1]) / 2 : 0,
                                k == 2 ? (a[axes > 2 ? 4 : 0][2] - a[0][2]) / 2 : 0};
    };
    const int sx = half(0)[0], sy = half(1)[1], sz = half(2)[2];
    for (int z = 0; z < (axes > 2 ? 2 : 1); ++z)
      for (int y = 0; y < (axes > 1 ? 2 : 1); ++y)
        for (int x = 0; x < 2; ++x) {
          const int ox = a[0][0] + x * sx, oy = a[0][1] + y * sy, oz = a[0][2] + z * sz;
          std::vector<std::array<int, 3>> c = {{ox, oy, oz}, {ox + sx, oy, oz}};
          if (axes > 1) c.push_back({ox + sx, oy + sy, oz}), c.push_back({ox, oy + sy, oz});
          if (axes > 2)
            for (int k = 0; k < 4; ++k) c.push_back({c[size_t(k)][0], c[size_t(k)][1], oz + sz});
          corners(p.type, std::move(c));
        }
  };
  switch (p.type) {
    case CellType::line: boxes(1); return;
    case CellType::quad: boxes(2); return;
    case CellType::hexahedron: boxes(3); return;
    case CellType::triangle: {
      const auto ab = m(0, 1), bc = m(1, 2), ca = m(2, 0);
      corners(p.type, {a[0], ab, ca}), corners(p.type, {ab, a[1], bc}), corners(p.type, {ca, bc, a[2]}), corners(p.type, {ab, bc, ca});
      return;
    }
    case CellType::wedge: {
      for (int z = 0; z < 2; ++z) {
        const auto lower = [&](int k) { return z == 0 ? a[size_t(k)] : m(k, k + 3); };
        const auto upper = [&](int k) { return z == 0 ? m(k, k + 3) : a[size_t(k + 3)]; };
        const std::array<int, 3> l[6] = {
            lower(0), lower(1), lower(2), middle(lower(0), lower(1)), middle(lower(1), lower(2)), middle(lower(2), lower(0))};
        const std::array<int, 3> u[6] = {
            upper(0), upper(1), upper(2), middle(upper(0), upper(1)), middle(upper(1), upper(2)), middle(upper(2), upper(0))};
        for (const auto& t : {std::array{0, 3, 5}, std::array{3, 1, 4}, std::array{5, 4, 2}, std::array{3, 4, 5}})
          corners(p.type, {l[t[0]], l[t[1]], l[t[2]], u[t[0]], u[t[1]], u[t[2]]});
      }
      return;
    }
    case CellType::tetra: {  // Bey (1995): four corners, and the octahedron cut along one diagonal
      const auto b = m(0, 1), c = m(0, 2), d = m(0, 3), e = m(1, 2), f = m(1, 3), g = m(2, 3);
      corners(p.type, {a[0], b, c, d}), corners(p.type, {b, a[1], e, f}), corners(p.type, {c, e, a[2], g}),
          corners(p.type, {d, f, g, a[3]});
      corners(p.type, {b, c, d, f}), corners(p.type, {b, e, c, f}), corners(p.type, {c, f, g, d}), corners(p.type, {c, e, g, f});
      return;
    }
    default: {  // pyramid: four at the base, one at the apex, one upside down, four tetrahedra between
      const auto ab = m(0, 1), bc = m(1, 2), cd = m(2, 3), da = m(3, 0), center = middle(a[0], a[2]);
      const auto ta = m(0, 4), tb = m(1, 4), tc = m(2, 4), td = m(3, 4);
      corners(p.type, {a[0], ab, center, da, ta}), corners(p.type, {ab, a[1], bc, center, tb});
      corners(p.type, {center, bc, a[2], cd, tc}), corners(p.type, {da, center, cd, a[3], td});
      corners(p.type, {ta, tb, tc, td, a[4]}), corners(p.type, {td, tc, tb, ta, center});
      corners(CellType::tetra, {ab, ta, tb, center}), corners(CellType::tetra, {bc, tb, tc, center});
      corners(CellType::tetra, {cd, tc, td, center}), corners(CellType::tetra, {da, td, ta, center});
      return;
    }
  }
}

// Corners of the linear types in lattice coordinates (0 or 1); a pyramid's apex stands over its first corner here.
std::vector<std::array<int, 3>> reference_corners(CellType t) {
  switch (t) {
    case CellType::line: return {{0, 0, 0}, {1, 0, 0}};
    case CellType::triangle: return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    case CellType::quad: return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    case CellType::tetra: return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    case CellType::wedge: return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    case CellType::pyramid: return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}};
    default: return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  }
}

// Reference coordinates of a lattice place: a pyramid leans over its first corner in the lattice, and stands upright in reference space.
Vec3 place(CellType t, const std::array<int, 3>& at, int n) {
  const double lean = t == CellType::pyramid ? 0.5 * at[2] : 0;
  return {(at[0] + lean) / n, (at[1] + lean) / n, double(at[2]) / n};
}

// The parts of a type, its edges halved `level` times; made once.
struct Pattern {
  int n = 1;
  std::vector<Part> parts;
  std::vector<std::array<int, 3>> points;  // each once
};

Pattern make_pattern(CellType t, int level) {
  Pattern p;
  p.n = 1 << level;
  Part whole{t, reference_corners(t)};
  for (auto& c : whole.at)
    for (int& x : c) x *= p.n;
  p.parts = {whole};
  for (int l = 0; l < level; ++l) {
    std::vector<Part> finer;
    for (const Part& part : p.parts) halve(part, finer);
    p.parts = std::move(finer);
  }
  for (const Part& part : p.parts) p.points.insert(p.points.end(), part.at.begin(), part.at.end());
  std::sort(p.points.begin(), p.points.end());
  p.points.erase(std::unique(p.points.begin(), p.points.end()), p.points.end());
  return p;
}

const Pattern& pattern(CellType t, int level, std::unordered_map<int, Pattern>& made) {
  const int key = int(t) * 16 + level;
  auto at = made.find(key);
  if (at == made.end()) at = made.emplace(key, make_pattern(t, level)).first;
  return at->second;
}

// A point by what it is made of: corners of the mesh and their shares. Equal for all cells that share it.
std::string point_key(CellType t, const std::array<int, 3>& at, int n, std::span<const int64_t> corners) {
  const int x = at[0], y = at[1], z = at[2], a = n - x, b = n - y, c = n - z;
  std::vector<int64_t> w;
  switch (t) {
    case CellType::line: w = {a, x}; break;
    case CellType::triangle: w = {n - x - y, x, y}; break;
    case CellType::quad: w = {int64_t(a) * b, int64_t(x) * b, int64_t(x) * y, int64_t(a) * y}; break;
    case CellType::tetra: w = {n - x - y - z, x, y, z}; break;
    case CellType::wedge: {
      const int64_t o = n - x - y;
      w = {o * c, int64_t(x) * c, int64_t(y) * c, o * z, int64_t(x) * z, int64_t(y) * z};
      break;
    }
    case CellType::pyramid: {  // the base's shares times what is left at this height, in 1/(n - z)
      const int64_t e = c - x, f = c - y, s = std::max(c, 1);
      w = {e * f, int64_t(x) * f, int64_t(x) * y, e * y, int64_t(z) * s};
      break;
    }
    default:
      w = {int64_t(a) * b * c, int64_t(x) * b * c, int64_t(x) * y * c, int64_t(a) * y * c,
           int64_t(a) * b * z, int64_t(x) * b * z, int64_t(x) * y * z, int64_t(a) * y * z};
  }
  // Shares of one face come out with a common factor that depends on the cell: divide it out.
  int64_t divisor = 0;
  for (const int64_t v : w) divisor = std::gcd(divisor, v);
  std::vector<std::pair<int64_t, int64_t>> shares;
  for (size_t k = 0; k < w.size(); ++k)
    if (w[k]) shares.emplace_back(corners[k], w[k] / std::max<int64_t>(divisor, 1));
  std::sort(shares.begin(), shares.end());
  return std::string(reinterpret_cast<const char*>(shares.data()), shares.size() * sizeof(shares[0]));
}

// Largest distance from straight at the middles of the new edges, relative to what it may be (1 = at the tolerance).
double deviation(CellMap& map, const Pattern& p, CellType base, const std::vector<std::pair<const Array*, double>>& fields,
                 double allowed) {
  const auto ids = map.reader().ids();
  std::vector<double> w[3];
  for (auto& v : w) v.resize(ids.size());
  double worst = 0;
  for (const Part& part : p.parts)
    for (size_t i = 0; i < part.at.size(); ++i)
      for (size_t j = i + 1; j < part.at.size(); ++j) {
        const Vec3 ends[2] = {place(base, part.at[i], p.n), place(base, part.at[j], p.n)};
        const Vec3 at[3] = {ends[0], ends[1], (ends[0] + ends[1]) * 0.5};
        Vec3 x[3];
        for (int k = 0; k < 3; ++k) {
          CellPlace cp;
          cp.rst = at[k];
          map.weights(cp, w[k]);
          x[k] = map.position(at[k]);
        }
        worst = std::max(worst, length(x[2] - (x[0] + x[1]) * 0.5) / allowed);
        for (const auto& [a, range] : fields)
          for (int c = 0; c < a->components(); ++c) {
            double off = 0;
            for (size_t k = 0; k < ids.size(); ++k) off += (w[2][k] - 0.5 * (w[0][k] + w[1][k])) * a->get(size_t(ids[k]), c);
            if (std::isfinite(off)) worst = std::max(worst, std::fabs(off) / range);
          }
      }
  return worst;
}

class Tessellation {
 public:
  Tessellation(const DatasetPtr& in, const UnstructuredMesh& mesh, Context& ctx) : in_(in), mesh_(mesh), map_(in), ctx_(ctx) {}

  /// Halvings that all cells need, up to `most`; `left` is then the largest deviation (1 = at the tolerance).
  int level(double tolerance, int most, double& left) {
    const Box3& b = in_->bounds();
    const double allowed = tolerance * std::max(length(b.hi - b.lo), 1e-300);
    std::vector<std::pair<const Array*, double>> fields;
    for (const Field& f : in_->fields())
      if (f.association == Association::point && is_float(f.array.type())) {
        const Range r = in_->range(f, f.components() == 1 ? 0 : -1);
        if (r.hi > r.lo) fields.emplace_back(&f.array, tolerance * (r.hi - r.lo));
      }
    int l = 0;
    left = 0;
    for (size_t c = 0; c < mesh_.cells.size(); ++c) {
      if (!is_high_order(mesh_.type(c))) continue;
      if (c % 1024 == 0) ctx_.check();
      map_.open(c);
      const CellType base = linear_type(mesh_.type(c));
      for (;; ++l) {
        const double d = deviation(map_, pattern(base, l, patterns_), base, fields, allowed);
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
    for (size_t c = 0; c < mesh_.cells.size(); ++c) {
      if (c % 1024 == 0) ctx_.check();
      map_.open(c);
      if (is_high_order(mesh_.type(c))) add_curved(c, level);
      else add_linear(c);
    }
    return result();
  }

 private:
  int64_t corner(int64_t id) {
    const auto [at, fresh] = corners_.emplace(id, int64_t(points_.size()));
    if (fresh) points_.push_back({in_position(id), {id}, {1.0}});
    return at->second;
  }
  Vec3 in_position(int64_t id) const { return mesh_.points.at(size_t(id)) - mesh_.points.origin; }

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
    const CellType base = linear_type(mesh_.type(c));
    const Pattern& p = pattern(base, level, patterns_);
    const auto ids = map_.reader().ids();
    const auto ends = reference_corners(base);
    std::vector<int64_t> number(p.points.size());
    for (size_t i = 0; i < p.points.size(); ++i) {
      // Corners are points of the mesh, which linear cells may share.
      const std::array<int, 3> scaled{p.points[i][0] / p.n, p.points[i][1] / p.n, p.points[i][2] / p.n};
      const auto end = std::find(ends.begin(), ends.end(), scaled);
      if (end != ends.end() && p.points[i] == std::array<int, 3>{scaled[0] * p.n, scaled[1] * p.n, scaled[2] * p.n}) {
        number[i] = corner(ids[size_t(end - ends.begin())]);
        continue;
      }
      const auto [at, fresh] = shared_.emplace(point_key(base, p.points[i], p.n, ids), int64_t(points_.size()));
      number[i] = at->second;
      if (!fresh) continue;
      CellPlace cp;
      cp.rst = place(base, p.points[i], p.n);
      Made made;
      made.weights.resize(ids.size());
      map_.weights(cp, made.weights);
      made.at = map_.position(cp.rst) - mesh_.points.origin;
      made.ids.assign(ids.begin(), ids.end());
      points_.push_back(std::move(made));
    }
    std::vector<int64_t> mine;
    for (const Part& part : p.parts) {
      mine.clear();
      for (const auto& at : part.at)
        mine.push_back(number[size_t(std::lower_bound(p.points.begin(), p.points.end(), at) - p.points.begin())]);
      add_cell(part.type, mine, c);
    }
  }

  DatasetPtr result() {
    DatasetParts out;
    UnstructuredMesh m;
    std::vector<double> xyz;
    size_t widest = 1;
    for (const Made& p : points_) {
      xyz.insert(xyz.end(), {p.at.x, p.at.y, p.at.z});
      widest = std::max(widest, p.ids.size());
    }
    m.points = {Array::from_vector(std::move(xyz), 3), mesh_.points.origin};
    m.cells = {Array::from_vector(std::move(ids_)), Array::from_vector(std::move(offsets_)), 0};
    m.types = Array::from_vector(std::move(types_));
    if (polyhedra_) {
      m.faces = {Array::from_vector(std::move(face_ids_)), Array::from_vector(std::move(face_offsets_)), 0};
      cell_faces_.insert(cell_faces_.begin(), 0);
      m.polyhedron_faces = Array::from_vector(std::move(cell_faces_));
    }
    out.mesh = std::move(m);
    std::vector<int64_t> ids(points_.size() * widest);
    std::vector<double> weights(points_.size() * widest, 0.0);
    for (size_t i = 0; i < points_.size(); ++i)
      for (size_t k = 0; k < widest; ++k) {
        const Made& p = points_[i];
        ids[i * widest + k] = p.ids[k < p.ids.size() ? k : 0];
        if (k < p.ids.size()) weights[i * widest + k] = p.weights[k];
      }
    carry_combined(out.fields, in_->fields(), Association::point, ids, weights, widest, Association::point);
    carry_gathered(out.fields, in_->fields(), Association::cell, from_, Association::cell);
    carry_whole(out.fields, in_->fields());
    if (!in_->cell_ghost().empty()) out.cell_ghost = gather(in_->cell_ghost(), from_);
    if (!out.fields.find("original_cell", Association::cell))
      out.fields.add({"original_cell", Association::cell, Array::from_vector(std::move(from_)), "", Role::global_ids});
    out.notes = in_->notes();
    out.time = in_->time();
    return make_dataset(std::move(out));
  }

  struct Made {
    Vec3 at;
    std::vector<int64_t> ids;
    std::vector<double> weights;
  };
  const DatasetPtr& in_;
  const UnstructuredMesh& mesh_;
  CellMap map_;
  Context& ctx_;
  std::unordered_map<int, Pattern> patterns_;
  std::unordered_map<std::string, int64_t> shared_;
  std::unordered_map<int64_t, int64_t> corners_;  // point of the input -> point of the result
  std::vector<Made> points_;
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
  const int level = work.level(p.tolerance, p.max_level, left);
  if (left > 1) ctx.info(fmt::format("tessellate: max_level leaves a distance of {:.3g} times the tolerance", left));
  return work.run(level);
}

}  // namespace sg
