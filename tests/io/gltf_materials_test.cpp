// SPDX-License-Identifier: Apache-2.0
// Materials of glTF and their pictures: in the file, in data: URIs, beside it; and what is damaged.
#include <cmath>
#include <nlohmann/json.hpp>

#include "data/fields/material_table.h"
#include "image/codec.h"
#include "io/gltf/gltf_bytes.h"
#include "io_files.h"

using namespace sg;
using doctest::Approx;
using OrderedJson = nlohmann::ordered_json;

namespace {

std::string png(int grey) {
  Image image(2, 3, 1);
  std::fill(image.pixels.begin(), image.pixels.end(), uint8_t(grey));
  const std::vector<uint8_t> bytes = encode_png(image);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A triangle with texture coordinates and one material; `picture` is in the buffer behind it.
OrderedJson triangle(const std::string& picture = png(7)) {
  const float numbers[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, /* uv */ 0, 0, 1, 0, 0, 1};
  std::string bytes(reinterpret_cast<const char*>(numbers), sizeof numbers);
  bytes += picture;
  OrderedJson j;
  j["asset"]["version"] = "2.0";
  j["buffers"] = {{{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + to_base64(bytes)}}};
  j["bufferViews"] = {{{"buffer", 0}, {"byteLength", 36}},
                      {{"buffer", 0}, {"byteOffset", 36}, {"byteLength", 24}},
                      {{"buffer", 0}, {"byteOffset", 60}, {"byteLength", picture.size()}}};
  j["accessors"] = {{{"bufferView", 0}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}},
                    {{"bufferView", 1}, {"componentType", 5126}, {"count", 3}, {"type", "VEC2"}}};
  j["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}, {"material", 0}}}}}};
  j["materials"] = {{{"name", "wood"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  j["textures"] = {{{"source", 0}}};
  j["images"] = {{{"bufferView", 2}, {"mimeType", "image/png"}}};
  return j;
}

struct Read {
  DatasetPtr data;
  std::vector<std::string> warnings;
  const MaterialLook& look() const { return data->fields().require("MaterialIds").materials->looks.at(1); }
};
Read read(const OrderedJson& j) {
  Read r;
  Context context;
  context.on_log = [&](LogLevel level, std::string_view text) {
    if (level == LogLevel::warning) r.warnings.emplace_back(text);
  };
  r.data = std::get<DatasetPtr>(read_data(test::temp_file("materials.gltf", j.dump()), {}, context));
  return r;
}
std::string text_of(const PictureFilePtr& file) {
  return file ? std::string(reinterpret_cast<const char*>(file->bytes.data()), file->bytes.size()) : "";
}

}  // namespace

TEST_CASE("gltf materials: a picture lies in the buffer, in a data: URI or beside the file") {
  CHECK(text_of(read(triangle()).look().base_picture.file) == png(7));
  OrderedJson j = triangle();
  j["images"][0] = {{"uri", "data:image/png;base64," + to_base64(png(9))}};
  CHECK(text_of(read(j).look().base_picture.file) == png(9));
  test::temp_file("wood grain.png", png(11));
  j["images"][0] = {{"uri", "wood%20grain.png"}};
  const Read beside = read(j);
  CHECK(text_of(beside.look().base_picture.file) == png(11));
  CHECK(beside.look().base_picture.coordinates == "TEXCOORD_0");
  CHECK(beside.warnings.empty());
}

TEST_CASE("gltf materials: factors, alpha and extensions") {
  OrderedJson j = triangle();
  const Read plain = read(j);
  CHECK(plain.look().metallic == 1);
  CHECK(plain.look().roughness == 1);
  CHECK_FALSE(plain.look().states_matter);
  CHECK(plain.look().alpha == MaterialLook::Alpha::opaque);
  j["materials"][0] = {
      {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 1, 0.5}}, {"metallicFactor", 0}, {"roughnessFactor", 0.25}}},
      {"alphaMode", "BLEND"},
      {"emissiveFactor", {1, 0.5, 0}},
      {"extensions",
       {{"KHR_materials_ior", {{"ior", 1.33}}},
        {"KHR_materials_transmission", {{"transmissionFactor", 0.75}}},
        {"KHR_materials_volume", {{"thicknessFactor", 1}, {"attenuationDistance", 2}, {"attenuationColor", {1, 0.5, 0.5}}}},
        {"KHR_materials_clearcoat", {{"clearcoatFactor", 0.5}, {"clearcoatRoughnessFactor", 0.125}}},
        {"KHR_materials_emissive_strength", {{"emissiveStrength", 10}}}}}};
  const MaterialLook l = read(j).look();
  CHECK(l.base_color == Vec3f(0.5f, 0.25f, 1));
  CHECK(l.opacity == 0.5f);
  CHECK(l.alpha == MaterialLook::Alpha::blend);
  CHECK(l.states_matter);
  CHECK(l.metallic == 0);
  CHECK(l.roughness == 0.25f);
  CHECK(l.emission == Vec3f(10, 5, 0));
  CHECK(l.ior == 1.33f);
  CHECK(l.transmission == 0.75f);
  CHECK_FALSE(l.thin);
  CHECK(l.attenuation_distance == 2);
  CHECK(l.coat == 0.5f);
  CHECK(l.coat_roughness == 0.125f);
  CHECK_FALSE(l.base_picture.file);
}

TEST_CASE("gltf materials: rows run downwards; transforms scale, turn and shift; samplers wrap") {
  OrderedJson j = triangle();
  const auto place = [&](double x, double y) {
    const auto p = read(j).look().base_picture.place;
    return Vec2{p[0] * x + p[1] * y + p[2], p[3] * x + p[4] * y + p[5]};
  };
  CHECK(place(0.25, 0) == Vec2{0.25, 1});
  CHECK(place(0.25, 1) == Vec2{0.25, 0});
  // The extension's own example: the lower left quadrant, turned by 90 degrees.
  j["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {
      {"offset", {0, 1}}, {"rotation", std::acos(-1) / 2}, {"scale", {0.5, 0.5}}};
  for (const double x : {0.0, 1.0})
    for (const double y : {0.0, 1.0}) {
      const Vec2 at = place(x, y);
      CHECK(at.x == Approx(0.5 * y));
      CHECK(at.y == Approx(0.5 * x));  // from below
    }
  j["textures"][0]["sampler"] = 0;
  j["samplers"] = {{{"wrapS", 33648}, {"wrapT", 33071}, {"magFilter", 9728}}};
  const MaterialPicture p = read(j).look().base_picture;
  CHECK(p.beyond_u == MaterialPicture::Beyond::mirror);
  CHECK(p.beyond_v == MaterialPicture::Beyond::clamp);
  CHECK(p.nearest);
}

TEST_CASE("gltf materials: what is damaged or missing leaves the shape, and is said") {
  const auto left_out = [](const OrderedJson& j) {
    const Read r = read(j);
    CHECK(r.data->cell_count() == 1);
    CHECK_FALSE(r.look().base_picture.file);
    return r.warnings.size();
  };
  OrderedJson j = triangle();
  j["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 5;
  CHECK(left_out(j) == 1);
  j["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", -1}};
  CHECK(left_out(j) == 1);
  j["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = "wood";
  CHECK(left_out(j) == 0);
  for (const OrderedJson& image :
       {OrderedJson{{"uri", "missing.png"}}, OrderedJson{{"uri", "../../../etc/passwd"}}, OrderedJson{{"uri", "http://x/y.png"}},
        OrderedJson{{"uri", "data:image/png;base64,(((("}}, OrderedJson{{"bufferView", 99}}, OrderedJson{{"bufferView", -1}},
        OrderedJson{{"mimeType", "image/png"}}}) {
    j = triangle();
    j["images"][0] = image;
    CHECK(left_out(j) == 1);
  }
  j = triangle();
  j["textures"] = 7, j["images"] = "x", j["samplers"] = nullptr;
  CHECK(left_out(j) == 1);
  // Numbers that are none keep their defaults.
  j = triangle();
  j["materials"][0] = {{"pbrMetallicRoughness", {{"metallicFactor", "much"}, {"roughnessFactor", 1e300}}},
                       {"emissiveFactor", {1, "a", 2}},
                       {"extensions", {{"KHR_materials_ior", 3}, {"KHR_materials_clearcoat", {{"clearcoatFactor", -5}}}}}};
  const MaterialLook l = read(j).look();
  CHECK(l.metallic == 1);
  CHECK(l.roughness == 1);
  CHECK(l.emission == Vec3f());
  CHECK(l.ior == 1.5f);
  CHECK(l.coat == 0);
}

TEST_CASE("gltf materials: pictures of numbers, of normals and of occlusion, with their channels and strengths") {
  OrderedJson j = triangle();
  const OrderedJson first = {{"index", 0}};
  j["materials"][0] = {
      {"pbrMetallicRoughness", {{"metallicRoughnessTexture", first}}},
      {"normalTexture", {{"index", 0}, {"scale", -2}}},
      {"occlusionTexture", {{"index", 0}, {"strength", 0.25}}},
      {"extensions",
       {{"KHR_materials_transmission", {{"transmissionFactor", 1}, {"transmissionTexture", first}}},
        {"KHR_materials_clearcoat", {{"clearcoatFactor", 1}, {"clearcoatTexture", first}, {"clearcoatRoughnessTexture", first}}}}}};
  const MaterialLook l = read(j).look();
  std::vector<std::pair<MaterialFactor, int>> channels;
  for (const FactorPicture& f : l.factors) {
    CHECK(text_of(f.picture.file) == png(7));
    for (const FactorChannel& c : f.channels) channels.emplace_back(c.factor, c.channel);
  }
  using enum MaterialFactor;
  CHECK(channels ==
        std::vector<std::pair<MaterialFactor, int>>{{roughness, 1}, {metalness, 2}, {transmission, 0}, {coat, 0}, {coat_roughness, 1}});
  CHECK(text_of(l.normal_picture.file) == png(7));
  CHECK(l.normal_scale == -2);
  CHECK(text_of(l.occlusion_picture.file) == png(7));
  CHECK(l.occlusion_strength == 0.25f);
}

TEST_CASE("gltf: texture coordinates of other files run upwards, and are turned round when they are written and read") {
  const DatasetPtr d = read(triangle()).data;
  const Field& from = d->fields().require("TEXCOORD_0");
  CHECK(from.array.get(2, 1) == 1);
  Context context;
  const std::string obj = test::temp_file("upwards.obj", ""), back = test::temp_file("back.glb", "");
  write_data(obj, read(triangle()).data, {}, context);
  const DatasetPtr upwards = std::get<DatasetPtr>(read_data(obj, {}, context));
  const Field& up = upwards->fields().require("TCoords");
  for (size_t i = 0; i < 3; ++i) {
    CHECK(up.array.get(i, 0) == from.array.get(i, 0));
    CHECK(up.array.get(i, 1) == 1 - from.array.get(i, 1));
  }
  write_data(back, upwards, {}, context);
  const DatasetPtr again = std::get<DatasetPtr>(read_data(back, {}, context));
  for (size_t i = 0; i < 3; ++i) CHECK(again->fields().require("TEXCOORD_0").array.get(i, 1) == from.array.get(i, 1));
  // A PLY file has the upward ones, too, under their usual name.
  const std::string ply = test::temp_file("upwards.ply", "");
  write_data(ply, read(triangle()).data, {}, context);
  CHECK(std::get<DatasetPtr>(read_data(ply, {}, context))->fields().require("TCoords").array.get(2, 1) == 0);
}

TEST_CASE("gltf materials: what is written is read again, with pictures, numbers and names") {
  OrderedJson j = triangle();
  const auto at = [](double x) {
    return OrderedJson{{"index", 0},
                       {"extensions", {{"KHR_texture_transform", {{"offset", {x, 0.25}}, {"rotation", 0.5}, {"scale", {2, -3}}}}}}};
  };
  const OrderedJson first = {{"index", 0}};
  j["samplers"] = {{{"wrapS", 33648}, {"wrapT", 33071}, {"magFilter", 9728}}};
  j["textures"][0]["sampler"] = 0;
  j["materials"][0] = {
      {"name", "wood"},
      {"pbrMetallicRoughness",
       {{"baseColorFactor", {0.5, 0.25, 1, 0.5}},
        {"baseColorTexture", at(0.125)},
        {"metallicFactor", 0.5},
        {"roughnessFactor", 0.25},
        {"metallicRoughnessTexture", first}}},
      {"alphaMode", "MASK"},
      {"alphaCutoff", 0.75},
      {"emissiveFactor", {1, 0.5, 0}},
      {"emissiveTexture", first},
      {"normalTexture", {{"index", 0}, {"scale", -2}}},
      {"occlusionTexture", {{"index", 0}, {"strength", 0.25}}},
      {"extensions",
       {{"KHR_materials_ior", {{"ior", 1.25}}},
        {"KHR_materials_transmission", {{"transmissionFactor", 0.75}, {"transmissionTexture", first}}},
        {"KHR_materials_volume", {{"thicknessFactor", 1}, {"attenuationDistance", 2}, {"attenuationColor", {1, 0.5, 0.5}}}},
        {"KHR_materials_clearcoat", {{"clearcoatFactor", 0.5}, {"clearcoatRoughnessFactor", 0.125}, {"clearcoatRoughnessTexture", first}}},
        {"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}}}}};
  const Read from = read(j);
  std::vector<std::string> said;
  Context context;
  context.on_log = [&](LogLevel, std::string_view text) { said.emplace_back(text); };
  const std::string path = test::temp_file("again.glb", "");
  write_data(path, from.data, {}, context);
  CHECK(said.empty());
  const DatasetPtr to = std::get<DatasetPtr>(read_data(path, {}, context));
  const MaterialLook &a = from.look(), &b = to->fields().require("MaterialIds").materials->looks.at(1);
  CHECK(b.base_color == a.base_color);
  CHECK(b.opacity == a.opacity);
  CHECK(b.alpha == a.alpha);
  CHECK(b.alpha_cutoff == a.alpha_cutoff);
  CHECK(b.metallic == a.metallic);
  CHECK(b.roughness == a.roughness);
  CHECK(b.emission == a.emission);
  CHECK(b.ior == a.ior);
  CHECK(b.transmission == a.transmission);
  CHECK(b.thin == a.thin);
  CHECK(b.attenuation_color == a.attenuation_color);
  CHECK(b.attenuation_distance == a.attenuation_distance);
  CHECK(b.coat == a.coat);
  CHECK(b.coat_roughness == a.coat_roughness);
  CHECK(b.normal_scale == a.normal_scale);
  CHECK(b.occlusion_strength == a.occlusion_strength);
  REQUIRE(b.factors.size() == a.factors.size());
  for (size_t i = 0; i < a.factors.size(); ++i)
    for (size_t k = 0; k < a.factors[i].channels.size(); ++k) CHECK(b.factors[i].channels[k].factor == a.factors[i].channels[k].factor);
  for (const auto& [p, q] : {std::pair{&a.base_picture, &b.base_picture},
                             {&a.emission_picture, &b.emission_picture},
                             {&a.normal_picture, &b.normal_picture},
                             {&a.occlusion_picture, &b.occlusion_picture}}) {
    CHECK(text_of(q->file) == png(7));
    CHECK(q->beyond_u == p->beyond_u);
    CHECK(q->beyond_v == p->beyond_v);
    CHECK(q->nearest == p->nearest);
    for (size_t i = 0; i < 6; ++i) CHECK(q->place[i] == Approx(p->place[i]).epsilon(1e-6));
  }
  // One picture, however often it is used.
  CHECK(a.base_picture.file != b.base_picture.file);
  CHECK(b.base_picture.file == b.normal_picture.file);
  bool named = false;
  for (const auto& [note, text] : to->notes()) named = named || test::contains(text, "1=wood");
  CHECK(named);
}

TEST_CASE("gltf materials: those of other files are written, turned round where these run upwards; what glTF cannot say is told") {
  test::temp_file("oak.png", png(200));
  test::temp_file("looks.mtl",
                  "newmtl wood\nKd 0.5 0.5 0.5\nmap_Kd -s 2 3 1 -o 0.25 0.5 oak.png\nmap_Pr oak.png\nnewmtl plain\nKd 1 0 0\n");
  const std::string obj = test::temp_file("upward_looks.obj",
                                          "mtllib looks.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                                          "usemtl wood\nf 1/1 2/2 3/3\nusemtl plain\nf 1/1 3/3 4/4\n"),
                    path = test::temp_file("upward_looks.glb", "");
  std::string said;
  Context context;
  context.on_log = [&](LogLevel, std::string_view text) { said += text; };
  write_data(path, read_data(obj, {}, context), {}, context);
  CHECK(test::contains(said, "of numbers of a material"));  // roughness in red
  CHECK_FALSE(test::contains(said, "MaterialIds"));
  const auto parts = std::get<CollectionPtr>(read_data(path, {}, context));
  REQUIRE(parts->parts.size() == 2);
  const auto& d = *std::get<DatasetPtr>(parts->parts[0].data);
  const Field& numbers = d.fields().require("MaterialIds");
  const MaterialLook& look = numbers.materials->looks.at(int64_t(numbers.array.get(0)));
  const auto& p = look.base_picture.place;
  const Field& uv = d.fields().require("TEXCOORD_0");
  const double places[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (size_t i = 0; i < 4; ++i) {
    const double s = uv.array.get(i, 0), t = uv.array.get(i, 1);
    CHECK(p[0] * s + p[1] * t + p[2] == Approx(2 * places[i][0] + 0.25).scale(1));
    CHECK(p[3] * s + p[4] * t + p[5] == Approx(3 * places[i][1] + 0.5).scale(1));
  }
}
