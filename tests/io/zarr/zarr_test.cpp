// SPDX-License-Identifier: Apache-2.0
#include <blosc.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "data/bricked.h"
#include "io/bytes/inflate.h"
#include "io/io_files.h"
#include "io/zarr/zarr.h"

using namespace sg;
using namespace sg::test;

namespace {

std::string folder(const std::string& name) {
  const std::string path = temp_folder() + name;
  std::filesystem::remove_all(path);
  return path;
}

DatasetPtr ramp(std::array<size_t, 3> dims, ElementType type = ElementType::f32, int components = 1) {
  DatasetParts parts;
  UniformGrid g;
  g.dims = dims, g.origin = {1, -2, 3.5}, g.spacing = {0.5, 0.25, 2};
  parts.mesh = g;
  std::vector<double> v;
  for (size_t i = 0; i < dims[0] * dims[1] * dims[2] * size_t(components); ++i) v.push_back(double(i * 7919 % 251));
  parts.fields.add({"T", Association::point, Array::from_vector(std::move(v), components).converted(type), "K",
                    components == 3 ? Role::vectors : Role::scalars});
  parts.notes = {{"length unit", "mm"}, {"title", "a \"ramp\""}};
  return make_dataset(std::move(parts));
}

void write(const std::string& path, const DatasetPtr& d, const WriteOptions& options = {}) {
  Context context;
  write_data(path, d, options, context);
}

DatasetPtr read(const std::string& path, const ReadOptions& options = {}, size_t memory = 0) {
  Context context;
  context.memory_limit = memory;
  return std::get<DatasetPtr>(read_data(path, options, context));
}

// A Zarr 2 array of one chunk [2, 2, 3], described as `more` says.
std::string small_array(const std::string& name, std::string_view dtype, std::string_view compressor, std::string_view chunk,
                        std::string_view more = "") {
  const std::string path = folder(name);
  ::mkdir(path.c_str(), 0777);
  write_file(
      path + "/.zarray",
      fmt::format(R"({{"zarr_format": 2, "shape": [2, 2, 3], "chunks": [2, 2, 3], "dtype": "{}", "compressor": {}, "order": "C"{}}})",
                  dtype, compressor, more));
  if (!chunk.empty()) write_file(path + "/0.0.0", chunk);
  return path;
}

std::string bytes_of(const std::vector<float>& v) { return {reinterpret_cast<const char*>(v.data()), v.size() * 4}; }
const std::vector<float> twelve{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, -11.5f};

}  // namespace

TEST_CASE("zarr: what was written is read back, for all types, compressions and odd sizes") {
  for (const char* type : {"u8", "i8", "u16", "i16", "u32", "i32", "u64", "i64", "f32", "f64"}) {
    ElementType t;
    REQUIRE(parse_element_type(type, t));
    for (const auto& dims : {std::array<size_t, 3>{70, 33, 65}, std::array<size_t, 3>{5, 1, 1}, std::array<size_t, 3>{17, 130, 1}}) {
      const DatasetPtr d = ramp(dims, t);
      const std::string path = folder("types.ome.zarr");
      WriteOptions options;
      options.chunk = 32;
      options.compression = t == ElementType::u8 ? Compression::zlib : t == ElementType::f32 ? Compression::zstd : Compression::none;
      write(path, d, options);
      const DatasetPtr r = read(path);
      CHECK(same_array(d->fields()[0].array, r->fields()[0].array));
      CHECK(r->fields()[0].name == "T");
      CHECK(r->fields()[0].unit == "K");
      CHECK(r->as<UniformGrid>()->dims == dims);
      CHECK(length(r->as<UniformGrid>()->origin - Vec3{1, -2, 3.5}) == 0);
      CHECK(length(r->as<UniformGrid>()->spacing - Vec3{0.5, 0.25, 2}) == 0);
      CHECK(r->notes() == std::vector<std::pair<std::string, std::string>>{{"title", "a \"ramp\""}, {"length unit", "mm"}});
      check_names_alone(path);
    }
  }
}

TEST_CASE("zarr: vectors, labels and turned grids come back as they were") {
  const DatasetPtr v = ramp({20, 10, 9}, ElementType::f32, 3);
  write(folder("vector.zarr"), v);
  const DatasetPtr r = read(temp_folder() + "vector.zarr");
  CHECK(same_array(v->fields()[0].array, r->fields()[0].array));
  CHECK(r->fields()[0].role == Role::vectors);

  DatasetParts parts = ramp({6, 5, 4}, ElementType::u8)->parts();
  UniformGrid g = std::get<UniformGrid>(parts.mesh);
  g.direction.m[0][0] = 0, g.direction.m[0][1] = -1, g.direction.m[1][0] = 1, g.direction.m[1][1] = 0;
  g.spacing.z = -2;  // an axis that runs down
  parts.mesh = g;
  Field labels = parts.fields[0];
  labels.role = Role::labels;
  parts.fields.add(labels);
  const DatasetPtr t = make_dataset(std::move(parts));
  write(folder("turned.zarr"), t);
  const DatasetPtr u = read(temp_folder() + "turned.zarr");
  CHECK(u->fields()[0].role == Role::labels);
  for (const Box3 *a = &t->bounds(), *b = &u->bounds(); a; a = nullptr) CHECK(length(a->lo - b->lo) + length(a->hi - b->hi) < 1e-12);
  CHECK(same_array(t->fields()[0].array, u->fields()[0].array));
}

TEST_CASE("zarr: levels are means at the places of the samples they stand for, of labels the most frequent") {
  DatasetParts parts;
  UniformGrid g;
  g.dims = {131, 70, 67}, g.spacing = {1, 2, 3}, g.origin = {5, 6, 7};
  parts.mesh = g;
  std::vector<float> linear, holes;
  for (size_t k = 0; k < 67; ++k)
    for (size_t j = 0; j < 70; ++j)
      for (size_t i = 0; i < 131; ++i)
        linear.push_back(float(i) + 2 * float(j) + 3 * float(k)), holes.push_back((i + j + k) % 2 ? NAN : float(i));
  parts.fields.add({"x", Association::point, Array::from_vector(linear), "", Role::scalars});
  const DatasetPtr d = make_dataset(parts);
  const std::string path = folder("levels.zarr");
  write(path, d);
  // Level 1 as an array of its own.
  const DatasetPtr one = read(path + "/1"), two = read(path + "/2");
  CHECK(one->as<UniformGrid>()->dims == std::array<size_t, 3>{66, 35, 34});
  CHECK(two->as<UniformGrid>()->dims == std::array<size_t, 3>{33, 18, 17});
  const auto v = one->fields()[0].array.view<float>();
  CHECK(v[0] == 3);  // (0+1)/2 * (1 + 2 + 3)
  CHECK(v[5 + 66 * (7 + 35 * 9)] == 3 + 2 * (5 + 2 * 7 + 3 * 9));
  CHECK(v[65] == doctest::Approx(130 + 2 * 0.5 + 3 * 0.5));  // an odd end: the mean of what there is

  parts.fields.add({"x", Association::point, Array::from_vector(holes), "", Role::scalars});
  write(path, make_dataset(parts));
  CHECK(read(path + "/1")->fields()[0].array.view<float>()[3] == 6.5);  // NaN does not count

  std::vector<uint8_t> labels(131 * 70 * 67, 9);
  labels[0] = labels[1] = labels[131] = 3, labels[131 + 1] = labels[131 * 70] = labels[131 * 70 + 1] = 4;
  labels[2] = 7;
  parts.fields.add({"x", Association::point, Array::from_vector(labels), "", Role::labels});
  write(path, make_dataset(parts));
  const DatasetPtr coarse = read(path + "/1");
  const auto l = coarse->fields()[0].array.view<uint8_t>();
  CHECK(l[0] == 3);
  CHECK(l[1] == 9);
}

TEST_CASE("zarr: whole numbers are rounded to the nearest in coarser levels, below zero too") {
  DatasetParts parts;
  UniformGrid g;
  g.dims = {70, 1, 1};
  parts.mesh = g;
  std::vector<int16_t> v(70, 0);
  v[0] = -3, v[1] = -4, v[2] = 3, v[3] = 4, v[4] = -7, v[5] = -7, v[6] = 32767, v[7] = 32767, v[8] = -32768, v[9] = -32767;
  parts.fields.add({"x", Association::point, Array::from_vector(v), "", Role::scalars});
  const std::string path = folder("rounded.zarr");
  write(path, make_dataset(parts));
  const DatasetPtr d = read(path + "/1");
  const auto c = d->fields()[0].array.view<int16_t>();
  CHECK(c[0] == -3);  // -3.5 rounds up
  CHECK(c[1] == 4);
  CHECK(c[2] == -7);
  CHECK(c[3] == 32767);
  CHECK(c[4] == -32767);
}

TEST_CASE("zarr: the same bytes for any number of threads") {
  const DatasetPtr d = ramp({150, 140, 90});
  auto bytes = [&](int threads) {
    return with_threads(threads, [&] {
      const std::string path = folder(fmt::format("threads{}.zarr", threads));
      write(path, d);
      std::string all;
      std::vector<std::string> files;
      for (const auto& e : std::filesystem::recursive_directory_iterator(path))
        if (e.is_regular_file()) files.push_back(e.path().string().substr(path.size()));
      std::sort(files.begin(), files.end());
      for (const std::string& f : files) all += f + std::string(MappedFile(path + f).text());
      CHECK(files.size() == 4 + 2 + 1 + 3 * 3 * 2 + 2 * 2 * 1 + 1);
      return all;
    });
  };
  CHECK(bytes(1) == bytes(8));
}

TEST_CASE("zarr: regions and strides are read as the whole cut down") {
  const DatasetPtr d = ramp({90, 50, 40});
  const std::string path = folder("region.zarr");
  WriteOptions w;
  w.chunk = 16;
  write(path, d, w);
  ReadOptions o;
  o.region.lo = {3, 15, 16}, o.region.hi = {80, 16, 39}, o.region.stride = {1, 1, 1};
  for (int turn = 0; turn < 2; ++turn) {
    const DatasetPtr part = read(path, o);
    const auto v = part->fields()[0].array.view<float>();
    const UniformGrid& g = *part->as<UniformGrid>();
    const auto whole = d->fields()[0].array.view<float>();
    bool same = true;
    size_t n = 0;
    for (size_t k = 0; k < g.dims[2]; ++k)
      for (size_t j = 0; j < g.dims[1]; ++j)
        for (size_t i = 0; i < g.dims[0]; ++i)
          same =
              same && v[n++] == whole[3 + i * o.region.stride[0] + 90 * (15 + j * o.region.stride[1] + 50 * (16 + k * o.region.stride[2]))];
    CHECK(same);
    CHECK(g.origin.x == 1 + 0.5 * 3);
    o.region.stride = {7, 1, 20};
  }
}

TEST_CASE("zarr: chunks of all compressors, both byte orders, both separators, missing ones and fill values") {
  const std::string raw = bytes_of(twelve);
  auto values = [&](const std::string& path) {
    const DatasetPtr d = read(path);
    CHECK(d->as<UniformGrid>()->dims == std::array<size_t, 3>{3, 2, 2});
    const Array a = d->fields()[0].array.converted(ElementType::f32);
    const auto v = a.view<float>();
    return std::vector<float>(v.data, v.data + v.count);
  };
  CHECK(values(small_array("raw.zarr", "<f4", "null", raw)) == twelve);
  const auto gz = pack_gzip(std::as_bytes(std::span(raw)));
  CHECK(values(small_array("gz.zarr", "<f4", R"({"id": "gzip", "level": 1})", {reinterpret_cast<const char*>(gz.data()), gz.size()})) ==
        twelve);
  std::string packed(200, 0);
  packed.resize(ZSTD_compress(packed.data(), packed.size(), raw.data(), raw.size(), 3));
  CHECK(values(small_array("zstd.zarr", "<f4", R"({"id": "zstd", "level": 1})", packed)) == twelve);
  for (const char* name : {"lz4", "zlib", "zstd", "blosclz"}) {
    packed.assign(200, 0);
    const int n = blosc_compress_ctx(5, 1, 4, raw.size(), raw.data(), packed.data(), packed.size(), name, 0, 1);
    REQUIRE(n > 0);
    packed.resize(size_t(n));
    CHECK(values(small_array("blosc.zarr", "<f4", R"({"id": "blosc", "cname": "lz4", "clevel": 5, "shuffle": 1})", packed)) == twelve);
  }
  // LZ4 by hand: its length, then one run of literals.
  packed = std::string("\x30\0\0\0\xf0\x21", 6) + raw;
  CHECK(values(small_array("lz4.zarr", "<f4", R"({"id": "lz4", "acceleration": 1})", packed)) == twelve);
  std::string big = raw;
  for (size_t i = 0; i < 12; ++i) std::reverse(big.begin() + ptrdiff_t(4 * i), big.begin() + ptrdiff_t(4 * i + 4));
  CHECK(values(small_array("big.zarr", ">f4", "null", big)) == twelve);
  CHECK(values(small_array("fill.zarr", "<f4", "null", "", R"(, "fill_value": 2.5)")) == std::vector<float>(12, 2.5f));
  CHECK(values(small_array("fill.zarr", "|i1", "null", "", R"(, "fill_value": -3)")) == std::vector<float>(12, -3));
  CHECK(std::isnan(values(small_array("fill.zarr", "<f8", "null", "", R"(, "fill_value": "NaN")"))[5]));
  const std::string nested = small_array("nested.zarr", "<f4", "null", "", R"(, "dimension_separator": "/")");
  std::filesystem::create_directories(nested + "/0/0");
  write_file(nested + "/0/0/0", raw);
  CHECK(values(nested) == twelve);
}

TEST_CASE("zarr: version 3 with axes by name, time and channels") {
  const std::string path = folder("three.ome.zarr");
  std::filesystem::create_directories(path + "/s0/c/0/0/0/0");
  std::filesystem::create_directories(path + "/s0/c/1/1/0/0");
  write_file(path + "/zarr.json",
             R"({"zarr_format": 3, "node_type": "group", "attributes": {"ome": {"version": "0.5", "multiscales": [{"axes": [
                {"name": "t", "type": "time", "unit": "second"}, {"name": "c", "type": "channel"}, {"name": "z", "type": "space", "unit": "micrometer"},
                {"name": "y", "type": "space", "unit": "micrometer"}, {"name": "x", "type": "space", "unit": "micrometer"}],
                "datasets": [{"path": "s0", "coordinateTransformations": [{"type": "scale", "scale": [0.5, 1, 4, 3, 2]}]}],
                "coordinateTransformations": [{"type": "translation", "translation": [10, 0, 1, 2, 3]}]}],
                "omero": {"channels": [{"label": "red"}, {"label": "red"}]}}}})");
  write_file(path + "/s0/zarr.json",
             R"({"zarr_format": 3, "node_type": "array", "shape": [2, 2, 2, 2, 3], "data_type": "float32", "chunk_grid": {"name": "regular",
                "configuration": {"chunk_shape": [1, 1, 2, 2, 3]}}, "chunk_key_encoding": {"name": "default", "configuration": {"separator": "/"}},
                "codecs": [{"name": "bytes", "configuration": {"endian": "little"}}, {"name": "zstd", "configuration": {"level": 1}}, "crc32c"], "fill_value": 7})");
  std::string packed(200, 0);
  const std::string raw = bytes_of(twelve);
  packed.resize(ZSTD_compress(packed.data(), packed.size(), raw.data(), raw.size(), 3));
  write_file(path + "/s0/c/1/1/0/0/0", packed + "abcd");
  Context context;
  CHECK(file_times(path, {}, context) == std::vector<double>{10, 10.5});
  ReadOptions o;
  o.time = 10.4;
  const DatasetPtr d = read(path, o);
  CHECK(d->time() == 10.5);
  CHECK(d->fields().names() == std::vector<std::string>{"red", "red 1"});
  CHECK(d->fields()[0].array.view<float>()[3] == 7);
  CHECK(d->fields()[1].array.view<float>()[11] == -11.5f);
  CHECK(d->as<UniformGrid>()->spacing.z == 4);
  CHECK(d->as<UniformGrid>()->origin.x == 3);
  o.fields = {"red 1"};
  CHECK(read(path, o)->fields().size() == 1);
}

TEST_CASE("zarr: a volume beyond the memory allowed is a coarse level with a way to all bricks") {
  const DatasetPtr d = ramp({200, 150, 140});
  const std::string path = folder("large.zarr");
  write(path, d);
  const size_t bytes = 200 * 150 * 140 * 4;
  CHECK(!read(path, {}, 4 * bytes)->bricks());
  const DatasetPtr coarse = read(path, {}, bytes);
  CHECK(coarse->as<UniformGrid>()->dims == std::array<size_t, 3>{50, 38, 35});
  const BrickedPtr v = coarse->bricks();
  REQUIRE(v);
  CHECK(v->levels.size() == 3);
  CHECK(v->levels[0].dims == std::array<size_t, 3>{200, 150, 140});
  CHECK(v->levels[2].coarseness == std::array<size_t, 3>{4, 4, 4});
  CHECK(v->levels[2].origin.x == 1 + 0.5 * 1.5);
  CHECK(v->field == "T");
  const auto whole = d->fields()[0].array.view<float>();
  // A box across chunks.
  std::vector<float> box(5 * 9 * 80);
  v->read(0, {62, 60, 55}, {5, 9, 80}, reinterpret_cast<std::byte*>(box.data()));
  bool same = true;
  for (size_t k = 0; k < 80; ++k)
    for (size_t j = 0; j < 9; ++j)
      for (size_t i = 0; i < 5; ++i) same = same && box[i + 5 * (j + 9 * k)] == whole[62 + i + 200 * (60 + j + 150 * (55 + k))];
  CHECK(same);
  // Extremes: of each block with both of its borders.
  REQUIRE(v->blocks() == std::array<size_t, 3>{4, 3, 3});
  for (size_t b = 0; b < v->extremes.size(); ++b) {
    const size_t at[3] = {b % 4, b / 4 % 3, b / 12};
    float lo = 1e9f, hi = -1e9f;
    for (size_t k = 64 * at[2]; k <= std::min<size_t>(64 * at[2] + 64, 139); ++k)
      for (size_t j = 64 * at[1]; j <= std::min<size_t>(64 * at[1] + 64, 149); ++j)
        for (size_t i = 64 * at[0]; i <= std::min<size_t>(64 * at[0] + 64, 199); ++i)
          lo = std::min(lo, whole[i + 200 * (j + 150 * k)]), hi = std::max(hi, whole[i + 200 * (j + 150 * k)]);
    CHECK(v->extremes[b].lo == lo);
    CHECK(v->extremes[b].hi == hi);
  }
  CHECK(v->range() == Range{0, 250});
  // Pictures have the frame and the colours of the whole.
  CHECK(length(coarse->bounds().lo - d->bounds().lo) + length(coarse->bounds().hi - d->bounds().hi) < 1e-12);
  CHECK(coarse->range(coarse->fields()[0]) == d->range(d->fields()[0]));
  // A file that says nothing of them.
  std::filesystem::remove_all(path + "/minmax");
  CHECK(read(path, {}, bytes)->bricks()->extremes.empty());
  // One level alone.
  CHECK(error_of([&] { read(path + "/0", {}, bytes); }).find("--region") != std::string::npos);
}

TEST_CASE("zarr: a file is converted slab by slab as from memory") {
  const DatasetPtr d = ramp({80, 60, 150});
  const std::string npy = temp_folder() + "slabs.npy", vti = temp_folder() + "slabs.vti";
  write(npy, d);
  write(vti, d);
  write(folder("memory.zarr"), d);
  Context context;
  for (const std::string& path : {npy, vti}) {
    write_zarr_slabs(folder("slabs.zarr"), slabs_of_file(path, {}, context), {}, context);
    CHECK(same_array(read(temp_folder() + "slabs.zarr")->fields()[0].array, d->fields()[0].array));
    CHECK(MappedFile(temp_folder() + "slabs.zarr/1/0/0/0").text() == MappedFile(temp_folder() + "memory.zarr/1/0/0/0").text());
    CHECK(MappedFile(temp_folder() + "slabs.zarr/minmax/0.0.0.0.0").text() ==
          MappedFile(temp_folder() + "memory.zarr/minmax/0.0.0.0.0").text());
  }
  // Little memory: thin chunks, the same numbers.
  context.memory_limit = 80 * 60 * 4 * 100;
  write_zarr_slabs(folder("thin.zarr"), slabs_of_file(vti, {}, context), {}, context);
  CHECK(MappedFile(temp_folder() + "thin.zarr/0/.zarray").text().find("\"chunks\": [16, 60, 64]") != std::string_view::npos);
  CHECK(same_array(read(temp_folder() + "thin.zarr/1")->fields()[0].array, read(temp_folder() + "memory.zarr/1")->fields()[0].array));
}

TEST_CASE("zarr: a folder is replaced when it is a Zarr folder, and only then; a failure leaves the old one") {
  const std::string path = folder("replaced.zarr");
  write(path, ramp({9, 8, 7}));
  write(path + "/", ramp({5, 4, 3}));
  CHECK(read(path)->point_count() == 60);
  CHECK(!file_exists(path + "/0/0/0/1"));
  SlabSource broken{};
  broken.grid.dims = {4, 4, 4}, broken.field = "f";
  broken.slab = [](size_t, size_t) -> Array { fail_data("the disk is gone"); };
  Context context;
  CHECK(error_of([&] { write_zarr_slabs(path, broken, {}, context); }).find("the disk is gone") != std::string::npos);
  CHECK(read(path)->point_count() == 60);
  for (const auto& e : std::filesystem::directory_iterator(temp_folder())) CHECK(e.path().string().find("partial") == std::string::npos);
  const std::string mine = folder("mine.zarr");
  std::filesystem::create_directories(mine);
  write_file(mine + "/letter.txt", "dear");
  CHECK(error_of([&] { write(mine, ramp({5, 4, 3})); }).find("not a Zarr folder") != std::string::npos);
  CHECK(file_exists(mine + "/letter.txt"));
  CHECK(error_of([&] { write(temp_folder() + "nowhere/x.zarr", ramp({5, 4, 3})); }).find("does not exist") != std::string::npos);
}

TEST_CASE("zarr: what cannot be written says why") {
  WriteOptions o;
  o.compression = Compression::lzma;
  CHECK(error_of([&] { write(folder("bad.zarr"), ramp({5, 4, 3}), o); }).find("lz4, zstd, zlib") != std::string::npos);
  o = {};
  o.chunk = 7;
  CHECK(error_of([&] { write(folder("bad.zarr"), ramp({5, 4, 3}), o); }).find("even number") != std::string::npos);
  DatasetParts parts;
  parts.mesh = PointCloud{{Array::from_vector(std::vector<float>{0, 0, 0}, 3), {}}};
  CHECK(error_of([&] { write(folder("bad.zarr"), make_dataset(parts)); }).find("uniform grid") != std::string::npos);
  parts.mesh = UniformGrid{};
  CHECK(error_of([&] { write(folder("bad.zarr"), make_dataset(parts)); }).find("point field") != std::string::npos);
}

TEST_CASE("zarr: every level but the first is coarser than the one before, whatever the size of a chunk") {
  for (const int chunk : {8, 16, 24, 32, 64}) {
    CAPTURE(chunk);
    DatasetParts parts;
    UniformGrid g;
    g.dims = {100, 40, 20};
    parts.mesh = g;
    parts.fields.add({"f", Association::point, Array::from_vector(std::vector<float>(100 * 40 * 20, 1.f)), "", Role::scalars});
    const std::string path = test::temp_folder() + fmt::format("levels{}.zarr", chunk);
    WriteOptions options;
    options.chunk = chunk;
    Context context;
    write_data(path, make_dataset(std::move(parts)), options, context);
    size_t levels = 0;
    uint64_t before = UINT64_MAX;
    for (; file_exists(fmt::format("{}/{}/.zarray", path, levels)); ++levels) {
      const std::string text(MappedFile(fmt::format("{}/{}/.zarray", path, levels)).text());
      unsigned long n[3] = {};
      const size_t at = text.find("\"shape\"");
      REQUIRE(at != std::string::npos);
      REQUIRE(std::sscanf(text.c_str() + at, "\"shape\": [%lu, %lu, %lu]", &n[0], &n[1], &n[2]) == 3);
      CHECK(uint64_t(n[0]) * n[1] * n[2] < before);
      before = uint64_t(n[0]) * n[1] * n[2];
      if (!file_exists(fmt::format("{}/{}/.zarray", path, levels + 1)))
        for (const unsigned long m : n) CHECK(m <= unsigned(chunk));  // the last is one chunk
    }
    CHECK(levels <= 6);
  }
}
