// SPDX-License-Identifier: Apache-2.0
#include "pipeline/operation/operation.h"

#include <algorithm>

#include "pipeline/operation/test_operations.h"
#include "support/test.h"

using namespace sg;
using test::first;

namespace {
Data run(const char* name, const std::vector<Data>& in, const std::vector<std::string>& words = {}) {
  Context context;
  return run_operation(find_operation(name, test::counted_operations()), in, words, context);
}
}  // namespace

TEST_CASE("operations: help of one operation is made from its declaration") {
  CHECK(ops_help("scale", test::counted_operations()) ==
        "scale (scalar filter)\n"
        "  Multiplies a field.\n"
        "  Takes: a mesh; makes: the same kind of mesh.\n"
        "\n"
        "Parameters (key=value):\n"
        "  field  Field to scale; default: the active scalar. [any field of points or cells]\n"
        "  by     Factor. [number, from -1000 to 1000, in units of 'field', default 2]\n"
        "  mode   How. [plain|fancy, default plain]\n");
  CHECK(ops_help("whole", test::counted_operations()) ==
        "whole (parts filter)\n  Passes everything on.\n  Takes: a mesh; makes: the same kind of mesh.\n\nNo parameters.\n");
  CHECK(ops_help("add", test::counted_operations()).find("Takes 2 inputs.") != std::string::npos);
  CHECK(ops_help("ramp", test::counted_operations()).starts_with("ramp (source)\n"));
}

TEST_CASE("operations: the overview lists families in the order of the table") {
  const std::string help = ops_help("", test::counted_operations());
  CHECK(help.starts_with(
      "source\n  ramp     A line of points with a rising field.\n  moment   A line at a moment.\n\nscalar\n  scale    Multiplies"));
  CHECK(help.find("\nparts\n") < help.find("\nstats\n"));
}

TEST_CASE("operations: every operation of this build has a sentence, a family, a name of its own and describable parameters") {
  std::vector<std::string_view> names;
  for (const Operation& o : operations()) {
    CAPTURE(o.name);
    CHECK(o.sentence.ends_with("."));
    CHECK_FALSE(o.family.empty());
    CHECK(std::find(names.begin(), names.end(), o.name) == names.end());
    names.push_back(o.name);
    const ParamSet params = o.make_params();
    for (const ParamDecl& d : params.schema.decls()) CHECK_MESSAGE(d.doc.ends_with("."), d.name);
    CHECK_FALSE(ops_help(o.name).empty());
  }
}

TEST_CASE("operations: an unknown name gets the nearest one") {
  CHECK(test::error_of([] {
          find_operation("scael", test::counted_operations());
        }).find("unknown operation 'scael'; did you mean 'scale'? available: ramp, moment") == 0);
  CHECK(&find_operation("add", test::counted_operations()) == &test::counted_operations()[4]);
}

TEST_CASE("operations: words set parameters and the function runs with them") {
  CHECK(first(run("ramp", {}, {"start=5"})) == 5);
  CHECK(test::value_at(run("scale", {test::line_of(4)}, {"by=10"}), 3) == 30);
  CHECK(test::value_at(run("add", {test::line_of(4), test::line_of(4)}), 3) == 6);
  const Data table = run("measure", {test::line_of(7)});
  CHECK(std::get<TablePtr>(table)->columns[0].array.get(0) == 7);
}

TEST_CASE("operations: a wrong number of inputs and a table for a mesh are refused") {
  CHECK(test::error_of([] { run("scale", {}); }) == "scale: takes 1 input, not 0");
  CHECK(test::error_of([] { run("add", {test::line_of(2)}); }) == "add: takes 2 inputs, not 1");
  CHECK(test::error_of([] { run("ramp", {test::line_of(2)}); }).find("takes 0 inputs") != std::string::npos);
  CHECK(test::error_of([] { run("join", {}); }).find("join: takes") == 0);
  CHECK(test::error_of([] { run("scale", {TablePtr(std::make_shared<Table>())}); }).find("scale: needs a mesh but got a table") == 0);
  CHECK(test::error_of([] { run("scale", {DatasetPtr()}); }) == "scale: got no data");
}

TEST_CASE("operations: filters are applied to each part of a collection, and errors name the part") {
  auto inner = std::make_shared<Collection>();
  inner->parts = {{"left", test::line_of(8)}, {"right", test::line_of(3)}};
  auto outer = std::make_shared<Collection>();
  outer->parts = {{"wing", CollectionPtr(inner)}, {"counts", TablePtr(std::make_shared<Table>())}, {"body", test::line_of(5)}};
  const Data in = CollectionPtr(outer);

  std::vector<std::string> names;
  for_each_dataset(run("scale", {in}, {"by=3"}), [&](const std::string& name, const DatasetPtr& d) {
    names.push_back(name);
    CHECK(test::value_at(d, 2) == 6);
  });
  CHECK(names == std::vector<std::string>{"wing/left", "wing/right", "body"});

  const Data dropped = run("drop", {in});  // null results leave, tables stay
  CHECK(std::get<CollectionPtr>(dropped)->parts.size() == 3);
  CHECK(std::get<CollectionPtr>(std::get<CollectionPtr>(dropped)->parts[0].data)->parts.size() == 1);

  CHECK(test::error_of([&] { run("fail", {in}); }) == "fail: cannot do that (while in part 'wing/left')");
  const Data whole = run("whole", {in});
  CHECK(std::get<CollectionPtr>(whole) == CollectionPtr(outer));
  CHECK(std::get<CollectionPtr>(run("join", {in, test::line_of(2)}))->parts.size() == 2);
  CHECK(test::error_of([&] { run("add", {test::line_of(5), in}); }).find("add: needs a single mesh but got 3 parts") == 0);
}

TEST_CASE("requests: the fields wanted go up with those that parameters name; a field left open asks for everything") {
  const Operation& scale = find_operation("scale", test::counted_operations());
  const Operation& pick = find_operation("pick", test::counted_operations());
  const Operation& add = find_operation("add", test::counted_operations());
  const Request p = Request::only({"p", "b", "p"});
  CHECK(p.fields == std::vector<std::string>{"b", "p"});
  CHECK(upstream_request(add, add.make_params(), p, 1).fields == std::vector<std::string>{"T", "b", "p"});
  CHECK(upstream_request(add, add.make_params(), {}).all_fields);
  CHECK(upstream_request(scale, make_params(scale, {"field=T"}), p).fields == std::vector<std::string>{"T", "b", "p"});
  CHECK(upstream_request(scale, make_params(scale, {}), p).all_fields);
  CHECK(upstream_request(pick, make_params(pick, {"field=T"}), p).fields == std::vector<std::string>{"T"});
  Request timed = p;
  timed.time = 2.5;
  timed.region = Box3{{0, 0, 0}, {1, 1, 1}};
  timed.piece = 1, timed.pieces = 4;
  for (const Operation* o : {&scale, &add}) {
    const Request up = upstream_request(*o, make_params(*o, {}), timed);
    CHECK(*up.time == 2.5);
    CHECK_FALSE(up.region);
    CHECK(up.pieces == 1);
  }
  CHECK(request_text(timed) == "fields=b,p time=2.5 region=0,0,0,1,1,1 piece=1/4");
  CHECK(request_text({}) == "everything");
  CHECK(request_text(Request::only({})) == "fields=none");
  CHECK_FALSE(can_merge(p, timed));
  CHECK(merged(p, Request::only({"a"})).fields == std::vector<std::string>{"a", "b", "p"});
  CHECK(merged(p, Request()) == Request());
}
