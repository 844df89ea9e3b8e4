// SPDX-License-Identifier: Apache-2.0
// What is said of drawing before it begins, and of colours that were left to the data.
#include "pipeline/picture/picture_cost.h"

#include <algorithm>

#include "pipeline/picture/picture.h"
#include "scene/show/volume.h"
#include "support/test.h"

using namespace sg;

namespace {

PipelineFile tangle(const std::string& show, const std::string& size) {
  return parse_pipeline("sightglass: 1\nsteps:\n  a: {tangle: {size: 32}}\n" + show + "picture: {size: " + size + "}\n", "",
                        picture_vocabulary());
}

std::string explained(const std::string& show, const std::string& size) {
  const PipelineFile file = tangle(show, size);
  return explain_drawing(file, build_graph(file));
}

}  // namespace

TEST_CASE("drawing: the plan tells what it adds, by ways to show, more for more pixels") {
  CHECK(explained("", "800x600").find("for surfaces") != std::string::npos);
  CHECK(explained("show: [{surface: {}}]\n", "800x600") == "drawing 800 x 600 pixels adds below 0.1 s\n");
  const std::string volume = explained("show: [{volume: {}}]\n", "8000x6000");
  CHECK(volume.find("drawing 8000 x 6000 pixels adds about ") == 0);
}

TEST_CASE("drawing: a lit volume that takes long says so, others do not") {
  UniformGrid g;
  g.dims = {64, 64, 64};
  DatasetParts parts;
  parts.mesh = g;
  parts.fields.add({"v", Association::point, Array::from_vector(std::vector<float>(64 * 64 * 64, 1)), "", Role::scalars});
  const DatasetPtr data = make_dataset(std::move(parts));
  const auto note = [&](std::vector<std::string> words, double pixels) {
    const ShowKind& kind = find_show("volume");
    Scene scene;
    Context context;
    kind.add(scene, data, show_params(kind, words), context);
    return note_of_long_drawing(scene, pixels, context);
  };
  CHECK(note({"tolerance=0.002"}, 3840.0 * 2160).find("tolerance=0.01 takes about half") != std::string::npos);
  CHECK_FALSE(note({"tolerance=0.002"}, 1920.0 * 1080).empty());
  CHECK(note({}, 3840.0 * 2160).empty());  // steps are measured first
  CHECK(note({"step=0.1"}, 3840.0 * 2160).empty());
  CHECK(note({"tolerance=0.1"}, 1920.0 * 1080).empty());  // takes a fifth of it
  CHECK(note({"tolerance=0.002"}, 800.0 * 600).empty());
  CHECK(note({"shaded=false"}, 3840.0 * 2160).empty());
  CHECK(note({"mode=maximum"}, 3840.0 * 2160).empty());
}

TEST_CASE("pictures: a stated way to show says by which field it colours, where that is left to the data") {
  const auto notes = [](const std::string& words) {
    PipelineFile file = tangle("show: [{surface: {" + words + "}}]\n", "60x40");
    Context context;
    return make_picture(file, {}, context).notes;
  };
  const auto said = [](const std::vector<std::string>& notes) {
    return std::any_of(notes.begin(), notes.end(), [](const std::string& n) { return n.find("surface: coloured by '") == 0; });
  };
  CHECK(said(notes("")));
  CHECK_FALSE(said(notes("color: red")));
}
