// SPDX-License-Identifier: Apache-2.0
// Pages that turn without a server, as far as the command line goes; what they show is tried in tests/web/offline.mjs.
#include "cli/program.h"
#include "support/test.h"

using sg::test::bytes_of;
using sg::test::must;
using sg::test::Ran;
using sg::test::sightglass;

TEST_CASE("pages: one file that asks nothing of a network, small and the same each time") {
  const std::vector<std::string> words = {"render", "--source", "gyroid size=24", "--show", "volume", "--size", "320x240"};
  const auto page_of = [&](const std::string& name) {
    std::vector<std::string> all = words;
    all.insert(all.end(), {"-o", name});
    must(all);
    return bytes_of(name);
  };
  const std::string page = page_of("a.html");
  CHECK(page.starts_with("<!doctype html>"));
  CHECK(page.find("Content-Security-Policy") != std::string::npos);
  CHECK(page.find("default-src 'none'") != std::string::npos);
  for (const char* loads : {"src=\"http", "href=\"http", "import(", "@import"}) CHECK(page.find(loads) == std::string::npos);
  CHECK(page.size() < 8 << 20);
  CHECK(page == page_of("b.html"));
}

TEST_CASE("pages: what a page leaves out of the picture is said on the command line, and the page is written") {
  const Ran shadows =
      sightglass({"render", "--source", "hydrogen size=16", "--show", "volume shadows=0.5", "--size", "160x120", "-o", "shadows.html"});
  CHECK(shadows.status == 0);
  CHECK((shadows.out + shadows.err).find("shadows and occlusion") != std::string::npos);
  CHECK(bytes_of("shadows.html").starts_with("<!doctype html>"));
}
