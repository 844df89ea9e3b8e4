// SPDX-License-Identifier: Apache-2.0
#include "filter/segment/label_components.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/parallel.h"
#include "base/union_find.h"
#include "filter/segment/samples.h"

namespace sg {

void describe(Schema& s, LabelComponentsParams& p) {
  s("field", p.field, "Field of labels; default: the first label field, else the active scalar.").takes(fields::scalars);
  s("background", p.background, "Background label.");
  s("labels", p.labels, "Labels to use; default: all except the background.");
  s("connectivity", p.connectivity, "Neighbours in space: 6 (faces), 18 (and edges) or 26 (and corners).").range(6, 26);
  s("by_label", p.by_label, "Treat different labels as different parts.");
  s("min_size", p.min_size, "Drop parts with fewer samples.").at_least(1);
  s("keep", p.keep, "Keep only this many of the largest parts; 0: all.").at_least(0);
}

namespace {

struct Run {
  uint32_t begin, end;  // along x
  int32_t code;
};

// Runs of equal code in each row, and sets of them.
struct RunSets {
  std::vector<Run> runs;
  std::vector<size_t> first;  // of each row
  UnionFind<> sets{0};
  // Runs of two rows that overlap, or with reach 1 touch at corners.
  void join_rows(size_t row, size_t other, uint32_t reach) {
    size_t a = first[row], b = first[other];
    const auto meet = [&](size_t i, size_t k) {
      if (i == first[row + 1] || k == first[other + 1]) return;
      const Run &x = runs[i], &y = runs[k];
      if (x.code == y.code && x.begin < y.end + reach && y.begin < x.end + reach) sets.join(uint32_t(i), uint32_t(k));
    };
    while (a < first[row + 1] && b < first[other + 1]) {
      meet(a, b);
      if (runs[a].end < runs[b].end) ++a;
      else if (runs[b].end < runs[a].end) ++b;
      else {  // each may still touch the one after the other
        if (reach) meet(a + 1, b), meet(a, b + 1);
        ++a, ++b;
      }
    }
  }
};

RunSets find_runs(const int32_t* code, std::array<size_t, 3> d, bool by_label, const Context& context) {
  const size_t rows = d[1] * d[2];
  RunSets s;
  s.first.assign(rows + 1, 0);
  const auto scan = [&](size_t row, auto&& emit) {
    const int32_t* c = code + row * d[0];
    for (size_t i = 0; i < d[0];) {
      const int32_t here = by_label ? c[i] : c[i] != 0;
      size_t end = i + 1;
      while (end < d[0] && (by_label ? c[end] : c[end] != 0) == here) ++end;
      if (here) emit(Run{uint32_t(i), uint32_t(end), here});
      i = end;
    }
  };
  parallel_for(
      rows, 64,
      [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row) scan(row, [&](Run) { ++s.first[row]; });
      },
      &context);
  const size_t total = exclusive_scan(s.first);
  if (total >= UINT32_MAX) fail_usage("the image has too many label runs", "label_components", "crop the image");
  s.runs.resize(total);
  s.sets = UnionFind<>(total);
  parallel_for(rows, 64, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      size_t at = s.first[row];
      scan(row, [&](Run r) { s.runs[at++] = r; });
    }
  });
  return s;
}

}  // namespace

CodeComponents code_components(const int32_t* code, std::array<size_t, 3> d, int connectivity, bool by_label, const Context& context) {
  if (d[0] >= UINT32_MAX - 1) fail_usage("the grid is too large", "label_components");
  RunSets s = find_runs(code, d, by_label, context);
  const auto join_row = [&](size_t j, size_t k, bool below) {
    const size_t row = j + d[1] * k;
    const uint32_t near = connectivity >= 18, corner = connectivity == 26;
    if (!below && j > 0) s.join_rows(row, row - 1, near);
    if (!below || k == 0) return;
    s.join_rows(row, row - d[1], near);
    if (near && j > 0) s.join_rows(row, row - d[1] - 1, corner);
    if (near && j + 1 < d[1]) s.join_rows(row, row - d[1] + 1, corner);
  };
  // Slabs of slices on their own, then their borders: joins of one slab touch only its runs.
  constexpr size_t slab = 16;
  parallel_for(
      d[2], slab,
      [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k)
          for (size_t j = 0; j < d[1]; ++j) {
            join_row(j, k, false);
            if (k > begin) join_row(j, k, true);
          }
      },
      &context);
  for (size_t k = slab; k < d[2]; k += slab)
    for (size_t j = 0; j < d[1]; ++j) join_row(j, k, true);

  // Number the sets by size, then by first run.
  std::vector<int64_t> samples(s.runs.size(), 0);
  std::vector<uint32_t> roots;
  for (uint32_t r = 0; r < s.runs.size(); ++r) {
    const uint32_t root = s.sets.root(r);
    if (root == r) roots.push_back(r);
    samples[root] += s.runs[r].end - s.runs[r].begin;
  }
  std::stable_sort(roots.begin(), roots.end(), [&](uint32_t a, uint32_t b) { return samples[a] > samples[b]; });
  if (roots.size() >= size_t(INT32_MAX)) fail_usage("more than two billion parts", "label_components");
  std::vector<int32_t> number(s.runs.size(), 0);
  CodeComponents out;
  for (size_t i = 0; i < roots.size(); ++i) number[roots[i]] = int32_t(i + 1), out.size.push_back(samples[roots[i]]);
  out.component.resize(d[0] * d[1] * d[2]);
  for (uint32_t r = 0; r < s.runs.size(); ++r) number[r] = number[s.sets.root(r)];
  parallel_for(d[1] * d[2], 64, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      int32_t* c = out.component.data() + row * d[0];
      std::fill(c, c + d[0], 0);
      for (size_t r = s.first[row]; r < s.first[row + 1]; ++r) std::fill(c + s.runs[r].begin, c + s.runs[r].end, number[r]);
    }
  });
  return out;
}

DatasetPtr label_components(const DatasetPtr& in, const LabelComponentsParams& p, Context& context) {
  if (p.connectivity != 6 && p.connectivity != 18 && p.connectivity != 26)
    fail_usage(fmt::format("{} is not a valid connectivity", p.connectivity), "label_components connectivity", "give 6, 18 or 26");
  const SampleImage image = sample_image(*in, p.field, "label_components", true);
  const LabelCodes codes = label_codes(image, p.background, p.labels, "label_components", context);
  CodeComponents c = code_components(codes.code.data(), image.dims, p.connectivity, p.by_label, context);
  // Parts are in order of size: those that stay come first.
  const size_t all = c.size.size();
  while (!c.size.empty() && (c.size.back() < p.min_size || (p.keep > 0 && c.size.size() > size_t(p.keep)))) c.size.pop_back();
  if (c.size.size() < all) {
    const auto last = int32_t(c.size.size());
    parallel_for(c.component.size(), 1 << 16, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        if (c.component[i] > last) c.component[i] = 0;
    });
  }
  context.info(all == 0 ? std::string("label_components: no sample has one of the selected labels")
                        : fmt::format("label_components: {} part{}{}, the largest of {} samples", all, all == 1 ? "" : "s",
                                      c.size.size() < all ? fmt::format(" ({} kept)", c.size.size()) : "", c.size.empty() ? 0 : c.size[0]));
  DatasetParts parts = in->parts();
  parts.fields.add({"component", image.field.association, Array::from_vector(std::move(c.component)), "", Role::labels, {.result = true}});
  parts.fields.add({"component sizes", Association::whole, Array::from_vector(std::move(c.size)), "", Role::none});
  return make_dataset(std::move(parts));
}

}  // namespace sg
