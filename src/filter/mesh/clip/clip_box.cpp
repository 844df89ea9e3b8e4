// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/clip/clip_box.h"

#include <algorithm>
#include <bit>

#include "data/field_ops.h"
#include "filter/mesh/append.h"

namespace sg::clipping {

namespace {

constexpr const char* name_field = "\x01name";  // numbers of points, blended where edges are cut: the same on both sides of a cut

DatasetPtr with_names(const DatasetPtr& in) {
  DatasetParts parts = in->parts();
  double* out = nullptr;
  Array names = Array::make<double>(in->point_count(), 1, &out);
  for (size_t i = 0; i < in->point_count(); ++i) out[i] = double(i);
  parts.fields.add({name_field, Association::point, std::move(names), "", Role::global_ids});
  return make_dataset(std::move(parts));
}

DatasetPtr without_names(const DatasetPtr& in) {
  DatasetParts parts = in->parts();
  parts.fields.remove(name_field, Association::point);
  return make_dataset(std::move(parts));
}

Array renumbered(const Array& ids, const std::vector<int64_t>& number) {
  std::vector<int64_t> out(ids.count());
  const IndexView v = index_view(ids);
  for (size_t i = 0; i < out.size(); ++i) out[i] = number[size_t(v[i])];
  return Array::from_vector(std::move(out));
}

// Points of the same place and name become one. Positions alone would also close cracks of the input.
DatasetPtr welded(const DatasetPtr& in) {
  using Key = std::array<uint64_t, 4>;
  const size_t n = in->point_count();
  UnstructuredMesh m = *in->as<UnstructuredMesh>();
  const auto name = in->fields().require(name_field, Association::point).array.view<double>();
  std::vector<Key> keys(n);
  std::vector<int64_t> order(n), number(n), kept;
  for (size_t i = 0; i < n; ++i) {
    const Vec3 p = m.points.at(i);
    keys[i] = {std::bit_cast<uint64_t>(p.x), std::bit_cast<uint64_t>(p.y), std::bit_cast<uint64_t>(p.z), std::bit_cast<uint64_t>(name[i])};
    order[i] = int64_t(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](int64_t a, int64_t b) { return keys[size_t(a)] < keys[size_t(b)]; });
  for (size_t i = 0; i < n; ++i) {
    const bool same = i > 0 && keys[size_t(order[i])] == keys[size_t(order[i - 1])];
    number[size_t(order[i])] = same ? number[size_t(order[i - 1])] : order[i];  // of equal points the first, numbered below
  }
  for (size_t i = 0; i < n; ++i) {
    if (number[i] == int64_t(i)) number[i] = int64_t(kept.size()), kept.push_back(int64_t(i));
    else number[i] = number[size_t(number[i])];  // the first one precedes it and has its number
  }
  m.points.xyz = gather(m.points.xyz, kept);
  m.cells.connectivity = renumbered(m.cells.connectivity, number);
  if (m.faces.size() > 0) m.faces.connectivity = renumbered(m.faces.connectivity, number);
  DatasetParts out;
  out.mesh = std::move(m);
  for (const Field& f : in->fields()) out.fields.add(f.association == Association::point ? f.with(gather(f.array, kept)) : f);
  out.time = in->time();
  return make_dataset(std::move(out));
}

}  // namespace

std::vector<ImplicitFunction> box_planes(const Box3& box, const Box3& bounds) {
  std::vector<ImplicitFunction> r;
  for (int pass = 0; pass < 2 && r.empty(); ++pass)  // the second time, for want of any, the first one
    for (int a = 0; a < 3; ++a)
      for (const double sign : {-1.0, 1.0}) {
        Vec3 normal;
        normal[a] = sign;
        ImplicitFunction f = plane_function(sign < 0 ? box.lo : box.hi, normal, bounds);
        const double reach = bounds.empty() ? 0 : sign < 0 ? box.lo[a] - bounds.lo[a] : bounds.hi[a] - box.hi[a];
        if (reach > f.snap || (pass == 1 && r.empty())) r.push_back(std::move(f));
      }
  return r;
}

DatasetPtr clip_box(const DatasetPtr& in, const Box3& box, bool outside, const PlaneCut& cut) {
  const std::vector<ImplicitFunction> planes = box_planes(box, in->bounds());
  DatasetPtr rest = outside && planes.size() > 1 ? with_names(in) : in;
  std::vector<Data> parts;
  for (size_t i = 0; i < planes.size(); ++i) {
    if (outside) {
      const DatasetPtr behind = cut(rest, planes[i], true);
      if (planes.size() == 1) return behind;
      if (behind->cell_count() > 0 || (parts.empty() && i + 1 == planes.size())) parts.push_back(behind);
      if (i + 1 == planes.size()) break;
    }
    rest = cut(rest, planes[i], false);
    if (rest->cell_count() == 0 && !outside) return rest;
  }
  if (!outside) return rest;
  Context quiet;
  const DatasetPtr all = parts.size() > 1 ? welded(append(parts, {.part = false}, quiet)) : std::get<DatasetPtr>(parts[0]);
  DatasetParts result = without_names(all)->parts();
  result.notes = in->notes();
  result.time = in->time();
  return make_dataset(std::move(result));
}

}  // namespace sg::clipping
