// SPDX-License-Identifier: Apache-2.0
// Every NIfTI, Analyze, DICOM, SLC, cube and OpenVDB set of the data folder against what other readers say of it.
#include <nlohmann/json.hpp>

#include "base/text/text.h"
#include "data/lattice.h"
#include "io/io_files.h"

using namespace sg;
using namespace sg::test;
using Json = nlohmann::json;

namespace {

const Json& manifest() {
  static const Json m = Json::parse(MappedFile(data_file("manifest.json")).text());
  return m;
}

Data read_all(const std::string& path, const ReadOptions& o = {}) {
  Context context;
  return read_data(data_file(path), o, context);
}
DatasetPtr first_of(const Data& data) {
  DatasetPtr r;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) { r = r ? r : d; });
  REQUIRE(r);
  return r;
}

bool is_nifti(const std::string& path) {
  for (const char* e : {".nii", ".nii.gz", ".img.gz", ".hdr"})
    if (path.ends_with(e)) return true;
  return false;
}

// Shape, steps, values and the place of voxels as nibabel reports them.
void check_nibabel(const std::string& path, const Json& t) {
  const auto shape = t["shape"].get<std::vector<size_t>>();
  const size_t steps = shape.size() > 3 ? shape[3] : 1;
  Context context;
  CHECK(file_times(data_file(path), {}, context).size() == (steps > 1 ? steps : 0));
  Range all;
  double sum = 0;
  size_t count = 0;
  for (size_t s = 0; s < steps; ++s) {
    ReadOptions o;
    o.step = steps > 1 ? int64_t(s) : -1;
    const DatasetPtr d = first_of(read_all(path, o));
    for (size_t a = 0; a < 3; ++a) CHECK(lattice_dims(d->mesh())[a] == shape[a]);
    const Field& f = d->fields().require("NIFTI");
    all.add(d->range(f));
    if (s == 0 || steps < 30) {
      dispatch(f.array, [&](auto v) {
        for (size_t i = 0; i < v.count; ++i) sum += double(v[i]);
      });
      count += f.array.count();
    }
    if (s > 0) continue;
    // nibabel turns volumes without an orientation; we leave them where their header does not put them.
    const bool told = t.value("qform_code", 0) > 0 || t.value("sform_code", 0) > 0;
    if (!told) continue;
    const Lattice lattice(d->mesh());
    const size_t corners[4][3] = {{0, 0, 0}, {shape[0] - 1, 0, 0}, {0, shape[1] - 1, 0}, {1, 2, shape[2] - 1}};
    for (const auto& c : corners) {
      const Vec3 p = lattice.view().position(c[0], c[1], c[2]);
      for (size_t r = 0; r < 3; ++r) {
        const Json& row = t["affine"][r];
        const double want = row[0].get<double>() * double(c[0]) + row[1].get<double>() * double(c[1]) +
                            row[2].get<double>() * double(c[2]) + row[3].get<double>();
        CHECK(std::abs((r < 2 ? -p[int(r)] : p[int(r)]) - want) < 1e-4);  // the affine is NIfTI's: right, anterior, superior
      }
    }
  }
  CHECK(all.lo == doctest::Approx(t["scaled_range"][0].get<double>()).epsilon(1e-6));
  CHECK(all.hi == doctest::Approx(t["scaled_range"][1].get<double>()).epsilon(1e-6));
  if (steps < 30) CHECK(sum / double(count) == doctest::Approx(t["scaled_mean"].get<double>()).epsilon(1e-6));
}

void check_vtk_image(const DatasetPtr& d, const Json& vtk, bool scaled) {
  CHECK(d->point_count() == vtk["points"].get<size_t>());
  CHECK(d->cell_count() == vtk["cells"].get<size_t>());
  for (size_t a = 0; a < 3; ++a) CHECK(lattice_dims(d->mesh())[a] == vtk["dimensions"][a].get<size_t>());
  const Json& a = vtk["point_data"][0];
  const Field* f = d->fields().find(trim(a["name"].get<std::string>()));
  REQUIRE(f);
  CHECK(f->components() == a["components"].get<int>());
  if (scaled) return;
  ElementType type = ElementType::u8;
  REQUIRE(parse_element_type(a["type"].get<std::string>(), type));
  CHECK(element_name(f->array.type()) == element_name(type));
  CHECK(d->range(*f).lo == doctest::Approx(a["range"][0][0].get<double>()).epsilon(1e-12));
  CHECK(d->range(*f).hi == doctest::Approx(a["range"][0][1].get<double>()).epsilon(1e-12));
}

}  // namespace

TEST_CASE("volumes: every NIfTI and Analyze file agrees with the manifest" * doctest::skip(no_data())) {
  size_t read = 0, empty = 0;
  for (const Json& set : manifest()["datasets"]) {
    const std::string path = set["path"];
    if (!is_nifti(path)) continue;
    CAPTURE(path);
    if (set["expect"] == "no-data") {
      CHECK(contains(error_of([&] { read_all(path); }), "no data"));
      ++empty;
      continue;
    }
    const Json& t = set["truth"];
    if (t.contains("shape")) check_nibabel(path, t);
    const double slope = t.value("slope", 1.0);
    check_vtk_image(first_of(read_all(path)), set["vtk"]["data"], slope != 1);
    ++read;
  }
  CHECK(read >= 15);
  CHECK(empty == 3);
}

TEST_CASE("volumes: the diffusion tensor of one voxel" * doctest::skip(no_data())) {
  for (const Json& set : manifest()["datasets"]) {
    if (set["id"] != "tensors/dti-one-voxel") continue;
    for (const auto& [name, t] : set["truth"].items()) {
      if (!t.is_object()) continue;
      CAPTURE(name);
      const auto values = t["values"].get<std::vector<double>>();
      const std::string path = "tensors/dti-one-voxel/" + name;
      const DatasetPtr d = first_of(read_all(path));
      const Array& a = d->fields().require("NIFTI").array;
      CHECK(d->point_count() == 1);
      if (a.components() == 3) {
        CHECK(d->fields()[0].role == Role::vectors);
        // FSL's directions, along voxels whose x leads to the right: in the patient frame y, which leads to the front, has the other sign.
        const double sign[3] = {1, -1, 1};
        for (int c = 0; c < 3; ++c) CHECK(a.get(0, c) == doctest::Approx(sign[c] * values[size_t(c)]));
        continue;
      }
      for (size_t s = 0; s < values.size(); ++s) {
        ReadOptions o;
        o.step = values.size() > 1 ? int64_t(s) : -1;
        CHECK(first_of(read_all(path, o))->fields().require("NIFTI").array.get(0) == doctest::Approx(values[s]));
      }
      if (values.size() == 7) CHECK(d->fields().require("bvec").array.get(1, 0) == 0.817324);
    }
  }
}

TEST_CASE("volumes: DICOM, SLC, cube and OpenVDB agree with the manifest" * doctest::skip(no_data())) {
  size_t read = 0;
  for (const Json& set : manifest()["datasets"]) {
    const std::string path = set["path"];
    CAPTURE(path);
    const bool dicom = path.ends_with(".dcm") || path == "volumes/dicom-brain";
    if (!dicom && !path.ends_with(".slc") && !path.ends_with(".cube") && !path.ends_with(".vdb")) continue;
    const DatasetPtr d = first_of(read_all(path));
    ++read;
    const bool failed = set.contains("vtk") && set["vtk"].value("vtk_error", false);
    if (set.contains("vtk") && !failed) check_vtk_image(d, set["vtk"]["data"], false);
    if (!set.contains("truth")) continue;
    const Json& t = set["truth"];
    if (dicom) {
      const Range r = d->range(d->fields().require("DICOMImage"));
      CHECK(r.lo == t["rescaled_range"][0].get<double>());
      CHECK(r.hi == t["rescaled_range"][1].get<double>());
    } else {
      const Json& g = t["grids"][0];
      if (g["value_type"] == "float") {
        CHECK(d->range(d->fields().require(g["name"].get<std::string>())).hi ==
              doctest::Approx(std::stod(g["max"].get<std::string>())).epsilon(1e-5));
      }
    }
  }
  CHECK(read == 8);
}

TEST_CASE("volumes: a region of the DICOM series is the same part of it" * doctest::skip(no_data())) {
  const DatasetPtr whole = first_of(read_all("volumes/dicom-brain"));
  ReadOptions o;
  o.region.lo = {100, 90, 5};
  o.region.hi = {120, 100, 9};
  const DatasetPtr part = first_of(read_all("volumes/dicom-brain", o));
  const Lattice a(whole->mesh()), b(part->mesh());
  CHECK(length(a.view().position(103, 97, 8) - b.view().position(3, 7, 3)) < 1e-9);
  const auto n = lattice_dims(part->mesh());
  CHECK(part->fields()[0].array.get(3 + n[0] * (7 + n[1] * 3)) == whole->fields()[0].array.get(103 + 256 * (97 + 256 * 8)));
}
