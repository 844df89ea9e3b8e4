// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/telling_field.h"

#include "scene/choose/scale.h"

#include "scene/choose/coloring.h"
#include "support/test.h"

using namespace sg;

namespace {

// 4 x 4 x 2 points, 1 apart.
DatasetParts box() {
  DatasetParts p;
  UniformGrid g;
  g.dims = {4, 4, 2};
  p.mesh = g;
  return p;
}
template <class T>
Field of(const std::string& name, T (*f)(int)) {
  std::vector<T> v;
  for (int i = 0; i < 32; ++i) v.push_back(f(i));
  return {name, Association::point, Array::from_vector(v), "", Role::none};
}
Telling telling_of(const Field& f) {
  DatasetParts p = box();
  p.fields.add(f);
  const DatasetPtr d = make_dataset(p);
  return telling(*d, d->fields()[0]);
}
double wave(int i) { return std::sin(double(i)); }
int parts(int i) { return i / 8; }

}  // namespace

TEST_CASE("telling fields: quantities, divisions, numberings and nothing") {
  for (const char* name : {"temperature", "fluid", "Mach number", "refractive index", "solid", "grid", "w", "x"})
    CHECK_MESSAGE(telling_of(of<double>(name, wave)) == Telling::values, name);
  for (const char* name : {"block", "Material_Type", "vtkBlock", "PartNumber2"}) {
    const Telling t = telling_of(of<int>(name, parts));
    CHECK_MESSAGE((t == Telling::divisions || t == Telling::numbering), name);
  }
  CHECK(telling_of(of<int>("block", parts)) == Telling::divisions);
  for (const char* name : {"rank", "GlobalNodeId", "vtkGhostType", "IBlank", "procid", "block_number", "cellids"})
    CHECK_MESSAGE(telling_of(of<int>(name, parts)) == Telling::numbering, name);
  CHECK(telling_of(of<int>("any", [](int i) { return 5 + i; })) == Telling::numbering);  // the ramp of an image
  CHECK(telling_of(of<uint8_t>("inside", [](int i) { return uint8_t(i % 3 == 0); })) == Telling::numbering);
  CHECK(telling_of(of<double>("constant", [](int) { return 3.5; })) == Telling::nothing);
  CHECK(telling_of(of<double>("nearly", [](int i) { return 1e5 * (1 + 1e-15 * (i % 3)); })) == Telling::nothing);
  // x is a coordinate where its values are.
  CHECK(telling_of(of<double>("x", [](int i) { return double(i % 4); })) == Telling::numbering);
  CHECK(telling_of(of<double>("pressure", [](int i) { return double(i % 4); })) == Telling::values);
}

TEST_CASE("telling fields: numbers of materials are labels in whatever type they are stored, and however large they are") {
  const auto large = of<double>("material_id", [](int i) { return i < 16 ? 1.0 : 4.5e8; });
  CHECK(telling_of(large) == Telling::numbering);
  CHECK(names_numbers(large));
  CHECK_FALSE(names_numbers(of<double>("material_id", wave)));
  CHECK_FALSE(names_numbers(of<double>("solid", [](int i) { return double(i % 3); })));
  CHECK(names_numbers(of<int>("material", parts)));
  DatasetParts p;
  UniformGrid g;
  g.dims = {4, 4, 2};
  p.mesh = g;
  p.fields.add(large);
  CHECK(looks_like_labels(*make_dataset(std::move(p)), large));
}

TEST_CASE("telling fields: ids of groups give no colour, however they are stored, unless the file names them") {
  CHECK(telling_of(of<float>("GroupIds", [](int i) { return float(i / 8); })) == Telling::ids);
  CHECK(telling_of(of<int>("group_id", parts)) == Telling::ids);
  CHECK(telling_of(of<double>("surfaceId", [](int i) { return 1e4 * (i / 4); })) == Telling::numbering);
  CHECK(telling_of(of<int>("surfaceId", parts)) == Telling::numbering);
  // More numbers than a legend can name.
  DatasetParts many;
  UniformGrid g;
  g.dims = {1000, 1, 1};
  many.mesh = g;
  std::vector<int32_t> surfaces;
  for (int i = 0; i < 1000; ++i) surfaces.push_back(3 * (i / 10));
  many.fields.add({"surfaceId", Association::point, Array::from_vector(std::move(surfaces)), "", Role::none});
  const DatasetPtr d = make_dataset(std::move(many));
  CHECK(telling(*d, d->fields()[0]) == Telling::ids);
  // A value is none, whatever its name ends in.
  CHECK(telling_of(of<double>("GroupIds", wave)) != Telling::ids);
  CHECK(telling_of(of<double>("fluid", [](int i) { return 10.0 * (i / 4); })) == Telling::values);
  Field named = of<int>("GroupIds", parts);
  named.role = Role::labels;
  CHECK(telling_of(named) == Telling::numbering);
  DatasetParts p = box();
  p.fields.add(of<float>("GroupIds", [](int i) { return float(i / 8); }));
  CHECK(automatic_field(*make_dataset(p)) == nullptr);
}

TEST_CASE("telling fields: an id for each of many points gives no colour, even where there is nothing else") {
  DatasetParts p;
  UniformGrid g;
  g.dims = {100, 1, 1};
  p.mesh = g;
  std::vector<int64_t> ids;
  for (int64_t i = 0; i < 100; ++i) ids.push_back(1000 + 37 * i % 100);  // in no order
  p.fields.add({"PointId", Association::point, Array::from_vector(ids), "", Role::none});
  const DatasetPtr d = make_dataset(p);
  CHECK(telling(*d, d->fields()[0]) == Telling::ids);
  CHECK(automatic_field(*d) == nullptr);
}

TEST_CASE("telling fields: rounding errors beside another field say nothing, alone they do") {
  const Field tiny = of<double>("w", [](int i) { return 1e-17 * std::cos(double(i)); });
  CHECK(telling_of(tiny) == Telling::values);
  DatasetParts p = box();
  p.fields.add(tiny);
  p.fields.add(of<double>("u", wave));
  const DatasetPtr d = make_dataset(p);
  CHECK(telling(*d, d->fields()[0]) == Telling::nothing);
  CHECK(automatic_field(*d)->name == "u");
}

TEST_CASE("telling fields: the picture's field is a quantity, then a division, then a numbering") {
  DatasetParts p = box();
  Field rank = of<int>("rank", parts);
  rank.role = Role::scalars;
  p.fields.add(rank);
  CHECK(automatic_field(*make_dataset(p))->name == "rank");
  p.fields.add(of<int>("material", parts));
  CHECK(automatic_field(*make_dataset(p))->name == "material");
  p.fields.add(of<double>("pressure", wave));
  CHECK(automatic_field(*make_dataset(p))->name == "pressure");
}
