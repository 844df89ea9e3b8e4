// SPDX-License-Identifier: Apache-2.0
// Every VTK file of the data folder against what other readers say of it (manifest.json).
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "base/file/file.h"
#include "data/lattice.h"
#include "io/formats.h"
#include "io/io.h"
#include "support/test.h"

using namespace sg;
using nlohmann::json;

namespace {

const json& manifest() {
  static const json m = json::parse(std::ifstream(test::data_file("manifest.json")));
  return m;
}

bool is_vtk_file(const std::string& path) {
  static const std::set<std::string> extensions{"vtk", "vti", "vtr", "vts", "vtu", "vtp", "myvtk"};
  return extensions.count(extension_of(path)) > 0;
}

// char is signed where the truth was recorded; ids are 64 bits wide.
std::string our_type(const std::string& vtk) {
  if (vtk == "idtype" || vtk == "long long" || vtk == "long") return "i64";
  ElementType t{};
  return parse_element_type(vtk, t) ? std::string(element_name(t)) : vtk;
}

bool near(double a, double b) { return std::abs(a - b) <= 1e-9 * std::max({1.0, std::abs(a), std::abs(b)}); }

DatasetPtr read_lone(const std::string& path) {
  Context context;
  const Data data = read_data(path, {}, context);
  REQUIRE(std::holds_alternative<DatasetPtr>(data));
  return std::get<DatasetPtr>(data);
}

void check_fields(const Dataset& d, const json& truth, Association association) {
  for (const json& want : truth) {
    const std::string name = want["name"], type = want["type"];
    if (type == "string" || name == "TimeValue" || name == "vtkGhostType") continue;
    CAPTURE(name);
    const Field* f = d.fields().find(name, association);
    CHECK(f != nullptr);
    if (!f) continue;
    // A 64-bit id type may be kept in the 32 bits that the file has.
    if (type == "idtype") CHECK((f->array.type() == ElementType::i64 || f->array.type() == ElementType::i32));
    else CHECK(std::string(element_name(f->array.type())) == our_type(type));
    CHECK(f->components() == want["components"].get<int>());
    CHECK(f->array.count() == want["tuples"].get<size_t>());
    const FieldStats stats = field_stats(f->array);
    for (size_t c = 0; c < want["range"].size() && c < stats.range.size(); ++c) {
      CAPTURE(c);
      if (want["range"][c].is_null()) continue;
      CHECK(near(stats.range[c].lo, want["range"][c][0].get<double>()));
      CHECK(near(stats.range[c].hi, want["range"][c][1].get<double>()));
    }
    if (want.contains("active") && want["active"] == "Vectors") CHECK(f->role == Role::vectors);
    if (want.contains("active") && want["active"] == "Normals") CHECK(f->role == Role::normals);
  }
}

void check_dataset(const Dataset& d, const json& truth) {
  CHECK(d.point_count() == truth["points"].get<size_t>());
  CHECK(d.cell_count() == truth["cells"].get<size_t>());
  if (truth.contains("dimensions")) {
    const auto dims = lattice_dims(d.mesh());
    for (size_t a = 0; a < 3; ++a) CHECK(dims[a] == truth["dimensions"][a].get<size_t>());
  }
  if (truth.contains("bounds") && d.point_count() > 0)
    for (int a = 0; a < 3; ++a) {
      CHECK(near(d.bounds().lo[a], truth["bounds"][size_t(2 * a)].get<double>()));
      CHECK(near(d.bounds().hi[a], truth["bounds"][size_t(2 * a + 1)].get<double>()));
    }
  if (truth.contains("cell_types")) {
    json ours = json::object();
    for (const auto& [name, n] : cell_type_counts(d.mesh())) ours[std::string(name)] = n;
    CHECK(ours == truth["cell_types"]);
  }
  for (const auto& [key, association] :
       {std::pair("point_data", Association::point), {"cell_data", Association::cell}, {"field_data", Association::whole}})
    if (truth.contains(key)) check_fields(d, truth[key], association);
}

}  // namespace

TEST_CASE("vtk: every file of the data folder agrees with the truth recorded for it" * doctest::skip(sg::test::no_data())) {
  size_t compared = 0;
  for (const json& set : manifest()["datasets"]) {
    const std::string path = set["path"], expect = set["expect"], use = set["use"];
    if (!is_vtk_file(path) || (expect != "reads" && expect != "valid")) continue;
    CAPTURE(path);
    if (use != "vtk" && use != "both") continue;
    DatasetPtr d;
    try {
      d = read_lone(test::data_file(path));
    } catch (const Error& e) {
      FAIL_CHECK(std::string(e.what()));
      continue;
    }
    check_dataset(*d, set["vtk"]["data"]);
    ++compared;
  }
  CHECK(compared >= 90);
}

TEST_CASE("vtk: the pieces of parallel, AMR and multiblock sets read, with the truth of each where there is one" *
          doctest::skip(sg::test::no_data())) {
  size_t read = 0, compared = 0;
  for (const json& set : manifest()["datasets"]) {
    if (is_vtk_file(set["path"])) continue;
    size_t cells = 0;
    for (const json& file : set["files"]) {
      const std::string path = file["path"];
      if (!is_vtk_file(path)) continue;
      CAPTURE(path);
      DatasetPtr d;
      try {
        d = read_lone(test::data_file(path));
      } catch (const Error& e) {
        FAIL_CHECK(std::string(e.what()));
        continue;
      }
      ++read;
      cells += d->cell_count();
      if (const auto others = set.find("other_files_vtk"); others != set.end() && others->contains(file_name_of(path))) {
        check_dataset(*d, (*others)[file_name_of(path)]["data"]);
        ++compared;
      }
    }
    if (extension_of(set["path"].get<std::string>()) == "pvtu") CHECK(cells == set["vtk"]["data"]["cells"].get<size_t>());
  }
  CHECK(read >= 120);
  CHECK(compared >= 16);
}

TEST_CASE("vtk: files without a mesh are refused with that reason" * doctest::skip(sg::test::no_data())) {
  Context context;
  for (const char* name : {"edge-cases/vtk-legacy/financial.vtk", "edge-cases/vtk-legacy/blowAttr.vtk"}) {
    CAPTURE(name);
    const std::string error = test::error_of([&] { read_data(test::data_file(name), {}, context); });
    CHECK(error.find("no mesh") != std::string::npos);
    CHECK(error.find(name) != std::string::npos);
  }
}

TEST_CASE("vtk: one quad mesh is the same in all of its XML encodings" * doctest::skip(sg::test::no_data())) {
  const DatasetPtr first = read_lone(test::data_file("edge-cases/vtu-encodings/quad_ascii.vtu"));
  const auto* a = first->as<UnstructuredMesh>();
  REQUIRE(a);
  for (const char* name : {"append_b64", "append_b64_compress", "append_raw", "append_raw_compress", "binary", "binary_compress"}) {
    CAPTURE(name);
    const DatasetPtr d = read_lone(test::data_file(std::string("edge-cases/vtu-encodings/quad_") + name + ".vtu"));
    const auto* b = d->as<UnstructuredMesh>();
    REQUIRE(b);
    CHECK(b->cells.fixed == 4);
    CHECK(b->single_type == CellType::quad);
    REQUIRE(b->points.count() == 16);
    for (size_t i = 0; i < 16; ++i) CHECK(a->points.at(i) == b->points.at(i));
    for (size_t i = 0; i < 36; ++i) CHECK(index_view(a->cells.connectivity)[i] == index_view(b->cells.connectivity)[i]);
  }
}
