// SPDX-License-Identifier: Apache-2.0
// SG_SIMD: results are the same bytes for every vector width that this machine has.
#include <cstdlib>

#include "base/file/file.h"
#include "program.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

namespace {

/// SG_SIMD while it lives.
struct Capped {
  explicit Capped(const char* word) { ::setenv("SG_SIMD", word, 1); }
  ~Capped() { ::unsetenv("SG_SIMD"); }
};

/// The bytes of what the program writes.
std::string written(const char* word, const std::vector<std::string>& args, const std::string& name) {
  const Capped capped(word);
  const std::string path = temp_folder() + name;
  std::vector<std::string> all = args;
  all.insert(all.end(), {"-o", path});
  const Ran r = sightglass(all);
  INFO(std::string(word) << ": " << r.err);
  REQUIRE(r.status == 0);
  return std::string(MappedFile(path).text());
}

}  // namespace

TEST_CASE("SG_SIMD: pictures and results are the same bytes for every vector width") {
  const std::vector<std::string> size = {"--size", "120x90"};
  const auto picture = [&](std::vector<std::string> args) {
    args.insert(args.begin(), "render"), args.insert(args.end(), size.begin(), size.end());
    return args;
  };
  const std::vector<std::vector<std::string>> pictures = {
      picture({"-s", "tangle size=24", "-f", "contour values=0"}),
      picture({"-s", "marschner_lobb size=24", "--show", "volume shaded=true"}),
      picture({"-s", "abc size=12", "-f", "streamlines", "--show", "lines"}),
  };
  for (size_t i = 0; i < pictures.size(); ++i) {
    CAPTURE(i);
    const std::string name = "simd" + std::to_string(i) + ".png", widest = written("", pictures[i], name);
    CHECK(written("avx2", pictures[i], name) == widest);
    CHECK(written("baseline", pictures[i], name) == widest);
  }
}

TEST_CASE("SG_SIMD: the cap is told with --verbose, and other words are refused") {
  const auto run = [](const char* word) {
    const Capped capped(word);
    return sightglass({"info", "--verbose", "-s", "tangle size=4"});
  };
  const Ran widest = run(""), baseline = run("baseline"), wrong = run("sse9");
  CHECK(widest.status == 0);
  CHECK(baseline.status == 0);
  CHECK(baseline.err.find("vector code for ") != std::string::npos);
  CHECK(baseline.err.find("AVX") == std::string::npos);
  CHECK(wrong.status == 2);
  CHECK(wrong.err.find("'sse9' is not a vector width") != std::string::npos);
  CHECK(wrong.err.find("avx2") != std::string::npos);
}
