// SPDX-License-Identifier: Apache-2.0
// What the material libraries of OBJ files say, and the pictures that they name.
#include <cmath>

#include "data/fields/material_table.h"
#include "image/codec.h"
#include "image/image.h"
#include "io/io_files.h"

using namespace sg;
using namespace sg::test;
using doctest::Approx;

namespace {

const std::string square_with_coordinates = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

void write_png(const std::string& name) {
  const std::vector<uint8_t> bytes = encode_png(Image(2, 2, 3));
  temp_file(name, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::shared_ptr<const MaterialTable> table(const std::string& library, std::vector<std::string>* warnings = nullptr) {
  temp_file("looks.mtl", library);
  Context context;
  context.on_log = [&](LogLevel level, std::string_view text) {
    if (level == LogLevel::warning && warnings) warnings->emplace_back(text);
  };
  const std::string path =
      temp_file("looks.obj", "mtllib looks.mtl\n" + square_with_coordinates + "usemtl wood\nf 1/1 2/2 3/3\nusemtl glass\nf 1/1 3/3 4/4\n");
  return std::get<DatasetPtr>(read_data(path, {}, context))->fields().require("MaterialIds").materials;
}

}  // namespace

TEST_CASE("obj materials: colours, pictures with their options, highlights and what is seen through") {
  write_png("oak wood.png");
  const auto t = table(
      "newmtl wood\nKd 0.5 1 0\nNs 30\nmap_Kd -s 2 3 1 -o 0.5 -clamp on oak wood.png\n\nnewmtl glass\nd 0.25\nNi 1.5\nPm 1\nPr 0.125\nKe 2 "
      "0 0\n");
  REQUIRE(t);
  REQUIRE(t->looks.size() == 2);
  const MaterialLook& wood = t->looks.begin()->second;
  CHECK(wood.base_color.x == Approx(srgb_decode(0.5f)));
  CHECK(wood.roughness == Approx(std::pow(2.0 / 32, 0.25)));
  CHECK(wood.metallic == 0);
  REQUIRE(wood.base_picture.file);
  CHECK(wood.base_picture.file->name == "oak wood.png");
  CHECK(wood.base_picture.place == std::array<double, 6>{2, 0, 0.5, 0, 3, 0});
  CHECK(wood.base_picture.beyond_u == MaterialPicture::Beyond::clamp);
  const MaterialLook& glass = t->looks.rbegin()->second;
  CHECK(glass.opacity == 0.25f);
  CHECK(glass.alpha == MaterialLook::Alpha::blend);
  CHECK(glass.metallic == 1);
  CHECK(glass.roughness == 0.125f);
  CHECK(glass.emission == Vec3f(2, 0, 0));
}

TEST_CASE("obj materials: black under a picture means the picture; one that cannot be read is said to be left out") {
  write_png("a.png");
  CHECK(table("newmtl wood\nKd 0 0 0\nmap_Kd a.png\n")->looks.begin()->second.base_color == Vec3f(1, 1, 1));
  std::vector<std::string> warnings;
  for (const char* name : {"missing.png", "../../../etc/passwd", "-s 1 2"}) {
    const auto t = table(std::string("newmtl wood\nKd 0.5\nmap_Kd ") + name + "\n", &warnings);
    CHECK_FALSE(t->looks.begin()->second.base_picture.file);
  }
  CHECK(warnings.size() == 3);
  CHECK(table("newmtl wood\nd x\nNs nan\nmap_Kd\nKe 1e99\n")->looks.begin()->second.opacity == 1);
}

TEST_CASE("obj materials: pictures of light, roughness, metal and normals") {
  write_png("a.png");
  const auto t =
      table("newmtl wood\nmap_Ke a.png\nmap_Pr a.png\nPr 0.5\nmap_Pm a.png\nnorm -clamp on a.png\nnewmtl glass\nmap_Pr missing.png\n");
  const MaterialLook& wood = t->looks.begin()->second;
  CHECK(wood.emission_picture.file);
  CHECK(wood.emission == Vec3f(1, 1, 1));
  REQUIRE(wood.factors.size() == 2);
  CHECK(wood.factors[0].channels[0].factor == MaterialFactor::roughness);
  CHECK(wood.factors[1].channels[0].factor == MaterialFactor::metalness);
  CHECK(wood.roughness == 0.5f);
  REQUIRE(wood.normal_picture.file);
  CHECK(wood.normal_picture.beyond_u == MaterialPicture::Beyond::clamp);
  CHECK(t->looks.rbegin()->second.factors.empty());
}
