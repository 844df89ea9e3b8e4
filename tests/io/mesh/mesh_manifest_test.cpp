// SPDX-License-Identifier: Apache-2.0
// Every Gmsh, MFEM, GLVis, UCD, Tecplot, GAMBIT, nek5000 and OFF file of the data folder against what other readers say of it.
#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <set>

#include "base/file/file.h"
#include "data/fields/label_names.h"
#include "io/io.h"
#include "support/test.h"

using namespace sg;
using Json = nlohmann::json;

namespace {

bool is_ours(const std::string& path) {
  const std::string e = extension_of(path);
  for (const char* ours : {"msh", "mesh", "saved", "inp", "tec", "neu", "nek5000", "off"})
    if (e == ours) return true;
  return false;
}

DatasetPtr read_one(const std::string& path, ReadOptions options = {}) {
  Context context;
  return std::get<DatasetPtr>(read_data(test::data_file(path), options, context));
}

std::map<std::string, size_t> shapes(const Dataset& d) {
  std::map<std::string, size_t> r;
  for (const auto& [name, count] : cell_type_counts(d.mesh())) {
    std::string s(name);
    for (const char* curved : {"Lagrange", "Bezier", "BiQuadratic", "Quadratic"})
      if (s.starts_with(curved)) s = s.substr(std::string(curved).size());
    if (s == "Quadrilateral") s = "Quad";
    if (s == "Tetrahedron") s = "Tetra";
    if (s == "Curve") s = "Line";
    r[s] += count;
  }
  return r;
}

void check_gmsh(const Dataset& d, const Json& t) {
  CHECK(d.point_count() == t["nodes"].get<size_t>());
  CHECK(d.cell_count() == t["elements"].get<size_t>());
  const auto have = shapes(d);
  for (const auto& [name, count] : t["elements_by_type"].items()) {
    const std::string shape = name.starts_with("line")   ? "Line"
                              : name.starts_with("tri")  ? "Triangle"
                              : name.starts_with("quad") ? "Quad"
                                                         : "Tetra";
    CHECK(have.at(shape) == count.get<size_t>());
  }
  if (!t.contains("physical_names")) return;
  std::set<std::string> named;
  for (const auto& [name, text] : d.notes())
    if (name == "labels of physical" || name == "labels of group")
      for (const auto& [number, group] : names_in_note(text)) named.insert(group);
  for (const std::string line : t["physical_names"]) {  // 2 9 "Base"
    const std::string name = line.substr(line.find('"') + 1, line.rfind('"') - line.find('"') - 1);
    CHECK_MESSAGE(named.contains(name), name);
  }
}

void check_mfem(const Dataset& d, const Json& t, const std::string& path) {
  if (t.contains("parameters")) {
    CHECK(d.cell_count() == 64);
    return;
  }
  const size_t elements = t.value("leaves", t["elements"].get<size_t>());
  const size_t spans = path.find("pipe-nurbs") != std::string::npos ? 2 : 1;  // knot spans per patch
  CHECK(d.cell_count() == spans * elements);
  const auto have = shapes(d);
  for (const auto& [name, count] : t["elements_by_geometry"].items()) {
    const std::string shape = name == "square"        ? "Quad"
                              : name == "triangle"    ? "Triangle"
                              : name == "cube"        ? "Hexahedron"
                              : name == "prism"       ? "Wedge"
                              : name == "tetrahedron" ? "Tetra"
                                                      : "Pyramid";
    CHECK(have.at(shape) == spans * count.get<size_t>());
  }
  if (!t.contains("spaces") || !path.ends_with(".saved")) return;
  const Json& space = t["spaces"].back();
  const Field* f = d.fields().find("solution");
  if (!f) f = d.fields().find("solution_real");
  REQUIRE(f != nullptr);
  // Values between nodes may pass the largest coefficient a little (Gauss-Lobatto) or stay below it (Bernstein).
  Range all;
  for (const Field& g : d.fields())
    if (g.name.starts_with("solution"))
      for (int c = 0; c < g.components(); ++c) all.add(d.range(g, c));
  const double lo = space["range"][0], hi = space["range"][1], slack = 0.02 * (hi - lo);
  CHECK(all.lo == doctest::Approx(lo).epsilon(1e-3).scale(slack * 1000));
  CHECK(all.hi == doctest::Approx(hi).epsilon(1e-3).scale(slack * 1000));
  CHECK(f->components() == (space["vdim"] == 2 ? 3 : space["vdim"].get<int>()));
}

void check_bounds(const Dataset& d, const Json& b) {
  for (int a = 0; a < 3; ++a) {
    CHECK(d.bounds().lo[a] == doctest::Approx(b[size_t(2 * a)].get<double>()).epsilon(1e-12));
    CHECK(d.bounds().hi[a] == doctest::Approx(b[size_t(2 * a + 1)].get<double>()).epsilon(1e-12));
  }
}

void check_vtk(const Dataset& d, const Json& vtk) {
  CHECK(d.point_count() == vtk["points"].get<size_t>());
  CHECK(d.cell_count() == vtk["cells"].get<size_t>());
  for (const auto& [name, count] : cell_type_counts(d.mesh())) CHECK(vtk["cell_types"].value(std::string(name), size_t(0)) == count);
  check_bounds(d, vtk["bounds"]);
  for (const auto& [key, association] : {std::pair("point_data", Association::point), std::pair("cell_data", Association::cell)}) {
    for (const Json& a : vtk[key]) {
      const std::string name = a["name"];
      CAPTURE(name);
      const Field* f = d.fields().find(name, association);
      REQUIRE(f != nullptr);
      ElementType type = ElementType::u8;
      REQUIRE(parse_element_type(a["type"].get<std::string>(), type));
      CHECK(element_name(f->array.type()) == element_name(type));
      CHECK(f->components() == a["components"].get<int>());
      for (int c = 0; c < f->components(); ++c) {
        CHECK(d.range(*f, c).lo == doctest::Approx(a["range"][size_t(c)][0].get<double>()).epsilon(1e-12));
        CHECK(d.range(*f, c).hi == doctest::Approx(a["range"][size_t(c)][1].get<double>()).epsilon(1e-12));
      }
    }
  }
  size_t arrays = 0;
  for (const Field& f : d.fields()) arrays += f.association != Association::whole;
  CHECK(arrays == vtk["point_data"].size() + vtk["cell_data"].size());
}

void check_nek(const std::string& path, const Json& set) {
  Context context;
  const std::vector<double> times = file_times(test::data_file(path), {}, context);
  REQUIRE(times.size() == 11);
  for (size_t step = 0; step < times.size(); ++step) {
    ReadOptions o;
    o.step = int64_t(step);
    const DatasetPtr d = read_one(path, o);
    const Json& t = step == 0 ? set["truth"] : set["other_files"][fmt::format("eddy_uv0.f{:05}", step + 1)];
    CHECK(d->time().value() == doctest::Approx(t["time"].get<double>()));
    CHECK(d->point_count() == 256 * 64);
    CHECK(d->cell_count() == 256 * 49);
    for (int c = 0; c < 2; ++c)
      for (int end = 0; end < 2; ++end) {
        const Range u = d->range(d->fields().require("velocity"), c);
        CHECK((end ? u.hi : u.lo) == t["U"][size_t(c)][size_t(end)].get<double>());
        CHECK((end ? d->bounds().hi : d->bounds().lo)[c] == t["X"][size_t(c)][size_t(end)].get<double>());
      }
    CHECK(d->range(d->fields().require("pressure")).lo == t["P"][0].get<double>());
    CHECK(d->range(d->fields().require("pressure")).hi == t["P"][1].get<double>());
  }
}

}  // namespace

TEST_CASE("meshes: every Gmsh, MFEM, UCD, Tecplot, GAMBIT, nek5000 and OFF file agrees with the manifest" *
          doctest::skip(test::no_data())) {
  const Json manifest = Json::parse(MappedFile(test::data_file("manifest.json")).text());
  size_t read = 0;
  for (const Json& set : manifest["datasets"]) {
    const std::string path = set["path"];
    if (!is_ours(path)) continue;
    CAPTURE(path);
    const std::string e = extension_of(path);
    if (e == "nek5000") {
      check_nek(path, set);
      ++read;
      continue;
    }
    DatasetPtr d;
    try {
      d = read_one(path);
    } catch (const Error& error) {
      FAIL_CHECK(error.what());
      continue;
    }
    ++read;
    if (e == "msh") check_gmsh(*d, set["truth"]);
    else if (e == "mesh" || e == "saved") check_mfem(*d, set["truth"], path);
    else if (e == "off") {
      CHECK(d->point_count() == set["truth"]["vertices"].get<size_t>());
      CHECK(d->cell_count() == set["truth"]["faces"].get<size_t>());
      check_bounds(*d, set["truth"]["bounds"]);
    } else {
      const Json& vtk = set["vtk"]["data"];
      check_vtk(*d, vtk.contains("blocks") ? vtk["blocks"][0] : vtk);
    }
  }
  CHECK(read == 5 + 18 + 7 + 2 + 2 + 1 + 3);
}
