// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/mesh/simplices.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "base/error.h"
#include "base/text/text.h"
#include "data/cells/cell_reader.h"
#include "data/cells/cell_topology.h"
#include "data/cells/mesh_dimension.h"
#include "data/cells/point_positions.h"

namespace sg::pde {

namespace {

using Corners = std::array<uint32_t, 4>;

// Triangles of a face by a fan from its lowest point.
template <class F>
void fan(std::span<const int64_t> ids, std::span<const uint32_t> face, F&& f) {
  size_t lowest = 0;
  for (size_t k = 1; k < face.size(); ++k)
    if (ids[face[k]] < ids[face[lowest]]) lowest = k;
  for (size_t k = 1; k + 1 < face.size(); ++k) f(face[lowest], face[(lowest + k) % face.size()], face[(lowest + k + 1) % face.size()]);
}

void cut_solid(CellReader& reader, Simplices& s, uint32_t cell) {
  const auto ids = reader.ids();
  const auto id = [&](uint32_t k) { return uint32_t(ids[k]); };
  if (linear_type(reader.type()) == CellType::tetra) {
    s.corners.push_back({id(0), id(1), id(2), id(3)}), s.cell.push_back(cell);
    return;
  }
  uint32_t apex = 0;
  bool polyhedron = reader.type() == CellType::polyhedron;
  if (polyhedron) {
    Vec3 sum{0, 0, 0};
    for (const Vec3& p : reader.at()) sum = sum + p;
    apex = uint32_t(s.at.size());
    s.at.push_back(sum * (1.0 / double(reader.at().size())));
  }
  // Of curved cells the corners alone take part.
  size_t corners = ids.size();
  if (const LinearTopology* t = linear_topology(linear_type(reader.type()))) corners = std::min(corners, size_t(t->corners));
  size_t lowest = 0;
  for (size_t k = 1; k < corners; ++k)
    if (ids[k] < ids[lowest]) lowest = k;
  if (!polyhedron) apex = id(uint32_t(lowest));
  std::vector<uint32_t> face;
  for (size_t f = 0; f < reader.face_count(); ++f) {
    face.clear();
    for (const uint32_t k : reader.face(f))
      if (k < corners) face.push_back(k);
    if (!polyhedron && std::any_of(face.begin(), face.end(), [&](uint32_t k) { return id(k) == apex; })) continue;
    fan(ids, face, [&](uint32_t a, uint32_t b, uint32_t c) { s.corners.push_back({apex, id(a), id(b), id(c)}), s.cell.push_back(cell); });
  }
}

}  // namespace

Simplices simplices_of(const DatasetPtr& mesh, const std::string& who, const Context& context) {
  Simplices s;
  s.dimension = mesh_dimension(*mesh);
  s.points = mesh->point_count();
  if (s.dimension < 1 || mesh->as<AmrGrid>())
    fail_usage(mesh->as<AmrGrid>() ? "an AMR grid has points that hang between levels" : "the mesh has no lines, faces or solids", who,
               mesh->as<AmrGrid>() ? "resample it first" : "");
  if (s.points + mesh->cell_count() >= UINT32_MAX) fail_usage("the mesh has more points than can be numbered", who);
  const Array xyz = point_positions(mesh->mesh());
  s.at.resize(s.points);
  const auto view = xyz.view<double>();
  for (size_t i = 0; i < s.points; ++i) s.at[i] = {view(i, 0), view(i, 1), view(i, 2)};
  CellReader reader(mesh);
  std::vector<uint32_t> parts;
  for (size_t c = 0; c < reader.count(); ++c) {
    if (c % 4096 == 0) context.check();
    if (reader.hidden(c)) continue;
    reader.open(c);
    if (reader.dimension() != s.dimension) continue;
    parts.clear();
    if (s.dimension == 3) {
      cut_solid(reader, s, uint32_t(c));
      continue;
    }
    const auto ids = reader.ids();
    if (s.dimension == 2) tessellate_face(reader.type(), reader.at(), parts, reader.orders());
    else {
      std::vector<uint32_t> order;
      curve_order(reader.type(), ids.size(), order);
      for (size_t k = 0; k + 1 < order.size(); ++k) parts.push_back(order[k]), parts.push_back(order[k + 1]);
    }
    const auto n = size_t(s.dimension) + 1;
    for (size_t k = 0; k + n <= parts.size(); k += n) {
      Corners corner{};
      for (size_t v = 0; v < n; ++v) corner[v] = uint32_t(ids[parts[k + v]]);
      s.corners.push_back(corner), s.cell.push_back(uint32_t(c));
    }
  }
  const double bytes = 80.0 * double(s.size()) + 400.0 * double(s.points);  // with the matrix
  if (context.memory_limit && bytes > double(context.memory_limit))
    fail_usage(fmt::format("{} simplices take about {}, more than there is", s.size(), human_bytes(uint64_t(bytes))), who,
               "take a coarser mesh or a part of it");
  size_t kept = 0;
  std::array<Vec3, 4> gradients;
  for (size_t k = 0; k < s.size(); ++k) {
    if (!(simplex_gradients(s, k, gradients) > 0)) continue;
    s.corners[kept] = s.corners[k], s.cell[kept++] = s.cell[k];
  }
  s.corners.resize(kept), s.cell.resize(kept);
  return s;
}

std::vector<uint8_t> border_points(const Simplices& s) {
  const auto n = size_t(s.dimension);
  std::vector<std::array<uint32_t, 3>> facets;
  facets.reserve(s.size() * (n + 1));
  for (const Corners& c : s.corners)
    for (size_t left = 0; left <= n; ++left) {
      std::array<uint32_t, 3> f{UINT32_MAX, UINT32_MAX, UINT32_MAX};
      for (size_t v = 0, k = 0; v <= n; ++v)
        if (v != left) f[k++] = c[v];
      std::sort(f.begin(), f.end());
      facets.push_back(f);
    }
  std::sort(facets.begin(), facets.end());
  std::vector<uint8_t> border(s.at.size());
  for (size_t i = 0; i < facets.size();) {
    size_t end = i + 1;
    while (end < facets.size() && facets[end] == facets[i]) ++end;
    if (end == i + 1)
      for (const uint32_t p : facets[i])
        if (p != UINT32_MAX) border[p] = 1;
    i = end;
  }
  return border;
}

double simplex_gradients(const Simplices& s, size_t simplex, std::array<Vec3, 4>& gradients) {
  const Corners& c = s.corners[simplex];
  const Vec3 a = s.at[c[1]] - s.at[c[0]];
  double size = 0;
  if (s.dimension == 1) {
    size = length(a);
    gradients[1] = a * (1 / (size * size));
    gradients[0] = gradients[1] * -1.0;
  } else if (s.dimension == 2) {
    const Vec3 b = s.at[c[2]] - s.at[c[0]], across = cross(a, b);
    const double twice = length(across);
    size = twice / 2;
    const Vec3 n = across * (1 / twice);
    gradients[1] = cross(b, n) * (1 / twice), gradients[2] = cross(n, a) * (1 / twice);
    gradients[0] = (gradients[1] + gradients[2]) * -1.0;
  } else {
    const Vec3 b = s.at[c[2]] - s.at[c[0]], d = s.at[c[3]] - s.at[c[0]];
    const double det = dot(a, cross(b, d));
    size = std::abs(det) / 6;
    gradients[1] = cross(b, d) * (1 / det), gradients[2] = cross(d, a) * (1 / det), gradients[3] = cross(a, b) * (1 / det);
    gradients[0] = (gradients[1] + gradients[2] + gradients[3]) * -1.0;
  }
  double longest = 0;
  for (int v = 1; v <= s.dimension; ++v) longest = std::max(longest, length(s.at[c[size_t(v)]] - s.at[c[0]]));
  // Flat ones, as far as can be computed.
  const double least = 1e-13 * longest * (s.dimension > 1 ? longest : 1) * (s.dimension > 2 ? longest : 1);
  return std::isfinite(size) && size > least ? size : 0;
}

}  // namespace sg::pde
