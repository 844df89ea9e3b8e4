// SPDX-License-Identifier: Apache-2.0
// Reading, computing, running operations and writing.
#include <fmt/format.h>

#include <filesystem>

#include "api/held.h"
#include "filter/mesh/select/piece.h"
#include "io/file_series.h"
#include "io/io.h"
#include "io/options.h"
#include "pipeline/graph/graph.h"
#include "pipeline/operation/operation.h"

namespace sightglass {

namespace {

std::string absolute(const std::string& path) {
  return sg::map_series(path, [](const std::string& part) {
    std::error_code error;
    const auto whole = std::filesystem::absolute(part, error);
    return error ? part : whole.lexically_normal().string();
  });
}

// Has it other values at other times, for operations that follow time?
bool varies(const Made& made, sg::Context& context) {
  if (sg::step_kind(made.operation) == sg::StepKind::read) return open_times(made, context).size() > 1;
  if (sg::step_kind(made.operation) == sg::StepKind::memory) return false;
  if (made.inputs.empty()) {
    const sg::ParamSet params = sg::make_params(sg::find_operation(made.operation), made.words);
    const sg::ParamDecl* time = params.schema.find("time");
    return time && !time->stated;
  }
  return std::any_of(made.inputs.begin(), made.inputs.end(), [&](const auto& input) { return varies(*input, context); });
}

sg::Data run_now(const sg::Operation& operation, const sg::ParamSet& params, const std::vector<const Data::Held*>& inputs,
                 sg::Context& context) {
  sg::GraphOptions options;
  options.cache_limit = 0;
  sg::Graph graph(options);
  std::vector<sg::NodeId> nodes;
  for (const Data::Held* held : inputs) nodes.push_back(graph.add_data(held->data));
  const sg::NodeId last = graph.add_operation(operation, params, nodes, std::string(operation.name));
  return graph.evaluate(last, {}, context);
}

Data run_on(std::string_view name, const Params& stated, const std::vector<const Data*>& inputs, const Context& context) {
  const sg::Operation& operation = sg::find_operation(name);
  const sg::ParamSet params = operation.make_params();
  set_values(const_cast<sg::Schema&>(params.schema), stated, operation.name);
  auto made = std::make_shared<Made>();
  made->operation = operation.name;
  made->words = stated_words(params.schema);
  std::vector<const Data::Held*> held;
  for (const Data* d : inputs) held.push_back(&held_by(*d)), made->inputs.push_back(held.back()->made);
  Noting noting(context);
  const bool over_time = operation.run_series && !held.empty() && varies(*held[0]->made, noting.core);
  sg::Data data = over_time ? run_steps(made, "run()", noting.core) : run_now(operation, params, held, noting.core);
  return make_data(std::move(data), std::move(made), std::move(noting.notes));
}

}  // namespace

Data read(const std::string& path, const Params& params, const Context& context) {
  return guarded([&] {
    sg::ReadParams p;
    sg::Schema schema = sg::schema_of(p);
    set_values(schema, params, "read");
    sg::check(p.options);
    Noting noting(context);
    sg::Data data = sg::read_data(path, p.options, noting.core);
    auto made = std::make_shared<Made>();
    made->operation = "read";
    made->words = sg::read_words(absolute(path), p.options);
    return make_data(std::move(data), std::move(made), std::move(noting.notes));
  });
}

std::vector<double> times(const std::string& path, const Context& context) {
  return guarded([&] { return sg::file_times(path, {}, context.state().core); });
}

Data source(std::string_view name, const Params& params, const Context& context) {
  return guarded([&] { return run_on(name, params, {}, context); });
}

Data Data::run(std::string_view operation, const Params& params, const Context& context) const {
  return guarded([&] { return run_on(operation, params, {this}, context); });
}

Data Data::run(std::string_view operation, const Params& params, const std::vector<Data>& others, const Context& context) const {
  return guarded([&] {
    std::vector<const Data*> inputs{this};
    for (const Data& d : others) inputs.push_back(&d);
    return run_on(operation, params, inputs, context);
  });
}

void Data::write(const std::string& path, const Params& params, const Context& context) const {
  guarded([&] {
    const sg::Format& format = sg::format_to_write(path);
    sg::WriteOptions options;
    sg::Schema schema;
    if (format.describe_write) format.describe_write(schema, options);
    set_values(schema, params, std::string(format.name) + " writer");
    sg::Context& core = context.state().core;
    sg::write_data(path, sg::in_pieces(held_by(*this).data, options.pieces, core), options, core);
  });
}

}  // namespace sightglass
