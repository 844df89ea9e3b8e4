// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/border_edges.h"

#include <algorithm>
#include <array>
#include <set>

#include "data/cells/cell_reader.h"
#include "data/cells/cell_topology.h"
#include "data/fields/known_looks.h"

namespace sg {

namespace {

// Edges of only one cell, in order of the cells.
std::vector<BorderEdge> single_edges(const DatasetPtr& d, int32_t part, const PlaneFrame& frame, Context& context) {
  CellReader reader(d);
  std::vector<BorderEdge> all;
  std::vector<uint32_t> ring;
  for (size_t c = 0; c < reader.count(); ++c) {
    if (c % 65536 == 0) context.check();
    if (reader.hidden(c)) continue;
    reader.open(c);
    if (reader.dimension() != 2) continue;
    const auto ids = reader.ids();
    const auto at = reader.at();
    ring.clear();
    std::vector<std::vector<uint32_t>> rings;
    if (reader.type() == CellType::triangle_strip) {
      for (uint32_t k = 0; k + 2 < ids.size(); ++k) rings.push_back({k, k + 1, k + 2});
    } else {
      face_outline(reader.type(), ids.size(), ring, reader.orders());
      rings.push_back(ring);
    }
    for (const auto& r : rings) {
      double area = 0;
      for (size_t k = 0; k < r.size(); ++k) area += dot(frame.normal, cross(at[r[k]] - at[r[0]], at[r[(k + 1) % r.size()]] - at[r[0]]));
      for (size_t k = 0; k < r.size(); ++k) {
        const uint32_t p = area >= 0 ? r[k] : r[(k + 1) % r.size()], q = area >= 0 ? r[(k + 1) % r.size()] : r[k];
        if (ids[p] != ids[q]) all.push_back({ids[p], ids[q], at[p], at[q], int64_t(c), part});
      }
    }
  }
  std::vector<size_t> order(all.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  auto key = [&](size_t i) { return std::pair(std::min(all[i].a, all[i].b), std::max(all[i].a, all[i].b)); };
  std::sort(order.begin(), order.end(), [&](size_t i, size_t j) { return std::pair(key(i), i) < std::pair(key(j), j); });
  std::vector<size_t> single;
  for (size_t i = 0; i < order.size();) {
    size_t j = i;
    while (j < order.size() && key(order[j]) == key(order[i])) ++j;
    if (j == i + 1) single.push_back(order[i]);
    i = j;
  }
  std::sort(single.begin(), single.end());
  std::vector<BorderEdge> out;
  for (const size_t i : single) out.push_back(all[i]);
  return out;
}

// Edges at one place, one each way, of points that are two: the seam of a grid that meets itself, or of parts.
void drop_seams(std::vector<BorderEdge>& edges) {
  using Place = std::array<double, 6>;
  auto place = [](Vec3 a, Vec3 b) { return Place{a.x, a.y, a.z, b.x, b.y, b.z}; };
  std::set<Place> all;
  for (const BorderEdge& e : edges) all.insert(place(e.at_a, e.at_b));
  std::erase_if(edges, [&](const BorderEdge& e) { return all.count(place(e.at_b, e.at_a)) > 0; });
}

}  // namespace

std::vector<BorderEdge> border_edges(const FlowParts& flow, const PlaneFrame& frame, Context& context) {
  std::vector<BorderEdge> out;
  bool behind = flow.count() > 1;
  for (size_t k = 0; k < flow.count(); ++k) {
    const DatasetPtr& d = flow.fields()[k].dataset();
    behind = behind || d->as<AmrGrid>();
    const auto more = single_edges(d, int32_t(k), frame, context);
    out.insert(out.end(), more.begin(), more.end());
  }
  drop_seams(out);
  if (!behind) return out;
  PartsCursor cursor(flow);
  std::erase_if(out, [&](const BorderEdge& e) {
    const Vec3 along = e.at_b - e.at_a;
    Vec3 v;
    return cursor(lerp(e.at_a, e.at_b, 0.5) + 0.05 * cross(along, frame.normal), v);
  });
  return out;
}

DatasetPtr border_dataset(const FlowParts& flow, const std::vector<BorderEdge>& edges) {
  std::vector<double> xyz, speed;
  std::vector<int64_t> ids;
  for (const BorderEdge& e : edges) {
    const Array& v = flow.fields()[size_t(e.part)].field().array;
    for (const auto& [at, point] : {std::pair(e.at_a, e.a), std::pair(e.at_b, e.b)}) {
      double sum = 0;
      for (int c = 0; c < v.components(); ++c) sum += v.get(size_t(point), c) * v.get(size_t(point), c);
      ids.push_back(int64_t(ids.size()));
      xyz.insert(xyz.end(), {at.x, at.y, at.z}), speed.push_back(std::sqrt(sum));
    }
  }
  SurfaceMesh mesh;
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  mesh.lines.fixed = 2;
  mesh.lines.connectivity = Array::from_vector(std::move(ids));
  DatasetParts parts;
  parts.mesh = std::move(mesh);
  parts.fields.add({"speed", Association::point, Array::from_vector(std::move(speed)), "", Role::scalars, known_look("speed")});
  return make_dataset(std::move(parts));
}

}  // namespace sg
