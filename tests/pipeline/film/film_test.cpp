// SPDX-License-Identifier: Apache-2.0
// Films made from C++, without the command line. tests/cli has those of files.
#include "pipeline/film/film.h"

#include "base/file/file.h"
#include "base/text/text.h"
#include "image/codec.h"
#include "simulate/run/frames.h"
#include "support/test.h"

using namespace sg;
using test::error_of;

namespace {

constexpr const char* gyre =
    "sightglass: 1\nsteps:\n  a: {double_gyre: {dims: [21, 11, 1]}}\nshow:\n  - {surface: {field: velocity}}\n"
    "picture: {size: 60x40, legend: false, times: \"0:1:3\", output: film.webm, fps: 5}\n";

struct Shot {
  Image image;
  PipelineFile pipeline;
  double time;
};

std::vector<Shot> shots_of(PipelineFile file, const FilmParams& params, Context& context) {
  std::vector<Shot> shots;
  const std::vector<double> times = make_film(std::move(file), params, {},
                                              {nullptr,
                                               [&](FilmFrame&& f) {
                                                 shots.push_back({std::move(f.image), f.pipeline, f.time});
                                               }},
                                              context);
  REQUIRE(times.size() == shots.size());
  for (size_t i = 0; i < times.size(); ++i) CHECK(shots[i].time == times[i]);
  return shots;
}

}  // namespace

TEST_CASE("film: what a pipeline file says of its film is taken out of it, and set with checks") {
  PipelineFile file = parse_pipeline(gyre, "", picture_vocabulary());
  FilmParams params;
  take_film_words(file, params);
  CHECK(params.times == "0:1:3");
  CHECK(params.output == "film.webm");
  CHECK(params.fps == 5.0);
  CHECK(file.picture == std::vector<std::string>{"size=60x40", "legend=false"});
  file.picture.push_back("fps=0");
  CHECK(error_of([&] { take_film_words(file, params); }).find("from 0.1 to 1000") != std::string::npos);
}

TEST_CASE("film: short series last for seconds, long ones have 25 pictures in each, unless it is stated") {
  FilmParams p;
  CHECK(pictures_per_second(p, 11) == 2.75);
  CHECK(pictures_per_second(p, 3) == 2);
  CHECK(pictures_per_second(p, 1000) == 25);
  CHECK(pictures_per_second(p, 0) == 25);
  p.fps = 12;
  CHECK(pictures_per_second(p, 11) == 12);
}

TEST_CASE("film: each picture is the one that its pipeline makes alone, and all have one range of colours") {
  PipelineFile file = parse_pipeline(gyre, "", picture_vocabulary());
  FilmParams params;
  take_film_words(file, params);
  Context context;
  const std::vector<Shot> shots = shots_of(file, params, context);
  REQUIRE(shots.size() == 3);
  CHECK(shots[1].time == 0.5);
  CHECK(shots[0].image.pixels != shots[1].image.pixels);
  const auto range = word_value(shots[0].pipeline.show[0].words, "range");
  CHECK(range);
  for (const Shot& s : shots) {
    CHECK(word_value(s.pipeline.steps[0].words, "time") == exact_number(s.time));
    CHECK(word_value(s.pipeline.show[0].words, "range") == range);
    PipelineFile alone = s.pipeline;
    CHECK(make_picture(alone, {}, context).image.pixels == s.image.pixels);
  }
}

TEST_CASE("film: where the data grow and shrink, camera and axes stay those of all of them, unless a frame is stated") {
  const std::string begin =
      "sightglass: 1\nsteps:\n  a: {double_gyre: {dims: [41, 21, 1]}}\n  b: {threshold: {field: velocity, component: 0, min: 0.15}}\n"
      "show:\n  - {surface: {field: velocity}}\npicture: {size: 60x40, legend: false";
  FilmParams params;
  params.times = "0:5:3";
  Context context;
  std::string said;
  context.on_log = [&](LogLevel, std::string_view text) { said += text; };
  const std::vector<Shot> shots = shots_of(parse_pipeline(begin + "}\n", "", picture_vocabulary()), params, context);
  const auto frame = word_value(shots[0].pipeline.picture, "frame");
  REQUIRE(frame);
  CHECK(said.find("frame=" + *frame) != said.npos);
  for (const Shot& s : shots) CHECK(word_value(s.pipeline.picture, "frame") == frame);
  for (const Shot& s : shots_of(parse_pipeline(begin + ", frame: [0, 2, 0, 1, 0, 0]}\n", "", picture_vocabulary()), params, context))
    CHECK(word_value(s.pipeline.picture, "frame") == "0,2,0,1,0,0");
}

TEST_CASE("film: where two steps do not fit into the memory allowed, the pictures are the same") {
  PipelineFile file = parse_pipeline(gyre, "", picture_vocabulary());
  FilmParams params;
  take_film_words(file, params);
  Context free, tight;
  tight.memory_limit = 4000;  // a source of 231 points may compute
  std::string said;
  tight.on_log = [&](LogLevel, std::string_view text) { said += text; };
  const std::vector<Shot> a = shots_of(file, params, free), b = shots_of(file, params, tight);
  CHECK(said.find("two steps do not fit") != std::string::npos);
  REQUIRE(a.size() == b.size());
  for (size_t i = 0; i < a.size(); ++i) CHECK(a[i].image.pixels == b[i].image.pixels);
}

TEST_CASE("film: an operation that shows a moment takes the time, and what it is given stays as it is") {
  PipelineFile file = parse_pipeline(
      "sightglass: 1\nsteps:\n  a: {double_gyre: {dims: [21, 11, 1]}}\n  b: {streamlines: {count: 5, max_time: 2}}\n  c: {trails: {length: "
      "1}}\n"
      "show:\n  - {lines: {}}\npicture: {size: 40x30}\n",
      "", picture_vocabulary());
  FilmParams params;
  params.times = "1,2";
  Context context;
  for (const Shot& s : shots_of(file, params, context)) {
    CHECK_FALSE(word_value(s.pipeline.steps[0].words, "time"));
    CHECK(word_value(s.pipeline.steps[2].words, "time") == exact_number(s.time));
  }
}

TEST_CASE("film: the camera and the title take the time, of data that stand still too") {
  PipelineFile file =
      parse_pipeline("sightglass: 1\nsteps:\n  a: {tangle: {size: 8}}\npicture: {size: 40x30, title: 'At {t}', camera: {azimuth: '{t}'}}\n",
                     "", picture_vocabulary());
  FilmParams params;
  params.times = "0:90:3";
  Context context;
  const std::vector<Shot> shots = shots_of(file, params, context);
  CHECK(word_value(shots[1].pipeline.picture, "camera.azimuth") == "45");
  CHECK(word_value(shots[1].pipeline.picture, "title") == "At 45");
  CHECK(shots[0].image.pixels != shots[1].image.pixels);
  // What has a time moves along.
  file = parse_pipeline(gyre, "", picture_vocabulary());
  take_film_words(file, params);
  file.picture.push_back("camera.roll={t}");
  const std::vector<Shot> both = shots_of(file, params, context);
  CHECK(word_value(both[1].pipeline.steps[0].words, "time") == "0.5");
  CHECK(word_value(both[1].pipeline.picture, "camera.roll") == "0.5");
}

TEST_CASE("film: a turntable is one turn of the camera from where it stands, and nothing else moves") {
  Context context;
  PipelineFile file =
      parse_pipeline("sightglass: 1\nsteps:\n  a: {tangle: {size: 8}}\npicture: {size: 40x30, camera: {azimuth: 10, roll: 5}}\n", "",
                     picture_vocabulary());
  FilmParams params;
  params.turntable = 4;
  const std::vector<Shot> shots = shots_of(file, params, context);
  REQUIRE(shots.size() == 4);
  const char* azimuths[] = {"10", "100", "190", "280"};
  for (size_t i = 0; i < 4; ++i) {
    CHECK(word_value(shots[i].pipeline.picture, "camera.azimuth") == azimuths[i]);
    CHECK(word_value(shots[i].pipeline.picture, "camera.roll") == "5");
  }
  // A view in one word, and data that could move by itself.
  file = parse_pipeline(gyre, "", picture_vocabulary());
  take_film_words(file, params);
  params.times.clear();
  std::erase_if(file.picture, [](const std::string& w) { return w.starts_with("camera"); });
  file.picture.push_back("camera=top azimuth=45");
  const std::vector<Shot> top = shots_of(file, params, context);
  REQUIRE(top.size() == 4);
  CHECK(top[0].image.pixels != top[1].image.pixels);
  CHECK(word_value(top[1].pipeline.picture, "camera") == "top azimuth=135");
  CHECK_FALSE(word_value(top[1].pipeline.steps[0].words, "time"));
  params.times = "0:1";
  CHECK(error_of([&] { shots_of(file, params, context); }).find("a turntable has no times") != std::string::npos);
}

TEST_CASE("film: progress goes on over all pictures") {
  PipelineFile file = parse_pipeline(gyre, "", picture_vocabulary());
  FilmParams params;
  take_film_words(file, params);
  Context context;
  std::vector<double> told;
  context.on_progress = [&](double f, std::string_view) { told.push_back(f); };
  shots_of(file, params, context);
  CHECK(std::is_sorted(told.begin(), told.end()));
  CHECK(told.back() == 1);
}

TEST_CASE("film: numbered pictures go into files that carry their recipes") {
  PipelineFile file = parse_pipeline(gyre, "", picture_vocabulary());
  FilmParams params;
  take_film_words(file, params);
  params.output = test::temp_folder() + "made_{n}.png", params.times = "0,1";
  CHECK(is_film(params.output));
  CHECK_FALSE(is_film("one.png"));
  Context context;
  const FilmWritten written = write_film(file, params, {}, context);
  CHECK(written.times == std::vector<double>{0, 1});
  CHECK(written.what.ends_with("made_001.png"));
  const Image second = read_png(test::temp_folder() + "made_001.png");
  CHECK(word_value(recipe_in(second, "x.png").steps[0].words, "time") == "1");
}

TEST_CASE("film: layers of numbered pictures and of a film are numbered, and are those of the pictures") {
  PipelineFile file = parse_pipeline(gyre, "", picture_vocabulary());
  FilmParams params;
  take_film_words(file, params);
  params.output = test::temp_folder() + "layered_{n}.png", params.times = "0,1", params.layers = test::temp_folder() + "layers_{n}.vti";
  Context context;
  write_film(file, params, {}, context);
  for (const char* n : {"000", "001"}) {
    const Image picture = read_png(test::temp_folder() + "layered_" + n + ".png");
    const DatasetPtr layers = std::get<DatasetPtr>(read_data(test::temp_folder() + "layers_" + n + ".vti", {}, context));
    const Field& color = layers->fields().require("color");
    REQUIRE(color.array.count() == size_t(picture.width) * size_t(picture.height));
    CHECK(layers->fields().find("light", Association::point));
    // The upper left pixel is in the last row.
    const size_t at = color.array.count() - size_t(picture.width);
    for (int c = 0; c < 3; ++c) CHECK(color.array.get(at, c) == picture.pixels[size_t(c)]);
  }
  params.layers = test::temp_folder() + "layers.vti";
  CHECK(test::contains(test::error_of([&] { write_film(file, params, {}, context); }), "layers_{n}.vti"));
}

TEST_CASE("film: what has no time says so before anything is drawn") {
  PipelineFile file = parse_pipeline("sightglass: 1\nsteps:\n  a: {tangle: {size: 5}}\n");
  Context context;
  FilmParams params;
  bool drawn = false;
  const FilmCallbacks callbacks{nullptr, [&](FilmFrame&&) { drawn = true; }};
  CHECK(error_of([&] { make_film(file, params, {}, callbacks, context); }).find("--times") != std::string::npos);
  params.times = "0,1";
  CHECK(error_of([&] { make_film(file, params, {}, callbacks, context); }).find("has no parameter 'time'") != std::string::npos);
  CHECK_FALSE(drawn);
}

TEST_CASE("film: a simulation runs once for the ranges of all pictures and for the pictures, which are those of single ones") {
  const auto pipeline = [](const std::string& show) {
    return parse_pipeline(
        "sightglass: 1\nsteps:\n  air: {smoke: {size: 8, frame: 0.1, bounds: [0, 1, 0, 1, 0, 0]}}\nshow:\n  - {surface: {" + show +
            "}}\npicture: {size: 60x40, legend: false, output: film.webm}\n",
        "", picture_vocabulary());
  };
  // An automatic range, a stated one, and pictures that lie some frames apart.
  for (const char* show : {"field: density", "field: density, range: [0, 1]"})
    for (const char* times : {"0:1.2:7", "0:1.2:13"}) {
      CAPTURE(show);
      CAPTURE(times);
      Context context;
      FilmParams params;
      params.times = times;
      const uint64_t before = computed_frames();
      const std::vector<Shot> shots = shots_of(pipeline(show), params, context);
      CHECK(computed_frames() - before == 12);
      PipelineFile last = shots.back().pipeline;
      CHECK(make_picture(last, {}, context).image.pixels == shots.back().image.pixels);
    }
}

TEST_CASE("film: where the frames of a simulation do not fit into the memory allowed, they are computed again") {
  const std::vector<double> times{0, 1, 2};
  const KeptFrames nothing(times, 0);
  FrameParams p;
  p.frame = 0.5;
  CHECK_FALSE(KeptFrames::wants("run", p, 2));
  const KeptFrames some(times, 1000);
  CHECK(KeptFrames::wants("run", p, 2));
  CHECK_FALSE(KeptFrames::wants("run", p, 3));
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(std::vector<double>(8)), "", Role::scalars});
  UniformGrid g;
  g.dims = {2, 2, 2};
  const DatasetPtr small = make_dataset(g, fields);  // 64 bytes
  KeptFrames::keep("run", p, 2, small);
  CHECK(KeptFrames::find("run", 2) == small);
  CHECK(KeptFrames::bytes() == 64);
  g.dims = {6, 6, 6};
  FieldSet more;
  more.add({"f", Association::point, Array::from_vector(std::vector<double>(216)), "", Role::scalars});
  KeptFrames::keep("run", p, 4, make_dataset(g, more));  // 1728 bytes are too many
  CHECK(KeptFrames::find("run", 4) == nullptr);
}
