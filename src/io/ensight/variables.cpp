// SPDX-License-Identifier: Apache-2.0
#include "io/ensight/variables.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/parallel.h"
#include "base/text/text.h"
#include "io/mesh/unread.h"

namespace sg::ensight {

namespace {

constexpr float no_value = std::numeric_limits<float>::quiet_NaN();

/// The values of one part as they come in.
class Values {
 public:
  Values(size_t count, int components, bool look_only) : count_(count), components_(components), look_only_(look_only) {}

  /// `n` tuples from `first` on; the line that begins them may contain undef or partial.
  void read(Stream& s, VariableKind kind, const std::string& line, size_t first, size_t n) {
    const auto w = words(line);
    const bool undef = std::find(w.begin(), w.end(), "undef") != w.end(), partial = std::find(w.begin(), w.end(), "partial") != w.end();
    const float undefined = undef ? s.real("the undefined value") : no_value;
    std::vector<int32_t> which;
    if (partial) {
      const size_t m = s.count("partial values", 4);
      which = s.integers(m, "places of partial values");
      for (const int32_t p : which)
        if (p < 1 || size_t(p) > n) s.fail(fmt::format("a partial value for position {} of {}", p, n));
      n = m;
    }
    if (look_only_) {
      for (int c = 0; c < components_; ++c) s.skip_numbers(n, "values");
      return;
    }
    for (int c = 0; c < components_; ++c) {
      const Array a = s.reals(n, "values");
      if (components_ == 1 && n == count_ && !undef && !partial) return void(whole_ = a);
      put(a, component_of(kind, c), first, which, undef, undefined);
    }
  }

  Array finished() {
    if (look_only_) return unread_values(ElementType::f32, count_, components_);
    if (whole_.count() == count_ && count_ > 0) return whole_;
    make();
    return values_;
  }

 private:
  void make() {
    if (out_ || count_ == 0) {
      if (count_ == 0) values_ = Array::make<float>(0, components_, &out_);
      return;
    }
    values_ = Array::make<float>(count_, components_, &out_);
    parallel_for(count_ * size_t(components_), 1 << 18, [&](size_t begin, size_t end) { std::fill(out_ + begin, out_ + end, no_value); });
  }

  void put(const Array& a, int component, size_t first, const std::vector<int32_t>& which, bool undef, float undefined) {
    make();
    const auto v = a.view<float>();
    const auto k = size_t(components_);
    parallel_for(v.count, 1 << 16, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const size_t to = first + (which.empty() ? i : size_t(which[i] - 1));
        out_[to * k + size_t(component)] = undef && v[i] == undefined ? no_value : v[i];
      }
    });
  }

  size_t count_;
  int components_;
  bool look_only_;
  Array whole_, values_;
  float* out_ = nullptr;
};

Part& part_of(Geometry& g, int number, Stream& s) {
  for (Part& p : g.parts)
    if (p.number == number) return p;
  s.fail(fmt::format("part {} is not in the geometry", number));
}

void read_elements(Stream& s, const Variable& v, const Part& part, Values& values) {
  std::vector<bool> done(part.sections.size());
  for (;;) {
    const std::string line = to_lower(s.peek());
    if (line.empty() || !find_element(line)) return;
    s.keyword("an element type");
    const std::string_view type = words(line)[0];
    size_t k = 0;
    while (k < done.size() && (done[k] || words(part.sections[k].type)[0] != type)) ++k;
    if (k == done.size()) s.fail(fmt::format("part {} has no (further) elements '{}'", part.number, type));
    done[k] = true;
    values.read(s, v.kind, line, part.sections[k].first, part.sections[k].count);
  }
}

}  // namespace

int component_of(VariableKind kind, int listed) {
  constexpr int symm[] = {0, 1, 2, 3, 5, 4};
  return kind == VariableKind::tensor_symm ? symm[listed] : listed;
}

void read_variable(Stream& s, const Variable& v, const std::string& name, Geometry& geometry, bool look_only) {
  if (s.peek() == "BEGIN TIME STEP") s.keyword("BEGIN TIME STEP");
  s.line("a description");
  for (;;) {
    const std::string k = s.peek();
    if (!to_lower(k).starts_with("part")) {
      if (k != "END TIME STEP" && !s.at_end()) s.fail(fmt::format("found '{}' where a part was expected", k.substr(0, 40)));
      return;
    }
    s.keyword("part");
    Part& part = part_of(geometry, s.integer("the number of a part"), s);
    const bool on_cells = v.association == Association::cell;
    Values values(on_cells ? part.cells : part.points, v.components(), look_only);
    if (on_cells && !part.structured) {
      read_elements(s, v, part, values);
    } else {
      const std::string line = to_lower(s.keyword("expected 'coordinates' or 'block'"));
      if (!line.starts_with(part.structured ? "block" : "coordinates"))
        s.fail(fmt::format("found '{}' where '{}' was expected in part {}", line.substr(0, 40), part.structured ? "block" : "coordinates",
                           part.number));
      values.read(s, v.kind, line, 0, on_cells ? part.cells : part.points);
    }
    Role role = Role::none;
    if (v.kind == VariableKind::vector && !v.complex) role = Role::vectors;
    part.data.fields.add({name, v.association, values.finished(), "", role});
  }
}

void join_complex(const std::string& name, Association association, Geometry& geometry) {
  for (Part& p : geometry.parts) {
    const Field* r = p.data.fields.find(name + "_r", association);
    const Field* i = p.data.fields.find(name + "_i", association);
    if (!r || !i) continue;
    Array joined;
    if (r->array.stride_bytes() == 0) {
      joined = unread_values(ElementType::f32, r->array.count(), 2);
    } else {
      float* out = nullptr;
      joined = Array::make<float>(r->array.count(), 2, &out);
      const auto a = r->array.view<float>(), b = i->array.view<float>();
      for (size_t k = 0; k < a.count; ++k) out[2 * k] = a[k], out[2 * k + 1] = b[k];
    }
    p.data.fields.remove(name + "_r", association);
    p.data.fields.remove(name + "_i", association);
    p.data.fields.add({name, association, std::move(joined), "", Role::none});
  }
}

}  // namespace sg::ensight
