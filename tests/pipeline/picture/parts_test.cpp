// SPDX-License-Identifier: Apache-2.0
// What a picture shows of data in parts, and from where, when nothing is said.
#include <algorithm>

#include "data/dataset.h"
#include "io/io.h"
#include "pipeline/picture/picture.h"
#include "scene/look/look.h"
#include "support/test.h"

using namespace sg;

namespace {

// A square in the plane z with its number as the cell field "ObjectId".
DatasetPtr square(float z, int number, const std::string& names) {
  SurfaceMesh m;
  m.points.xyz = Array::from_vector<float>({0, 0, z, 1, 0, z, 1, 1, z, 0, 1, z}, 3);
  m.polygons = {Array::from_vector<int32_t>({0, 1, 2, 3}), {}, 4};
  DatasetParts parts;
  parts.mesh = m;
  parts.fields.add({"ObjectId", Association::cell, Array::from_vector<int32_t>({number}), "", Role::none});
  parts.notes.emplace_back("labels of ObjectId", names);
  return make_dataset(std::move(parts));
}

CollectionPtr collection(std::vector<Collection::Part> parts) {
  auto c = std::make_shared<Collection>();
  c->parts = std::move(parts);
  return c;
}

struct Drawn {
  PipelineFile file;
  Picture picture;
};

Drawn shown(const Data& data, const std::string& show = "", const std::string& step = "") {
  Drawn r;
  r.file = parse_pipeline("sightglass: 1\nsteps:\n  in: {read: given.exo}\n" + step + show + "picture: {size: 80x60}\n", "",
                          picture_vocabulary());
  PictureOptions options;
  options.results["in"] = data;
  Context context;
  r.picture = make_picture(r.file, options, context);
  return r;
}

}  // namespace

TEST_CASE("pictures of parts: sets of sides lie upon their blocks and are left out, blocks are told apart by their numbers") {
  const CollectionPtr blocks = collection({{"rim", square(0, 1, "1=rim")}, {"tyre", square(2, 2, "2=tyre")}});
  const CollectionPtr sides = collection({{"outer", square(2, 1, "1=outer")}});
  const Drawn all = shown(Data(collection({{"Element Blocks", Data(blocks)}, {"Side Sets", Data(sides)}})));
  REQUIRE(all.file.steps.size() >= 2);
  CHECK(all.file.steps[1].operation == "extract");
  CHECK(all.file.steps[1].words == std::vector<std::string>{"blocks=Element Blocks"});
  REQUIRE(!all.file.show.empty());
  CHECK(word_value(all.file.show[0].words, "field") == "ObjectId");
  const std::string said = all.picture.notes.empty() ? "" : all.picture.notes[0];
  CHECK(said.find("sets of sides and nodes lie upon the blocks and are left out") != std::string::npos);
  // Nothing to leave out.
  const Drawn alone = shown(Data(collection({{"Side Sets", Data(sides)}})));
  CHECK(alone.file.steps.size() == 1);
  const Drawn plain = shown(Data(blocks));
  CHECK(plain.file.steps.size() == 1);
  CHECK(word_value(plain.file.show[0].words, "field") == "ObjectId");
  // The same number everywhere tells nothing.
  const Drawn same = shown(Data(collection({{"a", square(0, 1, "")}, {"b", square(2, 1, "")}})));
  CHECK(!word_value(same.file.show[0].words, "field"));
}

TEST_CASE("pictures of parts: sets are left out of what is shown by name, too, unless they were chosen or coloured by") {
  const CollectionPtr blocks = collection({{"rim", square(0, 1, "1=rim")}, {"tyre", square(2, 2, "2=tyre")}});
  DatasetParts wall = square(2, 1, "1=outer")->parts();
  wall.fields.add({"flux", Association::cell, Array::from_vector<float>({3}), "", Role::none});
  const Data all(
      collection({{"Element Blocks", Data(blocks)}, {"Side Sets", Data(collection({{"outer", make_dataset(std::move(wall))}}))}}));
  const auto told = [](const Drawn& s) {
    return std::count_if(s.picture.notes.begin(), s.picture.notes.end(), [](const std::string& n) { return n.find("lie upon") != n.npos; });
  };
  const Drawn two = shown(all, "show: [{surface: {}}, {outline: {}}]\n");
  REQUIRE(two.file.steps.size() == 2);
  CHECK(two.file.steps[1].words == std::vector<std::string>{"blocks=Element Blocks"});
  CHECK(two.file.steps[1].from == std::vector<std::string>{"in"});
  CHECK(two.file.show[0].of == "extract");
  CHECK(two.file.show[1].of == "extract");
  CHECK(told(two) == 1);
  // The recipe makes the same picture.
  PipelineFile again = two.file;
  PictureOptions options;
  options.results["in"] = all;
  Context context;
  CHECK(make_picture(again, options, context).image.pixels == two.picture.image.pixels);
  CHECK(again == two.file);

  const std::string chosen = "  some: {extract: {blocks: [Element Blocks, Side Sets]}}\n";
  for (const Drawn& s :
       {shown(all, "show: [{surface: {}}]\n", chosen), shown(all, "", chosen), shown(all, "show: [{surface: {field: flux}}]\n")}) {
    CHECK(told(s) == 0);
    CHECK(std::none_of(s.file.steps.begin(), s.file.steps.end(),
                       [](const auto& t) { return t.words == std::vector<std::string>{"blocks=Element Blocks"}; }));
  }
}

TEST_CASE("pictures: an input that surrounds another does not hide it") {
  const auto drawn = [](float first, float second) {
    Drawn r;
    r.file = parse_pipeline("sightglass: 1\nsteps:\n  a: {read: first.ply}\n  b: {read: second.ply}\npicture: {size: 80x60}\n", "",
                            picture_vocabulary());
    PictureOptions options;
    const auto box = [](float r) {
      std::vector<float> xyz;
      for (int i = 0; i < 8; ++i)
        for (int a = 0; a < 3; ++a) xyz.push_back((i >> a & 1) ? r : -r);
      SurfaceMesh m;
      m.points.xyz = Array::from_vector(std::move(xyz), 3);
      m.polygons = {Array::from_vector<int32_t>({0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5}), {}, 4};
      return make_dataset(m);
    };
    options.results["a"] = Data(box(first)), options.results["b"] = Data(box(second));
    Context context;
    r.picture = make_picture(r.file, options, context);
    return r;
  };
  const auto opacities = [](const Drawn& s) {
    std::vector<std::string> all;
    for (const auto& show : s.file.show) all.push_back(word_value(show.words, "opacity").value_or("1"));
    return all;
  };
  const Drawn inside = drawn(1, 2);
  CHECK(opacities(inside) == std::vector<std::string>{"1", "0.35"});
  CHECK(std::count(inside.picture.notes.begin(), inside.picture.notes.end(),
                   "second.ply surrounds first.ply: drawn with opacity=0.35, so that both are seen") == 1);
  CHECK(opacities(drawn(2, 1)) == std::vector<std::string>{"0.35", "1"});
  CHECK(opacities(drawn(1, 1)) == std::vector<std::string>{"1", "0.35"});
}

TEST_CASE("pictures: what a plane has cut open is seen from the side of the cut") {
  const auto picture = [](const std::string& clip, const std::string& camera) {
    PipelineFile file = parse_pipeline("sightglass: 1\nsteps:\n  a: {tangle: {size: 8}}\n  b: {clip: {" + clip +
                                           "}}\nshow: [{surface: {}}]\npicture: {size: 60x40, camera: {" + camera + "}}\n",
                                       "", picture_vocabulary());
    Context context;
    return make_picture(file, {}, context).image.pixels;
  };
  // Halves are seen from the side of their length.
  const std::string usual = "direction: [0.5, -1, 0.55]", behind = "direction: [0.5, 1, 0.55]";
  CHECK(picture("axis: x", "") == picture("axis: x", "direction: [1, -0.5, 0.55]"));
  CHECK(picture("axis: y", "") == picture("axis: y", behind));
  CHECK(picture("axis: y, keep: outside", "") == picture("axis: y, keep: outside", usual));
  CHECK(picture("axis: x, keep: outside", "") == picture("axis: x, keep: outside", "direction: [-1, -0.5, 0.55]"));
  CHECK(picture("axis: y", "zoom: 1") == picture("axis: y", behind));
  CHECK(picture("sphere: [0, 0, 0, 2]", "") == picture("sphere: [0, 0, 0, 2]", "direction: [0.75, -1, 0.55]"));
}

TEST_CASE("pictures: progress goes on while volumes and surfaces are drawn") {
  for (const char* show : {"volume: {}", "surface: {}"}) {
    CAPTURE(show);
    PipelineFile file = parse_pipeline(
        std::string("sightglass: 1\nsteps:\n  a: {tangle: {size: 16}}\nshow: [{") + show + "}]\npicture: {size: 500x400, samples: 2}\n", "",
        picture_vocabulary());
    Context context;
    std::vector<double> told;
    context.on_progress = [&](double f, std::string_view) { told.push_back(f); };
    make_picture(file, {}, context);
    CHECK(std::is_sorted(told.begin(), told.end()));
    REQUIRE(!told.empty());
    CHECK(told.back() == 1);
    if (show[0] == 'v') CHECK(std::count_if(told.begin(), told.end(), [](double f) { return f > 0.5 && f < 1; }) >= 5);
  }
}

TEST_CASE("pictures: ways to show the labels of lines, which are points, show the lines and what they were drawn upon") {
  PipelineFile file = parse_pipeline(
      "sightglass: 1\nsteps:\n  a: {tangle: {size: 12}}\n  b: {slice: {axis: z}}\n  c: {isolines: {count: 3}}\n  d: {line_labels: {}}\n"
      "show: [{surface: {}}, {lines: {}}, {labels: {}}]\npicture: {size: 80x60}\n",
      "", picture_vocabulary());
  Context context;
  const Picture picture = make_picture(file, {}, context);
  CHECK(file.show[0].of == "b");
  CHECK(file.show[1].of == "c");
  CHECK(file.show[2].of.empty());
  CHECK(std::any_of(picture.notes.begin(), picture.notes.end(), [](const std::string& n) { return n.find("surface: of 'b'") == 0; }));
}

TEST_CASE("pictures: contour and volume of a CT whose file does not say how the patient lies say so, unless up is stated") {
  // Air, a head of soft tissue and bone in Hounsfield units.
  std::vector<int16_t> hu;
  for (int k = 0; k < 16; ++k)
    for (int j = 0; j < 16; ++j)
      for (int i = 0; i < 16; ++i) {
        const int r = (2 * i - 15) * (2 * i - 15) + (2 * j - 15) * (2 * j - 15) + (2 * k - 15) * (2 * k - 15);
        hu.push_back(int16_t(r > 150 ? -1000 : r > 25 ? 40 : 1600));
      }
  UniformGrid g;
  g.dims = {16, 16, 16};
  DatasetParts parts;
  parts.mesh = g;
  parts.fields.add({"ct", Association::point, Array::from_vector(std::move(hu)), "", Role::scalars});
  const std::string folder = test::fresh_folder("lies_somehow");
  Context quiet;
  write_data(folder + "ct.vti", make_dataset(std::move(parts)), {}, quiet);
  const std::string contour = "  b: {contour: {values: 400}}\n", volume = "show: [{volume: {}}]\n",
                    upright = ", camera: {view: front, up: [0, 0, -1]}";
  const auto said = [&](const std::string& shown, const std::string& camera) {
    PipelineFile file =
        parse_pipeline("sightglass: 1\nsteps:\n  a: {read: " + folder + "ct.vti}\n" + shown + "picture: {size: 80x60" + camera + "}\n", "",
                       picture_vocabulary());
    Context context;
    const Picture picture = make_picture(file, {}, context);
    return std::any_of(picture.notes.begin(), picture.notes.end(),
                       [](const std::string& n) { return n.find("how the patient lies is not stated") != n.npos; });
  };
  CHECK(said(contour, ""));
  CHECK(said(volume, ""));
  CHECK(said("", ""));
  CHECK_FALSE(said(contour, upright));
  CHECK_FALSE(said(volume, upright));
}

TEST_CASE("pictures of parts: one of which a filter left nothing does not speak for the others") {
  const DatasetPtr full = square(0, 1, "1=rim");
  DatasetParts nothing = full->parts();
  SurfaceMesh none;
  none.points.xyz = Array::from_vector<float>({}, 3);
  nothing.mesh = none;
  nothing.fields = {};
  nothing.fields.add({"ObjectId", Association::cell, Array::from_vector<int32_t>({}), "", Role::none});
  const Drawn drawn = shown(Data(collection({{"a", make_dataset(std::move(nothing))}, {"b", full}})));
  REQUIRE(!drawn.file.show.empty());
  CHECK(drawn.picture.notes[0].find("no points") == std::string::npos);
}

TEST_CASE("pictures: where points have displacements, the displaced shape is offered") {
  DatasetParts parts = square(0, 1, "1=rim")->parts();
  parts.fields.add(
      {"Displacement", Association::point, Array::from_vector<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 2}, 3), "", Role::none});
  const Drawn bent = shown(Data(make_dataset(std::move(parts))));
  CHECK(bent.picture.notes[0].find("-f warp shows its shape displaced by 'Displacement'") != std::string::npos);
  CHECK(shown(Data(square(0, 1, "1=rim"))).picture.notes[0].find("warp") == std::string::npos);
}
