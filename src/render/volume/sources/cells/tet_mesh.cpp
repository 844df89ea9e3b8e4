// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/cells/tet_mesh.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cells/cell_neighbors.h"
#include "data/cells/point_positions.h"

namespace sg::volume {

namespace {

constexpr size_t tets_per_chunk = 4096;
constexpr uint32_t middle_bit = 0x80000000u;  // vertex is the middle of a polyhedron, numbered in its chunk
constexpr size_t most_tets = size_t(1) << 29, most_points = size_t(1) << 30;

using Tet = std::array<uint32_t, 4>;

/// The tetrahedra of some cells in a row.
struct Part {
  std::vector<Tet> tets;
  std::vector<uint32_t> cells;
  std::vector<Vec3> middles;
  std::vector<uint32_t> middle_of;
  size_t solid = 0;  // cells, drawn or not
  bool all_tets = true;
};

constexpr double thin = 1e-4, flat = 1e-9;
constexpr size_t most_ring = 64;

/// Twice the area by the square of the longest side; negative when it is seen from behind. NaN counts as the worst.
double roundness(Vec3 a, Vec3 b, Vec3 c, Vec3 normal) {
  const Vec3 n = cross(b - a, c - a);
  const double side = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
  const double q = side > 0 ? length(n) / side : 0;
  return !(q == q) ? -1 : dot(n, normal) < 0 ? -q : q;
}

/// Cuts a polygon so that its worst triangle is as good as can be (Klincsek 1980). Corners amid straight sides, where smaller neighbours
/// hang, then make no flat triangle: all cells around such a side would make the same one, and nothing told which of them belong together.
void best_triangles(const std::vector<Vec3>& p, std::vector<uint32_t>& out) {
  const size_t n = p.size();
  Vec3 normal;
  for (size_t k = 1; k + 1 < n; ++k) normal += cross(p[k] - p[0], p[k + 1] - p[0]);
  // Of the polygon from corner i to j: its worst triangle, and the third corner of the one at the side i j.
  std::vector<double> worst(n * n, HUGE_VAL);
  std::vector<uint32_t> third(n * n);
  for (size_t span = 2; span < n; ++span)
    for (size_t i = 0; i + span < n; ++i) {
      const size_t j = i + span;
      double best = -HUGE_VAL;
      for (size_t k = i + 1; k < j; ++k) {
        const double q = std::min({roundness(p[i], p[k], p[j], normal), worst[i * n + k], worst[k * n + j]});
        if (q > best) best = q, third[i * n + j] = uint32_t(k);
      }
      worst[i * n + j] = best;
    }
  std::vector<std::pair<uint32_t, uint32_t>> open{{0, uint32_t(n - 1)}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i < 2) continue;
    const uint32_t k = third[i * n + j];
    out.insert(out.end(), {i, k, j});
    open.push_back({i, k}), open.push_back({k, j});
  }
}

class Cutter {
 public:
  Cutter(CellReader& reader, Part& part) : reader_(reader), part_(part) {}

  /// The open cell.
  void cut() {
    const auto ids = reader_.ids();
    if (reader_.type() == CellType::tetra) return add(uint32_t(ids[0]), uint32_t(ids[1]), uint32_t(ids[2]), uint32_t(ids[3]));
    part_.all_tets = false;
    if (is_high_order(reader_.type()))
      fail_usage("curved cells cannot be clipped directly", "volume", "convert them to linear cells: -f tessellate");
    if (const LinearTopology* shape = linear_topology(reader_.type())) {
      const int64_t lowest = *std::min_element(ids.begin(), ids.end());
      for (size_t f = 0; f < shape->face_count(); ++f) {
        ring_.clear();
        for (uint8_t k : shape->face(f)) ring_.push_back(k);
        if (std::none_of(ring_.begin(), ring_.end(), [&](uint32_t k) { return ids[k] == lowest; })) fan(uint32_t(lowest));
      }
      return;
    }
    const auto middle = uint32_t(part_.middles.size());
    Vec3 sum;
    for (Vec3 p : reader_.at()) sum += p;
    part_.middles.push_back(sum / double(std::max<size_t>(ids.size(), 1)));
    part_.middle_of.push_back(uint32_t(reader_.cell()));
    for (size_t f = 0, n = reader_.face_count(); f < n; ++f) {
      const auto face = reader_.face(f);
      ring_.assign(face.begin(), face.end());
      if (ring_.size() >= 3) fan(middle | middle_bit);
    }
  }

 private:
  void add(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    Tet t{a, b, c, d};
    std::sort(t.begin(), t.end());
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[3]) return;
    part_.tets.push_back(t), part_.cells.push_back(uint32_t(reader_.cell()));
  }

  /// From the apex to the triangles of the face in ring_: seen from its lowest id, towards the lower neighbour, so that both cells agree.
  void fan(uint32_t apex) {
    const auto ids = reader_.ids();
    const auto at = reader_.at();
    const auto id = [&](size_t k) { return uint32_t(ids[ring_[k]]); };
    std::rotate(ring_.begin(), std::min_element(ring_.begin(), ring_.end(), [&](uint32_t a, uint32_t b) { return ids[a] < ids[b]; }),
                ring_.end());
    if (ids[ring_.back()] < ids[ring_[1]]) std::reverse(ring_.begin() + 1, ring_.end());
    const bool fixed_shape = linear_topology(reader_.type()) != nullptr;
    bool fits = true;
    if (ring_.size() > 4 || (ring_.size() == 4 && !fixed_shape)) {
      Vec3 normal;
      for (size_t k = 1; k + 1 < ring_.size(); ++k) normal += cross(at[ring_[k]] - at[ring_[0]], at[ring_[k + 1]] - at[ring_[0]]);
      points_.clear();
      for (uint32_t k : ring_) points_.push_back(at[k]);
      // Quadrangles may be those of cells of fixed shape: they keep the fan as long as it has no flat triangle.
      const double least = ring_.size() > 4 ? thin : -HUGE_VAL;
      for (size_t k = 1; k + 1 < ring_.size(); ++k) {
        const double q = roundness(points_[0], points_[k], points_[k + 1], normal);
        fits = fits && q >= least && std::abs(q) >= flat;
      }
    }
    if (fits) {
      for (size_t k = 1; k + 1 < ring_.size(); ++k) add(apex, id(0), id(k), id(k + 1));
      return;
    }
    local_.clear();
    if (points_.size() <= most_ring) best_triangles(points_, local_);
    else triangulate_polygon(points_, local_);
    for (size_t k = 0; k + 2 < local_.size(); k += 3) add(apex, id(local_[k]), id(local_[k + 1]), id(local_[k + 2]));
  }

  CellReader& reader_;
  Part& part_;
  std::vector<uint32_t> ring_, local_;
  std::vector<Vec3> points_;
};

std::vector<Part> cut_cells(const DatasetPtr& dataset, const std::function<bool(const CellReader&)>& draws, Context& context) {
  const CellReader shared(dataset);
  const size_t n = dataset->cell_count();
  std::vector<Part> parts((n + tets_per_chunk - 1) / tets_per_chunk);
  parallel_for(
      n, tets_per_chunk,
      [&](size_t begin, size_t end) {
        CellReader reader = shared;
        Part& part = parts[begin / tets_per_chunk];
        Cutter cutter(reader, part);
        for (size_t c = begin; c < end; ++c) {
          reader.open(c);
          if (reader.dimension() != 3) continue;
          ++part.solid;
          if (!reader.hidden(c) && draws(reader)) cutter.cut();
        }
        if (part.tets.size() != end - begin) part.all_tets = false;
      },
      &context);
  return parts;
}

void join(std::vector<Part>& parts, const Array& positions, TetMesh& mesh, Context& context) {
  std::vector<size_t> tets, middles;
  for (const Part& p : parts) tets.push_back(p.tets.size()), middles.push_back(p.middles.size());
  const size_t total = exclusive_scan(tets), more = exclusive_scan(middles);
  mesh.points = positions.count();
  if (total > most_tets || mesh.points + more > most_points)
    fail_usage(fmt::format("{} tetrahedra with {} vertices are too many to show as a volume", total, mesh.points + more), "volume",
               "crop the mesh, or resample it to a grid");
  mesh.all_tets = std::all_of(parts.begin(), parts.end(), [](const Part& p) { return p.all_tets; });
  mesh.corners.resize(total);
  if (!mesh.all_tets) mesh.cells.resize(total);
  mesh.at.resize(mesh.points + more);
  mesh.middle_of.resize(more);
  const View<double> xyz = positions.view<double>();
  parallel_for(
      mesh.points, 65536,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) mesh.at[i] = Vec3(xyz(i, 0), xyz(i, 1), xyz(i, 2)) - mesh.origin;
      },
      &context);
  parallel_for(parts.size(), 1, [&](size_t begin, size_t) {
    Part& p = parts[begin];
    for (size_t k = 0; k < p.middles.size(); ++k) {
      mesh.at[mesh.points + middles[begin] + k] = p.middles[k] - mesh.origin;
      mesh.middle_of[middles[begin] + k] = p.middle_of[k];
    }
    for (size_t k = 0; k < p.tets.size(); ++k) {
      Tet t = p.tets[k];
      if (t[3] & middle_bit) t[3] = uint32_t(mesh.points + middles[begin] + (t[3] & ~middle_bit));
      mesh.corners[tets[begin] + k] = t;
      if (!mesh.all_tets) mesh.cells[tets[begin] + k] = p.cells[k];
    }
    p = {};
  });
}

/// The corners that face f of a tetrahedron lacks.
std::array<int, 4> opposite_corners() {
  const LinearTopology& shape = *linear_topology(CellType::tetra);
  std::array<int, 4> r{};
  for (size_t f = 0; f < 4; ++f) {
    r[f] = 6;
    for (uint8_t k : shape.face(f)) r[f] -= k;
  }
  return r;
}

void link(TetMesh& mesh, Context& context) {
  const size_t n = mesh.corners.size();
  mesh.links.resize(n);
  if (n == 0) return;
  UnstructuredMesh tets;
  tets.points.xyz = Array(Buffer{}, ElementType::f32, 0, 3);
  tets.cells.fixed = 4;
  tets.cells.connectivity =
      Array(Buffer{nullptr, reinterpret_cast<const std::byte*>(mesh.corners.data()), n * sizeof(Tet)}, ElementType::i32, 4 * n);
  tets.single_type = CellType::tetra;
  const CellNeighbors across = cell_neighbors(tets, &context);
  const std::array<int, 4> opposite = opposite_corners();
  std::vector<std::vector<TetMesh::Face>> faces((n + tets_per_chunk - 1) / tets_per_chunk);
  parallel_for(
      n, tets_per_chunk,
      [&](size_t begin, size_t end) {
        auto& open = faces[begin / tets_per_chunk];
        for (size_t t = begin; t < end; ++t) {
          const Tet& v = mesh.corners[t];
          TetLink& l = mesh.links[t];
          l.all = v[0] ^ v[1] ^ v[2] ^ v[3];
          for (size_t f = 0; f < 4; ++f) {
            const auto k = size_t(opposite[f]);
            // Where three cells meet at a face, two of them are neighbours and the third ends there, although it may be the neighbour of
            // one of them across another face: a walk that goes back another way than it came could go round for ever.
            int64_t other = across(t, f);
            if (other >= 0) {
              const Tet& o = mesh.corners[size_t(other)];
              const uint32_t apex = o[0] ^ o[1] ^ o[2] ^ o[3] ^ l.all ^ v[k];
              bool mutual = false;
              for (size_t g = 0; g < 4; ++g) mutual = mutual || (o[size_t(opposite[g])] == apex && across(size_t(other), g) == int64_t(t));
              if (!mutual) other = -1;
            }
            l.next[k] = int32_t(other);
            if (other >= 0) continue;
            TetMesh::Face face{{}, v[k], uint32_t(t)};
            for (size_t i = 0, m = 0; i < 4; ++i)
              if (i != k) face.v[m++] = v[i];
            open.push_back(face);
          }
        }
      },
      &context);
  for (const auto& f : faces) mesh.boundary.insert(mesh.boundary.end(), f.begin(), f.end());
}

void measure(TetMesh& mesh) {
  struct Sum {
    Box3 box;
    double volume = 0;
  };
  const Sum sum = parallel_reduce(
      mesh.size(), 16384, Sum{},
      [&](size_t begin, size_t end) {
        Sum s;
        for (size_t t = begin; t < end; ++t) {
          Vec3 p[4];
          for (size_t k = 0; k < 4; ++k) p[k] = mesh.at[mesh.corners[t][k]], s.box.add(p[k]);
          s.volume += std::abs(dot(p[1] - p[0], cross(p[2] - p[0], p[3] - p[0]))) / 6;
        }
        return s;
      },
      [](Sum a, const Sum& b) { return a.box.add(b.box), a.volume += b.volume, a; });
  if (sum.box.empty()) return;
  mesh.bounds.add(sum.box.lo + mesh.origin), mesh.bounds.add(sum.box.hi + mesh.origin);
  size_t cells = mesh.size();
  for (size_t t = 1; t < mesh.cells.size(); ++t) cells -= mesh.cells[t] == mesh.cells[t - 1];
  mesh.edge = std::cbrt(2 * sum.volume / double(std::max<size_t>(cells, 1)));
}

}  // namespace

size_t TetMesh::bytes() const {
  return at.size() * sizeof(Vec3) + corners.size() * (sizeof(Tet) + sizeof(TetLink)) + cells.size() * 4 + boundary.size() * sizeof(Face) +
         (tree ? tree->bytes() : 0);
}

TetMesh make_tet_mesh(const DatasetPtr& dataset, const std::function<bool(const CellReader&)>& draws, Context& context) {
  if (dataset->point_count() > most_points || dataset->cell_count() > most_tets)
    fail_usage("the mesh is too large to show as a volume", "volume", "crop it, or resample it to a grid");
  std::vector<Part> parts = cut_cells(dataset, draws, context);
  if (std::all_of(parts.begin(), parts.end(), [](const Part& p) { return p.solid == 0; }))
    fail_usage(fmt::format("the {} mesh has no solid cells to show as a volume", dataset->kind()), "volume",
               "show its surface instead: --show surface");
  TetMesh mesh;
  const Box3& box = dataset->bounds();
  if (!box.empty()) mesh.origin = box.center();
  join(parts, point_positions(dataset->mesh()), mesh, context);
  link(mesh, context);
  measure(mesh);
  std::vector<Box3> boxes(mesh.boundary.size());
  for (size_t f = 0; f < boxes.size(); ++f)
    for (uint32_t v : mesh.boundary[f].v) boxes[f].add(mesh.at[v] + mesh.origin);
  mesh.tree.emplace(boxes, context);
  return mesh;
}

}  // namespace sg::volume
