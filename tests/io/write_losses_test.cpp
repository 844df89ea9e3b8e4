// SPDX-License-Identifier: Apache-2.0
// What a writer cannot keep, it says: random data are written in every format and read again, and each difference was in a warning.
#include "io/write_losses.h"

#include <algorithm>
#include <map>

#include "data/cells/point_positions.h"
#include "io_files.h"
#include "support/property.h"

using namespace sg;
using namespace sg::test;

namespace {

constexpr ElementType types[] = {ElementType::u8,  ElementType::i8,  ElementType::u16, ElementType::i16, ElementType::u32,
                                 ElementType::i32, ElementType::u64, ElementType::i64, ElementType::f32, ElementType::f64};

std::string random_name(Random& random, int number) {
  static const char* const names[] = {"T",        "wind speed", "a/b",        "p'",    "größe",      "x<y&z>", "id",
                                      "rho.mean", "100%",       "press (Pa)", "c,d",   "quote\"",    "::n",    "a=b",
                                      "T_0",      "温度",       "back\\",     "semi;", "two\nlines", " lead"};
  const std::string name = names[random.whole(0, int(std::size(names)) - 1)];
  return random.chance(0.3) ? name + std::to_string(number) : name;
}

Array random_values(Random& random, size_t count, int components) {
  const ElementType type = types[random.whole(0, 9)];
  const bool large = random.chance(0.4), broken = random.chance(0.3);
  std::byte* out = nullptr;
  Array a = Array::make_raw(type, count, components, &out);
  dispatch(a, [&](auto v) {
    using T = std::remove_cvref_t<decltype(v[0])>;
    T* to = reinterpret_cast<T*>(out);
    for (size_t i = 0; i < count * size_t(components); ++i) {
      if constexpr (std::is_floating_point_v<T>) {
        to[i] = large ? T(random.in(-1, 1) * 1e20) : T(random.whole(-1000, 1000)) / 8;
        if (broken && random.chance(0.05))
          to[i] = random.chance(0.5) ? std::numeric_limits<T>::quiet_NaN() : std::numeric_limits<T>::infinity();
      } else {
        const double top = large ? double(std::numeric_limits<T>::max()) * 0.9 : std::min(100.0, double(std::numeric_limits<T>::max()));
        to[i] = T(random.in(std::is_signed_v<T> ? -top : 0, top));
      }
    }
  });
  return a;
}

void add_fields(DatasetParts& parts, Random& random) {
  const Mesh& mesh = parts.mesh;
  const size_t points = point_count(mesh), cells = cell_count(mesh);
  const int n = random.whole(1, 5);
  for (int i = 0; i < n; ++i) {
    const Association a =
        i == 0 ? Association::point : random.one_of({Association::point, Association::point, Association::cell, Association::whole});
    if (a == Association::cell && cells == 0) continue;
    const int components = random.one_of({1, 1, 1, 2, 3, 3, 4, 6, 9});
    const size_t count = a == Association::point ? points : a == Association::cell ? cells : 3;
    const Array values = random_values(random, count, components);
    Role role = Role::none;
    if (components == 3 && is_float(values.type()) && random.chance(0.3)) role = random.chance(0.5) ? Role::vectors : Role::normals;
    if (components == 1 && random.chance(0.2)) role = Role::scalars;
    if (components == 2 && is_float(values.type()) && random.chance(0.3)) role = Role::tcoords;
    if ((components == 3 || components == 4) && values.type() == ElementType::u8 && random.chance(0.6)) role = Role::colors;
    parts.fields.add({random_name(random, i), a, values, random.chance(0.3) ? random.one_of({"m/s", "K", "µm"}) : "", role});
  }
}

Mesh grid(Random& random) {
  UniformGrid g;
  for (size_t& n : g.dims) n = size_t(random.whole(2, 5));
  g.spacing = {0.5, 0.25, 1}, g.origin = {1, 2, 3};
  return g;
}

Points some_points(Random& random, size_t n, bool wide) {
  Points p;
  std::vector<double> xyz;
  for (size_t i = 0; i < 3 * n; ++i) xyz.push_back(wide ? random.in(-1, 1) : random.whole(-64, 64) / 16.0);
  p.xyz = Array::from_vector(xyz, 3);
  if (!wide) p.xyz = p.xyz.converted(ElementType::f32);
  return p;
}

Mesh surface(Random& random) {
  SurfaceMesh s;
  const int n = random.whole(4, 9);
  s.points = some_points(random, size_t(n), random.chance(0.5));
  std::vector<int64_t> ids;
  const int triangles = random.whole(1, 6);
  for (int i = 0; i < triangles; ++i)
    for (int k = 0; k < 3; ++k) ids.push_back((i + k) % n);
  s.polygons.connectivity = Array::from_vector(ids), s.polygons.fixed = 3;
  return s;
}

Mesh cells(Random& random) {
  UnstructuredMesh m;
  m.points = some_points(random, 8, random.chance(0.5));
  m.cells.connectivity = Array::from_vector(std::vector<int64_t>{0, 1, 2, 3, 4, 5, 6, 7}), m.cells.fixed = 4;
  m.single_type = CellType::tetra;
  return m;
}

Mesh rectilinear(Random& random) {
  RectilinearGrid g;
  g.x = g.y = g.z = Array::from_vector(std::vector<double>{0, 1, random.in(2, 3)});
  return g;
}

Mesh curvilinear(Random& random) {
  CurvilinearGrid g;
  g.dims = {2, 3, 2};
  g.points = some_points(random, 12, random.chance(0.5));
  return g;
}

Mesh amr(Random&) {
  AmrGrid g;
  g.levels.resize(1);
  g.levels[0].patches = {{{0, 0, 0}, {1, 1, 1}, 0, 0}};
  return g;
}

Mesh cloud(Random& random) { return PointCloud{some_points(random, 7, random.chance(0.5))}; }

bool same_numbers(const Array& a, const Array& b) {
  if (a.count() != b.count() || a.components() != b.components()) return false;
  for (size_t i = 0; i < a.count(); ++i)
    for (int c = 0; c < a.components(); ++c) {
      // In 128 bits: all 64-bit integers and all floats are there.
      const auto number = [&](const Array& x) -> long double {
        if (x.type() == ElementType::i64) return static_cast<long double>(x.view<int64_t>()(i, c));
        if (x.type() == ElementType::u64) return static_cast<long double>(x.view<uint64_t>()(i, c));
        return static_cast<long double>(x.get(i, c));
      };
      const long double x = number(a), y = number(b);
      if (!(x == y || (std::isnan(x) && std::isnan(y)))) return false;
    }
  return true;
}

struct Writing {
  const char* extension;
  Mesh (*mesh)(Random&);
  const char* compression = "none";
  const char* encoding = "appended";
};
const Writing writings[] = {{"vti", grid},
                            {"vti", grid, "zlib", "base64"},
                            {"vti", grid, "none", "ascii"},
                            {"vtr", rectilinear},
                            {"vts", curvilinear},
                            {"vtu", cells},
                            {"vtp", surface},
                            {"vtp", cloud},
                            {"vthb", amr},
                            {"pvti", grid},
                            {"vtm", surface},
                            {"nrrd", grid},
                            {"nrrd", grid, "gzip"},
                            {"mha", grid},
                            {"mhd", grid},
                            {"nii", grid},
                            {"nii.gz", grid},
                            {"mnc", grid},
                            {"mnc", grid, "zlib"},
                            {"dcm", grid},
                            {"npy", grid},
                            {"vdb", grid},
                            {"zarr", grid},
                            {"ply", surface},
                            {"stl", surface},
                            {"obj", surface},
                            {"glb", surface},
                            {"gltf", cloud},
                            {"vtkhdf", grid},
                            {"vtkhdf", cells},
                            {"vtkhdf", surface},
                            {"vtkhdf", cloud},
                            {"vtkhdf", amr}};

// What went in and did not come out, one line a difference, with the word that a warning must have.
struct Difference {
  std::string word, what;
};
std::vector<Difference> differences(const Dataset& in, const Dataset& out, bool obj) {
  std::vector<Difference> r;
  for (const Field& f : in.fields()) {
    const Field* g = out.fields().find(f.name, f.association);
    const std::string word = "'" + f.name + "'";
    if (!g) r.push_back({word, "is gone"});
    else if (!same_numbers(f.array, g->array)) r.push_back({word, "has other values"});
    else if (f.unit != g->unit) r.push_back({word, "has the unit '" + g->unit + "'"});
  }
  // OBJ files hold all digits; their reader takes f32.
  const bool f32 = out.as<SurfaceMesh>() && out.as<SurfaceMesh>()->points.xyz.type() == ElementType::f32;
  if (in.point_count() == out.point_count() && !(obj && f32) && !same_numbers(point_positions(in.mesh()), point_positions(out.mesh())))
    r.push_back({"positions", "moved"});
  return r;
}

}  // namespace

TEST_CASE("property: whatever a writer loses, a warning names") {
  for (uint64_t seed : property_seeds(25))
    for (const Writing& w : writings) {
      CAPTURE(seed);
      CAPTURE(std::string(w.extension));
      CAPTURE(std::string(w.compression));
      Random random(seed);
      DatasetParts parts;
      parts.mesh = w.mesh(random);
      add_fields(parts, random);
      const DatasetPtr in = make_dataset(std::move(parts));
      std::vector<std::string> warnings;
      std::string all;
      Context ctx;
      ctx.on_log = [&](LogLevel level, std::string_view text) {
        if (level == LogLevel::warning) warnings.emplace_back(text), all += std::string(text) + "\n";
      };
      const std::string path = (getenv("SG_KEEP") ? std::string("/tmp/m3keep/") : temp_folder()) + "loss." + w.extension;
      WriteOptions options;
      options.compression = value_of_word<Compression>(w.compression), options.encoding = *value_of_word<VtkEncoding>(w.encoding),
      options.chunk = 8;
      const bool needs_scalar = std::string_view(w.extension) == "vdb" || std::string_view(w.extension) == "dcm";
      try {
        write_data(path, in, options, ctx);
      } catch (const Error& e) {
        CAPTURE(e.what());
        CHECK(needs_scalar);  // nothing that it can hold
        continue;
      }
      Context quiet;
      DatasetPtr out;
      for_each_dataset(read_data(path, {}, quiet), [&](const std::string&, const DatasetPtr& d) { out = d; });
      REQUIRE(out);
      CAPTURE(all);
      CHECK(warnings.size() <= 1);
      for (const Difference& d : differences(*in, *out, std::string_view(w.extension) == "obj")) {
        CAPTURE(d.word);
        CAPTURE(d.what);
        CHECK(all.find(d.word) != std::string::npos);
      }
      // And nothing is said of fields that came through.
      for (const Field& f : in->fields()) {
        const Field* g = out->fields().find(f.name, f.association);
        if (!g || !same_numbers(f.array, g->array) || f.unit != g->unit) continue;
        CAPTURE(f.name);
        CHECK(all.find("'" + f.name + "' (" + std::string(element_name(f.array.type()))) == std::string::npos);
      }
    }
}

TEST_CASE("writing: a cloud with a cell field, which has no values, gives a file that reads back") {
  Random random(1);
  FieldSet fields;
  fields.add({"c", Association::cell, Array::from_vector(std::vector<double>()), "", Role::scalars});
  Context ctx;
  write_data(temp_folder() + "cloud.vtp", make_dataset(cloud(random), fields), {}, ctx);
  CHECK(read_file(temp_folder() + "cloud.vtp")->point_count() == 7);
}

TEST_CASE("writing: ids within 2^24 lose nothing in f32, larger ones are named, and formats with integers keep them") {
  const auto write = [](const char* extension, std::vector<int64_t> ids, const Mesh& mesh) {
    FieldSet fields;
    ids.resize(point_count(mesh), 7);
    fields.add({"id", Association::point, Array::from_vector(ids), "", Role::none});
    std::string said;
    Context ctx;
    ctx.on_log = [&](LogLevel level, std::string_view text) {
      if (level == LogLevel::warning) said += text;
    };
    write_data(temp_folder() + "ids." + extension, make_dataset(mesh, fields), {}, ctx);
    return said;
  };
  Random random(1);
  const Mesh s = surface(random), g = grid(random);
  CHECK(write("ply", {int64_t(1) << 53}, s).empty());
  CHECK(write("ply", {(int64_t(1) << 53) + 1}, s).find("rounds 'id' (i64 to f64)") != std::string::npos);
  CHECK(write("glb", {int64_t(1) << 24}, s).find("'id'") == std::string::npos);
  CHECK(write("glb", {(int64_t(1) << 24) + 1}, s).find("'id' (i64 to f32)") != std::string::npos);
  CHECK(write("vdb", {(int64_t(1) << 53) + 1, INT64_MAX, INT64_MIN}, g).empty());
  CHECK(read_file(temp_folder() + "ids.vdb")->fields().require("id").array.view<int64_t>()[1] == INT64_MAX);
  CHECK(write("obj", {1}, s).find("leaves out 'id' (points)") != std::string::npos);
}

TEST_CASE("writing: whether numbers survive a conversion is exact at the edges") {
  const auto i64 = [](int64_t x) { return Array::from_vector(std::vector<int64_t>{x}); };
  CHECK(survives(i64(1 << 24), ElementType::f32));
  CHECK_FALSE(survives(i64((1 << 24) + 1), ElementType::f32));
  CHECK(survives(i64(INT64_MIN), ElementType::f64));
  CHECK_FALSE(survives(i64(INT64_MAX), ElementType::f64));
  CHECK_FALSE(survives(Array::from_vector(std::vector<uint64_t>{UINT64_MAX}), ElementType::f32));
  CHECK(survives(Array::from_vector(std::vector<uint64_t>{uint64_t(1) << 63}), ElementType::f32));
  CHECK_FALSE(survives(Array::from_vector(std::vector<uint64_t>{uint64_t(1) << 63}), ElementType::i64));
  CHECK(survives(Array::from_vector(std::vector<double>{NAN, HUGE_VAL, -0.0, 0.5}), ElementType::f32));
  CHECK_FALSE(survives(Array::from_vector(std::vector<double>{0.1}), ElementType::f32));
  CHECK_FALSE(survives(Array::from_vector(std::vector<double>{1e300}), ElementType::f32));
  CHECK_FALSE(survives(Array::from_vector(std::vector<double>{NAN}), ElementType::i32));
}
