// SPDX-License-Identifier: Apache-2.0
#include "io/plugins/netcdf/exodus.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/text/text.h"
#include "io/mesh/unread.h"

namespace sg::nc {

const ObjectKind element_blocks{"Element Blocks", "eb", "num_el_blk", "num_el_in_blk", "connect", "elem", "eb", false};
const ObjectKind face_blocks{"Face Blocks", "fa", "num_fa_blk", "num_fa_in_blk", "fbconn", "face", "fb", false};
const ObjectKind edge_blocks{"Edge Blocks", "ed", "num_ed_blk", "num_ed_in_blk", "ebconn", "edge", "eb", false};
const ObjectKind side_sets{"Side Sets", "ss", "num_side_sets", "num_side_ss", "elem_ss", "sset", "ss", true};
const ObjectKind node_sets{"Node Sets", "ns", "num_node_sets", "num_nod_ns", "node_ns", "nset", "ns", true};

bool is_exodus(const NcFile& file) {
  return file.dim("num_nodes") && (file.dim("num_el_blk") || file.dim("num_elem") || file.find("coordx") || file.find("coord"));
}

std::vector<double> exodus_times(const NcFile& file) {
  const Variable* t = file.find("time_whole");
  return t && t->is_number() && t->shape.size() == 1 ? file.doubles(*t) : std::vector<double>();
}

std::vector<ExodusObject> exodus_objects(const NcFile& file, const ObjectKind& kind) {
  std::vector<ExodusObject> objects;
  const size_t n = file.dim(kind.number).value_or(0);
  // Each has dimensions and variables of its own, so that a larger number is nonsense.
  if (n > file.dimensions().size() + file.variables().size() + (1 << 16))
    file.fail(fmt::format("has {} {}", n, kind.group), {}, "the dimension is damaged");
  std::vector<std::string> names;
  std::vector<double> ids;
  if (const Variable* v = file.find(std::string(kind.prefix) + "_names"); v && v->is_text()) names = file.strings(*v);
  if (const Variable* v = file.find(std::string(kind.prefix) + "_prop1"); v && v->is_number()) ids = file.doubles(*v);
  size_t first = 0;
  for (size_t i = 0; i < n; ++i) {
    ExodusObject o{&kind, int(i) + 1, i < ids.size() ? int64_t(ids[i]) : int64_t(i) + 1, i < names.size() ? names[i] : std::string(),
                   0,     first};
    if (o.name.empty()) o.name = fmt::format("Unnamed {} ID: {}", kind.set ? "set" : "block", o.id);
    o.size = file.dim(fmt::format("{}{}", kind.size, i + 1)).value_or(0);
    first += o.size;
    objects.push_back(std::move(o));
  }
  return objects;
}

ExodusMesh::ExodusMesh(const NcFile& file, const ReadOptions& options, Context& context)
    : elements(exodus_objects(file, element_blocks)),
      faces(exodus_objects(file, face_blocks)),
      edges(exodus_objects(file, edge_blocks)),
      sides(exodus_objects(file, side_sets)),
      node_lists(exodus_objects(file, node_sets)),
      file_(file),
      options_(options),
      context_(context) {
  nodes_ = file.dim("num_nodes").value_or(0);
  const size_t space = file.dim("num_dim").value_or(3);
  if (space < 1 || space > 3) file.fail(fmt::format("is a mesh in {} dimensions", space), {}, "Exodus II has 1 to 3 dimensions");
  space_ = int(space);
  const std::vector<double> times = exodus_times(file);
  if (!times.empty()) {
    step_ = chosen_step(times, options, file.path());
    time_ = times[step_];
  } else if (options.step > 0) {
    chosen_step(times, options, file.path());  // throws
  }
  const char* axis[] = {"coordx", "coordy", "coordz"};
  const Variable* together = file.find("coord");
  for (size_t a = 0; a < space; ++a) {
    const Variable* v = together ? together : file.find(axis[a]);
    if (!v) continue;  // nodes without coordinates along this axis
    const size_t rank = together ? 2 : 1;
    if (!v->is_number() || v->shape.size() != rank || v->shape.back() != nodes_ || (together && v->shape[0] < space))
      file.fail(fmt::format("must hold the coordinates of {} nodes", nodes_), v->name);
    const ElementType type = v->element() == ElementType::f32 ? ElementType::f32 : ElementType::f64;
    axes_[a] = together ? file.read(*v, {a, 0}, {1, nodes_}, type) : file.read(*v, type);
  }
  if (nodes_ > 0 && axes_[0].empty() && axes_[1].empty() && axes_[2].empty()) file.fail("has no coordinates of its nodes");
  if (const std::string title = file.text(nullptr, "title"); !title.empty()) notes_.emplace_back("title", title);
  for (const char* name : {"info_records", "qa_records"})
    if (const Variable* v = file.find(name); v && v->is_text()) {
      std::string all;
      for (const std::string& row : file.strings(*v))
        if (!row.empty()) all += (all.empty() ? "" : "\n") + row;
      if (!all.empty()) notes_.emplace_back(name, all);
    }
  // Global variables: one number each at this step.
  const Variable* names = file.find("name_glo_var");
  const Variable* v = file.find("vals_glo_var");
  if (names && names->is_text() && v && v->is_number() && v->shape.size() == 2 && step_ < v->shape[0]) {
    const Array all =
        options.header_only ? unread_values(ElementType::f64, v->shape[1]) : file.read(*v, {step_, 0}, {1, v->shape[1]}, ElementType::f64);
    const std::vector<std::string> words = file.strings(*names);
    for (size_t i = 0; i < std::min(words.size(), all.count()); ++i)
      if (wanted(words[i])) whole_.add({words[i], Association::whole, all.slice(i, i + 1), {}, Role::none});
  }
}

Data read_exodus(const NcFile& file, const ReadOptions& options, Context& context) {
  ExodusMesh mesh(file, options, context);
  Collection all;
  const auto add = [&](const std::vector<ExodusObject>& objects, const ObjectKind& kind, auto&& make) {
    Collection group;
    std::vector<ExodusObject> sorted = objects;  // by id, as VTK lists them
    std::stable_sort(sorted.begin(), sorted.end(), [](const ExodusObject& a, const ExodusObject& b) { return a.id < b.id; });
    for (const ExodusObject& o : sorted) {
      context.check();
      if (o.size == 0) continue;
      const DatasetPtr d = with_context(fmt::format("reading '{}' of the {}", o.name, to_lower(kind.group)), [&] { return make(o); });
      if (d) group.parts.push_back({o.name, d});
    }
    if (!group.parts.empty()) all.parts.push_back({kind.group, std::make_shared<const Collection>(std::move(group))});
  };
  const auto block = [&](const ExodusObject& o) { return mesh.block(o); };
  add(mesh.elements, element_blocks, block);
  const auto asked_for = [&](const ObjectKind& kind) {
    if (mesh.elements.empty()) return true;
    if (options.fields.empty()) return false;
    for (const std::string& name : mesh.variable_names(kind))
      if (mesh.wanted(name)) return true;
    return false;
  };
  for (const auto& [kind, objects] : {std::pair(&face_blocks, &mesh.faces), {&edge_blocks, &mesh.edges}}) {
    if (asked_for(*kind)) add(*objects, *kind, block);
    else if (!objects->empty())
      context.info(fmt::format("{}: {} {} are left out; request one of their fields to read them", file.path(), objects->size(),
                               to_lower(kind->group)));
  }
  add(mesh.sides, side_sets, [&](const ExodusObject& o) { return mesh.side_set(o); });
  add(mesh.node_lists, node_sets, [&](const ExodusObject& o) { return mesh.node_set(o); });
  if (all.parts.empty()) file.fail("contains no elements");
  return std::make_shared<const Collection>(std::move(all));
}

}  // namespace sg::nc
