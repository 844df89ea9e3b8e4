// SPDX-License-Identifier: Apache-2.0
// One value for all inputs of a picture, and for all steps of a series.
#include "pipeline/picture/settle_choices.h"

#include <cmath>

#include "base/file/file.h"
#include "pipeline/film/film.h"
#include "support/test.h"

using namespace sg;

namespace {

// Values from 0 in the corner to `most` in the opposite one of 6 x 6 x 6 samples, `aside` along x.
DatasetPtr ramp(const std::string& name, double most, double aside = 0) {
  UniformGrid g;
  g.dims = {6, 6, 6}, g.origin = {aside, 0, 0};
  std::vector<double> v;
  for (int i = 0; i < 216; ++i) v.push_back(most * (i % 6 + i / 6 % 6 + i / 36) / 15);
  DatasetParts parts;
  parts.mesh = g;
  parts.fields.add({name, Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  return make_dataset(std::move(parts));
}

PipelineFile two_inputs(const std::string& step) {
  return parse_pipeline("sightglass: 1\nsteps:\n  a: {read: a.vti}\n  fa: " + step + "\n  b: {read: b.vti}\n  fb: " + step + "\n", "",
                        picture_vocabulary());
}

PipelineFile settled(const std::string& step, const DatasetPtr& a, const DatasetPtr& b) {
  PipelineFile file = two_inputs(step);
  const StepResults results{{"a", Data(a)}, {"b", Data(b)}};
  std::vector<Data> held;
  Context context;
  settle_choices(file, {}, {}, results, held, context);
  return file;
}

}  // namespace

TEST_CASE("settle choices: the same field of two inputs gets the same isovalues, other fields their own") {
  const PipelineFile same = settled("{contour: {}}", ramp("T", 10), ramp("T", 40));
  CHECK(same.steps[1].words == std::vector<std::string>{"values=20"});  // near the middle of 0 to 40
  CHECK(same.steps[3].words == same.steps[1].words);
  const PipelineFile other = settled("{contour: {}}", ramp("T", 10), ramp("p", 40));
  CHECK(other.steps[1].words == std::vector<std::string>{"values=5"});
  CHECK(other.steps[3].words == std::vector<std::string>{"values=20"});
  const PipelineFile bands = settled("{bands: {count: 4}}", ramp("T", 10), ramp("T", 40));
  CHECK(bands.steps[1].words == std::vector<std::string>{"count=4", "values=10,20,30"});
  CHECK(bands.steps[3].words == bands.steps[1].words);
  const PipelineFile lines = settled("{isolines: {count: 3}}", ramp("T", 10), ramp("T", 40));
  CHECK(lines.steps[3].words == std::vector<std::string>{"count=3", "values=10,20,30"});
}

TEST_CASE("settle choices: what is stated stays, one input chooses by itself, and branches of one input are not two") {
  const PipelineFile stated = settled("{contour: {values: [3]}}", ramp("T", 10), ramp("T", 40));
  CHECK(stated.steps[1].words == std::vector<std::string>{"values=3"});
  PipelineFile branches = parse_pipeline(
      "sightglass: 1\nsteps:\n  a: {read: a.vti}\n  f: {contour: {}}\n  t: {threshold: {max: 5}, from: a}\n  g: {contour: {}}\n", "",
      picture_vocabulary());
  const std::vector<PipelineFile::Step> before = branches.steps;
  std::vector<Data> held;
  Context context;
  settle_choices(branches, {}, {}, {{"a", Data(ramp("T", 10))}}, held, context);
  CHECK(branches.steps == before);
  CHECK(held.empty());
}

TEST_CASE("settle choices: mistakes are told with their line") {
  PipelineFile file = two_inputs("{contour: {valeus: [3]}}");
  std::vector<Data> held;
  Context context;
  const std::string error = test::error_of([&] { settle_choices(file, {}, {}, {}, held, context); });
  CHECK(error.find("valeus") != std::string::npos);
}

namespace {

// Recipes of the pictures at three times, of data that grow from 0..10 to 0..30.
std::vector<PipelineFile> film_of(const std::string& rest) {
  PipelineFile file = parse_pipeline(
      "sightglass: 1\nsteps:\n  a: {sphere: {dims: [6, 6, 6], bounds: [0, 10, 0, 1, 0, 1]}}\n  grown: {calc: {expr: \"x*{t}\", name: T}}\n"
      "  only: {select: {keep: T}}\n" +
          rest,
      "", picture_vocabulary());
  FilmParams params;
  params.times = "1:3:3";
  std::vector<PipelineFile> recipes;
  Context context;
  make_film(file, params, {}, {nullptr, [&](FilmFrame&& f) { recipes.push_back(f.pipeline); }}, context);
  REQUIRE(recipes.size() == 3);
  return recipes;
}

}  // namespace

TEST_CASE("settle choices: all steps of a series have one isovalue") {
  for (const PipelineFile& one : film_of("  c: {contour: {}}\npicture: {size: 40x30}\n"))
    CHECK(one.steps[3].words == std::vector<std::string>{"values=15"});
}

TEST_CASE("settle choices: all steps of a series are seen through by one opacity and one range") {
  const std::vector<PipelineFile> recipes = film_of("show:\n  - {volume: {}}\npicture: {size: 40x30}\n");
  const auto opacity = word_value(recipes[0].show[0].words, "opacity"), range = word_value(recipes[0].show[0].words, "range");
  REQUIRE(opacity);
  CHECK(range == "0,30");
  for (const PipelineFile& one : recipes) {
    CHECK(word_value(one.show[0].words, "opacity") == opacity);
    CHECK(word_value(one.show[0].words, "range") == range);
  }
  const std::vector<PipelineFile> stated = film_of("show:\n  - {volume: {opacity: \"0:0,1:0.5\", map: magma}}\npicture: {size: 40x30}\n");
  CHECK(word_value(stated[2].show[0].words, "opacity") == "0:0,1:0.5");
  CHECK(!word_value(stated[2].show[0].words, "colors"));
}

TEST_CASE("settle choices: what a transfer file states is not chosen for a film") {
  const std::string path = test::fresh_folder("film_transfer") + "mine.yaml";
  write_file(path, "sightglass-transfer: 1\nopacity: '@0:0,@30:0.25'\n");
  const std::vector<PipelineFile> recipes = film_of("show:\n  - {volume: {transfer: \"" + path + "\"}}\npicture: {size: 40x30}\n");
  for (const PipelineFile& one : recipes) CHECK(word_value(one.show[0].words, "opacity") == "@0:0,@30:0.25");
}
