// SPDX-License-Identifier: Apache-2.0
#include "filter/tensor/diffusion/tensor_fit.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "filter/tensor/diffusion/diffusion_model.h"

namespace sg {

namespace {

// The images: components of one field, or fields of one component.
struct Images {
  std::vector<Array> arrays;  // one component each
  Association association = Association::point;
  std::vector<std::string> names;
  bool wide = false;
  size_t count() const { return arrays[0].count(); }
};

Images images_of(const Dataset& d, const TensorFitParams& p, size_t volumes) {
  Images im;
  if (!p.fields.empty()) {
    for (const std::string& name : p.fields) {
      const Field& f = d.fields().require(name);
      if (f.components() != 1)
        fail_usage(fmt::format("field '{}' has {} components; each image of 'fields' must have one", name, f.components()), "tensor_fit");
      if (!im.arrays.empty() && (f.association != im.association || f.array.count() != im.count()))
        fail_usage(fmt::format("fields '{}' and '{}' are not on the same points or cells", name, p.fields[0]), "tensor_fit",
                   "put all images on the points or all on the cells");
      im.association = f.association;
      im.arrays.push_back(f.array), im.names.push_back(name);
    }
  } else {
    const Field* f = nullptr;
    if (!p.field.empty()) f = &d.fields().require(p.field.name);
    for (const Field& g : d.fields())
      if (!f && g.association != Association::whole && size_t(g.components()) == volumes) f = &g;
    if (!f)
      fail_usage(fmt::format("no field has {} components, one for each b-value", volumes), "tensor_fit",
                 "the source gradient_images path=FILE turns a series of volumes into one field");
    im.association = f->association;
    for (int c = 0; c < f->components(); ++c) im.arrays.push_back(f->array.component(c));
    im.names.push_back(f->name);
  }
  if (im.arrays.size() != volumes) fail_usage(fmt::format("{} images for {} b-values", im.arrays.size(), volumes), "tensor_fit");
  if (im.association == Association::whole) fail_usage("the images belong to the whole dataset, not to points or cells", "tensor_fit");
  for (const Array& a : im.arrays) im.wide |= element_size(a.type()) == 8;
  return im;
}

struct Counts {
  size_t none = 0, negative = 0, raised = 0;
};

struct Outputs {
  Array tensor, s0, residual;
  std::byte *t = nullptr, *s = nullptr, *r = nullptr;
  bool wide;
  Outputs(size_t n, bool w) : wide(w) {
    const ElementType type = wide ? ElementType::f64 : ElementType::f32;
    tensor = Array::make_raw(type, n, 9, &t), s0 = Array::make_raw(type, n, 1, &s), residual = Array::make_raw(type, n, 1, &r);
  }
  void put(std::byte* to, size_t i, double v) const {
    if (wide) reinterpret_cast<double*>(to)[i] = v;
    else reinterpret_cast<float*>(to)[i] = float(v);
  }
  void write(size_t i, const DiffusionResult& f) const {
    const double rows[9] = {f.d.xx, f.d.xy, f.d.xz, f.d.xy, f.d.yy, f.d.yz, f.d.xz, f.d.yz, f.d.zz};
    for (size_t k = 0; k < 9; ++k) put(t, 9 * i + k, rows[k]);
    put(s, i, f.s0), put(r, i, f.residual);
  }
};

// Whether a place is to be fitted.
bool wanted(std::span<const double> signal, const GradientTable& t, const TensorFitParams& p) {
  if (!p.min_signal) return true;
  double sum = 0;
  size_t n = 0;
  for (size_t i = 0; i < signal.size(); ++i)
    if (t.b[i] <= p.b0) sum += signal[i], ++n;
  return n == 0 || sum / double(n) >= *p.min_signal;
}

}  // namespace

void describe(Schema& s, TensorFitParams& p) {
  s("field", p.field, "Field with one component per gradient; default: the first with as many components as there are b-values.");
  s("fields", p.fields, "Alternatively, fields of one component, in the order of the gradients.");
  s("bvals", p.bvals, "Text file of b-values in s/mm^2, one per volume; default: the field 'bval' that comes with a NIfTI file.")
      .unit("file");
  s("bvecs", p.bvecs, "Text file of directions, three rows or three columns; default: the field 'bvec' that comes with a NIfTI file.")
      .unit("file");
  s("frame", p.frame,
    "Frame of the directions. fsl: the image axes, with x flipped if they are right-handed, as in FSL's files; voxel: the image axes; "
    "world: x, y, z of the mesh.");
  s("b0", p.b0, "Volumes without direction and with b up to this value count as unweighted.").at_least(0).unit("s/mm^2");
  s("method", p.method,
    "Least squares of the logarithms: linear; weighted, by the squared signals; positive: weighted, with a Cholesky factor where the "
    "tensor would otherwise have eigenvalues of zero or below.");
  s("mask", p.mask, "Field that is above 0 where tensors are wanted.");
  s("min_signal", p.min_signal, "Make no tensor where the mean unweighted signal is below this.").unit("@field");
  s("name", p.name, "Name of the tensor field.");
}

DatasetPtr tensor_fit(const DatasetPtr& in, const TensorFitParams& p, Context& ctx) {
  GradientTable gradients = read_gradients(*in, p.bvals, p.bvecs, p.b0);
  const Images images = images_of(*in, p, gradients.size());
  turn_to_world(gradients, *in, p.frame);
  const DiffusionModel model(gradients);
  Array mask;
  if (!p.mask.empty()) mask = in->fields().require(p.mask.name, images.association).array;
  const size_t n = images.count(), volumes = gradients.size();
  const Outputs out(n, images.wide);
  const Counts counts = parallel_reduce(
      n, 256, Counts{},
      [&](size_t begin, size_t end) {
        DiffusionModel own = model;
        Counts c;
        std::vector<double> signal(volumes);
        for (size_t i = begin; i < end; ++i) {
          for (size_t v = 0; v < volumes; ++v) signal[v] = images.arrays[v].get(i);
          DiffusionResult f;
          if ((mask.empty() || mask.get(i) > 0) && wanted(signal, gradients, p)) f = own.fit(signal, p.method);
          c.none += std::isnan(f.s0), c.raised += f.raised;
          const Eigen3 e = eigen_of(f.d);
          c.negative += e.value[2] < -1e-9 * std::abs(e.value[0]);
          out.write(i, f);
        }
        return c;
      },
      [](Counts a, Counts b) {
        return Counts{a.none + b.none, a.negative + b.negative, a.raised + b.raised};
      },
      &ctx);
  if (counts.none > 0)
    ctx.info(fmt::format("tensor_fit: {} of {} places have no tensor (mask, min_signal, or signals that are not above 0)", counts.none, n));
  if (counts.raised > 0)
    ctx.info(fmt::format("tensor_fit: {} of {} tensors were not positive and were fitted by a Cholesky factor", counts.raised, n));
  if (counts.negative > 0)
    ctx.warn(fmt::format(
        "tensor_fit: {} of {} tensors have negative eigenvalues, which are impossible for diffusion; method=positive avoids them",
        counts.negative, n));
  DatasetParts parts = in->parts();
  for (const std::string& name : images.names) parts.fields.remove(name, images.association);
  parts.fields.add({p.name, images.association, out.tensor, "mm^2/s", Role::tensors});
  parts.fields.add({"S0", images.association, out.s0, "", Role::none});
  parts.fields.add({"residual", images.association, out.residual, "", Role::none});
  return make_dataset(std::move(parts));
}

}  // namespace sg
