// SPDX-License-Identifier: Apache-2.0
// Zarr folders that are damaged or hostile: an Error each, never a crash, and no memory for what is not there.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "io/io_files.h"

using namespace sg;
using namespace sg::test;

namespace {

std::string good(const std::string& name) {
  DatasetParts parts;
  UniformGrid g;
  g.dims = {70, 20, 10};
  parts.mesh = g;
  std::vector<float> v;
  for (size_t i = 0; i < 14000; ++i) v.push_back(std::sin(float(i)));
  parts.fields.add({"f", Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  const std::string path = temp_folder() + name;
  std::filesystem::remove_all(path);
  Context context;
  write_data(path, make_dataset(std::move(parts)), {}, context);
  return path;
}

std::string array_with(std::string_view shape, std::string_view chunks, std::string_view more = "") {
  const std::string path = empty_folder("hostile.zarr");
  write_file(path + "/.zarray",
             fmt::format(R"({{"zarr_format": 2, "shape": {}, "chunks": {}, "dtype": "<f4", "compressor": null, "order": "C"{}}})", shape,
                         chunks, more));
  return path;
}

std::string refused(const std::string& path) {
  Context context;
  context.memory_limit = size_t(64) << 20;
  return error_of([&] { read_data(path, {}, context); });
}

// Reads or throws an Error.
void survives(const std::string& path) {
  Context context;
  context.memory_limit = size_t(64) << 20;
  try {
    read_data(path, {}, context);
  } catch (const Error& e) {
    CHECK((e.kind() == ErrorKind::data || e.kind() == ErrorKind::usage));
  }
}

}  // namespace

TEST_CASE("zarr: each file cut anywhere and damaged in each of its first bytes is read or refused") {
  const std::string path = good("damaged.zarr");
  for (const char* name : {"/.zattrs", "/0/.zarray", "/0/0/0/0", "/minmax/.zarray", "/minmax/0.0.0.0.0", "/.zgroup"}) {
    CAPTURE(name);
    const std::string bytes(MappedFile(path + name).text());
    for (size_t k = 0; k < 64; ++k) {
      write_file(path + name, std::string_view(bytes).substr(0, bytes.size() * k / 64));
      survives(path);
    }
    for (size_t k = 0; k < std::min<size_t>(200, bytes.size()); ++k)
      for (const char with : {'\xff', '9', '\0'}) {
        std::string damaged = bytes;
        damaged[k] = with;
        write_file(path + name, damaged);
        survives(path);
      }
    write_file(path + name, bytes);
  }
  Context context;
  read_data(path, {}, context);
}

TEST_CASE("zarr: a damaged or cut chunk is named") {
  const std::string path = good("chunk.zarr");
  const std::string bytes(MappedFile(path + "/0/0/0/0").text());
  write_file(path + "/0/0/0/0", bytes.substr(0, bytes.size() / 2));
  CHECK(contains(refused(path), "/0/0/0/0"));
  write_file(path + "/0/0/0/0", "");
  CHECK(contains(refused(path), "/0/0/0/0"));
  std::filesystem::remove(path + "/0/0/0/0");  // a missing one is all fill value
  survives(path);
  std::filesystem::create_directories(path + "/0/0/0/0");
  CHECK(contains(refused(path), "/0/0/0/0"));
}

TEST_CASE("zarr: hostile shapes and chunks are refused before memory is asked for") {
  CHECK(contains(refused(array_with("[2147483648, 2147483648, 2147483648]", "[64, 64, 64]")), "2^56"));
  CHECK(contains(refused(array_with("[9223372036854775807]", "[64]")), "whole number"));
  CHECK(contains(refused(array_with("[-1, 3]", "[1, 1]")), "whole number"));
  CHECK(contains(refused(array_with("[1.5, 3]", "[1, 1]")), "whole number"));
  CHECK(contains(refused(array_with("[0, 3]", "[1, 1]")), "whole number"));
  CHECK(contains(refused(array_with("[4, 4]", "[0, 4]")), "whole number"));
  CHECK(contains(refused(array_with("[4, 4]", "[65536, 65536]")), "1 GiB"));
  CHECK(contains(refused(array_with("[4, 4]", "[4]")), "numbers, not 2"));
  CHECK(contains(refused(array_with("[]", "[]")), "axes"));
  CHECK(contains(refused(array_with("[1,1,1,1,1,1,1,1,1]", "[1,1,1,1,1,1,1,1,1]")), "axes"));
  CHECK(contains(refused(array_with("[1048576, 1048576, 32]", "[64, 64, 32]")), "no coarser level"));
  CHECK(contains(refused(array_with("[256, 256, 128]", "[64, 64, 64]")), "no chunk of this array"));
  // A chunk much larger than the array, whose file is tiny.
  const std::string path = array_with("[2, 2]", "[8192, 8192]");
  write_file(path + "/0.0", "abcd");
  refused(path);
}

TEST_CASE("zarr: descriptions that cannot be right are refused, and say where") {
  const std::string path = array_with("[2, 2]", "[2, 2]");
  auto with = [&](std::string_view text) {
    write_file(path + "/.zarray", text);
    return refused(path);
  };
  CHECK(contains(with("{"), "not valid JSON"));
  CHECK(contains(with("[]"), "not a JSON object"));
  CHECK(contains(with(std::string(100000, '[')), ".zarray"));
  CHECK(contains(with("{\"a\":" + std::string(100, '[') + std::string(100, ']') + "}"), "nested more than"));
  CHECK(contains(with(R"({"zarr_format": 2, "shape": [2], "chunks": [2], "dtype": "<U4"})"), "type '<U4'"));
  CHECK(contains(with(R"({"zarr_format": 2, "shape": [2], "chunks": [2], "dtype": [["a", "<f4"]]})"), "type"));
  CHECK(contains(with(R"({"zarr_format": 3, "shape": [2], "chunks": [2], "dtype": "<f4"})"), "version 2"));
  CHECK(contains(with(R"({"zarr_format": 2, "shape": [2], "chunks": [2], "dtype": "<f4", "order": "F"})"), "order"));
  CHECK(contains(with(R"({"zarr_format": 2, "shape": [2], "chunks": [2], "dtype": "<f4", "filters": [{"id": "delta"}]})"), "filters"));
  CHECK(contains(with(R"({"zarr_format": 2, "shape": [2], "chunks": [2], "dtype": "<f4", "compressor": {"id": "snappy"}})"), "snappy"));
  CHECK(contains(with(R"({"zarr_format": 2, "shape": [2], "chunks": [2], "dtype": "<f4", "dimension_separator": "-"})"), "separator"));
  CHECK(contains(with(R"({"zarr_format": 2, "shape": [2], "chunks": [2], "dtype": "|u1", "fill_value": "NaN"})"), "fill value"));
  CHECK(contains(with(R"({"zarr_format": 2, "shape": [2], "chunks": [2], "dtype": "|u1", "fill_value": []})"), "fill value"));

  const std::string image = good("image.zarr");
  auto described = [&](std::string_view text) {
    write_file(image + "/.zattrs", text);
    return refused(image);
  };
  CHECK(contains(described("{}"), "multiscales"));
  CHECK(contains(described(R"({"multiscales": [{}]})"), "datasets"));
  CHECK(contains(described(R"({"multiscales": [{"datasets": [{"path": "../x"}]}]})"), "'../x'"));
  CHECK(contains(described(R"({"multiscales": [{"datasets": [{"path": "/etc"}]}]})"), "'/etc'"));
  CHECK(contains(described(R"({"multiscales": [{"datasets": [{"path": "5"}]}]})"), "no array"));
  CHECK(contains(described(R"({"multiscales": [{"axes": ["z", "y"], "datasets": [{"path": "0"}]}]})"), "names 2 axes"));
  CHECK(contains(described(R"({"multiscales": [{"axes": ["q", "y", "x"], "datasets": [{"path": "0"}]}]})"), "axis 'q'"));
  CHECK(contains(described(R"({"multiscales": [{"axes": ["z", "y", "c"], "datasets": [{"path": "0"}]}]})"), "no axis x"));
  auto moved = [&](std::string_view t) {
    return described(fmt::format(
        R"({{"multiscales": [{{"axes": ["z", "y", "x"], "datasets": [{{"path": "0", "coordinateTransformations": [{}]}}]}}]}})", t));
  };
  CHECK(contains(moved(R"({"type": "scale", "scale": [1, 1]})"), "2 numbers for 3"));
  CHECK(contains(moved(R"({"type": "scale", "scale": [1, 0, 1]})"), "above 0"));
  CHECK(contains(moved(R"({"type": "scale", "scale": [1, "a", 1]})"), "not a number"));
  CHECK(contains(moved(R"({"type": "affine", "affine": []})"), "affine"));
  // Levels must go together.
  CHECK(contains(described(R"({"multiscales": [{"axes": ["z", "y", "x"], "datasets": [{"path": "1"}, {"path": "0"}]}]})"), "in level 0"));
  CHECK(contains(refused(empty_folder("empty.zarr")), "folder of unknown kind"));
}

TEST_CASE("zarr: version 3 that cannot be right is refused") {
  const std::string path = empty_folder("three.zarr");
  auto with = [&](std::string_view text) {
    write_file(path + "/zarr.json", text);
    return refused(path);
  };
  CHECK(contains(with("{}"), "multiscales"));
  const std::string array = R"({"zarr_format": 3, "node_type": "array", "shape": [2, 2], "data_type": "float32")";
  CHECK(contains(with(array + "}"), "not regular"));
  const std::string regular = array + R"(, "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [2, 2]}})";
  CHECK(contains(with(regular + "}"), "codecs"));
  CHECK(contains(with(regular + R"(, "codecs": []})"), "'bytes'"));
  CHECK(contains(with(regular + R"(, "codecs": [{"name": "sharding_indexed"}]})"), "shards"));
  CHECK(contains(with(regular + R"(, "codecs": ["bytes", "transpose"]})"), "transpose"));
  CHECK(contains(with(R"({"zarr_format": 3, "node_type": "array", "shape": [2, 2], "data_type": "complex64"})"), "complex64"));
}
