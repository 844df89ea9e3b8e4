// SPDX-License-Identifier: Apache-2.0
// VTKHDF files: the choice of the kind, time steps, fields, blocks.
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/text/text.h"
#include "io/plugins/hdf5/minc/minc_2.h"
#include "io/plugins/hdf5/vtkhdf/vtkhdf.h"
#include "io/vtk/vtk_cells.h"

namespace sg {

namespace vtkhdf {

uint64_t Group::step_entry(const std::string& name, uint64_t otherwise, uint64_t column) const {
  if (!step.any || !file.is_dataset(at("Steps/" + name))) return otherwise;
  const h5::Dataset table(file, at("Steps/" + name));
  if (column >= table.row_size()) return otherwise;
  const Array row = table.read_rows(step.index, 1).converted(ElementType::i64);
  const int64_t v = row.view<int64_t>()(0, int(column));
  if (v < 0 || v > (int64_t(1) << 60)) file.fail(fmt::format("holds {} for step {}", v, step.index), table.path(), "the file is damaged");
  return uint64_t(v);
}

bool Group::wants(const std::string& field) const {
  const auto& f = options.fields;
  return vtk::is_ghost_name(field) || field == "TimeValue" || f.empty() || std::find(f.begin(), f.end(), field) != f.end();
}

std::vector<double> step_values(const h5::File& file, const std::string& group) {
  const std::string values = group + "/Steps/Values";
  if (!file.is_dataset(values)) return {};
  const h5::Dataset d(file, values);
  uint64_t n = d.rows();
  const std::vector<double> said = file.number_attribute(group + "/Steps", "NSteps");
  if (!said.empty()) {
    if (!(said[0] >= 0) || said[0] > double(n)) file.fail(fmt::format("has {} values for {} steps", n, said[0]), values);
    n = uint64_t(said[0]);
  }
  const Array a = d.read_rows(0, n).converted(ElementType::f64);
  std::vector<double> times(a.count());
  for (size_t i = 0; i < times.size(); ++i) times[i] = a.get(i);
  return times;
}

std::vector<std::string> field_names(const Group& g, const std::string& data) {
  std::vector<std::string> names;
  if (!g.file.is_group(g.at(data))) return names;
  for (std::string& name : g.file.children(g.at(data))) {
    if (!g.wants(name) || !g.file.is_dataset(g.at(data + "/" + name))) continue;
    const h5::Dataset d(g.file, g.at(data + "/" + name));
    if (d.numeric() && (d.in_place() || !g.options.header_only || vtk::is_ghost_name(name))) names.push_back(std::move(name));
  }
  return names;
}

Role role_of(const Group& g, const std::string& data, const std::string& name) {
  constexpr std::pair<const char*, Role> roles[] = {
      {"Scalars", Role::scalars}, {"Vectors", Role::vectors},      {"Normals", Role::normals},       {"TCoords", Role::tcoords},
      {"Tensors", Role::tensors}, {"GlobalIds", Role::global_ids}, {"PedigreeIds", Role::global_ids}};
  for (const auto& [attribute, role] : roles)
    if (const auto active = g.file.text_attribute(g.at(data), attribute); active && *active == name) return role;
  return Role::none;
}

Field field_of(const Group& g, const std::string& data, const std::string& name, Association association, Array values) {
  const std::string path = g.at(data + "/" + name);
  return {name, association, std::move(values), g.file.text_attribute(path, "units").value_or(""), role_of(g, data, name)};
}

Array read_field(const Group& g, const std::string& data, const std::string& name, uint64_t otherwise, uint64_t begin, uint64_t n) {
  uint64_t from = 0;
  if (!add(g.step_entry(data + "Offsets/" + name, otherwise), begin, from)) from = UINT64_MAX;
  return h5::Dataset(g.file, g.at(data + "/" + name)).read_rows(from, n);
}

void read_whole_fields(const Group& g, DatasetParts& parts) {
  if (!g.file.is_group(g.at("FieldData"))) return;
  for (const std::string& name : g.file.children(g.at("FieldData"))) {
    const std::string path = g.at("FieldData/" + name);
    if (!g.file.is_dataset(path)) continue;
    const h5::Dataset d(g.file, path);
    if (!d.numeric()) {
      for (std::string& text : d.strings()) parts.notes.emplace_back(name, std::move(text));
      continue;
    }
    if (!g.wants(name) || d.dims().size() > 2) continue;
    const bool in_time = g.step.any && g.file.is_dataset(g.at("Steps/FieldDataOffsets/" + name));
    const uint64_t from = g.step_entry("FieldDataOffsets/" + name, 0);
    // FieldDataSizes holds components and tuples of each step; without it, a step has one row.
    const uint64_t n = in_time ? g.step_entry("FieldDataSizes/" + name, 1, 1) : d.rows();
    parts.fields.add({name, Association::whole, d.read_rows(from, n), g.file.text_attribute(path, "units").value_or(""), Role::none});
  }
}

namespace {

constexpr int deepest = 16;  // blocks within blocks
constexpr size_t most_blocks = 100000;

Step chosen(const h5::File& file, const std::string& group, const ReadOptions& options) {
  const std::vector<double> times = step_values(file, group);
  if (times.empty()) return {};
  const size_t index = chosen_step(times, options, file.path());
  return {true, index, times[index]};
}

struct Reader {
  const h5::File& file;
  const ReadOptions& options;
  Context& context;
  size_t blocks = 0;

  DatasetPtr leaf(const std::string& path, const std::string& type) {
    const Group g{file, path, options, context, chosen(file, path, options)};
    DatasetParts parts;
    parts.time = g.step.time;
    if (type == "ImageData") read_image(g, parts);
    else if (type == "UnstructuredGrid") read_unstructured(g, parts);
    else if (type == "PolyData") read_polydata(g, parts);
    else if (type == "OverlappingAMR") read_amr(g, parts);
    else
      file.fail(fmt::format("holds a dataset of type '{}'", type), path,
                "supported: ImageData, UnstructuredGrid, PolyData, OverlappingAMR, PartitionedDataSetCollection, MultiBlockDataSet");
    read_whole_fields(g, parts);
    if (const Field* t = parts.fields.find("TimeValue", Association::whole); t && !parts.time && t->array.count() == 1) {
      parts.time = t->array.get(0);
      parts.fields.remove("TimeValue", Association::whole);
    }
    vtk::take_ghosts(parts);
    return make_dataset(std::move(parts));
  }

  // A block of a collection: a dataset, or (in an assembly) a group of further ones.
  Data node(const std::string& path, int depth) {
    context.check();
    if (depth > deepest || ++blocks > most_blocks) file.fail("nests blocks too deeply", path, "the file is damaged");
    const auto type = file.text_attribute(path, "Type");
    if (!type || *type == "MultiBlockDataSet" || *type == "PartitionedDataSetCollection") return collection(path, type.value_or(""), depth);
    return leaf(path, *type);
  }

  Data collection(const std::string& path, const std::string& type, int depth) {
    auto out = std::make_shared<Collection>();
    // Multi-block data name their tree by an assembly of links; partitioned ones list the blocks themselves by their index.
    const bool assembly = type == "MultiBlockDataSet" && file.is_group(path + "/Assembly");
    const std::string from = assembly ? path + "/Assembly" : path;
    std::vector<std::pair<double, std::string>> order;
    for (const std::string& name : file.children(from)) {
      const std::string child = from + "/" + name;
      if ((!type.empty() && !assembly && name == "Assembly") || name == "Steps" || name == "FieldData" || !file.is_group(child)) continue;
      const std::vector<double> index = file.number_attribute(child, "Index");
      order.emplace_back(index.empty() || assembly ? double(order.size()) : index[0], name);
    }
    std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [index, name] : order) out->parts.push_back({name, node(from + "/" + name, depth + 1)});
    return CollectionPtr(out);
  }

  // The time values of the first group that has some.
  std::vector<double> times(const std::string& path, int depth) {
    std::vector<double> t = step_values(file, path);
    if (!t.empty() || depth > deepest || ++blocks > most_blocks) return t;
    const auto type = file.text_attribute(path, "Type");
    if (type && *type != "MultiBlockDataSet" && *type != "PartitionedDataSetCollection") return t;
    for (const std::string& name : file.children(path))
      if (t.empty() && name != "Assembly" && file.is_group(path + "/" + name) && file.text_attribute(path + "/" + name, "Type"))
        t = times(path + "/" + name, depth + 1);
    return t;
  }
};

// Any other HDF5 file: what it holds, and what would be read.
[[noreturn]] void refuse_other(const h5::File& file) {
  std::string found;
  size_t n = 0;
  for (const std::string& name : file.children("/")) {
    if (++n > 12) {
      found += ", ...";
      break;
    }
    found += (found.empty() ? "" : ", ") + name + (file.is_group("/" + name) ? "/" : "");
  }
  fail_data(fmt::format("is an HDF5 file of an unknown kind: it contains {}", found.empty() ? "nothing" : found), file.path(),
            "supported: VTKHDF (a group 'VTKHDF'), MINC 2 (.mnc), netCDF 4 (.nc), Exodus (.e .exo), CGNS (.cgns), ENZO (open its "
            ".hierarchy) and XDMF (open its .xdmf)");
}

void check_version(const h5::File& file, Context& context) {
  const std::vector<double> v = file.number_attribute("/VTKHDF", "Version");
  if (v.size() == 2 && v[0] > 2) context.warn(fmt::format("{}: VTKHDF version {}.{} is newer than this reader", file.path(), v[0], v[1]));
}

}  // namespace
}  // namespace vtkhdf

Data read_vtkhdf(const std::string& path, const ReadOptions& options, Context& context) {
  const h5::Turn turn;
  const h5::File file(path);
  if (minc::is_minc_2(file)) return minc::read_minc_2(file, options, context);
  if (!file.is_group("/VTKHDF")) vtkhdf::refuse_other(file);
  vtkhdf::check_version(file, context);
  if (!file.text_attribute("/VTKHDF", "Type")) file.fail("has no attribute 'Type'", "/VTKHDF", "the file is damaged or not complete");
  return vtkhdf::Reader{file, options, context}.node("/VTKHDF", 0);
}

std::vector<double> times_of_vtkhdf(const std::string& path, const ReadOptions& options, Context& context) {
  const h5::Turn turn;
  const h5::File file(path);
  if (minc::is_minc_2(file)) return minc::minc_2_times(file);
  if (!file.is_group("/VTKHDF")) return {};
  return vtkhdf::Reader{file, options, context}.times("/VTKHDF", 0);
}

}  // namespace sg
