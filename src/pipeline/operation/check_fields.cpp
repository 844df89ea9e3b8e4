// SPDX-License-Identifier: Apache-2.0
#include "pipeline/operation/check_fields.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/schema/field_kinds.h"

namespace sg {

namespace {

bool fits(const FieldKinds& k, const Field& f) {
  if (f.association == Association::point) return k.points && takes_components(k, f.components());
  return f.association == Association::whole || (k.cells && takes_components(k, f.components()));
}

// What is wrong with a field of some name, and which others would do.
struct Finding {
  const Field* refused = nullptr;
  bool fits = false;
  std::vector<std::string> others;
};

Finding look_for(const std::string& name, const FieldKinds& kinds, std::span<const Data> inputs) {
  Finding r;
  for (const Data& input : inputs)
    for_each_dataset(input, [&](const std::string&, const DatasetPtr& d) {
      if (d == nullptr) return;
      for (const Field& f : d->fields()) {
        const bool good = fits(kinds, f);
        if (f.name == name) {
          r.fits = r.fits || good;
          if (!good && !r.refused) r.refused = &f;
        } else if (good && f.association != Association::whole && std::find(r.others.begin(), r.others.end(), f.name) == r.others.end()) {
          r.others.push_back(f.name);
        }
      }
    });
  return r;
}

std::string hint(const FieldKinds& kinds, const Field& f, const std::vector<std::string>& others) {
  std::string r = "it takes " + field_kinds_text(kinds);
  if (!others.empty()) {
    r += ": ";
    for (size_t i = 0; i < std::min<size_t>(others.size(), 5); ++i) r += (i ? ", " : "") + others[i];
    if (others.size() > 5) r += ", ...";
  }
  if (takes_components(kinds, f.components()))
    r += f.association == Association::cell ? "; cell_to_point moves it" : "; point_to_cell moves it";
  else if (kinds.scalars && f.components() > 1) r += "; magnitude or component makes a scalar of it";
  return r;
}

}  // namespace

void check_fields(std::string_view who, const Schema& schema, std::span<const Data> inputs) {
  for (const ParamDecl& d : schema.decls()) {
    if (d.ref.type() != ParamType::field || d.field_ == FieldKinds{}) continue;
    const std::string name = param_text(d);
    if (name.empty()) continue;
    const Finding found = look_for(name, d.field_, inputs);
    if (!found.refused || found.fits) continue;
    const Field& f = *found.refused;
    const int n = f.components();
    fail_usage(fmt::format("field '{}' is a {} field of {} component{}", f.name, association_name(f.association), n, n == 1 ? "" : "s"),
               fmt::format("{} {}", who, d.name), hint(d.field_, f, found.others));
  }
}

}  // namespace sg
