// SPDX-License-Identifier: Apache-2.0
// `info --json` of every real data set agrees with what independent readers report (tools/check_manifest).
#include <cstdio>
#include <cstdlib>

#include "support/test.h"

using namespace sg;

namespace {

bool no_python() { return std::system("python3 -c pass >/dev/null 2>&1") != 0; }

}  // namespace

TEST_CASE("manifest: info agrees with independent readers on every data set" * doctest::skip(test::no_data() || no_python())) {
  const std::string command = "python3 '" + std::string(test::source_folder()) + "/tools/check_manifest' '" + test::build_folder() +
                              "/sightglass' '" + test::data_folder() + "' 2>&1";
  std::FILE* p = ::popen(command.c_str(), "r");
  REQUIRE(p);
  std::string out;
  char b[4096];
  while (const size_t n = std::fread(b, 1, sizeof b, p)) out.append(b, n);
  const int status = ::pclose(p);
  INFO(out);
  CHECK(status == 0);
  CHECK(out.find("read,") != std::string::npos);
}
