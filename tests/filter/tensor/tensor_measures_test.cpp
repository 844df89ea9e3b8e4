// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "filter/tensor/tensor_measures.h"

#include "filter/tensor/stress_measures.h"
#include "filter/tensor/tensor_support.h"

using namespace sg;
using namespace sg::test;

namespace {

TensorMeasuresParams all_measures() {
  TensorMeasuresParams p;
  p.measures.clear();
  for (const auto& w : enum_words(TensorMeasure())) p.measures.push_back(w.value);
  return p;
}

}  // namespace

TEST_CASE("tensor_measures: the published values of (1.7,.3,.3) and (1,.6,.2), in any orientation") {
  Context context;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const Mat3 r = random_rotation(seed);
    const DatasetPtr in = tensor_points({rotated(diagonal(1.7, .3, .3), r), rotated(diagonal(1, .6, .2), r)});
    const DatasetPtr d = tensor_measures(in, all_measures(), context);
    CHECK(value(d, "FA") == doctest::Approx(.799022).epsilon(1e-6));
    CHECK(value(d, "MD") == doctest::Approx(.766667).epsilon(1e-6));
    CHECK(value(d, "mode") == doctest::Approx(1).epsilon(1e-12));
    CHECK(value(d, "cl") == doctest::Approx(.608696).epsilon(1e-6));
    CHECK(std::abs(value(d, "cp")) < 1e-14);
    CHECK(value(d, "cs") == doctest::Approx(.391304).epsilon(1e-6));
    CHECK(value(d, "RA") == doctest::Approx(std::sqrt(1.3066666666666666 / 3) / .7666666666666666).epsilon(1e-12));
    CHECK(value(d, "FA", 1) == doctest::Approx(.585540).epsilon(1e-6));
    CHECK(std::abs(value(d, "mode", 1)) < 1e-12);
    CHECK(value(d, "trace", 1) == doctest::Approx(1.8));
    CHECK(value(d, "determinant", 1) == doctest::Approx(.12));
    CHECK(value(d, "norm", 1) == doctest::Approx(std::sqrt(1.4)));
  }
}

TEST_CASE("tensor_measures: line, disc and ball have the extreme values; both of Westin's normalisations sum to 1") {
  Context context;
  TensorMeasuresParams p = all_measures();
  const DatasetPtr in = tensor_points({diagonal(2, 0, 0), diagonal(2, 2, 0), diagonal(2, 2, 2), SymTensor{}, diagonal(3, 2, 1)});
  const DatasetPtr d = tensor_measures(in, p, context);
  CHECK(value(d, "FA", 0) == doctest::Approx(1));
  CHECK(value(d, "FA", 1) == doctest::Approx(std::sqrt(0.5)));
  CHECK(value(d, "FA", 2) == 0);
  CHECK(value(d, "FA", 3) == 0);
  CHECK(value(d, "RA", 0) == doctest::Approx(std::sqrt(2.0)));
  CHECK(value(d, "mode", 0) == doctest::Approx(1));
  CHECK(value(d, "mode", 1) == doctest::Approx(-1));
  CHECK(std::isnan(value(d, "mode", 2)));
  CHECK(value(d, "cl", 0) == 1);
  CHECK(value(d, "cp", 1) == 1);
  CHECK(value(d, "cs", 2) == 1);
  p.westin = WestinNorm::largest;
  const DatasetPtr l = tensor_measures(in, p, context);
  CHECK(value(l, "cl", 4) == doctest::Approx(1.0 / 3));
  CHECK(value(l, "cp", 4) == doctest::Approx(1.0 / 3));
  CHECK(value(d, "cp", 4) == doctest::Approx(2.0 / 6));
  for (const DatasetPtr& x : {d, l}) CHECK(value(x, "cl", 4) + value(x, "cp", 4) + value(x, "cs", 4) == doctest::Approx(1));
}

TEST_CASE("tensor_measures: negative eigenvalues are counted once and treated as asked") {
  const DatasetPtr in = tensor_points({diagonal(1, .5, -.2), diagonal(1, .5, .2), diagonal(1, -.5, -.6)});
  TensorMeasuresParams p;
  p.measures = {TensorMeasure::FA, TensorMeasure::MD};
  for (const auto& how : enum_words(NegativeEigenvalues())) {
    Listener l;
    p.negative = how.value;
    const DatasetPtr d = tensor_measures(in, p, l.context);
    CHECK(l.warnings.find("2 of 3 tensors of 'tensor' have negative eigenvalues") != std::string::npos);
    CHECK(std::count(l.warnings.begin(), l.warnings.end(), '\n') == 1);
    const double md = value(d, "MD");
    if (p.negative == NegativeEigenvalues::keep) CHECK(md == doctest::Approx(1.3 / 3));
    if (p.negative == NegativeEigenvalues::clip) CHECK(md == doctest::Approx(.5));
    if (p.negative == NegativeEigenvalues::absolute) CHECK(md == doctest::Approx(1.7 / 3));
    if (p.negative == NegativeEigenvalues::nan) CHECK(std::isnan(md));
    CHECK(value(d, "MD", 1) == doctest::Approx(1.7 / 3));
    if (p.negative == NegativeEigenvalues::clip) CHECK(value(d, "FA", 2) == doctest::Approx(1));
  }
  Listener l;
  p.measures = {TensorMeasure::trace};
  tensor_measures(in, p, l.context);
  CHECK(l.warnings.empty());  // a trace may well be negative
}

TEST_CASE("tensor fields: every order of components gives the same tensor") {
  Context context;
  const double want[3] = {4.5, 2.25, -1};
  const SymTensor t = rotated(diagonal(want[0], want[1], want[2]), random_rotation(5));
  const std::pair<const char*, std::vector<double>> stored[] = {
      {"rows", {t.xx, t.xy, t.xz, t.xy, t.yy, t.yz, t.xz, t.yz, t.zz}},
      {"vtk", {t.xx, t.yy, t.zz, t.xy, t.yz, t.xz}},
      {"upper", {t.xx, t.xy, t.xz, t.yy, t.yz, t.zz}},
      {"lower", {t.xx, t.xy, t.yy, t.xz, t.yz, t.zz}},
      {"voigt", {t.xx, t.yy, t.zz, t.yz, t.xz, t.xy}},
      {"abaqus", {t.xx, t.yy, t.zz, t.xy, t.xz, t.yz}},
      {"masked", {1, t.xx, t.xy, t.xz, t.yy, t.yz, t.zz}},
      {"auto", {t.xx, t.yy, t.zz, t.xy, t.yz, t.xz}},
  };
  for (const auto& [order, v] : stored) {
    INFO(std::string(order));
    PointCloud cloud;
    cloud.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0}, 3);
    FieldSet fields;
    fields.add({"s", Association::point, Array::from_vector(v, int(v.size())), "Pa", Role::none});
    TensorEigenParams p;
    p.tensors.order = value_of_word<TensorOrder>(order);
    const DatasetPtr d = tensor_eigen(make_dataset(cloud, fields), p, context);
    for (int k = 0; k < 3; ++k) {
      CHECK(value(d, fmt::format("eigenvalue {}", k + 1)) == doctest::Approx(want[k]).epsilon(1e-12));
      const Field& e = d->fields().require(fmt::format("eigenvector {}", k + 1));
      const Vec3 x(e.array.get(0, 0), e.array.get(0, 1), e.array.get(0, 2));
      CHECK(length(t * x - x * want[k]) < 1e-12);
    }
    CHECK(d->fields().require("eigenvalue 1").unit == "Pa");
  }
}

TEST_CASE("tensor fields: 2D tensors have two eigenvalues in the plane, a mask hides, asymmetric ones are told once") {
  Listener l;
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0, 1, 0, 0}, 3);
  FieldSet fields;
  fields.add({"flat", Association::point, Array::from_vector(std::vector<double>{2, 1, 1, 2, 3, 0, 0, 1}, 4), "", Role::none});
  fields.add({"skew", Association::point, Array::from_vector(std::vector<double>{1, 2, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 0, 2, 0, 0, 0, 3}, 9),
              "", Role::none});
  fields.add(
      {"masked", Association::point, Array::from_vector(std::vector<double>{0, 1, 0, 0, 1, 0, 1, 1, 1, 0, 0, 2, 0, 3}, 7), "", Role::none});
  const DatasetPtr in = make_dataset(cloud, fields);
  TensorEigenParams p;
  p.tensors.field = {"flat"};
  DatasetPtr d = tensor_eigen(in, p, l.context);
  CHECK(value(d, "eigenvalue 1") == doctest::Approx(3));
  CHECK(value(d, "eigenvalue 2") == doctest::Approx(1));
  CHECK(d->fields().find("eigenvalue 3") == nullptr);
  TensorMeasuresParams m;
  m.tensors.field = {"flat"}, m.measures = {TensorMeasure::FA, TensorMeasure::MD};
  CHECK(value(tensor_measures(in, m, l.context), "FA") == doctest::Approx(2 / std::sqrt(10.0)));
  CHECK(l.warnings.empty());
  p.tensors.field = {"masked"};
  d = tensor_eigen(in, p, l.context);
  CHECK(std::isnan(value(d, "eigenvalue 1", 0)));
  CHECK(value(d, "eigenvalue 1", 1) == doctest::Approx(3));
  p.tensors.field = {};  // 9 components come first
  d = tensor_eigen(in, p, l.context);
  CHECK(value(d, "eigenvalue 1", 0) == doctest::Approx(2));  // xy = (2 + 0) / 2
  CHECK(l.warnings == "tensor_eigen: 1 of 2 tensors of 'skew' are not symmetric: each is replaced by the mean with its transpose\n");
}

TEST_CASE("tensor operations name what is wrong with their input") {
  Context context;
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0}, 3);
  FieldSet fields;
  fields.add({"v", Association::point, Array::from_vector(std::vector<double>{1, 2, 3}, 3), "", Role::vectors});
  fields.add({"five", Association::point, Array::from_vector(std::vector<double>{1, 2, 3, 4, 5}, 5), "", Role::none});
  fields.add({"w", Association::whole, Array::from_vector(std::vector<double>{1, 2, 3, 1, 2, 3, 1, 2, 3}, 9), "", Role::none});
  const DatasetPtr in = make_dataset(cloud, fields);
  CHECK(error_of([&] { tensor_eigen(in, {}, context); }) ==
        "tensor_eigen: there is no tensor field; tensors have 9, 7, 6 or 4 components; fields: v (3), five (5), w (9)");
  TensorEigenParams p;
  p.tensors.field = {"five"};
  CHECK(error_of([&] { tensor_eigen(in, p, context); }).find("'five' has 5 components, which is not a tensor") != std::string::npos);
  p.tensors.field = {"fife"};
  CHECK(error_of([&] { tensor_eigen(in, p, context); }).find("did you mean 'five'") != std::string::npos);
  p.tensors.field = {"w"};
  CHECK(error_of([&] { tensor_eigen(in, p, context); }).find("belongs to the whole") != std::string::npos);
  p.tensors.field = {"v"}, p.tensors.order = TensorOrder::voigt;
  CHECK(error_of([&] { tensor_eigen(in, p, context); }).find("which does not fit the order 'voigt'") != std::string::npos);
  TensorMeasuresParams m;
  m.tensors.field = {"v"};  // as xx yy xy
  CHECK(error_of([&] { tensor_measures(in, m, context); }).find("'RA' is not defined for the 2D tensors") != std::string::npos);
  m.measures = {};
  CHECK(error_of([&] { tensor_measures(in, m, context); }).find("measures is empty") != std::string::npos);
  DirectionColorsParams c;
  c.tensors.field = {"v"}, c.eigenvector = 3;
  CHECK(error_of([&] { direction_colors(in, c, context); }).find("a 2D tensor has two eigenvectors") != std::string::npos);
  const DatasetPtr t = tensor_points({diagonal(1, 2, 3)});
  CHECK(error_of([&] { traction(t, {}, context); }).find("a points mesh has no normals; slice it first") != std::string::npos);
  TractionParams zero;
  zero.normal = Vec3(0, 0, 0);
  CHECK(error_of([&] { traction(t, zero, context); }).find("the normal is zero or not finite") != std::string::npos);
}

TEST_CASE("direction_colors: axes are red, green and blue, dark where nothing is preferred") {
  Context context;
  const DatasetPtr in = tensor_points({diagonal(1, 0, 0), diagonal(0, 1, 0), diagonal(0, 0, 1), diagonal(1, 1, 1), diagonal(NAN, 0, 0)});
  const DatasetPtr d = direction_colors(in, {}, context);
  const Array& a = d->fields().require("direction").array;
  CHECK(d->fields().require("direction").role == Role::colors);
  for (size_t i = 0; i < 3; ++i)
    for (int c = 0; c < 3; ++c) CHECK(a.get(i, c) == (int(i) == c ? 255 : 0));
  for (int c = 0; c < 3; ++c) CHECK(a.get(3, c) + a.get(4, c) == 0);
}

TEST_CASE("stress_measures: tension, shear and pressure have their textbook values") {
  Context context;
  StressMeasuresParams p;
  p.measures.clear();
  for (const auto& w : enum_words(StressMeasure())) p.measures.push_back(w.value);
  for (uint64_t seed = 0; seed < 10; ++seed) {
    const Mat3 r = random_rotation(seed);
    const SymTensor shear{0, 0, 0, 5, 0, 0};
    const DatasetPtr d =
        stress_measures(tensor_points({rotated(diagonal(7, 0, 0), r), rotated(shear, r), diagonal(-4, -4, -4)}), p, context);
    CHECK(value(d, "von Mises stress", 0) == doctest::Approx(7));
    CHECK(value(d, "von Mises stress", 1) == doctest::Approx(5 * std::sqrt(3.0)));
    CHECK(value(d, "von Mises stress", 2) == 0);
    CHECK(value(d, "Tresca stress", 1) == doctest::Approx(10));
    CHECK(value(d, "maximum shear stress", 1) == doctest::Approx(5));
    CHECK(value(d, "mean stress", 2) == doctest::Approx(-4));
    CHECK(value(d, "principal stress 1", 1) == doctest::Approx(5));
    CHECK(value(d, "principal stress 3", 1) == doctest::Approx(-5));
    CHECK(std::abs(dot(Vec3(value(d, "principal direction 1", 0, 0), value(d, "principal direction 1", 0, 1),
                            value(d, "principal direction 1", 0, 2)),
                       r.column(0))) == doctest::Approx(1));
  }
}

TEST_CASE("tensor_measures and stress_measures: every mesh kind, point and cell fields") {
  Context context;
  auto f = [](Vec3 p) { return rotated(diagonal(3 + p.x, 2, 1 - 0.2 * p.z), random_rotation(3)); };
  auto check = [&](const DatasetPtr& d) {
    const DatasetPtr m = tensor_measures(d, {}, context);
    CHECK(m->kind() == d->kind());
    const Field& fa = m->fields().require("FA");
    const Field& t = d->fields().require("tensor");
    REQUIRE(fa.array.count() == t.array.count());
    CHECK(fa.association == t.association);
    for (size_t i = 0; i < fa.array.count(); ++i) {
      const SymTensor s{t.array.get(i, 0), t.array.get(i, 4), t.array.get(i, 8), t.array.get(i, 1), t.array.get(i, 5), t.array.get(i, 2)};
      CHECK(fa.array.get(i) == doctest::Approx(std::sqrt(1.5) * s.deviator().norm() / s.norm()).epsilon(1e-10));
    }
    CHECK(stress_measures(d, {}, context)->fields().require("mean stress").array.count() == t.array.count());
  };
  for (const std::string& kind : solid_kinds()) {
    const DatasetPtr d = solid_mesh(
        kind, 2, 1, [](Vec3) { return 0.0; }, 0.1);
    check(with_tensors(d, f, places(d->as<UnstructuredMesh>()->points.xyz)));
  }
  check(tensor_grid({4, 3, 2}, {0, 0, 0}, {1, 1, 1}, f));
  AmrGrid amr;
  amr.levels.push_back({{1, 1, 1}, {1, 1, 1}, {{{0, 0, 0}, {1, 1, 1}, 0, 0}}});
  std::vector<SymTensor> cells;
  for (int i = 0; i < 8; ++i) cells.push_back(f({double(i), 0, 0}));
  FieldSet fields;
  fields.add(tensor_field(cells, Association::cell));
  check(make_dataset(amr, fields));
}

TEST_CASE("tensor operations: the same bytes for 1 and 8 threads") {
  const DatasetPtr in = tensor_grid({31, 17, 19}, {-1, -1, 0.1}, {1, 1, 2}, [](Vec3 x) {
    return rotated(diagonal(2 + x.x, 1, std::sin(3 * x.y) - x.z), random_rotation(uint64_t(100 * x.z)));
  });
  const auto [a, b] = with_threads([&] {
    Context c;
    return direction_colors(stress_measures(tensor_measures(tensor_eigen(in, {}, c), {}, c), {}, c), {}, c);
  });
  CHECK(equal_fields(*a, *b));
}
