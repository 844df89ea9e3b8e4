// SPDX-License-Identifier: Apache-2.0
// What each row of the table says of the kinds that go in and come out, against what the operation does with one of each kind.
#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "filter/every_mesh.h"
#include "pipeline/hostile/hostile_inputs.h"
#include "pipeline/operation/check_inputs.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

namespace {

using Words = std::vector<std::string>;

struct Sample {
  std::string name;
  DataKind kind;
  Data data;
};

DatasetPtr run_one(const char* name, const DatasetPtr& in, const Words& words) {
  Context context;
  return std::get<DatasetPtr>(run_operation(find_operation(name), {in}, words, context));
}

DatasetPtr without_cell_fields(const DatasetPtr& in) {
  DatasetParts parts = in->parts();
  for (const Field& f : in->fields())
    if (f.association == Association::cell) parts.fields.remove(f.name, Association::cell);
  return make_dataset(std::move(parts));
}

// One or more good ones of each kind: solids, flat ones, lines, each with scalars, vectors, tensors and labels on points and on cells.
std::vector<Sample> samples() {
  std::vector<Sample> r;
  const auto add = [&](std::string name, const DatasetPtr& mesh) {
    r.push_back({std::move(name), kind_of(*mesh), hostile::with(mesh, hostile::Values::smooth)});
  };
  for (const MeshKind& kind : every_mesh())
    for (const char* name : {"uniform", "rectilinear", "curvilinear", "amr", "tetra", "hexahedron", "flat uniform", "flat rectilinear",
                             "flat curvilinear", "flat amr", "triangle cells", "triangles"})
      if (kind.name == name) add(name, kind.make(5, 1));
  const DatasetPtr solid = every_mesh()[0].make(5, 1), skin = run_one("faces", solid, {});
  const DatasetPtr lines = run_one("polylines", run_one("feature_edges", skin, {}), {});
  add("skin", skin), add("lines", lines), add("lines as cells", run_one("unstructured", lines, {}));
  for (const char* name : {"uniform", "rectilinear", "curvilinear"})
    for (const MeshKind& kind : every_mesh())
      if (kind.name == name) add(std::string("row of ") + name, run_one("crop", kind.make(5, 1), {"region=0,5,2,2,2,2"}));
  add("points", run_one("glyph_points", solid, {"mode=all"}));
  r.back().data = without_cell_fields(std::get<DatasetPtr>(r.back().data));
  auto table = std::make_shared<Table>();
  for (const char* name : {"x", "y", "value"})
    table->columns.push_back({name, Association::whole, Array::from_vector(std::vector<double>{0, 1, 3}), "", Role::none});
  r.push_back({"table", DataKind::table, TablePtr(table)});
  return r;
}

// Words without which an operation asks for something else, and those that give other kinds.
std::vector<Words> words_for(const Operation& o) {
  static const std::map<std::string_view, std::vector<Words>> some{
      {"select", {{"keep=s"}}},
      {"calc", {{"expr=s*2", "name=q"}, {"expr=1", "on=cell"}}},
      {"crop", {{"stride=2"}}},
      {"piece", {{"pieces=2", "piece=0"}}},
      {"dice", {{"field=labels", "truth=labels"}}},
      {"probe_at", {{"points=0,0,0"}, {"from=0,0,0", "to=1,0,0", "count=5"}}},
      {"extract", {{"ids=1,2"}}},
      {"parallel_vectors", {{"a=v", "b=v"}, {}}},
      {"traction", {{}, {"normal=0,0,1"}}},
      {"label_surface", {{"field=labels"}}},
      {"label_components", {{"field=labels"}}},
      {"morphology", {{"field=labels"}}},
      {"resize", {{"dims=5"}}},
      {"resample", {{"size=8"}}},
      {"gaussian_smooth", {{"sigma=0.5"}}},
      {"region_grow", {{"seeds=0,0,0"}}},
      {"clip", {{}, {"keep=both"}}},
      {"transform", {{"angle=20", "axis=1,2,3"}, {"translate=1,0,0"}, {"scale=2,1,1"}}},
      {"silhouette", {{"direction=1,2,3", "smooth=false"}}},
      {"time_surface", {{"center=0,0,0", "normal=0,0,1", "size=0.2,0.2", "spacing=0.2"}}},
      {"timelines", {{"from=-0.5,0,0", "to=0.5,0,0"}}},
      {"trails", {{"field=s"}}},
      {"table_to_points", {{}, {"line=true"}}},
      {"lic", {{"resolution=16"}}},
      {"spot_noise", {{"resolution=16"}}},
      {"advect", {{"resolution=16"}}},
      {"ftle", {{"size=6"}}},
      {"surface_lic", {{"density=10"}}},
      {"tensor_lic", {{"density=10"}}},
      {"stream_surface", {{"spacing=0.2"}}},
      {"path_surface", {{"spacing=0.2"}}},
      {"streak_surface", {{"spacing=0.5"}}},
  };
  const auto found = some.find(o.name);
  std::vector<Words> r = found == some.end() ? std::vector<Words>{{}} : found->second;
  const ParamSet params = o.make_params();
  const ParamDecl* size = params.schema.find("size");
  if (o.kind == OperationKind::source && size && size->ref.type() == ParamType::integer)
    for (Words& w : r) w.push_back("size=6");
  return r;
}

// What `data` is made of: the kinds of its datasets and tables.
void add_kinds(const Data& data, std::set<DataKind>& kinds, bool& parts) {
  if (const auto* d = std::get_if<DatasetPtr>(&data)) kinds.insert(kind_of(**d));
  else if (std::holds_alternative<TablePtr>(data)) kinds.insert(DataKind::table);
  else {
    parts = true;
    for (const Collection::Part& p : std::get<CollectionPtr>(data)->parts) add_kinds(p.data, kinds, parts);
  }
}

std::string told(const std::set<DataKind>& kinds) {
  std::string r;
  for (const DataKind k : kinds) r += (r.empty() ? "" : ", ") + std::string(word_of(k));
  return r;
}

// With the check of kinds, as programs call it, and by itself.
Data run_checked(const Operation& o, const Data& in, const Words& words) {
  Context context;
  const std::vector<Data> inputs(size_t(o.min_inputs), in);
  if (!o.run_series || o.min_inputs != 1) return run_operation(o, inputs, words, context);
  const ParamSet params = make_params(o, words);
  check_inputs(o, params.schema, inputs);
  return o.run_series({{0, 1}, [&](size_t) { return in; }}, {}, params, context);
}
Data run_by_itself(const Operation& o, const Data& in, const Words& words) {
  Context context;
  const ParamSet params = make_params(o, words);
  if (o.run_series) return o.run_series({{0, 1}, [&](size_t) { return in; }}, {}, params, context);
  return o.run(std::vector<Data>(size_t(o.min_inputs), in), params, context);
}

// What became of the samples of one kind.
struct Outcome {
  bool ran = false;
  std::string refused;  // the last error
};

}  // namespace

TEST_CASE("kinds: every operation takes the kinds that its row states, refuses the others by name, and makes what it states") {
  const std::vector<Sample> all = samples();
  for (const Operation& o : operations()) {
    if (o.kind == OperationKind::source) continue;
    CAPTURE(o.name);
    std::map<DataKind, Outcome> outcomes;
    std::set<DataKind> made;
    bool made_parts = false;
    for (const Sample& in : all)
      for (const Words& words : words_for(o)) {
        Outcome& outcome = outcomes[in.kind];
        std::set<DataKind> kinds;
        bool parts = false;
        make_params(o, words);
        try {
          add_kinds(run_checked(o, in.data, words), kinds, parts);
          outcome.ran = true;
        } catch (const Error& e) {
          outcome.refused = e.what();
          CHECK_MESSAGE(e.kind() == ErrorKind::usage, in.name, ": ", e.what());
          continue;
        }
        const KindSet stated = o.keeps.has(in.kind) ? KindSet(in.kind) : o.makes;
        for (const DataKind k : kinds) CHECK_MESSAGE(stated.has(k), in.name, " gives ", told(kinds));
        CHECK_MESSAGE((!parts || o.makes_parts), in.name, " gives parts");
        if (!o.keeps.has(in.kind)) made.insert(kinds.begin(), kinds.end());
        made_parts = made_parts || parts;
      }
    // Some need what is in no sample, or more words: they refuse all of them.
    const bool runs = std::any_of(outcomes.begin(), outcomes.end(), [](const auto& k) { return k.second.ran; });
    for (const auto& [kind, outcome] : outcomes) {
      CAPTURE(word_of(kind));
      if (o.takes.has(kind)) CHECK_MESSAGE((outcome.ran || !runs), outcome.refused);
      else CHECK_MESSAGE(outcome.refused.find("but got " + std::string(kind_text(kind))) != std::string::npos, outcome.refused);
    }
    if (!runs) continue;
    for (int k = 0; k < data_kinds; ++k)
      if (o.makes.has(DataKind(k))) CHECK_MESSAGE(made.contains(DataKind(k)), "never makes ", word_of(DataKind(k)));
    CHECK(made_parts == o.makes_parts);
  }
}

TEST_CASE("kinds: what a row refuses, the operation does not take either") {
  const std::vector<Sample> all = samples();
  for (const Operation& o : operations()) {
    if (o.kind == OperationKind::source) continue;
    for (const Sample& in : all) {
      if (o.takes.has(in.kind) || in.kind == DataKind::table) continue;  // some pass tables on, as they are
      for (const Words& words : words_for(o)) CHECK_THROWS_AS_MESSAGE(run_by_itself(o, in.data, words), Error, o.name, " takes ", in.name);
    }
  }
}

TEST_CASE("kinds: every source makes what its row states") {
  for (const Operation& o : operations()) {
    if (o.kind != OperationKind::source || o.name == "gradient_images") continue;  // of a file
    CAPTURE(o.name);
    Context context;
    std::set<DataKind> kinds;
    bool parts = false;
    add_kinds(run_operation(o, {}, words_for(o)[0], context), kinds, parts);
    CHECK(o.takes == kinds::meshes);
    CHECK(o.keeps.empty());
    CHECK_FALSE(parts);
    for (const DataKind k : kinds) CHECK_MESSAGE(o.makes.has(k), told(kinds));
  }
}

TEST_CASE("kinds: second inputs are refused by name as well, and those of the kinds stated are taken") {
  const std::vector<Sample> all = samples();
  for (const Operation& o : operations()) {
    if (o.max_inputs == 1 || o.kind == OperationKind::source) continue;
    const Data first = std::find_if(all.begin(), all.end(), [&](const Sample& s) { return o.takes.has(s.kind); })->data;
    for (const Sample& in : all) {
      CAPTURE(o.name);
      CAPTURE(in.name);
      const std::vector<Data> inputs{first, in.data};
      std::string said;
      try {
        check_kinds(o, inputs);
      } catch (const Error& e) {
        said = e.what();
      }
      CHECK(said.empty() == o.takes_further.has(in.kind));
      if (!said.empty()) CHECK(said.find(std::string(o.name) + " input 2: needs ") == 0);
      if (!said.empty()) CHECK(said.find("but got " + std::string(kind_text(in.kind))) != std::string::npos);
      if (said.empty() || in.kind == DataKind::table || o.run_series || o.name == "append") continue;
      Context context;  // the operation itself does not take them either
      Words words = words_for(o)[0];
      if (o.make_params().schema.find("image")) words.push_back("image=s");
      CHECK_THROWS_AS(o.run(inputs, make_params(o, words), context), Error);
    }
  }
}

TEST_CASE("kinds: there is a sample of each, and each is called as its mesh is") {
  std::set<DataKind> seen;
  for (const Sample& s : samples()) {
    seen.insert(s.kind);
    if (const auto* d = std::get_if<DatasetPtr>(&s.data)) CHECK(word_of(s.kind) == (*d)->kind());
  }
  CHECK(seen.size() == size_t(data_kinds));
}

TEST_CASE("kinds: an error says what is needed, what there is, and what would do") {
  const std::vector<Sample> all = samples();
  const auto sample = [&](std::string_view name) {
    for (const Sample& s : all)
      if (s.name == name) return s.data;
    FAIL("no sample ", name);
    return Data();
  };
  const auto said = [&](const char* operation, const Data& in) {
    return error_of([&] {
      Context context;
      run_operation(find_operation(operation), {in}, {}, context);
    });
  };
  CHECK(said("contour", sample("table")) ==
        "contour: needs a mesh with cells but got a table; make points of its rows first: -f 'table_to_points x=... y=...'");
  CHECK(said("contour", sample("points")) == "contour: needs a mesh with cells but got a point cloud; resample makes a uniform grid of it");
  CHECK(said("morphology", sample("tetra")) ==
        "morphology: needs a uniform or rectilinear grid but got an unstructured mesh; resample makes a uniform grid of it");
  CHECK(said("crop", sample("skin")) ==
        "crop: needs a uniform, rectilinear or curvilinear grid but got a surface; resample makes a uniform grid of it");
  CHECK(said("clean", sample("amr")) ==
        "clean: needs a mesh other than an AMR grid but got an AMR grid; unstructured makes cells of it, resample a uniform grid");
  CHECK(said("table_to_points", sample("points")) == "table_to_points: needs a table but got a point cloud; read a .csv or .json file");
  CHECK(said("slice", sample("points")).ends_with("; keep points by value with threshold, or show them as they are"));
}

TEST_CASE("kinds: a collection is taken when one of its parts is, and its first part is named when none is") {
  const std::vector<Sample> all = samples();
  const auto parts = [&](std::initializer_list<std::string_view> names) {
    auto c = std::make_shared<Collection>();
    for (const Sample& s : all)
      if (std::find(names.begin(), names.end(), s.name) != names.end()) c->parts.push_back({s.name, s.data});
    return Data(CollectionPtr(c));
  };
  const Operation& contour = find_operation("contour");
  const Data mixed = parts({"uniform", "points", "table"}), none = parts({"points", "table"}), empty = parts({});
  CHECK_NOTHROW(check_kinds(contour, std::span(&mixed, 1)));
  CHECK_NOTHROW(check_kinds(contour, std::span(&empty, 1)));
  CHECK(error_of([&] { check_kinds(contour, std::span(&none, 1)); }).find("but got a point cloud in part 'points'") != std::string::npos);
}

TEST_CASE("kinds: help tells what goes in and comes out in one line") {
  const auto help = [](const char* name) { return kinds_help(find_operation(name)); };
  CHECK(help("gyroid") == "Makes: a uniform grid.");
  CHECK(help("calc") == "Takes: a mesh; makes: the same kind of mesh.");
  CHECK(help("contour") == "Takes: a mesh with cells; makes: a surface.");
  CHECK(help("threshold") == "Takes: a mesh; makes: of a surface or a point cloud the same kind, else an unstructured mesh.");
  CHECK(help("lic") == "Takes: a mesh with cells, or with a uniform grid beside it; makes: a uniform grid.");
  CHECK(help("probe") == "Takes: a mesh and another; makes: the same kind of mesh.");
  CHECK(help("topology") == "Takes: a mesh with cells; makes: a surface or a point cloud, or several as parts.");
}
