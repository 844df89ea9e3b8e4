// SPDX-License-Identifier: Apache-2.0
#include "pipeline/operation/check_inputs.h"

#include <fmt/core.h>

#include "base/error.h"
#include "pipeline/operation/check_fields.h"

namespace sg {

namespace {

// The first part that is not taken, when none is.
struct Refused {
  std::optional<DataKind> kind;
  std::string part;
};

Refused refused(KindSet takes, const Data& data) {
  if (const auto* table = std::get_if<TablePtr>(&data))
    return *table && !takes.has(DataKind::table) ? Refused{DataKind::table, {}} : Refused{};
  Refused r;
  bool any = false;
  for_each_dataset(data, [&](const std::string& part, const DatasetPtr& d) {
    if (d == nullptr) return;
    const DataKind kind = kind_of(*d);
    any = any || takes.has(kind);
    if (!takes.has(kind) && !r.kind) r = {kind, part};
  });
  return any ? Refused{} : r;
}

// What makes of `given` something that is taken.
std::string_view what_would_do(KindSet takes, DataKind given) {
  if (given == DataKind::table) return "make points of its rows first: -f 'table_to_points x=... y=...'";
  if (takes == kinds::table) return "read a .csv or .json file";
  if (given == DataKind::amr && takes.has(DataKind::unstructured)) return "unstructured makes cells of it, resample a uniform grid";
  if (takes.has(DataKind::uniform)) return "resample makes a uniform grid of it";
  if (takes.has(DataKind::surface)) return "faces makes a surface of it";
  return takes.has(DataKind::unstructured) ? "unstructured makes cells of it" : "";
}

}  // namespace

void check_kinds(const Operation& o, std::span<const Data> inputs, size_t first) {
  for (size_t i = 0; i < inputs.size(); ++i) {
    const bool main = i + first == 0;
    const KindSet takes = main ? o.takes : o.takes_further;
    const Refused r = refused(takes, inputs[i]);
    if (!r.kind) continue;
    const bool own = main && !o.takes_hint.empty() && *r.kind != DataKind::table;
    fail_usage(fmt::format("needs {} but got {}{}", kinds_text(takes), kind_text(*r.kind),
                           r.part.empty() ? "" : fmt::format(" in part '{}'", r.part)),
               main ? std::string(o.name) : fmt::format("{} input {}", o.name, i + first + 1),
               std::string(own ? o.takes_hint : what_would_do(takes, *r.kind)));
  }
}

void check_inputs(const Operation& o, const Schema& schema, std::span<const Data> inputs) {
  check_kinds(o, inputs);
  check_fields(o.name, schema, inputs);
}

}  // namespace sg
