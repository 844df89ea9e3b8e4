// SPDX-License-Identifier: Apache-2.0
// VTK XML image data, rectilinear and structured grids. Pieces are boxes of the whole extent; they share the layer of
// points where they touch. The grid that is read is the smallest box with all pieces of the file.
#include "base/bytes.h"
#include "base/parallel.h"
#include "io/vtk_cells.h"
#include "io/vtk_xml_pieces.h"

namespace sg::vtk {

namespace {

struct Extent {
  std::array<long long, 3> lo{0, 0, 0}, hi{-1, -1, -1};

  size_t points(size_t axis) const { return size_t(hi[axis] - lo[axis] + 1); }
  size_t cells(size_t axis) const { return points(axis) == 0 ? 0 : std::max<size_t>(points(axis) - 1, 1); }
  std::array<size_t, 3> dims(bool cell) const {
    return cell ? std::array{cells(0), cells(1), cells(2)} : std::array{points(0), points(1), points(2)};
  }
  bool empty() const { return points(0) == 0 || points(1) == 0 || points(2) == 0; }
};

size_t product(const std::array<size_t, 3>& d) { return d[0] * d[1] * d[2]; }

Extent parse_extent(const XmlFile& file, pugi::xml_node element, const char* attribute) {
  long long v[6];
  parse_longs(file, element, attribute, v, 6);
  Extent e;
  uint64_t n = 1;
  for (size_t a = 0; a < 3; ++a) {
    e.lo[a] = v[2 * a], e.hi[a] = v[2 * a + 1];
    constexpr long long most = 1ll << 60;
    if (e.lo[a] < -most || e.hi[a] > most || e.hi[a] < e.lo[a] - 1)
      file.fail(fmt::format("{} runs from {} to {} along {}", attribute, e.lo[a], e.hi[a], "xyz"[a]), element);
    if (!multiply(n, std::max<size_t>(e.points(a), 1), n) || n > uint64_t(1) << 62)
      file.fail(fmt::format("{} has more points than can be counted", attribute), element);
  }
  return e;
}

struct Piece {
  pugi::xml_node element;
  Extent extent;
};

struct Pieces {
  std::vector<Piece> list;
  Extent whole;
  std::vector<FieldSet> fields;
};

Pieces read_pieces(const XmlRead& read) {
  Pieces pieces;
  const pugi::xml_node dataset = read.file.dataset();
  const Extent announced = parse_extent(read.file, dataset, "WholeExtent");
  for (const pugi::xml_node& element : dataset.children("Piece")) {
    const Extent e = element.attribute("Extent") ? parse_extent(read.file, element, "Extent") : announced;
    if (e.empty()) continue;
    pieces.list.push_back({element, e});
  }
  if (pieces.list.empty()) {
    if (!announced.empty()) read.file.fail("has no Piece", dataset, "the file is truncated or not complete");
    return pieces;
  }
  pieces.whole = pieces.list[0].extent;
  uint64_t n = 1, sum = 0;
  for (const Piece& p : pieces.list) {
    for (size_t a = 0; a < 3; ++a) {
      pieces.whole.lo[a] = std::min(pieces.whole.lo[a], p.extent.lo[a]);
      pieces.whole.hi[a] = std::max(pieces.whole.hi[a], p.extent.hi[a]);
    }
    if (!add(sum, product(p.extent.dims(false)), sum)) sum = UINT64_MAX;
  }
  for (size_t a = 0; a < 3; ++a)
    if (!multiply(n, pieces.whole.points(a), n)) read.file.fail("has pieces too far apart", dataset);
  if (n / 64 > sum) read.file.fail(fmt::format("has pieces of {} points in a box of {}", sum, n), dataset, "pieces that touch");
  for (const Piece& p : pieces.list) {
    pieces.fields.push_back(read_fields(read, p.element, "PointData", Association::point, product(p.extent.dims(false))));
    for (const Field& f : read_fields(read, p.element, "CellData", Association::cell, product(p.extent.dims(true))))
      pieces.fields.back().add(f);
  }
  return pieces;
}

// A piece that is flat where the whole is not holds points only.
bool has_cells(const Extent& piece, const Extent& whole) {
  for (size_t a = 0; a < 3; ++a)
    if (piece.points(a) == 1 && whole.points(a) > 1) return false;
  return true;
}

// Copies the rows of a piece to their place in the whole.
void place(const Extent& piece, const Extent& whole, bool cell, size_t tuple, const std::byte* from, std::byte* to) {
  const auto d = piece.dims(cell), w = whole.dims(cell);
  std::array<size_t, 3> at{};
  for (size_t a = 0; a < 3; ++a) at[a] = size_t(piece.lo[a] - whole.lo[a]);
  parallel_for(d[1] * d[2], 64, [&](size_t begin, size_t end) {
    for (size_t r = begin; r < end; ++r) {
      const size_t row = at[0] + w[0] * (at[1] + r % d[1] + w[1] * (at[2] + r / d[1]));
      std::memcpy(to + row * tuple, from + r * d[0] * tuple, d[0] * tuple);
    }
  });
}

Array placed(const Pieces& pieces, const std::vector<Array>& arrays, bool cell) {
  std::byte* out = nullptr;
  Array a = Array::make_raw(arrays[0].type(), product(pieces.whole.dims(cell)), arrays[0].components(), &out);
  std::memset(out, 0, a.bytes());
  const size_t tuple = size_t(a.components()) * element_size(a.type());
  for (size_t i = 0; i < arrays.size(); ++i) {
    if (cell && !has_cells(pieces.list[i].extent, pieces.whole)) continue;
    const Array packed = arrays[i].made_packed();
    place(pieces.list[i].extent, pieces.whole, cell, tuple, packed.raw(), out);
  }
  return a;
}

// Points or cells that no piece covers are hidden; an empty array when there are none.
Array uncovered(const Pieces& pieces, bool cell, uint8_t bit) {
  std::vector<Array> covered;
  for (const Piece& p : pieces.list) {
    std::byte* one = nullptr;
    covered.push_back(Array::make_raw(ElementType::u8, product(p.extent.dims(cell)), 1, &one));
    std::memset(one, 1, covered.back().bytes());
  }
  const Array mask = placed(pieces, covered, cell);
  const auto v = mask.view<uint8_t>();
  if (std::find(v.data, v.data + v.count, 0) == v.data + v.count) return {};
  uint8_t* out = nullptr;
  Array hidden = Array::make<uint8_t>(v.count, 1, &out);
  for (size_t i = 0; i < v.count; ++i) out[i] = v[i] ? 0 : bit;
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

void put_fields(const XmlRead& read, const Pieces& pieces, DatasetParts& parts) {
  for (const SharedField& s : shared_fields(read, pieces.fields)) {
    Field f = *s.first;
    if (pieces.list.size() > 1) f.array = placed(pieces, s.arrays, f.association == Association::cell);
    parts.fields.add(std::move(f));
  }
  if (pieces.list.size() < 2) return;
  add_hidden(parts.fields, Association::point, uncovered(pieces, false, ghost_hidden_point));
  add_hidden(parts.fields, Association::cell, uncovered(pieces, true, ghost_hidden_cell));
}

}  // namespace

void read_image(const XmlRead& read, DatasetParts& parts) {
  const Pieces pieces = read_pieces(read);
  UniformGrid g;
  g.dims = pieces.whole.dims(false);
  double v[9];
  const pugi::xml_node dataset = read.file.dataset();
  if (parse_doubles(read.file, dataset, "Origin", v, 3)) g.origin = {v[0], v[1], v[2]};
  if (parse_doubles(read.file, dataset, "Spacing", v, 3)) g.spacing = {v[0], v[1], v[2]};
  if (parse_doubles(read.file, dataset, "Direction", v, 9))
    for (int i = 0; i < 9; ++i) g.direction.m[i / 3][i % 3] = v[i];
  g.extent_start = pieces.whole.lo;
  if (g.extent_start != std::array<long long, 3>{0, 0, 0}) {
    const Vec3 first(double(g.extent_start[0]), double(g.extent_start[1]), double(g.extent_start[2]));
    g.origin += g.direction * (g.spacing * first);
  }
  parts.mesh = g;
  put_fields(read, pieces, parts);
}

void read_rectilinear(const XmlRead& read, DatasetParts& parts) {
  const Pieces pieces = read_pieces(read);
  RectilinearGrid g;
  g.extent_start = pieces.whole.lo;
  Array* axes[3] = {&g.x, &g.y, &g.z};
  for (size_t p = 0; p < pieces.list.size(); ++p) {
    const Extent& e = pieces.list[p].extent;
    const pugi::xml_node coordinates = pieces.list[p].element.child("Coordinates");
    pugi::xml_node n = coordinates.child("DataArray");
    for (size_t a = 0; a < 3; ++a, n = n.next_sibling("DataArray")) {
      if (!n) read.file.fail("has no three arrays of Coordinates", pieces.list[p].element, "the file is truncated or not complete");
      const Array part = as_coordinates(read.file.array(n, e.points(a)));
      if (pieces.list.size() == 1) {
        *axes[a] = part;
        continue;
      }
      // Gaps between pieces would leave coordinates unknown, so NaN: validate() names them.
      const size_t total = pieces.whole.points(a);
      double* out = nullptr;
      Array merged = Array::make<double>(total, 1, &out);
      for (size_t i = 0; i < total; ++i) out[i] = p > 0 ? axes[a]->get(i) : std::numeric_limits<double>::quiet_NaN();
      for (size_t i = 0; i < part.count(); ++i) out[size_t(e.lo[a] - pieces.whole.lo[a]) + i] = part.get(i);
      *axes[a] = merged;
      if (p + 1 == pieces.list.size() && part.type() == ElementType::f32) *axes[a] = merged.converted(ElementType::f32);
    }
  }
  parts.mesh = g;
  put_fields(read, pieces, parts);
}

void read_curvilinear(const XmlRead& read, DatasetParts& parts) {
  const Pieces pieces = read_pieces(read);
  CurvilinearGrid g;
  g.dims = pieces.whole.dims(false);
  g.extent_start = pieces.whole.lo;
  std::vector<Array> xyz;
  bool wide = false;
  for (const Piece& p : pieces.list) {
    xyz.push_back(read_points(read, p.element, product(p.extent.dims(false))));
    wide = wide || xyz.back().type() == ElementType::f64;
  }
  for (Array& a : xyz) a = wide ? a.converted(ElementType::f64) : a;
  if (xyz.size() == 1) g.points.xyz = xyz[0];
  else if (!xyz.empty()) g.points.xyz = placed(pieces, xyz, false);
  parts.mesh = g;
  put_fields(read, pieces, parts);
}

}  // namespace sg::vtk
