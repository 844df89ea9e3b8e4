// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "io/mesh/mesh_robust.h"
#include "io_files.h"

using namespace sg;
using OrderedJson = nlohmann::ordered_json;

namespace {

template <class T>
void put(std::string& s, std::initializer_list<T> values) {
  for (T v : values) s.append(reinterpret_cast<const char*>(&v), sizeof v);
}

std::string glb(OrderedJson json, const std::string& binary) {
  json["asset"]["version"] = "2.0";
  json["buffers"] = {{{"byteLength", binary.size()}}};
  std::string text = json.dump(), padded = binary;
  while (text.size() % 4) text += ' ';
  while (padded.size() % 4) padded += '\0';
  std::string s = "glTF";
  put<uint32_t>(s, {2, uint32_t(28 + text.size() + padded.size()), uint32_t(text.size()), 0x4e4f534a});
  s += text;
  put<uint32_t>(s, {uint32_t(padded.size()), 0x004e4942});
  return s + padded;
}

// Four corners of a unit square in the plane z = 0 with a normal and a colour each, interleaved; then indices as bytes.
std::string square_bytes() {
  std::string s;
  for (int k = 0; k < 4; ++k) {
    put<float>(s, {float(k == 1 || k == 2), float(k >= 2), 0, 0, 0, 1});
    put<uint8_t>(s, {uint8_t(85 * k), 0, 255, 255});
  }
  put<uint8_t>(s, {0, 1, 2, 0, 2, 3, 0, 0});
  return s;
}

OrderedJson square(int mode = 4, int indices = 6) {
  OrderedJson j;
  j["bufferViews"] = {{{"buffer", 0}, {"byteLength", 112}, {"byteStride", 28}}, {{"buffer", 0}, {"byteOffset", 112}, {"byteLength", 8}}};
  j["accessors"] = {{{"bufferView", 0}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
                    {{"bufferView", 0}, {"byteOffset", 12}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
                    {{"bufferView", 0}, {"byteOffset", 24}, {"componentType", 5121}, {"normalized", true}, {"count", 4}, {"type", "VEC4"}},
                    {{"bufferView", 1}, {"componentType", 5121}, {"count", indices}, {"type", "SCALAR"}}};
  j["meshes"] = {
      {{"primitives", {{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"COLOR_0", 2}, {"_LOAD", 2}}}, {"indices", 3}, {"mode", mode}}}}}};
  j["nodes"] = {{{"mesh", 0}}};
  j["scenes"] = {{{"nodes", {0}}}};
  return j;
}

DatasetPtr read(const OrderedJson& j, const std::string& bytes = square_bytes()) { return test::read_text("a.glb", glb(j, bytes)); }
std::string refusal(const OrderedJson& j, const std::string& bytes = square_bytes()) { return test::refusal("bad.glb", glb(j, bytes)); }

}  // namespace

TEST_CASE("gltf: interleaved positions, normals and normalized colours") {
  const DatasetPtr d = read(square());
  const auto& m = *d->as<SurfaceMesh>();
  CHECK(d->point_count() == 4);
  CHECK(m.polygons.size() == 2);
  CHECK(m.points.at(2) == Vec3(1, 1, 0));
  CHECK(d->fields().require("NORMAL").array.get(3, 2) == 1);
  CHECK(d->fields().require("NORMAL").role == Role::normals);
  CHECK(d->fields().require("COLOR_0").array.type() == ElementType::u8);
  CHECK(d->fields().require("COLOR_0").array.get(2, 0) == 170);
  CHECK(d->fields().require("LOAD").array.get(2, 0) == doctest::Approx(170 / 255.0));
}

TEST_CASE("gltf: points, lines, loops, strips and fans") {
  const std::pair<int, int> cells[] = {{0, 4}, {1, 2}, {2, 1}, {3, 1}, {4, 1}, {5, 1}, {6, 2}};
  for (const auto& [mode, count] : cells) {
    CAPTURE(mode);
    const DatasetPtr d = read(square(mode, mode == 4 ? 3 : 4));
    const auto& m = *d->as<SurfaceMesh>();
    CHECK(d->cell_count() == size_t(count));
    if (mode == 2) CHECK(m.lines.connectivity.count() == 5);
    if (mode == 5) CHECK(m.strips.size() == 1);
    if (mode == 6) CHECK(m.polygons.fixed == 3);
  }
  OrderedJson j = square();
  j["meshes"][0]["primitives"][0].erase("indices");
  j["meshes"][0]["primitives"][0]["mode"] = 6;
  CHECK(read(j)->cell_count() == 2);
}

TEST_CASE("gltf: indices of 16 and 32 bits") {
  for (const int bytes : {2, 4}) {
    std::string b = square_bytes().substr(0, 112);
    for (uint32_t i : {3u, 2u, 1u}) b.append(reinterpret_cast<const char*>(&i), size_t(bytes));
    OrderedJson j = square(4, 3);
    j["accessors"][3]["componentType"] = bytes == 2 ? 5123 : 5125;
    j["bufferViews"][1]["byteLength"] = 3 * bytes;
    CHECK(read(j, b)->as<SurfaceMesh>()->polygons.connectivity.get(0) == 3);
  }
}

TEST_CASE("gltf: nodes move points and turn normals, as matrices and as translation, rotation and scale") {
  OrderedJson j = square();
  const double h = std::sqrt(0.5);
  // A quarter turn about x takes z to -y; then twice as large along x; the parent lifts by 10.
  j["nodes"] = {{{"children", {1}}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 10, 1}}},
                {{"mesh", 0}, {"rotation", {h, 0, 0, h}}, {"scale", {2, 1, 1}}, {"translation", {1, 0, 0}}}};
  const DatasetPtr d = read(j);
  const auto& m = *d->as<SurfaceMesh>();
  CHECK(length(m.points.at(2) - Vec3(3, 0, 11)) < 1e-6);
  const Array n = d->fields().require("NORMAL").array;
  CHECK(std::abs(n.get(0, 1) + 1) < 1e-6);
  CHECK(std::abs(n.get(0, 2)) < 1e-6);
}

TEST_CASE("gltf: normals stay at right angles under a slanting scale, and mirrored triangles are turned back") {
  // The plane x + z = 0 squeezed along z by 4: normals are (1, 0, 4) of the squeezed plane.
  OrderedJson j = square();
  std::string b;
  for (int k = 0; k < 4; ++k) {
    put<float>(b, {float(k == 1 || k == 2), float(k >= 2), -float(k == 1 || k == 2), float(std::sqrt(0.5)), 0, float(std::sqrt(0.5))});
    put<uint32_t>(b, {0});
  }
  b += square_bytes().substr(112);
  j["nodes"][0]["scale"] = {1, 1, -0.25};
  const DatasetPtr d = read(j, b);
  const auto& m = *d->as<SurfaceMesh>();
  const Array n = d->fields().require("NORMAL").array;
  const Vec3 normal(n.get(0, 0), n.get(0, 1), n.get(0, 2));
  CHECK(std::abs(dot(normal, m.points.at(1) - m.points.at(0))) < 1e-6);
  CHECK(std::abs(length(normal) - 1) < 1e-6);
  CHECK(normal.z < 0);  // it goes with the mirror
  const Array ids = m.polygons.connectivity;
  const auto at = [&](size_t k) { return m.points.at(size_t(ids.get(k))); };
  CHECK(dot(cross(at(1) - at(0), at(2) - at(0)), normal) > 0);
}

TEST_CASE("gltf: sparse accessors replace single values, also of zeros") {
  OrderedJson j = square();
  std::string b = square_bytes();
  put<uint16_t>(b, {1, 3});
  put<float>(b, {5, 6, 7, 8, 9, 10});
  j["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 120}, {"byteLength", 4}});
  j["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 124}, {"byteLength", 24}});
  j["accessors"][0]["sparse"] = {{"count", 2}, {"indices", {{"bufferView", 2}, {"componentType", 5123}}}, {"values", {{"bufferView", 3}}}};
  CHECK(read(j, b)->as<SurfaceMesh>()->points.at(3) == Vec3(8, 9, 10));
  CHECK(read(j, b)->as<SurfaceMesh>()->points.at(2) == Vec3(1, 1, 0));
  j["accessors"][0].erase("bufferView");
  CHECK(read(j, b)->as<SurfaceMesh>()->points.at(2) == Vec3(0, 0, 0));
  CHECK(read(j, b)->as<SurfaceMesh>()->points.at(1) == Vec3(5, 6, 7));
  j["accessors"][0]["count"] = 2000000000;
  CHECK(test::contains(refusal(j, b), "without a bufferView"));
  j["accessors"][0]["count"] = 3;
  CHECK(test::contains(refusal(j, b), "sparse value 3 of 3"));
}

TEST_CASE("gltf: buffers lie in the file, in data: URIs and in files beside it") {
  OrderedJson j = square();
  j["asset"]["version"] = "2.0";
  j["buffers"] = {{{"byteLength", 120}, {"uri", "corners%20of%20it.bin"}}};
  test::temp_file("corners of it.bin", square_bytes());
  CHECK(test::read_text("beside.gltf", j.dump())->as<SurfaceMesh>()->points.at(2) == Vec3(1, 1, 0));
  j["buffers"][0]["uri"] = "/etc/hostname";
  CHECK(test::contains(test::refusal("beside.gltf", j.dump()), "beside"));
  j["buffers"][0]["uri"] = "nowhere.bin";
  CHECK(test::contains(test::refusal("beside.gltf", j.dump()), "nowhere.bin"));
  j["buffers"][0]["uri"] = "data:application/octet-stream;base64,AAAA";
  CHECK(test::contains(test::refusal("beside.gltf", j.dump()), "has 3 bytes"));
  j["buffers"][0]["uri"] = "data:application/octet-stream;base64,A*AA";
  CHECK(test::contains(test::refusal("beside.gltf", j.dump()), "not base64"));
}

TEST_CASE("gltf: several primitives make a collection with names") {
  OrderedJson j = square();
  j["meshes"][0]["primitives"].push_back(j["meshes"][0]["primitives"][0]);
  j["meshes"][0]["name"] = "plate";
  j["materials"] = {{{"name", "steel"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 0, 1}}}}}};
  j["meshes"][0]["primitives"][1]["material"] = 0;
  j["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}}};
  j["scenes"] = {{{"nodes", {0, 1}}}};
  const Data data = test::read_bytes("two.glb", glb(j, square_bytes()));
  const auto& parts = std::get<CollectionPtr>(data)->parts;
  REQUIRE(parts.size() == 4);
  CHECK(parts[0].name.starts_with("plate 0"));
  CHECK(parts[0].name != parts[2].name);
  const auto& steel = *std::get<DatasetPtr>(parts[1].data);
  CHECK(steel.notes()[0].second == "steel");
  CHECK(steel.fields().require("BaseColorMultiplier").array.get(0, 1) == 0.25);
}

TEST_CASE("gltf: the base colour of a material is that of its cells, as sRGB, where points have none") {
  OrderedJson j = square();
  j["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0.2158605, 0, 1}}}}}};
  j["meshes"][0]["primitives"][0]["material"] = 0;
  CHECK(!read(j)->fields().find("BaseColor"));
  j["meshes"][0]["primitives"][0]["attributes"].erase("COLOR_0");
  const DatasetPtr colored = read(j);
  const Field& c = colored->fields().require("BaseColor", Association::cell);
  CHECK(c.role == Role::colors);
  CHECK(c.array.count() == 2);
  CHECK(c.array.get(1, 0) == 255);
  CHECK(c.array.get(1, 1) == 128);  // half of full scale, encoded
  CHECK(c.array.get(1, 2) == 0);
  j["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0.5};
  CHECK(!read(j)->fields().find("BaseColor"));
}

TEST_CASE("gltf: materials are labels with names, of one numbering for all parts") {
  OrderedJson j = square();
  const OrderedJson one = j["meshes"][0]["primitives"][0];
  j["materials"] = {{{"name", "steel"}}, {{"name", "glass"}}, OrderedJson::object()};
  j["meshes"][0]["primitives"] = OrderedJson::array();
  for (const int material : {1, 0, 2, 1}) {
    OrderedJson p = one;
    p["material"] = material;
    j["meshes"][0]["primitives"].push_back(p);
  }
  const auto parts_of = [&] {
    std::vector<DatasetPtr> parts;
    for_each_dataset(test::read_bytes("many.glb", glb(j, square_bytes())),
                     [&](const std::string&, const DatasetPtr& d) { parts.push_back(d); });
    return parts;
  };
  const auto names_of = [](const DatasetPtr& d) {
    for (const auto& [key, text] : d->notes())
      if (key == "labels of MaterialIds") return text;
    return std::string();
  };
  const double numbers[] = {2, 1, 3, 2};
  auto parts = parts_of();
  REQUIRE(parts.size() == 4);
  for (size_t k = 0; k < 4; ++k) {
    const Field& f = parts[k]->fields().require("MaterialIds", Association::cell);
    CHECK(f.role == Role::labels);
    REQUIRE(f.array.count() == parts[k]->cell_count());
    CHECK(f.array.get(0) == numbers[k]);
    CHECK(f.array.get(1) == numbers[k]);
    CHECK(names_of(parts[k]) == "1=steel\n2=glass\n3=material 2");
  }
  j["meshes"][0]["primitives"][3].erase("material");
  parts = parts_of();
  CHECK(parts[3]->fields().require("MaterialIds").array.get(0) == 0);
  CHECK(names_of(parts[0]) == "0=no material\n1=steel\n2=glass\n3=material 2");
  // Very many or long names stay with their own parts.
  j["materials"][0]["name"] = std::string(20000, 'x');
  parts = parts_of();
  CHECK(names_of(parts[0]) == "0=no material\n2=glass");
  // A strip is one cell; a file without materials has no such field.
  j = square(5, 4);
  CHECK(!read(j)->fields().find("MaterialIds"));
  j["materials"] = {{{"name", "steel"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 0, 1}}}}}};
  j["meshes"][0]["primitives"][0]["material"] = 0;
  j["meshes"][0]["primitives"][0]["attributes"].erase("COLOR_0");
  CHECK(read(j)->fields().require("MaterialIds").array.count() == read(j)->cell_count());
  CHECK(read(j)->fields().require("BaseColor").array.count() == read(j)->cell_count());
}

TEST_CASE("gltf: what is wrong is named") {
  auto with = [](auto change) {
    OrderedJson j = square();
    change(j);
    return refusal(j);
  };
  using test::contains;
  CHECK(contains(with([](OrderedJson& j) { j["extensionsRequired"] = {"KHR_draco_mesh_compression"}; }), "KHR_draco_mesh_compression"));
  CHECK(contains(with([](OrderedJson& j) { j["extensionsRequired"] = {"EXT_meshopt_compression"}; }), "EXT_meshopt_compression"));
  CHECK(contains(with([](OrderedJson& j) {
                   j["accessors"][0].erase("bufferView");
                   j["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = OrderedJson::object();
                 }),
                 "KHR_draco_mesh_compression"));
  CHECK(contains(with([](OrderedJson& j) { j["nodes"][0]["children"] = {0}; }), "its own ancestor"));
  CHECK(contains(with([](OrderedJson& j) { j["nodes"][0]["children"] = {7}; }), "'children' is 7"));
  CHECK(contains(with([](OrderedJson& j) { j["accessors"][0]["count"] = 5; }), "accessor 0"));
  CHECK(contains(with([](OrderedJson& j) { j["accessors"][0]["count"] = uint64_t(1) << 63; }), "2^31 points"));
  CHECK(contains(with([](OrderedJson& j) { j["accessors"][0]["count"] = -1; }), "'count'"));
  CHECK(contains(with([](OrderedJson& j) { j["accessors"][3]["count"] = 5; }), "not a multiple of 3"));
  CHECK(contains(with([](OrderedJson& j) { j["accessors"][1]["count"] = 3; }), "'NORMAL' has 3 values for 4 points"));
  CHECK(contains(with([](OrderedJson& j) { j["accessors"][0]["type"] = "VEC5"; }), "VEC5"));
  CHECK(contains(with([](OrderedJson& j) { j["accessors"][0]["componentType"] = 1; }), "componentType"));
  CHECK(contains(with([](OrderedJson& j) { j["bufferViews"][0]["byteLength"] = 121; }), "bufferView 0"));
  CHECK(contains(with([](OrderedJson& j) { j["bufferViews"][0]["byteOffset"] = UINT64_MAX; }), "bufferView 0"));
  CHECK(contains(with([](OrderedJson& j) { j["bufferViews"][0]["byteStride"] = UINT64_MAX; }), "accessor 0"));
  CHECK(contains(with([](OrderedJson& j) { j["meshes"][0]["primitives"][0]["indices"] = 9; }), "'indices' is 9"));
  CHECK(contains(with([](OrderedJson& j) { j["meshes"][0]["primitives"][0]["mode"] = 7; }), "'mode' is 7"));
  CHECK(contains(with([](OrderedJson& j) { j["nodes"][0].erase("mesh"); }), "no node"));
  CHECK(contains(with([](OrderedJson& j) { j["nodes"][0]["rotation"] = {0, 0, 0, 0}; }), "rotation"));
  std::string far = square_bytes();
  far[112] = 4;
  CHECK(contains(refusal(square(), far), "index 4"));
  CHECK(contains(test::refusal("one.gltf", R"({"asset":{"version":"1.0"}})"), "glTF 1.0"));
  CHECK(contains(test::refusal("deep.gltf", std::string(100000, '[')), "nested"));
  OrderedJson chain = square();
  chain["nodes"] = OrderedJson::array();
  for (int i = 0; i < 5000; ++i) chain["nodes"].push_back({{"children", {i + 1}}});
  chain["nodes"].push_back({{"mesh", 0}});
  CHECK(contains(refusal(chain), "nested more than 1000"));
}

TEST_CASE("gltf: cut and damaged files are read or refused") {
  test::check_survives("robust.glb", glb(square(), square_bytes()));
  OrderedJson j = square();
  j["asset"]["version"] = "2.0";
  j["buffers"] = {{{"byteLength", 3}, {"uri", "data:;base64,AAAA"}}};
  const std::string text = j.dump();
  CHECK(test::cut_and_damage("robust.gltf", text) == 63);
}

TEST_CASE("gltf: what is written is read again, as .glb and .gltf, and from any number of threads") {
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5, 0.5, 2}, 3);
  m.points.origin = {100, 0, 0};
  m.vertices = {Array::from_vector(std::vector<int32_t>{4}), {}, 1};
  m.lines = {Array::from_vector(std::vector<int32_t>{0, 1, 2}), {}, 3};
  m.polygons = {Array::from_vector(std::vector<int32_t>{0, 1, 2, 3}), {}, 4};
  FieldSet fields;
  fields.add({"heat", Association::point, Array::from_vector(std::vector<double>{1, 2, 3, 4, 5.5}), "", Role::none});
  fields.add({"Normals", Association::point, Array::from_vector(std::vector<float>(15, 0.5f), 3), "", Role::normals});
  fields.add({"RGB", Association::point, Array::from_vector(std::vector<uint8_t>(15, 77), 3), "", Role::colors});
  fields.add({"six", Association::point, Array::from_vector(std::vector<int16_t>(30, -3), 6), "", Role::none});
  const DatasetPtr d = make_dataset(m, fields);
  for (const std::string name : {"w.glb", "w.gltf"}) {
    CAPTURE(name);
    Context context;
    write_data(test::temp_folder() + name, d, {}, context);
    const Data back = read_data(test::temp_folder() + name, {}, context);
    const auto& parts = std::get<CollectionPtr>(back)->parts;
    REQUIRE(parts.size() == 3);
    const auto& t = *std::get<DatasetPtr>(parts[0].data);
    CHECK(t.as<SurfaceMesh>()->polygons.size() == 2);
    CHECK(t.as<SurfaceMesh>()->points.at(4) == Vec3(100.5, 0.5, 2));
    CHECK(t.fields().require("heat").array.get(4) == 5.5);
    CHECK(t.fields().require("NORMAL").array.get(1, 1) == 0.5);
    CHECK(t.fields().require("COLOR_0").array.components() == 3);
    CHECK(t.fields().require("COLOR_0").array.get(4, 2) == 77);
    CHECK(t.fields().require("six_5").array.get(4) == -3);
    CHECK(std::get<DatasetPtr>(parts[1].data)->as<SurfaceMesh>()->lines.size() == 2);
    CHECK(std::get<DatasetPtr>(parts[2].data)->as<SurfaceMesh>()->vertices.size() == 1);
  }
  PointCloud cloud;
  cloud.points = m.points;
  Context context;
  write_data(test::temp_folder() + "cloud.glb", make_dataset(cloud), {}, context);
  CHECK(test::read_file(test::temp_folder() + "cloud.glb")->cell_count() == 5);
  CHECK(test::contains(test::error_of([&] { write_data(test::temp_folder() + "g.glb", make_dataset(UniformGrid{}), {}, context); }),
                       "surface"));
}

TEST_CASE("gltf: the files of the data folder agree with the manifest" * doctest::skip(test::no_data())) {
  const MappedFile manifest(test::data_file("manifest.json"));
  size_t files = 0;
  std::function<void(const OrderedJson&, std::vector<OrderedJson>&)> leaves = [&](const OrderedJson& block,
                                                                                  std::vector<OrderedJson>& found) {
    if (block["class"] == "vtkPolyData") found.push_back(block);
    else
      for (const OrderedJson& b : block["blocks"]) leaves(b, found);
  };
  const OrderedJson all = OrderedJson::parse(manifest.text());
  for (const OrderedJson& entry : all["datasets"]) {
    const std::string path = entry["path"];
    if (!path.ends_with(".glb")) continue;
    CAPTURE(path);
    ++files;
    std::vector<OrderedJson> wanted;
    leaves(entry["vtk"]["data"], wanted);
    Context context;
    std::vector<DatasetPtr> have;
    for_each_dataset(read_data(test::data_file(path), {}, context), [&](const std::string&, const DatasetPtr& d) { have.push_back(d); });
    REQUIRE(have.size() == wanted.size());
    for (size_t i = 0; i < have.size(); ++i) {
      // Parts may come in another order; each is told by its points, and the two wheels by their places.
      const OrderedJson* w = nullptr;
      for (const OrderedJson& k : wanted)
        if (k["points"] == have[i]->point_count() && std::abs(k["bounds"][0].get<double>() - have[i]->bounds().lo.x) < 1e-4) w = &k;
      REQUIRE(w != nullptr);
      CHECK((*w)["cells"] == have[i]->cell_count());
      CHECK((*w)["cell_types"]["Triangle"] == have[i]->cell_count());
      for (int a = 0; a < 3; ++a) {
        CHECK(have[i]->bounds().lo[a] == doctest::Approx((*w)["bounds"][size_t(2 * a)].get<double>()).epsilon(1e-6));
        CHECK(have[i]->bounds().hi[a] == doctest::Approx((*w)["bounds"][size_t(2 * a + 1)].get<double>()).epsilon(1e-6));
      }
      for (const OrderedJson& f : (*w)["point_data"]) {
        const Field& field = have[i]->fields().require(f["name"].get<std::string>(), Association::point);
        CHECK(field.components() == f["components"].get<int>());
        CHECK(field.array.type() == ElementType::f32);
        if (field.name != "NORMAL") CHECK(have[i]->range(field, 0).hi == doctest::Approx(f["range"][0][1].get<double>()));
        else CHECK(have[i]->range(field, -1).lo == doctest::Approx(1));
      }
    }
  }
  CHECK(files == 3);
}
