// SPDX-License-Identifier: Apache-2.0
// What a picture is of: frames, titles of axes, and what is chosen of both.
#include "pipeline/picture/picture.h"

#include "pipeline/picture/picture_parts.h"
#include "support/test.h"

using namespace sg;

namespace {

struct Made {
  PipelineFile file;
  Picture picture;
};

Made made(const std::string& steps, const std::string& picture, const Data* data = nullptr, std::vector<std::string> coloring = {}) {
  Made m;
  m.file = parse_pipeline("sightglass: 1\nsteps:\n  a: {" + steps + "}\npicture: {" +
                              (picture.find("size:") == picture.npos ? "size: 120x90" : "legend: true") + picture + "}\n",
                          "", picture_vocabulary());
  PictureOptions options;
  options.coloring = std::move(coloring);
  if (data) options.results["a"] = *data;
  Context context;
  m.picture = make_picture(m.file, options, context);
  return m;
}

// A noisy scan with a ball in it, in the patient frame.
Data scan() {
  DatasetParts parts;
  UniformGrid g;
  g.dims = {32, 32, 32};
  std::vector<float> v;
  for (int k = 0; k < 32; ++k)
    for (int j = 0; j < 32; ++j)
      for (int i = 0; i < 32; ++i) {
        const double x = i - 15.5, y = j - 15.5, z = k - 15.5;
        v.push_back(x * x + y * y + z * z < 64 ? float(300 + (i * 7 + j * 3) / 3) : float((i * 7 + j * 5 + k * 3) % 20));
      }
  parts.mesh = g;
  parts.fields.add({"v", Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  parts.notes = {{"space", "left-posterior-superior"}, {"Modality", "MR"}};
  return Data(make_dataset(std::move(parts)));
}

// 1 in a corner of a grid of 30^3 samples, falling to nothing within a few.
Data corner() {
  UniformGrid g;
  g.dims = {30, 30, 30};
  std::vector<float> v;
  for (int k = 0; k < 30; ++k)
    for (int j = 0; j < 30; ++j)
      for (int i = 0; i < 30; ++i) v.push_back(std::exp(-0.1f * float(i * i + j * j + k * k)));
  FieldSet fields;
  fields.add({"v", Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  return Data(make_dataset(g, fields));
}

}  // namespace

TEST_CASE("frame: a stated one is seen as all of the data would be, in stretched coordinates, too") {
  // A cube is drawn as a crop of a larger one is, framed.
  const auto pixels = [](const std::string& step, const std::string& more) {
    Made m = made(step, ", legend: false, axes: false, triad: false" + more);
    return m.picture.image.pixels;
  };
  const std::string tangle = "tangle: {size: 8}";
  CHECK(pixels(tangle, ", frame: \"-1,1,-1,1,-1,1\"") != pixels(tangle, ""));
  const Made whole = made(tangle, "");
  CHECK_FALSE(word_value(whole.file.picture, "frame"));
  for (const char* bad : {"1,2", "0,1,0,1,1,0", "0,1,0,1,0"}) {
    CAPTURE(bad);
    CHECK_THROWS_WITH_AS(made(tangle, std::string(", frame: \"") + bad + "\""), doctest::Contains("frame"), Error);
  }
}

TEST_CASE("frame: chosen where the rest of a volume is clear, said, kept in the recipe, and left where something is stated") {
  const Data data = corner();
  const Made m = made("read: given.vti", "", &data);
  const auto frame = word_value(m.file.picture, "frame");
  REQUIRE(frame);
  CHECK(std::any_of(m.picture.notes.begin(), m.picture.notes.end(),
                    [&](const std::string& n) { return n.find("frame=" + *frame) != n.npos; }));
  PipelineFile again = m.file;
  PictureOptions options;
  options.results["a"] = data;
  Context context;
  CHECK(make_picture(again, options, context).image.pixels == m.picture.image.pixels);
  CHECK(word_value(made("read: given.vti", ", frame: \"0,29,0,29,0,29\"", &data).file.picture, "frame") == "0,29,0,29,0,29");
  CHECK_FALSE(word_value(made("read: given.vti", ", camera: {position: [90, -90, 60]}", &data).file.picture, "frame"));
  CHECK_FALSE(word_value(made("read: given.vti", "", &data, {"range=0,1"}).file.picture, "frame"));
}

TEST_CASE("axes: stated titles are written, and a curve has the name of its field") {
  const auto pixels = [](const std::string& more) { return made("tangle: {size: 8}", more).picture.image.pixels; };
  CHECK(pixels("") == pixels(", x_title: x, y_title: y, z_title: z"));
  CHECK(pixels("") != pixels(", x_title: east"));
  UniformGrid g;
  g.dims = {5, 1, 1};
  FieldSet fields;
  fields.add({"height", Association::point, Array::from_vector<float>({1, 3, 2, 5, 4}), "m", Role::scalars});
  const Data line(make_dataset(g, fields));
  const Made curve = made("read: given.vti", "", &line);
  CHECK(word_value(curve.file.picture, "y_title") == "height [m]");
  CHECK(word_value(curve.file.picture, "stretch") == "1,0.6,1");
  CHECK(word_value(made("read: given.vti", ", y_title: depth", &line).file.picture, "y_title") == "depth");
}

TEST_CASE("views: a scan's slices are each seen straight on, unless something is said of the view or there is no room") {
  const Data data = scan();
  const auto views = [&](const std::string& more) { return word_value(made("read: given.nii", more, &data).file.picture, "views"); };
  CHECK(views(", size: 480x360") == "front,left,bottom,iso");
  CHECK_FALSE(views(""));  // 120x90
  CHECK_FALSE(views(", size: 480x360, camera: front"));
  CHECK_FALSE(views(", size: 480x360, camera: {azimuth: 20}"));
  CHECK_FALSE(views(", size: 480x360, layout: 2x1"));
  CHECK(views(", size: 480x360, views: \"left,front\"") == "left,front");
}

TEST_CASE("frame: boxes in words keep their sides far from zero, and flat ones stay flat") {
  CHECK(box_words({{500000.04, -1.5, 3}, {500000.91, 1.5, 3}}) == "500000.04,500000.91,-1.5,1.5,3,3");
  CHECK(box_words({{0.1234567, 0, 0}, {0.7654321, 1, 1e-9}}) == "0.1235,0.7654,0,1,0,1e-09");
}
