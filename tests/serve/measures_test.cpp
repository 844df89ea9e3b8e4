// SPDX-License-Identifier: Apache-2.0
// Numbers of selections.
#include "serve/renderer/questions/measures.h"

#include <cmath>

#include "serve/support/looking.h"
#include "support/test.h"

using namespace sg;
using namespace sg::serve;
using doctest::Approx;
using sg::test::Window;

namespace {

// [-1,1]^3 (the source reaches 1.3 radii) in 24^3 cells, with u from 0 to 1 along x, and w = (x, y, 0).
const std::string u_grid =
    "sightglass: 1\nsteps:\n  ball: {sphere: {size: 25, radius: 0.7692307692307693}}\n  u: {calc: {expr: (x+1)/2, name: u}}\n"
    "  head: {calc: {expr: \"vec(x,y,0)\", name: w}}\nshow:\n  - {outline: , of: head}\n";

Json ask_measures(Window& window, const std::string& members) {
  window.say("{'do':'measures','n':5,'step':'head'" + members + "}");
  return window.next("measures");
}

std::string refused_measures(Window& window, const std::string& members) {
  window.say("{'do':'measures','n':6" + members + "}");
  const Json answer = window.next("refused");
  CHECK(answer["n"].whole() == 6);
  return answer["errors"][0]["text"].text();
}

const Json& field_of(const Json& answer, const std::string& name, int component = -1) {
  for (const Json& f : answer["fields"].items())
    if (f["name"].text() == name && int(f["component"].number()) == component) return f;
  static const Json none;
  return none;
}

// Cells and points of a step as its size tells them.
uint64_t cells_of_step(const Json& step) {
  const std::string size = step["size"].text();  // "169 points, 144 cells"
  return std::stoull(size.substr(size.find(", ") + 2));
}

// What an edit with the answer's steps leaves of "head".
uint64_t cells_after(Window& window, const Json& steps) {
  std::string from = "head";
  for (const Json& s : steps.items()) {
    window.say(Json(Json::Members{{"do", Json(std::string("edit"))},
                                  {"n", Json(uint64_t(77))},
                                  {"edits", Json(std::vector<Json>{Json(Json::Members{{"add", Json(std::string("step"))},
                                                                                      {"operation", s["operation"]},
                                                                                      {"from", Json(std::vector<Json>{Json(from)})},
                                                                                      {"set", s["set"]}})})}})
                   .dump());
    Json state;
    do state = window.next("state");
    while (state["by"].whole() != 77 && state["steps"].size() < 4);
    const Json& last = state["steps"][state["steps"].size() - 1];
    from = last["name"].text();
    if (&s == &steps.items().back()) return cells_of_step(last);
  }
  return 0;
}

}  // namespace

TEST_CASE("measures: of all of a box, the numbers of linear fields are known") {
  const auto session = test::opened(u_grid);
  Window window(*session);
  window.next("state");
  const Json all = ask_measures(window, "");
  CHECK(all["n"].whole() == 5);
  CHECK(all["points"].whole() == 25 * 25 * 25);
  CHECK(all["cells"].whole() == 24 * 24 * 24);
  CHECK(all["measure"].number() == Approx(8));
  CHECK(all["dimension"].whole() == 3);
  CHECK(all["steps"].is_list());
  CHECK(all["steps"].empty());
  const Json& u = field_of(all, "u");
  CHECK(u["on"].text() == "point");
  CHECK(u["count"].whole() == 25 * 25 * 25);
  CHECK(u["missing"].whole() == 0);
  CHECK(u["min"].number() == 0);
  CHECK(u["max"].number() == 1);
  CHECK(u["mean"].number() == Approx(0.5));
  CHECK(u["median"].number() == Approx(0.5));
  CHECK(u["integral"].number() == Approx(4));  // 8 times the mean
  // Of 25 numbers 0, 1/24, ... the mean square from the mean is (25^2 - 1) / 12 / 24^2.
  const double n = 25 * 25 * 25;
  CHECK(u["deviation"].number() == Approx(std::sqrt(624.0 / 12 / 576 * n / (n - 1))));
  const Json& length = field_of(all, "w", -1);
  CHECK(length["max"].number() == Approx(std::sqrt(2.0)));
  CHECK(length["integral"].is_null());
  CHECK(field_of(all, "w", 0)["integral"].number() == Approx(0).scale(1));
  const Json one = ask_measures(window, ",'field':'u'");
  CHECK(one["fields"].size() == 1);
}

TEST_CASE("measures: the half of a box by place, by value and by an outline in the picture") {
  const std::string place = "'box':[-2,0.001,-2,2,-2,2]", value = "'value':{'field':'u','range':[-1,0.5]}";
  for (const int how : {0, 1, 2, 3}) {
    const auto session = test::opened(u_grid);
    Window window(*session);
    const test::Looking seen = test::looked(window, test::along_z);
    const std::string outline = "'lasso':" + seen.pixels({{-3, -3, 0}, {0.001, -3, 0}, {0.001, 3, 0}, {-3, 3, 0}}) + ",'view':0";
    const std::string among = how == 0 ? place : how == 1 ? value : how == 2 ? outline : place + "," + outline + "," + value;
    CAPTURE(among);
    const Json half = ask_measures(window, ",'among':{" + among + "}");
    CHECK(half["cells"].whole() == 12 * 24 * 24);
    CHECK(half["points"].whole() == 13 * 25 * 25);
    CHECK(half["measure"].number() == Approx(4));
    CHECK(field_of(half, "u")["max"].number() == Approx(0.5));
    CHECK(field_of(half, "u")["mean"].number() == Approx(0.25));
    CHECK(field_of(half, "u")["integral"].number() == Approx(1));  // 4 times 1/4
    CHECK(cells_after(window, half["steps"]) == 12 * 24 * 24);
  }
  const auto session = test::opened(u_grid);
  Window window(*session);
  window.next("state");
  const Json none = ask_measures(window, ",'among':{'box':[5,6,5,6,5,6]}");
  CHECK(none["cells"].whole() == 0);
  CHECK(none["measure"].is_null());
  CHECK(field_of(none, "u")["count"].whole() == 0);
  CHECK(field_of(none, "u")["mean"].is_null());
  CHECK(field_of(none, "u")["integral"].is_null());
}

TEST_CASE("measures: outlines in oblique and perspective views, and of stretched data, hold what is seen in them") {
  for (const std::string stretch : {"", "picture: {stretch: \"1,2,0.5\"}\n"}) {
    const Vec3 s = stretch.empty() ? Vec3(1, 1, 1) : Vec3(1, 2, 0.5);
    for (const std::string camera : {"'position':[3,-4,2],'target':[0.1,0,0],'up':[0,0.1,1],'parallel':false,'view_angle':40",
                                     "'position':[3,-4,2],'target':[0.1,0,0],'up':[0,0.1,1],'parallel':true,'height':5"}) {
      const auto session = test::opened(u_grid + stretch);
      Window window(*session);
      const int view = camera.find("true") == camera.npos ? 0 : 1;
      CAPTURE(camera);
      const test::Looking seen = test::looked(window, camera, view);
      // A rectangle of the picture; its sides go through no centre of a cell.
      const double x0 = 141.3, x1 = 230.7, y0 = 77.7, y1 = 200.3;
      size_t expected = 0;
      for (int i = 0; i < 24 * 24 * 24; ++i) {
        const Vec3 at = Vec3((i % 24 + 0.5) / 12 - 1, (i / 24 % 24 + 0.5) / 12 - 1, (i / 576 + 0.5) / 12 - 1) * s;
        const Vec3 p = seen.projection.to_pixel(at) + Vec3(seen.x, seen.y, 0);
        expected += p.x > x0 && p.x < x1 && p.y > y0 && p.y < y1;
      }
      CHECK(expected > 1000);
      const auto number = [](double v) { return std::to_string(v); };
      const std::string lasso = "[[" + number(x0) + "," + number(y0) + "],[" + number(x1) + "," + number(y0) + "],[" + number(x1) + "," +
                                number(y1) + "],[" + number(x0) + "," + number(y1) + "]]";
      const Json answer = ask_measures(window, ",'among':{'view':" + std::to_string(view) + ",'lasso':" + lasso + "}");
      CHECK(answer["cells"].whole() == expected);
      CHECK(answer["steps"][0]["set"].contains("lasso_eye") == (view == 0));
      CHECK(cells_after(window, answer["steps"]) == expected);
    }
  }
}

TEST_CASE("measures: parts of a collection are one, and cell fields and clouds have numbers, too") {
  auto all = std::make_shared<Collection>();
  for (int k = 0; k < 2; ++k) {
    UniformGrid g;
    g.dims = {3, 2, 2}, g.origin = Vec3(2.0 * k, 0, 0);
    FieldSet fields;
    fields.add({"c", Association::cell, Array::from_vector(std::vector<float>{float(2 * k), float(2 * k + 1)}), "K", Role::scalars});
    all->parts.push_back({k ? "right" : "left", make_dataset(g, std::move(fields))});
  }
  Context context;
  const Json answer(measures_of(CollectionPtr(all), {}, "", context));
  CHECK(answer["cells"].whole() == 4);
  CHECK(answer["measure"].number() == Approx(4));
  const Json& c = field_of(answer, "c");
  CHECK(c["unit"].text() == "K");
  CHECK(c["count"].whole() == 4);
  CHECK(c["median"].number() == Approx(1.5));
  CHECK(c["deviation"].number() == Approx(std::sqrt(5.0 / 3)));
  CHECK(c["integral"].number() == Approx(6));
  Selection some;
  some.field = "c", some.lo = 1, some.hi = 2;
  const Json two(measures_of(CollectionPtr(all), some, "", context));
  CHECK(two["cells"].whole() == 2);
  CHECK(two["points"].whole() == 16);  // of the cells
  CHECK(field_of(two, "c")["mean"].number() == Approx(1.5));
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0, 1, 0, 0, 2, 0, 0}, 3);
  FieldSet fields;
  fields.add({"q", Association::point, Array::from_vector(std::vector<double>{1, 5, 9}), "", Role::scalars});
  Selection near;
  near.box = {0.5, 3, -1, 1, -1, 1};
  const Json points(measures_of(make_dataset(cloud, std::move(fields)), near, "q", context));
  CHECK(points["points"].whole() == 2);
  CHECK(points["cells"].whole() == 0);
  CHECK(field_of(points, "q")["mean"].number() == 7);
}

TEST_CASE("measures: what cannot be measured is refused with a sentence") {
  const auto session = test::opened(
      "sightglass: 1\nsteps:\n  head: {sphere: {size: 9}}\n  table: {statistics: , from: head}\nshow:\n  - {outline: , of: head}\n");
  Window window(*session);
  window.next("state");
  const std::string head = ",'step':'head'", among = head + ",'among':";
  const auto says = [&](const std::string& members, const char* what) {
    CAPTURE(members);
    CHECK(refused_measures(window, members).find(what) != std::string::npos);
  };
  says(",'step':'nothing'", "no step 'nothing'");
  says(",'step':'table'", "table has no places");
  says(head + ",'field':'wool'", "no field 'wool'");
  says(among + "{'value':{'field':'wool','range':[0,1]}}", "no field 'wool'");
  says(among + "{'value':{'field':'distance','range':[1,0]}}", "smaller number first");
  says(among + "{'value':{'field':'distance','range':[0]}}", "smaller number first");
  says(among + "{'box':[0,1,2]}", "needs 6 numbers");
  says(among + "{'box':[0,1,0,1,'a',1]}", "not finite");
  says(among + "{'box':[1,0,0,1,0,1]}", "empty along x");
  says(among + "{'box':true}", "six numbers");
  says(among + "7", "no object");
  says(among + "{'view':0,'lasso':[[0,0],[9,0],[9,9]]}", "has no picture");
  test::looked(window, test::along_z);
  says(among + "{'view':99,'lasso':[[0,0],[9,0],[9,9]]}", "views 0 to 3");
  says(among + "{'view':3,'lasso':[[0,0],[9,0],[9,9]]}", "has no picture");
  says(among + "{'view':0,'lasso':[[0,0],[9,0]]}", "2 corners");
  says(among + "{'view':0,'lasso':[[0,0],[9,0],[18,0]]}", "one line");
  says(among + "{'view':0,'lasso':[[0,0],[9,0],['x',0]]}", "no pixel");
  std::string many;
  for (int k = 0; k <= 2000; ++k) many += (k ? ",[" : "[") + std::to_string(k) + "," + std::to_string(k % 7) + "]";
  says(among + "{'view':0,'lasso':[" + many + "]}", "2001 corners");
}
