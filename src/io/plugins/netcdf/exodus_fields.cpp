// SPDX-License-Identifier: Apache-2.0
// Exodus II: variables, maps and points of an object.
#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "base/parallel.h"
#include "io/mesh/unread.h"
#include "io/plugins/netcdf/exodus.h"
#include "io/volume/component_names.h"

namespace sg::nc {

namespace {

constexpr size_t nodes_per_chunk = 1 << 15;

/// Rows `nodes` of an array.
Array gathered(const Array& all, const std::vector<int64_t>& nodes) {
  std::byte* out = nullptr;
  Array r = Array::make_raw(all.type(), nodes.size(), all.components(), &out);
  const size_t row = size_t(all.components()) * element_size(all.type());
  const std::byte* from = all.raw();
  parallel_for(nodes.size(), nodes_per_chunk, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) std::memcpy(out + i * row, from + size_t(nodes[i]) * row, row);
  });
  return r;
}

}  // namespace

bool ExodusMesh::wanted(const std::string& name) const {
  return options_.fields.empty() || std::find(options_.fields.begin(), options_.fields.end(), name) != options_.fields.end();
}

std::vector<std::string> ExodusMesh::variable_names(const ObjectKind& kind) const {
  const Variable* v = file_.find(fmt::format("name_{}_var", kind.variable));
  std::vector<std::string> names = v && v->is_text() ? file_.strings(*v) : std::vector<std::string>();
  for (size_t i = 0; i < names.size(); ++i)
    if (names[i].empty()) names[i] = fmt::format("{} variable {}", kind.variable, i + 1);
  return names;
}

// Values of variable number i (from 0) of an object, or of all nodes when there is none. As f64, like VTK: the file may hold f32.
std::optional<Array> ExodusMesh::values(const ObjectKind& kind, size_t i, const ExodusObject* o) {
  const Variable* v = o ? file_.find(fmt::format("vals_{}_var{}{}{}", kind.variable, i + 1, kind.suffix, o->number))
                        : file_.find(fmt::format("vals_nod_var{}", i + 1));
  const size_t n = o ? o->size : nodes_;
  if (v) {
    if (!v->is_number() || v->shape.size() != 2 || v->shape[1] != n) file_.fail(fmt::format("must hold {} numbers per step", n), v->name);
    if (step_ >= v->shape[0]) return {};
    if (options_.header_only) return unread_values(ElementType::f64, n);
    return file_.read(*v, {step_, 0}, {1, n}, ElementType::f64);
  }
  if (o) return {};
  v = file_.find("vals_nod_var");  // older files: all variables together
  if (!v || !v->is_number() || v->shape.size() != 3 || v->shape[2] != n || i >= v->shape[1] || step_ >= v->shape[0]) return {};
  if (options_.header_only) return unread_values(ElementType::f64, n);
  return file_.read(*v, {step_, i, 0}, {1, 1, n}, ElementType::f64);
}

// Components side by side; two become three with a zero.
Array ExodusMesh::grouped(const std::vector<Array>& members) const {
  if (members.size() == 1) return members[0];
  const size_t n = members[0].count(), width = std::max<size_t>(members.size(), 3);
  if (options_.header_only) return unread_values(ElementType::f64, n, int(width));
  double* out = nullptr;
  Array r = Array::make<double>(n, int(width), &out);
  parallel_for(n, nodes_per_chunk, [&](size_t begin, size_t end) {
    for (size_t c = 0; c < width; ++c) {
      const double* from = c < members.size() ? members[c].view<double>().data : nullptr;
      for (size_t i = begin; i < end; ++i) out[i * width + c] = from ? from[i] : 0;
    }
  });
  return r;
}

FieldSet ExodusMesh::object_fields(const ExodusObject& o, size_t cells) {
  FieldSet fields;
  const Association a = Association::cell;
  if (cells == o.size) {
    const std::vector<std::string> names = variable_names(*o.kind);
    for (const NameGroup& group : group_components(names, space_ == 2)) {
      bool any = wanted(group.name);
      for (const size_t k : group.members) any = any || (!options_.fields.empty() && wanted(names[k]));
      if (!any) continue;
      std::vector<Array> parts;
      for (const size_t k : group.members)
        if (std::optional<Array> v = values(*o.kind, k, &o)) parts.push_back(std::move(*v));
      if (parts.size() == group.members.size()) {
        const Role role = parts.size() == 1 ? Role::none : parts.size() <= 3 ? Role::vectors : Role::tensors;
        fields.add({group.name, a, grouped(parts), {}, role});
      } else {  // only some components are kept for this object
        for (const size_t k : group.members)
          if (std::optional<Array> v = values(*o.kind, k, &o)) fields.add({names[k], a, std::move(*v), {}, Role::none});
      }
    }
  }
  if (wanted("ObjectId")) {
    int32_t* out = nullptr;
    Array id = Array::make<int32_t>(cells, 1, &out);
    std::fill(out, out + cells, int32_t(o.id));
    fields.add({"ObjectId", a, std::move(id), {}, Role::labels});
  }
  if (o.kind == &element_blocks) {
    add_map(fields, a, "elem_num_map", "GlobalElementId", o.first, o.size, true, nullptr);
    for (size_t i = 1; i <= file_.dim("num_elem_maps").value_or(0); ++i) {
      const Variable* names = file_.find("emap_names");
      const std::vector<std::string> words = names && names->is_text() ? file_.strings(*names) : std::vector<std::string>();
      const std::string name = i <= words.size() && !words[i - 1].empty() ? words[i - 1] : fmt::format("element map {}", i);
      if (!file_.find(fmt::format("elem_map{}", i))) break;
      add_map(fields, a, fmt::format("elem_map{}", i).c_str(), name, o.first, o.size, false, nullptr);
    }
  }
  return fields;
}

// A map gives numbers to nodes or elements; the one that says 1, 2, 3, ... has no information.
void ExodusMesh::add_map(FieldSet& fields, Association a, const char* variable, std::string name, size_t first, size_t count,
                         bool skip_identity, const std::vector<int64_t>* nodes) {
  const Variable* v = file_.find(variable);
  if (!v || !wanted(name)) return;
  if (!v->is_number() || v->shape.size() != 1 || first > v->shape[0] || count > v->shape[0] - first)
    file_.fail(fmt::format("must hold {} numbers", first + count), v->name);
  const Array map = file_.read(*v, {first}, {count}, ElementType::i64);
  const int64_t* p = map.view<int64_t>().data;
  bool identity = skip_identity;
  for (size_t i = 0; identity && i < count; ++i) identity = p[i] == int64_t(first + i) + 1;
  if (!identity) fields.add({std::move(name), a, nodes ? gathered(map, *nodes) : map, {}, Role::global_ids});
}

void ExodusMesh::add_point_fields(FieldSet& fields, const std::vector<int64_t>* nodes) {
  if (!node_fields_) {
    static const ObjectKind nodal{"nodes", "", "", "", "", "nod", "", false};
    node_fields_.emplace();
    const std::vector<std::string> names = variable_names(nodal);
    for (const NameGroup& group : group_components(names, space_ == 2)) {
      bool any = wanted(group.name);
      for (const size_t k : group.members) any = any || (!options_.fields.empty() && wanted(names[k]));
      if (!any) continue;
      std::vector<Array> parts;
      for (const size_t k : group.members)
        if (std::optional<Array> v = values(nodal, k, nullptr)) parts.push_back(std::move(*v));
      if (parts.size() != group.members.size()) continue;
      const Role role = parts.size() == 1 ? Role::none : parts.size() <= 3 ? Role::vectors : Role::tensors;
      node_fields_->add({group.name, Association::point, grouped(parts), {}, role});
    }
    add_map(*node_fields_, Association::point, "node_num_map", "GlobalNodeId", 0, nodes_, true, nullptr);
    const Variable* names_of = file_.find("nmap_names");
    const std::vector<std::string> words = names_of && names_of->is_text() ? file_.strings(*names_of) : std::vector<std::string>();
    for (size_t i = 1; i <= file_.dim("num_node_maps").value_or(0) && file_.find(fmt::format("node_map{}", i)); ++i)
      add_map(*node_fields_, Association::point, fmt::format("node_map{}", i).c_str(),
              i <= words.size() && !words[i - 1].empty() ? words[i - 1] : fmt::format("node map {}", i), 0, nodes_, false, nullptr);
  }
  for (const Field& f : *node_fields_) {
    Field copy = f;
    const bool unread =
        options_.header_only && is_float(f.array.type());  // maps are read: the only way to know whether they contain anything
    if (nodes) copy.array = unread ? unread_values(f.array.type(), nodes->size(), f.components()) : gathered(f.array, *nodes);
    fields.add(std::move(copy));
  }
}

Points ExodusMesh::points_of(const std::vector<int64_t>* nodes) {
  const size_t n = nodes ? nodes->size() : nodes_;
  const auto fill = [&](auto* out) {
    using T = std::remove_pointer_t<decltype(out)>;
    parallel_for(n, nodes_per_chunk, [&](size_t begin, size_t end) {
      for (size_t a = 0; a < 3; ++a) {
        const T* from = axes_[a].count() == nodes_ && nodes_ > 0 ? axes_[a].view<T>().data : nullptr;
        for (size_t i = begin; i < end; ++i) out[3 * i + a] = from ? from[nodes ? size_t((*nodes)[i]) : i] : T(0);
      }
    });
  };
  bool wide = false;
  for (const Array& a : axes_) wide = wide || (!a.empty() && a.type() == ElementType::f64);
  Points points;
  if (wide) {
    for (Array& a : axes_)
      if (!a.empty()) a = a.converted(ElementType::f64);
    double* out = nullptr;
    points.xyz = Array::make<double>(n, 3, &out);
    fill(out);
  } else {
    float* out = nullptr;
    points.xyz = Array::make<float>(n, 3, &out);
    fill(out);
  }
  return points;
}

}  // namespace sg::nc
