// SPDX-License-Identifier: Apache-2.0
// First pictures of tensors: glyphs of few ones and of diffusion series, stress as its equivalent.
#include <cmath>

#include "filter/mesh/to_unstructured.h"
#include "scene/look/look.h"
#include "scene/show/surface.h"
#include "support/test.h"

using namespace sg;

namespace {

// n^3 samples with six numbers each, and a scalar where it has a name.
DatasetParts tensors(size_t n, const char* name, const char* scalar) {
  UniformGrid g;
  g.dims = {n, n, n};
  std::vector<double> t, s;
  for (size_t i = 0; i < n * n * n; ++i) {
    for (int k = 0; k < 6; ++k) t.push_back(k < 3 ? 1 + std::sin(0.1 * double(i) + k) : 0.1);
    s.push_back(std::cos(0.2 * double(i)));
  }
  DatasetParts parts;
  parts.mesh = g;
  parts.fields.add({name, Association::point, Array::from_vector(std::move(t), 6), "", Role::tensors});
  if (scalar[0]) parts.fields.add({scalar, Association::point, Array::from_vector(std::move(s)), "", Role::scalars});
  return parts;
}

// One image of a series with a gradient a volume: one without, and six or fewer directions in general position.
DatasetPtr diffusion_image(size_t directions) {
  UniformGrid g;
  g.dims = {4, 4, 4};
  std::vector<float> v;
  for (size_t i = 0; i < 64; ++i) v.push_back(float(100 + i * 7 % 13));
  const double q = std::sqrt(0.5), all[6][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {q, q, 0}, {q, 0, q}, {0, q, q}};
  std::vector<double> b{0}, d{0, 0, 0};
  for (size_t i = 0; i < directions; ++i) b.push_back(1000), d.insert(d.end(), all[i], all[i] + 3);
  DatasetParts parts;
  parts.mesh = g;
  parts.fields.add({"NIFTI", Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  parts.fields.add({"bval", Association::whole, Array::from_vector(std::move(b)), "s/mm^2", Role::none});
  parts.fields.add({"bvec", Association::whole, Array::from_vector(std::move(d), 3), "", Role::none});
  parts.notes = {{"space", "left-posterior-superior"}, {"Modality", "MR"}};
  return make_dataset(std::move(parts));
}

}  // namespace

TEST_CASE("first look: few tensors are glyphs beside scalars, many only where nothing else tells something") {
  const auto filter_of = [](DatasetParts parts) {
    const Look look = choose_look(*make_dataset(std::move(parts)), "", "vtk");
    return look.filter.empty() ? "" : look.filter[0];
  };
  CHECK(filter_of(tensors(3, "t", "s")) == "tensor_glyphs");
  CHECK(filter_of(tensors(6, "t", "s")) == "");
  CHECK(filter_of(tensors(6, "t", "")) == "tensor_glyphs");
  CHECK(filter_of(tensors(12, "t", "")) == "");
  CHECK(choose_look(*make_dataset(tensors(3, "t", "s")), "s", "vtk").filter.empty());  // what is asked for is shown
}

TEST_CASE("first look: stress in a solid is its von Mises stress, unless another scalar tells more") {
  Context context;
  const auto solid = [&](const char* scalar) { return to_unstructured(make_dataset(tensors(12, "Nodal Stress", scalar)), {}, context); };
  for (const char* scalar : {"", "Nodal Stress-xx"}) {
    const Look look = choose_look(*solid(scalar), "", "vtu");
    CHECK(look.filter == std::vector<std::string>{"stress_measures", "field=Nodal Stress"});
    REQUIRE(look.shows.size() == 1);
    CHECK_FALSE(look.shows[0].of_input);
    CHECK(look.shows[0].params.as<SurfaceShow>().coloring.field.name == "von Mises stress");
  }
  CHECK(choose_look(*solid("temperature"), "", "vtu").filter.empty());
}

TEST_CASE("first look: a diffusion series is a glyph for each of its tensors, where its gradients determine them") {
  const Look look = choose_look(*diffusion_image(6), "", "nii", true);
  CHECK(look.source == "gradient_images");
  CHECK(look.prepare == std::vector<std::string>{"tensor_fit"});
  CHECK(look.filter == std::vector<std::string>{"tensor_glyphs"});
  CHECK(choose_look(*diffusion_image(6), "", "nii", false).source.empty());
  CHECK(choose_look(*diffusion_image(6), "NIFTI", "nii", true).source.empty());
  CHECK(choose_look(*diffusion_image(5), "", "nii", true).source.empty());
}
