// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/select/piece.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "data/lattice.h"
#include "data/lattice_crop.h"
#include "filter/mesh/select/extract.h"

namespace sg {

namespace {

DatasetPtr with_ghosts(const DatasetPtr& d, const std::vector<uint8_t>& duplicate) {
  DatasetParts parts = d->parts();
  std::vector<uint8_t> ghost(d->cell_count(), 0);
  for (size_t i = 0; i < ghost.size(); ++i) {
    if (!parts.cell_ghost.empty()) ghost[i] = uint8_t(parts.cell_ghost.get(i));
    if (duplicate[i]) ghost[i] |= ghost_duplicate;
  }
  parts.cell_ghost = Array::from_vector(std::move(ghost));
  return make_dataset(std::move(parts));
}

DatasetPtr with_point_ghosts(const DatasetPtr& d, std::vector<uint8_t> duplicate) {
  DatasetParts parts = d->parts();
  for (size_t i = 0; i < duplicate.size(); ++i) {
    duplicate[i] = duplicate[i] ? uint8_t(ghost_duplicate) : uint8_t(0);
    if (!parts.point_ghost.empty()) duplicate[i] |= uint8_t(parts.point_ghost.get(i));
  }
  parts.point_ghost = Array::from_vector(std::move(duplicate));
  return make_dataset(std::move(parts));
}

struct Run {
  size_t begin, end;
};
Run share(size_t n, int piece, int pieces) {
  return {size_t(uint64_t(n) * uint64_t(piece) / uint64_t(pieces)), size_t(uint64_t(n) * uint64_t(piece + 1) / uint64_t(pieces))};
}

DatasetPtr lattice_piece(const DatasetPtr& in, int piece, int pieces, size_t ghosts, bool mark_points) {
  const auto dims = lattice_dims(in->mesh());
  size_t axis = 0;
  for (size_t a = 1; a < 3; ++a)
    if (dims[a] > dims[axis]) axis = a;
  const size_t cells = std::max<size_t>(dims[axis], 2) - 1;
  const Run own = share(cells, piece, pieces);
  if (own.begin == own.end) return extract_cells(in, {}, "piece");
  const size_t first = own.begin - std::min(own.begin, ghosts), last = std::min(cells, own.end + ghosts);  // cells [first, last)
  std::array<size_t, 3> lo{0, 0, 0}, hi{SIZE_MAX, SIZE_MAX, SIZE_MAX};
  lo[axis] = first, hi[axis] = dims[axis] > 1 ? last : 0;
  DatasetPtr part = crop_lattice(*in, lo, hi);
  if (mark_points && (own.begin > 0 || last > own.end)) {
    const auto n = lattice_dims(part->mesh());
    const size_t step = axis == 0 ? 1 : axis == 1 ? n[0] : n[0] * n[1];
    std::vector<uint8_t> duplicate(part->point_count());
    for (size_t p = 0; p < duplicate.size(); ++p) {
      const size_t plane = first + p / step % n[axis];
      duplicate[p] = (own.begin > 0 && plane <= own.begin) || plane > own.end;
    }
    part = with_point_ghosts(part, std::move(duplicate));
  }
  if (first == own.begin && last == own.end) return part;
  std::array<size_t, 3> n;
  for (size_t a = 0; a < 3; ++a) n[a] = std::max<size_t>(lattice_dims(part->mesh())[a], 2) - 1;
  std::vector<uint8_t> duplicate(part->cell_count());
  for (size_t c = 0; c < duplicate.size(); ++c) {
    const size_t at[3] = {c % n[0], c / n[0] % n[1], c / (n[0] * n[1])};
    duplicate[c] = first + at[axis] < own.begin || first + at[axis] >= own.end;
  }
  return with_ghosts(part, duplicate);
}

// Calls f(point) for each point of a cell.
template <class F>
void each_point(const DatasetPtr& d, size_t cell, F&& f) {
  if (auto* u = d->as<UnstructuredMesh>()) {
    const CellsView v = cells_view(u->cells);
    for (size_t k = v.begin(cell); k < v.end(cell); ++k) f(size_t(v.connectivity[k]));
  } else if (auto* s = d->as<SurfaceMesh>()) {
    for (const CellArray* kind : {&s->vertices, &s->lines, &s->polygons, &s->strips}) {
      if (cell >= kind->size()) {
        cell -= kind->size();
        continue;
      }
      const CellsView v = cells_view(*kind);
      for (size_t k = v.begin(cell); k < v.end(cell); ++k) f(size_t(v.connectivity[k]));
      return;
    }
  }
}

// Which points of the part have no cell of this piece, or one of a piece before. `kept`: the cells of the part, ascending.
std::vector<uint8_t> points_of_others(const DatasetPtr& in, const DatasetPtr& part, const std::vector<int64_t>& kept, const Run& own) {
  constexpr size_t none = SIZE_MAX;
  std::vector<size_t> first(in->point_count(), none);  // cell at each point
  const size_t n = in->cell_count();
  for (size_t c = 0; c < std::min(n, own.end); ++c) each_point(in, c, [&](size_t p) { first[p] = std::min(first[p], c); });
  std::vector<uint8_t> others(part->point_count(), 0);
  // The points of the part's cells stand in the order of those of the whole.
  std::vector<size_t> ids;
  for (size_t k = 0; k < kept.size(); ++k) {
    ids.clear();
    each_point(in, size_t(kept[k]), [&](size_t p) { ids.push_back(p); });
    size_t i = 0;
    each_point(part, k, [&](size_t p) {
      const size_t c = first[ids[i++]];
      others[p] = c == none || c < own.begin || c >= own.end;
    });
  }
  return others;
}

DatasetPtr listed_piece(const DatasetPtr& in, int piece, int pieces, int ghosts, bool mark_points) {
  const bool cloud = in->as<PointCloud>() != nullptr;
  const size_t n = cloud ? in->point_count() : in->cell_count();
  const Run own = share(n, piece, pieces);
  if (mark_points && ghosts > 0 && in->as<AmrGrid>()) {  // cells of different patches share no points
    std::vector<uint8_t> duplicate(n, 1);
    std::fill(duplicate.begin() + ptrdiff_t(own.begin), duplicate.begin() + ptrdiff_t(own.end), uint8_t(0));
    return with_ghosts(in, duplicate);
  }
  std::vector<uint8_t> taken(n, 0), touched(in->point_count(), 0);
  std::fill(taken.begin() + ptrdiff_t(own.begin), taken.begin() + ptrdiff_t(own.end), uint8_t(1));
  for (int level = 0; level < ghosts; ++level) {
    for (size_t c = 0; c < n; ++c)
      if (taken[c]) each_point(in, c, [&](size_t p) { touched[p] = 1; });
    for (size_t c = 0; c < n; ++c)
      if (!taken[c]) each_point(in, c, [&](size_t p) { taken[c] |= touched[p] * 2; });
  }
  std::vector<int64_t> cells;
  std::vector<uint8_t> duplicate;
  for (size_t c = 0; c < n; ++c)
    if (taken[c]) cells.push_back(int64_t(c)), duplicate.push_back(c < own.begin || c >= own.end);
  DatasetPtr part = extract_cells(in, cells, "piece");
  if (mark_points && !cloud && !in->as<AmrGrid>() && part->cell_count() == cells.size() && pieces > 1)
    part = with_point_ghosts(part, points_of_others(in, part, cells, own));
  return ghosts > 0 && !cloud && part->cell_count() == duplicate.size() ? with_ghosts(part, duplicate) : part;
}

}  // namespace

namespace {

DatasetPtr take(const DatasetPtr& in, int piece, int pieces, int ghost_levels, bool mark_points) {
  if (piece < 0 || piece >= pieces) fail_usage(fmt::format("there is no piece {} of {}", piece, pieces), "piece", "pieces count from 0");
  if (pieces == 1) return in;
  return is_lattice(in->mesh()) ? lattice_piece(in, piece, pieces, size_t(ghost_levels), mark_points)
                                : listed_piece(in, piece, pieces, ghost_levels, mark_points);
}

}  // namespace

DatasetPtr take_piece(const DatasetPtr& in, int piece, int pieces, int ghost_levels, Context&) {
  return take(in, piece, pieces, ghost_levels, false);
}

DatasetPtr take_share(const DatasetPtr& in, int piece, int pieces, int ghost_levels, Context&) {
  return take(in, piece, pieces, ghost_levels, true);
}

namespace {

// What is shared out: cells, or the points of a cloud.
size_t parts_of(const Dataset& d) { return d.as<PointCloud>() ? d.point_count() : d.cell_count(); }

Data cut(const Data& data, int pieces, Context& context) {
  auto parts = std::make_shared<Collection>();
  if (auto* c = std::get_if<CollectionPtr>(&data)) {
    if (*c)
      for (const Collection::Part& p : (*c)->parts) parts->parts.push_back({p.name, cut(p.data, pieces, context)});
    return parts;
  }
  auto* d = std::get_if<DatasetPtr>(&data);
  if (!d || !*d || parts_of(**d) < 2) return data;  // tables, and what cannot be cut
  const int most = int(std::min<size_t>(size_t(pieces), parts_of(**d)));
  for (int k = 0; k < most; ++k) {
    context.check();
    DatasetPtr part = take_piece(*d, k, most, 0, context);
    if (parts_of(*part) > 0) parts->parts.push_back({std::to_string(k), std::move(part)});
  }
  return parts;
}

}  // namespace

Data in_pieces(const Data& data, int pieces, Context& context) {
  if (pieces < 1) fail_usage(fmt::format("{} pieces", pieces), "pieces", "give at least 1");
  return pieces == 1 ? data : cut(data, pieces, context);
}

}  // namespace sg
