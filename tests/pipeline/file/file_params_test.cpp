// SPDX-License-Identifier: Apache-2.0
// Which parameters name files: those that write one are marked "new file", so that a recipe cannot use them.
#include <set>

#include "base/text/text.h"
#include "io/options.h"
#include "pipeline/catalog/catalog.h"
#include "pipeline/picture/picture.h"
#include "scene/show/show.h"
#include "support/test.h"

using namespace sg;

namespace {

struct Param {
  std::string name, doc, unit;
};

std::vector<Param> all_params() {
  std::vector<Param> all;
  for (const CatalogEntry& e : catalog())
    if (e.kind != EntryKind::reader && e.kind != EntryKind::writer)  // what a pipeline file can say
      for (const ParamDecl& d : e.schema.decls()) all.push_back({e.name + " " + d.name, d.doc, d.unit_});
  return all;
}

}  // namespace

TEST_CASE("parameters: those that write a file say so, and so do those that read one") {
  std::set<std::string> writing, reading, talk;
  for (const Param& p : all_params()) {
    if (p.unit == "new file") writing.insert(p.name);
    else if (p.unit == "file") reading.insert(p.name);
    else {
      const std::string doc = " " + to_lower(p.doc) + " ";
      for (const std::string_view word : {"writes", "write ", "saves", "save ", "output", "folder", "file.", "file:", " a file", "path="})
        if (doc.find(word) != doc.npos) talk.insert(p.name);
    }
  }
  CHECK(std::erase_if(writing, [](const std::string& name) { return name.ends_with(" store"); }) > 10);  // the states of simulators
  CHECK(writing == std::set<std::string>{"volume save", "film layers", "film output"});
  // Of each number of a material.
  for (const std::string_view kind : {"surface ", "volume "})
    CHECK(std::erase_if(reading, [&](const std::string& name) { return name.starts_with(kind) && name.ends_with("_picture"); }) == 17);
  CHECK(reading == std::set<std::string>{"gradient_images path", "panorama file", "read path", "surface picture", "tensor_fit bvals",
                                         "tensor_fit bvecs", "volume picture"});
  // Every other one that speaks of files, each looked at: names or files to read (the fence around a recipe holds them), or no file at all.
  for (const std::string& name : talk) {
    INFO(name);
    const std::string_view last = std::string_view(name).substr(name.find(' ') + 1);
    CHECK((last == "map" || last == "transfer" || last == "shape" || last == "times" || last == "by" ||
           name == "camera file"));  // a camera in what is read anyway
  }
}

TEST_CASE("recipes: a parameter that writes a file is found in every step and way to show") {
  for (const std::string word : {"save=x", "save =x", " save=x", "save"}) {
    PipelineFile f;
    f.steps = {{"a", "hydrogen", {}, {}, 1}};
    f.show = {{"volume", {word}, "", 2}};
    CHECK(test::error_of([&] { check_recipe(f, "p.png"); }).find("would write a file") != std::string::npos);
  }
}
