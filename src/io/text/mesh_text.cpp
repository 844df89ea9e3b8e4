// SPDX-License-Identifier: Apache-2.0
#include "io/text/mesh_text.h"

#include <fmt/core.h>

#include <algorithm>

#include "data/cells/cell_topology.h"
#include "io/text/text_scan.h"

namespace sg {

void TextCursor::skip() {
  for (;;) {
    while (p_ < end_ && is_space(*p_)) ++p_;
    if (p_ == end_ || comment_ == 0 || *p_ != comment_) return;
    p_ = line_end(p_, end_);
  }
}

bool TextCursor::at_end() {
  skip();
  return p_ == end_;
}

std::string_view TextCursor::word() {
  skip();
  const char* begin = p_;
  p_ = skip_word(p_, end_);
  return {begin, size_t(p_ - begin)};
}

std::string_view TextCursor::peek() {
  skip();
  return {p_, size_t(skip_word(p_, end_) - p_)};
}

double TextCursor::number(const char* what) {
  skip();
  double v = 0;
  const char* q = p_;
  if (!scan_number(q, end_, v) || (q < end_ && !is_space(*q)))
    fail(fmt::format("found '{}' where {} was expected", peek().substr(0, 40), what));
  p_ = q;
  return v;
}

int64_t TextCursor::integer(const char* what) {
  skip();
  int64_t v = 0;
  const char* q = p_;
  if (!scan_number(q, end_, v) || (q < end_ && !is_space(*q)))
    fail(fmt::format("found '{}' where {} was expected", peek().substr(0, 40), what));
  p_ = q;
  return v;
}

size_t TextCursor::count(const char* what, size_t bytes_each) {
  const int64_t n = integer(what);
  if (n < 0 || uint64_t(n) > left() / std::max<size_t>(bytes_each, 1) + 1)
    fail(fmt::format("{} is {}, but only {} bytes follow", what, n, left()));
  return size_t(n);
}

int64_t TextCursor::index(const char* what, int64_t first, int64_t n) {
  const int64_t i = integer(what);
  if (i < first || i - first >= n) fail(fmt::format("{} {} does not exist", what, i), fmt::format("there are {}, from {}", n, first));
  return i - first;
}

void TextCursor::expect(std::string_view wanted) {
  const std::string_view got = peek();
  if (got != wanted) fail(fmt::format("found '{}' where '{}' was expected", got.substr(0, 40), wanted));
  word();
}

std::string_view TextCursor::line() {
  const char* begin = p_;
  const char* e = line_end(p_, end_);
  p_ = e < end_ ? e + 1 : end_;
  if (comment_)
    if (const void* c = std::memchr(begin, comment_, size_t(e - begin))) e = static_cast<const char*>(c);
  while (begin < e && is_space(*begin)) ++begin;
  while (begin < e && is_space(e[-1])) --e;
  return {begin, size_t(e - begin)};
}

void TextCursor::skip_empty_lines() {
  skip();
  while (p_ > base_ && p_[-1] != '\n') --p_;
}

size_t TextCursor::line_now() const { return line_number(text(), position()); }

void TextCursor::fail(const std::string& what, const std::string& hint) const {
  fail_data(fmt::format("line {}: {}", line_now(), p_ == end_ && what.starts_with("''") ? "the file ends" + what.substr(2) : what), where_,
            hint);
}

void MixedCells::add(CellType type, std::span<const int64_t> points) {
  types_.push_back(uint8_t(type));
  ids_.insert(ids_.end(), points.begin(), points.end());
  offsets_.push_back(int64_t(ids_.size()));
}

void MixedCells::finish(UnstructuredMesh& mesh, const std::vector<int64_t>* number) {
  const size_t n = types_.size();
  if (number)
    for (int64_t& id : ids_) id = (*number)[size_t(id)];
  bool one_type = n > 0, one_size = n > 0 && offsets_[1] > 0;
  for (size_t c = 1; c < n; ++c) {
    one_type = one_type && types_[c] == types_[0];
    one_size = one_size && offsets_[c + 1] - offsets_[c] == offsets_[1];
  }
  const bool small = ids_.size() < size_t(INT32_MAX) && std::all_of(ids_.begin(), ids_.end(), [](int64_t i) { return i <= INT32_MAX; });
  auto indices = [&](const std::vector<int64_t>& v) {
    return small ? Array::from_vector(std::vector<int32_t>(v.begin(), v.end())) : Array::from_vector(v);
  };
  if (one_size) mesh.cells.fixed = int(offsets_[1]);
  else if (n > 0) mesh.cells.offsets = indices(offsets_);
  mesh.cells.connectivity = indices(ids_);
  if (one_type) mesh.single_type = CellType(types_[0]);
  else mesh.types = Array::from_vector(std::move(types_));
}

TagIndex::TagIndex(const std::vector<int64_t>& tags) {
  if (tags.empty()) return;
  const auto [lo, hi] = std::minmax_element(tags.begin(), tags.end());
  first_ = *lo;
  if (uint64_t(*hi) - uint64_t(*lo) < 4 * tags.size() + 1024) {
    direct_.assign(size_t(*hi - *lo) + 1, -1);
    for (size_t i = 0; i < tags.size(); ++i) direct_[size_t(tags[i] - first_)] = int64_t(i);
    return;
  }
  hashed_.reserve(tags.size());
  for (size_t i = 0; i < tags.size(); ++i) hashed_[tags[i]] = int64_t(i);
}

int64_t TagIndex::find(int64_t tag) const {
  if (!hashed_.empty()) {
    const auto it = hashed_.find(tag);
    return it == hashed_.end() ? -1 : it->second;
  }
  return tag < first_ || uint64_t(tag) - uint64_t(first_) >= direct_.size() ? -1 : direct_[size_t(tag - first_)];
}

std::vector<std::array<int, 3>> lattice_places(CellType shape, int n) {
  std::vector<std::array<int, 3>> places;
  if (shape == CellType::vertex) return {{0, 0, 0}};
  if (shape == CellType::pyramid) {
    if (n != 1) fail_internal("lattice_places: pyramids have no lattice above order 1");
    return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}};
  }
  const int dimension = cell_type_info(shape).dimension;
  const bool tri = shape == CellType::triangle || shape == CellType::wedge, tet = shape == CellType::tetra;
  std::vector<std::pair<uint32_t, std::array<int, 3>>> all;
  for (int k = 0; k <= (dimension > 2 ? n : 0); ++k)
    for (int j = 0; j <= (dimension > 1 ? n - (tet ? k : 0) : 0); ++j)
      for (int i = 0; i <= n - (tri || tet ? j : 0) - (tet ? k : 0); ++i) all.push_back({lattice_node(shape, n, i, j, k), {i, j, k}});
  places.resize(all.size());
  for (const auto& [node, place] : all) places.at(node) = place;
  return places;
}

namespace {

CellType curved_type(CellType shape, CellType curve) {
  const int step = int(curve) - int(CellType::lagrange_curve);
  auto at = [&](CellType t) { return CellType(int(t) + step); };
  switch (shape) {
    case CellType::line: return at(CellType::lagrange_curve);
    case CellType::triangle: return at(CellType::lagrange_triangle);
    case CellType::quad: return at(CellType::lagrange_quad);
    case CellType::tetra: return at(CellType::lagrange_tetra);
    case CellType::hexahedron: return at(CellType::lagrange_hexahedron);
    case CellType::wedge: return at(CellType::lagrange_wedge);
    case CellType::pyramid: return at(CellType::lagrange_pyramid);
    default: fail_internal("curved_type: unsupported shape");
  }
}

}  // namespace

CellType lagrange_type(CellType shape, int n) { return n == 1 ? shape : curved_type(shape, CellType::lagrange_curve); }
CellType bezier_type(CellType shape) { return curved_type(shape, CellType::bezier_curve); }

Field cell_ids(std::string name, std::vector<int32_t> ids) {
  Field f;
  f.name = std::move(name);
  f.association = Association::cell;
  f.array = Array::from_vector(std::move(ids));
  f.role = Role::labels;
  return f;
}

}  // namespace sg
