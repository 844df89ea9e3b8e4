// SPDX-License-Identifier: Apache-2.0
#include "filter/tensor/degenerate/degenerate_lines.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "data/cells/cell_reader.h"
#include "filter/mesh/tessellate_cells.h"
#include "filter/scalar/isolines.h"
#include "filter/tensor/degenerate/degenerate_face.h"
#include "filter/tensor/tensor_sampler.h"

namespace sg {

namespace {

// Which solution on which face: the ids of its corners, ascending, and a number.
struct Key {
  std::array<int64_t, 3> face;
  int number;
  friend auto operator<=>(const Key&, const Key&) = default;
};

struct FacePoint {
  Key key;
  Vec3 at, axis, tangent;
  bool planar;
  double twice, once;
};

struct Segment {
  FacePoint a, b;
};

struct Chunk {
  std::vector<Segment> segments;
  size_t alone = 0;
};

struct Tetra {
  int64_t id[4];
  Vec3 at[4];
};

// Tetrahedra from the corner with the smallest id to the triangles of the faces that do not have it; a face is cut from its smallest id.
void cut_cell(CellReader& reader, std::vector<Tetra>& out) {
  out.clear();
  const auto ids = reader.ids();
  const auto at = reader.at();
  size_t top = 0;
  for (size_t i = 1; i < ids.size(); ++i)
    if (ids[i] < ids[top]) top = i;
  for (size_t f = 0; f < reader.face_count(); ++f) {
    const auto face = reader.face(f);
    size_t least = 0;
    bool has_top = false;
    for (size_t i = 0; i < face.size(); ++i) {
      has_top |= face[i] == top;
      if (ids[face[i]] < ids[face[least]]) least = i;
    }
    if (has_top) continue;
    for (size_t i = 1; i + 1 < face.size(); ++i) {
      const size_t p = face[least], q = face[(least + i) % face.size()], r = face[(least + i + 1) % face.size()];
      out.push_back({{ids[top], ids[p], ids[q], ids[r]}, {at[top], at[p], at[q], at[r]}});
    }
  }
}

// The distance between eigenvalues of a sum changes by no more than sqrt(2) times the norm of what is added (Weyl): where the mean's differ
// by more than that of the corners from it, no combination of the corners has equal ones.
bool may_be_degenerate(std::span<const int64_t> ids, const std::vector<SymTensor>& d) {
  SymTensor mean;
  for (int64_t id : ids) mean = mean + d[size_t(id)];
  mean = (mean * (1 / double(ids.size()))).deviator();
  double most = 0;
  for (int64_t id : ids) most = std::max(most, (d[size_t(id)].deviator() - mean).norm());
  const Eigen3 e = eigen_of(mean);
  return !(std::min(e.value[0] - e.value[1], e.value[1] - e.value[2]) > 1.42 * most);
}

// Numbers in [-1, 1] that depend only on the point.
SymTensor noise(int64_t id) {
  double v[6];
  for (uint64_t k = 0; k < 6; ++k) v[k] = 2 * random_unit(0x7e2507, uint64_t(id) * 6 + k) - 1;
  return {v[0], v[1], v[2], v[3], v[4], v[5]};
}

// Direction of the line in a tetrahedron: across the gradients of the two conditions that hold on it.
Vec3 tangent_in(const Vec3 (&gradient)[6], Vec3 axis) {
  const Vec3 u = normalize(cross(axis, std::abs(axis.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0))), w = cross(axis, u);
  // Gradients of u T u - w T w and of u T w, from those of the components xx yy zz xy yz xz.
  const double same[6] = {u.x * u.x - w.x * w.x,       u.y * u.y - w.y * w.y,       u.z * u.z - w.z * w.z,
                          2 * (u.x * u.y - w.x * w.y), 2 * (u.y * u.z - w.y * w.z), 2 * (u.x * u.z - w.x * w.z)};
  const double mixed[6] = {u.x * w.x, u.y * w.y, u.z * w.z, u.x * w.y + u.y * w.x, u.y * w.z + u.z * w.y, u.x * w.z + u.z * w.x};
  Vec3 p, q;
  for (int c = 0; c < 6; ++c) p += gradient[c] * same[c], q += gradient[c] * mixed[c];
  return normalize(cross(p, q));
}

class TetraSearch {
 public:
  TetraSearch(const std::vector<SymTensor>& d, double min_gap) : d_(&d), min_gap_(min_gap) {}

  void run(const Tetra& t, Chunk& out) {
    points_.clear();
    for (int64_t id : t.id)
      if (!(*d_)[size_t(id)].finite()) return;
    const Vec3 u = t.at[1] - t.at[0], v = t.at[2] - t.at[0], w = t.at[3] - t.at[0];
    const double volume = dot(u, cross(v, w));
    if (volume == 0) return;
    for (int skip = 0; skip < 4; ++skip) on_face(t, skip);
    if (points_.size() < 2) {
      out.alone += points_.size();
      return;
    }
    const Vec3 slopes[3] = {cross(v, w) / volume, cross(w, u) / volume, cross(u, v) / volume};
    Vec3 gradient[6];
    for (int k = 0; k < 3; ++k) {
      const SymTensor e = (*d_)[size_t(t.id[k + 1])] - (*d_)[size_t(t.id[0])];
      const double c[6] = {e.xx, e.yy, e.zz, e.xy, e.yz, e.xz};
      for (int i = 0; i < 6; ++i) gradient[i] += slopes[k] * c[i];
    }
    for (FacePoint& p : points_) p.tangent = tangent_in(gradient, p.axis);
    join(out);
  }

 private:
  void on_face(const Tetra& t, int skip) {
    int k[3], n = 0;
    for (int i = 0; i < 4; ++i)
      if (i != skip) k[n++] = i;
    std::sort(k, k + 3, [&](int a, int b) { return t.id[a] < t.id[b]; });  // both neighbours compute the same
    places_.clear();
    const Key key{{t.id[k[0]], t.id[k[1]], t.id[k[2]]}, 0};
    degenerate_places((*d_)[size_t(key.face[0])], (*d_)[size_t(key.face[1])], (*d_)[size_t(key.face[2])], places_);
    for (size_t i = 0; i < places_.size(); ++i) {
      const DegeneratePlace& x = places_[i];
      if (std::abs(x.twice - x.once) < min_gap_) continue;
      FacePoint p{key,   t.at[k[0]] + (t.at[k[1]] - t.at[k[0]]) * x.s + (t.at[k[2]] - t.at[k[0]]) * x.t, x.axis, {}, x.planar, x.twice,
                  x.once};
      p.key.number = int(i);
      points_.push_back(p);
    }
  }

  // The pairs whose chords follow their tangents best, best first.
  void join(Chunk& out) {
    struct Pair {
      double cost;
      size_t a, b;
    };
    std::vector<Pair> pairs;
    for (size_t a = 0; a < points_.size(); ++a)
      for (size_t b = a + 1; b < points_.size(); ++b) {
        if (points_[a].planar != points_[b].planar) continue;
        const Vec3 chord = normalize(points_[b].at - points_[a].at);
        pairs.push_back({2 - std::abs(dot(chord, points_[a].tangent)) - std::abs(dot(chord, points_[b].tangent)), a, b});
      }
    std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& x, const Pair& y) { return x.cost < y.cost; });
    std::vector<uint8_t> used(points_.size());
    for (const Pair& p : pairs)
      if (!used[p.a] && !used[p.b]) used[p.a] = used[p.b] = 1, out.segments.push_back({points_[p.a], points_[p.b]});
    out.alone += size_t(std::count(used.begin(), used.end(), 0));
  }

  const std::vector<SymTensor>* d_;
  double min_gap_;
  std::vector<FacePoint> points_;
  std::vector<DegeneratePlace> places_;
};

// Segments that share points by their keys.
DatasetPtr as_mesh(const std::vector<Segment>& segments, const std::string& unit) {
  std::vector<Key> keys;
  for (const Segment& s : segments) keys.push_back(s.a.key), keys.push_back(s.b.key);
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  const size_t n = keys.size();
  std::vector<double> xyz(3 * n), twice(n), once(n), axis(3 * n), mode(n);
  std::vector<int64_t> ids;
  std::vector<int32_t> type;
  for (const Segment& s : segments) {
    for (const FacePoint* p : {&s.a, &s.b}) {
      const size_t i = size_t(std::lower_bound(keys.begin(), keys.end(), p->key) - keys.begin());
      for (int c = 0; c < 3; ++c) xyz[3 * i + size_t(c)] = p->at[c], axis[3 * i + size_t(c)] = p->axis[c];
      twice[i] = p->twice, once[i] = p->once, mode[i] = p->planar ? -1 : 1;
      ids.push_back(int64_t(i));
    }
    type.push_back(s.a.planar);
  }
  SurfaceMesh mesh;
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  if (!segments.empty()) mesh.lines.connectivity = Array::from_vector(std::move(ids)), mesh.lines.fixed = 2;
  FieldSet f;
  f.add({"type", Association::cell, Array::from_vector(std::move(type)), "", Role::labels});
  f.add({"mode", Association::point, Array::from_vector(std::move(mode)), "", Role::scalars});
  f.add({"eigenvalue", Association::point, Array::from_vector(std::move(twice)), unit, Role::none});
  f.add({"single eigenvalue", Association::point, Array::from_vector(std::move(once)), unit, Role::none});
  f.add({"axis", Association::point, Array::from_vector(std::move(axis), 3), "", Role::none});
  return make_dataset(mesh, std::move(f));
}

// Where eigenvalues are equal all over a surface, cells cut it into many lines that end or close after a few cells.
void tell_of_surfaces(const Dataset& lines, double diagonal, Context& ctx) {
  constexpr size_t many = 50;
  constexpr double little = 0.1;  // of the diagonal
  const Array& length = lines.fields().require("length").array;
  size_t pieces = 0;
  for (size_t l = 0; l < length.count(); ++l) pieces += length.get(l) < little * diagonal;
  if (pieces >= many && 2 * pieces >= length.count())
    ctx.warn(
        fmt::format("degenerate_lines: {} of {} lines are shorter than a tenth of the data: eigenvalues are equal on whole surfaces (as in "
                    "symmetric data), of which lines show only pieces",
                    pieces, length.count()));
}

}  // namespace

void describe(Schema& s, DegenerateLinesParams& p) {
  describe_tensors(s, p.tensors);
  s("perturb", p.perturb, "Perturbation of each tensor, as a share of its deviator, that moves lines off cell edges and corners; 0: none.")
      .range(0, 0.01);
  s("min_gap", p.min_gap, "Leave out points whose third eigenvalue differs by less than this share of the field's largest deviator.")
      .range(0, 1);
}

DatasetPtr degenerate_lines(const DatasetPtr& input, const DegenerateLinesParams& p, Context& ctx) {
  if (const int dimension = dimension_of_cells(input); dimension != 3)
    fail_usage(fmt::format("a mesh ({}) with cells of dimension {} has no degenerate lines", input->kind(), dimension), "degenerate_lines",
               dimension == 2 ? "use degenerate_points for flat meshes and surfaces" : "use a mesh of solid cells");
  // Curved cells in parts, as many as can be looked through in a moment, and three halvings at least.
  TessellateParams straight;
  while (straight.max_level > 3 && double(input->cell_count()) * std::pow(8.0, straight.max_level) > 100'000) --straight.max_level;
  const DatasetPtr in = tessellate(input, straight, ctx);
  TensorField t = read_point_tensors(in, p.tensors, "degenerate_lines", ctx);
  if (t.dimension != 3)
    fail_usage(fmt::format("'{}' holds 2D tensors on a mesh of solid cells", t.field.name), "degenerate_lines",
               "use tensors of 6 or 9 components");
  double largest = 0;
  for (const SymTensor& d : t.d)
    if (d.finite()) largest = std::max(largest, d.deviator().norm());
  if (p.perturb > 0)
    for (size_t i = 0; i < t.d.size(); ++i) t.d[i] = t.d[i] + noise(int64_t(i)) * (p.perturb * (t.d[i].deviator().norm() + 1e-3 * largest));
  const CellReader all_cells(in);
  constexpr size_t grain = 1024;
  std::vector<Chunk> chunks(all_cells.count() / grain + 1);
  parallel_for(
      all_cells.count(), grain,
      [&](size_t begin, size_t end) {
        CellReader reader = all_cells;
        TetraSearch search(t.d, p.min_gap * largest);
        std::vector<Tetra> tetras;
        for (size_t c = begin; c < end; ++c) {
          if (reader.hidden(c)) continue;
          reader.open(c);
          if (reader.dimension() != 3 || !may_be_degenerate(reader.ids(), t.d)) continue;
          cut_cell(reader, tetras);
          for (const Tetra& x : tetras) search.run(x, chunks[begin / grain]);
        }
      },
      &ctx);
  std::vector<Segment> segments;
  size_t alone = 0;
  for (const Chunk& c : chunks) segments.insert(segments.end(), c.segments.begin(), c.segments.end()), alone += c.alone;
  if (alone > 0) ctx.info(fmt::format("degenerate_lines: {} points on faces have no partner in their tetrahedron; lines end there", alone));
  const DatasetPtr parts = as_mesh(segments, t.field.unit);
  if (segments.empty()) return parts;
  PolylinesParams joined;
  joined.fields = {"type"};
  const DatasetPtr lines = polylines(parts, joined, ctx);
  tell_of_surfaces(*lines, in->bounds().diagonal(), ctx);
  return lines;
}

}  // namespace sg
