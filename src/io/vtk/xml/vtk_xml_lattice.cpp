// SPDX-License-Identifier: Apache-2.0
// VTK XML image data, rectilinear and structured grids. Pieces are boxes of the whole extent; they share the layer of
// points where they touch. The grid that is read is the smallest box with all pieces, or the requested part of it (ReadOptions::region); of
// the pieces only what lies in that part is read.
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/parallel.h"
#include "io/vtk/vtk_cells.h"
#include "io/vtk/xml/vtk_xml_pieces.h"

namespace sg::vtk {

namespace {

using Index3 = std::array<long long, 3>;
using Size3 = std::array<size_t, 3>;

struct Extent {
  Index3 lo{0, 0, 0}, hi{-1, -1, -1};

  size_t points(size_t axis) const { return size_t(hi[axis] - lo[axis] + 1); }
  Size3 dims() const { return {points(0), points(1), points(2)}; }
  bool empty() const { return points(0) == 0 || points(1) == 0 || points(2) == 0; }
};

size_t product(const Size3& d) { return d[0] * d[1] * d[2]; }
Size3 cells_of(const Size3& points) {
  Size3 c;
  for (size_t a = 0; a < 3; ++a) c[a] = points[a] == 0 ? 0 : std::max<size_t>(points[a] - 1, 1);
  return c;
}

Extent parse_extent(const XmlFile& file, pugi::xml_node element, const char* attribute) {
  long long v[6];
  parse_longs(file, element, attribute, v, 6);
  Extent e;
  uint64_t n = 1;
  for (size_t a = 0; a < 3; ++a) {
    e.lo[a] = v[2 * a], e.hi[a] = v[2 * a + 1];
    constexpr long long most = 1ll << 60;
    if (e.lo[a] < -most || e.hi[a] > most || e.hi[a] < e.lo[a] - 1)
      file.fail(fmt::format("{} extends from {} to {} along {}", attribute, e.lo[a], e.hi[a], "xyz"[a]), element);
    if (!multiply(n, std::max<size_t>(e.points(a), 1), n) || n > uint64_t(1) << 62)
      file.fail(fmt::format("{} has too many points to count", attribute), element);
  }
  return e;
}

// The points, or the cells, that the grid will have, by their indices in the file.
struct Grid {
  Index3 base{0, 0, 0};
  Size3 count{0, 0, 0}, stride{1, 1, 1};
};

// What a piece gives to it: a window of the piece, and where that goes.
struct Share {
  Window window;
  Size3 at{0, 0, 0};
};

std::optional<Share> share_of(const Grid& grid, const Index3& lo, const Size3& dims) {
  Share s;
  s.window.dims = dims;
  s.window.stride = grid.stride;
  for (size_t a = 0; a < 3; ++a) {
    const auto step = static_cast<long long>(grid.stride[a]);
    const long long from = std::max(0ll, lo[a] - grid.base[a] + step - 1) / step;
    const long long last = lo[a] + static_cast<long long>(dims[a]) - 1 - grid.base[a];
    if (last < 0) return std::nullopt;
    const long long to = std::min(last / step, static_cast<long long>(grid.count[a]) - 1);
    if (to < from) return std::nullopt;
    s.at[a] = size_t(from);
    s.window.count[a] = size_t(to - from + 1);
    s.window.lo[a] = size_t(grid.base[a] + from * step - lo[a]);
  }
  return s;
}

struct Layout {
  std::vector<XmlPiece> pieces;
  std::vector<Extent> extents;
  Extent box;                                                   // of all pieces
  Size3 lo{0, 0, 0};                                            // the requested part, in points of the box
  Grid points, cells;                                           // what is made of it
  bool keep_cells = true;                                       // cells do not survive a stride
  std::vector<std::optional<Share>> point_shares, cell_shares;  // of the pieces

  Index3 start() const {
    Index3 r = box.lo;
    for (size_t a = 0; a < 3; ++a) r[a] = points.stride == Size3{1, 1, 1} ? r[a] + static_cast<long long>(lo[a]) : 0;
    return r;
  }
};

// A piece that is flat where the whole is not holds points only.
bool has_cells(const Extent& piece, const Extent& whole) {
  for (size_t a = 0; a < 3; ++a)
    if (piece.points(a) == 1 && whole.points(a) > 1) return false;
  return true;
}

void choose_region(const XmlRead& read, Layout& l) {
  const LatticeRegion& r = read.options.region;
  const Size3 dims = l.box.dims();
  for (size_t a = 0; a < 3; ++a) {
    if (r.stride[a] == 0) fail_usage("the stride is 0", read.file.path(), "use 1 to keep every point");
    const size_t last = std::min(r.hi[a], dims[a] - 1);
    if (r.lo[a] > last)
      fail_usage(fmt::format("points {} to {} along {} do not exist: the grid has {} points there", r.lo[a], r.hi[a], "xyz"[a], dims[a]),
                 read.file.path(), fmt::format("0 to {}", dims[a] - 1));
    const size_t stride = std::min(r.stride[a], dims[a]), cells = std::max<size_t>(dims[a], 2) - 1;
    l.lo[a] = r.lo[a];
    l.points.base[a] = l.box.lo[a] + static_cast<long long>(r.lo[a]);
    l.points.count[a] = (last - r.lo[a]) / stride + 1;
    l.points.stride[a] = stride;
    l.cells.base[a] = l.box.lo[a] + static_cast<long long>(std::min(r.lo[a], cells - 1));  // the last layer takes the preceding cells
    l.cells.count[a] = std::max<size_t>(l.points.count[a], 2) - 1;
    l.keep_cells = l.keep_cells && (stride == 1 || dims[a] == 1);
  }
  for (const Extent& e : l.extents) {
    l.point_shares.push_back(share_of(l.points, e.lo, e.dims()));
    l.cell_shares.push_back(l.keep_cells && has_cells(e, l.box) ? share_of(l.cells, e.lo, cells_of(e.dims())) : std::nullopt);
  }
}

// Pieces without anything to give are left out.
void drop_idle_pieces(Layout& l) {
  size_t kept = 0;
  for (size_t i = 0; i < l.pieces.size(); ++i) {
    if (!l.point_shares[i] && !l.cell_shares[i]) continue;
    l.pieces[kept] = l.pieces[i], l.extents[kept] = l.extents[i];
    l.point_shares[kept] = l.point_shares[i], l.cell_shares[kept] = l.cell_shares[i];
    ++kept;
  }
  l.pieces.resize(kept), l.extents.resize(kept), l.point_shares.resize(kept), l.cell_shares.resize(kept);
}

Layout lay_out(const XmlRead& read) {
  Layout l;
  const pugi::xml_node dataset = read.file.dataset();
  const Extent announced = parse_extent(read.file, dataset, "WholeExtent");
  for (const XmlPiece& p : read.pieces) {
    const Extent e = p.node.attribute("Extent") ? parse_extent(*p.file, p.node, "Extent") : announced;
    if (e.empty()) continue;
    l.pieces.push_back(p), l.extents.push_back(e);
  }
  if (l.pieces.empty()) {
    if (!announced.empty() && read.options.pieces == 1) read.file.fail("has no Piece", dataset, "the file is truncated or not complete");
    return l;
  }
  l.box = l.extents[0];
  uint64_t n = 1, sum = 0;
  for (const Extent& e : l.extents) {
    for (size_t a = 0; a < 3; ++a) {
      l.box.lo[a] = std::min(l.box.lo[a], e.lo[a]);
      l.box.hi[a] = std::max(l.box.hi[a], e.hi[a]);
    }
    if (!add(sum, product(e.dims()), sum)) sum = UINT64_MAX;
  }
  for (size_t a = 0; a < 3; ++a)
    if (!multiply(n, l.box.points(a), n)) read.file.fail("has pieces too far apart", dataset);
  if (n / 64 > sum) read.file.fail(fmt::format("has pieces of {} points in a box of {}", sum, n), dataset, "the pieces must touch");
  choose_region(read, l);
  drop_idle_pieces(l);
  return l;
}

// Points or cells, as the functions below handle both.
struct Side {
  Association association;
  const char* element;
  const Grid& grid;
  const std::vector<std::optional<Share>>& shares;
  uint8_t hidden;
};

// Copies the tuples of a piece for which `take` holds to their place in the whole.
template <class Take>
void place(const Array& from, const Share& s, const Size3& whole, std::byte* to, Take take) {
  const size_t tuple = size_t(from.components()) * element_size(from.type());
  const Size3& d = s.window.count;
  parallel_for(d[1] * d[2], 64, [&](size_t begin, size_t end) {
    for (size_t r = begin; r < end; ++r) {
      const size_t row = s.at[0] + whole[0] * (s.at[1] + r % d[1] + whole[1] * (s.at[2] + r / d[1]));
      take(row, from.raw() + r * d[0] * tuple, d[0], tuple, to + row * tuple);
    }
  });
}

void take_all(size_t, const std::byte* from, size_t n, size_t tuple, std::byte* to) { std::memcpy(to, from, n * tuple); }

// Which piece each tuple comes from, where pieces overlap with ghosts: the first that has it as its own, else the first at all.
struct Owners {
  static constexpr uint32_t none = UINT32_MAX;
  std::vector<uint32_t> piece;  // empty when there are no ghosts
};

Owners find_owners(const Layout& l, const Side& side, const std::vector<XmlField>& fields) {
  Owners o;
  const auto ghost = std::find_if(fields.begin(), fields.end(), [](const XmlField& f) { return is_ghost_name(f.field.name); });
  if (ghost == fields.end() || l.pieces.size() < 2) return o;
  o.piece.assign(product(side.grid.count), Owners::none);
  std::vector<uint8_t> own(o.piece.size(), 0);
  for (size_t i = 0; i < l.pieces.size(); ++i) {
    if (!side.shares[i]) continue;
    const Share& s = *side.shares[i];
    const Array bits = ghost->nodes[i] ? l.pieces[i].file->block(ghost->nodes[i], s.window).converted(ElementType::u8)
                                       : hollow(ElementType::u8, s.window.tuples(), 1).converted(ElementType::u8);
    place(bits, s, side.grid.count, nullptr, [&](size_t row, const std::byte* from, size_t n, size_t, std::byte*) {
      for (size_t k = 0; k < n; ++k) {
        const bool mine = (uint8_t(from[k]) & ghost_duplicate) == 0;
        if (o.piece[row + k] != Owners::none && (own[row + k] || !mine)) continue;
        o.piece[row + k] = uint32_t(i);
        own[row + k] = mine;
      }
    });
  }
  return o;
}

// One array of all pieces in the order of the grid; `read_share(i)` gives what piece i has.
template <class ReadShare>
Array assembled(const Layout& l, const Side& side, const Owners& owners, ElementType type, int components, ReadShare read_share) {
  if (l.pieces.size() == 1 && side.shares[0] && side.shares[0]->window.count == side.grid.count) return read_share(0);
  std::byte* out = nullptr;
  Array a = Array::make_raw(type, product(side.grid.count), components, &out);
  std::memset(out, 0, a.bytes());
  for (size_t i = 0; i < l.pieces.size(); ++i) {
    if (!side.shares[i]) continue;
    const Array part = read_share(i).made_packed();
    if (owners.piece.empty()) {
      place(part, *side.shares[i], side.grid.count, out, take_all);
      continue;
    }
    place(part, *side.shares[i], side.grid.count, out, [&](size_t row, const std::byte* from, size_t n, size_t tuple, std::byte* to) {
      for (size_t k = 0; k < n; ++k)
        if (owners.piece[row + k] == i) std::memcpy(to + k * tuple, from + k * tuple, tuple);
    });
  }
  return a;
}

// Points or cells that no piece covers are hidden; an empty array when there are none.
Array uncovered(const Layout& l, const Side& side) {
  const Array mask = assembled(l, side, {}, ElementType::u8, 1, [&](size_t i) {
    std::byte* one = nullptr;
    Array a = Array::make_raw(ElementType::u8, side.shares[i]->window.tuples(), 1, &one);
    std::memset(one, 1, a.bytes());
    return a;
  });
  const auto v = mask.view<uint8_t>();
  if (std::find(v.data, v.data + v.count, 0) == v.data + v.count) return {};
  uint8_t* out = nullptr;
  Array hidden = Array::make<uint8_t>(v.count, 1, &out);
  for (size_t i = 0; i < v.count; ++i) out[i] = v[i] ? 0 : side.hidden;
  return hidden;
}

void add_hidden(FieldSet& fields, Association association, const Array& hidden) {
  if (hidden.empty()) return;
  Field f{"vtkGhostType", association, hidden, {}, Role::none};
  if (const Field* have = fields.find(f.name, association)) {
    uint8_t* out = nullptr;
    const Array before = have->array.converted(ElementType::u8);
    f.array = Array::make<uint8_t>(hidden.count(), 1, &out);
    for (size_t i = 0; i < hidden.count(); ++i) out[i] = before.view<uint8_t>()[i] | hidden.view<uint8_t>()[i];
  }
  fields.add(std::move(f));
}

void put_fields(const XmlRead& read, const Layout& l, const Side& side, DatasetParts& parts) {
  const std::vector<XmlField> fields = list_fields(read, l.pieces, side.element, side.association);
  if (l.pieces.size() > 1) check_backed(l.pieces, {{}, ElementType::u8, 1, {l.pieces[0].node}}, product(side.grid.count) / 8);
  const Owners owners = find_owners(l, side, fields);
  for (const XmlField& f : fields) {
    read.context.check();
    Field field = f.field;
    if (header_only(read, f)) {
      check_backed(l.pieces, f, product(side.grid.count) / (l.pieces.size() > 1 ? 8 : 1));
      field.array = hollow(f.type, product(side.grid.count), f.components);
    } else {
      if (l.pieces.size() > 1) check_backed(l.pieces, f, product(side.grid.count) / 8);
      field.array = assembled(l, side, owners, f.type, f.components, [&](size_t i) {
        if (f.nodes[i]) return l.pieces[i].file->block(f.nodes[i], side.shares[i]->window);
        return hollow(f.type, side.shares[i]->window.tuples(), f.components);
      });
    }
    parts.fields.add(std::move(field));
  }
  if (l.pieces.size() > 1) add_hidden(parts.fields, side.association, uncovered(l, side));
}

void put_all_fields(const XmlRead& read, const Layout& l, DatasetParts& parts) {
  if (l.pieces.empty()) return;
  put_fields(read, l, {Association::point, "PointData", l.points, l.point_shares, ghost_hidden_point}, parts);
  if (l.keep_cells) return put_fields(read, l, {Association::cell, "CellData", l.cells, l.cell_shares, ghost_hidden_cell}, parts);
  std::vector<XmlField> dropped = list_fields(read, l.pieces, "CellData", Association::cell);
  std::erase_if(dropped, [](const XmlField& f) { return is_ghost_name(f.field.name); });
  if (const size_t n = dropped.size())
    parts.notes.emplace_back("crop", fmt::format("{} cell fields were left out: a stride keeps points, not cells", n));
}

}  // namespace

void read_image(const XmlRead& read, DatasetParts& parts) {
  const Layout l = lay_out(read);
  UniformGrid g;
  g.dims = l.points.count;
  double v[9];
  const pugi::xml_node dataset = read.file.dataset();
  if (parse_doubles(read.file, dataset, "Origin", v, 3)) g.origin = {v[0], v[1], v[2]};
  if (parse_doubles(read.file, dataset, "Spacing", v, 3)) g.spacing = {v[0], v[1], v[2]};
  if (parse_doubles(read.file, dataset, "Direction", v, 9))
    for (int i = 0; i < 9; ++i) g.direction.m[i / 3][i % 3] = v[i];
  if (l.box.lo != Index3{0, 0, 0}) {
    const Vec3 first(double(l.box.lo[0]), double(l.box.lo[1]), double(l.box.lo[2]));
    g.origin += g.direction * (g.spacing * first);
  }
  g.extent_start = l.start();
  if (!read.options.region.whole()) {
    Vec3 stride;
    for (size_t a = 0; a < 3; ++a) stride[int(a)] = double(l.points.stride[a]);
    g.origin += g.direction * (g.spacing * Vec3(double(l.lo[0]), double(l.lo[1]), double(l.lo[2])));
    g.spacing = g.spacing * stride;
  }
  parts.mesh = g;
  put_all_fields(read, l, parts);
}

void read_rectilinear(const XmlRead& read, DatasetParts& parts) {
  const Layout l = lay_out(read);
  RectilinearGrid g;
  g.extent_start = l.start();
  Array* axes[3] = {&g.x, &g.y, &g.z};
  std::vector<double> merged[3];
  bool narrow = true;
  for (size_t p = 0; p < l.pieces.size(); ++p) {
    const XmlFile& file = *l.pieces[p].file;
    pugi::xml_node n = l.pieces[p].node.child("Coordinates").child("DataArray");
    for (size_t a = 0; a < 3; ++a, n = n.next_sibling("DataArray")) {
      if (!n) file.fail("does not have three arrays of Coordinates", l.pieces[p].node, "the file is truncated or not complete");
      if (!l.point_shares[p]) continue;  // gives cells only
      const Share& s = *l.point_shares[p];
      const Window w{{l.extents[p].points(a), 1, 1}, {s.window.lo[a], 0, 0}, {s.window.count[a], 1, 1}, {s.window.stride[a], 1, 1}};
      const Array part = as_coordinates(file.block(n, w));
      if (l.pieces.size() == 1) {
        *axes[a] = part;
        continue;
      }
      // Gaps between pieces would leave coordinates unknown, so NaN: validate() names them.
      merged[a].resize(l.points.count[a], std::numeric_limits<double>::quiet_NaN());
      for (size_t i = 0; i < part.count(); ++i) merged[a][s.at[a] + i] = part.get(i);
      narrow = narrow && part.type() == ElementType::f32;
    }
  }
  for (size_t a = 0; a < 3 && l.pieces.size() > 1; ++a) {
    *axes[a] = Array::from_vector(std::move(merged[a]));
    if (narrow) *axes[a] = axes[a]->converted(ElementType::f32);
  }
  parts.mesh = g;
  put_all_fields(read, l, parts);
}

void read_curvilinear(const XmlRead& read, DatasetParts& parts) {
  const Layout l = lay_out(read);
  CurvilinearGrid g;
  g.dims = l.points.count;
  g.extent_start = l.start();
  std::vector<pugi::xml_node> nodes;
  bool wide = false;
  for (size_t i = 0; i < l.pieces.size(); ++i) {
    nodes.push_back(points_array(l.pieces[i], product(l.extents[i].dims())));
    const ElementType t = l.pieces[i].file->number_type(nodes.back()).first;
    wide = wide || t == ElementType::f64 || (!is_float(t) && element_size(t) >= 4);
  }
  if (!l.pieces.empty()) {
    const ElementType type = wide ? ElementType::f64 : ElementType::f32;
    const Side side{Association::point, "", l.points, l.point_shares, 0};
    if (l.pieces.size() > 1) check_backed(l.pieces, {{}, type, 3, nodes}, product(l.points.count) / 8);
    g.points.xyz = assembled(l, side, {}, type, 3, [&](size_t i) {
      return as_coordinates(l.pieces[i].file->block(nodes[i], side.shares[i]->window)).converted(type);
    });
  }
  parts.mesh = g;
  put_all_fields(read, l, parts);
}

}  // namespace sg::vtk
