// SPDX-License-Identifier: Apache-2.0
#include "io/io_files.h"
#include "io/scan/dicom_encoder.h"
#include "io/scan/dicom_stored.h"

using namespace sg;
using namespace sg::test;

namespace {

DatasetPtr volume_of(const Array& values, Role role = Role::scalars, const std::string& unit = "") {
  UniformGrid g;
  g.dims = {values.count(), 1, 1};
  DatasetParts parts;
  parts.mesh = g;
  parts.fields.add({"T", Association::point, values, unit, role});
  parts.notes.emplace_back("Modality", "MET_MOD_MR");
  parts.notes.emplace_back("SeriesDescription", "a\\b");
  parts.notes.emplace_back("WindowCenter", "40");
  parts.notes.emplace_back("WindowWidth", "400");
  return make_dataset(std::move(parts));
}

std::string written(const DatasetPtr& d) {
  const std::string path = temp_folder() + "w.dcm";
  Context context;
  write_data(path, d, {}, context);
  return std::string(MappedFile(path).text());
}

DatasetPtr through(const Array& values, Role role = Role::scalars, const std::string& unit = "") {
  written(volume_of(values, role, unit));
  return read_file(temp_folder() + "w.dcm");
}

}  // namespace

TEST_CASE("writing DICOM: decimal strings have at most 16 characters and are the nearest of them") {
  CHECK(decimal_string(0.5) == "0.5");
  CHECK(decimal_string(-0.0) == "0");
  for (const double v : {1.0 / 3, -1.0 / 3, 1e-300 / 3, -123456789.123456789, 1e22 / 7, M_PI}) {
    const std::string s = decimal_string(v);
    CAPTURE(s);
    CHECK(s.size() <= 16);
    CHECK(std::abs(std::stod(s) - v) <= std::abs(v) * 1e-9);
  }
  CHECK(std::stod(decimal_string(double(0.1f))) == doctest::Approx(double(0.1f)).epsilon(1e-12));
}

TEST_CASE("writing DICOM: identifiers are legal, and the same for the same content alone") {
  CHECK(dicom_uid(0, 0) == "2.25.604472133179351442128896");  // the marks of version and variant alone
  CHECK(dicom_uid(~uint64_t(0), ~uint64_t(0)).size() <= 64);
  const Array values = Array::from_vector(std::vector<float>{0, 1.5f, 4});
  const std::string a = written(volume_of(values)), b = written(volume_of(values)),
                    c = written(volume_of(Array::from_vector(std::vector<float>{0, 1.5f, 4.5f})));
  CHECK(a == b);
  std::vector<std::string> uids[2];
  for (int f = 0; f < 2; ++f) {
    const std::string& bytes = f ? c : a;
    for (size_t at = bytes.find("2.25."); at != std::string::npos; at = bytes.find("2.25.", at + 1)) {
      const size_t end = std::min(bytes.find_first_not_of("0123456789.", at), bytes.size());
      uids[f].push_back(bytes.substr(at, end - at));
      CHECK(uids[f].back().size() <= 64);
      CHECK(uids[f].back()[5] != '0');
    }
  }
  REQUIRE(uids[0].size() == uids[1].size());
  size_t different = 0;
  for (size_t i = 0; i < uids[0].size(); ++i) different += uids[0][i] != uids[1][i];
  CHECK(different == uids[0].size() - 1);  // all but that of the program
}

TEST_CASE("writing DICOM: whole numbers within 16 bits stay as they are, with an intercept where they lie elsewhere") {
  const auto check = [](const Array& values, double intercept, int bits, ElementType read) {
    const DicomStored s = dicom_stored(values);
    CHECK(s.slope == 1);
    CHECK(s.intercept == intercept);
    CHECK(s.bits == bits);
    CHECK(s.exact);
    const DatasetPtr d = through(values);
    CHECK(d->fields()[0].array.type() == read);
    for (size_t i = 0; i < values.count(); ++i) CHECK(d->fields()[0].array.get(i) == values.get(i));
  };
  using enum ElementType;
  check(Array::from_vector(std::vector<int16_t>{-32768, 0, 32767}), -32768, 16, i16);
  check(Array::from_vector(std::vector<float>{-1024, 0, 3071}), -1024, 12, i16);
  check(Array::from_vector(std::vector<uint8_t>{0, 255}), 0, 9, u16);
  check(Array::from_vector(std::vector<uint16_t>{0, 65535}), 0, 16, u16);
  check(Array::from_vector(std::vector<int32_t>{-40000, 25535}), -40000, 16, i32);
  check(Array::from_vector(std::vector<double>{1e12, 1e12 + 65535}), 1e12, 16, f64);
  check(Array::from_vector(std::vector<float>{2.5f, 2.5f}), 2.5, 16, f32);
}

TEST_CASE("writing DICOM: other values are rounded to 65536 steps of their range, of any size and place") {
  for (const double size : {1e-30, 1e-3, 1.0, 1e5, 1e30})
    for (const double middle : {0.0, -3.0, 1000.0}) {
      std::vector<double> v;
      for (int i = 0; i <= 1000; ++i) v.push_back(size * (middle + std::sin(0.7 * i)));
      const Array values = Array::from_vector(v);
      const DicomStored s = dicom_stored(values);
      CAPTURE(size);
      CAPTURE(middle);
      CHECK_FALSE(s.exact);
      CHECK(s.slope < size * 2.001 / 65535);
      const DatasetPtr d = through(values);
      const double digits = size * (std::abs(middle) + 1) * 1e-7;  // of f32
      for (size_t i = 0; i < v.size(); ++i) CHECK(std::abs(d->fields()[0].array.get(i) - v[i]) <= 0.501 * s.slope + digits);
    }
  const DicomStored gaps = dicom_stored(Array::from_vector(std::vector<float>{NAN, 1.5f, HUGE_VALF, 2.25f}));
  CHECK(gaps.missing == 2);
  CHECK(error_of([] { dicom_stored(Array::from_vector(std::vector<double>{-1e308, 1e308})); }).find("too far apart") != std::string::npos);
}

TEST_CASE("writing DICOM: colours, the modality, the window and Hounsfield units") {
  const DatasetPtr rgb = through(Array::from_vector(std::vector<uint8_t>{1, 2, 3, 4, 5, 6, 7, 8, 9}, 3), Role::colors);
  CHECK(rgb->fields()[0].role == Role::colors);
  CHECK(rgb->fields()[0].array.get(1, 2) == 6);
  const DatasetPtr mr = through(Array::from_vector(std::vector<int16_t>{1, 2}));
  const auto note = [](const DatasetPtr& d, const std::string& key) {
    for (const auto& [k, v] : d->notes())
      if (k == key) return v;
    return std::string();
  };
  CHECK(note(mr, "Modality") == "MR");
  CHECK(note(mr, "SeriesDescription") == "a b");
  CHECK(note(mr, "WindowCenter") == "40");
  CHECK(note(mr, "WindowWidth") == "400");
  CHECK(error_of([] {
          through(Array::from_vector(std::vector<float>{1, 2, 3, 4, 5, 6}, 3), Role::vectors);
        }).find("3 components") != std::string::npos);
  UniformGrid g;
  g.dims = {2, 2, 1};
  FieldSet fields;
  fields.add({"T", Association::point, Array::from_vector(std::vector<float>{-1000, 0, 40, 0.5}), "HU", Role::scalars});
  written(make_dataset(g, fields));
  const DatasetPtr ct = read_file(temp_folder() + "w.dcm");
  CHECK(note(ct, "Modality") == "CT");
  CHECK(ct->fields()[0].unit == "HU");
}
