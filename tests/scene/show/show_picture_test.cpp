// SPDX-License-Identifier: Apache-2.0
// Pictures and materials of the data's own on a surface: which items a scene gets of them.
#include <filesystem>

#include "base/file/file.h"
#include "image/codec.h"
#include "scene/choose/own_materials.h"
#include "scene/items/surface_pictures.h"
#include "scene/show/show.h"
#include "scene/show/surface.h"
#include "support/test.h"

using namespace sg;
using doctest::Approx;

namespace {

/// Two squares side by side.
DatasetParts squares(bool coordinates = true) {
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 2, 0, 0, 2, 1, 0}, 3);
  m.polygons.connectivity = Array::from_vector(std::vector<int32_t>{0, 1, 2, 3, 1, 4, 5, 2}), m.polygons.fixed = 4;
  DatasetParts parts;
  parts.mesh = m;
  if (coordinates)
    parts.fields.add(
        {"uv", Association::point, Array::from_vector(std::vector<float>{0, 0, 1, 0, 1, 1, 0, 1, 2, 0, 2, 1}, 2), "", Role::tcoords});
  return parts;
}

std::vector<uint8_t> png(int grey) {
  Image image(2, 2, 1);
  std::fill(image.pixels.begin(), image.pixels.end(), uint8_t(grey));
  return encode_png(image);
}

MaterialPicture picture_of(const std::vector<uint8_t>& bytes) {
  auto kept = std::make_shared<std::vector<uint8_t>>(bytes);
  auto file = std::make_shared<PictureFile>();
  file->name = "inside", file->owner = kept, file->bytes = std::as_bytes(std::span(*kept));
  MaterialPicture p;
  p.file = file;
  return p;
}

DatasetPtr with_materials(std::vector<int32_t> numbers, MaterialTable table, bool coordinates = true) {
  DatasetParts parts = squares(coordinates);
  parts.fields.add({"MaterialIds",
                    Association::cell,
                    Array::from_vector(std::move(numbers)),
                    "",
                    Role::labels,
                    {},
                    std::make_shared<const MaterialTable>(std::move(table))});
  return make_dataset(parts);
}

struct Shown {
  Scene scene;
  std::optional<Legend> legend;
  std::vector<std::string> warnings;
  const SurfaceItem& item(size_t i) const { return std::get<SurfaceItem>(scene.items.at(i)); }
};
Shown shown(const DatasetPtr& d, const std::vector<std::string>& words) {
  Shown s;
  Context context;
  context.on_log = [&](LogLevel level, std::string_view text) {
    if (level == LogLevel::warning) s.warnings.emplace_back(text);
  };
  s.legend = add_show(s.scene, "surface", d, words, context);
  return s;
}
std::string refusal(const DatasetPtr& d, const std::vector<std::string>& words) {
  return test::error_of([&] { shown(d, words); });
}

std::string file_of(int grey, const char* name) {
  const std::string path = (std::filesystem::temp_directory_path() / name).string();
  const auto bytes = png(grey);
  write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  return path;
}

}  // namespace

TEST_CASE("show picture: a file on the surface, by the data's texture coordinates or those that are named") {
  const std::string path = file_of(188, "sg_show_picture.png");
  DatasetParts parts = squares();
  Field other = parts.fields.require("uv");
  other.name = "other", other.role = Role::none;
  parts.fields.add(other);
  const DatasetPtr d = make_dataset(parts);
  const Shown a = shown(d, {"picture=" + path});
  REQUIRE(a.scene.items.size() == 1);
  REQUIRE(a.item(0).pictures);
  CHECK(a.item(0).pictures->color->coordinates == "uv");
  CHECK(a.item(0).pictures->color->texture->levels()[0].at(0, 0).x == Approx(srgb_decode(188 / 255.f)));
  CHECK(a.item(0).color == Vec3f(1, 1, 1));
  CHECK_FALSE(a.item(0).color_by);
  CHECK_FALSE(a.legend);
  const Shown b = shown(d, {"picture=" + path, "picture_coordinates=other", "picture_repeats=2,3", "picture_wrap=mirror",
                            "picture_filter=nearest", "picture_encoding=linear", "color=#ff0000"});
  const SurfacePicture& p = *b.item(0).pictures->color;
  CHECK(p.coordinates == "other");
  CHECK(p.place == std::array<double, 6>{2, 0, 0, 0, 3, 0});
  CHECK(p.lookup.wrap_u == TextureWrap::mirror);
  CHECK(p.lookup.filter == TextureFilter::nearest);
  CHECK(p.texture->levels()[0].at(0, 0).x == Approx(188 / 255.0));
  CHECK(b.item(0).color == Vec3f(1, 0, 0));
  // Decoded once, and again when the file is another.
  CHECK(shown(d, {"picture=" + path}).item(0).pictures->color->texture == a.item(0).pictures->color->texture);
  file_of(0, "sg_show_picture.png");
  std::filesystem::last_write_time(path, std::filesystem::file_time_type::clock::now() + std::chrono::seconds(5));
  CHECK(shown(d, {"picture=" + path}).item(0).pictures->color->texture->levels()[0].at(0, 0).x == 0);
  std::filesystem::remove(path);
}

TEST_CASE("show picture: pictures of normals and of the material lie on a surface that a field colours") {
  const std::string path = file_of(128, "sg_show_normals.png");
  DatasetParts parts = squares();
  parts.fields.add({"t", Association::point, Array::from_vector(std::vector<float>{0, 1, 2, 3, 4, 5}), "", Role::scalars});
  const DatasetPtr d = make_dataset(parts);
  const Shown s = shown(
      d, {"field=t", "normal_picture=" + path, "normal_scale=-2", "material_picture=" + path, "picture_repeats=3", "base_metalness=0.5"});
  const SurfaceItem& item = s.item(0);
  CHECK(item.color_by->field == "t");
  REQUIRE(item.pictures);
  CHECK_FALSE(item.pictures->color);
  CHECK(item.pictures->normal->texture->levels()[0].at(0, 0).x == Approx(128 / 255.0));  // numbers, not a screen's colours
  CHECK(item.pictures->normal->place == std::array<double, 6>{3, 0, 0, 0, 3, 0});
  CHECK(item.pictures->normal_scale == -2);
  REQUIRE(item.pictures->factors.size() == 1);
  CHECK(item.pictures->factors[0].channels.size() == 2);
  CHECK(item.made_of->specular_roughness == 1);  // not stated: the picture alone decides
  CHECK(item.made_of->base_metalness == 0.5);
  CHECK(shown(d, {"normal_picture=" + path}).item(0).color_by->field == "t");
  CHECK(refusal(d, {"normal_picture=" + path, "style=points"}).find("solid") != std::string::npos);
  CHECK(refusal(d, {"isolines=5", "style=wireframe"}).find("solid") != std::string::npos);
  std::filesystem::remove(path);
}

TEST_CASE("show picture: what cannot be is told with what would be right") {
  const DatasetPtr d = make_dataset(squares()), bare = make_dataset(squares(false));
  CHECK(refusal(bare, {"pattern=checker"}).find("texture_coordinates") != std::string::npos);
  CHECK(refusal(d, {"pattern=checker", "picture_coordinates=nothing"}).find("nothing") != std::string::npos);
  CHECK(refusal(d, {"picture=/nowhere/wood.png"}).find("wood.png") != std::string::npos);
  CHECK(refusal(d, {"picture=a.png", "pattern=noise"}).find("both") != std::string::npos);
  CHECK(refusal(d, {"pattern=noise", "field=uv"}).find("both") != std::string::npos);
  CHECK(refusal(d, {"pattern=noise", "style=wireframe"}).find("solid") != std::string::npos);
  CHECK(refusal(d, {"pattern=noise", "picture_repeats=0"}).find("picture_repeats") != std::string::npos);
  CHECK(refusal(d, {"pattern=wood"}).find("checker") != std::string::npos);
}

TEST_CASE("show picture: patterns multiply the surface's colour") {
  const Shown s = shown(make_dataset(squares()), {"pattern=checker", "color=#808080"});
  const SurfacePicture& p = *s.item(0).pictures->color;
  CHECK(p.lookup.sharp);
  CHECK(p.texture->levels()[0].at(0, 0) == Vec4f{1, 1, 1, 1});
  CHECK(s.item(0).color.x == Approx(128 / 255.0));
}

TEST_CASE("own materials: each has an item of its polygons, with its picture and what it is made of") {
  MaterialTable table;
  MaterialLook& wood = table.looks[1];
  wood.base_picture = picture_of(png(255)), wood.base_color = {0.5f, 0.25f, 1}, wood.metallic = 0.25f, wood.roughness = 0.75f;
  MaterialLook& glass = table.looks[2];
  glass.opacity = 0.5f, glass.alpha = MaterialLook::Alpha::blend, glass.metallic = 0;
  const DatasetPtr d = with_materials({2, 1}, table);
  CHECK(has_own_materials(*d));
  const Shown s = shown(d, {});
  REQUIRE(s.scene.items.size() == 2);
  CHECK(s.warnings.empty());
  CHECK_FALSE(s.legend);
  const SurfaceItem &a = s.item(0), &b = s.item(1);
  CHECK(a.data->cell_count() == 1);
  CHECK(a.data->as<SurfaceMesh>()->polygons.connectivity.get(1) == 4);  // the second square
  CHECK(a.pictures->color->texture->width() == 2);
  CHECK(a.color.y == Approx(srgb_encode(0.25f)));
  CHECK(a.made_of->base_metalness == 0.25);
  CHECK(a.made_of->specular_roughness == 0.75);
  CHECK(b.data->as<SurfaceMesh>()->polygons.connectivity.get(1) == 1);
  CHECK_FALSE(b.pictures);
  CHECK(b.opacity == 0.5);
  // Where they meet they are smooth, as one surface.
  CHECK(a.part_of == b.part_of);
  CHECK(a.part_of->cell_count() == 2);
  // Parts and textures are kept with the data.
  CHECK(shown(d, {}).item(0).data == a.data);
  CHECK(shown(d, {}).item(0).pictures->color->texture == a.pictures->color->texture);
}

TEST_CASE("own materials: holes by the alpha of a picture; more materials than are drawn by themselves") {
  MaterialTable table;
  MaterialLook& leaf = table.looks[1];
  leaf.base_picture = picture_of(png(255)), leaf.alpha = MaterialLook::Alpha::mask, leaf.alpha_cutoff = 0.25f, leaf.opacity = 0.5f;
  const Shown s = shown(with_materials({1, 1}, table), {});
  REQUIRE(s.scene.items.size() == 1);
  CHECK(s.item(0).pictures->alpha == SurfacePictures::Alpha::cutout);
  CHECK(s.item(0).pictures->cutoff == 0.5f);  // of the picture's alpha, half of which counts
  CHECK(s.item(0).opacity == 1);
  CHECK_FALSE(s.item(0).part_of);

  DatasetParts many = squares();
  std::vector<int32_t> corners, numbers;
  for (int32_t i = 0; i < 257; ++i) corners.insert(corners.end(), {0, 1, 2, 3}), numbers.push_back(i);
  SurfaceMesh mesh = std::get<SurfaceMesh>(many.mesh);
  mesh.polygons.connectivity = Array::from_vector(std::move(corners));
  many.mesh = mesh;
  many.fields.add({"MaterialIds",
                   Association::cell,
                   Array::from_vector(std::move(numbers)),
                   "",
                   Role::labels,
                   {},
                   std::make_shared<const MaterialTable>(table)});
  const Shown all = shown(make_dataset(many), {});
  CHECK(all.scene.items.size() == 1);
  REQUIRE(all.warnings.size() == 1);
  CHECK(all.warnings[0].find("257 materials") != std::string::npos);
}

TEST_CASE("own materials: they give way to what is stated, and can be switched off") {
  MaterialTable table;
  table.looks[1].base_picture = picture_of(png(255));
  const DatasetPtr d = with_materials({1, 2}, table);
  CHECK(shown(d, {"color=red"}).scene.items.size() == 1);
  CHECK(shown(d, {"field=MaterialIds"}).item(0).color_by->field == "MaterialIds");
  const Shown off = shown(d, {"own_materials=false"});
  CHECK(off.scene.items.size() == 1);
  CHECK_FALSE(off.item(0).pictures);
  CHECK(off.item(0).color_by->field == "MaterialIds");
  // Colours alone are told by a field as well.
  MaterialTable plain;
  plain.looks[1].base_color = {1, 0, 0};
  CHECK_FALSE(has_own_materials(*with_materials({1, 1}, plain)));
}

TEST_CASE("own materials: pictures without coordinates, and damaged ones, are left out and said to be") {
  MaterialTable table;
  table.looks[1].base_picture = picture_of(png(255)), table.looks[1].base_color = {1, 0, 0};
  const Shown bare = shown(with_materials({1, 1}, table, false), {});
  REQUIRE(bare.scene.items.size() == 1);
  CHECK_FALSE(bare.item(0).pictures);
  CHECK(bare.item(0).color == Vec3f(1, 0, 0));
  REQUIRE(bare.warnings.size() == 1);
  CHECK(bare.warnings[0].find("coordinates") != std::string::npos);
  std::vector<uint8_t> cut = png(255);
  cut.resize(50);
  table.looks[1].base_picture = picture_of(cut);
  const Shown damaged = shown(with_materials({1, 1}, table), {});
  CHECK_FALSE(damaged.item(0).pictures);
  REQUIRE(damaged.warnings.size() == 1);
  CHECK(damaged.warnings[0].find("inside") != std::string::npos);
}

TEST_CASE("show picture: every number of a material may be a picture's, and what it shines with") {
  const std::string path = file_of(128, "sg_show_numbers.png");
  const DatasetPtr d = make_dataset(squares());
  using enum MaterialFactor;
  struct Word {
    std::string name;
    MaterialFactor factor;
    bool color;
  };
  for (const Word& w :
       {Word{"specular_roughness", roughness, false}, Word{"specular_weight", specular, false}, Word{"specular_ior", ior, false},
        Word{"base_metalness", metalness, false}, Word{"transmission_weight", transmission, false},
        Word{"transmission_color", transmission_color, true}, Word{"subsurface_weight", subsurface, false},
        Word{"subsurface_radius", subsurface_radius, false}, Word{"subsurface_anisotropy", subsurface_anisotropy, false},
        Word{"coat_weight", coat, false}, Word{"coat_roughness", coat_roughness, false}, Word{"coat_ior", coat_ior, false},
        Word{"coat_color", coat_color, true}, Word{"retro_weight", retro, false}}) {
    CAPTURE(w.name);
    const Shown s = shown(d, {w.name + "_picture=" + path, "picture_repeats=3", "picture_wrap=mirror"});
    REQUIRE(s.item(0).pictures->factors.size() == 1);
    const SurfaceFactors& f = s.item(0).pictures->factors[0];
    CHECK(f.channels[0].factor == w.factor);
    CHECK(f.picture.place == std::array<double, 6>{3, 0, 0, 0, 3, 0});
    CHECK(f.picture.lookup.wrap_u == TextureWrap::mirror);
    // Numbers, but of colours a screen's.
    const double grey = w.color ? double(srgb_decode(128 / 255.f)) : 128 / 255.0;
    CHECK(f.picture.texture->levels()[0].at(0, 0).x == Approx(grey));
    CHECK(refusal(d, {w.name + "_picture=" + path, "style=points"}).find("solid") != std::string::npos);
    CHECK(refusal(d, {w.name + "_picture=/no/such.png"}).find("such.png") != std::string::npos);
  }
  const Shown lamp = shown(d, {"emission_picture=" + path});
  CHECK(lamp.item(0).made_of->emission == Vec3(1, 1, 1));
  CHECK(lamp.item(0).pictures->emission->texture->levels()[0].at(0, 0).x == Approx(srgb_decode(128 / 255.f)));
  CHECK(refusal(d, {"emission_picture=" + path, "emission_by=t"}).find("leave one out") != std::string::npos);
  // What is not stated is the picture's alone; an index of refraction stays the largest.
  CHECK(shown(d, {"coat_weight_picture=" + path}).item(0).made_of->coat_weight == 1);
  CHECK(shown(d, {"material=diamond", "specular_ior_picture=" + path}).item(0).made_of->specular_ior == 2.417);
  std::filesystem::remove(path);
}
