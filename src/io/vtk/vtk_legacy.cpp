// SPDX-License-Identifier: Apache-2.0
// Legacy VTK files ("# vtk DataFile Version 1.0" to 5.1): a header of three lines, then keywords with their numbers.
// Format: VTK User's Guide, "Simple legacy formats"; versions 5.x as VTK 9 writes them.
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/text/text.h"
#include "io/formats.h"
#include "io/text/word_categories.h"
#include "io/vtk/named_linear.h"
#include "io/vtk/vtk_cells.h"
#include "io/vtk/vtk_legacy_text.h"

namespace sg {

bool sniff_vtk_legacy(std::span<const std::byte> head) {
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  return text.size() >= 14 && equal_ignoring_case(text.substr(0, 14), "# vtk datafile");
}

namespace vtk {
namespace {

enum class Kind { none, points, curvilinear, rectilinear, unstructured, surface };

class LegacyReader {
 public:
  LegacyReader(const MappedFile& file, const ReadOptions& options, Context& context) : text_(file), options_(options), context_(context) {}
  DatasetPtr read();

 private:
  struct Keyword {
    std::string_view name;
    void (LegacyReader::*read)();
  };
  static const Keyword keywords[];

  void header();
  void dataset();
  void dimensions();
  void extent();
  void origin();
  void spacing();
  void points();
  void coordinates_x() { axes_[0] = coordinates(); }
  void coordinates_y() { axes_[1] = coordinates(); }
  void coordinates_z() { axes_[2] = coordinates(); }
  void blanking();
  void cells() { need(Kind::unstructured, "CELLS"), cells_ = cell_list("CELLS"); }
  void cell_types();
  void vertices() { surface_.vertices = surface_cells("VERTICES"); }
  void lines() { surface_.lines = surface_cells("LINES"); }
  void polygons() { surface_.polygons = surface_cells("POLYGONS"); }
  void strips() { surface_.strips = surface_cells("TRIANGLE_STRIPS"); }

  void point_data() { association_ = Association::point, attribute_count_ = text_.count("the number of points"); }
  void cell_data() { association_ = Association::cell, attribute_count_ = text_.count("the number of cells"); }
  void scalars();
  void color_scalars();
  void lookup_table();
  void vectors() { simple(3, Role::vectors); }
  void normals() { simple(3, Role::normals); }
  void tensors() { simple(9, Role::tensors); }
  void tensors6() { simple(6, Role::tensors); }
  void ids() { simple(1, Role::global_ids); }
  void edge_flags() { simple(1, Role::none); }
  void texture_coordinates();
  void field();
  void metadata() { text_.skip_metadata(); }

  void need(Kind kind, std::string_view keyword);
  Array coordinates();
  CellArray cell_list(std::string_view keyword);
  CellArray surface_cells(std::string_view keyword) { return need(Kind::surface, keyword), cell_list(keyword); }
  void simple(size_t components, Role role);
  bool is_wanted(const std::string& name) const;
  void add(std::string name, Association association, const std::string& type, size_t tuples, size_t components, std::string_view keyword,
           Role role);
  void add_strings(std::string name, Association association, size_t tuples, size_t components);
  size_t tuples();
  Mesh mesh();

  LegacyText text_;
  const ReadOptions& options_;
  Context& context_;
  Kind kind_ = Kind::none;
  std::array<size_t, 3> dims_{0, 0, 0};
  bool have_dims_ = false, have_points_ = false;
  std::array<long long, 3> start_{0, 0, 0};
  Vec3 origin_{0, 0, 0}, spacing_{1, 1, 1};
  Points points_;
  Array axes_[3];
  CellArray cells_;
  bool have_cells_ = false;
  Array types_;
  std::optional<CellType> one_type_;
  size_t type_count_ = 0;
  SurfaceMesh surface_;
  Association association_ = Association::whole;
  size_t attribute_count_ = 0;
  DatasetParts parts_;
};

const LegacyReader::Keyword LegacyReader::keywords[] = {
    {"dataset", &LegacyReader::dataset},
    {"dimensions", &LegacyReader::dimensions},
    {"extent", &LegacyReader::extent},
    {"origin", &LegacyReader::origin},
    {"spacing", &LegacyReader::spacing},
    {"aspect_ratio", &LegacyReader::spacing},
    {"points", &LegacyReader::points},
    {"x_coordinates", &LegacyReader::coordinates_x},
    {"y_coordinates", &LegacyReader::coordinates_y},
    {"z_coordinates", &LegacyReader::coordinates_z},
    {"blanking", &LegacyReader::blanking},
    {"cells", &LegacyReader::cells},
    {"cell_types", &LegacyReader::cell_types},
    {"vertices", &LegacyReader::vertices},
    {"lines", &LegacyReader::lines},
    {"polygons", &LegacyReader::polygons},
    {"triangle_strips", &LegacyReader::strips},
    {"point_data", &LegacyReader::point_data},
    {"cell_data", &LegacyReader::cell_data},
    {"scalars", &LegacyReader::scalars},
    {"color_scalars", &LegacyReader::color_scalars},
    {"lookup_table", &LegacyReader::lookup_table},
    {"vectors", &LegacyReader::vectors},
    {"normals", &LegacyReader::normals},
    {"tensors", &LegacyReader::tensors},
    {"tensors6", &LegacyReader::tensors6},
    {"global_ids", &LegacyReader::ids},
    {"pedigree_ids", &LegacyReader::ids},
    {"edge_flags", &LegacyReader::edge_flags},
    {"texture_coordinates", &LegacyReader::texture_coordinates},
    {"field", &LegacyReader::field},
    {"metadata", &LegacyReader::metadata},
};

void LegacyReader::header() {
  const std::string_view first = text_.line();
  const std::string_view prefix = "# vtk datafile version";
  if (first.size() < prefix.size() || !equal_ignoring_case(first.substr(0, prefix.size()), prefix))
    text_.fail("is not a legacy VTK file", "the first line should be '# vtk DataFile Version 3.0'");
  const std::string_view title = trim(text_.line());
  if (!title.empty() && title.size() <= 1024) parts_.notes.emplace_back("title", std::string(title));
  const std::string_view encoding = text_.need_word("use ASCII or BINARY");
  if (equal_ignoring_case(encoding, "BINARY")) text_.binary = true;
  else if (!equal_ignoring_case(encoding, "ASCII"))
    text_.fail(fmt::format("found '{}' where ASCII or BINARY was expected", encoding.substr(0, 40)),
               "the word after the title line gives the encoding");
}

void LegacyReader::dataset() {
  if (kind_ != Kind::none) text_.fail("has a second DATASET");
  const std::string_view w = text_.need_word("the kind of the dataset");
  constexpr std::pair<std::string_view, Kind> kinds[] = {{"structured_points", Kind::points},
                                                         {"structured_grid", Kind::curvilinear},
                                                         {"rectilinear_grid", Kind::rectilinear},
                                                         {"unstructured_grid", Kind::unstructured},
                                                         {"polydata", Kind::surface}};
  for (const auto& [name, kind] : kinds)
    if (equal_ignoring_case(w, name)) kind_ = kind;
  if (kind_ == Kind::none)
    text_.fail(fmt::format("the dataset '{}' has no mesh that can be read", w.substr(0, 40)),
               "supported: STRUCTURED_POINTS, STRUCTURED_GRID, RECTILINEAR_GRID, UNSTRUCTURED_GRID, POLYDATA");
}

void LegacyReader::need(Kind kind, std::string_view keyword) {
  if (kind_ != kind) text_.fail(fmt::format("{} does not belong to this kind of dataset", keyword));
}

void LegacyReader::dimensions() {
  for (size_t a = 0; a < 3; ++a) dims_[a] = text_.count("a dimension");
  have_dims_ = true;
}

void LegacyReader::extent() {
  for (size_t a = 0; a < 3; ++a) {
    const double lo = text_.number("an extent"), hi = text_.number("an extent");
    if (!(std::abs(lo) < 1e15 && std::abs(hi) < 1e15 && hi >= lo - 1)) text_.fail(fmt::format("an extent runs from {} to {}", lo, hi));
    start_[a] = (long long)lo;
    dims_[a] = size_t((long long)hi - (long long)lo + 1);
  }
  have_dims_ = true;
}

void LegacyReader::origin() {
  for (int a = 0; a < 3; ++a) origin_[a] = text_.number("a coordinate of the origin");
}

void LegacyReader::spacing() {
  for (int a = 0; a < 3; ++a) spacing_[a] = text_.number("a spacing");
}

void LegacyReader::points() {
  if (kind_ == Kind::none || kind_ == Kind::points || kind_ == Kind::rectilinear)
    text_.fail("POINTS does not belong to this kind of dataset");
  const size_t n = text_.count("the number of points");
  const std::string type(text_.need_word("the type of the points"));
  points_.xyz = as_coordinates(text_.array(type, n, 3, "POINTS"));
  have_points_ = true;
}

Array LegacyReader::coordinates() {
  need(Kind::rectilinear, "coordinates");
  const size_t n = text_.count("the number of coordinates");
  const std::string type(text_.need_word("the type of the coordinates"));
  return as_coordinates(text_.array(type, n, 1, "the coordinates"));
}

void LegacyReader::blanking() {
  const size_t n = text_.count("the number of points");
  const std::string type(text_.need_word("the type of the blanking"));
  const Array visible = text_.array(type, n, 1, "BLANKING");
  uint8_t* ghost = nullptr;
  parts_.point_ghost = Array::make<uint8_t>(n, 1, &ghost);
  for (size_t i = 0; i < n; ++i) ghost[i] = visible.get(i) != 0 ? 0 : ghost_hidden_point;
}

CellArray LegacyReader::cell_list(std::string_view keyword) {
  have_cells_ = true;
  const size_t n = text_.count("the number of cells"), size = text_.count("the size of the cell list");
  // Since version 5.0: n offsets (one more than cells) and `size` ids, each with a type of its own.
  if (equal_ignoring_case(text_.peek(), "OFFSETS")) {
    text_.word();
    const std::string offset_type(text_.need_word("the type of the offsets"));
    // Cells of one size: one look at the offsets where they lie, and they need not become an array.
    ElementType type{};
    const std::byte* p = n > 1 ? text_.in_place(offset_type, n, type) : nullptr;
    const size_t width = element_size(type);
    const bool from_zero = p && std::all_of(p, p + width, [](std::byte b) { return b == std::byte(0); });
    const int fixed = from_zero ? uniform_size(p + width, type, n - 1, true) : 0;
    Array starts;
    if (fixed) text_.skip_array(offset_type, n, 1, "OFFSETS");
    else starts = text_.array(offset_type, n, 1, "OFFSETS");
    if (!equal_ignoring_case(text_.need_word("CONNECTIVITY"), "CONNECTIVITY")) text_.fail("expected CONNECTIVITY here");
    const std::string id_type(text_.need_word("the type of the connectivity"));
    const Array ids = text_.array(id_type, size, 1, "CONNECTIVITY");
    return with_context(fmt::format("splitting {}", keyword),
                        [&] { return fixed ? cells_of_size(fixed, n - 1, ids) : cells_from_starts(starts, ids); });
  }
  const Array records = text_.array("int", size, 1, keyword);
  return with_context(fmt::format("splitting {}", keyword), [&] { return cells_from_records(records, n); });
}

void LegacyReader::cell_types() {
  need(Kind::unstructured, "CELL_TYPES");
  const size_t n = text_.count("the number of cells");
  // All of one type: the numbers need not become an array.
  ElementType type{};
  if (const std::byte* p = n > 0 ? text_.in_place("int", n, type) : nullptr)
    if (n == 1 || std::memcmp(p, p + 4, (n - 1) * 4) == 0)
      if (const uint32_t t = load<uint32_t>(p, true); t < 256 && CellType(t) != CellType::polyhedron) one_type_ = CellType(t);
  if (one_type_) text_.skip_array("int", n, 1, "CELL_TYPES"), type_count_ = n;
  else types_ = text_.array("int", n, 1, "CELL_TYPES"), type_count_ = types_.count();
}

// Ghosts, weights and orders belong to the mesh.
static bool shapes_mesh(const std::string& name) {
  return is_ghost_name(name) || name == "RationalWeights" || name == "HigherOrderDegrees";
}

static bool is_string(std::string_view type) { return equal_ignoring_case(type, "string") || equal_ignoring_case(type, "utf8_string"); }

bool LegacyReader::is_wanted(const std::string& name) const {
  return shapes_mesh(name) || options_.fields.empty() ||
         std::find(options_.fields.begin(), options_.fields.end(), name) != options_.fields.end();
}

void LegacyReader::add(std::string name, Association association, const std::string& type, size_t tuples, size_t components,
                       std::string_view keyword, Role role) {
  if (is_string(type)) return add_strings(std::move(name), association, tuples, components);
  const std::string what = fmt::format("{} '{}'", keyword, name);
  if (!is_wanted(name)) {
    text_.skip_array(type, tuples, components, what);
    return;
  }
  const bool hollow_one = options_.header_only && text_.binary && !shapes_mesh(name);
  Array a = hollow_one ? hollow(text_.skip_array(type, tuples, components, what), tuples, int(components))
                       : text_.array(type, tuples, components, what);
  parts_.fields.add({std::move(name), association, std::move(a), {}, role});
}

// Words of points and cells become categories, lines of the whole dataset a note, as in the XML forms.
void LegacyReader::add_strings(std::string name, Association association, size_t tuples, size_t components) {
  constexpr size_t most_lines = 100;
  const std::string what = fmt::format("array '{}'", name);
  uint64_t n = 0;
  if (!multiply(tuples, components, n)) text_.fail(fmt::format("{} has more strings than the file can hold", what));
  const std::vector<std::string> all = text_.strings(n, what);
  if (association == Association::whole) {
    if (all.empty() || all.size() > most_lines) return;
    std::string text;
    for (const std::string& line : all) text += (&line == &all[0] ? "" : "\n") + line;
    parts_.notes.emplace_back(std::move(name), std::move(text));
    return;
  }
  if (components != 1 || !is_wanted(name)) return;
  if (options_.header_only) return parts_.fields.add({std::move(name), association, hollow(ElementType::i32, tuples, 1), {}, Role::labels});
  auto categories = word_categories(name, all);
  if (!categories)
    return context_.info(
        fmt::format("the strings '{}' are left out: more than {} different ones are no categories", name, most_categories));
  parts_.notes.push_back(std::move(categories->note));
  parts_.fields.add({std::move(name), association, Array::from_vector(std::move(categories->numbers)), {}, Role::labels});
}

size_t LegacyReader::tuples() {
  if (association_ == Association::whole) text_.fail("attributes precede POINT_DATA or CELL_DATA");
  return attribute_count_;
}

void LegacyReader::scalars() {
  std::string name = decode_name(text_.need_word("the name of the scalars"));
  const std::string type(text_.need_word("the type of the scalars"));
  // "[components] LOOKUP_TABLE name": the first is often left out.
  const size_t components = equal_ignoring_case(text_.peek(), "LOOKUP_TABLE") ? 1 : text_.count("the number of components or LOOKUP_TABLE");
  if (!equal_ignoring_case(text_.need_word("LOOKUP_TABLE"), "LOOKUP_TABLE")) text_.fail("expected LOOKUP_TABLE here");
  text_.need_word("the name of the lookup table");
  add(std::move(name), association_, type, tuples(), components, "SCALARS", Role::scalars);
}

void LegacyReader::color_scalars() {
  std::string name = decode_name(text_.need_word("the name of the colour scalars"));
  const size_t components = text_.count("the number of colour components");
  const std::string what = fmt::format("COLOR_SCALARS '{}'", name);
  Array a = text_.array(text_.binary ? "unsigned_char" : "float", tuples(), components, what);
  if (!text_.binary) {  // as text they run from 0 to 1
    uint8_t* out = nullptr;
    const auto v = a.view<float>();
    const Array bytes = Array::make<uint8_t>(v.count, v.components, &out);
    for (size_t i = 0; i < v.count * components; ++i) out[i] = uint8_t(std::clamp(255.0f * v.data[i] + 0.5f, 0.0f, 255.0f));
    a = bytes;  // not before: v looks into the old numbers
  }
  if (is_wanted(name)) parts_.fields.add({std::move(name), association_, a, {}, Role::colors});
}

void LegacyReader::lookup_table() {
  text_.need_word("the name of the lookup table");
  const size_t n = text_.count("the size of the lookup table");
  text_.array(text_.binary ? "unsigned_char" : "float", n, 4, "LOOKUP_TABLE");
}

void LegacyReader::simple(size_t components, Role role) {
  std::string name = decode_name(text_.need_word("the name of the array"));
  const std::string type(text_.need_word("the type of the array"));
  add(std::move(name), association_, type, tuples(), components, "array", role);
}

void LegacyReader::texture_coordinates() {
  std::string name = decode_name(text_.need_word("the name of the texture coordinates"));
  const size_t components = text_.count("the number of texture coordinates per point");
  const std::string type(text_.need_word("the type of the texture coordinates"));
  add(std::move(name), association_, type, tuples(), components, "TEXTURE_COORDINATES", Role::tcoords);
}

void LegacyReader::field() {
  text_.need_word("the name of the field");
  const size_t arrays = text_.count("the number of arrays");
  for (size_t i = 0; i < arrays; ++i) {
    std::string name = decode_name(text_.need_word("the name of an array"));
    if (name == "NULL_ARRAY") continue;
    const size_t components = text_.count("the number of components"), n = text_.count("the number of tuples");
    const std::string type(text_.need_word("the type of the array"));
    if (association_ == Association::whole && n == 1 && components == 1 && (name == "TimeValue" || name == "TIME") && !is_string(type)) {
      parts_.time = text_.array(type, n, components, fmt::format("array '{}'", name)).get(0);
      continue;
    }
    const bool fits = association_ == Association::whole || n == attribute_count_;
    if (!fits)
      context_.warn(fmt::format("array '{}' has {} tuples, not {}: kept as a field of the whole dataset", name, n, attribute_count_));
    add(std::move(name), fits ? association_ : Association::whole, type, n, components, "array", Role::none);
  }
}

Mesh LegacyReader::mesh() {
  auto need_dims = [&] {
    if (!have_dims_) text_.fail("the dataset has no DIMENSIONS", "the file is truncated");
  };
  switch (kind_) {
    case Kind::none: break;
    case Kind::points: {
      need_dims();
      UniformGrid g;
      g.dims = dims_, g.spacing = spacing_, g.extent_start = start_;
      for (int a = 0; a < 3; ++a) g.origin[a] = start_[size_t(a)] ? origin_[a] + spacing_[a] * double(start_[size_t(a)]) : origin_[a];
      return g;
    }
    case Kind::curvilinear:
      need_dims();
      if (!have_points_) text_.fail("the dataset has no POINTS", "the file is truncated");
      return CurvilinearGrid{dims_, points_, start_};
    case Kind::rectilinear:
      need_dims();
      for (size_t a = 0; a < 3; ++a)
        if (axes_[a].count() != dims_[a])
          text_.fail(fmt::format("has {} {} coordinates for the dimension {}", axes_[a].count(), "xyz"[a], dims_[a]),
                     "the file is truncated or the count is wrong");
      return RectilinearGrid{axes_[0], axes_[1], axes_[2], start_};
    case Kind::unstructured: {
      if (!have_points_) text_.fail("the dataset has no POINTS", "the file is truncated");
      if (!have_cells_ && points_.count() > 0) text_.fail("the dataset has no CELLS", "the file is truncated");
      UnstructuredMesh m;
      m.points = points_, m.cells = cells_;
      if (type_count_ != cells_.size())
        text_.fail(fmt::format("{} CELL_TYPES for {} CELLS", type_count_, cells_.size()), "the file is truncated or the count is wrong");
      if (one_type_) m.single_type = *one_type_;
      else set_types(m, types_);
      if (!m.types.empty()) expand_polyhedra(m);
      if (const size_t mended = mend_named_linear(m))
        context_.warn(
            fmt::format("{} cells have more points than their types: they are read as the quadratic cells of these shapes", mended));
      return m;
    }
    case Kind::surface:
      if (!have_points_) text_.fail("the dataset has no POINTS", "the file is truncated");
      surface_.points = points_;
      return surface_;
  }
  text_.fail("the file has no mesh: it contains attributes without a DATASET",
             "use a file with DATASET STRUCTURED_POINTS, POLYDATA, UNSTRUCTURED_GRID, ...");
}

DatasetPtr LegacyReader::read() {
  header();
  for (std::string_view w = text_.word(); !w.empty(); w = text_.word()) {
    const std::string key = to_lower(w.substr(0, 40));
    const auto* k = std::find_if(std::begin(keywords), std::end(keywords), [&](const Keyword& x) { return x.name == key; });
    if (k == std::end(keywords))
      text_.fail(fmt::format("unknown keyword '{}'", w.substr(0, 40)), "there may be more numbers before it than announced");
    if (kind_ == Kind::none && k->read != &LegacyReader::dataset && k->read != &LegacyReader::field && k->read != &LegacyReader::metadata)
      text_.fail(fmt::format("the file has no mesh: {} comes before any DATASET", w),
                 "use a file with DATASET STRUCTURED_POINTS, POLYDATA, UNSTRUCTURED_GRID, ...");
    context_.check();
    (this->*k->read)();
  }
  parts_.mesh = mesh();
  if (auto* m = std::get_if<UnstructuredMesh>(&parts_.mesh)) {
    if (const Field* f = parts_.fields.find("RationalWeights", Association::point)) set_weights(*m, *f);
    if (const Field* f = parts_.fields.find("HigherOrderDegrees", Association::cell)) set_degrees(*m, *f);
  }
  take_ghosts(parts_);
  return make_dataset(std::move(parts_));
}

}  // namespace
}  // namespace vtk

Data read_vtk_legacy(const std::string& path, const ReadOptions& options, Context& context) {
  const MappedFile file(path);
  return vtk::LegacyReader(file, options, context).read();
}

}  // namespace sg
