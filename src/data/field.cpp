// SPDX-License-Identifier: Apache-2.0
#include "data/field.h"

#include <fmt/core.h>

#include <atomic>
#include <unordered_map>
#include <unordered_set>

#include "base/error.h"

namespace sg {

std::string_view association_name(Association a) { return a == Association::point ? "point" : a == Association::cell ? "cell" : "whole"; }

struct FieldSet::Index {
  std::unordered_map<std::string, size_t> places[3];  // by association
};

FieldSet::FieldSet(const FieldSet&) = default;
FieldSet::FieldSet(FieldSet&&) noexcept = default;
FieldSet& FieldSet::operator=(const FieldSet&) = default;
FieldSet& FieldSet::operator=(FieldSet&&) noexcept = default;
FieldSet::~FieldSet() = default;

namespace {
constexpr size_t many = 32, nowhere = SIZE_MAX;
}

size_t FieldSet::place_of(std::string_view name, Association a) const {
  if (index_) {
    const auto& places = index_->places[size_t(a)];
    const auto at = places.find(std::string(name));
    return at == places.end() ? nowhere : at->second;
  }
  for (size_t i = 0; i < fields_.size(); ++i)
    if (fields_[i].association == a && fields_[i].name == name) return i;
  return nowhere;
}

void FieldSet::add(Field f) {
  if (f.look.result)
    for (Field& other : fields_) other.look.result = false;
  if (const size_t at = place_of(f.name, f.association); at != nowhere) {
    fields_[at] = std::move(f);
    return;
  }
  if (fields_.size() >= many) {
    if (!index_) {
      index_ = std::make_shared<Index>();
      for (size_t i = 0; i < fields_.size(); ++i) index_->places[size_t(fields_[i].association)].emplace(fields_[i].name, i);
    } else if (index_.use_count() > 1) {
      index_ = std::make_shared<Index>(*index_);
    }
    std::atomic_thread_fence(std::memory_order_acquire);  // another copy may just have released it
    index_->places[size_t(f.association)].emplace(f.name, fields_.size());
  }
  fields_.push_back(std::move(f));
}

void FieldSet::remove(std::string_view name, Association a) {
  const size_t at = place_of(name, a);
  if (at == nowhere) return;
  fields_.erase(fields_.begin() + ptrdiff_t(at));
  index_.reset();  // rebuilt by the next add()
}

const Field* FieldSet::find(std::string_view name, Association a) const {
  const size_t at = place_of(name, a);
  return at == nowhere ? nullptr : &fields_[at];
}

const Field* FieldSet::find(std::string_view name) const {
  for (Association a : {Association::point, Association::cell, Association::whole})
    if (const Field* f = find(name, a)) return f;
  return nullptr;
}

const Field& FieldSet::require(std::string_view name) const {
  if (const Field* f = find(name)) return *f;
  std::string hint = unknown_name_hint(name, names());
  if (name.size() == 1 && name[0] >= 'x' && name[0] <= 'z')
    hint += fmt::format("{}-f 'calc expr={} name={}' makes a field of the coordinate", hint.empty() ? "" : "; ", name, name);
  fail_usage(fmt::format("field '{}' not found", name), {}, hint);
}

const Field& FieldSet::require(std::string_view name, Association a) const {
  if (const Field* f = find(name, a)) return *f;
  if (const Field* other = find(name))
    fail_usage(
        fmt::format("field '{}' is defined on the {}s, not on the {}s", name, association_name(other->association), association_name(a)));
  require(name);
  fail_internal("unreachable");
}

const Field* FieldSet::with_role(Role role) const {
  for (Association a : {Association::point, Association::cell})
    for (const Field& f : fields_)
      if (f.association == a && f.role == role) return &f;
  return nullptr;
}

const Field* FieldSet::result() const {
  for (const Field& f : fields_)
    if (f.look.result) return &f;
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
  std::unordered_set<std::string_view> seen;
  for (const Field& f : fields_)
    if (seen.insert(f.name).second) r.push_back(f.name);
  return r;
}

}  // namespace sg
