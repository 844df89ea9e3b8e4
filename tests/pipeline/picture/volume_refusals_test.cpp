// SPDX-License-Identifier: Apache-2.0
// What volumes and colours refuse, and that what is advised instead exists: every key=value, option and operation of a message.
#include <fmt/ranges.h>

#include "color/colormap.h"
#include "data/cells/point_positions.h"
#include "index/locator_meshes.h"
#include "pipeline/operation/operation.h"
#include "pipeline/picture/picture.h"
#include "render/volume/sources/cells/volume_cells_support.h"
#include "render/volume/volume.h"
#include "scene/camera.h"
#include "scene/camera_params.h"
#include "scene/show/show.h"
#include "scene/show/volume.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

namespace {

/// Fields "f" (one number), "v" (three), "c" (one, on the cells).
DatasetPtr with_fields(const DatasetPtr& mesh) {
  const Array xyz = point_positions(mesh->mesh());
  std::vector<float> f, v, c;
  for (size_t i = 0; i < xyz.count(); ++i) {
    f.push_back(float(xyz.get(i, 0)));
    for (int a = 0; a < 3; ++a) v.push_back(float(xyz.get(i, a)));
  }
  for (size_t i = 0; i < mesh->cell_count(); ++i) c.push_back(float(i % 7));
  DatasetParts parts = mesh->parts();
  parts.fields.add({"f", Association::point, Array::from_vector(std::move(f)), "", Role::scalars});
  parts.fields.add({"v", Association::point, Array::from_vector(std::move(v), 3), "", Role::none});
  parts.fields.add({"c", Association::cell, Array::from_vector(std::move(c)), "", Role::none});
  return make_dataset(std::move(parts));
}

DatasetPtr small_grid() {
  UniformGrid g;
  g.dims = {5, 5, 5}, g.origin = {-1, -1, -1}, g.spacing = {0.5, 0.5, 0.5};
  return make_dataset(std::move(g));
}

/// Shows and draws it; the refusal, or nothing.
std::string refusal(const DatasetPtr& data, const std::vector<std::string>& words, bool parallel = true, std::string_view kind = "volume") {
  try {
    Context context;
    Scene scene;
    add_show(scene, kind, data, words, context);
    if (kind != "volume") return "";
    Camera camera;
    camera.position = {0.5, 0.7, 5}, camera.parallel = parallel, camera.parallel_height = 3, camera.near_plane = 0.1, camera.far_plane = 20;
    const Projection p = make_projection(camera, 8, 8);
    Frame frame(p.width, p.height);
    composite_volumes(scene, p, {}, frame, context);
  } catch (const Error& e) {
    CHECK(e.kind() != ErrorKind::internal);
    return e.what();
  }
  return "";
}

DatasetPtr tets() { return make_dataset(cube(CellType::tetra, 2)); }

/// The words of a message that name nothing that exists.
std::string unknown_words(const std::string& message) {
  VolumeShow volume;
  CameraParams camera;
  PictureParams picture;
  const Schema schemas[] = {schema_of(volume), schema_of(camera), schema_of(picture)};
  std::string wrong;
  ParamSet of_operation;
  std::vector<std::string> words;
  std::string word;
  for (const char c : message + " ") {
    const bool part = std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-' || c == '=';
    if (part) word += c;
    else if (!word.empty()) words.push_back(word), word.clear();
  }
  for (size_t i = 0; i < words.size(); ++i) {
    const std::string& w = words[i];
    if (w.starts_with("--")) {
      const std::vector<std::string> options{"--show", "--camera", "--picture", "--memory"};
      if (std::find(options.begin(), options.end(), w) == options.end()) wrong += w + " ";
    } else if (w == "-f" && i + 1 < words.size()) {
      const auto all = operations();
      const auto named = std::find_if(all.begin(), all.end(), [&](const Operation& o) { return o.name == words[i + 1]; });
      if (named == all.end()) wrong += words[i + 1] + " ";
      else of_operation = named->make_params();
    } else if (const size_t at = w.find('='); at != w.npos) {
      const std::string key = w.substr(0, at), value = w.substr(at + 1);
      bool known = of_operation.schema.find(key) != nullptr;
      for (const Schema& s : schemas)
        for (const ParamDecl& d : s.decls())
          if (d.name == key)
            known =
                known || value.empty() || d.choices_.empty() || std::find(d.choices_.begin(), d.choices_.end(), value) != d.choices_.end();
      if (!known) wrong += w + " ";
    }
  }
  return wrong;
}

}  // namespace

TEST_CASE("volume: methods for lattices refuse other meshes, and say what draws them") {
  for (const DatasetPtr& mesh : {tets(), amr(), curvilinear({4, 4, 4}, false)})
    for (const char* method : {"splat", "slices", "shear_warp", "fourier"}) {
      const std::string text = refusal(with_fields(mesh), {"field=f", fmt::format("method={}", method),
                                                           "mode=" + std::string(method == std::string("fourier") ? "sum" : "composite")});
      CAPTURE(mesh->kind());
      CAPTURE(text);
      CHECK(text.find("method=ray or method=cells") != std::string::npos);
      CHECK(text.find(mesh->kind()) != std::string::npos);
      for (const char* instead : {"ray", "cells"})
        CHECK(refusal(with_fields(mesh), {"field=f", fmt::format("method={}", instead)}).empty());
    }
}

TEST_CASE("component: a number that the field does not have is refused wherever one is taken") {
  const DatasetPtr data = with_fields(small_grid());
  for (const char* number : {"1", "7", "65536", "1000000"})
    for (const char* field : {"f", "c"}) {
      CAPTURE(field);
      const std::string component = fmt::format("component={}", number), named = fmt::format("field={}", field);
      for (const char* kind : {"volume", "surface", "points"}) {
        CAPTURE(kind);
        const std::string text = refusal(data, {named, component}, true, kind);
        CHECK(text.find(fmt::format("has 1 component; there is no component {}", number)) != std::string::npos);
        CHECK(text.find("leave out component") != std::string::npos);
      }
      for (const char* more : {"range=0,1", "mode=sum", "preset=xray", "transfer=boundaries", "second=gradient", "scale=log", "map=gray"})
        CHECK(refusal(data, {named, component, more}).find("has 1 component; there is no component") != std::string::npos);
    }
  CHECK(refusal(data, {"field=v", "component=3"}).find("has 3 components; there is no component 3") != std::string::npos);
  CHECK(refusal(data, {"field=v", "component=3"}).find("0 to 2, or -1 for the magnitude") != std::string::npos);
  for (const char* good : {"-1", "0", "2"}) CHECK(refusal(data, {"field=v", fmt::format("component={}", good)}).empty());
  for (const char* good : {"-1", "0"}) CHECK(refusal(data, {"field=f", fmt::format("component={}", good)}).empty());
  // Of two fields it counts for the one that has several.
  CHECK(refusal(data, {"field=f", "opacity_by=v", "component=2"}).empty());
  CHECK(refusal(data, {"field=f", "opacity_by=v", "component=3"}).find("has 3 components") != std::string::npos);

  for (const Operation& o : operations()) {
    if (o.kind != OperationKind::filter || o.min_inputs > 1) continue;
    const ParamSet params = o.make_params();
    for (const ParamDecl& d : params.schema.decls()) {
      if (d.name != "component") continue;
      CAPTURE(o.name);
      for (const char* number : {"1", "65536"}) {
        Context context;
        const std::string text = error_of([&] { run_operation(o, {data}, {"field=f", fmt::format("component={}", number)}, context); });
        CAPTURE(text);
        CHECK(text.find("component") != std::string::npos);
      }
    }
  }
}

TEST_CASE("volume: what a refusal advises exists") {
  const DatasetPtr rectilinear_data = with_fields(rectilinear());
  std::vector<DatasetPtr> meshes{with_fields(small_grid()), rectilinear_data, with_fields(tets()), with_fields(amr())};
  std::vector<std::vector<std::string>> asked;
  for (const auto& [method, value] : enum_words(VolumeMethod()))
    for (const char* more :
         {"mode=composite",      "mode=first_hit",      "mode=sum",       "clip=1,0,0,0",  "second=gradient", "second=v",
          "kernel=sinc",         "gradient=sobel",      "classify=table", "antialias=mip", "antialias=split", "shadows=1",
          "occlusion=1",         "style=hatch",         "ink=0.5",        "depth_cue=0.5", "step=1e-9",       "levels=nan",
          "preset=xray",         "transfer=boundaries", "opacity=0:2",    "colors=0:none", "widgets=disc",    "opacity_by=v",
          "widgets=paint 1 0,0", "component=5",         "transfer=none",  "clip=1",        "unit=inf"})
      asked.push_back({fmt::format("method={}", method), more});
  asked.push_back({"shadows=1", "mode=maximum"});
  asked.push_back({"opacity_by=f", "color_by=c"});
  asked.push_back({"opacity_by=f", "second=gradient"});
  asked.push_back({"second_opacity=0:1"});
  asked.push_back({"opacity=0:1", "widgets=triangle 0 1 0 1 1 red"});
  asked.push_back({"antialias=mip", "kernel=sinc"});
  size_t refused = 0;
  for (const DatasetPtr& data : meshes)
    for (const auto& words : asked)
      for (const char* field : {"field=f", "field=v"}) {
        std::vector<std::string> all = words;
        all.insert(all.begin(), field);
        const std::string text = refusal(data, all, words.back() != "mode=composite");  // some methods have parallel projections only
        refused += !text.empty();
        INFO(data->kind(), " ", fmt::format("{}", fmt::join(all, " ")), ": ", text);
        CHECK(unknown_words(text) == "");
      }
  CHECK(refused > 500);
}
