// SPDX-License-Identifier: Apache-2.0
#include "io/vtk/vtk_cells.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/parallel.h"

namespace sg::vtk {

namespace {

template <class Holds>
bool all_of(size_t n, Holds holds) {
  return parallel_reduce(
      n, 1 << 17, true,
      [&](size_t begin, size_t end) {
        bool good = true;
        for (size_t i = begin; i < end; ++i) good &= holds(i);
        return good;
      },
      [](bool a, bool b) { return a && b; });
}

// dispatch over the two index types
template <class F>
decltype(auto) with_indices(const Array& a, F&& f) {
  return a.type() == ElementType::i64 ? f(a.view<int64_t>().data) : f(a.view<int32_t>().data);
}

CellArray no_cells() { return {}; }

}  // namespace

Array as_indices(const Array& a) {
  if (a.type() == ElementType::i32 || a.type() == ElementType::i64) return a.made_packed();
  if (is_float(a.type())) fail_data(fmt::format("indices are {}, not integers", element_name(a.type())));
  return a.converted(element_size(a.type()) < 4 ? ElementType::i32 : ElementType::i64);
}

Array as_coordinates(const Array& a) {
  if (is_float(a.type())) return a;
  return a.converted(element_size(a.type()) < 4 ? ElementType::f32 : ElementType::f64);
}

namespace {

constexpr int most_points = 4096;  // of cells of one size; for larger ones the offsets pay off

template <class T, bool BIG>
int uniform_size_of(const std::byte* p, size_t n) {
  const T size = load<T>(p, BIG);
  if (size <= 0 || size > most_points || size_t(size) > size_t(std::numeric_limits<T>::max()) / n) return 0;
  const bool uniform = parallel_reduce(
      n, 1 << 16, true,
      [&](size_t begin, size_t end) {
        T odd = 0, want = T(begin) * size;
        for (size_t i = begin; i < end; ++i) odd |= load<T>(p + i * sizeof(T), BIG) ^ (want += size);
        return odd == 0;
      },
      [](bool a, bool b) { return a && b; });
  return uniform ? int(size) : 0;
}

}  // namespace

int uniform_size(const std::byte* p, ElementType type, size_t n, bool big_endian) {
  if (n == 0) return 0;
  if (type == ElementType::i64) return big_endian ? uniform_size_of<int64_t, true>(p, n) : uniform_size_of<int64_t, false>(p, n);
  if (type == ElementType::i32) return big_endian ? uniform_size_of<int32_t, true>(p, n) : uniform_size_of<int32_t, false>(p, n);
  return 0;
}

CellArray cells_of_size(int size, size_t n, const Array& connectivity) {
  CellArray cells;
  cells.connectivity = as_indices(connectivity);
  if (cells.connectivity.count() / size_t(size) < n)
    fail_data(fmt::format("{} cells of {} points need more than {} point ids", n, size, cells.connectivity.count()));
  cells.connectivity = cells.connectivity.slice(0, n * size_t(size));
  cells.fixed = size;
  return cells;
}

CellArray cells_from_ends(const Array& ends_in, const Array& connectivity) {
  const size_t n = ends_in.count();
  if (n == 0) return no_cells();
  const Array ends = as_indices(ends_in);
  if (const int size = uniform_size(ends.raw(), ends.type(), n)) return cells_of_size(size, n, connectivity);
  CellArray cells;
  cells.connectivity = as_indices(connectivity);
  const size_t ids = cells.connectivity.count();
  with_indices(ends, [&](auto* end) {
    using T = std::remove_cvref_t<decltype(*end)>;
    // For i == 0 the end before is the start of the list.
    if (!all_of(n, [&](size_t i) { return end[i] >= (i ? end[i - 1] : T(0)); })) fail_data("the offsets of cells decrease");
    if (size_t(end[n - 1]) > ids) fail_data(fmt::format("the offsets of cells end at {}, but there are {} point ids", end[n - 1], ids));
    T* out = nullptr;
    cells.offsets = Array::make<T>(n + 1, 1, &out);
    out[0] = 0;
    std::memcpy(out + 1, end, n * sizeof(T));
    cells.connectivity = cells.connectivity.slice(0, size_t(end[n - 1]));
  });
  return cells;
}

CellArray cells_from_starts(const Array& starts, const Array& connectivity) {
  if (starts.count() < 2) return no_cells();
  const Array a = as_indices(starts);
  if (index_view(a)[0] != 0) fail_data(fmt::format("the offsets of cells begin at {}, not 0", index_view(a)[0]));
  return cells_from_ends(a.slice(1, a.count()), connectivity);
}

namespace {

template <class T>
CellArray split_records(const T* r, size_t count, size_t n) {
  CellArray cells;
  const size_t k = r[0] > 0 && r[0] <= most_points ? size_t(r[0]) : 0;
  T* ids = nullptr;
  if (k > 0 && n <= count / (k + 1) && count == n * (k + 1) && all_of(n, [&](size_t i) { return size_t(r[i * (k + 1)]) == k; })) {
    cells.connectivity = Array::make<T>(n * k, 1, &ids);
    cells.fixed = int(k);
    parallel_for(n, 1 << 15, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        for (size_t j = 0; j < k; ++j) ids[i * k + j] = r[i * (k + 1) + 1 + j];
    });
    return cells;
  }
  T* offsets = nullptr;
  cells.offsets = Array::make<T>(n + 1, 1, &offsets);
  offsets[0] = 0;
  size_t at = 0;
  for (size_t i = 0; i < n; ++i) {
    if (at >= count) fail_data(fmt::format("the cell list ends after {} of {} cells", i, n));
    const T size = r[at];
    if (size < 0 || size_t(size) > count - at - 1)
      fail_data(fmt::format("cell {} has {} points but the list has only {} more numbers", i, size, count - at - 1));
    at += size_t(size) + 1;
    offsets[i + 1] = offsets[i] + size;  // at most count, which is a T in the file
  }
  cells.connectivity = Array::make<T>(size_t(offsets[n]), 1, &ids);
  parallel_for(n, 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      for (T j = offsets[i]; j < offsets[i + 1]; ++j) ids[j] = r[size_t(j) + i + 1];
  });
  return cells;
}

}  // namespace

CellArray cells_from_records(const Array& records, size_t n) {
  if (n == 0) return no_cells();
  if (records.count() < n) fail_data(fmt::format("a cell list of {} numbers cannot hold {} cells", records.count(), n));
  Array a = as_indices(records);
  if (a.type() == ElementType::i32 && a.count() > size_t(INT32_MAX)) a = a.converted(ElementType::i64);  // offsets must fit too
  return with_indices(a, [&](auto* r) { return split_records(r, a.count(), n); });
}

void set_types(UnstructuredMesh& mesh, const Array& types_in) {
  const Array types =
      element_size(types_in.type()) == 1 && types_in.packed()
          ? Array(types_in.buffer(), ElementType::u8, types_in.count(), 1, size_t(types_in.raw() - types_in.buffer().data), 1, 1)
          : types_in.converted(ElementType::u8);
  if (types.count() == 0) return;
  const uint8_t* t = types.view<uint8_t>().data;
  if (all_of(types.count(), [&](size_t i) { return t[i] == t[0]; }) && t[0] != uint8_t(CellType::polyhedron))
    mesh.single_type = CellType(t[0]);
  else mesh.types = types;
}

size_t FaceCollector::add(IndexView stream, size_t begin, size_t end) {
  auto take = [&, at = begin]() mutable {
    if (at >= end) fail_data(fmt::format("the faces of polyhedron {} extend beyond its list", cell_faces_.size() - 1));
    return stream[at++];
  };
  const int64_t faces = take();
  if (faces < 0 || size_t(faces) > end - begin) fail_data(fmt::format("polyhedron {} has {} faces", cell_faces_.size() - 1, faces));
  size_t used = 1;
  for (int64_t f = 0; f < faces; ++f) {
    const int64_t size = take();
    if (size < 0 || size_t(size) > end - begin - used)
      fail_data(fmt::format("a face of polyhedron {} has {} points", cell_faces_.size() - 1, size));
    for (int64_t i = 0; i < size; ++i) ids_.push_back(take());
    offsets_.push_back(int64_t(ids_.size()));
    used += size_t(size) + 1;
  }
  add_none();
  return used;
}

void FaceCollector::finish(UnstructuredMesh& mesh) {
  mesh.faces.connectivity = Array::from_vector(std::move(ids_));
  mesh.faces.offsets = Array::from_vector(std::move(offsets_));
  mesh.polyhedron_faces = Array::from_vector(std::move(cell_faces_));
}

void expand_polyhedra(UnstructuredMesh& mesh) {
  const size_t n = mesh.cells.size();
  if (n == 0 || mesh.types.count() != n) return;  // a wrong number of types is reported by validate()
  const auto types = mesh.types.view<uint8_t>();
  constexpr auto polyhedron = uint8_t(CellType::polyhedron);
  if (all_of(n, [&](size_t i) { return types[i] != polyhedron; })) return;
  const CellsView cells = cells_view(mesh.cells);
  FaceCollector faces;
  std::vector<int64_t> ids, offsets{0};
  for (size_t c = 0; c < n; ++c) {
    const size_t begin = cells.begin(c), end = cells.end(c);
    if (types[c] != polyhedron) {
      for (size_t i = begin; i < end; ++i) ids.push_back(cells.connectivity[i]);
      faces.add_none();
    } else {
      faces.add(cells.connectivity, begin, end);
      const auto first = ptrdiff_t(ids.size());  // the distinct points in ascending order, as VTK lists them
      size_t at = begin + 1;
      for (int64_t f = cells.connectivity[begin]; f > 0; --f) {
        const size_t stop = at + 1 + size_t(cells.connectivity[at]);
        for (++at; at < stop; ++at) ids.push_back(cells.connectivity[at]);
      }
      std::sort(ids.begin() + first, ids.end());
      ids.erase(std::unique(ids.begin() + first, ids.end()), ids.end());
    }
    offsets.push_back(int64_t(ids.size()));
  }
  mesh.cells.connectivity = Array::from_vector(std::move(ids));
  mesh.cells.offsets = Array::from_vector(std::move(offsets));
  mesh.cells.fixed = 0;
  faces.finish(mesh);
}

Array concatenated(std::span<const Array> parts) {
  if (parts.size() == 1) return parts[0];
  const Array* some = nullptr;
  size_t n = 0;
  for (const Array& a : parts)
    if (!a.empty()) some = some ? some : &a, n += a.count();
  if (!some) return parts.empty() ? Array() : parts[0];
  std::byte* out = nullptr;
  Array r = Array::make_raw(some->type(), n, some->components(), &out);
  for (const Array& a : parts) {
    if (a.empty()) continue;
    if (a.type() != r.type() || a.components() != r.components()) fail_internal("concatenated: arrays differ in type");
    const Array packed = a.made_packed();
    std::memcpy(out, packed.raw(), packed.bytes());
    out += packed.bytes();
  }
  return r;
}

Array concatenated_indices(std::span<const Array> parts, std::span<const size_t> shift) {
  size_t n = 0, most = 0;
  bool wide = false;
  for (size_t i = 0; i < parts.size(); ++i) {
    n += parts[i].count();
    most = std::max(most, shift[i]);
    wide = wide || parts[i].type() == ElementType::i64;
  }
  // Ids beyond 2^31 that are wrong wrap here; make them wide so that validate() still sees them.
  wide = wide || most > size_t(INT32_MAX) / 2 || parts.empty();
  auto fill = [&](auto* out) {
    using T = std::remove_pointer_t<decltype(out)>;
    for (size_t i = 0; i < parts.size(); ++i) {
      if (parts[i].empty()) continue;
      const IndexView from = index_view(parts[i]);
      const auto add = T(shift[i]);
      // A negative id must not become a valid one of the piece before.
      for (size_t k = 0; k < parts[i].count(); ++k) {
        const auto id = T(from[k]);
        T sum = 0;
        *out++ = id < 0 || __builtin_add_overflow(id, add, &sum) ? T(-1) : sum;
      }
    }
  };
  if (wide) {
    int64_t* out = nullptr;
    Array r = Array::make<int64_t>(n, 1, &out);
    fill(out);
    return r;
  }
  int32_t* out = nullptr;
  Array r = Array::make<int32_t>(n, 1, &out);
  fill(out);
  return r;
}

CellArray concatenated_cells(std::span<const CellArray> parts, std::span<const size_t> shift) {
  if (parts.size() == 1 && shift[0] == 0) return parts[0];
  CellArray r;
  std::vector<Array> ids;
  std::vector<size_t> shifts;
  size_t cells = 0;
  int fixed = -1;
  for (size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].size() == 0) continue;
    ids.push_back(parts[i].connectivity);
    shifts.push_back(shift[i]);
    cells += parts[i].size();
    fixed = fixed < 0 || fixed == parts[i].fixed ? parts[i].fixed : 0;
  }
  if (cells == 0) return r;
  r.connectivity = concatenated_indices(ids, shifts);
  if (fixed > 0) {
    r.fixed = fixed;
    return r;
  }
  int64_t* offsets = nullptr;
  r.offsets = Array::make<int64_t>(cells + 1, 1, &offsets);
  *offsets = 0;
  for (const CellArray& part : parts) {
    const CellsView v = cells_view(part);
    for (size_t c = 0; c < v.count; ++c, ++offsets) offsets[1] = offsets[0] + int64_t(v.size(c));
  }
  return r;
}

void set_weights(UnstructuredMesh& mesh, const Field& field) {
  if (field.components() != 1 || field.array.count() != mesh.points.count())
    fail_data(fmt::format("the rational weights '{}' have {} components", field.name, field.components()), {},
              "expected one number per point");
  mesh.weights = field.array.converted(ElementType::f64);
  const double* w = mesh.weights.view<double>().data;
  if (!all_of(mesh.weights.count(), [&](size_t i) { return std::isfinite(w[i]); }))
    fail_data(fmt::format("the rational weights '{}' are not all finite", field.name));
}

void set_degrees(UnstructuredMesh& mesh, const Field& field) {
  if (field.components() != 3 || field.array.count() != mesh.cells.size())
    fail_data(fmt::format("the orders of cells '{}' have {} components", field.name, field.components()), {},
              "expected three numbers per cell");
  const size_t n = field.array.count();
  uint8_t* out = nullptr;
  Array degrees = Array::make<uint8_t>(n, 3, &out);
  dispatch(field.array, [&](auto v) {
    for (size_t i = 0; i < n; ++i)
      for (int c = 0; c < 3; ++c) {
        const auto d = double(v(i, c));
        if (!(d >= 0 && d <= 255) || d != std::floor(d))
          fail_data(fmt::format("cell {} has the order {}", i, d), fmt::format("array '{}'", field.name),
                    "expected a whole number from 0 to 255");
        out[3 * i + size_t(c)] = uint8_t(d);
      }
  });
  mesh.degrees = degrees;
}

Array hollow(ElementType type, size_t tuples, int components) {
  std::byte* one = nullptr;
  const Buffer b = Buffer::allocate(64, &one);
  std::memset(one, 0, 64);
  if (const double nan = std::numeric_limits<double>::quiet_NaN(); type == ElementType::f64) std::memcpy(one, &nan, sizeof nan);
  if (const float nan = std::numeric_limits<float>::quiet_NaN(); type == ElementType::f32) std::memcpy(one, &nan, sizeof nan);
  return Array(b, type, tuples, components, 0, 0, 0);
}

bool is_ghost_name(std::string_view name) { return name == "vtkGhostType" || name == "vtkGhostLevels"; }

void take_ghosts(DatasetParts& parts) {
  for (const Association a : {Association::point, Association::cell})
    for (const char* name : {"vtkGhostLevels", "vtkGhostType"}) {
      const Field* f = parts.fields.find(name, a);
      if (!f || f->components() != 1) continue;
      Array ghost = f->array.converted(ElementType::u8);
      if (std::string_view(name) == "vtkGhostLevels") {  // levels, not bits: every level above 0 is a copy of a neighbour's
        const auto level = ghost.view<uint8_t>();
        uint8_t* bits = nullptr;
        Array b = Array::make<uint8_t>(ghost.count(), 1, &bits);
        for (size_t i = 0; i < level.count; ++i) bits[i] = level[i] ? ghost_duplicate : 0;
        ghost = b;
      }
      (a == Association::point ? parts.point_ghost : parts.cell_ghost) = ghost;
      parts.fields.remove(name, a);
    }
}

}  // namespace sg::vtk
