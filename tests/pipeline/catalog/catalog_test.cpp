// SPDX-License-Identifier: Apache-2.0
// tools/check_schema looks at the whole document from outside.
#include "pipeline/catalog/catalog.h"

#include <nlohmann/json.hpp>
#include <set>

#include "io/options.h"
#include "pipeline/operation/test_operations.h"
#include "scene/show/show.h"
#include "support/test.h"

using namespace sg;
using nlohmann::json;

namespace {

const CatalogEntry& entry(const std::vector<CatalogEntry>& all, EntryKind kind, std::string_view name) {
  for (const CatalogEntry& e : all)
    if (e.kind == kind && e.name == name) return e;
  FAIL("no entry ", name);
  return all.front();
}

json properties(const std::vector<CatalogEntry>& all, EntryKind kind, std::string_view name) {
  return json::parse(entry_json(entry(all, kind, name)))["params"]["properties"];
}

}  // namespace

TEST_CASE("catalog: every operation, way to show, reader and writer is an entry, each once") {
  size_t readers = 0, writers = 0;
  for (const Format& f : formats()) readers += f.read != nullptr, writers += f.write != nullptr;
  std::map<EntryKind, size_t> count;
  std::set<std::pair<EntryKind, std::string>> names;
  for (const CatalogEntry& e : catalog()) {
    CAPTURE(e.name);
    CHECK(names.emplace(e.kind, e.name).second);
    CHECK(e.sentence.ends_with("."));
    for (const ParamDecl& d : e.schema.decls()) CHECK_MESSAGE(d.doc.ends_with("."), d.name);
    ++count[e.kind];
  }
  CHECK(count[EntryKind::source] + count[EntryKind::operation] == operations().size());
  CHECK(count[EntryKind::show] == show_kinds().size());
  CHECK(count[EntryKind::reader] == readers);
  CHECK(count[EntryKind::writer] == writers);
  for (const EntryKind one : {EntryKind::read, EntryKind::camera, EntryKind::picture, EntryKind::film, EntryKind::page})
    CHECK(count[one] == 1);
}

TEST_CASE("catalog: an operation as JSON has name, family, sentence, inputs and the schema of its parameters") {
  const Operation& op = find_operation("scale", test::counted_operations());
  const ParamSet params = op.make_params();
  const CatalogEntry e{EntryKind::operation, "scale", std::string(op.sentence), params.values, params.schema, &op, nullptr};
  CHECK(json::parse(entry_json(e)) == json::parse(R"({"name":"scale","kind":"operation","sentence":"Multiplies a field.","family":"scalar",
    "version":3,"inputs":[1,1],"takes":[["uniform","rectilinear","curvilinear","unstructured","surface","points","amr"]],
    "makes":{"same":["uniform","rectilinear","curvilinear","unstructured","surface","points","amr"],"else":[],"parts":false},"params":{"$schema":"https://json-schema.org/draft/2020-12/schema","type":"object",
    "additionalProperties":false,"properties":{
      "field":{"type":"string","field":{"on":["point","cell"],"of":["scalar","vector","tensor","other"]},
               "description":"Field to scale; default: the active scalar."},
      "by":{"type":"number","minimum":-1000,"maximum":1000,"unit":"@field","default":2,"description":"Factor."},
      "mode":{"type":"string","enum":["plain","fancy"],"default":"plain","description":"How."}}}})"));
}

TEST_CASE("catalog: a writer has the options of its format alone, with the choices of its format") {
  const auto all = catalog();
  const auto choices = [&](std::string_view name) {
    std::vector<std::string> words;
    const json params = properties(all, EntryKind::writer, name);
    for (const json& w : params["compression"]["enum"])
      if (!w.is_null()) words.push_back(w);
    return words;
  };
  using Words = std::vector<std::string>;
  CHECK(choices("NRRD") == Words{"none", "gzip"});
  CHECK(choices("VTK XML") == Words{"none", "zlib", "lz4", "lzma"});
  CHECK(choices("OME-Zarr") == Words{"lz4", "zstd", "zlib"});
  CHECK(properties(all, EntryKind::writer, "STL").size() == 1);
  CHECK(properties(all, EntryKind::writer, "STL")["binary"]["default"] == true);
  CHECK(properties(all, EntryKind::writer, "OBJ").empty());
}

TEST_CASE("catalog: a reader has what all formats take and its own; a step that reads has all") {
  const auto all = catalog();
  CHECK(properties(all, EntryKind::reader, "raw brick").contains("dims"));
  CHECK_FALSE(properties(all, EntryKind::reader, "NRRD").contains("dims"));
  CHECK(properties(all, EntryKind::reader, "delimited text").contains("csv_header"));
  const json step = properties(all, EntryKind::read, "read");
  for (const CatalogEntry& e : all)
    if (e.kind == EntryKind::reader)
      for (const ParamDecl& d : e.schema.decls()) CHECK(step.contains(d.name));
  CHECK(step["dims"]["minItems"] == 3);
  CHECK(step["dims"]["maxItems"] == 3);
  CHECK(step["region"]["default"].is_null());
  CHECK(json::parse(entry_json(entry(all, EntryKind::read, "read")))["params"]["required"] == json{"path"});
}
