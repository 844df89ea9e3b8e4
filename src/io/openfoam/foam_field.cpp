// SPDX-License-Identifier: Apache-2.0
#include "io/openfoam/foam_field.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "base/parallel.h"
#include "base/text/text.h"
#include "data/field_ops.h"
#include "io/mesh/unread.h"
#include "io/openfoam/foam_file.h"

namespace sg::openfoam {

namespace {

/// A value as written in the file.
struct Value {
  bool given = false, uniform = false;
  std::vector<double> one;
  Array list;
};

/// An entry of boundaryField.
struct PatchEntry {
  std::string key;  // name, or a pattern in quotes
  Value value;
};

// OpenFOAM lists a symmetric tensor as xx xy xz yy yz zz, we as xx yy zz xy yz xz.
Array in_our_order(const Array& a) {
  constexpr int from[] = {0, 3, 5, 1, 4, 2};
  std::byte* out = nullptr;
  Array r = Array::make_raw(a.type(), a.count(), 6, &out);
  const size_t size = element_size(a.type());
  const Array p = a.made_packed();
  parallel_for(a.count(), 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      for (size_t c = 0; c < 6; ++c) std::memcpy(out + (6 * i + c) * size, p.raw() + (6 * i + size_t(from[c])) * size, size);
  });
  return r;
}

Array filled(const std::vector<double>& one, ElementType type, size_t count) {
  const size_t k = one.size();
  std::byte* out = nullptr;
  Array a = Array::make_raw(type, count, int(k), &out);
  parallel_for(count * k, 1 << 18, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      if (type == ElementType::f64) reinterpret_cast<double*>(out)[i] = one[i % k];
      else reinterpret_cast<float*>(out)[i] = float(one[i % k]);
  });
  return a;
}

class FieldReader {
 public:
  FieldReader(const std::string& path, const FoamMesh& mesh, bool look_only) : f_(path), mesh_(mesh), look_only_(look_only) {
    kind_ = field_class(f_.class_name());
  }

  FoamField run(const std::string& name) {
    const size_t count = kind_.on_points ? mesh_.points.count() : mesh_.cells;
    read_entries();
    FoamField r;
    r.inner = {name, kind_.on_points ? Association::point : Association::cell, {}, unit_, Role::none};
    if (kind_.components == 3) r.inner.role = Role::vectors;
    if (!inner_.given) {
      const std::string why = f_.directive().empty() ? "" : fmt::format("; '{}' is not expanded", f_.directive());
      f_.fail(fmt::format("has no internalField{}", why), "use 'uniform VALUE' or 'nonuniform List<TYPE> N(...)'");
    }
    // An empty list means no values at all: a processor without cells.
    type_ = inner_.uniform || inner_.list.empty() ? ElementType::f32 : inner_.list.type();
    r.inner.array = array_of(inner_, count, "internalField");
    if (kind_.only_inner) return r;
    for (const Patch& p : mesh_.patches) {
      Field f = r.inner;
      if (kind_.on_points) f.array = Array();  // taken from the inner points by the caller
      else f.array = on_patch(p, r.inner.array);
      r.patches.push_back(std::move(f));
    }
    return r;
  }

 private:
  void read_entries() {
    for (;;) {
      const std::string key(f_.next());
      if (key.empty()) return;
      if (key[0] == '#') f_.remember_directive(key), f_.skip_directive();
      else if (key[0] == '$') f_.remember_directive(key), f_.skip_entry();
      else if (key == ";") continue;
      else if (key == "dimensions") dimensions();
      else if (key == "internalField" || (kind_.only_inner && key == "value")) {
        inner_ = value();
        if (look_only_) return;
      } else if (key == "boundaryField") boundary();
      else f_.skip_entry();
    }
  }

  void dimensions() {
    f_.expect("[", "the dimensions");
    std::vector<double> e;
    while (f_.peek() != "]") {
      if (const auto v = parse_double(f_.next())) e.push_back(*v);
      else f_.fail("dimensions must be seven numbers");
      if (e.size() > 7) f_.fail("dimensions must be seven numbers");
    }
    f_.next();
    f_.expect(";", "the dimensions");
    unit_ = unit_name(e);
  }

  Value value() {
    Value v;
    const std::string how(f_.next());
    if (how == "uniform") {
      v.uniform = true;
      const std::string_view t = f_.peek();
      if (t.starts_with('$') || t.starts_with('#')) return skipped();
      if (kind_.components > 1) f_.expect("(", "a uniform value");
      for (int c = 0; c < kind_.components; ++c) v.one.push_back(f_.real("a uniform value"));
      if (kind_.components > 1) f_.expect(")", "a uniform value");
    } else if (how == "nonuniform") {
      if (f_.peek().starts_with("List<")) f_.next();
      if (look_only_) {
        look_type_ = f_.list_type();
        v.given = true;
        return v;
      }
      v.list = f_.tuples(kind_.components, "values");
    } else if (how == "$internalField") {
      f_.expect(";", "an entry");
      return inner_;
    } else if (how.starts_with('$') || how.starts_with('#')) {
      f_.remember_directive(how);
      f_.skip_entry();
      return v;
    } else {
      f_.fail(fmt::format("found '{}' where uniform or nonuniform was expected", how.substr(0, 40)));
    }
    f_.expect(";", "an entry");
    v.given = true;
    return v;
  }
  Value skipped() {
    f_.skip_entry();
    return {};
  }

  void boundary() {
    f_.expect("{", "boundaryField");
    for (;;) {
      PatchEntry e;
      e.key = f_.next();
      if (e.key == "}") return;
      if (e.key.empty()) f_.fail("ends within boundaryField");
      if (e.key[0] == '#') {
        f_.remember_directive(e.key), f_.skip_directive();
        continue;
      }
      f_.expect("{", fmt::format("patch {}", e.key));
      for (;;) {
        const std::string key(f_.next());
        if (key == "}") break;
        if (key.empty()) f_.fail("ends within a patch");
        if (key == ";") continue;
        if (key[0] == '#') f_.remember_directive(key), f_.skip_directive();
        else if (key[0] == '$') f_.remember_directive(key), f_.skip_entry();
        else if (key == "value" && !kind_.on_points) e.value = value();
        else f_.skip_entry();
      }
      entries_.push_back(std::move(e));
    }
  }

  Array array_of(const Value& v, size_t count, const std::string& what) const {
    if (look_only_) return unread_values(look_type_, count, kind_.components);
    Array a;
    if (v.uniform) a = filled(v.one, type_, count);
    else if (v.list.count() != count) f_.fail(fmt::format("{} has {} values, expected {}", what, v.list.count(), count));
    else a = v.list.converted(type_);
    return kind_.components == 6 ? in_our_order(a) : a;
  }

  // The name itself goes first, then the last fitting pattern, then groups.
  const PatchEntry* entry_of(const Patch& p) const {
    for (const PatchEntry& e : entries_)
      if (e.key == p.name) return &e;
    for (auto e = entries_.rbegin(); e != entries_.rend(); ++e)
      if (e->key.size() >= 2 && e->key[0] == '"' && pattern_fits(std::string_view(e->key).substr(1, e->key.size() - 2), p.name)) return &*e;
    for (const PatchEntry& e : entries_)
      if (std::find(p.groups.begin(), p.groups.end(), e.key) != p.groups.end()) return &e;
    return nullptr;
  }

  Array on_patch(const Patch& p, const Array& inner) const {
    if (look_only_) return unread_values(inner.type(), p.count, kind_.components);
    const PatchEntry* e = entry_of(p);
    // Patches of no extent (empty) may keep a list of no values.
    if (e && e->value.given && (e->value.uniform || e->value.list.count() == p.count)) return array_of(e->value, p.count, p.name);
    if (e && e->value.given && e->value.list.count() != 0)
      f_.fail(fmt::format("patch '{}' has {} values, expected {}", p.name, e->value.list.count(), p.count));
    std::vector<int64_t> cells(p.count);
    for (size_t i = 0; i < p.count; ++i) cells[i] = mesh_.owner[p.start + i];
    return gather(inner, cells);
  }

  FoamFile f_;
  const FoamMesh& mesh_;
  bool look_only_;
  FieldClass kind_;
  ElementType type_ = ElementType::f32, look_type_ = ElementType::f32;
  std::string unit_;
  Value inner_;
  std::vector<PatchEntry> entries_;
};

bool fits(std::string_view p, std::string_view s, int depth) {
  if (depth > 64) return false;
  while (!p.empty()) {
    if (p[0] == '(') {  // one level of alternatives
      const size_t close = p.find(')');
      if (close == std::string_view::npos) return false;
      const std::string_view rest = p.substr(close + 1);
      std::string_view inside = p.substr(1, close - 1);
      for (;;) {
        const size_t bar = std::min(inside.find('|'), inside.size());
        if (fits(std::string(inside.substr(0, bar)) + std::string(rest), s, depth + 1)) return true;
        if (bar == inside.size()) return false;
        inside.remove_prefix(bar + 1);
      }
    }
    const bool star = p.size() > 1 && p[1] == '*';
    if (star) {
      for (size_t n = 0;; ++n) {
        if (fits(p.substr(2), s.substr(n), depth + 1)) return true;
        if (n == s.size() || (p[0] != '.' && p[0] != s[n])) return false;
      }
    }
    if (s.empty() || (p[0] != '.' && p[0] != s[0])) return false;
    p.remove_prefix(1), s.remove_prefix(1);
  }
  return s.empty();
}

}  // namespace

bool pattern_fits(std::string_view pattern, std::string_view name) {
  // Longer ones could take for ever; names of patches are short.
  return pattern.size() <= 200 && name.size() <= 200 && std::count(pattern.begin(), pattern.end(), '*') <= 4 &&
         std::count(pattern.begin(), pattern.end(), '(') <= 3 && fits(pattern, name, 0);
}

FieldClass field_class(const std::string& name) {
  FieldClass c;
  std::string_view n = name;
  if (n.starts_with("vol")) n.remove_prefix(3);
  else if (n.starts_with("point")) n.remove_prefix(5), c.on_points = true;
  else return {};
  if (n.ends_with("::Internal")) n.remove_suffix(10), c.only_inner = true;
  if (n == "ScalarField" || n == "SphericalTensorField") c.components = 1;
  else if (n == "VectorField") c.components = 3;
  else if (n == "SymmTensorField") c.components = 6;
  else if (n == "TensorField") c.components = 9;
  return c;
}

FoamField read_field(const std::string& path, const std::string& name, const FoamMesh& mesh, bool look_only) {
  return FieldReader(path, mesh, look_only).run(name);
}

std::string unit_name(std::span<const double> e) {
  constexpr const char* base[] = {"kg", "m", "s", "K", "mol", "A", "cd"};
  std::string up, down;
  int below = 0;
  for (size_t i = 0; i < e.size() && i < 7; ++i) {
    if (e[i] == 0) continue;
    std::string& to = e[i] > 0 ? up : down;
    below += e[i] < 0;
    to += (to.empty() ? "" : " ") + std::string(base[i]);
    if (std::fabs(e[i]) != 1) to += "^" + short_number(std::fabs(e[i]));
  }
  if (down.empty()) return up;
  return (up.empty() ? "1" : up) + "/" + (below > 1 ? "(" + down + ")" : down);
}

}  // namespace sg::openfoam
