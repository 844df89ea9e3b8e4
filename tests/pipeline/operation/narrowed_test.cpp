// SPDX-License-Identifier: Apache-2.0
// Every operation, with nothing of its inputs but the fields that it asks for: what is wanted of its result is the same as with all.
// SG_HOSTILE_ONLY=NAME: that operation alone.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <set>

#include "base/schema/field_kinds.h"
#include "pipeline/hostile/hostile_inputs.h"
#include "pipeline/hostile/hostile_random.h"
#include "pipeline/hostile/hostile_watch.h"
#include "pipeline/operation/operation.h"
#include "support/same_data.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

namespace {

bool asks_for(const Request& r, const std::string& name) {
  return r.all_fields || std::find(r.fields.begin(), r.fields.end(), name) != r.fields.end();
}

// Tables that go through an operation untouched lose nothing that is not wanted: there is no field to tell by.
Data narrowed(const Data& data, const Request& r, bool takes_tables) {
  if (auto* t = std::get_if<TablePtr>(&data)) {
    if (!takes_tables) return data;
    auto few = std::make_shared<Table>();
    for (const Field& f : (*t)->columns)
      if (asks_for(r, f.name)) few->columns.push_back(f);
    return TablePtr(few);
  }
  return map_datasets(data, [&](const DatasetPtr& d) {
    DatasetParts parts = d->parts();
    for (const Field& f : d->fields())
      if (!asks_for(r, f.name)) parts.fields.remove(f.name, f.association);
    return make_dataset(std::move(parts));
  });
}

std::set<std::string> names_in(const Data& data) {
  std::set<std::string> names;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) {
    for (const Field& f : d->fields()) names.insert(f.name);
  });
  return names;
}

// What operations look for by name or role, beside the fields of plain_inputs().
DatasetPtr with_more(const DatasetPtr& d, Random& random, double left_out = 0.3) {
  DatasetParts parts = d->parts();
  for (const Association a : {Association::point, Association::cell}) {
    const size_t n = a == Association::point ? d->point_count() : d->cell_count();
    const auto add = [&](const char* name, int components, Role role) {
      if (random.chance(left_out)) return;
      std::vector<float> v(n * size_t(components));
      for (size_t i = 0; i < v.size(); ++i) v[i] = float(double(i) + random.unit());
      parts.fields.add({name, a, Array::from_vector(std::move(v), components), "", role});
    };
    add("time", 1, Role::none), add("rotation", 1, Role::none), add("contour value", 1, Role::scalars), add("x", 1, Role::none);
    add("stretch", 2, Role::none), add("stretch direction", 3, Role::none), add("shrink direction", 3, Role::none);
    add("n", 3, Role::normals), add("w", 3, Role::vectors), add("r", 1, Role::scalars), add("images", 7, Role::none);
  }
  const std::vector<double> b{0, 1000, 1000, 1000, 1000, 1000, 1000},
      g{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, .7, .7, 0, .7, 0, .7, 0, .7, .7};
  parts.fields.add({"bval", Association::whole, Array::from_vector(b), "", Role::none});
  parts.fields.add({"bvec", Association::whole, Array::from_vector(g, 3), "", Role::none});
  return make_dataset(std::move(parts));
}

Data random_input(const Operation& o, Random& random) {
  if (o.name == "table_to_points") {
    auto t = std::make_shared<Table>();
    for (const char* name : {"a", "x", "b", "y"})
      t->columns.push_back({name, Association::whole, Array::from_vector(std::vector<double>{1, 2, 3.5}), "", Role::none});
    return TablePtr(t);
  }
  if (o.name == "shear_lines") return with_more(std::get<DatasetPtr>(hostile::plain_inputs()[1].data), random, 0);
  if (random.chance(0.3)) return hostile::random_data(random);
  const auto& plain = hostile::plain_inputs();
  return with_more(std::get<DatasetPtr>(plain[size_t(random.whole(0, int(plain.size()) - 1))].data), random);
}

// Curved cells are divided until all fields that are there are straight in them: other fields, other pieces.
bool has_curved_cells(const Data& data) {
  bool curved = false;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) {
    const auto* m = d->as<UnstructuredMesh>();
    for (size_t c = 0; m && c < d->cell_count(); ++c) {
      const auto type = uint8_t(m->type(c));
      curved = curved || (type > 20 && type < 41) || type > 42;
    }
  });
  return curved;
}

// A field that the parameter takes, most of the time.
std::string field_word(Random& random, const ParamDecl& d, const Data& data) {
  std::vector<std::string> fitting;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& set) {
    for (const Field& f : set->fields())
      if (takes_components(d.field_, f.components()) && (f.association == Association::point ? d.field_.points : d.field_.cells))
        fitting.push_back(f.name);
  });
  if (fitting.empty() || random.chance(0.1)) return hostile::random_word(random, d, data);
  return d.name + "=" + fitting[size_t(random.whole(0, int(fitting.size()) - 1))];
}

std::vector<std::string> words_for(Random& random, const Operation& o, const std::vector<Data>& inputs) {
  const Schema schema = o.make_params().schema;
  std::vector<std::string> words = hostile::small_sizes(schema, o.name, inputs);
  if (o.name == "calc")
    words.push_back(random.one_of<const char*>({"expr=s*2", "expr=mag(v)+labels", "expr=x*2", "expr=v.x + \"contour value\""}));
  if (o.name == "extract") words.push_back("ids=0,1,2");
  if (o.name == "select") words.push_back(random.one_of<const char*>({"keep=s,v", "drop=s", "keep=s,t drop=t"}));
  if (o.name == "dice") words.insert(words.end(), {"field=labels", "truth=s"});
  if (o.name == "region_grow") words.insert(words.end(), {"seeds=0.1,0.1,0.1", "confidence=2"});
  if (o.name == "resize") words.push_back("dims=5");
  if (o.name == "threshold") words.push_back("min=0.3");
  const double chance = random.one_of({0.0, 0.05, 0.2});
  for (const ParamDecl& d : schema.decls()) {
    if (d.unit_ == "file" || d.unit_ == "new file") continue;
    const bool by_hand = d.name == "expr" || d.name == "size" || d.name == "dims" || d.name == "resolution" || d.name == "density" ||
                         d.name == "spacing" || d.name == "step" || (d.name == "count" && random.chance(0.7));
    if (by_hand) continue;
    if (d.ref.type() == ParamType::field && random.chance(0.6)) words.push_back(field_word(random, d, inputs[0]));
    else if (d.name == "fields" && random.chance(0.4)) words.push_back(random.one_of<const char*>({"fields=s", "fields=v,labels"}));
    else if (random.chance(chance)) words.push_back(hostile::random_word(random, d, inputs[0]));
  }
  return words;
}

// As the graph runs it: series get the first input at two times.
Data run(const Operation& o, const std::vector<Data>& inputs, const ParamSet& params, Context& context) {
  if (!o.run_series) return o.run(inputs, params, context);
  const Series series{{0, 0.5}, [&](size_t) { return inputs[0]; }};
  return o.run_series(series, std::vector<Data>(inputs.begin() + 1, inputs.end()), params, context);
}

struct Tried {
  int same = 0, everything = 0;
};

// One case; false when the operation refuses it.
void try_one(const Operation& o, uint64_t seed, Tried& tried) {
  Random random(seed);
  std::vector<Data> inputs;
  const bool more = o.max_inputs < 0 || o.max_inputs > std::max(1, o.min_inputs);
  for (int n = std::max(1, o.min_inputs) + (more && random.chance(0.4)); n > 0; --n) inputs.push_back(random_input(o, random));
  if (o.name == "join_fields" && random.chance(0.7)) inputs[1] = inputs[0];
  for (const Data& d : inputs)
    if (has_curved_cells(d) && o.name != "tessellate") return;
  const std::vector<std::string> words = words_for(random, o, inputs);
  Data whole;
  std::optional<ParamSet> params;
  try {
    Context context;
    params = make_params(o, words);
    const std::string what = fmt::format("seed {}: {} {}", seed, o.name, fmt::join(words, " "));
    const hostile::Watch watch(context, hostile::seconds(20), what);
    whole = run(o, inputs, *params, context);
  } catch (const Error&) {
    return;
  }
  // Some of what the result has, and of what it might have had.
  std::set<std::string> names = names_in(whole);
  for (const Data& d : inputs) names.merge(names_in(d));
  std::vector<std::string> wanted;
  const double share = random.one_of({0.0, 0.15, 0.5});
  for (const std::string& name : names)
    if (random.chance(share)) wanted.push_back(name);
  std::vector<Data> few;
  for (size_t i = 0; i < inputs.size(); ++i) {
    const Request up = upstream_request(o, *params, Request::only(wanted), i);
    tried.everything += i == 0 && up.all_fields;
    few.push_back(narrowed(inputs[i], up, o.takes.has(DataKind::table)));
  }
  std::string differs;
  try {
    Context context;
    const Data result = run(o, few, *params, context);
    differs = difference(whole, result, [&](const Field& f) { return std::find(wanted.begin(), wanted.end(), f.name) != wanted.end(); });
  } catch (const Error& e) {
    if (std::string_view(e.what()).find("allowed are in use") != std::string_view::npos) return;  // the whole result holds the memory
    differs = e.what();
  }
  CHECK_MESSAGE(differs.empty(),
                fmt::format("seed {}: {} {} for {}: {}", seed, o.name, fmt::join(words, " "), fmt::join(wanted, ","), differs));
  tried.same += differs.empty();
}

}  // namespace

TEST_CASE("property: what is wanted of the result of any operation is the same with the fields that it asks for alone") {
  std::string never, always;
  for (const Operation& o : operations()) {
    if (o.kind == OperationKind::source || (hostile::only() && o.name != hostile::only())) continue;
    Tried tried;
    const std::vector<uint64_t> seeds = property_seeds(24);
    for (const uint64_t seed : seeds) try_one(o, seed, tried);
    for (uint64_t more = 1; tried.same == 0 && more <= 200; ++more) try_one(o, seeds.back() + more, tried);
    if (tried.same == 0) never += fmt::format(" {}", o.name);
    if (tried.same > 0 && tried.everything == tried.same) always += fmt::format(" {}", o.name);
  }
  CHECK_MESSAGE(never.empty(), "no case with which it answers: " << never);
  MESSAGE("ask for every field in every case:" << always);
}

TEST_CASE("operations: parameters that hooks name are there") {
  for (const Operation& o : operations()) {
    const ParamSet params = o.make_params();
    CAPTURE(o.name);
    for (const auto& [names, field] : {std::pair(&o.fields.may_lack, true), {&o.fields.lists, false}, {&o.fields.lists_or_all, false}})
      for (const std::string_view name : *names) {
        if (name.empty()) continue;
        const ParamDecl* d = params.schema.find(name);
        CAPTURE(name);
        REQUIRE(d);
        CHECK((field ? d->ref.type() == ParamType::field : d->ref.type() == ParamType::words || d->ref.type() == ParamType::word));
      }
  }
}

TEST_CASE("operations: with every field stated, few ask for more") {
  std::string always;
  int filters = 0, left_open = 0;
  for (const Operation& o : operations()) {
    if (o.kind == OperationKind::source) continue;
    ++filters;
    const Request none = Request::only({});
    left_open += upstream_request(o, o.make_params(), none).all_fields;
    std::vector<std::string> words;
    const ParamSet params = o.make_params();
    for (const ParamDecl& d : params.schema.decls()) {
      const bool named = d.ref.type() == ParamType::field || d.name == "carry" ||
                         std::find(o.fields.lists.begin(), o.fields.lists.end(), d.name) != o.fields.lists.end() ||
                         std::find(o.fields.lists_or_all.begin(), o.fields.lists_or_all.end(), d.name) != o.fields.lists_or_all.end();
      if (named) words.push_back(d.name + "=T");
    }
    if (upstream_request(o, make_params(o, words), none).all_fields) always += fmt::format(" {}", o.name);
  }
  CHECK(always == " warp tessellate silhouette cap surfels traction join_fields");
  MESSAGE(left_open << " of " << filters << " filters ask for every field while their fields are left open");
}
