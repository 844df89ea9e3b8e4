// SPDX-License-Identifier: Apache-2.0
#include "filter/tensor/tensor_measures.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "filter/tensor/tensor_shape.h"

namespace sg {

namespace {

// The first of them is the result.
DatasetPtr with_added(const DatasetPtr& in, std::vector<Field> fields) {
  DatasetParts parts = in->parts();
  if (!fields.empty()) fields[0].look.result = true;
  for (Field& f : fields) parts.fields.add(std::move(f));
  return make_dataset(std::move(parts));
}

bool is_negative(const double* l, int dimension) {
  const double least = dimension == 2 ? l[1] : l[2];
  return least < -1e-6 * std::max(std::abs(l[0]), std::abs(least));  // what rounding to f32 leaves of 0
}

void treat_negative(double* l, NegativeEigenvalues how) {
  if (how == NegativeEigenvalues::clip)
    for (int k = 0; k < 3; ++k) l[k] = std::max(l[k], 0.0);
  if (how == NegativeEigenvalues::absolute) {
    for (int k = 0; k < 3; ++k) l[k] = std::abs(l[k]);
    std::sort(l, l + 3, std::greater<>());
  }
  if (how == NegativeEigenvalues::nan) l[0] = l[1] = l[2] = NAN;
}

double measure_2d(TensorMeasure m, const double* l) {
  if (m == TensorMeasure::FA) return fractional_anisotropy_2d(l);
  if (m == TensorMeasure::MD) return (l[0] + l[1]) / 2;
  if (m == TensorMeasure::trace) return l[0] + l[1];
  if (m == TensorMeasure::determinant) return l[0] * l[1];
  return std::hypot(l[0], l[1]);
}

double measure_3d(TensorMeasure m, const double* l, bool by_trace) {
  if (m == TensorMeasure::FA) return fractional_anisotropy(l);
  if (m == TensorMeasure::MD) return mean_of(l);
  if (m == TensorMeasure::RA) return relative_anisotropy(l);
  if (m == TensorMeasure::mode) return tensor_mode(l);
  if (m == TensorMeasure::cl) return westin_of(l, by_trace).linear;
  if (m == TensorMeasure::cp) return westin_of(l, by_trace).planar;
  if (m == TensorMeasure::cs) return westin_of(l, by_trace).spherical;
  if (m == TensorMeasure::trace) return l[0] + l[1] + l[2];
  if (m == TensorMeasure::determinant) return l[0] * l[1] * l[2];
  return norm_of(l);
}

bool is_diffusion(TensorMeasure m) { return m != TensorMeasure::trace && m != TensorMeasure::determinant && m != TensorMeasure::norm; }

std::string unit_of(TensorMeasure m, const std::string& unit) {
  return m == TensorMeasure::MD || m == TensorMeasure::trace || m == TensorMeasure::norm ? unit
         : m == TensorMeasure::determinant && !unit.empty()                              ? "(" + unit + ")^3"
                                                                                         : "";
}

}  // namespace

void describe(Schema& s, TensorEigenParams& p) {
  describe_tensors(s, p.tensors);
  s("vectors", p.vectors, "Eigenvectors to add besides the eigenvalues.");
}

void describe(Schema& s, TensorMeasuresParams& p) {
  describe_tensors(s, p.tensors);
  s("measures", p.measures,
    "FA: fractional anisotropy; MD: mean diffusivity; RA: relative anisotropy (0 to 1.414); mode: 1 line-like, -1 disc-like; cl, cp, cs: "
    "linear, planar, spherical (Westin); trace; determinant; norm.");
  s("westin", p.westin,
    "Normalisation of cl, cp, cs. trace: (l1-l2)/t, 2(l2-l3)/t, 3 l3/t with t = l1+l2+l3; largest: (l1-l2)/l1, (l2-l3)/l1, l3/l1.");
  s("negative", p.negative,
    "Treatment of negative eigenvalues: keep them, clip to 0, take the absolute value, or set the whole tensor to nan.");
}

void describe(Schema& s, DirectionColorsParams& p) {
  describe_tensors(s, p.tensors);
  s("eigenvector", p.eigenvector, "Eigenvector that gives the direction; 1 belongs to the largest eigenvalue.").range(1, 3);
  s("weight", p.weight, "What the brightness shows: FA, the linear measure cl, or nothing.");
  s("gamma", p.gamma, "The brightness is raised to the power 1/gamma: larger is brighter.").positive();
}

void warn_negative(size_t count, size_t all, const TensorField& t, std::string_view who, std::string_view what_happens, Context& ctx) {
  if (count > 0)
    ctx.warn(fmt::format("{}: {} of {} tensors of '{}' have negative eigenvalues, which are impossible for diffusion; {}", who, count, all,
                         t.field.name, what_happens));
}

DatasetPtr tensor_eigen(const DatasetPtr& in, const TensorEigenParams& p, Context& ctx) {
  const TensorField t = read_tensors(*in, p.tensors, "tensor_eigen", ctx);
  const int n = t.dimension, vectors = p.vectors == EigenvectorsKept::all ? n : p.vectors == EigenvectorsKept::first ? 1 : 0;
  std::vector<Array> arrays;
  std::vector<Field> fields;
  // One decomposition a tensor: all results of a tuple side by side, then seen as fields of their own.
  const Field all = [&] {
    const int width = n + 3 * vectors;
    std::byte* out = nullptr;
    const bool wide = t.result_type() == ElementType::f64;
    Array a = Array::make_raw(t.result_type(), t.d.size(), width, &out);
    parallel_for(
        t.d.size(), 2048,
        [&](size_t begin, size_t end) {
          for (size_t i = begin; i < end; ++i) {
            const Eigen3 e = t.eigen(i);
            for (int c = 0; c < width; ++c) {
              const double v = c < n ? e.value[c] : e.vector[(c - n) / 3][(c - n) % 3];
              const size_t at = i * size_t(width) + size_t(c);
              if (wide) reinterpret_cast<double*>(out)[at] = v;
              else reinterpret_cast<float*>(out)[at] = float(v);
            }
          }
        },
        &ctx);
    return Field{"", t.field.association, a, t.field.unit, Role::none};
  }();
  const ptrdiff_t size = ptrdiff_t(element_size(all.array.type())), stride = all.array.stride_bytes();
  auto part = [&](int first, int components) {
    return Array(all.array.buffer(), all.array.type(), t.d.size(), components, size_t(first * size), stride, size);
  };
  for (int k = 0; k < n; ++k)
    fields.push_back({fmt::format("eigenvalue {}", k + 1), t.field.association, part(k, 1), t.field.unit, Role::none});
  for (int k = 0; k < vectors; ++k)
    fields.push_back({fmt::format("eigenvector {}", k + 1), t.field.association, part(n + 3 * k, 3), "", Role::none});
  return with_added(in, std::move(fields));
}

DatasetPtr tensor_measures(const DatasetPtr& in, const TensorMeasuresParams& p, Context& ctx) {
  const TensorField t = read_tensors(*in, p.tensors, "tensor_measures", ctx);
  if (p.measures.empty())
    fail_usage("measures is empty", "tensor_measures", "give some of FA, MD, RA, mode, cl, cp, cs, trace, determinant, norm");
  const bool by_trace = p.westin == WestinNorm::trace;
  bool diffusion = false;
  for (const TensorMeasure m : p.measures) {
    diffusion |= is_diffusion(m);
    if (t.dimension == 2 &&
        (m == TensorMeasure::RA || m == TensorMeasure::mode || m == TensorMeasure::cl || m == TensorMeasure::cp || m == TensorMeasure::cs))
      fail_usage(fmt::format("'{}' is not defined for the 2D tensors of '{}'", word_of(m), t.field.name), "tensor_measures",
                 "in 2D: FA, MD, trace, determinant, norm");
  }
  std::vector<Eigen3> eigen(t.d.size());
  const size_t negative = parallel_reduce(
      t.d.size(), 2048, size_t(0),
      [&](size_t begin, size_t end) {
        size_t n = 0;
        for (size_t i = begin; i < end; ++i) {
          eigen[i] = t.eigen(i);
          if (!diffusion || !is_negative(eigen[i].value, t.dimension)) continue;
          ++n;
          treat_negative(eigen[i].value, p.negative);
        }
        return n;
      },
      [](size_t a, size_t b) { return a + b; }, &ctx);
  warn_negative(negative, t.d.size(), t, "tensor_measures",
                p.negative == NegativeEigenvalues::keep ? "they are kept (FA may exceed 1); negative=clip, absolute or nan handles them"
                                                        : fmt::format("negative={}", word_of(p.negative)),
                ctx);
  std::vector<Field> fields;
  for (const TensorMeasure m : p.measures)
    fields.push_back(field_beside(t, std::string(word_of(m)), 1, unit_of(m, t.field.unit), Role::none, ctx, [&](size_t i, double* v) {
      *v = t.dimension == 2 ? measure_2d(m, eigen[i].value) : measure_3d(m, eigen[i].value, by_trace);
    }));
  return with_added(in, std::move(fields));
}

void direction_color(Vec3 v, double weight, uint8_t* rgb) {
  for (int c = 0; c < 3; ++c) {
    const double x = std::abs(v[c]) * weight;
    rgb[c] = uint8_t(x > 0 ? std::min(255.0, std::round(255 * x)) : 0);  // NaN is black
  }
}

DatasetPtr direction_colors(const DatasetPtr& in, const DirectionColorsParams& p, Context& ctx) {
  const TensorField t = read_tensors(*in, p.tensors, "direction_colors", ctx);
  if (p.eigenvector > t.dimension) fail_usage("a 2D tensor has two eigenvectors", "direction_colors", "choose eigenvector 1 or 2");
  uint8_t* out = nullptr;
  Array a = Array::make<uint8_t>(t.d.size(), 3, &out);
  parallel_for(
      t.d.size(), 2048,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          const Eigen3 e = t.eigen(i);
          double w = 1;
          if (p.weight == ColorWeight::FA) w = t.dimension == 2 ? fractional_anisotropy_2d(e.value) : fractional_anisotropy(e.value);
          if (p.weight == ColorWeight::cl) w = t.dimension == 2 ? (e.value[0] - e.value[1]) / e.value[0] : westin_of(e.value, true).linear;
          direction_color(e.vector[p.eigenvector - 1], std::pow(std::clamp(w, 0.0, 1.0), 1 / p.gamma), out + 3 * i);
        }
      },
      &ctx);
  return with_added(in, {{"direction", t.field.association, a, "", Role::colors}});
}

}  // namespace sg
