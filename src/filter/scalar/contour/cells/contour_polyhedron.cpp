// SPDX-License-Identifier: Apache-2.0
#include <map>

#include "filter/scalar/contour/contour_finder.h"

namespace sg::contouring {

namespace {

uint64_t key_of(const std::vector<int64_t>& face, size_t k) { return edge_key(face[k], face[(k + 1) % face.size()]); }

// Each edge once in both directions?
bool turn_together(const PolyhedronFaces& faces) {
  thread_local std::vector<std::pair<uint64_t, int>> edges;
  edges.clear();
  for (const auto& face : faces)
    for (size_t k = 0; k < face.size(); ++k) edges.emplace_back(key_of(face, k), face[k] < face[(k + 1) % face.size()]);
  std::sort(edges.begin(), edges.end());
  if (edges.size() % 2) return false;
  for (size_t i = 0; i < edges.size(); i += 2)
    if (edges[i].first != edges[i + 1].first || edges[i].second == edges[i + 1].second) return false;
  return true;
}

// Makes neighbours agree.
void turn_alike(PolyhedronFaces& faces) {
  std::map<uint64_t, std::vector<size_t>> at_edge;
  for (size_t f = 0; f < faces.size(); ++f)
    for (size_t k = 0; k < faces[f].size(); ++k) at_edge[key_of(faces[f], k)].push_back(f);
  auto forward = [&](size_t f, uint64_t edge) {
    for (size_t k = 0; k < faces[f].size(); ++k)
      if (key_of(faces[f], k) == edge) return faces[f][k] == int64_t(edge >> 32);
    return false;
  };
  std::vector<char> seen(faces.size());
  for (size_t first = 0; first < faces.size(); ++first) {
    std::vector<size_t> pending;
    if (!seen[first]) pending.push_back(first), seen[first] = 1;
    while (!pending.empty()) {
      const size_t f = pending.back();
      pending.pop_back();
      for (size_t k = 0; k < faces[f].size(); ++k) {
        const uint64_t edge = key_of(faces[f], k);
        for (size_t g : at_edge[edge]) {
          if (seen[g]) continue;
          if (forward(f, edge) == forward(g, edge)) std::reverse(faces[g].begin(), faces[g].end());
          seen[g] = 1;
          pending.push_back(g);
        }
      }
    }
  }
}

// The corners of six four-sided faces in the order of lattices, from the lowest number along its neighbours in their order.
bool as_hexahedron(const PolyhedronFaces& faces, std::array<int64_t, 16>& p) {
  if (faces.size() != 6) return false;
  std::vector<int64_t> ids;
  for (const auto& f : faces) {
    if (f.size() != 4) return false;
    ids.insert(ids.end(), f.begin(), f.end());
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  if (ids.size() != 8) return false;
  const int64_t low = ids[0];
  std::vector<int64_t> near;
  for (const auto& f : faces)
    for (size_t k = 0; k < 4; ++k)
      if (f[k] == low) near.push_back(f[(k + 1) % 4]);  // once for each edge, as each is in two faces
  std::sort(near.begin(), near.end());
  if (near.size() != 3 || near[0] == near[1] || near[1] == near[2]) return false;
  std::fill(p.begin(), p.end(), -1);
  p[0] = low, p[1] = near[0], p[2] = near[1], p[4] = near[2];
  for (const auto& f : faces)
    for (size_t k = 0; k < 4; ++k) {
      if (f[k] != low) continue;
      size_t place = 0;
      for (size_t c : {1, 2, 4})
        if (p[c] == f[(k + 1) % 4] || p[c] == f[(k + 3) % 4]) place |= c;
      p[place] = f[(k + 2) % 4];
    }
  for (int64_t id : ids)
    if (std::find(p.begin(), p.begin() + 7, id) == p.begin() + 7) p[7] = id;
  return std::find(p.begin(), p.begin() + 8, -1) == p.begin() + 8;
}

// A polyhedron of any faces: the rules of cell_cases.h, worked out on the spot.
class PolyhedronCut {
 public:
  PolyhedronCut(const Finder& finder, const UnstructuredMesh& m, size_t cell) : finder_(finder), cell_(cell) {
    faces_ = outward_faces(m, cell);
  }

  void run(Found& out) {
    std::array<int64_t, 16> corners;
    if (as_hexahedron(faces_, corners)) return finder_.solid(lattice_cases(), corners, cell_, out);
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
  static uint64_t key(const std::vector<int64_t>& face, size_t k) { return key_of(face, k); }

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
  PolyhedronFaces faces_;
  std::map<uint64_t, std::pair<uint64_t, size_t>> next_, step_;  // entry edge -> exit edge and the face between
  std::map<uint64_t, std::vector<size_t>> edge_faces_;
};

}  // namespace

PolyhedronFaces outward_faces(const UnstructuredMesh& mesh, size_t cell) {
  const CellsView view = cells_view(mesh.faces);
  const auto of_cell = mesh.polyhedron_faces.view<int64_t>();
  PolyhedronFaces faces;
  for (size_t f = size_t(of_cell[cell]); f < size_t(of_cell[cell + 1]); ++f) {
    if (view.size(f) < 3) continue;
    auto& face = faces.emplace_back(view.size(f));
    for (size_t k = 0; k < face.size(); ++k) face[k] = view.point(f, k);
  }
  // Files promise outward faces but do not all keep it: make neighbours agree, then look at the volume.
  if (!turn_together(faces)) turn_alike(faces);
  if (faces.empty()) return faces;
  double volume = 0;
  const Vec3 base = mesh.points.at(size_t(faces[0][0]));
  auto place = [&](int64_t p) { return mesh.points.at(size_t(p)) - base; };
  for (const auto& face : faces)
    for (size_t k = 1; k + 1 < face.size(); ++k) volume += dot(place(face[0]), cross(place(face[k]), place(face[k + 1])));
  if (volume < 0)
    for (auto& face : faces) std::reverse(face.begin(), face.end());
  return faces;
}

void cut_polyhedron(const Finder& finder, const UnstructuredMesh& mesh, size_t cell, Found& out) {
  PolyhedronCut(finder, mesh, cell).run(out);
}

}  // namespace sg::contouring
