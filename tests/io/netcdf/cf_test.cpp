// SPDX-License-Identifier: Apache-2.0
// CF grids and MINC volumes in small classic netCDF files.
#include "data/lattice.h"
#include "data/lattice_crop.h"
#include "io/io_files.h"
#include "netcdf_bytes.h"

using namespace sg;
using namespace sg::test;

namespace {

// t(time, lat, lon) = 100 time + 10 lat + lon on a 4 x 3 grid, 2 steps, one value missing, packed as i16.
NcBytes packed_grid(int version) {
  NcBytes f(version);
  const int time = f.dim("time", 0), lat = f.dim("lat", 3), lon = f.dim("lon", 4), nv = f.dim("nv", 2);
  f.records(2).att("title", "a test").att("Conventions", "CF-1.8");
  std::vector<int16_t> t;
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 4; ++i) t.push_back(int16_t(k == 1 && j == 2 && i == 3 ? -999 : 100 * k + 10 * j + i));
  f.var<double>("time", {time}, {15, 45}).att("units", "days since 2001-1-1").att("calendar", "360_day");
  f.var<double>("lon", {lon}, {10, 20, 30, 40}).att("units", "degrees_east").att("bounds", "lon_bnds");
  f.var<double>("lon_bnds", {lon, nv}, {5, 15, 15, 25, 25, 35, 35, 45});
  f.var<float>("lat", {lat}, {-10, 0, 20}).att("units", "degrees_north");
  f.var<int16_t>("t", {time, lat, lon}, t)
      .att("units", "K")
      .num("_FillValue", {-999.})
      .num("scale_factor", {0.1})
      .num("add_offset", {273.});
  f.var<float>("level", {lat}, {7, 8, 9});
  return f;
}

}  // namespace

TEST_CASE("netcdf: flags are labels with their meanings as names") {
  const auto file = [](bool masks) {
    NcBytes f(1);
    const int lat = f.dim("lat", 2), lon = f.dim("lon", 3);
    f.var<double>("lon", {lon}, {10, 20, 30}).att("units", "degrees_east");
    f.var<double>("lat", {lat}, {0, 10}).att("units", "degrees_north");
    auto& v =
        f.var<int16_t>("surface", {lat, lon}, {1, 2, 2, 1, 4, 4}).num("flag_values", {1., 2., 4.}).att("flag_meanings", "sea land sea_ice");
    if (masks) v.num("flag_masks", {1., 2., 4.});
    return f.bytes();
  };
  const DatasetPtr d = read_text("flags.nc", file(false));
  CHECK(d->fields().require("surface").role == Role::labels);
  const std::pair<std::string, std::string> names("labels of surface", "1=sea\n2=land\n4=sea ice");
  CHECK(std::find(d->notes().begin(), d->notes().end(), names) != d->notes().end());
  CHECK(read_text("masks.nc", file(true))->fields().require("surface").role != Role::labels);
}

TEST_CASE("netcdf: classes are named line by line from valid_min on, and floats stay floats") {
  const auto file = [](double last) {
    NcBytes f(1);
    const int lat = f.dim("lat", 2), lon = f.dim("lon", 3);
    f.var<double>("lon", {lon}, {10, 20, 30}).att("units", "degrees_east");
    f.var<double>("lat", {lat}, {0, 10}).att("units", "degrees_north");
    f.var<float>("basin", {lat, lon}, {1, 2, 2, 3, -99, 3})
        .num("missing_value", {-99.})
        .num("valid_min", {1.})
        .num("valid_max", {last})
        .att("CLIST", "Atlantic Ocean\nPacific Ocean \nIndian Ocean");
    return f.bytes();
  };
  const DatasetPtr d = read_text("classes.nc", file(3));
  const Field& basin = d->fields().require("basin");
  CHECK(basin.role == Role::labels);
  CHECK(basin.array.type() == ElementType::f32);
  CHECK(std::isnan(basin.array.get(4)));
  const std::pair<std::string, std::string> names("labels of basin", "1=Atlantic Ocean\n2=Pacific Ocean\n3=Indian Ocean");
  CHECK(std::find(d->notes().begin(), d->notes().end(), names) != d->notes().end());
  CHECK(read_text("classes.nc", file(4))->fields().require("basin").role != Role::labels);
}

TEST_CASE("netcdf: a packed variable on a longitude-latitude grid is unpacked, with NaN for the missing value") {
  for (const int version : {1, 2, 5}) {
    CAPTURE(version);
    ReadOptions o;
    o.step = 1;
    const DatasetPtr d = read_text("packed.nc", packed_grid(version).bytes(), o);
    const auto* g = d->as<RectilinearGrid>();
    REQUIRE(g);
    CHECK(g->dims() == std::array<size_t, 3>{4, 3, 1});
    CHECK(g->x.get(3) == 40);
    CHECK(g->y.type() == ElementType::f32);
    CHECK(g->y.get(2) == 20);
    const Field& t = d->fields().require("t");
    CHECK(t.unit == "K");
    CHECK(t.array.type() == ElementType::f64);  // 0.1 is no float
    for (size_t p = 0; p < 11; ++p) CHECK(t.array.get(p) == doctest::Approx(273 + 0.1 * double(100 + 10 * (p / 4) + p % 4)).epsilon(1e-14));
    CHECK(std::isnan(t.array.get(11)));
    REQUIRE(d->time());
    CHECK(*d->time() == 45);
    CHECK(d->fields().find("lon_bnds") == nullptr);
    const Field& level = d->fields().require("level");  // a profile along an axis
    CHECK(level.association == Association::whole);
    CHECK(level.array.count() == 3);
    std::string notes;
    for (const auto& [k, v] : d->notes()) notes += k + "=" + v + ";";
    CHECK(contains(notes, "title=a test;"));
    CHECK(contains(notes, "time=days since 2001-1-1 (360_day calendar);"));
    CHECK(contains(notes, "x axis=lon, degrees_east"));
  }
}

TEST_CASE("netcdf: times are told, a step is chosen by time, and one too far is refused") {
  const std::string path = temp_file("steps.nc", packed_grid(1).bytes());
  Context context;
  CHECK(file_times(path, {}, context) == std::vector<double>{15, 45});
  ReadOptions o;
  o.time = 40;
  CHECK(*read_file(path, o)->time() == 45);
  o = {};
  o.step = 2;
  CHECK(contains(error_of([&] { read_file(path, o); }), "no time step 2"));
}

TEST_CASE("netcdf: only the fields that are asked for are read") {
  ReadOptions o;
  o.fields = {"t"};
  CHECK(read_text("some.nc", packed_grid(1).bytes(), o)->fields().names() == std::vector<std::string>{"t"});
  o.header_only = true;
  check_names_alone(temp_file("some.nc", packed_grid(1).bytes()), o);
  check_names_alone(temp_file("some.nc", packed_grid(1).bytes()));
}

TEST_CASE("netcdf: equally spaced axes make a uniform grid, whatever the order of the dimensions") {
  NcBytes f;
  const int x = f.dim("x", 3), y = f.dim("y", 2), z = f.dim("depth", 2);
  f.var<double>("x", {x}, {0, 2, 4}).var<double>("y", {y}, {5, 6}).var<double>("depth", {z}, {10, 20}).att("positive", "down");
  std::vector<int32_t> v;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 2; ++k) v.push_back(i + 10 * j + 100 * k);
  f.var<int32_t>("v", {x, y, z}, v);  // x slowest
  const DatasetPtr d = read_text("order.nc", f.bytes());
  const auto* g = d->as<UniformGrid>();
  REQUIRE(g);
  CHECK(g->dims == std::array<size_t, 3>{3, 2, 2});
  CHECK(g->spacing == Vec3(2, 1, 10));
  CHECK(g->origin == Vec3(0, 5, 10));
  const Field& field = d->fields().require("v");
  CHECK(field.array.type() == ElementType::i32);
  for (size_t p = 0; p < 12; ++p) CHECK(field.array.get(p) == double(p % 3 + 10 * (p / 3 % 2) + 100 * (p / 6)));
}

TEST_CASE("netcdf: a region with strides is the same as the whole cut afterwards") {
  NcBytes f;
  const int x = f.dim("x", 7), y = f.dim("y", 5), z = f.dim("z", 6), time = f.dim("time", 2);
  std::vector<double> along;
  for (int i = 0; i < 7; ++i) along.push_back(i * i);
  std::vector<float> v(2 * 7 * 5 * 6);
  for (size_t i = 0; i < v.size(); ++i) v[i] = float(i);
  f.var<double>("x", {x}, along).var<double>("y", {y}, {0, 1, 2, 3, 4}).var<double>("z", {z}, {0, 1, 2, 3, 4, 5});
  f.var<double>("time", {time}, {1, 2});
  f.var<float>("a", {time, z, y, x}, v)
      .var<float>("b", {time, x, z, y}, v)
      .var<float>("c", {y, x}, std::vector<float>(v.begin(), v.begin() + 35));
  const std::string path = temp_file("region.nc", f.bytes());
  Context context;
  for (const std::array<size_t, 3> stride : {std::array<size_t, 3>{1, 1, 1}, {2, 1, 1}, {1, 1, 3}, {3, 2, 2}}) {
    ReadOptions o;
    o.step = 1;
    o.fields = {"a", "b"};
    const auto whole = std::get<DatasetPtr>(read_data(path, o, context));
    o.region.lo = {1, 1, 2}, o.region.hi = {5, SIZE_MAX, 5}, o.region.stride = stride;
    const auto part = std::get<DatasetPtr>(read_data(path, o, context));
    const DatasetPtr cut = crop_lattice(*whole, o.region.lo, o.region.hi, stride);
    CHECK(whole->fields().size() == 2);  // and not the grid of c
    CHECK(lattice_dims(part->mesh()) == lattice_dims(cut->mesh()));
    CHECK(same_array(part->as<RectilinearGrid>()->x, cut->as<RectilinearGrid>()->x));
    for (const char* name : {"a", "b"}) CHECK(same_array(part->fields().require(name).array, cut->fields().require(name).array));
  }
}

TEST_CASE("netcdf: listed longitudes and latitudes make a curvilinear grid; points without a place are hidden") {
  NcBytes f;
  const int j = f.dim("j", 2), i = f.dim("i", 3);
  const float none = 1e20f;
  f.var<float>("lon", {j, i}, {0, 1, 2, 0, 1, none}).att("units", "degrees_east").num32("_FillValue", none);
  f.var<float>("lat", {j, i}, {0, 0.5, 1, 2, 2.5, none}).att("units", "degrees_north").num32("_FillValue", none);
  f.var<float>("s", {j, i}, {1, 2, 3, 4, 5, none}).att("coordinates", "lat lon").num32("missing_value", none);
  const DatasetPtr d = read_text("curved.nc", f.bytes());
  const auto* g = d->as<CurvilinearGrid>();
  REQUIRE(g);
  CHECK(g->dims == std::array<size_t, 3>{3, 2, 1});
  CHECK(g->points.at(4).x == 1);
  CHECK(g->points.at(4).y == 2.5);
  REQUIRE(d->cell_ghost().count() == 2);
  CHECK(d->cell_ghost().get(0) == 0);
  CHECK(d->cell_ghost().get(1) == ghost_hidden_cell);
  CHECK(d->fields().names() == std::vector<std::string>{"s"});
  CHECK(std::isnan(d->fields()[0].array.get(5)));
}

TEST_CASE("netcdf: cells with bounds become polygons that share their corners, without bounds a cloud of points") {
  for (const bool bounded : {true, false}) {
    NcBytes f;
    const int cell = f.dim("cell", 2), nv = f.dim("nv", 4);
    f.var<double>("lon", {cell}, {0.5, 1.5}).att("units", "degrees_east");
    if (bounded) f.att("bounds", "blon");
    f.var<double>("lat", {cell}, {0.5, 0.5}).att("units", "degrees_north");
    if (bounded) f.att("bounds", "blat");
    f.var<double>("blon", {cell, nv}, {0, 1, 1, 0, 1, 2, 1, 1});
    f.var<double>("blat", {cell, nv}, {0, 0, 1, 1, 0, 0, 1, 1});
    f.var<double>("a", {cell}, {3, 4}).att("coordinates", "lon lat");
    ReadOptions o;
    o.fields = {"a"};
    Context context;
    const Data data = read_data(temp_file("cells.nc", f.bytes()), o, context);
    DatasetPtr d;
    for_each_dataset(data, [&](const std::string&, const DatasetPtr& part) { d = d ? d : part; });
    if (bounded) {
      CHECK(d->point_count() == 5);
      CHECK(d->cell_count() == 2);
      const CellsView cells = cells_view(d->as<UnstructuredMesh>()->cells);
      CHECK(cells.size(0) == 4);
      CHECK(cells.size(1) == 3);  // its last corner is there twice
      CHECK(d->fields().require("a").association == Association::cell);
    } else {
      REQUIRE(d->as<PointCloud>());
      CHECK(d->bounds().hi.x == 1.5);
      CHECK(d->fields().require("a").association == Association::point);
    }
  }
}

TEST_CASE("netcdf: variables on different grids become parts, that with most variables first") {
  NcBytes f;
  const int x = f.dim("x", 3), y = f.dim("y", 2), xf = f.dim("xf", 4);
  f.var<double>("u", {y, xf}, std::vector<double>(8, 1));
  f.var<double>("a", {y, x}, std::vector<double>(6, 2)).var<double>("b", {y, x}, std::vector<double>(6, 3));
  Context context;
  const Data data = read_data(temp_file("two.nc", f.bytes()), {}, context);
  const auto* c = std::get_if<CollectionPtr>(&data);
  REQUIRE(c);
  REQUIRE((*c)->parts.size() == 2);
  CHECK((*c)->parts[0].name == "y x x");
  CHECK((*c)->parts[1].name == "y x xf");
}

TEST_CASE("netcdf: what holds no grid is refused by name") {
  NcBytes f;
  f.dim("n", 1);
  f.var<double>("one", {0}, {1});
  const std::string message = refusal("none.nc", f.bytes());
  CAPTURE(message);
  CHECK(contains(message, "contains no variable on a grid"));
}

TEST_CASE("netcdf: cut and damaged files are refused or read, never more") {
  CHECK(cut_and_damage("hurt.nc", packed_grid(1).bytes()) == 63);
  CHECK(cut_and_damage("hurt.nc", packed_grid(5).bytes()) == 63);
  // Each of the first bytes, two ways.
  const std::string good = packed_grid(2).bytes();
  Context context;
  for (size_t k = 4; k < 200; ++k)
    for (const int flip : {0xff, 0x80}) {
      std::string bad = good;
      bad[k] = char(bad[k] ^ flip);
      try {
        read_data(temp_file("flip.nc", bad), {}, context);
      } catch (const Error& e) {
        CHECK(e.kind() != ErrorKind::internal);
      }
    }
}

TEST_CASE("netcdf: sizes that the file cannot back are told with the variable") {
  const std::string good = packed_grid(1).bytes();
  // The length of dimension lat (second in the list): a name of 3 bytes, then the length.
  const size_t at = good.find("lat") + 4;
  for (const uint32_t n : {0x7fffffffu, 0x80000000u, 0xffffffffu}) {
    std::string bad = good;
    for (size_t k = 0; k < 4; ++k) bad[at + k] = char(n >> (24 - 8 * k));
    const std::string message = refusal("huge.nc", bad);
    CAPTURE(message);
    CHECK(contains(message, "huge.nc"));
    CHECK(contains(message, "variable"));
  }
  CHECK(contains(refusal("cut.nc", good.substr(0, good.size() - 8)), "the file at byte"));
}

namespace {

// Slices of a volume along z, y, x with scaling per slice: stored 0..1000 means 0..10 in slice 0 and 100..200 in slice 1.
std::string minc(bool flipped) {
  NcBytes f;
  const int z = f.dim("zspace", 2), y = f.dim("yspace", 2), x = f.dim("xspace", 3);
  f.var<int32_t>("rootvariable", {}, {0});
  f.var<double>("xspace", {}, {0}).num("start", {-5.}).num("step", {flipped ? -2. : 2.});
  f.var<double>("yspace", {}, {0}).num("start", {1.}).num("step", {1.});
  f.var<double>("zspace", {}, {0}).num("start", {7.}).num("step", {3.});
  f.var<double>("image-min", {z}, {0, 100}).var<double>("image-max", {z}, {10, 200});
  f.var<int16_t>("image", {z, y, x}, {0, 100, 200, 300, 400, 1000, 0, 10, 20, 30, 40, 1000}).num("valid_range", {0., 1000.});
  f.att("signtype", "signed__");
  return f.bytes();
}

}  // namespace

TEST_CASE("minc: slices are scaled by their own image-min and image-max") {
  const DatasetPtr d = read_text("a.mnc", minc(false));
  const auto* g = d->as<UniformGrid>();
  REQUIRE(g);
  CHECK(g->dims == std::array<size_t, 3>{3, 2, 2});
  CHECK(g->spacing == Vec3(2, 1, 3));
  CHECK(g->origin == Vec3(5, -1, 7));  // MINC's x is to the right, y to the front
  const Field& image = d->fields().require("image");
  CHECK(image.role == Role::scalars);
  CHECK(image.array.get(1) == doctest::Approx(1));
  CHECK(image.array.get(5) == doctest::Approx(10));
  CHECK(image.array.get(7) == doctest::Approx(101));
  CHECK(image.array.get(11) == doctest::Approx(200));
  const Field& stored = d->fields().require("ImageScalars");
  CHECK(stored.array.type() == ElementType::i16);
  CHECK(stored.array.get(5) == 1000);
}

TEST_CASE("minc: a negative step turns the axis, the world position of each voxel stays") {
  const DatasetPtr d = read_text("b.mnc", minc(true));
  const Lattice lattice(d->mesh());
  const Vec3 p = lattice.view().position(2, 1, 1);
  CHECK(p.x == doctest::Approx(9));
  CHECK(p.y == doctest::Approx(-2));
  CHECK(p.z == doctest::Approx(10));
}

TEST_CASE("minc: damaged volumes are refused or read") { CHECK(cut_and_damage("hurt.mnc", minc(false)) == 63); }
