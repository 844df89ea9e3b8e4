// SPDX-License-Identifier: Apache-2.0
#include "data/field.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>

#include "support/property.h"
#include "support/test.h"

using namespace sg;

namespace {

Field field(const std::string& name, Association a, float value) {
  return {name, a, Array::from_vector(std::vector<float>{value}), "", Role::none};
}

}  // namespace

TEST_CASE("property: a set of fields answers as a plain list does, however many there are and whatever is added, removed and copied") {
  for (const uint64_t seed : test::property_seeds(30)) {
    CAPTURE(seed);
    test::Random random(seed);
    struct Pair {
      FieldSet set;
      std::vector<Field> list;
    };
    std::vector<Pair> all(1);
    const int names = random.whole(3, 120);
    for (int step = 0; step < 300; ++step) {
      Pair& p = all[size_t(random.whole(0, int(all.size()) - 1))];
      const std::string name = fmt::format("f{}", random.whole(0, names));
      const auto on = Association(random.whole(0, 2));
      const auto same = [&](const Field& f) { return f.name == name && f.association == on; };
      const auto at = std::find_if(p.list.begin(), p.list.end(), same);
      if (random.chance(0.15)) {
        p.set.remove(name, on);
        if (at != p.list.end()) p.list.erase(at);
      } else {
        const Field f = field(name, on, float(step));
        p.set.add(f);
        if (at != p.list.end()) *at = f;
        else p.list.push_back(f);
      }
      if (all.size() < 4 && random.chance(0.05)) all.push_back(Pair(p));
    }
    for (const Pair& p : all) {
      REQUIRE(p.set.size() == p.list.size());
      std::vector<std::string> order;
      for (size_t i = 0; i < p.list.size(); ++i) {
        const Field &want = p.list[i], *found = p.set.find(want.name, want.association);
        CHECK(p.set[i].name == want.name);
        CHECK(found == &p.set[i]);
        CHECK(found->array.get(0) == want.array.get(0));
        if (std::find(order.begin(), order.end(), want.name) == order.end()) order.push_back(want.name);
      }
      CHECK(p.set.names() == order);
      CHECK(p.set.find("none", Association::point) == nullptr);
    }
  }
}

TEST_CASE("fields: forty thousand of them are added, found and named in less than the square of their time") {
  const auto begin = std::chrono::steady_clock::now();
  FieldSet set;
  for (int i = 0; i < 40000; ++i) set.add(field(fmt::format("a rather long name of a field {}", i), Association(i % 3), float(i)));
  for (int i = 0; i < 40000; ++i) CHECK(set.require(fmt::format("a rather long name of a field {}", i)).array.get(0) == i);
  CHECK(set.names().size() == 40000);
  CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() < 3);
}
