// SPDX-License-Identifier: Apache-2.0
// Every Exodus II, netCDF, MINC and CGNS file of the data folder against what other readers say of it.
#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>

#include "base/text/text.h"
#include "data/lattice.h"
#include "data/patient/patient_frame.h"
#include "io/io_files.h"

using namespace sg;
using namespace sg::test;
using Json = nlohmann::json;

namespace {

const Json& manifest() {
  static const Json m = Json::parse(MappedFile(data_file("manifest.json")).text());
  return m;
}

bool is_ours(const std::string& path) {
  const std::string e = extension_of(path);
  for (const char* ours : {"e", "exo", "ex2", "exii", "nc", "mnc", "cgns"})
    if (e == ours) return true;
  return false;
}

// Numbers that another reader rounded to f32 on its way agree to six digits.
void check_number(double ours, const Json& theirs, double tolerance) {
  if (theirs.is_number()) CHECK(ours == doctest::Approx(theirs.get<double>()).epsilon(tolerance));
}

void check_arrays(const Dataset& d, const Json& arrays, Association association, bool values) {
  for (const Json& a : arrays) {
    const std::string name = a["name"];
    CAPTURE(name);
    const Field* f = d.fields().find(name, association);
    REQUIRE(f != nullptr);
    CHECK(f->components() == a["components"].get<int>());
    CHECK(f->array.count() == a["tuples"].get<size_t>());
    if (!values) continue;
    ElementType type = ElementType::i64;  // vtkIdType
    if (a["type"] != "idtype") REQUIRE(parse_element_type(a["type"].get<std::string>(), type));
    CHECK(element_name(f->array.type()) == element_name(type));
    for (size_t c = 0; c < a["range"].size(); ++c) {
      const Range r = d.range(*f, int(c));
      check_number(r.lo, a["range"][c][0], 1e-12);
      check_number(r.hi, a["range"][c][1], 1e-12);
    }
    if (a.contains("mean") && f->components() == 1) {
      double sum = 0;
      for (size_t i = 0; i < f->array.count(); ++i) sum += f->array.get(i);
      check_number(sum / double(f->array.count()), a["mean"], 1e-9);
    }
  }
}

void check_dataset(const Dataset& d, const Json& vtk, bool values) {
  CHECK(d.point_count() == vtk["points"].get<size_t>());
  CHECK(d.cell_count() == vtk["cells"].get<size_t>());
  if (vtk.contains("cell_types"))
    for (const auto& [name, count] : cell_type_counts(d.mesh())) CHECK(vtk["cell_types"].value(std::string(name), size_t(0)) == count);
  if (vtk.contains("dimensions")) {
    const auto dims = lattice_dims(d.mesh());
    for (size_t a = 0; a < 3; ++a) CHECK(dims[a] == vtk["dimensions"][a].get<size_t>());
  }
  const std::map<std::string, std::string> kinds = {{"vtkImageData", "uniform"},
                                                    {"vtkRectilinearGrid", "rectilinear"},
                                                    {"vtkStructuredGrid", "curvilinear"},
                                                    {"vtkUnstructuredGrid", "unstructured"}};
  CHECK(d.kind() == kinds.at(vtk["class"].get<std::string>()));
  // VTK leaves MINC's world as it is: right, anterior, superior.
  const bool turned = in_patient_frame(d);
  for (int a = 0; a < 3; ++a) {
    const bool flip = turned && a < 2;
    check_number(flip ? -d.bounds().hi[a] : d.bounds().lo[a], vtk["bounds"][size_t(2 * a)], 1e-6);
    check_number(flip ? -d.bounds().lo[a] : d.bounds().hi[a], vtk["bounds"][size_t(2 * a + 1)], 1e-6);
  }
  check_arrays(d, vtk["point_data"], Association::point, values);
  check_arrays(d, vtk["cell_data"], Association::cell, values);
}

// Blocks that VTK left out or that are empty are null or have no blocks; ours are then not there.
size_t check_tree(const Data& ours, const Json& vtk, bool values) {
  if (!vtk.contains("blocks")) {
    REQUIRE(std::holds_alternative<DatasetPtr>(ours));
    check_dataset(*std::get<DatasetPtr>(ours), vtk, values);
    return 1;
  }
  REQUIRE(std::holds_alternative<CollectionPtr>(ours));
  const auto& parts = std::get<CollectionPtr>(ours)->parts;
  size_t k = 0, leaves = 0;
  const std::function<bool(const Json&)> holds = [&](const Json& b) {
    if (b.is_null()) return false;
    if (!b.contains("blocks")) return b.contains("points");
    for (const Json& c : b["blocks"])
      if (holds(c)) return true;
    return false;
  };
  for (const Json& b : vtk["blocks"]) {
    if (!holds(b)) continue;
    REQUIRE(k < parts.size());
    CAPTURE(parts[k].name);
    CHECK(parts[k].name == b["name"].get<std::string>());
    leaves += check_tree(parts[k].data, b, values);
    ++k;
  }
  CHECK(k == parts.size());
  return leaves;
}

// Variables of a CF file: counts and ranges over all steps, missing ones left out.
void check_variables(const std::string& path, const Json& variables) {
  Context context;
  const size_t steps = std::max<size_t>(file_times(data_file(path), {}, context).size(), 1);
  std::map<std::string, Range> ranges;
  std::map<std::string, size_t> valid;
  for (size_t s = 0; s < steps; ++s) {
    ReadOptions o;
    if (steps > 1) o.step = int64_t(s);
    for_each_dataset(read_any(data_file(path), o), [&](const std::string&, const DatasetPtr& d) {
      for (const Field& f : d->fields()) {
        ranges[f.name].add(d->range(f));
        valid[f.name] += f.array.count() - size_t(d->stats(f).nan);
      }
    });
  }
  size_t found = 0;
  for (const auto& [name, r] : ranges)
    for (const Json& v : variables) {
      if (v["name"] != Json(name) || v["shape"].size() < 2) continue;
      CAPTURE(name);
      const bool changes = v["shape"][0] == steps && steps > 1;
      CHECK(valid[name] == v["valid"].get<size_t>() * (changes || steps == 1 ? 1 : steps));
      check_number(r.lo, v["valid_range"][0], 1e-12);
      check_number(r.hi, v["valid_range"][1], 1e-12);
      ++found;
    }
  CHECK(found >= 1);
}

}  // namespace

TEST_CASE("netcdf: every Exodus II, CF, MINC and CGNS file agrees with the manifest" * doctest::skip(no_data())) {
  size_t files = 0, leaves = 0;
  for (const Json& set : manifest()["datasets"]) {
    const std::string path = set["path"];
    if (!is_ours(path)) continue;
    CAPTURE(path);
    ++files;
    Data data;
    try {
      data = read_any(data_file(path));
    } catch (const Error& e) {
      FAIL_CHECK(e.what());
      continue;
    }
    const bool vtk = set["use"] == "both" || set["use"] == "vtk", cf = extension_of(path) == "nc";
    // VTK applies no missing values, so that its values of CF files differ; truth tells them.
    if (vtk) leaves += check_tree(data, set["vtk"]["data"], !cf);
    if (!cf || !set["truth"].contains("variables") || path.find("sampleGenGrid") != std::string::npos) continue;
    check_variables(path, set["truth"]["variables"]);
    if (set.contains("other_files"))
      for (const auto& [name, variables] : set["other_files"].items()) {
        if (name.find("GLOBCURRENT") != std::string::npos && name.find("0101000000") == std::string::npos &&
            name.find("31000000") == std::string::npos)
          continue;
        Json list = Json::array();
        for (const auto& [key, v] : variables.items()) {
          list.push_back(v);
          list.back()["name"] = key;
        }
        check_variables(folder_of(path) + name, list);
      }
  }
  CHECK(files == 16);
  CHECK(leaves == 63);
}

TEST_CASE("netcdf: the times of the files are those of the manifest" * doctest::skip(no_data())) {
  Context context;
  for (const Json& set : manifest()["datasets"]) {
    const std::string path = set["path"];
    if (!is_ours(path) || !set.contains("vtk") || !set["vtk"].contains("times") || extension_of(path) == "cgns") continue;
    CAPTURE(path);
    std::vector<double> expected = set["vtk"]["times"];
    CHECK(file_times(data_file(path), {}, context) == expected);
  }
}

TEST_CASE("netcdf: the headers of the Exodus, netCDF and CGNS files tell every field, without its values" * doctest::skip(no_data())) {
  size_t fields = 0;
  for (const Json& set : manifest()["datasets"]) {
    const std::string path = set["path"];
    if (!is_ours(path) || set["expect"] != "reads" || extension_of(path) == "mnc") continue;
    CAPTURE(path);
    fields += check_names_alone(data_file(path));
  }
  CHECK(fields > 60);
}

TEST_CASE("netcdf: a step of moving eddies reads alike with one thread and with eight" * doctest::skip(no_data())) {
  ReadOptions o;
  o.step = 5;
  o.fields = {"vozocrtx"};
  const auto read = [&] { return std::get<DatasetPtr>(read_any(data_file("vectors/moving_eddies/moving_eddiesU.nc"), o)); };
  const DatasetPtr a = with_threads(1, read), b = with_threads(8, read);
  REQUIRE(a->fields().size() == 1);
  CHECK(same_array(a->fields()[0].array, b->fields()[0].array));
  const auto exodus = [&] { return read_any(data_file("meshes/exodus/disk_out_ref.ex2")); };
  std::vector<DatasetPtr> one, eight;
  for_each_dataset(with_threads(1, exodus), [&](const std::string&, const DatasetPtr& d) { one.push_back(d); });
  for_each_dataset(with_threads(8, exodus), [&](const std::string&, const DatasetPtr& d) { eight.push_back(d); });
  REQUIRE(one.size() == eight.size());
  for (size_t i = 0; i < one.size(); ++i)
    for (size_t f = 0; f < one[i]->fields().size(); ++f) CHECK(same_array(one[i]->fields()[f].array, eight[i]->fields()[f].array));
}

TEST_CASE("exodus: blocks of faces and edges come when a field of theirs is asked for" * doctest::skip(no_data())) {
  const std::string path = data_file("meshes/exodus/edgeFaceElem.exii");
  Context context;
  std::string said;
  context.on_log = [&](LogLevel, std::string_view text) { said += text; };
  read_data(path, {}, context);
  CHECK(contains(said, "3 face blocks are left out"));
  ReadOptions o;
  o.fields = {"PHI"};
  o.step = 1;
  std::map<std::string, DatasetPtr> parts;
  for_each_dataset(read_data(path, o, context), [&](const std::string& name, const DatasetPtr& d) { parts[name] = d; });
  REQUIRE(parts.count("Face Blocks/John BARTHA"));
  const DatasetPtr faces = parts["Face Blocks/John BARTHA"];
  CHECK(cell_type_counts(faces->mesh())[0] == std::pair<std::string_view, size_t>("Quad", 8));
  CHECK(faces->range(faces->fields().require("PHI")).hi == 4);
  CHECK(parts.count("Face Blocks/Claudio SCARCHILLI") == 1);
  CHECK(parts["Face Blocks/Claudio SCARCHILLI"]->fields().empty());
  CHECK(parts.count("Edge Blocks/Aldo GIUFFRE") == 0);
}
