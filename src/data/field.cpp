// SPDX-License-Identifier: Apache-2.0
#include "data/field.h"

#include "base/error.h"

namespace sg {

std::string_view association_name(Association a) { return a == Association::point ? "point" : a == Association::cell ? "cell" : "whole"; }

void FieldSet::add(Field f) {
  for (Field& have : fields_)
    if (have.association == f.association && have.name == f.name) {
      have = std::move(f);
      return;
    }
  fields_.push_back(std::move(f));
}

void FieldSet::remove(std::string_view name, Association a) {
  std::erase_if(fields_, [&](const Field& f) { return f.association == a && f.name == name; });
}

const Field* FieldSet::find(std::string_view name, Association a) const {
  for (const Field& f : fields_)
    if (f.association == a && f.name == name) return &f;
  return nullptr;
}

const Field* FieldSet::find(std::string_view name) const {
  for (Association a : {Association::point, Association::cell, Association::whole})
    if (const Field* f = find(name, a)) return f;
  return nullptr;
}

const Field& FieldSet::require(std::string_view name) const {
  if (const Field* f = find(name)) return *f;
  fail_usage(fmt::format("field '{}' not found", name), {}, unknown_name_hint(name, names()));
}

const Field& FieldSet::require(std::string_view name, Association a) const {
  if (const Field* f = find(name, a)) return *f;
  if (const Field* other = find(name))
    fail_usage(fmt::format("field '{}' lies on the {}s, not on the {}s", name, association_name(other->association), association_name(a)));
  require(name);
  fail_internal("unreachable");
}

const Field* FieldSet::with_role(Role role) const {
  for (Association a : {Association::point, Association::cell})
    for (const Field& f : fields_)
      if (f.association == a && f.role == role) return &f;
  return nullptr;
}

const Field* FieldSet::active(int components) const {
  auto fits = [&](const Field& f) { return components == 0 || f.components() == components; };
  auto plain = [](Role r) { return r != Role::normals && r != Role::tcoords && r != Role::global_ids; };
  if (const Field* f = with_role(components == 3 ? Role::vectors : Role::scalars); f && fits(*f)) return f;
  for (Association a : {Association::point, Association::cell})
    for (const Field& f : fields_)
      if (f.association == a && fits(f) && plain(f.role)) return &f;
  return nullptr;
}

std::vector<std::string> FieldSet::names() const {
  std::vector<std::string> r;
  for (const Field& f : fields_)
    if (std::find(r.begin(), r.end(), f.name) == r.end()) r.push_back(f.name);
  return r;
}

}  // namespace sg
