// SPDX-License-Identifier: Apache-2.0
// AVS UCD (.inp), ASCII and binary: nodes, cells with a material, node and cell data with units. Model data are left out.
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "io/formats.h"
#include "io/text/mesh_text.h"

namespace sg {

namespace {

struct UcdType {
  const char* name;
  CellType cell;
  std::vector<int> from;  ///< of each node of the cell, its place in the file's list
};

// Numbered as in binary files. UCD lists apex and top before the base.
const std::vector<UcdType>& ucd_types() {
  static const std::vector<UcdType> types{{"pt", CellType::vertex, {0}},
                                          {"line", CellType::line, {0, 1}},
                                          {"tri", CellType::triangle, {0, 1, 2}},
                                          {"quad", CellType::quad, {0, 1, 2, 3}},
                                          {"tet", CellType::tetra, {0, 1, 2, 3}},
                                          {"pyr", CellType::pyramid, {1, 2, 3, 4, 0}},
                                          {"prism", CellType::wedge, {3, 4, 5, 0, 1, 2}},
                                          {"hex", CellType::hexahedron, {4, 5, 6, 7, 0, 1, 2, 3}}};
  return types;
}

struct UcdMesh {
  MixedCells cells;
  std::vector<int32_t> material;
  std::vector<float> xyz;
  FieldSet fields;
};

void add_cell(UcdMesh& m, const UcdType& type, std::span<const int64_t> nodes) {
  std::vector<int64_t> points;
  for (int k : type.from) points.push_back(nodes[size_t(k)]);
  m.cells.add(type.cell, points);
}

bool wanted(const ReadOptions& options, std::string_view name) {
  return options.fields.empty() || std::find(options.fields.begin(), options.fields.end(), name) != options.fields.end();
}

void add_field(UcdMesh& m, const ReadOptions& options, std::string_view name, std::string_view unit, Association association,
               std::vector<float> values, int components) {
  const std::string label = name.empty() ? "data" : std::string(name);
  if (!wanted(options, label)) return;
  Field f;
  f.name = label;
  for (int k = 2; m.fields.find(f.name, association); ++k) f.name = fmt::format("{}_{}", label, k);
  f.association = association;
  f.unit = std::string(unit);
  f.array = Array::from_vector(std::move(values), components);
  if (components == 3) f.role = Role::vectors;
  m.fields.add(std::move(f));
}

// "2 1 3" and two lines "name, unit", then a line "id values" per node or cell.
void read_text_data(TextCursor& in, UcdMesh& m, const ReadOptions& options, const TagIndex& index, size_t n, size_t numbers,
                    Association association) {
  const size_t fields = in.count("the number of fields", 2);
  std::vector<size_t> width;
  size_t sum = 0;
  for (size_t f = 0; f < fields; ++f) {
    width.push_back(in.count("the number of components", 1));
    sum += width.back();
    if (width.back() < 1 || width.back() > 64) in.fail(fmt::format("a field has {} components", width.back()));
  }
  if (sum != numbers) in.fail(fmt::format("the fields have {} numbers where the header announces {}", sum, numbers));
  in.line();
  std::vector<std::pair<std::string_view, std::string_view>> labels;
  for (size_t f = 0; f < fields; ++f) {
    in.skip_empty_lines();
    const auto parts = split(in.line(), ',');
    labels.emplace_back(parts.empty() ? "" : parts[0], parts.size() < 2 ? "" : parts[1]);
  }
  uint64_t total = 0;
  if (!multiply(n, sum, total) || total > in.left())
    in.fail(fmt::format("{} values are announced, but only {} bytes follow", total, in.left()));
  std::vector<std::vector<float>> values(fields);
  for (size_t f = 0; f < fields; ++f) values[f].assign(n * width[f], std::nanf(""));
  for (size_t i = 0; i < n; ++i) {
    const int64_t id = in.integer("a number"), at = index.find(id);
    if (at < 0) in.fail(fmt::format("has data of {} {}, which does not exist", association == Association::point ? "node" : "cell", id));
    for (size_t f = 0; f < fields; ++f)
      for (size_t c = 0; c < width[f]; ++c) values[f][size_t(at) * width[f] + c] = float(in.number("a value"));
  }
  for (size_t f = 0; f < fields; ++f)
    add_field(m, options, labels[f].first, labels[f].second, association, std::move(values[f]), int(width[f]));
}

void read_ucd_text(const MappedFile& file, const ReadOptions& options, UcdMesh& m) {
  TextCursor in(file.text(), file.path(), '#');
  const size_t nodes = in.count("the number of nodes", 8), cells = in.count("the number of cells", 8);
  const size_t node_numbers = in.count("the number of node data", 1), cell_numbers = in.count("the number of cell data", 1);
  in.count("the number of model data", 1);
  std::vector<int64_t> node_ids, cell_ids_;
  for (size_t i = 0; i < nodes; ++i) {
    node_ids.push_back(in.integer("the number of a node"));
    for (int a = 0; a < 3; ++a) m.xyz.push_back(float(in.number("a coordinate")));
  }
  const TagIndex index(node_ids);
  std::vector<int64_t> points;
  for (size_t c = 0; c < cells; ++c) {
    cell_ids_.push_back(in.integer("the number of a cell"));
    m.material.push_back(int32_t(in.integer("a material")));
    const std::string_view name = in.word();
    const UcdType* type = nullptr;
    for (const UcdType& t : ucd_types())
      if (name == t.name) type = &t;
    if (!type) in.fail(fmt::format("cell type '{}'", name.substr(0, 40)), "use pt, line, tri, quad, tet, pyr, prism or hex");
    points.clear();
    for (size_t k = 0; k < type->from.size(); ++k) {
      const int64_t id = in.integer("a node");
      points.push_back(index.find(id));
      if (points.back() < 0) in.fail(fmt::format("node {} does not exist", id));
    }
    add_cell(m, *type, points);
  }
  if (node_numbers > 0) read_text_data(in, m, options, index, nodes, node_numbers, Association::point);
  if (cell_numbers > 0) read_text_data(in, m, options, TagIndex(cell_ids_), cells, cell_numbers, Association::cell);
}

// Labels in 1024 bytes, separated by dots, closed by a zero.
std::vector<std::string_view> labels_of(const char* p) { return split(std::string_view(p, strnlen(p, 1024)), '.'); }

class UcdBinary {
 public:
  explicit UcdBinary(const MappedFile& file) : bytes_(file.text()), path_(file.path()) {
    big_endian_ = false;
    if (!plausible()) big_endian_ = true;
    if (!plausible()) fail_data(fmt::format("the header does not fit the file of {} bytes", bytes_.size()), path_);
  }

  void read(const ReadOptions& options, UcdMesh& m) {
    const size_t nodes = number(0), cells = number(1), node_numbers = number(2), cell_numbers = number(3), list = number(5);
    size_t ids = 25 + 16 * cells;
    at_ = 25;
    need(16 * cells + 4 * list + 12 * nodes, "the mesh");
    const size_t ids_end = ids + 4 * list;
    std::vector<int64_t> points;
    for (size_t c = 0; c < cells; ++c) {
      integer();
      m.material.push_back(int32_t(integer()));
      const int64_t n = integer(), t = integer();
      if (t < 0 || t >= int64_t(ucd_types().size()) || n != int64_t(ucd_types()[size_t(t)].from.size()))
        fail_data(fmt::format("cell {} has type {} and {} nodes", c, t, n), path_);
      if (ids + 4 * size_t(n) > ids_end) fail_data(fmt::format("the nodes of cell {} extend beyond the list", c), path_);
      points.clear();
      for (int64_t k = 0; k < n; ++k, ids += 4) {
        const int64_t id = load<int32_t>(bytes_.data() + ids, big_endian_);
        if (id < 1 || id > int64_t(nodes))
          fail_data(fmt::format("cell {} has node {}", c, id), path_, fmt::format("there are {}, from 1", nodes));
        points.push_back(id - 1);
      }
      add_cell(m, ucd_types()[size_t(t)], points);
    }
    at_ = ids_end;
    m.xyz.resize(3 * nodes);
    for (size_t a = 0; a < 3; ++a)
      for (size_t i = 0; i < nodes; ++i) m.xyz[3 * i + a] = real();
    if (node_numbers > 0) read_data(m, options, nodes, node_numbers, Association::point);
    if (cell_numbers > 0) read_data(m, options, cells, cell_numbers, Association::cell);
  }

 private:
  size_t number(size_t k) const { return size_t(std::max(0, load<int32_t>(bytes_.data() + 1 + 4 * k, big_endian_))); }
  bool plausible() const {
    if (bytes_.size() < 25) return false;
    for (size_t k = 0; k < 6; ++k)
      if (load<int32_t>(bytes_.data() + 1 + 4 * k, big_endian_) < 0) return false;
    return number(0) <= bytes_.size() / 12 && number(1) <= bytes_.size() / 16 && number(5) <= bytes_.size() / 4 &&
           25 + 16 * number(1) + 4 * number(5) + 12 * number(0) <= bytes_.size();
  }
  void need(size_t n, const char* what) const {
    if (bytes_.size() - at_ < n) fail_data(fmt::format("byte {}: the file ends in {}", at_, what), path_);
  }
  int64_t integer() {
    at_ += 4;
    return load<int32_t>(bytes_.data() + at_ - 4, big_endian_);
  }
  float real() {
    at_ += 4;
    return load<float>(bytes_.data() + at_ - 4, big_endian_);
  }

  // Labels, units, the number of fields, their components, minima, maxima, values field by field, and which are active.
  void read_data(UcdMesh& m, const ReadOptions& options, size_t n, size_t numbers, Association association) {
    uint64_t values = 0;
    if (!multiply(n, numbers, values) || values > bytes_.size() / 4 || numbers > bytes_.size() / 12)
      fail_data(fmt::format("{} x {} values in a file of {} bytes", n, numbers, bytes_.size()), path_);
    need(2048 + 4 + 12 * numbers + 4 * size_t(values), "the data");
    const auto labels = labels_of(bytes_.data() + at_), units = labels_of(bytes_.data() + at_ + 1024);
    at_ += 2048;
    const int64_t fields = integer();
    if (fields < 1 || uint64_t(fields) > numbers) fail_data(fmt::format("{} fields of {} numbers", fields, numbers), path_);
    std::vector<size_t> width;
    size_t sum = 0;
    for (size_t k = 0; k < numbers; ++k) {
      const int64_t w = integer();
      if (k >= size_t(fields)) continue;
      if (w < 1 || w > 64) fail_data(fmt::format("a field has {} components", w), path_);
      width.push_back(size_t(w)), sum += size_t(w);
    }
    if (sum != numbers) fail_data(fmt::format("the fields have {} numbers where the header announces {}", sum, numbers), path_);
    at_ += 8 * numbers;
    for (size_t f = 0; f < size_t(fields); ++f) {
      std::vector<float> v(n * width[f]);
      for (float& x : v) x = real();
      add_field(m, options, f < labels.size() ? labels[f] : "", f < units.size() ? units[f] : "", association, std::move(v), int(width[f]));
    }
    at_ = std::min(at_ + 4 * numbers, bytes_.size());
  }

  std::string_view bytes_;
  std::string path_;
  bool big_endian_ = false;
  size_t at_ = 0;
};

bool is_binary(std::string_view s) { return !s.empty() && s[0] == 7; }

}  // namespace

bool sniff_ucd(std::span<const std::byte> head) {
  std::string_view s(reinterpret_cast<const char*>(head.data()), head.size());
  if (is_binary(s)) {  // counts that are small against 2^31, in either order of bytes
    if (s.size() < 25) return false;
    for (bool big : {false, true}) {
      bool good = true;
      for (size_t k = 0; k < 6; ++k) {
        const int32_t n = load<int32_t>(s.data() + 1 + 4 * k, big);
        good = good && n >= (k < 2 || k == 5 ? 1 : 0) && n < (k == 2 || k == 3 || k == 4 ? 4096 : 1 << 30);
      }
      good = good && load<int32_t>(s.data() + 21, big) >= load<int32_t>(s.data() + 5, big);
      if (good) return true;
    }
    return false;
  }
  // "nodes cells n n n", then "id x y z".
  auto next_line = [&]() -> std::vector<std::string_view> {
    while (!s.empty()) {
      const size_t end = std::min(s.find('\n'), s.size());
      const std::string_view line = trim(s.substr(0, end));
      s.remove_prefix(std::min(end + 1, s.size()));
      if (!line.empty() && line[0] != '#') return words(line);
    }
    return {};
  };
  const auto first = next_line(), second = next_line();
  if (first.size() != 5 || second.size() != 4 || !parse_int(second[0])) return false;
  for (const auto& w : first)
    if (const auto n = parse_int(w); !n || *n < 0) return false;
  for (size_t k = 1; k < 4; ++k)
    if (!parse_double(second[k])) return false;
  return true;
}

Data read_ucd(const std::string& path, const ReadOptions& options, Context&) {
  const MappedFile file(path);
  UcdMesh m;
  if (is_binary(file.text())) UcdBinary(file).read(options, m);
  else read_ucd_text(file, options, m);
  for (float x : m.xyz)
    if (!std::isfinite(x)) fail_data("a coordinate is not finite", path);
  UnstructuredMesh mesh;
  m.cells.finish(mesh);
  mesh.points.xyz = Array::from_vector(std::move(m.xyz), 3);
  FieldSet fields;
  fields.add(cell_ids("Material Id", std::move(m.material)));
  for (const Field& f : m.fields) fields.add(f);
  return make_dataset(std::move(mesh), std::move(fields));
}

}  // namespace sg
