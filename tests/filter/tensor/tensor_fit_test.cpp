// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "filter/tensor/diffusion/tensor_fit.h"

#include "base/file/file.h"
#include "filter/tensor/diffusion/diffusion_model.h"
#include "filter/tensor/tensor_support.h"

using namespace sg;
using namespace sg::test;

namespace {

// One volume without gradient and `n` directions spread over the sphere.
GradientTable spread(int n, double b = 1000) {
  GradientTable t;
  t.b.push_back(0), t.g.push_back({0, 0, 0});
  for (int i = 0; i < n; ++i) {
    const double z = 1 - (i + 0.5) / n, a = i * M_PI * (3 - std::sqrt(5.0)), r = std::sqrt(1 - z * z);
    t.b.push_back(b), t.g.push_back({r * std::cos(a), r * std::sin(a), z});
  }
  return t;
}

std::vector<double> signals(const GradientTable& t, const SymTensor& d, double s0, double noise = 0, uint64_t seed = 0) {
  std::vector<double> s;
  for (size_t i = 0; i < t.size(); ++i) s.push_back(s0 * std::exp(-t.b[i] * d.along(t.g[i])) + noise * (random_unit(seed, i) - 0.5));
  return s;
}

// A grid of tensors as a field of images with bval and bvec of the whole.
DatasetPtr image_grid(const UniformGrid& g, const GradientTable& t, const std::vector<SymTensor>& d, double s0) {
  std::vector<double> v, bvec;
  for (const SymTensor& x : d)
    for (double s : signals(t, x, s0)) v.push_back(s);
  for (Vec3 q : t.g) bvec.insert(bvec.end(), {q.x, q.y, q.z});
  FieldSet fields;
  fields.add({"images", Association::point, Array::from_vector(v, int(t.size())), "", Role::scalars});
  fields.add({"bval", Association::whole, Array::from_vector(t.b), "s/mm^2", Role::none});
  fields.add({"bvec", Association::whole, Array::from_vector(bvec, 3), "", Role::none});
  return make_dataset(g, fields);
}

std::string text_file(const std::string& name, const std::string& text) {
  const std::string path = temp_folder() + name;
  write_file(path, text);
  return path;
}

SymTensor tensor_at(const DatasetPtr& d, size_t i) {
  const Array& a = d->fields().require("tensor").array;
  return {a.get(i, 0), a.get(i, 4), a.get(i, 8), a.get(i, 1), a.get(i, 5), a.get(i, 2)};
}

}  // namespace

TEST_CASE("tensor_fit: six directions or more without noise give the tensor and S0 back, by every method") {
  for (int n : {6, 7, 12, 64})
    for (DiffusionFit method : {DiffusionFit::linear, DiffusionFit::weighted, DiffusionFit::positive})
      for (uint64_t seed = 0; seed < 5; ++seed) {
        const GradientTable t = spread(n);
        DiffusionModel model(t);
        const SymTensor d = rotated(diagonal(1.7e-3, 0.4e-3, 0.2e-3), random_rotation(seed));
        const DiffusionResult f = model.fit(signals(t, d, 812.5), method);
        CHECK((f.d - d).max_abs() < 1e-12 * d.max_abs() * 10);
        CHECK(f.s0 == doctest::Approx(812.5).epsilon(1e-12));
        CHECK(f.residual < 1e-9);
        CHECK(!f.raised);
      }
}

TEST_CASE("tensor_fit: two shells need no volume at b = 0; too few or flat directions are named") {
  GradientTable t = spread(6, 1000);
  for (int i = 1; i <= 6; ++i) t.b.push_back(300), t.g.push_back(t.g[size_t(i)]);
  t.b.erase(t.b.begin()), t.g.erase(t.g.begin());
  DiffusionModel model(t);
  const SymTensor d = rotated(diagonal(1e-3, 5e-4, 3e-4), random_rotation(4));
  CHECK((model.fit(signals(t, d, 100), DiffusionFit::linear).d - d).max_abs() < 1e-14);
  auto refused = [](const GradientTable& g) {
    return error_of([&] { DiffusionModel m(g); }).find("do not determine a tensor") != std::string::npos;
  };
  CHECK(refused(spread(5)));
  GradientTable flat = spread(0);
  for (int i = 0; i < 12; ++i) flat.b.push_back(1000), flat.g.push_back({std::cos(i * 0.5), std::sin(i * 0.5), 0});
  CHECK(refused(flat));
  GradientTable one_shell = spread(12);
  one_shell.b.erase(one_shell.b.begin()), one_shell.g.erase(one_shell.g.begin());
  CHECK(refused(one_shell));
  GradientTable zero = spread(6, 0);
  CHECK(error_of([&] { DiffusionModel m(zero); }).find("all b-values are 0") != std::string::npos);
}

TEST_CASE("tensor_fit: with noise, weights come nearer to the truth than plain logarithms, and positive tensors stay positive") {
  const GradientTable t = spread(30, 2000);
  DiffusionModel model(t);
  double plain = 0, weighted = 0;
  size_t raised = 0;
  for (uint64_t i = 0; i < 300; ++i) {
    const SymTensor d = rotated(diagonal(2e-3, 1e-4, 2e-5), random_rotation(i));
    const std::vector<double> s = signals(t, d, 100, 12, i);
    plain += (model.fit(s, DiffusionFit::linear).d - d).norm();
    weighted += (model.fit(s, DiffusionFit::weighted).d - d).norm();
    const DiffusionResult f = model.fit(s, DiffusionFit::positive), w = model.fit(s, DiffusionFit::weighted);
    raised += f.raised;
    CHECK(eigen_of(f.d).value[2] >= -1e-18);
    CHECK((f.d - d).norm() < 1.1 * (w.d - d).norm() + 1e-5);
    if (!f.raised) CHECK(f.d == w.d);
  }
  CHECK(weighted < plain);
  CHECK(raised > 30);
}

TEST_CASE("tensor_fit: signals of zero are left out, NaN and too few useful ones give NaN") {
  const GradientTable t = spread(12);
  DiffusionModel model(t);
  const SymTensor d = rotated(diagonal(1e-3, 5e-4, 3e-4), random_rotation(4));
  std::vector<double> s = signals(t, d, 100);
  s[3] = 0, s[5] = -1;
  CHECK((model.fit(s, DiffusionFit::weighted).d - d).max_abs() < 1e-13);
  s[7] = NAN;
  CHECK(std::isnan(model.fit(s, DiffusionFit::weighted).s0));
  CHECK(std::isnan(model.fit(std::vector<double>(13, 0.0), DiffusionFit::positive).d.xx));
}

TEST_CASE("tensor_fit: a grid of images; frames turn directions into the world, FSL's x included") {
  Context context;
  const GradientTable t = spread(12);
  UniformGrid g;
  g.dims = {3, 2, 2};
  g.direction = random_rotation(9);
  std::vector<SymTensor> d;
  for (uint64_t i = 0; i < 12; ++i) d.push_back(rotated(diagonal(1e-3 * double(i + 1), 5e-4, 3e-4), random_rotation(i)));
  const DatasetPtr in = image_grid(g, t, d, 50);
  Mat3 mirrored = g.direction, mirror;
  mirror.m[0][0] = -1;
  mirrored = g.direction * mirror;
  for (const auto& [frame, turn] :
       {std::pair(GradientFrame::world, Mat3()), std::pair(GradientFrame::voxel, g.direction), std::pair(GradientFrame::fsl, mirrored)}) {
    TensorFitParams p;
    p.frame = frame;
    const DatasetPtr out = tensor_fit(in, p, context);
    for (size_t i = 0; i < 12; ++i) CHECK((tensor_at(out, i) - rotated(d[i], turn)).max_abs() < 1e-14);
    CHECK(out->fields().require("tensor").role == Role::tensors);
    CHECK(out->fields().require("S0").array.get(3) == doctest::Approx(50));
    CHECK(out->fields().find("images") == nullptr);
  }
  // An image that is stored the other way round: no turn.
  UniformGrid left = g;
  left.direction = mirrored;
  TensorFitParams p;
  CHECK((tensor_at(tensor_fit(image_grid(left, t, d, 50), p, context), 1) - rotated(d[1], mirrored)).max_abs() < 1e-14);
}

TEST_CASE("tensor_fit: text files of gradients in rows or columns, images as single fields, masks and faint signals") {
  Listener l;
  const GradientTable t = spread(6, 700);
  const SymTensor d = rotated(diagonal(1e-3, 5e-4, 3e-4), random_rotation(4));
  std::string bvals, rows[3], columns;
  for (size_t i = 0; i < t.size(); ++i) {
    bvals += fmt::format("{} ", t.b[i]);
    for (int c = 0; c < 3; ++c) rows[c] += fmt::format("{} ", t.g[i][c]), columns += fmt::format("{} ", t.g[i][c]);
    columns += "\n";
  }
  UniformGrid g;
  g.dims = {4, 1, 1};
  FieldSet fields;
  TensorFitParams p;
  const std::vector<double> s = signals(t, d, 10);
  for (size_t i = 0; i < t.size(); ++i) {
    fields.add({fmt::format("dwi{}", i), Association::point, Array::from_vector(std::vector<double>{s[i], s[i], 0.1 * s[i], NAN}), "",
                Role::none});
    p.fields.push_back(fmt::format("dwi{}", i));
  }
  fields.add({"brain", Association::point, Array::from_vector(std::vector<uint8_t>{1, 0, 1, 1}), "", Role::labels});
  const DatasetPtr in = make_dataset(g, fields);
  p.frame = GradientFrame::world, p.mask = {"brain"}, p.min_signal = 5;
  p.bvals = text_file("bvals", bvals + "\n");
  for (const std::string& text : {rows[0] + "\n" + rows[1] + "\n" + rows[2] + "\n", columns}) {
    p.bvecs = text_file("bvecs", text);
    const DatasetPtr out = tensor_fit(in, p, l.context);
    CHECK((tensor_at(out, 0) - d).max_abs() < 1e-13);
    for (size_t i = 1; i < 4; ++i) CHECK(std::isnan(tensor_at(out, i).xx));
  }
  CHECK(l.notes.find("3 of 4 places have no tensor") != std::string::npos);

  auto with = [&](auto change) {
    TensorFitParams q = p;
    change(q);
    return error_of([&] { tensor_fit(in, q, l.context); });
  };
  CHECK(with([&](auto& q) { q.bvals = text_file("bad1", "0 1000 x"); }).find("bad1: line 1: 'x' is not a number") != std::string::npos);
  CHECK(with([&](auto& q) { q.bvals = text_file("bad2", "0 1000"); }).find("do not fit 2 b-values") != std::string::npos);
  CHECK(with([&](auto& q) { q.bvals = text_file("bad3", ""); }).find("it contains no numbers") != std::string::npos);
  CHECK(with([&](auto& q) { q.bvecs = text_file("bad4", "1 2 3\n4 5\n"); }).find("line 2 has 2 numbers, the first has 3") !=
        std::string::npos);
  CHECK(with([&](auto& q) { q.bvals = text_file("bad5", "0 1 2 3 -4 5 6"); }).find("b-value 5 is -4") != std::string::npos);
  CHECK(with([&](auto& q) {
          q.bvecs = text_file("bad6", rows[0] + "\n" + rows[1] + "\n" + "0 0 0 0 0 0 nan\n");
        }).find("volume 7 has b = 700 but no direction") != std::string::npos);
  CHECK(with([](auto& q) { q.bvals = ""; }).find("bvals names no file, and the data has no field 'bval'") != std::string::npos);
  CHECK(with([](auto& q) { q.fields.pop_back(); }).find("6 images for 7 b-values") != std::string::npos);
  CHECK(with([](auto& q) { q.fields = {}; }).find("no field has 7 components") != std::string::npos);
  CHECK(with([](auto& q) { q.bvecs = "/nowhere/bvecs"; }).find("/nowhere/bvecs") != std::string::npos);
}

TEST_CASE("tensor_fit: the same bytes for 1 and 8 threads") {
  const GradientTable t = spread(12);
  UniformGrid g;
  g.dims = {20, 20, 5};
  std::vector<SymTensor> d;
  for (uint64_t i = 0; i < 2000; ++i) d.push_back(rotated(diagonal(2e-3, 5e-4, i % 5 ? 3e-4 : -4e-4), random_rotation(i)));
  const DatasetPtr in = image_grid(g, t, d, 50);
  const auto [a, b] = with_threads([&] {
    Listener l;
    TensorFitParams p;
    p.method = DiffusionFit::positive;
    const DatasetPtr r = tensor_fit(in, p, l.context);
    CHECK(l.notes.find("400 of 2000 tensors were not positive") != std::string::npos);
    CHECK(l.warnings.empty());
    return r;
  });
  CHECK(equal_fields(*a, *b));
}
