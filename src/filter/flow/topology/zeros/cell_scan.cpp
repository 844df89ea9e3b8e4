// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/zeros/cell_scan.h"

#include <algorithm>

#include "base/huge_allocator.h"
#include "base/parallel.h"
#include "data/cells/cell_reader.h"
#include "data/cells/cell_topology.h"
#include "data/lattice.h"

namespace sg {

namespace {

// Two bits a component: above zero, below zero; what is but rounding counts as zero. NaN has all: it excludes nothing here, the search
// refuses it.
uint8_t signs_of(Vec3 v, int components, double noise) {
  uint8_t bits = 0;
  for (int c = 0; c < components; ++c) bits |= uint8_t((v[c] > noise) << (2 * c) | (v[c] < -noise) << (2 * c + 1));
  const double sum = v.x + v.y + v.z;
  return std::isfinite(sum) ? bits : uint8_t(0xff);
}

// Part of the points and cells that are numbered like a grid.
struct Block {
  std::array<size_t, 3> points, cells;
  size_t first_point, first_cell;
};

using Found = std::vector<std::vector<uint64_t>>;

std::vector<uint64_t> joined(const Found& parts) {
  std::vector<uint64_t> all;
  size_t n = 0;
  for (const auto& p : parts) n += p.size();
  all.reserve(n);
  for (const auto& p : parts) all.insert(all.end(), p.begin(), p.end());
  return all;
}

void scan_block(const Block& b, const uint8_t* signs, std::vector<uint64_t>& out, Context& context) {
  const auto [nx, ny, nz] = b.points;
  const auto [cx, cy, cz] = b.cells;
  const size_t rows = cy * cz, grain = std::max<size_t>(1, 65536 / std::max<size_t>(cx, 1));
  Found parts((rows + grain - 1) / grain);
  parallel_for(
      rows, grain,
      [&, nx = nx, ny = ny, nz = nz, cx = cx, cy = cy](size_t begin, size_t end) {
        std::vector<uint8_t> bits(nx);
        auto& found = parts[begin / grain];
        for (size_t row = begin; row < end; ++row) {
          const size_t j = row % cy, k = row / cy, up = ny > 1 ? nx : 0, over = nz > 1 ? nx * ny : 0;
          const uint8_t* p = signs + b.first_point + nx * (j + ny * k);
          for (size_t i = 0; i < nx; ++i) bits[i] = uint8_t(p[i] & p[i + up] & p[i + over] & p[i + up + over]);
          const size_t side = nx > 1 ? 1 : 0;
          for (size_t i = 0; i < cx; ++i)
            if (!(bits[i] & bits[i + side])) found.push_back(b.first_cell + cx * row + i);
        }
      },
      &context);
  const auto all = joined(parts);
  out.insert(out.end(), all.begin(), all.end());
}

// Mean value weights of polygons and polyhedra that are not convex may be negative.
bool is_hollow(CellReader& cell, const std::vector<uint32_t>& ring) {
  const auto at = cell.at();
  auto turns = [&](std::span<const uint32_t> face, Vec3 inside) {
    Vec3 area;
    for (size_t k = 1; k + 1 < face.size(); ++k) area += cross(at[face[k]] - at[face[0]], at[face[k + 1]] - at[face[0]]);
    const double noise = 1e-9 * dot(area, area);
    for (size_t k = 0; k < face.size(); ++k) {
      const Vec3 a = at[face[k]], b = at[face[(k + 1) % face.size()]], c = at[face[(k + 2) % face.size()]];
      if (dot(cross(b - a, c - b), area) < -noise) return true;
    }
    if (cell.dimension() == 2) return false;
    // All corners on the side of the middle.
    const double side = dot(inside - at[face[0]], area), reach = 1e-9 * length(area) * std::sqrt(length(area));
    return std::any_of(at.begin(), at.end(), [&](Vec3 p) { return dot(p - at[face[0]], area) * (side < 0 ? -1 : 1) < -reach; });
  };
  if (cell.dimension() == 2) return turns(ring, {});
  Vec3 middle;
  for (const Vec3 p : at) middle += p / double(at.size());
  for (size_t f = 0, n = cell.face_count(); f < n; ++f) {
    const auto face = cell.face(f);
    if (face.size() >= 3 && turns(face, middle)) return true;
  }
  return false;
}

// Cells that may have a zero whatever the signs are; one per thread.
class Unsure {
 public:
  explicit Unsure(const DatasetPtr& data) : reader_(data) {}
  bool operator()(size_t cell, CellType type) {
    if (is_high_order(type)) return true;
    if (type != CellType::polygon && type != CellType::polyhedron) return false;
    reader_.open(cell);
    ring_.clear();
    if (type == CellType::polygon) {
      if (reader_.ids().size() <= 3) return false;
      face_outline(type, reader_.ids().size(), ring_, reader_.orders());
    }
    return is_hollow(reader_, ring_);
  }

 private:
  CellReader reader_;
  std::vector<uint32_t> ring_;
};

template <class TypeOf>
std::vector<uint64_t> scan_lists(const DatasetPtr& data, const CellsView& cells, size_t first, const uint8_t* signs, Context& context,
                                 const TypeOf& type_of) {
  constexpr size_t grain = 16384;
  Found parts((cells.count + grain - 1) / grain);
  parallel_for(
      cells.count, grain,
      [&](size_t begin, size_t end) {
        Unsure unsure(data);
        for (size_t c = begin; c < end; ++c) {
          uint8_t bits = 0xff;
          for (size_t i = cells.begin(c); i < cells.end(c); ++i) bits &= signs[cells.connectivity[i]];
          if (!bits || unsure(first + c, type_of(c))) parts[begin / grain].push_back(first + c);
        }
      },
      &context);
  return joined(parts);
}

}  // namespace

std::vector<uint64_t> cells_that_may_vanish(const FlowField& flow, const PlaneFrame* frame, Context& context) {
  const Dataset& d = *flow.dataset();
  const double noise = 1e-13 * flow.largest_speed();
  Plane<uint8_t> signs(d.point_count());
  parallel_for(
      signs.size(), 65536,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          const Vec3 v = flow.at_point(i);
          signs[i] = frame ? signs_of({dot(v, frame->e1), dot(v, frame->e2), 0}, 2, noise) : signs_of(v, 3, noise);
        }
      },
      &context);
  std::vector<uint64_t> out;
  if (is_lattice(d.mesh())) {
    const auto n = lattice_dims(d.mesh());
    scan_block({n, {std::max<size_t>(n[0], 2) - 1, std::max<size_t>(n[1], 2) - 1, std::max<size_t>(n[2], 2) - 1}, 0, 0}, signs.data(), out,
               context);
  } else if (const auto* amr = d.as<AmrGrid>()) {
    for (const auto& level : amr->levels)
      for (const auto& patch : level.patches) {
        const auto c = patch.cells();
        const std::array<size_t, 3> n{c[0] + 1, c[1] + 1, amr->dimension == 3 ? c[2] + 1 : 1};
        scan_block({n, c, patch.point_offset, patch.cell_offset}, signs.data(), out, context);
      }
    std::sort(out.begin(), out.end());
  } else if (const auto* u = d.as<UnstructuredMesh>()) {
    out = scan_lists(flow.dataset(), cells_view(u->cells), 0, signs.data(), context, [&](size_t c) { return u->type(c); });
  } else if (const auto* s = d.as<SurfaceMesh>()) {
    size_t first = 0;
    for (const CellArray* list : {&s->vertices, &s->lines, &s->polygons, &s->strips}) {
      const CellType type = list == &s->polygons ? CellType::polygon : CellType::empty;
      const auto more = scan_lists(flow.dataset(), cells_view(*list), first, signs.data(), context, [&](size_t) { return type; });
      out.insert(out.end(), more.begin(), more.end());
      first += list->size();
    }
  }
  return out;
}

}  // namespace sg
