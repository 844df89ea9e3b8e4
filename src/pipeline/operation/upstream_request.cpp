// SPDX-License-Identifier: Apache-2.0
// What an operation asks of its inputs: fields by its FieldNeeds, the rest by its hooks.
#include <algorithm>

#include "base/text/text.h"
#include "pipeline/operation/operation.h"

namespace sg {

namespace {

void ask_for_all(Request& r) { r.all_fields = true, r.fields.clear(); }

bool holds(const FieldNeeds::Names& names, std::string_view name) { return std::find(names.begin(), names.end(), name) != names.end(); }

// Those that the parameters of type field name; false when one is left open, so that the operation chooses among all.
bool add_fields_named(const ParamSet& params, const FieldNeeds& needs, Request& r) {
  for (const ParamDecl& d : params.schema.decls()) {
    if (d.ref.type() != ParamType::field) continue;
    const std::string name = param_text(d);
    if (!name.empty()) add_field(r, name);
    else if (!holds(needs.may_lack, d.name)) return false;
  }
  return true;
}

// The names that a word or a list of words holds; false: none.
bool add_fields_listed(const ParamSet& params, std::string_view parameter, Request& r) {
  const ParamDecl* d = params.schema.find(parameter);
  if (!d) return false;
  const Value value = d->ref.get();
  if (auto* word = std::get_if<std::string>(&value); word && !word->empty()) return add_field(r, *word), true;
  auto* list = std::get_if<std::vector<std::string>>(&value);
  if (!list) return false;
  for (const std::string& name : *list) add_field(r, name);
  return !list->empty();
}

void ask_for_fields(const FieldNeeds& needs, const ParamSet& params, size_t input, Request& r) {
  if (int64_t(input) >= needs.inputs_with_fields) {
    r.all_fields = false, r.fields.clear();
    return;
  }
  if (needs.result == FieldNeeds::Result::every) return ask_for_all(r);
  if (needs.result == FieldNeeds::Result::own) r.all_fields = false, r.fields.clear();
  // What moves fields of cells to points, where there is a field of the name already, calls them so.
  constexpr std::string_view moved = "_cell";
  for (const std::string& name : std::vector<std::string>(r.fields))
    if (name.size() > moved.size() && name.ends_with(moved)) add_field(r, name.substr(0, name.size() - moved.size()));
  for (const std::string_view name : needs.found)
    if (!name.empty()) add_field(r, std::string(name));
  for (const std::string_view name : needs.lists)
    if (!name.empty()) add_fields_listed(params, name, r);
  for (const std::string_view name : needs.lists_or_all)
    if (!name.empty() && !add_fields_listed(params, name, r)) return ask_for_all(r);
  if (!add_fields_named(params, needs, r)) ask_for_all(r);
}

bool is_open(const ParamDecl& d) {
  const Value v = d.ref.get();
  if (std::holds_alternative<std::monostate>(v)) return true;
  if (auto* list = std::get_if<std::vector<double>>(&v)) return list->empty();
  return false;
}

}  // namespace

bool works_by_piece(const Operation& operation, const ParamSet& params, const Request& wanted, bool together) {
  const PieceWork& w = operation.pieces;
  if (wanted.pieces == 1 || w.result == PieceWork::Result::of_whole) return false;
  if (w.result == PieceWork::Result::of_all) return together;
  if (!w.keeps_ghosts && wanted.ghost_levels > 0) return false;
  if (!together && w.chooses && w.chooses(params)) return false;
  for (const std::string_view name : w.chosen)
    if (!together && !name.empty() && params.schema.find(name) && is_open(*params.schema.find(name))) return false;
  return true;
}

Request upstream_request(const Operation& operation, const ParamSet& params, const Request& wanted, size_t input, bool together) {
  Request r = wanted;
  // Only a hook knows what part of the input a part of the result needs.
  r.region.reset();
  const bool by_piece = int64_t(input) < operation.pieces.inputs && works_by_piece(operation, params, wanted, together);
  if (!by_piece) r.piece = 0, r.pieces = 1, r.ghost_levels = 0;
  else if (operation.pieces.result == PieceWork::Result::of_all) r.ghost_levels = 0;
  else r.ghost_levels += operation.pieces.ghost_levels;
  ask_for_fields(operation.fields, params, input, r);
  if (operation.ask) operation.ask(params, wanted, input, r);
  return r;
}

}  // namespace sg
