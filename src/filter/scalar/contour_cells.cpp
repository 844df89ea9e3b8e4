// SPDX-License-Identifier: Apache-2.0
// Contours of unstructured and surface meshes, cell by cell. A cut edge is known by its two point numbers, so that cells of
// different kinds share it; the numbers are sorted afterwards to count each edge once.
#include <bit>
#include <cmath>
#include <map>

#include "base/parallel.h"
#include "filter/field/gradient_cells.h"
#include "filter/scalar/cell_cases.h"
#include "filter/scalar/contour_parts.h"

namespace sg::contouring {

namespace {

uint64_t edge_key(int64_t a, int64_t b) { return a < b ? uint64_t(a) << 32 | uint64_t(b) : uint64_t(b) << 32 | uint64_t(a); }

struct Found {
  std::vector<uint64_t> lines, triangles;
  std::vector<uint32_t> line_cells, triangle_cells;
};

struct Finder {
  const Job& job;
  const Points& points;
  double value;
  Sample f{job.samples};
  View<uint8_t> point_ghost = job.input.point_ghost().empty() ? View<uint8_t>{} : job.input.point_ghost().view<uint8_t>();
  View<uint8_t> cell_ghost = job.input.cell_ghost().empty() ? View<uint8_t>{} : job.input.cell_ghost().view<uint8_t>();

  bool skipped(size_t cell) const { return cell_ghost.count && (cell_ghost[cell] & (ghost_duplicate | ghost_refined_cell | ghost_hidden_cell)); }
  bool bad(int64_t p) const { return std::isnan(f(size_t(p))) || (point_ghost.count && (point_ghost[size_t(p)] & ghost_hidden_point)); }

  // Six times the volume when the faces, as listed, turn outwards; negative for a mirrored cell.
  double volume(const CellShape& shape, const CellsView& cells, size_t cell) const {
    const Vec3 base = points.at(size_t(cells.point(cell, 0)));
    auto at = [&](uint8_t c) { return points.at(size_t(cells.point(cell, c))) - base; };
    double v = 0;
    for (const auto& face : shape.faces)
      for (size_t k = 1; k + 1 < face.size(); ++k) v += dot(at(face[0]), cross(at(face[k]), at(face[k + 1])));
    return v;
  }

  void solid(const CaseTable& table, const CellsView& cells, size_t cell, Found& out) const {
    const CellShape& shape = table.shape();
    std::array<int64_t, 16> p;
    uint32_t any = 0, every = 1;
    for (size_t c = 0; c < size_t(shape.corners); ++c) {
      p[c] = cells.point(cell, c);
      const uint32_t in = f(size_t(p[c])) >= value;
      any |= in, every &= in;
    }
    if (!any || every) return;
    // The rules for segments and diagonals look at cells from outside, so mirrored ones are turned into proper ones.
    if (volume(shape, cells, cell) < 0)
      for (size_t c = 0; c < size_t(shape.corners); ++c) p[c] = cells.point(cell, shape.mirror[c]);
    uint32_t pattern = 0;
    for (int c = 0; c < shape.corners; ++c) {
      if (bad(p[size_t(c)])) return;
      pattern |= uint32_t(f(size_t(p[size_t(c)])) >= value) << c;
    }
    uint32_t joined = 0;
    for (uint32_t m = table.ambiguous(pattern); m; m &= m - 1) {
      const auto& face = shape.faces[size_t(std::countr_zero(m))];
      double v[4];
      for (size_t c = 0; c < 4; ++c) v[c] = f(size_t(p[face[c]])) - value;
      joined |= uint32_t(joined_inside(v[0], v[1], v[2], v[3])) << std::countr_zero(m);
    }
    const auto edges = table.triangles(pattern, joined);
    for (uint8_t e : edges) out.triangles.push_back(edge_key(p[shape.edges[e][0]], p[shape.edges[e][1]]));
    out.triangle_cells.insert(out.triangle_cells.end(), edges.size() / 3, uint32_t(cell));
  }

  // A polygon: a line from where the boundary leaves the inside to where it came in, so that the inside lies on the left.
  void polygon(std::span<const int64_t> p, size_t number, Found& out) const {
    const size_t n = p.size();
    bool any = false, every = true;
    for (int64_t q : p) {
      const bool in = f(size_t(q)) >= value;
      any = any || in, every = every && in;
    }
    if (!any || every) return;
    for (int64_t q : p)
      if (bad(q)) return;
    auto in = [&](size_t k) { return f(size_t(p[k % n])) >= value; };
    size_t start = 0;
    while (in(start) || !in(start + 1)) ++start;
    uint64_t first_entry = 0, entry = 0, exit = 0;
    const bool four = n == 4 && in(0) == in(2) && in(1) == in(3);
    const bool join = four && joined_inside(f(size_t(p[0])) - value, f(size_t(p[1])) - value, f(size_t(p[2])) - value, f(size_t(p[3])) - value);
    auto line = [&](uint64_t a, uint64_t b) {
      out.lines.push_back(a), out.lines.push_back(b);
      out.line_cells.push_back(uint32_t(number));
    };
    for (size_t s = 0; s < n; ++s) {
      const size_t k = start + s;
      const uint64_t key = edge_key(p[k % n], p[(k + 1) % n]);
      if (!in(k) && in(k + 1)) {
        entry = key;
        if (s == 0) first_entry = key;
        else if (join) line(exit, entry);
      } else if (in(k) && !in(k + 1)) {
        exit = key;
        if (!join) line(exit, entry);
      }
    }
    if (join) line(exit, first_entry);
  }
};

// A polyhedron of any faces: the rules of cell_cases.h, worked out on the spot.
class PolyhedronCut {
 public:
  PolyhedronCut(const Finder& finder, const UnstructuredMesh& m, size_t cell) : finder_(finder), cell_(cell) {
    const CellsView faces = cells_view(m.faces);
    const auto of_cell = m.polyhedron_faces.view<int64_t>();
    for (size_t f = size_t(of_cell[cell]); f < size_t(of_cell[cell + 1]); ++f) {
      auto& face = faces_.emplace_back(faces.size(f));
      for (size_t k = 0; k < face.size(); ++k) face[k] = faces.point(f, k);
    }
  }

  void run(Found& out) {
    turn_outwards();
    for (size_t f = 0; f < faces_.size(); ++f) segments(f);
    while (!next_.empty()) {
      std::vector<uint64_t> loop;
      for (auto at = next_.begin(); at != next_.end(); at = next_.find(loop.back())) {
        if (loop.empty()) loop.push_back(at->first);
        loop.push_back(at->second.first);
        step_[at->first] = at->second;
        next_.erase(at);
      }
      if (loop.size() < 4 || loop.front() != loop.back()) continue;  // faces that do not close: no surface rather than a wrong one
      loop.pop_back();
      fill(loop, out);
    }
  }

 private:
  static uint64_t key(const std::vector<int64_t>& face, size_t k) { return edge_key(face[k], face[(k + 1) % face.size()]); }

  // Files promise outward faces but do not all keep it: make neighbours agree, then look at the volume.
  void turn_outwards() {
    std::map<uint64_t, std::vector<size_t>> at_edge;
    for (size_t f = 0; f < faces_.size(); ++f)
      for (size_t k = 0; k < faces_[f].size(); ++k) at_edge[key(faces_[f], k)].push_back(f);
    auto forward = [&](size_t f, uint64_t edge) {
      for (size_t k = 0; k < faces_[f].size(); ++k)
        if (key(faces_[f], k) == edge) return faces_[f][k] == int64_t(edge >> 32);
      return false;
    };
    std::vector<char> seen(faces_.size());
    for (size_t first = 0; first < faces_.size(); ++first) {
      std::vector<size_t> todo;
      if (!seen[first]) todo.push_back(first), seen[first] = 1;
      while (!todo.empty()) {
        const size_t f = todo.back();
        todo.pop_back();
        for (size_t k = 0; k < faces_[f].size(); ++k) {
          const uint64_t edge = key(faces_[f], k);
          for (size_t g : at_edge[edge]) {
            if (seen[g]) continue;
            if (forward(f, edge) == forward(g, edge)) std::reverse(faces_[g].begin(), faces_[g].end());
            seen[g] = 1;
            todo.push_back(g);
          }
        }
      }
    }
    double volume = 0;
    if (faces_.empty() || faces_[0].empty()) return;
    const Vec3 base = finder_.points.at(size_t(faces_[0][0]));
    auto place = [&](int64_t p) { return finder_.points.at(size_t(p)) - base; };
    for (const auto& face : faces_)
      for (size_t k = 1; k + 1 < face.size(); ++k) volume += dot(place(face[0]), cross(place(face[k]), place(face[k + 1])));
    if (volume < 0)
      for (auto& face : faces_) std::reverse(face.begin(), face.end());
  }

  void segments(size_t f) {
    const auto& p = faces_[f];
    const size_t n = p.size();
    auto value = [&](size_t k) { return finder_.f(size_t(p[k % n])) - finder_.value; };
    for (size_t k = 0; k < n; ++k) edge_faces_[key(p, k)].push_back(f);
    std::vector<uint64_t> entry, exit;
    size_t start = 0;
    while (start < n && !(value(start) < 0 && value(start + 1) >= 0)) ++start;
    if (start == n) return;
    for (size_t s = 0; s < n; ++s) {
      const size_t k = (start + s) % n;
      const bool a = value(k) >= 0, b = value(k + 1) >= 0;
      if (!a && b) entry.push_back(key(p, k));
      if (a && !b) exit.push_back(key(p, k));
    }
    const bool join = n == 4 && entry.size() == 2 && joined_inside(value(0), value(1), value(2), value(3));
    for (size_t r = 0; r < entry.size(); ++r) next_[entry[join ? (r + 1) % entry.size() : r]] = {exit[r], f};
  }

  void fill(const std::vector<uint64_t>& loop, Found& out) const {
    const size_t n = loop.size();
    std::vector<Vec3> middle;
    Box3 box;
    for (uint64_t e : loop) {
      middle.push_back((finder_.points.at(e >> 32) + finder_.points.at(uint32_t(e))) * 0.5);
      box.add(middle.back());
    }
    const double unit = 1 / std::max(dot(box.size(), box.size()), 1e-300);
    auto cost = [&](size_t a, size_t b) {
      const Vec3 d = middle[a] - middle[b];
      double c = dot(d, d) * unit;
      for (size_t f : edge_faces_.at(loop[a]))
        for (size_t g : edge_faces_.at(loop[b]))
          if (f == g) c += face_penalty(step_.at(loop[a]).second == f && step_.at(loop[b]).second == f);
      return c;
    };
    for (const auto& t : fill_loop(n, cost)) {
      for (uint32_t k : t) out.triangles.push_back(loop[k]);
      out.triangle_cells.push_back(uint32_t(cell_));
    }
  }

  const Finder& finder_;
  size_t cell_;
  std::vector<std::vector<int64_t>> faces_;
  std::map<uint64_t, std::pair<uint64_t, size_t>> next_, step_;  // entry edge -> exit edge and the face between
  std::map<uint64_t, std::vector<size_t>> edge_faces_;
};

template <class Each>
Found find(size_t n, const Context& context, Each&& each) {
  constexpr size_t grain = 4096;
  std::vector<Found> parts((n + grain - 1) / grain);
  parallel_for(n, grain, [&](size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c) each(c, parts[begin / grain]);
  }, &context);
  Found all;
  auto join = [&](auto member) {
    size_t size = 0;
    for (const Found& p : parts) size += (p.*member).size();
    (all.*member).reserve(size);
    for (const Found& p : parts) (all.*member).insert((all.*member).end(), (p.*member).begin(), (p.*member).end());
  };
  join(&Found::lines), join(&Found::triangles), join(&Found::line_cells), join(&Found::triangle_cells);
  return all;
}

[[noreturn]] void unsupported(const UnstructuredMesh& m, size_t cell) {
  fail_usage(fmt::format("cell {} is a {}; only linear cells can be contoured", cell, cell_type_info(m.type(cell)).name), "contour",
             "split the mesh into linear cells first");
}

Found find_cells(const Finder& finder, const UnstructuredMesh& m) {
  const CellsView cells = cells_view(m.cells);
  return find(cells.count, finder.job.context, [&](size_t c, Found& out) {
    if (finder.skipped(c)) return;
    const CellType type = m.type(c);
    if (const CaseTable* table = cell_cases(type)) return finder.solid(*table, cells, c, out);
    const CellTypeInfo& info = cell_type_info(type);
    if (info.dimension < 2) return;
    const size_t n = cells.size(c), b = cells.begin(c);
    auto p = [&](size_t k) { return cells.connectivity[b + k]; };
    if (type == CellType::pixel) {
      const int64_t around[4] = {p(0), p(1), p(3), p(2)};
      finder.polygon(around, c, out);
    } else if (type == CellType::triangle_strip) {
      for (size_t k = 0; k + 2 < n; ++k) {
        const int64_t around[3] = {p(k), p(k + 1 + k % 2), p(k + 2 - k % 2)};
        finder.polygon(around, c, out);
      }
    } else if (type == CellType::triangle || type == CellType::quad || type == CellType::polygon) {
      std::vector<int64_t> around(n);
      for (size_t k = 0; k < n; ++k) around[k] = p(k);
      finder.polygon(around, c, out);
    } else if (type == CellType::polyhedron) {
      bool any = false, every = true, good = true;
      for (size_t k = 0; k < n; ++k) {
        const bool in = finder.f(size_t(p(k))) >= finder.value;
        any = any || in, every = every && in, good = good && !finder.bad(p(k));
      }
      if (any && !every && good) PolyhedronCut(finder, m, c).run(out);
    } else {
      unsupported(m, c);
    }
  });
}

Found find_cells(const Finder& finder, const SurfaceMesh& m) {
  const CellsView polygons = cells_view(m.polygons), strips = cells_view(m.strips);
  const size_t before = m.vertices.size() + m.lines.size();
  return find(polygons.count + strips.count, finder.job.context, [&](size_t c, Found& out) {
    if (finder.skipped(before + c)) return;
    const bool strip = c >= polygons.count;
    const CellsView& cells = strip ? strips : polygons;
    const size_t cell = strip ? c - polygons.count : c, n = cells.size(cell);
    std::vector<int64_t> p(n);
    for (size_t k = 0; k < n; ++k) p[k] = cells.point(cell, k);
    if (!strip) return finder.polygon(p, before + c, out);
    for (size_t k = 0; k + 2 < n; ++k) {
      const int64_t around[3] = {p[k], p[k + 1 + k % 2], p[k + 2 - k % 2]};
      finder.polygon(around, before + c, out);
    }
  });
}

// Distinct edges in order of their point numbers, by buckets of the lower one.
class EdgeNumbers {
 public:
  EdgeNumbers(size_t points, const Found& found) : start_(points + 1, 0) {
    for (const auto* keys : {&found.lines, &found.triangles})
      for (uint64_t k : *keys) ++start_[k >> 32];
    exclusive_scan(start_);
    std::vector<uint32_t> other(start_.back());
    std::vector<size_t> next(start_.begin(), start_.end() - 1);
    for (const auto* keys : {&found.lines, &found.triangles})
      for (uint64_t k : *keys) other[next[k >> 32]++] = uint32_t(k);
    std::vector<size_t> count(points + 1, 0);
    parallel_for(points, 1 << 14, [&](size_t begin, size_t end) {
      for (size_t p = begin; p < end; ++p) {
        const auto b = other.begin() + ptrdiff_t(start_[p]), e = other.begin() + ptrdiff_t(start_[p + 1]);
        std::sort(b, e);
        count[p] = size_t(std::unique(b, e) - b);
      }
    });
    std::vector<size_t> first = count;
    exclusive_scan(first);
    other_.resize(first.back());
    parallel_for(points, 1 << 14, [&](size_t begin, size_t end) {
      for (size_t p = begin; p < end; ++p) std::copy_n(other.begin() + ptrdiff_t(start_[p]), count[p], other_.begin() + ptrdiff_t(first[p]));
    });
    start_ = std::move(first);
  }
  size_t size() const { return other_.size(); }
  int32_t operator()(uint64_t key) const {
    size_t i = start_[key >> 32];
    while (other_[i] != uint32_t(key)) ++i;
    return int32_t(i);
  }
  template <class F>
  void each(F&& f) const {  // f(vertex, a, b), in parallel
    parallel_for(start_.size() - 1, 1 << 14, [&](size_t begin, size_t end) {
      for (size_t p = begin; p < end; ++p)
        for (size_t i = start_[p]; i < start_[p + 1]; ++i) f(i, uint32_t(p), other_[i]);
    });
  }

 private:
  std::vector<size_t> start_;
  std::vector<uint32_t> other_;
};

Array make_normals(const Job& job, const Block<EdgePoint>& edges) {
  std::vector<uint32_t> points;
  std::vector<uint32_t> slot(job.input.point_count(), UINT32_MAX);
  for (size_t i = 0; i < edges.count; ++i)
    for (uint32_t p : {edges.data[i].a, edges.data[i].b})
      if (slot[p] == UINT32_MAX) {
        slot[p] = uint32_t(points.size());
        points.push_back(p);
      }
  std::vector<double> g(points.size() * 3);
  least_squares_gradients(job.input, points, job.samples.converted(ElementType::f64), g.data(), job.context);
  float* out = nullptr;
  Array normals = Array::make<float>(edges.count, 3, &out);
  for (size_t i = 0; i < edges.count; ++i) {
    const EdgePoint e = edges.data[i];
    const double *a = &g[3 * slot[e.a]], *b = &g[3 * slot[e.b]], t = double(e.t);
    const Vec3 n = Vec3(a[0], a[1], a[2]) * (1 - t) + Vec3(b[0], b[1], b[2]) * t;
    const double size = length(n);
    for (int c = 0; c < 3; ++c) out[3 * i + size_t(c)] = size > 0 && std::isfinite(size) ? float(-n[c] / size) : 0.0f;
  }
  return normals;
}

Block<uint32_t> cell_block(const std::vector<uint32_t>& v) {
  Block<uint32_t> b;
  b.allocate(v.size());
  std::copy(v.begin(), v.end(), b.data);
  return b;
}

}  // namespace

Piece contour_cells(const Job& job, double value) {
  const auto* mesh = job.input.as<UnstructuredMesh>();
  const Points& points = mesh ? mesh->points : job.input.as<SurfaceMesh>()->points;
  const Finder finder{job, points, value};
  const Found found = mesh ? find_cells(finder, *mesh) : find_cells(finder, *job.input.as<SurfaceMesh>());
  const EdgeNumbers numbers(points.count(), found);
  if (numbers.size() > size_t(INT32_MAX)) fail_usage("the surface has more than 2^31 points", "contour", "contour a part of the mesh at a time");

  Piece piece;
  float* xyz = nullptr;
  piece.xyz = Array::make<float>(numbers.size(), 3, &xyz);
  piece.points.allocate(numbers.size());
  numbers.each([&](size_t v, uint32_t a, uint32_t b) {
    const double t = crossing(value, finder.f(a), finder.f(b));
    piece.points.data[v] = {a, b, float(t)};
    const Vec3 from = points.at(a) - job.origin, to = points.at(b) - job.origin;
    const Vec3 x = from + (to - from) * t;
    for (int c = 0; c < 3; ++c) xyz[3 * v + size_t(c)] = float(x[c]);
  });
  auto connect = [&](const std::vector<uint64_t>& keys) {
    int32_t* out = nullptr;
    Array a = Array::make<int32_t>(keys.size(), 1, &out);
    parallel_for(keys.size(), 1 << 15, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) out[i] = numbers(keys[i]);
    });
    return a;
  };
  piece.lines = connect(found.lines);
  piece.triangles = connect(found.triangles);
  piece.line_cells = cell_block(found.line_cells);
  piece.triangle_cells = cell_block(found.triangle_cells);
  if (job.normals && !found.triangles.empty()) piece.normals = make_normals(job, piece.points);
  return piece;
}

}  // namespace sg::contouring
