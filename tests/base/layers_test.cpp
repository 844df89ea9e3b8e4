// SPDX-License-Identifier: Apache-2.0
// tools/check_layers finds what it is there to find.
#include <sys/stat.h>

#include <cstdio>
#include <cstdlib>

#include "base/file/file.h"
#include "support/test.h"

using namespace sg;

namespace {

bool no_python() { return std::system("python3 -c pass >/dev/null 2>&1") != 0; }

/// Output of the checker on a checkout; `passed` says whether it exited 0.
std::string check(const std::string& root, bool& passed) {
  std::FILE* p = ::popen(("python3 '" + std::string(test::source_folder()) + "/tools/check_layers' '" + root + "' 2>&1").c_str(), "r");
  REQUIRE(p);
  std::string out;
  char b[4096];
  while (const size_t n = std::fread(b, 1, sizeof b, p)) out.append(b, n);
  passed = ::pclose(p) == 0;
  return out;
}

/// A checkout with one good file, and one more file.
std::string checkout_with(const std::string& name, const std::string& file, const std::string& text) {
  const std::string root = test::temp_folder() + name;
  for (const char* folder : {"", "/src", "/src/base", "/src/data", "/src/filter", "/src/filter/flow", "/src/oddities", "/src/scene",
                             "/src/scene/choose", "/src/render", "/src/render/shade", "/src/render/attic", "/src/render/volume",
                             "/src/render/raster", "/src/render/raster/marks", "/tests"})
    ::mkdir((root + folder).c_str(), 0755);
  write_file(root + "/src/base/error.h", "// SPDX-License-Identifier: Apache-2.0\n#include <string>\n");
  write_file(root + "/src/filter/flow/a.h", "// SPDX-License-Identifier: Apache-2.0\n#include \"base/error.h\"\n");
  write_file(root + "/src/scene/look.h", "// SPDX-License-Identifier: Apache-2.0\n");
  write_file(root + "/src/render/raster/marks/m.h", "// SPDX-License-Identifier: Apache-2.0\n");
  write_file(root + "/" + file, text);
  return root;
}

const std::string spdx = "// SPDX-License-Identifier: Apache-2.0\n";

}  // namespace

TEST_CASE("check_layers: this checkout keeps the rules" * doctest::skip(no_python())) {
  bool passed = false;
  const std::string out = check(test::source_folder(), passed);
  CHECK_MESSAGE(passed, out);
}

TEST_CASE("check_layers: each violation is found and named with its line" * doctest::skip(no_python())) {
  struct Case {
    const char *file, *text, *finds;
  };
  const std::string longer = spdx + std::string(700, '\n');
  const Case cases[] = {
      {"src/data/x.h", "#include \"filter/flow/a.h\"\n", "src/data/x.h:2: data includes \"filter/flow/a.h\", but filter stands below data"},
      {"src/base/x.cpp", "\n  #  include \"data/none.h\"\n", "src/base/x.cpp:3: includes \"data/none.h\", which is not under src/"},
      {"src/filter/flow/b.cpp", "#include \"a.h\"\n", "src/filter/flow/b.cpp:2: includes \"a.h\"; write \"folder/a.h\""},
      {"src/data/x.h", "#include <iostream>\n", "a header includes <iostream>"},
      {"src/data/x.h", "#include <yaml-cpp/yaml.h>\n", "a header includes <yaml-cpp/yaml.h>"},
      {"src/data/x.h", "#include \"hwy/highway.h\"\n", "a header includes <hwy/highway.h>"},
      {"src/oddities/x.h", "", "folder 'oddities' has no place"},
      {"src/data/x.cpp", "#include <iostream>\n#include \"base/error.h\"\n#include \"data/x.cpp\"\n", ""},
      {"tests/x.cpp", "#include \"x.h\"\n", ""},
      {"src/render/shade/x.h", "#include \"render/raster/marks/m.h\"\n",
       "src/render/shade/x.h:2: includes \"render/raster/marks/m.h\", but raster/marks stands below it"},
      {"src/render/volume/x.h", "#include \"render/raster/marks/m.h\"\n", ""},
      {"src/render/attic/x.h", "#include \"render/raster/marks/m.h\"\n", "render/attic/x.h has no place in the order"},
      {"src/scene/choose/x.h", "#include \"scene/look.h\"\n", "but look stands below it"},
      {"tests/x.cpp", "// fmt::\nint x = fmt::format();\n", "tests/x.cpp:3: uses fmt without an include"},
  };
  int i = 0;
  for (const Case& c : cases) {
    bool passed = false;
    const std::string out = check(checkout_with("layers" + std::to_string(i++), c.file, spdx + c.text), passed);
    CHECK_MESSAGE(passed == !*c.finds, out);
    CHECK_MESSAGE(out.find(c.finds) != std::string::npos, out);
  }
  bool passed = true;
  CHECK(check(checkout_with("layers_long", "src/data/x.cpp", longer), passed).find("has 701 lines, more than 700") != std::string::npos);
  CHECK_FALSE(passed);
  CHECK(
      check(checkout_with("layers_spdx", "tests/x.cpp", "int x;\n"), passed).find("tests/x.cpp:1: the first line must be the SPDX line") !=
      std::string::npos);
  CHECK_FALSE(passed);
  std::string crowded;
  for (int i = 0; i < 26; ++i) crowded = checkout_with("layers_crowded", "src/data/x" + std::to_string(i) + ".h", spdx);
  CHECK(check(crowded, passed).find("src/data:1: holds 26 sources flat, more than 25") != std::string::npos);
  CHECK_FALSE(passed);
  check("/nowhere", passed);
  CHECK_FALSE(passed);
}
