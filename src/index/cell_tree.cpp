// SPDX-License-Identifier: Apache-2.0
// The boxes that a tree is built from.
#include "index/cell_tree.h"

#include "base/error.h"
#include "base/parallel.h"
#include "index/cell_probe.h"

namespace sg {

namespace {

constexpr size_t cells_per_chunk = 8192;
constexpr double growth = 1e-7;  // of a box's largest side: see CellTree

Vec3 center_of(const Box3& b) {
  const Vec3 c = b.center();
  return b.empty() || !std::isfinite(dot(c, c)) ? Vec3() : c;
}

void set_empty(TreeRecord& r) {
  for (int a = 0; a < 3; ++a) r.lo[a] = 1, r.hi[a] = -1;
}

void set_record(TreeRecord& r, Vec3 lo, Vec3 hi, Vec3 center, size_t cell) {
  r.cell = uint32_t(cell);
  const Vec3 s = hi - lo;
  if (!(s.x >= 0 && s.y >= 0 && s.z >= 0)) return set_empty(r);
  const double g = growth * std::max({s.x, s.y, s.z});
  for (int a = 0; a < 3; ++a) r.lo[a] = detail::float_below(lo[a] - center[a] - g), r.hi[a] = detail::float_above(hi[a] - center[a] + g);
}

// Cells that lie in the box of their points, straight from the arrays. `first` is the number of the first of them.
template <class T>
void boxes_of_lists(const CellsView& cells, const View<T>& xyz, Vec3 origin, Vec3 center, size_t first, TreeRecord* out, Context& context) {
  parallel_for(
      cells.count, cells_per_chunk,
      [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c) {
          T lo[3], hi[3];
          for (int a = 0; a < 3; ++a) lo[a] = std::numeric_limits<T>::infinity(), hi[a] = -lo[a];
          for (size_t i = cells.begin(c), last = cells.end(c); i < last; ++i) {
            const T* p = xyz.data + 3 * size_t(cells.connectivity[i]);
            for (int a = 0; a < 3; ++a) {
              lo[a] = p[a] < lo[a] ? p[a] : lo[a];
              hi[a] = p[a] > hi[a] ? p[a] : hi[a];
            }
          }
          set_record(out[c], origin + Vec3(double(lo[0]), double(lo[1]), double(lo[2])),
                     origin + Vec3(double(hi[0]), double(hi[1]), double(hi[2])), center, first + c);
        }
      },
      &context);
}

void boxes_of_lists(const CellArray& cells, const Points& points, Vec3 center, size_t first, TreeRecord* out, Context& context) {
  if (cells.size() == 0) return;
  const Array xyz = points.xyz.made_packed();
  const CellsView v = cells_view(cells);
  if (xyz.type() == ElementType::f32) boxes_of_lists(v, xyz.view<float>(), points.origin, center, first, out + first, context);
  else boxes_of_lists(v, xyz.view<double>(), points.origin, center, first, out + first, context);
}

void boxes_by_reader(const DatasetPtr& d, Vec3 center, Plane<TreeRecord>& out, Context& context) {
  const CellReader model(d);
  parallel_for(
      out.size(), cells_per_chunk,
      [&](size_t begin, size_t end) {
        CellReader reader = model;
        for (size_t c = begin; c < end; ++c) {
          reader.open(c);
          const Box3 b = cell_box(reader);
          set_record(out[c], b.lo, b.hi, center, c);
        }
      },
      &context);
}

// Whether all cells lie in the box of their points.
bool flat_cells(const UnstructuredMesh& m) {
  if (m.types.empty()) return !is_high_order(m.single_type);
  const auto types = m.types.view<uint8_t>();
  return parallel_reduce(
      types.count, 1 << 16, true,
      [&](size_t begin, size_t end) {
        bool flat = true;
        for (size_t i = begin; i < end; ++i)
          flat = flat && (types[i] < uint8_t(CellType::quadratic_edge) || types[i] == uint8_t(CellType::polyhedron));
        return flat;
      },
      [](bool a, bool b) { return a && b; });
}

void remove_empty(Plane<TreeRecord>& records) {
  const auto empty = [](const TreeRecord& r) { return !(r.lo[0] <= r.hi[0]); };
  const bool any = parallel_reduce(
      records.size(), 1 << 16, false,
      [&](size_t begin, size_t end) { return std::any_of(records.begin() + ptrdiff_t(begin), records.begin() + ptrdiff_t(end), empty); },
      [](bool a, bool b) { return a || b; });
  if (any) records.erase(std::remove_if(records.begin(), records.end(), empty), records.end());
}

}  // namespace

CellTree::CellTree(DatasetPtr dataset, Context& context) {
  const CellReader reader(dataset);
  const size_t n = reader.count();
  if (n >= size_t(1) << 31) fail_usage("the mesh has 2^31 cells or more", "cell tree", "take a part of it at a time");
  center_ = center_of(dataset->bounds());
  Plane<TreeRecord> records(n);
  const auto* u = dataset->as<UnstructuredMesh>();
  if (u && flat_cells(*u)) {
    boxes_of_lists(u->cells, u->points, center_, 0, records.data(), context);
  } else if (const auto* s = dataset->as<SurfaceMesh>()) {
    size_t first = 0;
    for (const CellArray* a : {&s->vertices, &s->lines, &s->polygons, &s->strips}) {
      boxes_of_lists(*a, s->points, center_, first, records.data(), context);
      first += a->size();
    }
  } else {
    boxes_by_reader(dataset, center_, records, context);
  }
  if (!dataset->cell_ghost().empty() || !dataset->point_ghost().empty())
    parallel_for(n, cells_per_chunk, [&](size_t begin, size_t end) {
      for (size_t c = begin; c < end; ++c)
        if (reader.hidden(c)) set_empty(records[c]);
    });
  remove_empty(records);
  tree_ = build_box_tree(std::move(records), {}, context);
}

CellTree::CellTree(std::span<const Box3> boxes, Context& context) {
  if (boxes.size() >= size_t(1) << 31) fail_usage("2^31 boxes or more", "cell tree");
  const Box3 all = parallel_reduce(
      boxes.size(), cells_per_chunk, Box3{},
      [&](size_t begin, size_t end) {
        Box3 b;
        for (size_t i = begin; i < end; ++i) b.add(boxes[i]);
        return b;
      },
      [](Box3 a, const Box3& b) {
        a.add(b);
        return a;
      });
  center_ = center_of(all);
  Plane<TreeRecord> records(boxes.size());
  parallel_for(boxes.size(), cells_per_chunk, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) set_record(records[i], boxes[i].lo, boxes[i].hi, center_, i);
  });
  remove_empty(records);
  tree_ = build_box_tree(std::move(records), {}, context);
}

}  // namespace sg
