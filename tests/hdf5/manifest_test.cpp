// SPDX-License-Identifier: Apache-2.0
// The VTKHDF, XDMF and ENZO files of the data folder against what other readers say of them.
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <algorithm>

#include "samples.h"

using namespace sg;
using Json = nlohmann::json;

namespace {

const Json& entry(const std::string& path) {
  static const Json m = Json::parse(MappedFile(test::data_file("manifest.json")).text());
  for (const Json& set : m["datasets"])
    if (set["path"] == path) return set;
  FAIL("no such entry");
  return m;
}

std::string our_type(const std::string& vtk) {
  if (vtk == "long" || vtk == "idtype") return "i64";
  if (vtk == "char") return "i8";
  ElementType t{};
  return parse_element_type(vtk, t) ? std::string(element_name(t)) : vtk;
}

void check_arrays(const Dataset& d, const Json& arrays, Association association) {
  for (const Json& a : arrays) {
    const std::string name = a["name"], type = a["type"];
    if (type == "string") continue;
    CAPTURE(name);
    const Field* f = d.fields().find(name, association);
    REQUIRE(f);
    CHECK(std::string(element_name(f->array.type())) == our_type(type));
    CHECK(f->components() == a["components"].get<int>());
    CHECK(f->array.count() == a["tuples"].get<size_t>());
    const FieldStats s = field_stats(f->array);
    for (size_t c = 0; c < a["range"].size(); ++c) {
      CHECK(s.range[c].lo == a["range"][c][0].get<double>());
      CHECK(s.range[c].hi == a["range"][c][1].get<double>());
    }
  }
}

// Range of a dataset in an HDF5 file beside an XDMF file.
void check_against_h5(const Field& f, const Json& truth, const std::string& name) {
  for (const Json& t : truth["datasets"]) {
    if (t["name"] != name) continue;
    const FieldStats s = field_stats(f.array);
    Range all;
    for (const Range& r : s.range) all.add(r);
    CHECK(all.lo == t["range"][0].get<double>());
    CHECK(all.hi == t["range"][1].get<double>());
    CHECK(f.array.count() == t["shape"][0].get<size_t>());
    return;
  }
  FAIL("no such dataset");
}

}  // namespace

TEST_CASE("hdf5 files: VTKHDF agrees with the manifest" * doctest::skip(test::no_data())) {
  for (const char* path : {"meshes/vtkhdf/can-vtu.hdf", "meshes/vtkhdf/ug_test.vtkhdf"}) {
    CAPTURE(std::string(path));
    const Json& vtk = entry(path)["vtk"]["data"];
    const DatasetPtr d = test::read_file(test::data_file(path));
    CHECK(d->point_count() == vtk["points"].get<size_t>());
    CHECK(d->cell_count() == vtk["cells"].get<size_t>());
    for (const auto& [name, n] : cell_type_counts(d->mesh())) CHECK(vtk["cell_types"][std::string(name)].get<size_t>() == n);
    for (int a = 0; a < 3; ++a) {
      CHECK(d->bounds().lo[a] == vtk["bounds"][size_t(2 * a)].get<double>());
      CHECK(d->bounds().hi[a] == vtk["bounds"][size_t(2 * a + 1)].get<double>());
    }
    check_arrays(*d, vtk["point_data"], Association::point);
    check_arrays(*d, vtk["cell_data"], Association::cell);
    if (vtk.contains("field_data")) check_arrays(*d, vtk["field_data"], Association::whole);
  }
  // Its second step: the upper half of each array that changes.
  ReadOptions late;
  late.step = 1;
  const DatasetPtr d = test::read_file(test::data_file("meshes/vtkhdf/ug_test.vtkhdf"), late);
  CHECK(d->time() == 1.0);
  CHECK(d->range(d->fields().require("cell-radius")).hi == 1.8642193008721804);
  CHECK(d->range(d->fields().require("static-point-scalar")).hi == 0);
}

TEST_CASE("hdf5 files: XDMF agrees with the manifest" * doctest::skip(test::no_data())) {
  const DatasetPtr lone = test::read_file(test::data_file("meshes/xdmf/mesh.xdmf"));
  CHECK(lone->point_count() == 970);
  CHECK(cell_type_counts(lone->mesh()) == std::vector<std::pair<std::string_view, size_t>>{{"QuadraticTriangle", 484}});
  Context context;
  const std::string dolfin = "meshes/xdmf/dolfinx-no_checkpoint/no_checkpoint.xdmf";
  CHECK(file_times(test::data_file(dolfin), {}, context) == std::vector<double>{0, 1, 2, 3, 4});
  const std::string meshio = "meshes/xdmf/meshio-out/out.xdmf";
  CHECK(file_times(test::data_file(meshio), {}, context) == std::vector<double>{0, 0.25, 0.5, 0.75, 1});
  for (int step = 0; step < 5; ++step) {
    ReadOptions o;
    o.step = step;
    const DatasetPtr a = test::read_file(test::data_file(dolfin), o);
    CHECK(cell_type_counts(a->mesh()) == std::vector<std::pair<std::string_view, size_t>>{{"Tetra", 3072}});
    check_against_h5(a->fields().require("f_5"), entry(dolfin)["other_files"]["no_checkpoint.h5"],
                     fmt::format("/VisualisationVector/{}", step));
    const DatasetPtr b = test::read_file(test::data_file(meshio), o);
    CHECK(b->cell_count() == 2);
    const char* names[3] = {"phi", "u", "a"};
    for (int i = 0; i < 3; ++i)
      check_against_h5(b->fields().require(names[i]), entry(meshio)["other_files"]["out.h5"], fmt::format("/data{}", 2 + 3 * step + i));
  }
}

TEST_CASE("hdf5 files: ENZO agrees with the manifest, level by level" * doctest::skip(test::no_data())) {
  const std::string path = "meshes/amr/enzo-moving7/moving7_0010.hierarchy";
  const Json& set = entry(path);
  const DatasetPtr d = test::read_file(test::data_file(path));
  const auto* g = d->as<AmrGrid>();
  REQUIRE(g);
  CHECK(d->time() == set["vtk"]["times"][0].get<double>());
  const Json& levels = set["vtk"]["data"]["level_info"];
  REQUIRE(g->levels.size() == levels.size());
  for (size_t l = 0; l < levels.size(); ++l) {
    CAPTURE(l);
    const auto& level = g->levels[l];
    CHECK(level.patches.size() == levels[l]["blocks"].get<size_t>());
    size_t begin = SIZE_MAX, end = 0, points = 0;
    for (const auto& p : level.patches) {
      const auto c = p.cells();
      begin = std::min(begin, p.cell_offset), end = std::max(end, p.cell_offset + c[0] * c[1] * c[2]);
      points += (c[0] + 1) * (c[1] + 1) * (c[2] + 1);
    }
    CHECK(end - begin == levels[l]["cells"].get<size_t>());
    CHECK(points == levels[l]["points"].get<size_t>());
    for (int a = 0; a < 3; ++a) CHECK(level.spacing[a] == doctest::Approx(levels[l]["spacing"][size_t(a)].get<double>()).epsilon(1e-9));
    for (const Json& want : levels[l]["arrays"]) {
      const std::string name = want["name"];
      CAPTURE(name);
      const Array a = (name == "vtkGhostType" ? d->cell_ghost() : d->fields().require(name).array).slice(begin, end);
      CHECK(std::string(element_name(a.type())) == our_type(want["type"]));
      const Range r = field_stats(a).range[0];
      CHECK(r.lo == doctest::Approx(want["range"][0][0].get<double>()).epsilon(1e-6));
      CHECK(r.hi == doctest::Approx(want["range"][0][1].get<double>()).epsilon(1e-6));
    }
  }
}
