// SPDX-License-Identifier: Apache-2.0
#include "filter/field/calc/calc.h"

#include <cstring>

#include "base/parallel.h"
#include "filter/field/calc/units.h"
#include "support/test.h"

using namespace sg;

namespace {

// Four points on a line x = 0, 2, 4, 6 with T = 1..4 K, velocity (i, 2, 0) m/s, rho (cells) 3 cells.
DatasetPtr line_of_four() {
  UniformGrid g;
  g.dims = {4, 1, 1};
  g.spacing = {2, 1, 1};
  FieldSet f;
  f.add({"T", Association::point, Array::from_vector(std::vector<float>{1, 2, 3, 4}), "K", Role::scalars});
  f.add({"velocity", Association::point, Array::from_vector(std::vector<float>{0, 2, 0, 1, 2, 0, 2, 2, 0, 3, 2, 0}, 3), "m/s",
         Role::vectors});
  f.add({"rho", Association::cell, Array::from_vector(std::vector<double>{10, 20, 30}), "kg/m^3", Role::scalars});
  f.add({"two words", Association::point, Array::from_vector(std::vector<int32_t>{5, 6, 7, 8}), "", Role::none});
  f.add({"grad", Association::point, Array::from_vector(std::vector<double>(36, 2.0), 9), "", Role::tensors});
  return make_dataset(g, std::move(f));
}

double value(const std::string& expr, size_t i = 1, int c = 0, std::optional<CalcPlace> on = {}) {
  Context ctx;
  return calc(line_of_four(), {expr, "r", on}, ctx)->fields().require("r").array.get(i, c);
}
std::string error_of_calc(const std::string& expr) {
  return test::error_of([&] { value(expr); });
}
const Field result(const std::string& expr) {
  Context ctx;
  return calc(line_of_four(), {expr, "r", {}}, ctx)->fields().require("r");
}

}  // namespace

TEST_CASE("calc: arithmetic has the usual precedence") {
  CHECK(value("1+2*3^2") == 19);
  CHECK(value("-2^2") == -4);
  CHECK(value("2^-1") == 0.5);
  CHECK(value("2^3^2") == 512);
  CHECK(value("(1+2)*3 - 4/8") == 8.5);
  CHECK(value("7 % 3 - mod(-1, 3)") == -1);
  CHECK(value("1 < 2 && 3 >= 4 || !0") == 1);
  CHECK(value("T == 2 ? 10 : 20") == 10);
  CHECK(value("if(T > 2, 10, 20)") == 20);
  CHECK(value("1.5e2 + .5") == 150.5);
  CHECK(value("2*pi") == doctest::Approx(6.283185307179586).epsilon(1e-15));
}

TEST_CASE("calc: functions of numbers and vectors") {
  CHECK(value("sqrt(T*8)") == 4);
  CHECK(value("mag(velocity)") == doctest::Approx(std::sqrt(5.0)).epsilon(1e-7));
  CHECK(value("velocity.x + velocity[1]") == 3);
  CHECK(value("dot(velocity, vec(1,1,1))") == 3);
  CHECK(value("cross(vec(1,0,0), vec(0,1,0))", 0, 2) == 1);
  CHECK(value("2*velocity", 3, 0) == 6);
  CHECK(value("velocity / 2", 3, 1) == 1);
  CHECK(value("mag(norm(velocity))", 0) == 1);
  CHECK(value("norm(vec(0,0,0)).x") == 0);
  CHECK(value("trace(grad)") == 6);
  CHECK(value("det(grad)") == 0);
  CHECK(value("clamp(T, 1.5, 2.5)", 0) == 1.5);
  CHECK(value("max(T, 3)", 3) == 4);
  CHECK(value("hypot(3,4)") == 5);
  CHECK(value("isnan(nan) + isnan(1)") == 1);
  CHECK(value("atan2(1,1)*4") == doctest::Approx(3.141592653589793).epsilon(1e-14));
  CHECK(value("\"two words\" + `two words`") == 12);
}

TEST_CASE("calc: coordinates of points and of cell centres") {
  CHECK(value("x", 3) == 6);
  CHECK(value("position", 2, 0) == 4);
  CHECK(value("rho * x", 1) == 20 * 3);  // the middle of the second cell
  CHECK(value("x", 0, 0, CalcPlace::cell) == 1);
}

TEST_CASE("calc: f32 in gives f32 out, f64 stays, integers of 32 bits become f64") {
  CHECK(result("T+1").array.type() == ElementType::f32);
  CHECK(result("rho").array.type() == ElementType::f64);
  CHECK(result("\"two words\"").array.type() == ElementType::f64);
  CHECK(result("x").array.type() == ElementType::f64);
  CHECK(result("velocity").components() == 3);
  CHECK(result("rho").association == Association::cell);
  CHECK(result("T").array.get(2) == 3);
}

TEST_CASE("calc: units go through products, powers and roots; unequal sums lose theirs") {
  CHECK(result("mag(velocity)").unit == "m/s");
  CHECK(result("T*velocity").unit == "K m/s");
  CHECK(result("velocity.x^2").unit == "m^2/s^2");
  CHECK(result("sqrt(velocity.x^2)").unit == "m/s");
  CHECK(result("T/T").unit == "");
  CHECK(result("T+1").unit == "K");
  CHECK(result("1/T").unit == "1/K");
  CHECK(result("exp(T)").unit == "");
  Context ctx;
  std::string said;
  ctx.on_log = [&](LogLevel, std::string_view t) { said = t; };
  CHECK(calc(line_of_four(), {"T + velocity.x", "r", {}}, ctx)->fields().require("r").unit == "");
  CHECK(said.find("'K' and 'm/s'") != std::string::npos);
}

TEST_CASE("units: notations of one unit are equal, unreadable ones stay a symbol") {
  CHECK(*Unit::parse("kg m-3") == *Unit::parse("kg/m^3"));
  CHECK(*Unit::parse("m s^-1") == *Unit::parse("m/s"));
  CHECK(*Unit::parse("1/s") == *Unit::parse("s-1"));
  CHECK(Unit::parse("1/s")->text() == "1/s");
  CHECK_FALSE(Unit::parse("10 m"));
  CHECK(Unit::of("days since 1990-01-01").to_power(2).text() == "days since 1990-01-01^2");
  CHECK(Unit::parse("m")->times(*Unit::parse("1/m")).none());
}

TEST_CASE("calc: mistakes say where and what would be right") {
  CHECK(error_of_calc("T +").find("ends too early") != std::string::npos);
  CHECK(error_of_calc("T + velocit").find("did you mean 'velocity'") != std::string::npos);
  CHECK(error_of_calc("sqr(T)").find("did you mean 'sqrt'") != std::string::npos);
  CHECK(error_of_calc("(T").find("a ')' is missing") != std::string::npos);
  CHECK(error_of_calc("T T").find("character 3") != std::string::npos);
  CHECK(error_of_calc("velocity + grad").find("combines 3 numbers with 9") != std::string::npos);
  CHECK(error_of_calc("velocity[3]").find("component 3 of 3") != std::string::npos);
  CHECK(error_of_calc("sqrt(T, 2)").find("takes 1 argument, not 2") != std::string::npos);
  CHECK(error_of_calc("T * rho").find("cell_to_point") != std::string::npos);
  CHECK(error_of_calc("").find("the expression is empty") != std::string::npos);
  CHECK(error_of_calc(std::string(5000, '(')).find("nested too deeply") != std::string::npos);
  CHECK(error_of_calc(std::string(5000, '-') + "1").find("nested too deeply") != std::string::npos);
  std::string many = "T";
  for (int i = 0; i < 3000; ++i) many += "+T";
  CHECK(error_of_calc(many).find("more than 2000 terms") != std::string::npos);
}

TEST_CASE("calc: NaN goes through, and any number of threads gives the same bytes") {
  UniformGrid g;
  g.dims = {20001, 1, 1};
  std::vector<float> v(20001);
  for (size_t i = 0; i < v.size(); ++i) v[i] = i % 7 ? float(i) * 0.37f : NAN;
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector(v), "", Role::scalars});
  const DatasetPtr d = make_dataset(g, std::move(f));
  Context ctx;
  std::vector<DatasetPtr> r;
  for (const int threads : {1, 8}) {
    set_thread_count(threads);
    r.push_back(calc(d, {"sin(v)*x + v^3", "r", {}}, ctx));
  }
  set_thread_count(0);
  const Array &a = r[0]->fields().require("r").array, &b = r[1]->fields().require("r").array;
  CHECK(std::memcmp(a.raw(), b.raw(), a.bytes()) == 0);
  CHECK(std::isnan(a.get(7)));
  CHECK(a.get(8) == doctest::Approx(std::sin(double(v[8])) * 8 + std::pow(double(v[8]), 3)).epsilon(1e-6));
}
