// SPDX-License-Identifier: Apache-2.0
#include "pipeline/graph/key.h"

#include <algorithm>

#include <fcntl.h>
#include <sys/stat.h>

#include "base/file/file.h"
#include "pipeline/operation/test_operations.h"
#include "support/test.h"

using namespace sg;

namespace {
Graph graph() {
  GraphOptions o;
  o.operations = test::counted_operations();
  return Graph(o);
}

void set_modified(const std::string& path, int64_t nanoseconds) {
  const timespec t{time_t(nanoseconds / 1'000'000'000), long(nanoseconds % 1'000'000'000)};
  const timespec both[2] = {t, t};
  REQUIRE(::utimensat(AT_FDCWD, path.c_str(), both, 0) == 0);
}
}  // namespace

TEST_CASE("keys: are the same in every run and on every machine") {
  Graph g = graph();
  const NodeId ramp = g.add_operation("ramp", {"n=4"});
  const NodeId scale = g.add_operation("scale", {"by=0.1"}, {ramp});
  CHECK(key_text(g.key(ramp)) == "8b1e0a6014ef175b73fa3b6df74822c6");
  CHECK(key_text(g.key(scale)) == "0e9a57b972e7d6e89143c787e114342f");
  CHECK(key_text(hash_bytes("", 0)) == "99aa06d3014798d86001c324468d497f");  // of XXH3-128's definition
}

TEST_CASE("keys: same words same key, however they are written; another value another key") {
  Graph g = graph();
  const NodeId a = g.add_operation("ramp", {"n=4", "start=1"});
  const NodeId same = g.add_operation("ramp", {"start=1.0", " n = 4"}, {}, "another name");
  const NodeId defaults = g.add_operation("ramp", {"n=8"}), none = g.add_operation("ramp");
  CHECK(g.key(a) == g.key(same));
  CHECK(g.key(defaults) == g.key(none));
  CHECK(g.key(a) != g.key(none));
  std::vector<Key> keys;
  for (const char* word : {"by=2", "by=2.0000000000000004", "by=-2", "mode=fancy", "field=T", "field=mode=fancy"})
    keys.push_back(g.key(g.add_operation("scale", {word}, {a})));
  keys.push_back(g.key(g.add_operation("scale", {}, {none})));
  keys.push_back(g.key(g.add_operation("pick", {}, {a})));
  keys.push_back(g.key(g.add_operation("add", {}, {a, none})));
  keys.push_back(g.key(g.add_operation("add", {}, {none, a})));
  std::sort(keys.begin(), keys.end());
  CHECK(std::unique(keys.begin(), keys.end()) == keys.end());
}

TEST_CASE("keys: parts of a key do not run together") {
  CHECK(KeyBuilder().add("ab").add("c").key() != KeyBuilder().add("a").add("bc").key());
  CHECK(KeyBuilder().add("a\nb=2").key() != KeyBuilder().add("a").add("b=2").key());
  CHECK(KeyBuilder().add(uint64_t(1)).key() == KeyBuilder().add(uint64_t(1)).key());
}

TEST_CASE("keys: the version of an operation is part of the key") {
  std::vector<Operation> newer(test::counted_operations().begin(), test::counted_operations().end());
  newer[0].version = 2;
  GraphOptions o;
  o.operations = newer;
  Graph a = graph(), b(o);
  CHECK(a.key(a.add_operation("ramp")) != b.key(b.add_operation("ramp")));
  CHECK(a.key(a.add_operation("moment")) == b.key(b.add_operation("moment")));
}

TEST_CASE("keys: a file's key follows its path, size and time of change, and strictly its content") {
  const std::string a = test::temp_folder() + "key_a.raw", b = test::temp_folder() + "key_b.raw";
  write_file(a, "12345"), write_file(b, "12345");
  const int64_t t = 1'700'000'000'123'456'789;
  set_modified(a, t), set_modified(b, t);
  const Key loose = file_key(a, false), strict = file_key(a, true);
  CHECK(loose == file_key(a, false));
  CHECK(loose != strict);
  CHECK(loose != file_key(b, false));
  set_modified(a, t + 1);
  CHECK(loose != file_key(a, false));
  write_file(a, "12346"), set_modified(a, t);  // the same size and time: only the strict key sees it
  CHECK(loose == file_key(a, false));
  CHECK(strict != file_key(a, true));
  write_file(a, "123456"), set_modified(a, t);
  CHECK(loose != file_key(a, false));
  CHECK(file_key(test::temp_folder() + "absent.raw", true) == file_key(test::temp_folder() + "absent.raw", true));
}

TEST_CASE("keys: a header's key follows the files that it names") {
  const std::string header = test::temp_folder() + "brick.mhd", data = test::temp_folder() + "brick.raw";
  write_file(data, "abc");
  write_file(header, "NDims = 3\nDimSize = 1 1 3\nElementSpacing = 1.5 1 1\nElementDataFile = brick.raw\n");
  const std::vector<FileState> files = file_and_parts(header);
  REQUIRE(files.size() == 2);
  CHECK(files[1].path == data);
  CHECK(files[1].size == 3);
  const Key before = file_key(header, false);
  write_file(data, "abcd");
  CHECK(file_key(header, false) != before);
}

TEST_CASE("keys: data at hand equals nothing else unless words vouch for it") {
  Graph g = graph();
  const DatasetPtr d = test::line_of(3);
  CHECK(g.key(g.add_data(d)) != g.key(g.add_data(d)));
  CHECK(g.key(g.add_data(d, "line 3")) == g.key(g.add_data(test::line_of(3), "line 3")));
  CHECK(g.key(g.add_data(d, "line 3")) != g.key(g.add_data(d, "line 4")));
}
