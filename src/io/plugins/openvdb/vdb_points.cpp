// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <openvdb/points/PointCount.h>
#include <openvdb/points/PointDataGrid.h>

#include <algorithm>

#include "base/error.h"
#include "base/file/file.h"
#include "io/plugins/openvdb/vdb.h"

namespace sg {

namespace {

using openvdb::points::AttributeArray;
using openvdb::points::AttributeHandle;
using openvdb::points::PointDataGrid;

// One attribute of all points, leaf by leaf in the tree's order.
template <class Stored, class T, int N>
Array attribute(const PointDataGrid& grid, const std::string& name, size_t count) {
  T* out = nullptr;
  Array a = Array::make<T>(count, N, &out);
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    const auto handle = AttributeHandle<Stored>::create(leaf->constAttributeArray(name));
    for (auto i = leaf->beginIndexOn(); i; ++i) {
      const Stored v = handle->get(*i);
      if constexpr (N == 3) *out++ = v[0], *out++ = v[1], *out++ = v[2];
      else *out++ = T(v);
    }
  }
  return a;
}

Array numbers_of(const PointDataGrid& grid, const std::string& name, const std::string& type, size_t count) {
  using namespace openvdb;
  if (type == "float") return attribute<float, float, 1>(grid, name, count);
  if (type == "half") return attribute<math::half, float, 1>(grid, name, count);
  if (type == "double") return attribute<double, double, 1>(grid, name, count);
  if (type == "int16") return attribute<int16_t, int16_t, 1>(grid, name, count);
  if (type == "int32") return attribute<int32_t, int32_t, 1>(grid, name, count);
  if (type == "int64") return attribute<int64_t, int64_t, 1>(grid, name, count);
  if (type == "int8") return attribute<int8_t, int8_t, 1>(grid, name, count);
  if (type == "bool") return attribute<bool, uint8_t, 1>(grid, name, count);
  if (type == "vec3s") return attribute<Vec3f, float, 3>(grid, name, count);
  if (type == "vec3d") return attribute<Vec3d, double, 3>(grid, name, count);
  if (type == "vec3i") return attribute<math::Vec3<int32_t>, int32_t, 3>(grid, name, count);
  return {};
}

}  // namespace

bool is_vdb_points(const openvdb::GridBase& grid) { return grid.isType<PointDataGrid>(); }

DatasetPtr vdb_points(const openvdb::GridBase& base, const std::string& path, const ReadOptions& options, Context& context) {
  const auto& grid = static_cast<const PointDataGrid&>(base);
  const size_t count = size_t(openvdb::points::pointCount(grid.tree()));
  DatasetParts out;
  // Offsets from the middle of the box keep their digits as f32.
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  const auto center = box.empty() ? openvdb::Vec3d(0, 0, 0) : grid.transform().indexToWorld(box.getCenter());
  float* xyz = nullptr;
  PointCloud cloud;
  cloud.points.xyz = Array::make<float>(count, 3, &xyz);
  cloud.points.origin = {center[0], center[1], center[2]};
  size_t done = 0;
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    const auto handle = AttributeHandle<openvdb::Vec3f>::create(leaf->constAttributeArray("P"));
    for (auto i = leaf->beginIndexOn(); i; ++i) {
      if (++done > count) fail_data(fmt::format("has more points than the {} in its leaves", count), path);
      const openvdb::Vec3f inside = handle->get(*i);
      const auto p = grid.transform().indexToWorld(openvdb::Vec3d(inside) + i.getCoord().asVec3d()) - center;
      for (int a = 0; a < 3; ++a) *xyz++ = float(p[a]);
    }
  }
  if (done != count) fail_data(fmt::format("has {} points, but its leaves have {}", done, count), path);
  out.mesh = std::move(cloud);
  if (auto leaf = grid.tree().cbeginLeaf(); leaf && !options.header_only) {
    const auto& descriptor = leaf->attributeSet().descriptor();
    for (const auto& [name, at] : descriptor.map()) {
      const bool wanted = options.fields.empty() || std::find(options.fields.begin(), options.fields.end(), name) != options.fields.end();
      if (name == "P" || !wanted) continue;
      const AttributeArray& array = *leaf->attributeSet().getConst(at);
      Array a;
      if (array.stride() == 1 && !openvdb::points::isGroup(array) && !openvdb::points::isString(array))
        a = numbers_of(grid, name, descriptor.valueType(at), count);
      if (a.count() == count && count > 0) out.fields.add({name, Association::point, std::move(a), "", Role::none});
      else if (!openvdb::points::isGroup(array))
        context.info(fmt::format("{}: attribute '{}' of type {} is left out", path, name, descriptor.valueType(at)));
    }
  }
  return make_dataset(std::move(out));
}

}  // namespace sg
