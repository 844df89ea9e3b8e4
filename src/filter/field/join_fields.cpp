// SPDX-License-Identifier: Apache-2.0
#include "filter/field/join_fields.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <set>

#include "base/error.h"
#include "data/lattice.h"
#include "data/trusted.h"

namespace sg {

namespace {

std::string shape_of(const Dataset& d) {
  std::string dims;
  if (is_lattice(d.mesh()))
    for (const size_t n : lattice_dims(d.mesh())) dims += (dims.empty() ? " of " : " x ") + std::to_string(n);
  return fmt::format("{}{}, {} points, {} cells", d.kind(), dims, d.point_count(), d.cell_count());
}

void check_shape(const Dataset& first, const Dataset& other, size_t number, Context& context) {
  const bool lattices = is_lattice(first.mesh()) && is_lattice(other.mesh());
  const bool same = first.point_count() == other.point_count() && first.cell_count() == other.cell_count() &&
                    (lattices ? lattice_dims(first.mesh()) == lattice_dims(other.mesh()) : first.kind() == other.kind());
  if (!same)
    fail_usage(fmt::format("input {} has a different mesh: {}; the first has {}", number, shape_of(other), shape_of(first)), "join_fields",
               "the operation probe transfers fields from one mesh to another");
  const Box3 a = first.bounds(), b = other.bounds();
  const double apart = std::max(length(a.lo - b.lo), length(a.hi - b.hi));
  if (apart > 1e-6 * length(a.size()))
    context.warn(fmt::format(
        "join_fields: the points of input {} lie up to {:.3g} away from those of the first; values are matched by index", number, apart));
}

bool same_values(const Array& a, const Array& b) {
  if (a.type() != b.type() || a.count() != b.count() || a.components() != b.components()) return false;
  const Array p = a.made_packed(), q = b.made_packed();
  return p.bytes() == 0 || std::memcmp(p.raw(), q.raw(), p.bytes()) == 0;
}

// Hidden in one of them is hidden.
Array both_ghosts(const Array& a, const Array& b) {
  if (a.empty() || b.empty()) return a.empty() ? b : a;
  uint8_t* out = nullptr;
  Array r = Array::make<uint8_t>(a.count(), 1, &out);
  for (size_t i = 0; i < a.count(); ++i) out[i] = uint8_t(int(a.get(i)) | int(b.get(i)));
  return r;
}

class Join {
 public:
  Join(const JoinFieldsParams& p, Context& context) : p_(p), context_(context) {}

  DatasetPtr operator()(const std::vector<DatasetPtr>& inputs) {
    DatasetParts parts = inputs[0]->parts();
    for (size_t i = 1; i < inputs.size(); ++i) {
      const Dataset& other = *inputs[i];
      check_shape(*inputs[0], other, i + 1, context_);
      parts.point_ghost = both_ghosts(parts.point_ghost, other.point_ghost());
      parts.cell_ghost = both_ghosts(parts.cell_ghost, other.cell_ghost());
      for (const Field& f : other.fields())
        if (wanted(f.name)) add(parts.fields, f, i + 1);
    }
    return make_trusted_dataset(std::move(parts));
  }

  void require_all(const std::vector<std::string>& have) const {
    for (const std::string& name : p_.fields)
      if (!found_.count(name))
        fail_usage(fmt::format("no further input has a field '{}'", name), "join_fields fields", unknown_name_hint(name, have));
  }

 private:
  bool wanted(const std::string& name) {
    return p_.fields.empty() || std::find(p_.fields.begin(), p_.fields.end(), name) != p_.fields.end();
  }

  void add(FieldSet& fields, Field f, size_t number) {
    found_.insert(f.name);
    if (!p_.names.empty()) f.name = p_.names[size_t(std::find(p_.fields.begin(), p_.fields.end(), f.name) - p_.fields.begin())];
    if (const Field* have = fields.find(f.name, f.association)) {
      if (same_values(have->array, f.array)) return;
      const std::string plain = f.name;
      f.name = fmt::format("{}_{}", plain, number);
      if (told_.insert(f.name).second)
        context_.info(
            fmt::format("join_fields: '{}' of input {} differs from that of the first and is renamed '{}'", plain, number, f.name));
    }
    for (const Field& have : fields)
      if (have.role == f.role) f.role = Role::none;  // what is active stays so
    fields.add(std::move(f));
  }

  const JoinFieldsParams& p_;
  Context& context_;
  std::set<std::string> found_, told_;
};

}  // namespace

Data join_fields(const std::vector<Data>& inputs, const JoinFieldsParams& p, Context& context) {
  if (!p.names.empty() && p.names.size() != p.fields.size())
    fail_usage(fmt::format("{} names for {} fields", p.names.size(), p.fields.size()), "join_fields names", "give one for each of fields=");
  std::vector<std::vector<DatasetPtr>> all(inputs.size());
  std::vector<std::string> have;
  for (size_t i = 0; i < inputs.size(); ++i) {
    if (std::holds_alternative<TablePtr>(inputs[i]))
      fail_usage(fmt::format("input {} is a table", i + 1), "join_fields", "meshes with fields");
    for_each_dataset(inputs[i], [&](const std::string&, const DatasetPtr& d) {
      all[i].push_back(d);
      if (i > 0)
        for (const std::string& name : d->fields().names()) have.push_back(name);
    });
    if (all[i].size() != all[0].size())
      fail_usage(fmt::format("input {} has {} parts, the first has {}", i + 1, all[i].size(), all[0].size()), "join_fields",
                 "collections are joined part by part");
  }
  Join join(p, context);
  size_t part = 0;
  Data out = map_datasets(inputs[0], [&](const DatasetPtr&) {
    std::vector<DatasetPtr> one;
    for (const auto& input : all) one.push_back(input[part]);
    ++part;
    return join(one);
  });
  join.require_all(have);
  return out;
}

}  // namespace sg
