// SPDX-License-Identifier: Apache-2.0
// Parallel VTK XML files: pieces in files of their own, with and without ghosts.
#include <tuple>

#include "data/lattice.h"
#include "data/lattice_crop.h"
#include "io/vtk/vtk_samples.h"

using namespace sg;
using namespace sg::test;

namespace {

// A parallel file of that type; `sources` are names beside it.
std::string parallel(const std::string& type, const std::string& attributes, const std::vector<std::string>& sources) {
  std::string t = "<VTKFile type=\"P" + type + "\" version=\"1.0\" byte_order=\"LittleEndian\"><P" + type + " " + attributes + ">";
  for (const std::string& s : sources) t += "<Piece Source=\"" + s + "\"/>";
  return t + "</P" + type + "></VTKFile>";
}

DatasetPtr lattice(Mesh mesh) {
  DatasetParts p;
  p.mesh = std::move(mesh);
  const size_t points = point_count(p.mesh), cells = cell_count(p.mesh);
  p.fields.add({"T", Association::point, ramp<float>(points, 1, 0.5), {}, Role::scalars});
  p.fields.add({"v", Association::point, ramp<double>(points, 3), {}, Role::none});
  p.fields.add({"id", Association::cell, ramp<int32_t>(cells), {}, Role::none});
  return make_dataset(std::move(p));
}

UniformGrid image(size_t x, size_t y, size_t z) {
  UniformGrid g;
  g.dims = {x, y, z}, g.origin = {1, 2, 3}, g.spacing = {0.5, 0.25, 2};
  return g;
}

// Cuts a lattice along x at `at` (both keep that layer, and `ghosts` more of the neighbour's) and writes both pieces.
void write_halves(const DatasetPtr& d, const std::string& name, const std::string& extension, size_t at, size_t ghosts = 0) {
  const auto dims = lattice_dims(d->mesh());
  const std::array<size_t, 3> last{dims[0] - 1, dims[1] - 1, dims[2] - 1};
  for (int half = 0; half < 2; ++half) {
    const size_t lo = half ? at - ghosts : 0, hi = half ? last[0] : at + ghosts;
    const DatasetPtr part = crop_lattice(*d, {lo, 0, 0}, {hi, last[1], last[2]});
    DatasetParts p = part->parts();
    if (ghosts > 0) {
      const size_t nx = hi - lo, rows = part->cell_count() / nx;
      std::vector<uint8_t> bits(part->cell_count());
      std::vector<int32_t> id(part->cell_count());
      for (size_t i = 0; i < bits.size(); ++i) {
        const size_t x = lo + i % nx;
        bits[i] = (half ? x < at : x >= at) ? ghost_duplicate : 0;
        id[i] = bits[i] ? -1 : p.fields.find("id")->array.view<int32_t>()[i];  // what a stale copy may hold
      }
      CHECK(rows > 0);
      p.cell_ghost = Array::from_vector(std::move(bits));
      p.fields.add({"id", Association::cell, Array::from_vector(std::move(id)), {}, Role::none});
    }
    write(temp(name + std::to_string(half) + "." + extension), make_dataset(std::move(p)));
  }
}

std::string extent(const std::array<size_t, 3>& d) {
  return "WholeExtent=\"0 " + std::to_string(d[0] - 1) + " 0 " + std::to_string(d[1] - 1) + " 0 " + std::to_string(d[2] - 1) + "\"";
}

DatasetPtr read_parallel(const std::string& name, const std::string& text, const ReadOptions& options = {}) {
  write_file(temp(name), text);
  return read(temp(name), options);
}

}  // namespace

TEST_CASE("vtk parallel: the pieces of a grid are assembled to the grid they were cut from") {
  RectilinearGrid r;
  r.x = numbers<double>({0, 1, 3, 4, 9}), r.y = numbers<double>({0, 1, 2}), r.z = numbers<double>({5, 6});
  CurvilinearGrid c;
  c.dims = {5, 3, 2}, c.points.xyz = ramp<float>(30, 3, 0.1);
  const std::tuple<Mesh, const char*, const char*, const char*> kinds[] = {
      {image(5, 3, 2), "vti", "ImageData", "Origin=\"1 2 3\" Spacing=\"0.5 0.25 2\""},
      {r, "vtr", "RectilinearGrid", ""},
      {c, "vts", "StructuredGrid", ""}};
  for (const auto& [mesh, extension, type, attributes] : kinds) {
    CAPTURE(extension);
    const DatasetPtr d = lattice(mesh);
    for (const size_t ghosts : {0, 1}) {
      write_halves(d, "half", extension, 2, ghosts);
      const std::string name = std::string("whole.p") + extension;
      const std::string e = extension;
      const DatasetPtr back = read_parallel(name, parallel(type, extent({5, 3, 2}) + " " + attributes, {"half0." + e, "half1." + e}));
      check_same_mesh(d->mesh(), back->mesh());
      for (const Field& f : d->fields()) {
        const Field* g = back->fields().find(f.name, f.association);
        REQUIRE(g);
        CHECK(same(f.array, g->array));
      }
      if (ghosts == 0) CHECK(back->cell_ghost().empty());
      for (size_t i = 0; i < back->cell_ghost().count(); ++i) CHECK(back->cell_ghost().get(i) == 0);
    }
  }
}

TEST_CASE("vtk parallel: a region of the pieces is the region of the whole") {
  const DatasetPtr d = lattice(image(9, 5, 4));
  write_halves(d, "reg", "vti", 4);
  const std::string text = parallel("ImageData", extent({9, 5, 4}) + " Origin=\"1 2 3\" Spacing=\"0.5 0.25 2\"", {"reg0.vti", "reg1.vti"});
  const LatticeRegion regions[] = {{{0, 0, 0}, {3, 4, 3}, {1, 1, 1}}, {{2, 1, 1}, {7, 3, 2}, {1, 1, 1}}, {{5, 0, 0}, {8, 4, 3}, {1, 1, 1}},
                                   {{4, 0, 0}, {4, 4, 3}, {1, 1, 1}}, {{0, 0, 0}, {8, 4, 3}, {3, 2, 1}}, {{8, 0, 2}, {8, 4, 3}, {1, 1, 1}}};
  for (const LatticeRegion& region : regions) {
    ReadOptions options;
    options.region = region;
    CAPTURE(region.lo[0]);
    CAPTURE(region.hi[0]);
    const DatasetPtr part = read_parallel("reg.pvti", text, options), cut = crop_lattice(*d, region.lo, region.hi, region.stride);
    check_same_mesh(cut->mesh(), part->mesh());
    CHECK(part->fields().size() == cut->fields().size());
    for (const Field& f : cut->fields()) {
      REQUIRE(part->fields().find(f.name, f.association));
      CHECK(same(f.array, part->fields().find(f.name, f.association)->array));
    }
    CHECK(part->cell_ghost().empty());
  }
}

TEST_CASE("vtk parallel: unstructured and polygonal pieces become one mesh, ghosts marked") {
  DatasetParts a;
  a.mesh = tetra_mesh(4);
  a.fields.add({"T", Association::point, ramp<float>(7), {}, Role::none});
  a.fields.add({"c", Association::cell, ramp<double>(4, 3), {}, Role::none});
  a.fields.add({"only here", Association::cell, ramp<double>(4), {}, Role::none});
  DatasetParts b = a;
  b.cell_ghost = numbers<uint8_t>({1, 0, 0, 1});
  b.fields.remove("only here", Association::cell);
  write(temp("u0.vtu"), make_dataset(a));
  write(temp("u1.vtu"), make_dataset(b));
  Context context;
  std::string warnings;
  context.on_log = [&](LogLevel, std::string_view t) { warnings += t; };
  write_file(temp("u.pvtu"), parallel("UnstructuredGrid", "GhostLevel=\"1\"", {"u0.vtu", "u1.vtu"}));
  const DatasetPtr d = std::get<DatasetPtr>(read_data(temp("u.pvtu"), {}, context));
  CHECK(warnings.find("'only here'") != std::string::npos);
  CHECK(d->point_count() == 14);
  CHECK(d->cell_count() == 8);
  const auto* m = d->as<UnstructuredMesh>();
  REQUIRE(m);
  CHECK(cells_view(m->cells).point(4, 0) == 7);
  CHECK(d->fields().require("c").array.get(5, 1) == 4);
  REQUIRE(d->cell_ghost().count() == 8);
  const uint8_t want[] = {0, 0, 0, 0, 1, 0, 0, 1};
  for (size_t i = 0; i < 8; ++i) CHECK(d->cell_ghost().get(i) == want[i]);

  DatasetParts s;
  s.mesh = surface_mesh();
  s.fields.add({"k", Association::cell, ramp<int32_t>(make_dataset(s)->cell_count()), {}, Role::none});
  write(temp("s0.vtp"), make_dataset(s));
  write(temp("s1.vtp"), make_dataset(s));
  const DatasetPtr p = read_parallel("s.pvtp", parallel("PolyData", "", {"s0.vtp", "s1.vtp"}));
  const auto* surface = p->as<SurfaceMesh>();
  REQUIRE(surface);
  CHECK(surface->vertices.size() == 6);
  CHECK(surface->strips.size() == 2);
  // Vertices of both, then lines of both, ...: the cell numbers follow.
  const int32_t k[] = {0, 1, 2, 0, 1, 2, 3, 4, 3, 4, 5, 6, 5, 6, 7, 7};
  for (size_t i = 0; i < 16; ++i) CHECK(p->fields().require("k").array.get(i) == k[i]);
}

TEST_CASE("vtk parallel: a process reads its share of the pieces, and all shares make the whole") {
  std::vector<std::string> sources;
  for (int i = 0; i < 5; ++i) {
    DatasetParts p;
    p.mesh = tetra_mesh(size_t(i) + 1);
    sources.push_back("share" + std::to_string(i) + ".vtu");
    write(temp(sources.back()), make_dataset(p));
  }
  write_file(temp("share.pvtu"), parallel("UnstructuredGrid", "", sources));
  for (const int pieces : {1, 2, 3, 5, 8}) {
    size_t cells = 0;
    for (int i = 0; i < pieces; ++i) {
      ReadOptions o;
      o.piece = i, o.pieces = pieces;
      cells += read(temp("share.pvtu"), o)->cell_count();
    }
    CHECK(cells == 15);
  }
  ReadOptions o;
  o.piece = 3, o.pieces = 3;
  CHECK(error_of([&] { read(temp("share.pvtu"), o); }).find("piece 3 of 3") != std::string::npos);
}

TEST_CASE("vtk parallel: of missing pieces the others are read with a warning") {
  write_halves(lattice(image(5, 3, 2)), "part", "vti", 2);
  Context context;
  std::string warned;
  context.on_log = [&](LogLevel level, std::string_view text) { warned += level == LogLevel::warning ? std::string(text) : ""; };
  write_file(temp("part.pvti"), parallel("ImageData", extent({5, 3, 2}), {"part0.vti", "gone.vti"}));
  const Data half = read_data(temp("part.pvti"), {}, context);
  CHECK(warned.find("1 of the 2 files that it names is missing (") != std::string::npos);
  const DatasetPtr d = std::get<DatasetPtr>(half);
  CHECK(d->point_count() == 18);  // the first three of five layers
}

TEST_CASE("vtk parallel: absent, repeated and foreign pieces are refused by name") {
  const DatasetPtr d = lattice(image(3, 3, 3));
  write(temp("one.vti"), d);
  auto error = [&](const std::string& text) {
    write_file(temp("bad.pvti"), text);
    return error_of([&] { read(temp("bad.pvti")); });
  };
  CHECK(error(parallel("ImageData", extent({3, 3, 3}), {"gone.vti"})).find("gone.vti") != std::string::npos);
  CHECK(error(parallel("ImageData", extent({3, 3, 3}), {"one.vti", "one.vti"})).find("second time") != std::string::npos);
  CHECK(error(parallel("ImageData", extent({3, 3, 3}), {"bad.pvti"})).find("PImageData") != std::string::npos);
  CHECK(error(parallel("ImageData", extent({3, 3, 3}), {""})).find("Source") != std::string::npos);
  CHECK(error(parallel("RectilinearGrid", extent({3, 3, 3}), {"one.vti"})).find("one.vti") != std::string::npos);
  CHECK(error(parallel("ImageData", "WholeExtent=\"0 1\"", {"one.vti"})).find("WholeExtent") != std::string::npos);
  CHECK(error(parallel("ImageData", extent({3, 3, 3}), {})).find("no Piece") != std::string::npos);
}

TEST_CASE("vtk parallel: a file cut or changed anywhere reads or gives an Error") {
  const DatasetPtr d = lattice(image(5, 3, 2));
  write_halves(d, "cutp", "vti", 2);
  const std::string text = parallel("ImageData", extent({5, 3, 2}), {"cutp0.vti", "cutp1.vti"});
  size_t errors = 0;
  auto attempt = [&](const std::string& t) {
    write_file(temp("cutp.pvti"), t);
    try {
      read(temp("cutp.pvti"));
    } catch (const Error& e) {
      ++errors;
      CHECK(e.kind() == ErrorKind::data);
    }
  };
  for (size_t i = 1; i < 64; ++i) attempt(text.substr(0, text.size() * i / 64));
  CHECK(errors == 63);
  for (size_t i = 0; i < text.size(); ++i)
    for (const char c : {'\0', '0', '"', '\xff'}) {
      std::string bent = text;
      bent[i] = c;
      attempt(bent);
    }
  CHECK(errors > 200);
}

TEST_CASE("vtk parallel: blood vessels agree with what VTK says of them" * doctest::skip(no_data())) {
  Context context;
  const DatasetPtr d = std::get<DatasetPtr>(read_data(data_file("meshes/parallel/blood_vessels/T0000000500.pvtu"), {}, context));
  CHECK(d->point_count() == 48823);
  CHECK(d->cell_count() == 39353);
  CHECK(d->bounds().lo == Vec3(53, 50, 64));
  CHECK(d->bounds().hi == Vec3(121, 97, 182));
  CHECK(d->range(d->fields().require("density")).hi == doctest::Approx(0.5231892466545105).epsilon(1e-12));
  CHECK(d->range(d->fields().require("velocity"), 2).lo == doctest::Approx(-0.36065810918807983).epsilon(1e-12));
  ReadOptions o;
  o.fields = {"density"};
  CHECK(std::get<DatasetPtr>(read_data(data_file("meshes/parallel/blood_vessels/T0000000500.pvtu"), o, context))->fields().size() == 1);
}

TEST_CASE("vtk parallel: a collection is written as the pieces of one mesh") {
  DatasetParts a, b;
  a.mesh = tetra_mesh(3);
  a.fields.add({"T", Association::point, ramp<float>(6), {}, Role::scalars});
  a.fields.add({"mine", Association::cell, ramp<float>(3), {}, Role::none});
  b.mesh = mixed_mesh();
  b.fields.add({"T", Association::point, ramp<float>(12), {}, Role::scalars});
  b.cell_ghost = numbers<uint8_t>({0, 1, 0});
  auto c = std::make_shared<Collection>();
  c->parts.push_back({"a", make_dataset(a)});
  c->parts.push_back({"b", make_dataset(b)});
  Context context;
  write_data(temp("pieces.pvtu"), CollectionPtr(c), {VtkEncoding::appended, Compression::zlib}, context);
  const DatasetPtr d = read(temp("pieces.pvtu"));
  CHECK(d->point_count() == 18);
  CHECK(d->cell_count() == 6);
  CHECK(d->fields().require("T").array.get(6) == 0);
  CHECK(d->cell_ghost().get(4) == ghost_duplicate);
  CHECK(d->cell_ghost().get(0) == 0);
  CHECK(d->as<UnstructuredMesh>()->points.xyz.type() == ElementType::f64);
  CHECK(error_of([&] { write_data(temp("no.pvtp"), CollectionPtr(c), {}, context); }).find("part 'a'") != std::string::npos);
  CHECK(error_of([&] { write_data(temp("no.pvti"), CollectionPtr(c), {}, context); }).find(".vtm") != std::string::npos);
  CHECK(!file_exists(temp("no")));
}
