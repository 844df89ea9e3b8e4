// SPDX-License-Identifier: Apache-2.0
// GeoJSON: geometries as cells, properties as fields, and bad input.
#include <fmt/core.h>

#include "data/fields/axis_notes.h"
#include "io/io_files.h"

using namespace sg;
using namespace test;

namespace {

std::string feature(const std::string& geometry, const std::string& properties = "null", const std::string& more = "") {
  return R"({"type":"Feature","geometry":)" + geometry + R"(,"properties":)" + properties + more + "}";
}
std::string collection(const std::string& features, const std::string& more = "") {
  return R"({"type":"FeatureCollection")" + more + R"(,"features":[)" + features + "]}";
}

const std::string square = R"({"type":"Polygon","coordinates":[[[0,0],[4,0],[4,4],[0,4],[0,0]]]})";
const std::string frame = R"({"type":"Polygon","coordinates":[[[10,0],[14,0],[14,4],[10,4],[10,0]],[[11,1],[11,3],[13,3],[13,1],[11,1]]]})";
const std::string path_of_three = R"({"type":"LineString","coordinates":[[0,0],[1,1],[1,1],[2,0]]})";
const std::string spot = R"({"type":"Point","coordinates":[7,8,120.5]})";

double area_of(const DatasetPtr& d) {
  const SurfaceMesh& s = surface_of(d);
  const CellsView c = cells_view(s.polygons);
  double twice = 0;
  for (size_t i = 0; i < c.count; ++i)
    for (size_t k = 0; k < c.size(i); ++k) {
      const Vec3 a = s.points.at(size_t(c.point(i, k))), b = s.points.at(size_t(c.point(i, (k + 1) % c.size(i))));
      twice += a.x * b.y - a.y * b.x;
    }
  return twice / 2;
}

std::string note_of(const DatasetPtr& d, const std::string& name) {
  for (const auto& [key, text] : d->notes())
    if (key == name) return text;
  return "";
}

}  // namespace

TEST_CASE("GeoJSON: points, lines and polygons are one surface in degrees, holes stay open") {
  const DatasetPtr d = read_text(
      "a.geojson",
      collection(feature(square) + "," + feature(spot) + "," + feature(frame) + "," + feature(path_of_three), R"(,"name":"all")"));
  const SurfaceMesh& s = surface_of(d);
  CHECK(s.vertices.size() == 1);
  CHECK(s.lines.size() == 1);
  CHECK(cells_view(s.lines).size(0) == 3);
  CHECK(s.polygons.size() == 1 + 8);
  CHECK(area_of(d) == 16 + 16 - 4);
  CHECK(s.points.count() == 4 + 1 + 8 + 3);
  CHECK(d->bounds().hi == Vec3(14, 8, 0));
  const auto x = axis_note(*d, 0), y = axis_note(*d, 1);
  REQUIRE(x);
  CHECK(x->title() == "longitude [degrees east]");
  REQUIRE(y);
  CHECK(y->in_degrees());
  CHECK(note_of(d, "title") == "all");
  CHECK(note_of(d, "features") == "4");
  // Vertices, lines, polygons: in this order.
  const Field& of = d->fields().require("feature", Association::cell);
  CHECK(of.array.get(0) == 1);
  CHECK(of.array.get(1) == 3);
  CHECK(of.array.get(2) == 0);
  CHECK(of.array.get(10) == 2);
  const Field& height = d->fields().require("altitude", Association::point);
  CHECK(height.unit == "m");
  CHECK(height.array.get(4) == 120.5);
  CHECK(std::isnan(height.array.get(0)));
}

TEST_CASE("GeoJSON: properties are numbers or words with names, and what is missing says so") {
  const DatasetPtr d = read_text(
      "a.geojson",
      collection(feature(square, R"({"n":3,"v":1.5,"kind":"wood","code":"007","q":"12","on":true,"deep":{"a":1}})", R"(,"id":"A")") + "," +
                 feature(frame, R"({"n":-4,"kind":"field","code":"11","q":"-2.5","on":false})", R"(,"id":"B")") + "," +
                 feature(path_of_three, R"({"n":5,"v":null,"code":"11","q":"0"})")));
  const auto at = [&](const char* name, size_t cell) { return d->fields().require(name, Association::cell).array.get(cell); };
  REQUIRE(d->cell_count() == 10);
  CHECK(d->fields().require("n").array.type() == ElementType::i32);
  CHECK(at("n", 0) == 5);
  CHECK(at("n", 1) == 3);
  CHECK(at("n", 9) == -4);
  CHECK(std::isnan(at("v", 0)));
  CHECK(at("v", 1) == 1.5);
  CHECK(at("q", 2) == -2.5);
  CHECK(std::isnan(at("on", 0)));
  CHECK(at("on", 1) == 1);
  CHECK(d->fields().require("kind").role == Role::labels);
  CHECK(note_of(d, "labels of kind") == "0=(no value)\n1=field\n2=wood");
  CHECK(at("kind", 0) == 0);
  CHECK(at("kind", 1) == 2);
  CHECK(at("kind", 9) == 1);
  CHECK(note_of(d, "labels of code") == "0=007\n1=11");
  CHECK(note_of(d, "labels of id") == "0=(no value)\n1=A\n2=B");
  CHECK_FALSE(d->fields().find("deep"));
  ReadOptions one;
  one.fields = {"v"};
  CHECK(read_text("a.geojson", collection(feature(square, R"({"n":3,"v":1.5})")), one)->fields().names() == std::vector<std::string>{"v"});
  check_names_alone(temp_file("b.geojson", collection(feature(square, R"({"n":3,"kind":"wood"})"))));
}

TEST_CASE("GeoJSON: points alone are a cloud; bare geometries, collections of geometries and null") {
  const DatasetPtr cloud =
      read_text("a.geojson", collection(feature(spot, R"({"m":2.5})") + "," +
                                        feature(R"({"type":"MultiPoint","coordinates":[[1,2],[3,4]]})", R"({"m":4})") + "," +
                                        feature("null", R"({"m":9})") + "," + feature(R"({"type":"Point","coordinates":[]})")));
  REQUIRE(cloud->as<PointCloud>());
  CHECK(cloud->point_count() == 3);
  CHECK(cloud->fields().require("m", Association::point).array.get(2) == 4);
  CHECK(surface_of(read_text("a.geojson", square)).polygons.size() == 1);
  CHECK(surface_of(read_text("a.geojson", feature(path_of_three))).lines.size() == 1);
  const DatasetPtr many =
      read_text("a.geojson", R"({"type":"GeometryCollection","geometries":[)" + square + "," +
                                 R"({"type":"MultiLineString","coordinates":[[[0,0],[1,1]],[[2,2],[3,3]]]},)" +
                                 R"({"type":"MultiPolygon","coordinates":[[[[0,0],[1,0],[0,1],[0,0]]],[[[5,5],[6,5],[5,6]]]]}]})");
  CHECK(surface_of(many).lines.size() == 2);
  CHECK(surface_of(many).polygons.size() == 3);
  CHECK(area_of(many) == 17);
}

TEST_CASE("GeoJSON: the content decides, whatever the name and the order of the members") {
  const std::string text = collection(feature(square, R"({"n":1})"));
  CHECK(find_format(temp_file("a.json", text), {}).name == "GeoJSON");
  CHECK(find_format(temp_file("a.json", R"({"features":[{"geometry":)" + square + R"(,"type":"Feature"}],"type":"FeatureCollection"})"), {})
            .name == "GeoJSON");
  CHECK(find_format(temp_file("a.geojson", R"({"x":")" + std::string(5000, 'x') + R"(","type":"FeatureCollection","features":[]})"), {})
            .name == "GeoJSON");
  CHECK(find_format(temp_file("a.json", R"([{"type":"Point","x":1}])"), {}).name == "JSON table");
  CHECK(find_format(temp_file("a.json", R"({"a":[{"type":"Point"}]})"), {}).name == "JSON table");
  CHECK(read_text("a.geojson", "\xef\xbb\xbf  " + text)->cell_count() == 1);
}

TEST_CASE("GeoJSON: lengths are no degrees, and heights among them are coordinates") {
  const std::string metres = R"({"type":"LineString","coordinates":[[500000,10,3],[500010,20,4]]})";
  const DatasetPtr d = read_text("a.geojson", metres);
  CHECK_FALSE(axis_note(*d, 0));
  CHECK(d->bounds().hi == Vec3(500010, 20, 4));
  const std::string crs = R"(,"crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::25832"}})";
  const DatasetPtr named = read_text("a.geojson", collection(feature(square), crs));
  CHECK_FALSE(axis_note(*named, 0));
  CHECK(note_of(named, "coordinates") == "urn:ogc:def:crs:EPSG::25832");
}

TEST_CASE("GeoJSON: errors say which feature is wrong") {
  CHECK(contains(refusal("a.geojson", collection(feature(square) + "," + feature(R"({"type":"LineString","coordinates":[[0,0],[1]]})"))),
                 "feature 1: '[1]' is no position"));
  CHECK(contains(refusal("a.geojson", feature(R"({"type":"Circle","coordinates":[0,0]})")), "'Circle'"));
  CHECK(contains(refusal("a.geojson", feature(R"({"type":"Polygon","coordinates":[7]})")), "no list of positions"));
  CHECK(contains(refusal("a.geojson", R"({"type":"Topology","objects":{}})"), "'Topology'"));
  CHECK(contains(refusal("a.geojson", collection("")), "no feature with a geometry"));
  std::string nested = square;
  for (int i = 0; i < 12; ++i) nested = R"({"type":"GeometryCollection","geometries":[)" + nested + "]}";
  CHECK(contains(refusal("a.geojson", nested), "nested more than 8 deep"));
  // Lines of one point and rings of two are left out, wherever the others are kept.
  CHECK(surface_of(read_text("a.geojson", collection(feature(square) + "," + feature(R"({"type":"LineString","coordinates":[[0,0]]})"))))
            .lines.size() == 0);
  const std::string whole =
      collection(feature(square, R"({"n":3,"kind":"wood"})") + "," + feature(frame, R"({"n":4,"kind":"x"})") + "," + feature(spot));
  CHECK(cut_and_damage("a.geojson", whole) == 63);
}

TEST_CASE("GeoJSON: many names of properties in many features do not fill the memory") {
  std::string features;
  for (int i = 0; i < 20000; ++i)
    features += (i ? "," : "") + feature(R"({"type":"Point","coordinates":[1,2]})", fmt::format(R"({{"p{}":1}})", i));
  CHECK(contains(refusal("a.geojson", collection(features)), "memory"));
}
