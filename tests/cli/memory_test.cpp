// SPDX-License-Identifier: Apache-2.0
// Files larger than the memory that is allowed: opened, sliced and subsampled.
#include <sys/resource.h>
#include <unistd.h>

#include "base/file/file.h"
#include "cli/program.h"
#include "data/memory/memory_budget.h"
#include "io/io.h"
#include "support/test.h"

using namespace sg;
using test::sightglass;

namespace {

// 1 GiB of zeros that take no room on the disk, with a value of 7 in layer 300.
std::string big_brick() {
  const std::string path = test::temp_folder() + "big_1024x1024x1024.raw";
  if (file_exists(path)) return path;
  std::FILE* f = std::fopen(path.c_str(), "wb");
  REQUIRE(f);
  REQUIRE(std::fseek(f, 300L << 20, SEEK_SET) == 0);
  const std::vector<char> layer(1 << 20, 7);
  std::fwrite(layer.data(), 1, layer.size(), f);
  REQUIRE(::ftruncate(::fileno(f), 1L << 30) == 0);
  std::fclose(f);
  return path;
}

}  // namespace

TEST_CASE("memory: a brick larger than what is allowed is subsampled, sliced and cut within it") {
  const std::string big = big_brick(), out = test::temp_folder();
  const std::vector<std::string> read = {"convert", big, "--dims", "1024,1024,1024", "--type", "u8", "--memory", "200M"};
  auto run = [&](std::vector<std::string> more) {
    std::vector<std::string> args = read;
    args.insert(args.end(), more.begin(), more.end());
    const auto r = sightglass(args);
    INFO(r.err);
    CHECK(r.status == 0);
    CHECK(r.peak_bytes < size_t(320) << 20);  // 200 MB of arrays, the program and what it maps for a moment
  };
  Context context;
  run({"--stride", "4", "-o", out + "coarse.vti"});
  const DatasetPtr coarse = std::get<DatasetPtr>(read_data(out + "coarse.vti", {}, context));
  CHECK(coarse->point_count() == 256 * 256 * 256);
  CHECK(coarse->fields()[0].array.get(256 * 256 * 75) == 7);
  run({"--region", "0,1023,0,1023,299,301", "-o", out + "layers.vti"});
  const DatasetPtr layers = std::get<DatasetPtr>(read_data(out + "layers.vti", {}, context));
  CHECK(layers->point_count() == size_t(3) << 20);
  CHECK(layers->as<UniformGrid>()->origin.z == 299);
  run({"--stride", "8,8,1", "-f", "slice axis=z position=300", "-o", out + "slice.vtp"});
  const DatasetPtr slice = std::get<DatasetPtr>(read_data(out + "slice.vtp", {}, context));
  CHECK(slice->cell_count() == 127 * 127);
  CHECK(slice->stats(*slice->fields().find("values")).range[0] == Range{7, 7});
}

TEST_CASE("memory: a slice at a known place reads the layers around it alone") {
  const auto r = sightglass({"convert", big_brick(), "--dims", "1024,1024,1024", "--type", "u8", "--memory", "400M", "-f",
                             "slice axis=z position=300.5", "-o", test::temp_folder() + "thin.vtp"});
  INFO(r.err);
  CHECK(r.status == 0);
  CHECK(r.peak_bytes < size_t(600) << 20);
}

TEST_CASE("memory: what does not fit is refused in one line that says what helps") {
  const auto r = sightglass({"convert", big_brick(), "--dims", "1024,1024,1024", "--type", "u8", "--memory", "100M", "-f", "gradient", "-o",
                             test::temp_folder() + "no.vti"});
  CHECK(r.status == 2);
  CHECK(r.err.find("--memory") != std::string::npos);
  CHECK(r.err.find("100.0 MiB allowed") != std::string::npos);
  CHECK_FALSE(file_exists(test::temp_folder() + "no.vti"));
}

TEST_CASE("memory: arrays are counted while they live") {
  const size_t before = array_memory();
  {
    float* p = nullptr;
    const Array a = Array::make<float>(1000, 1, &p);
    CHECK(array_memory() == before + 4000);
  }
  CHECK(array_memory() == before);
  set_memory_limit(before + 1000);
  float* p = nullptr;
  CHECK(test::error_of([&] { Array::make<float>(1000, 1, &p); }).find("3.9 KiB more") != std::string::npos);
  CHECK(array_memory() == before);
  set_memory_limit(0);
}
