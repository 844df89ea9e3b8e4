// SPDX-License-Identifier: Apache-2.0
#include <set>

#include "filter/field/calc/calc.h"
#include "filter/mesh/mesh_meshes.h"
#include "support/test.h"

using namespace sg;

TEST_CASE("calc: every word of its help can be written as the help writes it") {
  Context ctx;
  DatasetParts parts = test::meshes::uniform_box(1, 1, 1)->parts();
  const size_t n = 8;
  for (const char* name : {"a", "b", "c"})
    parts.fields.add({name, Association::point, Array::from_vector(std::vector<double>(n, 0.5)), "", Role::none});
  for (const char* name : {"u", "v"})
    parts.fields.add({name, Association::point, Array::from_vector(std::vector<double>(3 * n, 0.5), 3), "", Role::none});
  parts.fields.add({"t", Association::point, Array::from_vector(std::vector<double>(9 * n, 0.5), 9), "", Role::none});
  const DatasetPtr in = make_dataset(std::move(parts));
  std::set<std::string_view> forms;
  for (const HelpWord& w : calc_words()) {
    CAPTURE(w.form);
    CHECK(forms.insert(w.form).second);
    CHECK(w.sentence.back() == '.');
    CHECK_NOTHROW(calc(in, {std::string(w.form), "r"}, ctx));
  }
  // Functions are listed all: the parser offers one that is near to every wrong name.
  for (const char* wrong : {"sim", "coz", "atan3", "clmp", "isnam", "trase", "hypo"}) {
    const std::string error = test::error_of([&] { calc(in, {std::string(wrong) + "(a)", "r"}, ctx); });
    const size_t quote = error.rfind("'", error.rfind("'") - 1);
    CAPTURE(error);
    const std::string named = error.substr(quote + 1, error.rfind("'") - quote - 1);
    bool listed = false;
    for (const HelpWord& w : calc_words()) listed |= w.form.starts_with(named + "(");
    CHECK(listed);
  }
}
