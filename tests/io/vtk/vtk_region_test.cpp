// SPDX-License-Identifier: Apache-2.0
// VTK XML lattices in part: regions, strides, named fields, headers. What is not asked for is not read.
#include <algorithm>

#include "data/lattice_crop.h"
#include "io/vtk/vtk_samples.h"

using namespace sg;
using namespace sg::test;

namespace {

DatasetPtr big(Mesh mesh) {
  DatasetParts p;
  p.mesh = std::move(mesh);
  const size_t points = point_count(p.mesh), cells = cell_count(p.mesh);
  p.fields.add({"T", Association::point, ramp<float>(points, 1, 0.37), {}, Role::scalars});
  p.fields.add({"v", Association::point, ramp<double>(points, 3, 0.11), {}, Role::none});
  p.fields.add({"m", Association::cell, ramp<uint16_t>(cells), {}, Role::none});
  uint8_t* ghost = nullptr;
  p.cell_ghost = Array::make<uint8_t>(cells, 1, &ghost);
  for (size_t i = 0; i < cells; ++i) ghost[i] = i % 7 ? 0 : ghost_hidden_cell;
  return make_dataset(std::move(p));
}

void check_part(const Dataset& want, const Dataset& got) {
  check_same_mesh(want.mesh(), got.mesh());
  CHECK(want.fields().size() == got.fields().size());
  for (const Field& f : want.fields()) {
    CAPTURE(f.name);
    REQUIRE(got.fields().find(f.name, f.association));
    CHECK(same(f.array, got.fields().find(f.name, f.association)->array));
  }
  CHECK(same(want.cell_ghost(), got.cell_ghost()));
  CHECK(want.notes() == got.notes());
}

}  // namespace

TEST_CASE("vtk xml: a region of a lattice is what cutting the whole gives, in every encoding") {
  UniformGrid u;
  u.dims = {70, 41, 33}, u.spacing = {0.5, 0.25, 1}, u.origin = {1, -2, 8}, u.extent_start = {3, 0, -4};
  RectilinearGrid r;
  r.x = ramp<float>(30, 1, 0.5), r.y = ramp<double>(20, 1, 2), r.z = ramp<float>(11);
  CurvilinearGrid c;
  c.dims = {17, 12, 9}, c.points.xyz = ramp<float>(17 * 12 * 9, 3, 0.1);
  const std::pair<const char*, Mesh> meshes[] = {{"vti", u}, {"vtr", r}, {"vts", c}};
  const LatticeRegion regions[] = {{{0, 0, 4}, {SIZE_MAX, SIZE_MAX, 4}, {1, 1, 1}},
                                   {{3, 2, 1}, {9, 9, 7}, {1, 1, 1}},
                                   {{16, 0, 0}, {16, SIZE_MAX, SIZE_MAX}, {1, 1, 1}},
                                   {{0, 0, 0}, {SIZE_MAX, SIZE_MAX, SIZE_MAX}, {3, 2, 4}},
                                   {{5, 11, 8}, {5, 11, 8}, {1, 1, 1}},
                                   {{1, 1, 1}, {SIZE_MAX, SIZE_MAX, SIZE_MAX}, {50, 1, 1}}};
  for (const auto& [extension, mesh] : meshes) {
    const DatasetPtr d = big(mesh);
    for (const WriteOptions& o : every_option) {
      const std::string path = temp(std::string("region.") + extension);
      write(path, d, o);
      for (const LatticeRegion& region : regions) {
        CAPTURE(extension);
        CAPTURE(std::string(word_of(o.encoding)));
        CAPTURE(std::string(word_of(*o.compression)));
        CAPTURE(region.lo[0]);
        ReadOptions options;
        options.region = region;
        check_part(*crop_lattice(*d, region.lo, region.hi, region.stride), *read(path, options));
      }
    }
  }
}

TEST_CASE("vtk xml: big-endian raw numbers of a region are turned") {
  std::string bytes("\0\0\0\x10", 4);
  for (const unsigned v : {1u, 2u, 3u, 4u}) bytes += std::string("\0\0\0", 3) + char(v);
  write_file(temp("big.vti"),
             "<VTKFile type=\"ImageData\" byte_order=\"BigEndian\"><ImageData WholeExtent=\"0 3 0 0 0 0\"><Piece "
             "Extent=\"0 3 0 0 0 0\"><PointData><DataArray type=\"Int32\" Name=\"T\" format=\"appended\" offset=\"0\"/>"
             "</PointData></Piece></ImageData><AppendedData encoding=\"raw\">_" +
                 bytes + "</AppendedData></VTKFile>");
  ReadOptions options;
  options.region.lo[0] = 1, options.region.stride[0] = 2;
  const DatasetPtr d = read(temp("big.vti"), options);
  CHECK(same(d->fields().require("T").array, numbers<int32_t>({2, 4})));
}

TEST_CASE("vtk xml: blocks and arrays that are not needed may be damaged") {
  UniformGrid u;
  u.dims = {128, 128, 32};
  const DatasetPtr d = big(u);
  const std::string path = temp("holes.vti");
  write(path, d, {VtkEncoding::appended, Compression::zlib});
  std::string text(MappedFile(path).text());
  // The last bytes belong to the ghosts; the array before is 'm', those before are 'v' and 'T'. Half of 'v' is wiped.
  const size_t begin = text.find("_", text.find("<AppendedData")), middle = begin + (text.size() - begin) / 2;
  std::fill(text.begin() + ptrdiff_t(middle), text.begin() + ptrdiff_t(middle) + 200, 'x');
  write_file(path, text);
  CHECK(!error_of([&] { read(path); }).empty());
  ReadOptions named;
  named.fields = {"T"};
  CHECK(read(path, named)->fields().size() == 1);
  ReadOptions region;
  region.region.hi = {SIZE_MAX, SIZE_MAX, 1};
  CHECK(read(path, region)->fields().size() == 3);
  // Only the header: names, types and sizes are there, numbers are not looked at.
  ReadOptions header;
  header.header_only = true;
  const DatasetPtr h = read(path, header);
  REQUIRE(h->fields().find("v"));
  CHECK(h->fields().require("v").array.count() == d->point_count());
  CHECK(h->fields().require("v").components() == 3);
  CHECK(std::isnan(h->fields().require("T").array.get(5)));
  CHECK(same(h->cell_ghost(), d->cell_ghost()));
}

TEST_CASE("vtk xml: regions out of the grid and strides of 0 are the caller's mistake") {
  UniformGrid u;
  u.dims = {4, 4, 4};
  write(temp("small.vti"), big(u));
  ReadOptions o;
  o.region.lo = {4, 0, 0};
  CHECK(error_of([&] { read(temp("small.vti"), o); }).find("0 to 3") != std::string::npos);
  o.region = {};
  o.region.stride = {1, 0, 1};
  CHECK(error_of([&] { read(temp("small.vti"), o); }).find("stride is 0") != std::string::npos);
}

TEST_CASE("vtk legacy: arrays that are not asked for are passed over, text or binary") {
  auto file = [](bool binary) {
    std::string t =
        std::string("# vtk DataFile Version 3.0\nt\n") + (binary ? "BINARY" : "ASCII") +
        "\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 1\nORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA 4\nSCALARS a short 1\nLOOKUP_TABLE "
        "default\n";
    t += binary ? std::string("\0\1\0\2\0\3\0\4\n", 9) : "1 2 3 4\n";
    t += "VECTORS v unsigned_char\n";
    t += binary ? "abcdefghijkl\n" : "1 2 3 4 5 6 7 8 9 10 11 12\n";
    return t + "FIELD f 1\nb 1 4 unsigned_char\n" + (binary ? std::string("ABCD\n") : std::string("65 66 67 68\n"));
  };
  for (const bool binary : {false, true}) {
    CAPTURE(binary);
    ReadOptions o;
    o.fields = {"b"};
    const DatasetPtr d = read_text("skip.vtk", file(binary), o);
    CHECK(d->fields().size() == 1);
    CHECK(same(d->fields().require("b").array, numbers<uint8_t>({65, 66, 67, 68})));
    CHECK(read_text("skip.vtk", file(binary))->fields().size() == 3);
    o.fields = {};
    o.header_only = true;
    CHECK(read_text("skip.vtk", file(binary), o)->fields().require("v").components() == 3);
    // A cut inside what is passed over is still found.
    o.fields = {"b"};
    const std::string text = file(binary);
    CHECK(error_of([&] { read_text("skip.vtk", text.substr(0, text.find("VECTORS") + 30), o); }).find("skip.vtk") != std::string::npos);
  }
}
