// SPDX-License-Identifier: Apache-2.0
// view and serve, as far as the command line goes; what they serve is tried in tests/serve and tests/web.
#include "cli/program.h"
#include "support/test.h"

using sg::test::Ran;
using sg::test::sightglass;

TEST_CASE("view: mistakes that can be seen at once end the command") {
  const Ran missing = sightglass({"view", "no_such_file.vti", "--no-browser"});
  CHECK(missing.status == 3);
  CHECK(missing.err.find("no_such_file.vti") != std::string::npos);
  const Ran operation = sightglass({"view", "--source", "sphere", "--no-browser", "-f", "contuor values=1"});
  CHECK(operation.status == 2);
  CHECK(operation.err.find("contour") != std::string::npos);
  const Ran way = sightglass({"view", "--source", "sphere", "--no-browser", "--show", "surfac"});
  CHECK(way.status == 2);
  CHECK(way.err.find("surface") != std::string::npos);
  CHECK(sightglass({"view"}).status == 2);
  CHECK(sightglass({"view", "--source", "sphere", "--port", "70000"}).status == 2);
}

TEST_CASE("serve: only folders, and not the root of all; a new user's token is printed once") {
  CHECK(sightglass({"serve", "/no/such/folder"}).status == 2);
  CHECK(sightglass({"serve", "/"}).status == 2);
  CHECK(sightglass({"serve", ".", "--users", "no_such_file.txt"}).status == 3);
  const Ran user = sightglass({"serve", ".", "--add-user", "anna edit"});
  CHECK(user.status == 0);
  CHECK(user.out.find("anna edit sha256:") != std::string::npos);
  CHECK(sightglass({"serve", ".", "--add-user", "anna rule"}).status == 2);
}
