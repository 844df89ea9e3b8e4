// SPDX-License-Identifier: Apache-2.0
// Meshes in blocks with sets of their sides and nodes, as Exodus files hold them: the sets lie upon the blocks, and drawn together both
// would flicker.
#include <fmt/format.h>

#include <algorithm>

#include "base/schema/field_kinds.h"
#include "filter/mesh/select/extract_ids.h"
#include "pipeline/operation/operation.h"
#include "pipeline/picture/picture_parts.h"

namespace sg {

namespace {

// The top parts of a collection that hold the blocks of a mesh, where others hold sets of their sides and nodes, named as Exodus files and
// what is made of them name them. Empty where there are no sets.
std::vector<std::string> blocks_beside_sets(const Data& data) {
  std::vector<std::string> blocks;
  bool sets = false;
  if (const auto* c = std::get_if<CollectionPtr>(&data))
    for (const Collection::Part& part : (*c)->parts) {
      if (part.name.ends_with(" Blocks")) blocks.push_back(part.name);
      sets = sets || part.name.ends_with(" Sets");
    }
  return sets ? blocks : std::vector<std::string>();
}

bool extracts(const PipelineFile::Step& step) {
  const Operation* op = known_operation(step.operation);
  return op && op->is<ExtractParams>();
}

// Were parts chosen by name on the way to a step?
bool parts_chosen(const PipelineFile& file, const std::string& step) {
  const auto chain = steps_behind(file, step);
  return std::any_of(chain.begin(), chain.end(),
                     [](const PipelineFile::Step* s) { return extracts(*s) && word_value(s->words, "blocks"); });
}

bool has_field(const Data& data, const std::string& name) {
  bool found = false;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) { found = found || d->fields().find(name); });
  return found;
}

// The fields that a way to show names.
std::vector<std::string> named_fields(const Schema& schema) {
  std::vector<std::string> names;
  for (const ParamDecl& d : schema.decls())
    if (d.ref.type() == ParamType::field)
      if (const FieldName field{param_text(d)}; !field.empty() && !field.none() && !is_automatic(field)) names.push_back(field.name);
  return names;
}

}  // namespace

bool leave_out_sets(PipelineFile& file, std::string& step, Data& data, const std::vector<std::string>& fields,
                    std::vector<std::string>& notes, Context& context) {
  const std::vector<std::string> blocks = blocks_beside_sets(data);
  if (blocks.empty() || parts_chosen(file, step)) return false;
  ExtractParams p;
  p.blocks = blocks;
  const Data kept = extract_blocks(data, p, context);
  if (!std::all_of(fields.begin(), fields.end(), [&](const std::string& name) { return has_field(kept, name); })) return false;
  data = kept;
  const std::vector<std::string> words{fmt::format("blocks={}", fmt::join(blocks, ","))}, from{step};
  const auto made =
      std::find_if(file.steps.begin(), file.steps.end(), [&](const auto& s) { return extracts(s) && s.words == words && s.from == from; });
  step = made != file.steps.end() ? made->name : added_step(file, "extract", words, step);
  const char* said = "sets of sides and nodes lie upon the blocks and are left out: -f 'extract blocks=\"Side Sets\"' takes them";
  if (std::find(notes.begin(), notes.end(), said) == notes.end()) notes.emplace_back(said);
  return true;
}

void leave_out_sets(PipelineFile& file, const std::vector<StatedShow>& shows, std::vector<Data>& results, std::vector<std::string>& notes,
                    Context& context) {
  std::vector<std::string> steps;
  for (size_t i = 0; i < shows.size(); ++i) steps.push_back(shown_step(file, i));  // before others follow the last one
  for (size_t i = 0; i < shows.size(); ++i) {
    const bool less = leave_out_sets(file, steps[i], results[i], named_fields(shows[i].params.schema), notes, context);
    if (less)
      for (size_t k = 0; k < shows.size(); ++k)
        if (k == i || file.show[k].of.empty()) file.show[k].of = steps[k];
  }
}

}  // namespace sg
