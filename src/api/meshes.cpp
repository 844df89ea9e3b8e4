// SPDX-License-Identifier: Apache-2.0
// Meshes from the caller's memory.
#include <fmt/format.h>

#include "api/held.h"

namespace sightglass {

namespace {

// The same numbers as tuples of `components`.
sg::Array retupled(const sg::Array& a, int components, const char* what) {
  if (a.components() == components || a.count() == 0) return a;
  const sg::Array packed = a.made_packed();
  const size_t numbers = packed.count() * size_t(packed.components());
  if (numbers % size_t(components) != 0)
    sg::fail_usage(fmt::format("{} numbers are no {} of {}", numbers, what, components), what, fmt::format("{} numbers each", components));
  sg::Buffer rest = packed.buffer();
  rest.size -= size_t(packed.raw() - rest.data), rest.data = packed.raw();
  return {std::move(rest), packed.type(), numbers / size_t(components), components};
}

sg::Points points_of(const Array& a) {
  const sg::Array xyz = retupled(a.held().array, 3, "points");
  return {sg::is_float(xyz.type()) ? xyz : xyz.converted(sg::ElementType::f64), {0, 0, 0}};
}

// One list of whole numbers, i32 or i64.
sg::Array list_of(const Array& a, const char* what) {
  const sg::Array flat = retupled(a.held().array, 1, what).made_packed();
  if (flat.type() == sg::ElementType::i32 || flat.type() == sg::ElementType::i64) return flat;
  if (sg::is_float(flat.type()) && flat.count() > 0)
    sg::fail_usage(fmt::format("{} are {}, not whole numbers", what, sg::element_name(flat.type())), what, "i32 or i64");
  return flat.converted(sg::ElementType::i64);
}

sg::CellArray lists_of(const Array& ids, const Array& offsets) {
  sg::CellArray cells;
  cells.connectivity = list_of(ids, "ids");
  cells.offsets = list_of(offsets, "offsets");
  return cells;
}

Data from_mesh(sg::Mesh mesh) { return data_from_memory(sg::make_dataset(std::move(mesh))); }

}  // namespace

Data uniform_grid(std::array<size_t, 3> dims, Vec3 spacing, Vec3 origin) {
  return guarded([&] {
    sg::UniformGrid g;
    g.dims = dims;
    g.spacing = {spacing[0], spacing[1], spacing[2]};
    g.origin = {origin[0], origin[1], origin[2]};
    return from_mesh(std::move(g));
  });
}

Data rectilinear_grid(Array x, Array y, Array z) {
  return guarded([&] {
    auto axis = [](const Array& a) {
      const sg::Array one = retupled(a.held().array, 1, "coordinates");
      return sg::is_float(one.type()) ? one : one.converted(sg::ElementType::f64);
    };
    sg::RectilinearGrid g;
    g.x = axis(x), g.y = axis(y), g.z = axis(z);
    return from_mesh(std::move(g));
  });
}

Data curvilinear_grid(std::array<size_t, 3> dims, Array points) {
  return guarded([&] {
    sg::CurvilinearGrid g;
    g.dims = dims;
    g.points = points_of(points);
    return from_mesh(std::move(g));
  });
}

Data unstructured_mesh(Array points, Cells cells) {
  return guarded([&] {
    sg::UnstructuredMesh m;
    m.points = points_of(points);
    m.cells = lists_of(cells.ids, cells.offsets);
    const sg::Array types = retupled(cells.types.held().array, 1, "types").made_packed();
    m.types = types.type() == sg::ElementType::u8 ? types : types.converted(sg::ElementType::u8);
    return from_mesh(std::move(m));
  });
}

Data unstructured_mesh(Array points, Cell type, Array ids) {
  return guarded([&] {
    const sg::CellTypeInfo* info = sg::cell_type_info(uint8_t(type));
    if (!info || info->points < 1)
      sg::fail_usage(fmt::format("cells of type {} have no fixed number of points", int(type)), "unstructured_mesh()",
                     "state offsets and types with Cells");
    sg::UnstructuredMesh m;
    m.points = points_of(points);
    m.cells.connectivity = list_of(ids, "ids");
    m.cells.fixed = info->points;
    m.single_type = sg::CellType(uint8_t(type));
    return from_mesh(std::move(m));
  });
}

Data triangle_mesh(Array points, Array ids) {
  return guarded([&] {
    sg::SurfaceMesh m;
    m.points = points_of(points);
    m.polygons.connectivity = list_of(ids, "ids");
    m.polygons.fixed = 3;
    return from_mesh(std::move(m));
  });
}

Data polygon_mesh(Array points, Array ids, Array offsets) {
  return guarded([&] {
    sg::SurfaceMesh m;
    m.points = points_of(points);
    m.polygons = lists_of(ids, offsets);
    return from_mesh(std::move(m));
  });
}

Data line_mesh(Array points, Array ids, Array offsets) {
  return guarded([&] {
    sg::SurfaceMesh m;
    m.points = points_of(points);
    m.lines = lists_of(ids, offsets);
    return from_mesh(std::move(m));
  });
}

Data point_cloud(Array points) {
  return guarded([&] { return from_mesh(sg::PointCloud{points_of(points)}); });
}

}  // namespace sightglass
