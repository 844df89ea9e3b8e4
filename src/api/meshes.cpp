// SPDX-License-Identifier: Apache-2.0
// Meshes from the caller's memory.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "api/held.h"
#include "io/mesh/amr_cover.h"

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

Data uniform_grid(std::array<size_t, 3> dims, const Placing& placing) {
  return guarded([&] {
    sg::UniformGrid g;
    g.dims = dims;
    const auto vec = [](const Vec3& v) { return sg::Vec3{v[0], v[1], v[2]}; };
    g.spacing = vec(placing.spacing), g.origin = vec(placing.origin);
    for (size_t a = 0; a < 3; ++a) {
      const sg::Vec3 axis = vec(placing.axes[a]);
      const double length = sg::length(axis);
      if (!(length > 0) || !std::isfinite(length))
        sg::fail_usage(fmt::format("the direction of {} has the length {}", "xyz"[a], length), "uniform_grid()",
                       "three axes that are not 0");
      for (int row = 0; row < 3; ++row) g.direction.m[row][a] = axis[row] / length;
    }
    if (!(std::abs(sg::determinant(g.direction)) > 1e-6))
      sg::fail_usage("the directions of its axes lie in a plane", "uniform_grid()", "three axes that span space");
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
    if (cells.cell_faces.count() > 0) {
      m.faces = lists_of(cells.face_ids, cells.face_offsets);
      m.polyhedron_faces = list_of(cells.cell_faces, "cell_faces").converted(sg::ElementType::i64);
    }
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

Data surface_mesh(Array points, const SurfaceCells& cells) {
  return guarded([&] {
    const auto lists = [](const SurfaceCells::Lists& l) { return l.offsets.count() == 0 ? sg::CellArray() : lists_of(l.ids, l.offsets); };
    sg::SurfaceMesh m;
    m.points = points_of(points);
    m.vertices = lists(cells.vertices), m.lines = lists(cells.lines);
    m.polygons = lists(cells.polygons), m.strips = lists(cells.strips);
    return from_mesh(std::move(m));
  });
}

Data point_cloud(Array points) {
  return guarded([&] { return from_mesh(sg::PointCloud{points_of(points)}); });
}

Data amr_grid(const std::vector<AmrLevel>& levels, Vec3 origin) {
  return guarded([&] {
    sg::AmrGrid grid;
    grid.origin = {origin[0], origin[1], origin[2]};
    if (levels.empty()) sg::fail_usage("has no levels", "amr_grid()");
    grid.dimension = levels[0].spacing[2] == 0 ? 2 : 3;
    for (size_t l = 0; l < levels.size(); ++l) {
      sg::AmrGrid::Level level;
      for (size_t a = 0; a < 3; ++a) {
        const bool flat = a == 2 && grid.dimension == 2;
        const double width = flat ? 1 : levels[l].spacing[a];
        level.spacing[int(a)] = width;
        const double ratio = l == 0 || flat ? 1 : levels[l - 1].spacing[a] / width;
        level.ratio[a] = int(std::clamp(std::round(ratio), -1.0, 1e6));
        if (!(width > 0) || !std::isfinite(width) || level.ratio[a] < 1 || std::abs(ratio - level.ratio[a]) > 1e-6 * ratio)
          sg::fail_usage(
              fmt::format("cells of level {} are {} long along {}", l, width, "xyz"[a]), "amr_grid()",
              l == 0 ? "a positive length" : fmt::format("a whole share of the {} of level {}", levels[l - 1].spacing[a], l - 1));
      }
      for (const AmrLevel::Patch& p : levels[l].patches) {
        sg::AmrGrid::Patch patch;
        std::copy(p.lo.begin(), p.lo.end(), patch.lo.begin()), std::copy(p.hi.begin(), p.hi.end(), patch.hi.begin());
        if (grid.dimension == 2) patch.lo[2] = patch.hi[2] = 0;
        level.patches.push_back(patch);
      }
      grid.levels.push_back(std::move(level));
    }
    sg::number_patches(grid);
    sg::DatasetParts parts;
    parts.cell_ghost = sg::refined_cells(grid);
    parts.mesh = std::move(grid);
    return data_from_memory(sg::make_dataset(std::move(parts)));
  });
}

}  // namespace sightglass
