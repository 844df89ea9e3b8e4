// SPDX-License-Identifier: Apache-2.0
// MINC 2 volumes, made by the HDF5 library with the objects and attributes that libminc writes.
#include "data/lattice.h"
#include "data/patient/patient_frame.h"
#include "samples.h"

using namespace sg;
using test::H5Sample;

namespace {

struct MincDim {
  std::string name;
  size_t length;
  double start = 0, step = 1;
  std::vector<double> cosines = {};
};

// Groups and dimensions; the image is for the case to add.
void minc_frame(H5Sample& h, const std::vector<MincDim>& dims) {
  for (const char* g : {"/minc-2.0", "/minc-2.0/dimensions", "/minc-2.0/image", "/minc-2.0/image/0", "/minc-2.0/info"}) h.group(g);
  h.text("/minc-2.0", "history", "made for a test");
  for (const MincDim& d : dims) {
    const std::string at = "/minc-2.0/dimensions/" + d.name;
    h.data<double>(at, {0}, {1});
    h.numbers<int>(at, "length", {int(d.length)});
    h.text(at, "spacing", "regular__");
    if (d.name == "vector_dimension") continue;
    h.numbers<double>(at, "start", {d.start});
    h.numbers<double>(at, "step", {d.step});
    if (!d.cosines.empty()) h.numbers<double>(at, "direction_cosines", d.cosines);
  }
}
const std::string minc_image = "/minc-2.0/image/0/image";

hid_t minc_shorts() { return H5T_NATIVE_INT16; }

// 2 slices of 2 x 3 voxels: stored 0..1000 means 0..10 in slice 0 and 100..200 in slice 1.
std::string minc_sample(const std::string& name, const test::H5Layout& layout = {{1, 2, 3}, true, true, false, H5T_NATIVE_INT16}) {
  H5Sample h(name);
  minc_frame(h, {{"zspace", 2, 7, 3}, {"yspace", 2, 1, 1}, {"xspace", 3, -5, 2}});
  h.data<int>(minc_image, {0, 100, 200, 300, 400, 1000, 0, 10, 20, 30, 40, 1000}, {2, 2, 3}, layout);
  h.text(minc_image, "dimorder", "zspace,yspace,xspace");
  h.numbers<double>(minc_image, "valid_range", {0, 1000});
  h.data<double>(minc_image + "-min", {0, 100});
  h.data<double>(minc_image + "-max", {10, 200});
  h.text(minc_image + "-min", "dimorder", "zspace");
  h.text(minc_image + "-max", "dimorder", "zspace");
  return h.path;
}

// What the library reads of the image.
struct LibraryNumbers {
  std::vector<float> values;
  explicit LibraryNumbers(const std::string& path) {
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), set = H5Dopen2(file, minc_image.c_str(), H5P_DEFAULT),
                space = H5Dget_space(set);
    values.resize(size_t(H5Sget_simple_extent_npoints(space)));
    H5Dread(set, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Sclose(space), H5Dclose(set), H5Fclose(file);
  }
};

}  // namespace

TEST_CASE("minc 2: slices are scaled by their own image-min and image-max, places are the patient's") {
  for (const char* name : {"a.mnc", "a.h5"}) {
    const std::string path = minc_sample(name);
    const DatasetPtr d = test::read_file(path);
    const auto* g = d->as<UniformGrid>();
    REQUIRE(g);
    CHECK(in_patient_frame(*d));
    CHECK(g->dims == std::array<size_t, 3>{3, 2, 2});
    CHECK(g->spacing == Vec3(2, 1, 3));
    CHECK(g->origin == Vec3(5, -1, 7));  // MINC's x is to the right, y to the front
    const Field& real = d->fields().require("image");
    CHECK(real.role == Role::scalars);
    CHECK(real.array.get(1) == doctest::Approx(1));
    CHECK(real.array.get(5) == doctest::Approx(10));
    CHECK(real.array.get(7) == doctest::Approx(101));
    CHECK(real.array.get(11) == doctest::Approx(200));
    const Field& stored = d->fields().require("ImageScalars");
    CHECK(stored.array.type() == ElementType::i16);
    CHECK(stored.array.get(5) == 1000);
  }
}

TEST_CASE("minc 2: oblique axes, negative steps and permuted dimensions put each voxel where the file says") {
  H5Sample h("oblique.mnc");
  // x and y turned by 30 degrees about z; files may name the dimensions in any order.
  const double c = std::cos(0.5235987755982988), s = 0.5;
  minc_frame(h, {{"xspace", 2, 4, -2, {c, s, 0}}, {"zspace", 3, -1, 0.5}, {"yspace", 4, 10, 3, {-s, c, 0}}});
  std::vector<float> values(24);
  for (size_t i = 0; i < values.size(); ++i) values[i] = float(i);
  h.data<float>(minc_image, values, {2, 3, 4});
  h.text(minc_image, "dimorder", "xspace,zspace,yspace");
  h.close();
  const DatasetPtr d = test::read_file(h.path);
  const Lattice lattice(d->mesh());
  REQUIRE(lattice_dims(d->mesh()) == std::array<size_t, 3>{4, 3, 2});
  for (size_t y = 0; y < 4; ++y)
    for (size_t z = 0; z < 3; ++z)
      for (size_t x = 0; x < 2; ++x) {
        const double a = 4 - 2 * double(x), b = 10 + 3 * double(y);
        const Vec3 right_front_head(a * c - b * s, a * s + b * c, -1 + 0.5 * double(z));
        const Vec3 p = lattice.view().position(y, z, x);
        CHECK(length(p - Vec3(-right_front_head.x, -right_front_head.y, right_front_head.z)) < 1e-12);
        CHECK(d->fields().require("image").array.get(y + 4 * (z + 3 * x)) == values[(x * 3 + z) * 4 + y]);
      }
  CHECK(!d->fields().find("ImageScalars"));
}

TEST_CASE("minc 2: vectors and steps of time, whichever dimension comes first") {
  // Two times of 1 x 1 x 2 voxels with 3 components each; the range of real values changes with the time.
  for (const bool vector_first : {false, true}) {
    H5Sample h("vectors.mnc");
    minc_frame(h, {{"time", 2, 0.5, 2}, {"zspace", 1, 0, 1}, {"yspace", 1, 0, 1}, {"xspace", 2, 0, 1}, {"vector_dimension", 3}});
    std::vector<int> v;
    for (int t = 0; t < 2; ++t)
      for (int k = 0; k < 6; ++k) v.push_back(vector_first ? 100 * t + 10 * (k / 2) + k % 2 : 100 * t + 10 * (k % 3) + k / 3);
    if (vector_first) {
      h.data<int>(minc_image, v, {2, 3, 1, 1, 2}, {{}, false, false, false, minc_shorts()});
      h.text(minc_image, "dimorder", "time,vector_dimension,zspace,yspace,xspace");
    } else {
      h.data<int>(minc_image, v, {2, 1, 1, 2, 3}, {{}, false, false, false, minc_shorts()});
      h.text(minc_image, "dimorder", "time,zspace,yspace,xspace,vector_dimension");
    }
    h.numbers<double>(minc_image, "valid_range", {0, 200});
    for (const char* end : {"-min", "-max"}) {
      h.data<double>(minc_image + end, end[2] == 'i' ? std::vector<double>{0, 0} : std::vector<double>{200, 400});
      h.text(minc_image + end, "dimorder", "time");
    }
    h.close();
    Context context;
    CHECK(file_times(h.path, {}, context) == std::vector<double>{0.5, 2.5});
    for (int t = 0; t < 2; ++t) {
      ReadOptions options;
      options.step = t;
      const DatasetPtr d = test::read_file(h.path, options);
      CHECK(d->time() == 0.5 + 2 * t);
      const Field& f = d->fields().require("image");
      REQUIRE(f.components() == 3);
      CHECK(f.role == Role::vectors);
      for (size_t p = 0; p < 2; ++p)
        for (int k = 0; k < 3; ++k) {
          const double real = (t + 1) * (100 * t + 10 * k + int(p));
          CHECK(f.array.get(p, k) == doctest::Approx(k < 2 ? -real : real));  // turned with the frame
        }
      CHECK(d->fields().require("ImageScalars").array.get(1, 2) == 100 * t + 21);
    }
  }
}

TEST_CASE("minc 2: one range for all, bytes without a range, one slice, the modality") {
  H5Sample h("slice.mnc");
  minc_frame(h, {{"yspace", 2, 1, 1}, {"xspace", 2, 0, 1}, {"zspace", 1, 55, 1}});
  h.data<uint8_t>("/minc-2.0/info/study", {0});
  h.text("/minc-2.0/info/study", "modality", "MRI__");
  h.data<uint8_t>(minc_image, {0, 51, 102, 255}, {2, 2});
  h.text(minc_image, "dimorder", "yspace,xspace");
  h.data<double>(minc_image + "-min", {-1});
  h.data<double>(minc_image + "-max", {1});
  h.close();
  const DatasetPtr d = test::read_file(h.path);
  CHECK(d->as<UniformGrid>()->origin == Vec3(0, -1, 55));
  CHECK(d->fields().require("image").array.get(1) == doctest::Approx(-0.6));
  CHECK(d->fields().require("image").array.get(3) == doctest::Approx(1));
  CHECK(std::find(d->notes().begin(), d->notes().end(), std::pair<std::string, std::string>("Modality", "MR")) != d->notes().end());
}

TEST_CASE("minc 2: what does not fit is refused by name") {
  const auto refusal_of = [](const std::function<void(H5Sample&)>& make) {
    H5Sample h("odd.mnc");
    minc_frame(h, {{"zspace", 2}, {"yspace", 2}, {"xspace", 2}});
    make(h);
    h.close();
    return test::error_of([&] { test::read_any(h.path); });
  };
  const std::vector<int> eight(8, 1);
  const auto with_image = [&](H5Sample& h, const std::string& order) {
    h.data<int>(minc_image, eight, {2, 2, 2});
    if (!order.empty()) h.text(minc_image, "dimorder", order);
  };
  CHECK(test::contains(refusal_of([](H5Sample&) {}), "/minc-2.0/image/0/image"));
  CHECK(test::contains(refusal_of([&](H5Sample& h) { with_image(h, ""); }), "dimorder"));
  CHECK(test::contains(refusal_of([&](H5Sample& h) { with_image(h, "zspace,xspace"); }), "2 of its 3 dimensions"));
  CHECK(test::contains(refusal_of([&](H5Sample& h) { with_image(h, "zspace,xspace,xspace"); }), "the same direction twice"));
  CHECK(test::contains(refusal_of([&](H5Sample& h) { with_image(h, "zspace,yspace,tfrequency"); }), "'tfrequency'"));
  const auto ranges = [&](H5Sample& h, size_t n, const std::string& order) {
    with_image(h, "zspace,yspace,xspace");
    for (const char* end : {"-min", "-max"}) {
      h.data<double>(minc_image + end, std::vector<double>(n, 0));
      h.text(minc_image + end, "dimorder", order);
    }
  };
  CHECK(test::contains(refusal_of([&](H5Sample& h) { ranges(h, 3, "zspace"); }), "one number per slice"));
  CHECK(test::contains(refusal_of([&](H5Sample& h) { ranges(h, 2, "xspace"); }), "one number per slice"));
  // A shape of a million million voxels that were never written.
  CHECK(test::contains(refusal_of([&](H5Sample& h) {
                         const hsize_t dims[3] = {10000, 10000, 10000}, chunk[3] = {1, 64, 64};
                         const hid_t space = H5Screate_simple(3, dims, nullptr), make_list = H5Pcreate(H5P_DATASET_CREATE);
                         H5Pset_chunk(make_list, 3, chunk);
                         H5Dclose(H5Dcreate2(h.id(), minc_image.c_str(), H5T_NATIVE_INT16, space, H5P_DEFAULT, make_list, H5P_DEFAULT));
                         H5Pclose(make_list), H5Sclose(space);
                         h.text(minc_image, "dimorder", "zspace,yspace,xspace");
                       }),
                       "more numbers than the file can hold"));
}

TEST_CASE("minc 2: a file that is cut or damaged is read or refused") {
  const std::string whole = test::bytes_of(minc_sample("whole.mnc"));
  CHECK(test::cut_and_damage("hurt.mnc", whole) == 63);
}

TEST_CASE("minc 2: names alone, and a region") {
  const std::string path = minc_sample("names.mnc");
  ReadOptions options;
  options.region.lo = {1, 0, 1}, options.region.hi = {2, 1, 1};
  const DatasetPtr d = test::read_file(path, options);
  CHECK(lattice_dims(d->mesh()) == std::array<size_t, 3>{2, 2, 1});
  CHECK(d->fields().require("image").array.get(0) == doctest::Approx(101));
}

TEST_CASE("writing MINC 2: numbers of every type come back as they are, with unit and modality, packed or not") {
  UniformGrid g;
  g.dims = {20, 17, 9}, g.spacing = {1, 2, 4}, g.origin = {-3, 5, 7};
  for (const ElementType type : {ElementType::u8, ElementType::i8, ElementType::u16, ElementType::i16, ElementType::u32, ElementType::i32,
                                 ElementType::f32, ElementType::f64}) {
    CAPTURE(element_name(type));
    std::vector<double> v;
    for (size_t i = 0; i < 20 * 17 * 9; ++i) v.push_back(double(i * 7 % 100) + (is_float(type) ? 0.125 : 0));
    DatasetParts parts;
    parts.mesh = g;
    parts.fields.add({"T", Association::point, Array::from_vector(v).converted(type), "ms", Role::scalars});
    parts.notes.emplace_back("Modality", "PT");
    note_patient_frame(parts);
    const DatasetPtr in = make_dataset(std::move(parts));
    size_t bytes[2] = {0, 0};
    for (const Compression c : {Compression::none, Compression::zlib}) {
      WriteOptions options;
      options.compression = c;
      Context context;
      const std::string path = test::temp_folder() + "w.mnc";
      write_data(path, in, options, context);
      const std::string first = test::bytes_of(path);
      write_data(path, in, options, context);
      CHECK(first == test::bytes_of(path));
      bytes[c == Compression::zlib] = first.size();
      const DatasetPtr out = test::read_file(path);
      CHECK(out->as<UniformGrid>()->origin == g.origin);
      CHECK(out->fields().names() == std::vector<std::string>{"image"});
      CHECK(out->fields()[0].unit == "ms");
      CHECK(test::same_array(out->fields()[0].array, in->fields()[0].array));
      CHECK(std::find(out->notes().begin(), out->notes().end(), std::pair<std::string, std::string>("Modality", "PT")) !=
            out->notes().end());
    }
    if (element_size(type) > 1) CHECK(bytes[1] < bytes[0]);
  }
}

TEST_CASE("writing MINC 2: vectors turn with the frame, other components keep their numbers") {
  UniformGrid g;
  g.dims = {2, 1, 1};
  for (const int n : {2, 3, 9}) {
    std::vector<float> v;
    for (int i = 0; i < 2 * n; ++i) v.push_back(float(i) + 1);
    DatasetParts parts;
    parts.mesh = g;
    parts.fields.add({"u", Association::point, Array::from_vector(v, n), "", n == 9 ? Role::tensors : Role::none});
    note_patient_frame(parts);
    Context context;
    write_data(test::temp_folder() + "v.mnc", make_dataset(std::move(parts)), {}, context);
    const LibraryNumbers stored(test::temp_folder() + "v.mnc");
    CHECK(stored.values[0] == (n == 3 ? -1 : 1));  // x to the right in the file
    const DatasetPtr out = test::read_file(test::temp_folder() + "v.mnc");
    for (int i = 0; i < 2 * n; ++i) CHECK(out->fields()[0].array.get(size_t(i / n), i % n) == i + 1);
  }
}
