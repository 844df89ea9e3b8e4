// SPDX-License-Identifier: Apache-2.0
// CGNS files: real ones, and damage done to them.
#include "io/cases/case_files.h"

using namespace sg;
using namespace sg::test;

namespace {

constexpr const char* adf = "meshes/cgns/sqnz_s.adf.cgns";
constexpr const char* hdf = "meshes/cgns/cgnslib_vers-4400.cgns";

}  // namespace

TEST_CASE("cgns: a file of version 3.0, which numbers its elements otherwise, holds the same mesh as one of 4.4" *
          doctest::skip(no_data())) {
  const DatasetPtr a = leaf_named(read_any(data_file(hdf)), "Base/Zone 1");
  const DatasetPtr b = leaf_named(read_any(data_file("edge-cases/cgns/cgnslib_vers-3000.cgns")), "Base/Zone 1");
  CHECK(b->cell_count() == 2560);
  CHECK(cell_type_counts(a->mesh()) == cell_type_counts(b->mesh()));
  const auto &p = *a->as<UnstructuredMesh>(), &q = *b->as<UnstructuredMesh>();
  CHECK(same_array(p.points.xyz, q.points.xyz));
  CHECK(same_array(p.cells.connectivity, q.cells.connectivity));
  CHECK(same_array(a->fields().require("Density").array, b->fields().require("Density").array));
}

TEST_CASE("cgns: the cells of an unstructured zone fill its box" * doctest::skip(no_data())) {
  const DatasetPtr d = leaf_named(read_any(data_file(hdf)), "Base/Zone 1");
  const auto& mesh = *d->as<UnstructuredMesh>();
  const CellsView cells = cells_view(mesh.cells);
  double volume = 0;
  for (size_t c = 0; c < cells.count; ++c) {
    const Vec3 o = mesh.points.at(size_t(cells.point(c, 0)));
    const auto edge = [&](size_t k) { return mesh.points.at(size_t(cells.point(c, k))) - o; };
    volume += dot(cross(edge(1), edge(3)), edge(4));  // boxes
  }
  CHECK(volume == doctest::Approx(20. * 16 * 8));
  std::string notes;
  for (const auto& [k, v] : d->notes()) notes += k + "=" + v + ";";
  CHECK(contains(notes, "reference Mach=4.6;"));
  CHECK(contains(notes, "boundary Walls="));
}

TEST_CASE("cgns: neighbouring zones share their faces, components make vectors" * doctest::skip(no_data())) {
  const Data data = read_any(data_file(adf));
  const DatasetPtr a = leaf_named(data, "SQNZ/dom1_1_1_1"), b = leaf_named(data, "SQNZ/dom1_2_1_1");
  CHECK(a->bounds().hi.x == doctest::Approx(b->bounds().lo.x));
  const Field& m = a->fields().require("Momentum");
  CHECK(m.components() == 3);
  CHECK(m.association == Association::cell);
  CHECK(m.role == Role::vectors);
  ReadOptions o;
  o.fields = {"Density"};
  CHECK(leaf_named(read_any(data_file(adf), o), "SQNZ/dom1_3_2_2")->fields().names() == std::vector<std::string>{"Density"});
  o.step = 1;
  CHECK(contains(error_of([&] { read_any(data_file(adf), o); }), "no time step 1"));
}

TEST_CASE("cgns: files cut anywhere are refused or read" * doctest::skip(no_data())) {
  for (const char* name : {adf, hdf}) {
    const MappedFile file(data_file(name));
    int refused = 0;
    for (size_t k = 1; k < 64; ++k) {
      const std::string path = temp_file("cut.cgns", file.text().substr(0, file.size() * k / 64));
      try {
        read_any(path);
      } catch (const Error& e) {
        CHECK(e.kind() == ErrorKind::data);
        ++refused;
      }
    }
    CAPTURE(name);
    CHECK(refused >= 60);
  }
}

TEST_CASE("cgns: files with a byte changed in their first part are refused or read" * doctest::skip(no_data())) {
  for (const char* name : {adf, hdf}) {
    const MappedFile file(data_file(name));
    for (size_t k = 0; k < 200; k += 3) {
      std::string bad(file.text());
      bad[k] = char(bad[k] ^ 0xff);
      try {
        read_any(temp_file("flip.cgns", bad));
      } catch (const Error& e) {
        CHECK(e.kind() != ErrorKind::internal);
      }
    }
  }
}

TEST_CASE("cgns: what is only named so is refused") {
  CHECK(contains(refusal("no.cgns", "@(#)ADF Database Version" + std::string(200, 'x')), "no.cgns"));
  CHECK(contains(refusal("text.cgns", "just some text, long enough to be looked at"), "named like CGNS"));
}
