// SPDX-License-Identifier: Apache-2.0
#include "data/lattice.h"
#include "data/patient/patient_frame.h"
#include "io/io_files.h"

using namespace sg;
using namespace sg::test;

namespace {

struct AnalyzeWritten {
  DatasetPtr data;
  std::string header, warnings;
};

AnalyzeWritten through_analyze(const Array& values, Role role = Role::scalars, Vec3 origin = {0, 0, 0}) {
  UniformGrid g;
  g.dims = {2, 3, 2}, g.spacing = {1, 2, 4}, g.origin = origin;
  FieldSet fields;
  fields.add({"NIFTI", Association::point, values, "", role});
  AnalyzeWritten w;
  Context context;
  context.on_log = [&](LogLevel level, std::string_view text) {
    if (level == LogLevel::warning) w.warnings += text;
  };
  write_data(temp_folder() + "w.hdr", make_dataset(g, fields), {}, context);
  w.header = MappedFile(temp_folder() + "w.hdr").text();
  w.data = read_file(temp_folder() + "w.hdr");
  return w;
}

// The value at a place.
double value_at(const Dataset& d, Vec3 at, int component = 0) {
  const Lattice lattice(d.mesh());
  for (size_t k = 0; k < 2; ++k)
    for (size_t j = 0; j < 3; ++j)
      for (size_t i = 0; i < 2; ++i)
        if (length(lattice.view().position(i, j, k) - at) < 1e-6) return d.fields()[0].array.get(i + 2 * (j + 3 * k), component);
  return NAN;
}

template <class T>
Array twelve(T first, T step) {
  std::vector<T> v;
  for (int i = 0; i < 12; ++i) v.push_back(T(first + T(i) * step));
  return Array::from_vector(v);
}

int16_t short_at(const std::string& header, size_t byte) {
  int16_t v = 0;
  std::memcpy(&v, header.data() + byte, 2);
  return v;
}

}  // namespace

TEST_CASE("writing Analyze: rows lead to the front in the file, and every value keeps its place") {
  const AnalyzeWritten w = through_analyze(twelve<int16_t>(-5, 1));
  CHECK(w.warnings.empty());
  CHECK(w.header.size() == 348);
  CHECK(axis_letters(w.data->as<UniformGrid>()->direction) == "LAS");
  for (size_t i = 0; i < 12; ++i) {
    const Vec3 at(double(i % 2), 2 * double(i / 2 % 3), 4 * double(i / 6));
    CHECK(value_at(*w.data, at) == -5 + double(i));
  }
  // SPM counts voxels from 1; the last row of the file is the first of ours.
  CHECK(short_at(w.header, 253) == 1);
  CHECK(short_at(w.header, 255) == 3);
  CHECK(short_at(w.header, 257) == 1);
}

TEST_CASE("writing Analyze: numbers go into the smallest of its types that keeps them") {
  const auto type_of = [](const Array& a) { return through_analyze(a).data->fields()[0].array.type(); };
  using enum ElementType;
  CHECK(type_of(twelve<uint8_t>(200, 1)) == u8);
  CHECK(type_of(twelve<int8_t>(-100, 1)) == i16);
  CHECK(type_of(twelve<uint16_t>(100, 1)) == i16);
  CHECK(type_of(twelve<uint16_t>(65000, 1)) == i32);
  CHECK(type_of(twelve<uint32_t>(4000000000u, 1)) == f64);
  CHECK(type_of(twelve<float>(0.5f, 1)) == f32);
  CHECK(type_of(twelve<double>(0.1, 1)) == f64);
  CHECK(type_of(twelve<int64_t>(int64_t(1) << 40, 1)) == f64);
  CHECK(contains(through_analyze(twelve<int64_t>((int64_t(1) << 60) + 1, 1)).warnings, "rounds 'NIFTI' (i64 to f64)"));
}

TEST_CASE("writing Analyze: colours are kept, other components refused, and packed pairs not written") {
  std::vector<uint8_t> rgb;
  for (int i = 0; i < 36; ++i) rgb.push_back(uint8_t(i));
  const AnalyzeWritten w = through_analyze(Array::from_vector(rgb, 3), Role::colors);
  CHECK(w.data->fields()[0].role == Role::colors);
  CHECK(value_at(*w.data, {1, 4, 4}, 2) == 35);
  std::vector<float> vectors(36, 1);
  CHECK(contains(error_of([&] { through_analyze(Array::from_vector(vectors, 3), Role::vectors); }), "3 components"));
  Context context;
  CHECK(contains(error_of([&] { write_data(temp_folder() + "w.img.gz", w.data, {}, context); }), "name it .hdr or .img"));
}

TEST_CASE("Analyze: the voxel at the origin is read as SPM counts it, unless it is text of another program") {
  // A head of 2 x 3 x 2 voxels of 1 x 2 x 4 mm whose origin is the third voxel along y.
  AnalyzeWritten w = through_analyze(twelve<uint8_t>(0, 1));
  const auto origin_of = [&](std::array<int16_t, 3> voxel) {
    for (size_t a = 0; a < 3; ++a) std::memcpy(w.header.data() + 253 + 2 * a, &voxel[a], 2);
    write_file(temp_folder() + "w.hdr", w.header);
    return read_file(temp_folder() + "w.hdr")->as<UniformGrid>()->origin;
  };
  CHECK(origin_of({1, 3, 1}) == Vec3(0, 4, 0));  // columns lead to the front: -y
  CHECK(origin_of({2, 1, 2}) == Vec3(-1, 0, -4));
  CHECK(origin_of({0, 0, 0}) == Vec3(0, 0, 0));
  CHECK(origin_of({3, 1, 1}) == Vec3(-2, 0, 0));
  CHECK(origin_of({0x6854, 0x2065, 0x696c}) == Vec3(0, 0, 0));
}
