// SPDX-License-Identifier: Apache-2.0
#include "filter/segment/classify.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/text/text.h"
#include "data/fields/known_looks.h"
#include "filter/segment/otsu.h"
#include "filter/segment/samples.h"
#include "filter/segment/tissue_model.h"

namespace sg {

void describe(Schema& s, ClassifyParams& p) {
  s("field", p.field, "Field of intensities; default: the active scalar.").takes(fields::scalars);
  s("mask", p.mask, "Classify only samples where this field is not zero; default: all.").takes(fields::scalars);
  s("classes", p.classes, "Number of tissues.").range(1, 16);
  s("background", p.background, "Add one class, darker than all tissues, for the background.");
  s("partial_volume", p.partial_volume, "Allow samples that mix two classes adjacent in intensity.");
  s("bias_degree", p.bias_degree, "Total degree of the polynomial for the logarithm of the bias; 0: no bias.").range(0, 8);
  s("smoothness", p.smoothness, "Weight of neighbours of the same class (Potts model); 0: none.").range(0, 10);
  s("iterations", p.iterations, "Maximum number of iterations.").range(1, 10000);
  s("tolerance", p.tolerance, "Increase of the mean log-likelihood below which iteration stops.").positive();
}

namespace {

// Everything about the image that both passes use.
struct Volume {
  SampleImage image;
  std::vector<uint8_t> inside;              // classified?
  std::array<std::vector<double>, 3> unit;  // places scaled to [-1,1]
};

Volume open_volume(const Dataset& in, const ClassifyParams& p, const Context& context) {
  Volume v{sample_image(in, p.field, "classify"), {}, {}};
  const SampleImage& image = v.image;
  const size_t n = image.count();
  v.inside.resize(n);
  std::optional<Field> mask;
  if (!p.mask.empty()) mask = companion_field(in, image, p.mask, "classify");
  dispatch(image.field.array, [&](auto values) {
    parallel_for(
        n, 1 << 15,
        [&](size_t begin, size_t end) {
          for (size_t i = begin; i < end; ++i) v.inside[i] = std::isfinite(double(values[i])) && !image.hidden(i);
        },
        &context);
  });
  if (mask)
    dispatch(mask->array, [&](auto m) {
      for (size_t i = 0; i < n; ++i) v.inside[i] = v.inside[i] && m[i] == m[i] && m[i] != 0;
    });
  for (size_t a = 0; a < 3; ++a) {
    v.unit[a] = image.at[a];
    const double lo = v.unit[a].front(), width = v.unit[a].back() - lo;
    for (double& x : v.unit[a]) x = width != 0 ? 2 * (x - lo) / width - 1 : 0.0;
  }
  return v;
}

// At most 100000 samples, evenly spread: every s-th along each axis, with s as equal as possible in length units.
// `calm` receives the means of each with its up to 26 neighbours.
TissueSamples chosen_samples(const Volume& v, const BiasPolynomial& bias, std::vector<double>& calm) {
  constexpr size_t most = 100000;
  const SampleImage& image = v.image;
  std::array<size_t, 3> step{1, 1, 1};
  const auto total = [&] {
    size_t used = 1;
    for (size_t a = 0; a < 3; ++a) used *= (image.dims[a] + step[a] - 1) / step[a];
    return used;
  };
  size_t inside = 0;
  for (const uint8_t b : v.inside) inside += b;
  const double share = double(std::max<size_t>(inside, 1)) / double(image.count());
  while (double(total()) * share > double(most)) {
    size_t best = 0;
    double finest = HUGE_VAL;
    for (size_t a = 0; a < 3; ++a)
      if (const double h = double(step[a]) * image.spacing(a); image.dims[a] > 2 * step[a] && h < finest) finest = h, best = a;
    ++step[best];
  }
  TissueSamples s;
  std::vector<double> phi(bias.terms.size());
  dispatch(image.field.array, [&](auto values) {
    for (size_t k = step[2] / 2; k < image.dims[2]; k += step[2])
      for (size_t j = step[1] / 2; j < image.dims[1]; j += step[1])
        for (size_t i = step[0] / 2; i < image.dims[0]; i += step[0]) {
          const size_t id = i + image.dims[0] * (j + image.dims[1] * k);
          if (!v.inside[id] || !image.counts(id)) continue;
          s.value.push_back(double(values[id]));
          double sum = 0, count = 0;
          for (size_t z = k - (k > 0); z <= std::min(k + 1, image.dims[2] - 1); ++z)
            for (size_t y = j - (j > 0); y <= std::min(j + 1, image.dims[1] - 1); ++y)
              for (size_t x = i - (i > 0); x <= std::min(i + 1, image.dims[0] - 1); ++x)
                if (const size_t near = x + image.dims[0] * (y + image.dims[1] * z); v.inside[near]) sum += double(values[near]), ++count;
          calm.push_back(sum / count);
          bias.basis({v.unit[0][i], v.unit[1][j], v.unit[2][k]}, phi.data());
          s.basis.insert(s.basis.end(), phi.begin(), phi.end());
        }
  });
  return s;
}

// The optimal split of the histogram gives the first means, deviations and shares.
TissueModel start_model(const TissueSamples& s, const ClassifyParams& p, size_t pure, double& least_deviation, bool whole_numbers,
                        const std::string& name, const Context& context) {
  const ValueCounts h = value_counts(Array::from_vector(s.value), {}, 4096, context);
  if (h.value.size() < pure)
    fail_usage(h.value.empty() ? fmt::format("field '{}' has no finite value to classify", name)
                               : fmt::format("field '{}' has {} different value{}, too few for {} classes", name, h.value.size(),
                                             h.value.size() == 1 ? "" : "s", pure),
               "classify", "use fewer classes, or leave out the background with background=false");
  least_deviation = std::max(1e-3 * (h.value.back() - h.value.front()), whole_numbers ? 0.3 : 0.0);
  if (!(least_deviation > 0)) least_deviation = 1e-6 * std::max(1.0, std::abs(h.value[0]));
  TissueModel m;
  std::vector<size_t> split = pure > 1 ? best_split(h, int(pure)) : std::vector<size_t>();
  split.push_back(h.value.size());
  for (size_t c = 0, i = 0; c < pure; ++c) {
    double w = 0, mean = 0, var = 0;
    for (size_t j = i; j < split[c]; ++j) w += h.count[j], mean += h.count[j] * h.value[j];
    mean /= w;
    for (size_t j = i; j < split[c]; ++j) var += h.count[j] * (h.value[j] - mean) * (h.value[j] - mean);
    i = split[c];
    m.mean.push_back(mean), m.deviation.push_back(std::max(least_deviation, std::sqrt(var / w)));
    m.share.push_back(w / double(s.value.size()));
  }
  if (p.partial_volume)
    for (size_t c = 0; c + 1 < pure; ++c) m.share.push_back(0.05);
  return m;
}

// Densities and proportions over intensity, looked up instead of computed: the parts of a row lie side by side. Parts with the background
// are looked up at the intensity itself, the others at the corrected one.
struct DensityTable {
  size_t pure = 0, parts = 0, bins = 8192;
  bool background = false;
  float lo = 0, scale = 0;
  std::vector<float> rows;
  const float* row(float y) const {
    const float t = (y - lo) * scale;
    const size_t b = t <= 0 ? 0 : t >= float(bins - 1) ? bins - 1 : size_t(t + 0.5f);
    return rows.data() + b * (2 * parts);
  }
};

DensityTable density_table(const TissueModel& m) {
  DensityTable t;
  t.pure = m.pure(), t.parts = m.parts(), t.background = m.background;
  double widest = 0;
  for (const double d : m.deviation) widest = std::max(widest, d);
  const double lo = m.mean.front() - 6 * widest, hi = m.mean.back() + 6 * widest;
  t.lo = float(lo), t.scale = float(double(t.bins - 1) / (hi - lo));
  t.rows.resize(t.bins * 2 * t.parts);
  std::vector<double> density(t.parts), proportion(t.parts);
  for (size_t b = 0; b < t.bins; ++b) {
    part_densities(m, lo + (hi - lo) * double(b) / double(t.bins - 1), 1, density.data(), proportion.data());
    for (size_t c = 0; c < t.parts; ++c) {
      t.rows[b * 2 * t.parts + c] = float(density[c] * m.share[c] * widest) + 1e-20f;
      if (c >= t.pure) t.rows[b * 2 * t.parts + t.parts + c - t.pure] = float(proportion[c - t.pure]);
    }
  }
  return t;
}

constexpr size_t max_classes = 17;

// Expected shares of one sample from its densities and its neighbours (factor[c], 1 when they have no influence).
inline void expected_shares(const DensityTable& t, float y, float corrected, const float* factor, float* share) {
  const float* bright_row = t.row(corrected);
  const float* dark_row = t.background ? t.row(y) : bright_row;
  float total = 0;
  for (size_t c = 0; c < t.pure; ++c) total += share[c] = (c == 0 ? dark_row : bright_row)[c] * factor[c];
  for (size_t c = t.pure; c < t.parts; ++c) {
    const size_t k = c - t.pure;
    const float* row = k == 0 ? dark_row : bright_row;
    const float p = row[c] * std::sqrt(factor[k] * factor[k + 1]), bright = row[t.parts + k];
    share[k] += p * (1 - bright), share[k + 1] += p * bright;
    total += p;
  }
  for (size_t c = 0; c < t.pure; ++c) share[c] /= total;
}

struct Shares {
  std::vector<float*> plane;  // one per pure class
  float *value = nullptr, *corrected = nullptr;
};

// One half-sweep over the samples of one colour of the chequerboard: they read only samples of the other.
void sweep(const Volume& v, const DensityTable& t, const Shares& s, double smoothness, size_t colour, const Context& context) {
  const auto d = v.image.dims;
  const auto stride = v.image.strides();
  float weight[3];
  double mean = 0;
  for (size_t a = 0; a < 3; ++a) mean += d[a] > 1 ? 1 / v.image.spacing(a) : 0;
  for (size_t a = 0; a < 3; ++a) weight[a] = float(smoothness / v.image.spacing(a) / (mean / std::max(1, v.image.dimension())));
  parallel_for(
      d[1] * d[2], std::max<size_t>(1, (1 << 14) / d[0]),
      [&](size_t begin, size_t end) {
        float factor[max_classes], share[max_classes];
        for (size_t row = begin; row < end; ++row) {
          const size_t j = row % d[1], k = row / d[1];
          for (size_t i = (colour + j + k) & 1; i < d[0]; i += 2) {
            const size_t id = i + d[0] * row;
            if (!v.inside[id]) continue;
            for (size_t c = 0; c < t.pure; ++c) factor[c] = 0;
            const size_t index[3] = {i, j, k};
            for (size_t a = 0; a < 3; ++a) {
              if (index[a] > 0 && v.inside[id - stride[a]])
                for (size_t c = 0; c < t.pure; ++c) factor[c] += weight[a] * s.plane[c][id - stride[a]];
              if (index[a] + 1 < d[a] && v.inside[id + stride[a]])
                for (size_t c = 0; c < t.pure; ++c) factor[c] += weight[a] * s.plane[c][id + stride[a]];
            }
            for (size_t c = 0; c < t.pure; ++c) factor[c] = std::exp(factor[c]);
            expected_shares(t, s.value[id], s.corrected[id], factor, share);
            for (size_t c = 0; c < t.pure; ++c) s.plane[c][id] = share[c];
          }
        }
      },
      &context);
}

// The bias along each row is a polynomial of one variable: its coefficients are put together once per row.
void correct(const Volume& v, const BiasPolynomial& bias, float* bias_out, float* value, float* corrected, const Context& context) {
  const auto d = v.image.dims;
  const size_t order = size_t(bias.degree) + 1;
  std::vector<double> along(d[0] * order);
  for (size_t i = 0; i < d[0]; ++i) legendre(v.unit[0][i], bias.degree, along.data() + i * order);
  dispatch(v.image.field.array, [&](auto values) {
    parallel_for(
        d[1] * d[2], std::max<size_t>(1, (1 << 14) / d[0]),
        [&](size_t begin, size_t end) {
          double py[16], pz[16], row_terms[16];
          for (size_t row = begin; row < end; ++row) {
            legendre(v.unit[1][row % d[1]], bias.degree, py), legendre(v.unit[2][row / d[1]], bias.degree, pz);
            std::fill(row_terms, row_terms + order, 0.0);
            for (size_t t = 0; t < bias.terms.size(); ++t)
              row_terms[bias.terms[t][0]] += bias.coefficient[t] * py[bias.terms[t][1]] * pz[bias.terms[t][2]];
            for (size_t i = 0; i < d[0]; ++i) {
              const size_t id = i + d[0] * row;
              double log_b = bias.log_scale;
              for (size_t o = 0; o < order; ++o) log_b += row_terms[o] * along[i * order + o];
              const double b = std::exp(std::clamp(log_b, -2.0, 2.0));
              if (bias_out) bias_out[id] = float(b);
              value[id] = float(values[id]);
              corrected[id] = float(double(values[id]) / b);
            }
          }
        },
        &context);
  });
}

// Scale of the bias: geometric mean 1 over what is brighter than the background.
void normalize_bias(TissueModel& m, const TissueSamples& s, bool background) {
  const size_t terms = m.bias.terms.size();
  const double limit = background && m.pure() > 1 ? (m.mean[0] + m.mean[1]) / 2 : -HUGE_VAL;
  double sum = 0, n = 0;
  for (size_t i = 0; i < s.value.size(); ++i) {
    const double b = m.bias.log_value(s.basis.data() + i * terms);
    if (s.value[i] > limit * std::exp(b)) sum += b, ++n;
  }
  if (n == 0) return;
  m.bias.log_scale -= sum / n;
  for (size_t c = background ? 1 : 0; c < m.pure(); ++c) m.mean[c] *= std::exp(sum / n), m.deviation[c] *= std::exp(sum / n);
}

void report(const TissueModel& m, const ClassifyParams& p, const TissueSamples& s, const Context& context) {
  std::string classes;
  for (size_t c = 0; c < m.pure(); ++c)
    classes += fmt::format("{}{}{} +- {}", c ? ", " : "", p.background && c == 0 ? "background " : "", short_number(m.mean[c], 4),
                           short_number(m.deviation[c], 2));
  double lo = HUGE_VAL, hi = 0;
  const size_t terms = m.bias.terms.size();
  for (size_t i = 0; i < s.value.size(); ++i) {
    const double b = std::exp(m.bias.log_value(s.basis.data() + i * terms));
    if (p.background && s.value[i] < b * (m.mean[0] + m.mean[std::min<size_t>(1, m.pure() - 1)]) / 2) continue;
    lo = std::min(lo, b), hi = std::max(hi, b);
  }
  const std::string bias = terms ? fmt::format("; bias {} to {} over tissue", short_number(lo, 3), short_number(hi, 3)) : "";
  context.info(fmt::format("classify: {}{}; {} after {} iterations on {} samples", classes, bias, m.converged ? "converged" : "stopped",
                           m.iterations, s.value.size()));
  if (!m.converged) context.warn(fmt::format("classify: not converged after {} iterations; allow more with iterations=", m.iterations));
}

}  // namespace

DatasetPtr classify(const DatasetPtr& in, const ClassifyParams& p, Context& context) {
  const Volume v = open_volume(*in, p, context);
  const SampleImage& image = v.image;
  const size_t n = image.count(), pure = size_t(p.classes) + (p.background ? 1 : 0), first = p.background ? 1 : 0;
  if (pure == 1 && p.bias_degree == 0) fail_usage("a single class is meaningless", "classify", "use more classes");
  const BiasPolynomial bias(p.bias_degree, {image.dims[0] > 1, image.dims[1] > 1, image.dims[2] > 1});
  std::vector<double> calm;
  TissueSamples samples = chosen_samples(v, bias, calm);
  std::swap(samples.value, calm);
  double least_deviation = 0;
  TissueModel model = start_model(samples, p, pure, least_deviation, !is_float(image.field.array.type()), image.field.name, context);
  model.bias = bias;
  model.background = p.background;
  FitOptions options{least_deviation, p.iterations, p.tolerance, true};
  fit_tissues(model, samples, options, context);
  std::swap(samples.value, calm);
  options.with_bias = false;
  fit_tissues(model, samples, options, context);
  normalize_bias(model, samples, p.background);
  report(model, p, samples, context);

  const Association on = image.field.association;
  DatasetParts parts = in->parts();
  float* bias_values = nullptr;
  if (p.bias_degree > 0) parts.fields.add({"bias", on, Array::make<float>(n, 1, &bias_values), "", Role::none});
  Plane<float> original(n), corrected(n), dark(p.background ? n : 0);
  correct(v, model.bias, bias_values, original.data(), corrected.data(), context);

  Shares shares;
  shares.value = original.data(), shares.corrected = corrected.data();
  if (p.background) shares.plane.push_back(dark.data());
  for (int c = 1; c <= p.classes; ++c) {
    float* plane = nullptr;
    parts.fields.add({fmt::format("fraction_{}", c), on, Array::make<float>(n, 1, &plane), "", Role::none});
    shares.plane.push_back(plane);
  }
  const DensityTable table = density_table(model);
  parallel_for(
      n, 1 << 14,
      [&](size_t begin, size_t end) {
        float factor[max_classes], share[max_classes];
        std::fill(factor, factor + max_classes, 1.0f);
        for (size_t i = begin; i < end; ++i) {
          if (v.inside[i]) expected_shares(table, original[i], corrected[i], factor, share);
          for (size_t c = 0; c < pure; ++c) shares.plane[c][i] = v.inside[i] ? share[c] : NAN;
        }
      },
      &context);
  constexpr int sweeps = 5;
  if (p.smoothness > 0)
    for (int s = 0; s < sweeps; ++s) {
      context.progress(double(s) / sweeps, "smoothing classes");
      for (size_t colour = 0; colour < 2; ++colour) sweep(v, table, shares, p.smoothness, colour, context);
    }

  uint8_t* label = nullptr;
  parts.fields.add({"label", on, Array::make<uint8_t>(n, 1, &label), "", Role::labels});
  parallel_for(n, 1 << 15, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      size_t best = 0;
      for (size_t c = 1; c < pure; ++c)
        if (shares.plane[c][i] > shares.plane[best][i]) best = c;
      label[i] = v.inside[i] ? uint8_t(best + 1 - first) : uint8_t(0);
    }
  });
  mark_result(parts.fields, "label", on);
  parts.fields.add({"class means", Association::whole, Array::from_vector(model.mean), image.field.unit, Role::none});
  parts.fields.add({"class deviations", Association::whole, Array::from_vector(model.deviation), image.field.unit, Role::none});
  return make_dataset(std::move(parts));
}

}  // namespace sg
