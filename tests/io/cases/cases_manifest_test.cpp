// SPDX-License-Identifier: Apache-2.0
// The EnSight, OpenFOAM, PLOT3D, AMReX and BOV files of the data folder against what VTK and others say of them.
#include <nlohmann/json.hpp>

#include <algorithm>

#include "case_files.h"
#include "data/lattice.h"

using namespace sg;
using namespace sg::test;
using Json = nlohmann::json;

namespace {

const Json& set_of(const std::string& path) {
  static const Json m = Json::parse(MappedFile(data_file("manifest.json")).text());
  for (const Json& s : m["datasets"])
    if (s["path"] == path) return s;
  FAIL("not in the manifest");
  return m;
}

void check_fields(const Dataset& d, const Json& arrays, Association association, const std::vector<std::string>& computed) {
  size_t known = 0;
  for (const Json& a : arrays) {
    const std::string name = a["name"];
    CAPTURE(name);
    if (std::find(computed.begin(), computed.end(), name) != computed.end()) {  // in another order, and there in float
      const Field* f = d.fields().find(name, association);
      for (size_t c = 0; f && c < a["range"].size(); ++c)
        CHECK(d.range(*f, int(c)).hi == doctest::Approx(a["range"][c][1].get<double>()).epsilon(1e-5).scale(1e-3));
      continue;
    }
    ++known;
    const Field* f = d.fields().find(name, association);
    REQUIRE(f != nullptr);
    ElementType type = ElementType::u8;
    REQUIRE(parse_element_type(a["type"].get<std::string>(), type));
    CHECK(element_name(f->array.type()) == element_name(type));
    CHECK(f->components() == a["components"].get<int>());
    CHECK(f->array.count() == a["tuples"].get<size_t>());
    for (size_t c = 0; c < a["range"].size(); ++c) {
      CHECK(d.range(*f, int(c)).lo == doctest::Approx(a["range"][c][0].get<double>()).epsilon(1e-12));
      CHECK(d.range(*f, int(c)).hi == doctest::Approx(a["range"][c][1].get<double>()).epsilon(1e-12));
    }
    if (a.contains("magnitude_range")) CHECK(d.range(*f, -1).hi == doctest::Approx(a["magnitude_range"][1].get<double>()).epsilon(1e-9));
    if (a.contains("mean")) {
      double sum = 0;
      for (size_t i = 0; i < f->array.count(); ++i) sum += f->array.get(i);
      CHECK(sum / double(f->array.count()) == doctest::Approx(a["mean"].get<double>()).epsilon(1e-9));
    }
  }
  size_t ours = 0;
  for (const Field& f : d.fields())
    ours += f.association == association && std::find(computed.begin(), computed.end(), f.name) == computed.end();
  CHECK(ours == known);
}

void check_leaf(const Dataset& d, const Json& vtk, const std::vector<std::string>& computed) {
  CHECK(d.point_count() == vtk["points"].get<size_t>());
  CHECK(d.cell_count() == vtk["cells"].get<size_t>());
  if (vtk.contains("cell_types"))
    for (const auto& [name, count] : cell_type_counts(d.mesh())) CHECK(vtk["cell_types"].value(std::string(name), size_t(0)) == count);
  if (vtk.contains("dimensions")) {
    const auto n = lattice_dims(d.mesh());
    for (size_t a = 0; a < 3; ++a) CHECK(n[a] == vtk["dimensions"][a].get<size_t>());
  }
  for (int a = 0; a < 3; ++a) {
    CHECK(d.bounds().lo[a] == doctest::Approx(vtk["bounds"][size_t(2 * a)].get<double>()).epsilon(1e-12));
    CHECK(d.bounds().hi[a] == doctest::Approx(vtk["bounds"][size_t(2 * a + 1)].get<double>()).epsilon(1e-12));
  }
  check_fields(d, vtk["point_data"], Association::point, computed);
  check_fields(d, vtk["cell_data"], Association::cell, computed);
}

/// The same tree of names and leaves. A lone dataset stands for a tree of one leaf without a name.
void check_tree(const Data& data, const Json& vtk, const std::vector<std::string>& computed = {}) {
  if (!vtk.contains("blocks")) return check_leaf(*std::get<DatasetPtr>(data), vtk, computed);
  if (std::holds_alternative<DatasetPtr>(data)) {
    REQUIRE(vtk["blocks"].size() == 1);
    CHECK(vtk["blocks"][0]["name"].is_null());
    return check_leaf(*std::get<DatasetPtr>(data), vtk["blocks"][0], computed);
  }
  const auto& parts = std::get<CollectionPtr>(data)->parts;
  REQUIRE(parts.size() == vtk["blocks"].size());
  for (size_t i = 0; i < parts.size(); ++i) {
    const Json& block = vtk["blocks"][i];
    if (block["name"].is_string()) CHECK(parts[i].name == block["name"].get<std::string>());
    CAPTURE(parts[i].name);
    check_tree(parts[i].data, block, computed);
  }
}

Data read_set(const std::string& path, const ReadOptions& options = {}) { return read_any(data_file(path), options); }

}  // namespace

TEST_CASE("cases: EnSight files agree with the manifest" * doctest::skip(no_data())) {
  for (const char* path :
       {"meshes/ensight/naca/naca.bin.case", "meshes/ensight/elements/elements.case", "meshes/ensight/office_bin/office_bin.case",
        "meshes/ensight/office_ascii/office_ascii.case", "meshes/ensight/ironProt_ascii/ironProt_ascii.case",
        "meshes/ensight/blow1_ascii/blow1_ascii.case", "vectors/cylinder_Re35/cylinder_Re35.case"}) {
    CAPTURE(path);
    const Json& vtk = set_of(path)["vtk"];
    check_tree(read_set(path), vtk["data"]);
    Context context;
    const auto times = file_times(data_file(path), {}, context);
    const auto expected = vtk.value("times", std::vector<double>());
    REQUIRE(times.size() == expected.size());
    for (size_t i = 0; i < times.size(); ++i) CHECK(float(times[i]) == float(expected[i]));
  }
}

TEST_CASE("cases: the second step of EnSight series is another one" * doctest::skip(no_data())) {
  ReadOptions o;
  o.step = 1;
  for (const char* path : {"meshes/ensight/naca/naca.bin.case", "meshes/ensight/blow1_ascii/blow1_ascii.case"}) {
    const DatasetPtr a = leaf(read_set(path), 0), b = leaf(read_set(path, o), 0);
    CHECK(a->point_count() == b->point_count());
    CHECK(*b->time() > *a->time());
    CHECK_FALSE(same_array(a->fields()[0].array, b->fields()[0].array));
  }
}

TEST_CASE("cases: the solids of the EnSight elements have positive volumes" * doctest::skip(no_data())) {
  // penta6 is listed counter-clockwise as seen from its top, as our wedge.
  const DatasetPtr d = leaf(read_set("meshes/ensight/elements/elements.case"), 0);
  const auto* m = d->as<UnstructuredMesh>();
  REQUIRE(m);
  const CellsView v = cells_view(m->cells);
  int wedges = 0;
  for (size_t c = 0; c < v.count; ++c) {
    if (m->type(c) != CellType::wedge) continue;
    auto at = [&](size_t k) { return m->points.at(size_t(v.point(c, k))); };
    CHECK(dot(cross(at(1) - at(0), at(2) - at(0)), at(3) - at(0)) > 0);
    ++wedges;
  }
  CHECK(wedges == 1);
}

TEST_CASE("cases: the OpenFOAM cavity agrees with the manifest at its last step" * doctest::skip(no_data())) {
  const std::string path = "meshes/openfoam/cavity/case.foam";
  const Json& vtk = set_of(path)["vtk"];
  check_tree(read_set(path), vtk["data"]);
  check_tree(read_set("meshes/openfoam/cavity"), vtk["data"]);
  check_tree(read_set("meshes/openfoam/cavity/"), vtk["data"]);
  check_tree(read_set("meshes/openfoam/cavity/system/controlDict"), vtk["data"]);
  Context context;
  CHECK(file_times(data_file(path), {}, context) == vtk["times"].get<std::vector<double>>());
  ReadOptions o;
  o.time = 0;
  const DatasetPtr first = leaf(read_set(path, o), 0);
  CHECK(first->range(first->fields().require("p")).hi == 0);
  CHECK(first->time() == 0);
  CHECK(first->fields().require("U").unit == "m/s");
  CHECK(first->fields().require("p").unit == "m^2/s^2");
}

TEST_CASE("cases: PLOT3D files agree with the manifest" * doctest::skip(no_data())) {
  // The manifest's set was asked to compute these.
  const std::vector<std::string> computed{"Pressure", "Temperature", "Velocity"};
  for (const char* path : {"meshes/curvilinear/comb/combxyz.bin", "meshes/curvilinear/bluntfin/bluntfinxyz.bin",
                           "meshes/curvilinear/plot3d-multi-bin/multi-bin.xyz"}) {
    CAPTURE(path);
    check_tree(read_set(path), set_of(path)["vtk"]["data"], computed);
  }
  check_tree(read_set("meshes/curvilinear/plot3d-multi-bin/multi.p3d"),
             set_of("meshes/curvilinear/plot3d-multi-bin/multi-bin.xyz")["vtk"]["data"], computed);
}

TEST_CASE("cases: the AMReX plotfile agrees with the manifest, level by level" * doctest::skip(no_data())) {
  const std::string path = "meshes/amr/amrex-plt1_Y/plt1_Y";
  const Json& vtk = set_of(path)["vtk"]["data"];
  const DatasetPtr d = std::get<DatasetPtr>(read_set(path));
  const auto* g = d->as<AmrGrid>();
  REQUIRE(g);
  REQUIRE(g->levels.size() == vtk["levels"].get<size_t>());
  CHECK(d->time() == set_of(path)["truth"]["time"].get<double>());
  CHECK(d->bounds().hi.x == doctest::Approx(0.016));
  size_t begin = 0;
  for (size_t l = 0; l < g->levels.size(); ++l) {
    const Json& level = vtk["level_info"][l];
    CHECK(g->levels[l].patches.size() == level["blocks"].get<size_t>());
    CHECK(g->levels[l].spacing.x == level["spacing"][0].get<double>());
    const size_t cells = level["cells"];
    for (const Json& a : level["arrays"]) {
      const std::string name = a["name"];
      CAPTURE(name);
      const Array values = name == "vtkGhostType" ? d->cell_ghost() : d->fields().require(name, Association::cell).array;
      const Range r = field_stats(values.slice(begin, begin + cells)).range[0];
      CHECK(r.lo == a["range"][0][0].get<double>());
      CHECK(r.hi == a["range"][0][1].get<double>());
    }
    begin += cells;
  }
  CHECK(begin == d->cell_count());
  CHECK(d->fields().size() == 4);
}

TEST_CASE("cases: the brick without a header is read as its name says" * doctest::skip(no_data())) {
  const std::string path = "volumes/chi_chunk_0_700_0_50x50x50.bov";
  const Json& t = set_of(path)["truth"];
  const DatasetPtr d = std::get<DatasetPtr>(read_set(path));
  const auto dims = lattice_dims(d->mesh());
  for (size_t a = 0; a < 3; ++a) CHECK(dims[a] == t["assumed"]["shape_xyz"][a].get<size_t>());
  const Field& f = d->fields()[0];
  CHECK(f.array.type() == ElementType::f32);
  CHECK(d->range(f).lo == t["range"][0].get<double>());
  CHECK(d->range(f).hi == t["range"][1].get<double>());
}
