// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/vortex/parallel_vectors.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <numeric>

#include "base/parallel.h"
#include "data/cells/cell_reader.h"
#include "data/cells/cell_topology.h"
#include "data/fields/known_looks.h"
#include "filter/field/sampling/point_cell.h"
#include "filter/flow/flow_parts.h"
#include "filter/flow/vortex/mend_lines.h"
#include "filter/flow/vortex/parallel_tetra.h"
#include "filter/flow/vortex/whole_faces.h"
#include "filter/mesh/append.h"
#include "filter/probe/field_sampler.h"
#include "filter/scalar/isolines.h"

namespace sg {

namespace {

using namespace parallel;

// Whether the cross product of the two fields can vanish between these corners. Its components are quadratic forms in the barycentric
// coordinates: no, when all coefficients of one have the same sign. `at(i)`: the fields of corner i; `least`: what counts as nothing.
template <class At>
bool may_vanish(size_t n, double least, At&& at) {
  bool plus[3] = {true, true, true}, minus[3] = {true, true, true};
  for (size_t i = 0; i < n; ++i) {
    const auto [a, b] = at(i);
    for (size_t j = i; j < n; ++j) {
      const auto [c, d] = at(j);
      const Vec3 w = cross(a, d) + cross(c, b);
      for (int k = 0; k < 3; ++k) plus[k] &= w[k] > least, minus[k] &= w[k] < -least;
    }
    if (!(plus[0] | minus[0] | plus[1] | minus[1] | plus[2] | minus[2])) return true;
  }
  return false;
}

// The corners of a face of the open cell: of curved cells without the nodes of its edges and inside.
std::span<const uint32_t> face_corners(CellReader& reader, size_t f) {
  const auto nodes = reader.face(f);
  if (!is_high_order(reader.type())) return nodes;
  return nodes.first(cell_faces(reader.type(), reader.ids().size(), reader.orders()).corners[f]);
}

// Corners come first in the nodes of a cell.
size_t corner_count(const CellReader& reader) {
  if (!is_high_order(reader.type())) return reader.ids().size();
  const CellType t = linear_type(reader.type());
  return t == CellType::tetra ? 4 : t == CellType::pyramid ? 5 : t == CellType::wedge ? 6 : 8;
}

// The solid cells in which the fields may be parallel. Of their points: the largest lengths of both fields in those cells around, and
// where the fields are parallel. Faces on which they are parallel everywhere (walls, where nothing moves) have no points.
struct Around {
  std::vector<size_t> cells;
  bool solid = false;
  std::vector<double> most_a, most_b;
  std::vector<uint8_t> parallel;

  Around(const CellReader& proto, std::span<const Vec3> a, std::span<const Vec3> b, double nothing, Context& context)
      : most_a(a.size(), 0), most_b(a.size(), 0), parallel(a.size(), 0) {
    find_cells(proto, a, b, nothing, context);
    std::atomic<size_t> count{0};
    parallel_for(a.size(), 1 << 14, [&](size_t begin, size_t end) {
      size_t here = 0;
      for (size_t i = begin; i < end; ++i) {
        most_a[i] = std::sqrt(most_a[i]), most_b[i] = std::sqrt(most_b[i]);
        here += parallel[i] = most_a[i] > 0 && most_b[i] > 0 && are_parallel(a[i], b[i], most_a[i], most_b[i], nothing);
      }
      count += here;
    });
    if (count > 2) leave_out_areas(proto, a, b, nothing, context);
  }

 private:
  void find_cells(const CellReader& proto, std::span<const Vec3> a, std::span<const Vec3> b, double nothing, Context& context) {
    constexpr size_t grain = 1 << 12;
    std::vector<std::vector<size_t>> found((proto.count() + grain - 1) / grain);
    std::vector<uint8_t> some(found.size(), 0);
    parallel_for(
        proto.count(), grain,
        [&](size_t begin, size_t end) {
          CellReader reader(proto);
          for (size_t c = begin; c < end; ++c) {
            if (reader.hidden(c)) continue;
            reader.open(c);
            if (reader.dimension() != 3) continue;
            some[begin / grain] = 1;
            const auto ids = reader.ids().first(corner_count(reader));
            double la = 0, lb = 0;
            for (const int64_t id : ids) {
              la = std::fmax(la, dot(a[size_t(id)], a[size_t(id)]));
              lb = std::fmax(lb, dot(b[size_t(id)], b[size_t(id)]));
            }
            const auto at = [&](size_t i) { return std::pair<Vec3, Vec3>(a[size_t(ids[i])], b[size_t(ids[i])]); };
            if (!may_vanish(ids.size(), nothing * std::sqrt(la * lb), at)) continue;
            found[begin / grain].push_back(c);
            for (const int64_t id : ids) raise(most_a[size_t(id)], la), raise(most_b[size_t(id)], lb);
          }
        },
        &context);
    for (const auto& f : found) cells.insert(cells.end(), f.begin(), f.end());
    solid = std::find(some.begin(), some.end(), 1) != some.end();
  }
  static void raise(double& most, double to) {
    std::atomic_ref<double> m(most);
    double before = m.load(std::memory_order_relaxed);
    while (before < to && !m.compare_exchange_weak(before, to, std::memory_order_relaxed)) {
    }
  }
  void leave_out_areas(const CellReader& proto, std::span<const Vec3> a, std::span<const Vec3> b, double nothing, Context& context) {
    std::vector<uint8_t> area(parallel.size(), 0);
    CellReader reader(proto);
    for (const size_t c : cells) {
      context.check();
      reader.open(c);
      const auto ids = reader.ids();
      if (std::count_if(ids.begin(), ids.end(), [&](int64_t id) { return parallel[size_t(id)] != 0; }) < 3) continue;
      for (size_t f = 0; f < reader.face_count(); ++f) {
        const auto face = face_corners(reader, f);
        Vec3 u, w;
        double la = 0, lb = 0;
        bool all = true;
        for (const uint32_t k : face) {
          const auto i = size_t(ids[k]);
          u += a[i], w += b[i], la += most_a[i], lb += most_b[i], all &= parallel[i] != 0;
        }
        if (!all || !are_parallel(u, w, la, lb, nothing)) continue;
        for (const uint32_t k : face) area[size_t(ids[k])] = 1;
      }
    }
    for (size_t i = 0; i < area.size(); ++i) parallel[i] &= uint8_t(!area[i]);
  }
};

bool is_flat(Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 u = b - a, v = c - a, w = c - b, n = cross(u, v);
  const double longest2 = std::max({dot(u, u), dot(v, v), dot(w, w)});
  return dot(n, n) <= 1e-18 * longest2 * longest2;
}

// f(p, q, r) for triangles of a face, the same for both of its cells: a fan from the smallest id, or, where that would hold flat triangles
// (a corner amid an edge, as where levels of a grid meet), ears by the shortest diagonal.
template <class F>
void each_triangle(std::vector<Corner>& ring, F&& f) {
  std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end(), [](const Corner& l, const Corner& m) { return l.id < m.id; }),
              ring.end());
  bool flat = false;
  for (size_t k = 1; k + 1 < ring.size(); ++k) flat |= is_flat(ring[0].at, ring[k].at, ring[k + 1].at);
  if (ring.size() == 3 || !flat) {
    for (size_t k = 1; k + 1 < ring.size(); ++k) f(ring[0], ring[k], ring[k + 1]);
    return;
  }
  while (ring.size() > 3) {
    size_t best = ring.size();
    double shortest = HUGE_VAL;
    for (size_t k = 0; k < ring.size(); ++k) {
      const Corner &before = ring[(k + ring.size() - 1) % ring.size()], &after = ring[(k + 1) % ring.size()];
      const Vec3 d = after.at - before.at;
      if (is_flat(before.at, ring[k].at, after.at)) continue;
      if (best < ring.size() && (dot(d, d) > shortest || (dot(d, d) == shortest && ring[k].id > ring[best].id))) continue;
      best = k, shortest = dot(d, d);
    }
    if (best == ring.size()) return;  // no area
    f(ring[(best + ring.size() - 1) % ring.size()], ring[best], ring[(best + 1) % ring.size()]);
    ring.erase(ring.begin() + ptrdiff_t(best));
  }
  f(ring[0], ring[1], ring[2]);
}

struct Work : TetraLines {
  std::vector<Corner> corners, ring;

  void cell(CellReader& reader, std::span<const Vec3> a, std::span<const Vec3> b, const Around& around, int64_t points) {
    const auto ids = reader.ids();
    const auto at = reader.at();
    const auto corner = [&](uint32_t k) {
      const auto i = size_t(ids[k]);
      return Corner{ids[k], at[k], a[i], b[i], around.most_a[i], around.most_b[i], around.parallel[i] != 0};
    };
    const size_t faces = reader.face_count();
    corners.clear();
    if (linear_type(reader.type()) == CellType::tetra) {
      for (uint32_t k = 0; k < 4; ++k) corners.push_back(corner(k));
      tetra(corners[0], corners[1], corners[2], corners[3], int64_t(reader.cell()));
      return;
    }
    const size_t used = corner_count(reader);
    Corner middle{points + int64_t(reader.cell()), {}, {}, {}, 0, 0, false};
    for (uint32_t k = 0; k < used; ++k) {
      corners.push_back(corner(k));
      middle.at += at[k], middle.a += corners.back().a, middle.b += corners.back().b;
    }
    middle.at = middle.at / double(used), middle.a = middle.a / double(used), middle.b = middle.b / double(used);
    for (const Corner& k : corners) middle.most_a = std::max(middle.most_a, k.most_a), middle.most_b = std::max(middle.most_b, k.most_b);
    middle.parallel = are_parallel(middle.a, middle.b, middle.most_a, middle.most_b, nothing);
    for (size_t f = 0; f < faces; ++f) {
      ring.clear();
      for (const uint32_t k : face_corners(reader, f)) ring.push_back(corner(k));
      if (ring.size() < 3) continue;
      each_triangle(ring, [&](const Corner& p, const Corner& q, const Corner& r) { tetra(p, q, r, middle, int64_t(reader.cell())); });
    }
  }
};

}  // namespace

Data each_flow_mesh(const std::vector<DatasetPtr>& meshes, const std::function<DatasetPtr(const DatasetPtr&)>& f, Context& context) {
  if (meshes.size() == 1) return f(meshes.front());
  std::vector<Data> lines;
  for (const DatasetPtr& d : meshes) lines.push_back(f(d));
  return append(lines, {}, context);
}

std::vector<Vec3> point_vectors(const DatasetPtr& in, const Field& given, Context& context) {
  Field field = given;
  if (field.association == Association::cell)
    field = cell_to_point(in, {{field.name}}, context)->fields().require(field.name, Association::point);
  std::vector<Vec3> out(field.array.count());
  dispatch(field.array, [&](const auto& v) {
    parallel_for(out.size(), 1 << 14, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        out[i] = {double(v(i, 0)), v.components > 1 ? double(v(i, 1)) : 0.0, v.components > 2 ? double(v(i, 2)) : 0.0};
    });
  });
  return out;
}

ParallelLines parallel_lines(const DatasetPtr& data, std::span<const Vec3> a, std::span<const Vec3> b, Context& context, double nothing) {
  const CellReader proto(data);
  const Around around(proto, a, b, nothing, context);
  if (!around.solid)
    fail_usage("lines along which two vector fields are parallel need cells with volume", "parallel_vectors",
               "in a plane the counterpart is points: use critical_points");
  constexpr size_t grain = 1 << 10;
  std::vector<Work> parts((around.cells.size() + grain - 1) / grain);
  const auto points = int64_t(data->point_count());
  parallel_for(
      around.cells.size(), grain,
      [&](size_t begin, size_t end) {
        CellReader reader(proto);
        Work& work = parts[begin / grain];
        work.nothing = nothing;
        for (size_t k = begin; k < end; ++k) {
          reader.open(around.cells[k]);
          work.cell(reader, a, b, around, points);
        }
      },
      &context);

  // Each point once: those of shared faces were found by both cells, in the same bits.
  std::vector<Found> all;
  for (Work& w : parts) all.insert(all.end(), w.found.begin(), w.found.end());
  std::stable_sort(all.begin(), all.end(), [](const Found& l, const Found& r) { return l.key < r.key; });
  all.erase(std::unique(all.begin(), all.end(), [](const Found& l, const Found& r) { return l.key == r.key; }), all.end());
  ParallelLines out;
  CellReader reader(proto);
  for (const Found& f : all) {
    ParallelPoint p{f.at, uint32_t(out.ids.size()), 0, f.cell, f.ratio};
    for (int k = 0; k < 3; ++k) {
      const int64_t id = f.key.corners[size_t(k)];
      if (id < 0) break;
      if (id < points) {
        out.ids.push_back(id), out.weights.push_back(f.s[k]);
        continue;
      }
      reader.open(size_t(id - points));
      const auto middle = reader.ids().first(corner_count(reader));
      for (const int64_t m : middle) out.ids.push_back(m), out.weights.push_back(f.s[k] / double(middle.size()));
    }
    p.count = uint32_t(out.ids.size()) - p.first;
    out.points.push_back(p);
  }
  const auto number = [&](const Key& key) {
    return uint32_t(std::lower_bound(all.begin(), all.end(), key, [](const Found& l, const Key& r) { return l.key < r; }) - all.begin());
  };
  // Those in a face or along an edge were found by all tetrahedra there; the first counts.
  std::vector<std::array<uint32_t, 2>> ends;
  std::vector<int64_t> cells;
  for (const Work& w : parts)
    for (const Segment& s : w.segments) ends.push_back({number(s.from), number(s.to)}), cells.push_back(s.cell);
  std::vector<uint32_t> order(ends.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](uint32_t l, uint32_t r) { return std::pair(ends[l], l) < std::pair(ends[r], r); });
  order.erase(std::unique(order.begin(), order.end(), [&](uint32_t l, uint32_t r) { return ends[l] == ends[r]; }), order.end());
  std::sort(order.begin(), order.end());
  for (const uint32_t k : order) {
    out.segments.insert(out.segments.end(), ends[k].begin(), ends[k].end());
    out.cells.push_back(cells[k]);
  }
  // Near a vertex a line is as uncertain as the numbers are, magnified by how flat its angle with faces may be.
  constexpr double magnified = 20;
  std::vector<double> reach;
  for (const ParallelPoint& p : out.points) {
    reader.open(size_t(p.cell));
    reach.push_back(magnified * nothing * reader.box().diagonal());
  }
  mend_lines(out, reach);
  return out;
}

DatasetPtr parallel_lines_mesh(const DatasetPtr& data, const ParallelLines& lines, Context& context, std::vector<PointNumbers> more) {
  FieldSampler sampler(*data, lines.points.size());
  SampleBlock block;
  for (size_t i = 0; i < lines.points.size(); ++i) {
    const ParallelPoint& p = lines.points[i];
    block.add(i, p.cell, std::span(lines.ids).subspan(p.first, p.count), std::span(lines.weights).subspan(p.first, p.count));
    if (block.full()) sampler.write(block), block.count = 0;
  }
  sampler.write(block);
  DatasetParts parts;
  parts.fields = sampler.take();
  parts.fields.remove("valid", Association::point);
  SurfaceMesh mesh;
  mesh.points.origin = data->bounds().center();
  std::vector<double> xyz, ratio;
  for (const ParallelPoint& p : lines.points) {
    const Vec3 x = p.at - mesh.points.origin;
    xyz.insert(xyz.end(), {x.x, x.y, x.z});
    ratio.push_back(p.ratio);
  }
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  mesh.lines.fixed = 2;
  mesh.lines.connectivity = Array::from_vector(std::vector<int32_t>(lines.segments.begin(), lines.segments.end()));
  parts.fields.add({"parallel ratio", Association::point, Array::from_vector(std::move(ratio)), "", Role::none});
  for (PointNumbers& m : more)
    parts.fields.add({m.name, Association::point, Array::from_vector(std::move(m.values)), "", Role::none, known_look(m.name)});
  parts.mesh = std::move(mesh), parts.notes = data->notes(), parts.time = data->time();
  const bool none = lines.segments.empty();
  const DatasetPtr segments = make_dataset(std::move(parts));
  return none ? segments : polylines(segments, {}, context);
}

namespace {

DatasetPtr of_mesh(const DatasetPtr& given, const ParallelVectorsParams& p, Context& context) {
  if (p.b.empty())
    fail_usage("there is no second vector field", "parallel_vectors",
               "name it with b=FIELD, and the first with a=FIELD (default: the active vectors)");
  Field first = flow_field_of(*given, p.a.name, "parallel_vectors"), second = flow_field_of(*given, p.b.name, "parallel_vectors");
  const double nothing = std::max(parallel_within(first.array.type()), parallel_within(second.array.type()));
  const DatasetPtr in = with_whole_faces(given, {first, second}, context);
  first = flow_field_of(*in, first.name, "parallel_vectors"), second = flow_field_of(*in, second.name, "parallel_vectors");
  const std::vector<Vec3> a = point_vectors(in, first, context), b = point_vectors(in, second, context);
  return parallel_lines_mesh(in, parallel_lines(in, a, b, context, nothing), context);
}

}  // namespace

Data parallel_vectors(const Data& in, const ParallelVectorsParams& p, Context& context) {
  std::string field = p.a.name;
  return each_flow_mesh(
      flow_meshes(in, field, "parallel_vectors"), [&](const DatasetPtr& d) { return of_mesh(d, p, context); }, context);
}

}  // namespace sg
