// SPDX-License-Identifier: Apache-2.0
// Every NRRD, MetaImage, raw, STL, PLY and OBJ file of the data folder against what other readers say of it.
#include <nlohmann/json.hpp>

#include "base/file/file.h"
#include "data/lattice.h"
#include "io/io.h"
#include "support/test.h"

using namespace sg;
using Json = nlohmann::json;

namespace {

bool is_ours(const std::string& path) {
  const std::string e = extension_of(path);
  for (const char* ours : {"nrrd", "nhdr", "mhd", "mha", "raw", "stl", "ply", "obj"})
    if (e == ours) return true;
  return false;
}

const Json& manifest() {
  static const Json m = Json::parse(MappedFile(test::data_file("manifest.json")).text());
  return m;
}

DatasetPtr read_one(const std::string& path, ReadOptions options = {}) {
  Context context;
  return std::get<DatasetPtr>(read_data(test::data_file(path), options, context));
}

void check_arrays(const Dataset& d, const Json& arrays, Association association) {
  for (const Json& a : arrays) {
    if (a["tuples"] == 0) continue;  // VTK reports empty arrays for cells that are no polygons
    const std::string name = a["name"];
    CAPTURE(name);
    const Field* f = d.fields().find(name, association);
    REQUIRE(f != nullptr);
    ElementType type = ElementType::u8;
    REQUIRE(parse_element_type(a["type"].get<std::string>(), type));
    CHECK(element_name(f->array.type()) == element_name(type));
    CHECK(f->components() == a["components"].get<int>());
    CHECK(f->array.count() == a["tuples"].get<size_t>());
    const auto& ranges = a["range"];
    for (size_t c = 0; c < ranges.size(); ++c) {
      const Range r = d.range(*f, int(c));
      CHECK(r.lo == doctest::Approx(ranges[c][0].get<double>()).epsilon(1e-12));
      CHECK(r.hi == doctest::Approx(ranges[c][1].get<double>()).epsilon(1e-12));
    }
  }
}

void check_vtk(const Dataset& d, const Json& vtk) {
  CHECK(d.point_count() == vtk["points"].get<size_t>());
  CHECK(d.cell_count() == vtk["cells"].get<size_t>());
  if (vtk.contains("cell_types")) {
    size_t kinds = 0;
    for (const auto& [name, count] : cell_type_counts(d.mesh())) {
      CHECK(vtk["cell_types"].value(std::string(name), size_t(0)) == count);
      ++kinds;
    }
    CHECK(kinds == vtk["cell_types"].size());
  }
  const auto* grid = d.as<UniformGrid>();
  if (grid) {
    for (size_t a = 0; a < 3; ++a) {
      CHECK(grid->dims[a] == vtk["dimensions"][a].get<size_t>());
      if (grid->dims[a] > 1) CHECK(grid->spacing[int(a)] == doctest::Approx(vtk["spacing"][a].get<double>()).epsilon(1e-9));
      CHECK(grid->origin[int(a)] == doctest::Approx(vtk["origin"][a].get<double>()));
    }
  }
  // VTK reads no directions, so bounds agree where the axes are not turned.
  if (vtk.contains("bounds") && (!grid || grid->direction == Mat3{})) {
    for (int a = 0; a < 3; ++a) {
      CHECK(d.bounds().lo[a] == doctest::Approx(vtk["bounds"][size_t(2 * a)].get<double>()).epsilon(1e-9));
      CHECK(d.bounds().hi[a] == doctest::Approx(vtk["bounds"][size_t(2 * a + 1)].get<double>()).epsilon(1e-9));
    }
  }
  check_arrays(d, vtk["point_data"], Association::point);
  check_arrays(d, vtk["cell_data"], Association::cell);
}

void check_truth(const Dataset& d, const Json& truth) {
  if (truth.contains("values_read")) {
    const Field& f = d.fields()[0];
    CHECK(f.array.count() * size_t(f.components()) == truth["values_read"].get<size_t>());
    Range all;
    double sum = 0;
    for (int c = 0; c < f.components(); ++c) {
      all.add(d.range(f, c));
      for (size_t i = 0; i < f.array.count(); ++i) sum += f.array.get(i, c);
    }
    CHECK(all.lo == doctest::Approx(truth["range"][0].get<double>()).epsilon(1e-12));
    CHECK(all.hi == doctest::Approx(truth["range"][1].get<double>()).epsilon(1e-12));
    CHECK(sum / double(f.array.count() * size_t(f.components())) == doctest::Approx(truth["mean"].get<double>()).epsilon(1e-9));
  }
  if (truth.contains("statements")) {
    const Json& s = truth["statements"];
    if (!s.contains("vt") && !s.contains("vn")) CHECK(d.point_count() == s["v"].get<size_t>());
    CHECK(d.cell_count() == s.value("f", size_t(0)) + s.value("l", size_t(0)) + s.value("p", size_t(0)));
  }
  if (truth.contains("elements"))
    for (const Json& e : truth["elements"]) {
      if (e["name"] == "vertex") CHECK(d.point_count() == e["count"].get<size_t>());
      if (e["name"] == "face") CHECK(d.cell_count() == e["count"].get<size_t>());
    }
}

}  // namespace

TEST_CASE("files: every NRRD, MetaImage, STL, PLY and OBJ file agrees with the manifest" * doctest::skip(test::no_data())) {
  size_t read = 0, refused = 0;
  for (const Json& set : manifest()["datasets"]) {
    const std::string path = set["path"];
    if (!is_ours(path) || extension_of(path) == "raw") continue;
    CAPTURE(path);
    if (set["expect"] == "malformed") {
      const std::string message = test::error_of([&] { read_one(path); });
      CAPTURE(message);
      CHECK(message.find("line ") != std::string::npos);
      ++refused;
      continue;
    }
    const std::string use = set["use"];
    DatasetPtr d;
    try {
      d = read_one(path);
    } catch (const Error& e) {
      FAIL_CHECK(e.what());
      continue;
    }
    if ((use == "vtk" || use == "both") && set.contains("vtk") && set["vtk"].contains("data")) check_vtk(*d, set["vtk"]["data"]);
    if (use != "vtk" && set.contains("truth")) check_truth(*d, set["truth"]);
    if (set.contains("other_files_vtk"))
      for (const auto& [name, vtk] : set["other_files_vtk"].items())
        if (is_ours(name)) check_vtk(*read_one(folder_of(path) + name), vtk["data"]);
    ++read;
  }
  CHECK(read >= 45);
  CHECK(refused == 5);
}

TEST_CASE("files: the raw brick agrees with the manifest" * doctest::skip(test::no_data())) {
  for (const Json& set : manifest()["datasets"]) {
    const std::string path = set["path"];
    if (extension_of(path) != "raw" || !set.contains("truth")) continue;
    CAPTURE(path);
    const Json& t = set["truth"];
    ReadOptions o;
    for (size_t a = 0; a < 3; ++a) o.raw_dims[a] = t["assumed"]["shape_xyz"][a];
    REQUIRE(t["assumed"]["type"] == "<i2");
    o.raw_type = "i16";
    const DatasetPtr d = read_one(path, o);
    const Range r = d->range(d->fields()[0]);
    CHECK(r.lo == t["range"][0].get<double>());
    CHECK(r.hi == t["range"][1].get<double>());
  }
}

TEST_CASE("files: details that the manifest does not tell" * doctest::skip(test::no_data())) {
  SUBCASE("the direction of FullHead's axes is kept") {
    const auto d = read_one("volumes/fullhead/FullHead.mhd");
    const auto* g = d->as<UniformGrid>();
    REQUIRE(g);
    CHECK(g->direction.m[0][0] == -1);
    CHECK(g->direction.m[1][1] == 1);
    CHECK(g->direction.m[2][2] == -1);
    CHECK(d->bounds().lo.x == -239.0625);
  }
  SUBCASE("one material has one number") {
    const auto d = read_one("surfaces/cornell_box/cornell_box.obj");
    const Field& m = d->fields().require("MaterialIds");
    std::string names;
    for (const auto& [k, v] : d->notes())
      if (k == "MaterialNames") names = v;
    CHECK(names == "0 white\n2 light\n3 blue\n4 green\n5 red");
    int white = 0;
    for (size_t i = 0; i < m.array.count(); ++i) white += m.array.get(i) == 0;
    CHECK(white == 15);
  }
  SUBCASE("raw numbers are mapped, not copied") {
    const auto d = read_one("volumes/fullhead/FullHead.mhd");
    CHECK(reinterpret_cast<uintptr_t>(d->fields()[0].array.raw()) % 4096 == 0);
  }
  SUBCASE("PLY texture coordinates and face properties are read where VTK does not") {
    const auto d = read_one("edge-cases/ply/multi.ply");
    const Field* t = d->fields().with_role(Role::tcoords);
    REQUIRE(t);
    CHECK(t->array.get(2, 0) == 1);
    CHECK(t->array.get(2, 1) == 1);
    const auto m = read_one("edge-cases/ply/metadata.ply");
    CHECK(m->fields().require("face_type", Association::cell).array.get(1) == 90);
  }
  SUBCASE("OBJ vertex colours") {
    const auto d = read_one("edge-cases/obj/cube-vertexcol.obj");
    const Field& c = d->fields().require("RGB");
    CHECK(c.array.get(3, 0) == 0);
    CHECK(c.array.get(3, 2) == 255);
  }
}
