// SPDX-License-Identifier: Apache-2.0
// Diffusion tensors of real images.
#include <fmt/core.h>

#include "filter/tensor/diffusion/tensor_fit.h"
#include "filter/tensor/lines/tractography.h"
#include "filter/tensor/tensor_measures.h"
#include "filter/tensor/tensor_support.h"
#include "io/io.h"
#include "pipeline/file/gradient_images.h"
#include "pipeline/picture/picture.h"

using namespace sg;
using namespace sg::test;

namespace {

const std::string one = "tensors/dti-one-voxel/", brain = "tensors/dwi-small_64D/small_64D.nii";

DatasetPtr images(const std::string& file) {
  Context context;
  GradientImagesParams p;
  p.path = data_file(file);
  return gradient_images(p, context);
}
Vec3 fsl_vector(const std::string& file) {
  Context context;
  const DatasetPtr d = std::get<DatasetPtr>(read_data(data_file(one + file), {}, context));
  const Array& a = d->fields().require("NIFTI").array;
  return {a.get(0, 0), a.get(0, 1), a.get(0, 2)};
}
double fsl_number(const std::string& file) {
  Context context;
  return std::get<DatasetPtr>(read_data(data_file(one + file), {}, context))->fields().require("NIFTI").array.get(0);
}

}  // namespace

TEST_CASE("one voxel: eigenvalues, eigenvectors, FA, MD, mode and S0 agree with FSL's dtifit" * doctest::skip(no_data())) {
  Listener l;
  const DatasetPtr in = images(one + "voxel_D7.nii.gz");
  CHECK(in->fields().require("images").components() == 7);
  TensorFitParams p;
  p.method = DiffusionFit::linear;
  const DatasetPtr d = tensor_eigen(tensor_measures(tensor_fit(in, p, l.context), {}, l.context), {}, l.context);
  for (int k = 1; k <= 3; ++k) {
    CHECK(value(d, fmt::format("eigenvalue {}", k)) == doctest::Approx(fsl_number(fmt::format("dti_L{}.nii.gz", k))).epsilon(1e-4));
    const Vec3 v = fsl_vector(fmt::format("dti_V{}.nii.gz", k)),
               mine(value(d, fmt::format("eigenvector {}", k), 0, 0), value(d, fmt::format("eigenvector {}", k), 0, 1),
                    value(d, fmt::format("eigenvector {}", k), 0, 2));
    CHECK(std::abs(dot(v, mine)) == doctest::Approx(1).epsilon(1e-4));
  }
  CHECK(value(d, "FA") == doctest::Approx(fsl_number("dti_FA.nii.gz")).epsilon(1e-4));
  CHECK(value(d, "MD") == doctest::Approx(fsl_number("dti_MD.nii.gz")).epsilon(1e-4));
  CHECK(value(d, "mode") == doctest::Approx(fsl_number("dti_MO.nii.gz")).epsilon(1e-3));
  CHECK(value(d, "S0") == doctest::Approx(fsl_number("dti_S0.nii.gz")).epsilon(1e-4));
}

TEST_CASE("gradient_images: the volumes of a series stand side by side" * doctest::skip(no_data())) {
  Context context;
  const DatasetPtr in = images(brain);
  const Array& a = in->fields().require("images").array;
  CHECK(a.components() == 65);
  CHECK(a.count() == 1000);
  CHECK(a.type() == ElementType::i16);
  const Series s = open_series(data_file(brain), {}, context);
  for (size_t step : {size_t(0), size_t(13), size_t(64)}) {
    const Array v = std::get<DatasetPtr>(s.load(step))->fields().require("NIFTI").array;
    for (size_t i = 0; i < 1000; i += 37) CHECK(a.get(i, int(step)) == v.get(i));
  }
  CHECK(error_of([&] { gradient_images({}, context); }).find("path does not name a file") != std::string::npos);
  GradientImagesParams p;
  p.path = data_file(brain), p.field = {"bvec"};
  CHECK(error_of([&] { gradient_images(p, context); }).find("'bvec' has 3 components") != std::string::npos);
}

TEST_CASE("a block of a brain: plausible diffusivities, positive tensors, coherent fibres" * doctest::skip(no_data())) {
  Listener l;
  TensorFitParams p;
  const DatasetPtr in = images(brain), weighted = tensor_fit(in, p, l.context);
  CHECK(l.warnings.find("28 of 1000 tensors have negative eigenvalues") != std::string::npos);
  p.method = DiffusionFit::positive;
  l.warnings.clear();
  const DatasetPtr positive = tensor_fit(in, p, l.context), d = tensor_measures(positive, {}, l.context);
  CHECK(l.warnings.empty());
  const Array &md = d->fields().require("MD").array, &fa = d->fields().require("FA").array;
  double sum = 0, high = 0;
  for (size_t i = 0; i < 1000; ++i) {
    CHECK(md.get(i) > 0);
    CHECK(fa.get(i) <= 1 + 1e-6);
    sum += md.get(i) / 1000, high += fa.get(i) > 0.4 ? 1 : 0;
  }
  CHECK(sum > 0.5e-3);  // white and grey matter and fluid: 0.7 to 3e-3 mm^2/s
  CHECK(sum < 2e-3);
  CHECK(high > 100);
  // Wrong signs of the directions would break fibres: with the right ones they are long.
  auto total_length = [&](const DatasetPtr& t) {
    TractographyParams q;
    const DatasetPtr lines = tractography(t, q, l.context);
    const Array& a = lines->fields().require("line length").array;
    double s = 0;
    for (size_t i = 0; i < a.count(); ++i) s += a.get(i);
    return s;
  };
  DatasetParts mirrored = in->parts();
  Field bvec = in->fields().require("bvec");
  std::vector<double> v;
  for (size_t i = 0; i < bvec.array.count(); ++i) v.insert(v.end(), {-bvec.array.get(i, 0), bvec.array.get(i, 1), bvec.array.get(i, 2)});
  bvec.array = Array::from_vector(std::move(v), 3);
  mirrored.fields.add(bvec);
  const double right = total_length(positive), wrong = total_length(tensor_fit(make_dataset(std::move(mirrored)), p, l.context));
  CHECK(right > 1.05 * wrong);
}

TEST_CASE("pictures: a diffusion series is drawn from all of its volumes, and one volume where a time is stated" *
          doctest::skip(no_data())) {
  const auto drawn = [](const std::string& words) {
    PipelineFile file =
        parse_pipeline("sightglass: 1\nsteps:\n  a: {read: {path: \"" + data_file(brain) + "\"" + words + "}}\npicture: {size: 60x40}\n",
                       "", picture_vocabulary());
    Context context;
    Picture p = make_picture(file, {}, context);
    return std::pair{file, std::move(p.image.pixels)};
  };
  auto [file, pixels] = drawn("");
  std::vector<std::string> operations;
  for (const auto& s : file.steps) operations.push_back(s.operation);
  CHECK(operations == std::vector<std::string>{"gradient_images", "tensor_fit", "tensor_glyphs"});
  Context context;
  CHECK(make_picture(file, {}, context).image.pixels == pixels);  // what was chosen stands in the file
  const auto at_a_time = drawn(", time: 3");
  CHECK(at_a_time.first.steps.at(0).reads());
  CHECK(at_a_time.second != pixels);
}
