// SPDX-License-Identifier: Apache-2.0
#include "filter/segment/watershed.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <queue>

#include "base/parallel.h"
#include "base/text/text.h"
#include "data/fields/known_looks.h"
#include "filter/segment/samples.h"

namespace sg {

void describe(Schema& s, WatershedParams& p) {
  s("field", p.field, "Field to flood; default: the active scalar.").takes(fields::scalars);
  s("markers", p.markers, "Label field to grow from; default: the minima of the field.").takes(fields::scalars);
  s("gradient", p.gradient, "Flood the gradient magnitude of the field.");
  s("min_depth", p.min_depth, "Minima shallower than this do not form basins of their own.").unit("@field").at_least(0);
  s("connectivity", p.connectivity, "Neighbours in space: 6 (faces), 18 (and edges) or 26 (and corners).").range(6, 26);
  s("name", p.name, "Name of the label field.");
}

namespace {

constexpr size_t places_per_chunk = 1 << 16;
constexpr uint32_t no_sample = UINT32_MAX;

// f32 numbers as integers of the same order; no value is `no_sample`.
uint32_t order_key(float x) {
  if (x != x) return no_sample;
  const uint32_t bits = std::bit_cast<uint32_t>(x + 0.0f);
  return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

float value_of_key(uint32_t key) { return std::bit_cast<float>(key & 0x80000000u ? key & 0x7FFFFFFFu : ~key); }

Plane<float> values_of(const SampleImage& image) {
  Plane<float> f(image.count());
  dispatch(image.field.array, [&](auto v) {
    parallel_for(f.size(), places_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) f[i] = image.hidden(i) ? NAN : float(v[i]);
    });
  });
  return f;
}

// Length of the gradient; one-sided at borders and next to samples without a value.
Plane<float> gradient_length(const SampleImage& image, const Plane<float>& f) {
  const auto d = image.dims;
  const auto stride = image.strides();
  Plane<float> g(f.size());
  parallel_for(d[1] * d[2], 16, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row)
      for (size_t i = 0; i < d[0]; ++i) {
        const size_t id = i + d[0] * row, at[3] = {i, row % d[1], row / d[1]};
        double sum = 0;
        for (size_t a = 0; a < 3; ++a) {
          const bool low = at[a] > 0 && f[id - stride[a]] == f[id - stride[a]],
                     high = at[a] + 1 < d[a] && f[id + stride[a]] == f[id + stride[a]];
          if (!low && !high) continue;
          const size_t from = low ? 1 : 0, to = high ? 1 : 0;
          const double rise = double(f[id + to * stride[a]]) - double(f[id - from * stride[a]]);
          const double run = image.at[a][at[a] + to] - image.at[a][at[a] - from];
          sum += rise / run * (rise / run);
        }
        g[id] = f[id] == f[id] ? float(std::sqrt(sum)) : NAN;
      }
  });
  return g;
}

struct Neighbors {
  std::array<size_t, 3> d;
  std::vector<std::array<int, 3>> steps;
  std::vector<ptrdiff_t> jump;
  explicit Neighbors(std::array<size_t, 3> dims, int connectivity) : d(dims), steps(neighbors_before(connectivity)) {
    for (size_t s = steps.size(); s-- > 0;) steps.push_back({-steps[s][0], -steps[s][1], -steps[s][2]});
    for (const auto& s : steps) jump.push_back(s[0] + ptrdiff_t(d[0]) * (s[1] + ptrdiff_t(d[1]) * s[2]));
  }
  template <class F>
  void each(size_t i, F&& f) const {
    const size_t x = i % d[0], y = i / d[0] % d[1], z = i / (d[0] * d[1]);
    const bool inner = x > 0 && y > 0 && z > 0 && x + 1 < d[0] && y + 1 < d[1] && z + 1 < d[2];
    for (size_t s = 0; s < steps.size(); ++s)
      if (inner || (x + size_t(steps[s][0]) < d[0] && y + size_t(steps[s][1]) < d[1] && z + size_t(steps[s][2]) < d[2]))
        f(size_t(ptrdiff_t(i) + jump[s]));
  }
};

// Ids in order of key, then id: three stable passes of 11 bits.
std::vector<uint32_t> sorted_ids(const Plane<uint32_t>& key) {
  std::vector<uint32_t> ids, next;
  ids.reserve(key.size());
  for (size_t i = 0; i < key.size(); ++i)
    if (key[i] != no_sample) ids.push_back(uint32_t(i));
  next.resize(ids.size());
  for (int shift = 0; shift < 33; shift += 11) {
    std::vector<size_t> count(2049, 0);
    for (const uint32_t i : ids) ++count[(key[i] >> shift & 2047) + 1];
    std::partial_sum(count.begin(), count.end(), count.begin());
    for (const uint32_t i : ids) next[count[key[i] >> shift & 2047]++] = i;
    std::swap(ids, next);
  }
  return ids;
}

// The lowest sample of each basin that is deeper than min_depth. Samples join in order of value; where two basins meet, the one with the
// higher minimum ends unless it is deep enough (its persistence).
std::vector<uint32_t> deep_minima(const Plane<uint32_t>& key, const Neighbors& neighbors, double min_depth, const Context& context) {
  const std::vector<uint32_t> ids = sorted_ids(key);
  std::vector<uint32_t> parent(key.size(), no_sample);  // towards the lowest sample of the basin
  std::vector<uint8_t> kept(key.size(), 0);
  const auto root = [&](uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  const auto lower = [&](uint32_t a, uint32_t b) { return key[a] < key[b] || (key[a] == key[b] && a < b); };
  for (size_t n = 0; n < ids.size(); ++n) {
    if (n % (1 << 20) == 0) context.check();
    const uint32_t i = ids[n];
    parent[i] = i;
    kept[i] = 1;
    neighbors.each(i, [&](size_t near) {
      if (parent[near] == no_sample) return;
      uint32_t a = root(i), b = root(uint32_t(near));
      if (a == b) return;
      if (lower(b, a)) std::swap(a, b);
      parent[b] = a;  // b is the higher minimum
      if (double(value_of_key(key[i])) - double(value_of_key(key[b])) <= min_depth) kept[b] = 0;
    });
  }
  std::vector<uint32_t> minima;
  for (const uint32_t i : ids)
    if (kept[i]) minima.push_back(i);
  return minima;
}

// First in, first out among equal keys: lists by the upper half of the key, a heap for the list that is being emptied.
class FloodQueue {
 public:
  explicit FloodQueue(size_t samples) : next_(samples), head_(1 << 16, no_sample), tail_(1 << 16, no_sample) {}
  void push(uint32_t key, uint32_t id) {
    const size_t b = key >> 16;
    if (b <= current_ && open_) {
      heap_.push({key, age_++, id});
      return;
    }
    next_[id] = no_sample;
    if (tail_[b] == no_sample) head_[b] = id;
    else next_[tail_[b]] = id;
    tail_[b] = id;
    if (b < current_) current_ = b;
  }
  /// False when there is nothing more.
  bool pop(const Plane<uint32_t>& keys, uint32_t& key, uint32_t& id) {
    while (heap_.empty()) {
      size_t b = open_ ? current_ + 1 : 0;
      while (b < head_.size() && head_[b] == no_sample) ++b;
      if (b == head_.size()) return false;
      current_ = b, open_ = true;
      for (uint32_t i = head_[b]; i != no_sample; i = next_[i]) heap_.push({keys[i], age_++, i});
      head_[b] = tail_[b] = no_sample;
    }
    key = heap_.top().key, id = heap_.top().id;
    heap_.pop();
    return true;
  }

 private:
  struct Entry {
    uint32_t key, age, id;
    bool operator<(const Entry& o) const { return key > o.key || (key == o.key && age > o.age); }  // the top is the least
  };
  std::priority_queue<Entry> heap_;
  std::vector<uint32_t> next_, head_, tail_;
  size_t current_ = 0;
  bool open_ = false;
  uint32_t age_ = 0;
};

// label: 0 where no water is; grows over all samples with a value that are joined to a marker.
void flood(Plane<int32_t>& label, const Plane<uint32_t>& key, const std::vector<uint32_t>& shore, const Neighbors& neighbors,
           const Context& context) {
  FloodQueue queue(key.size());
  for (const uint32_t i : shore) queue.push(key[i], i);
  uint32_t level = 0, id = 0;
  for (size_t n = 0; queue.pop(key, level, id); ++n) {
    if (n % (1 << 20) == 0) context.check();
    neighbors.each(id, [&](size_t near) {
      if (label[near] != 0 || key[near] == no_sample) return;
      label[near] = label[id];
      queue.push(std::max(key[near], level), uint32_t(near));
    });
  }
}

}  // namespace

DatasetPtr watershed(const DatasetPtr& in, const WatershedParams& p, Context& context) {
  if (p.connectivity != 6 && p.connectivity != 18 && p.connectivity != 26)
    fail_usage(fmt::format("{} is not a valid connectivity", p.connectivity), "watershed connectivity", "give 6, 18 or 26");
  const SampleImage image = sample_image(*in, p.field, "watershed");
  const size_t n = image.count();
  if (n >= no_sample) fail_usage("the grid has more than four billion samples", "watershed", "crop it first");
  Plane<uint32_t> key(n);
  {
    Plane<float> f = values_of(image);
    if (p.gradient) f = gradient_length(image, f);
    parallel_for(n, places_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) key[i] = order_key(f[i]);
    });
  }
  const Neighbors neighbors(image.dims, p.connectivity);
  Plane<int32_t> label(n);
  std::fill(label.begin(), label.end(), 0);
  std::vector<uint32_t> shore;
  LabelCodes codes;
  size_t basins = 0;
  if (!p.markers.empty()) {
    SampleImage marker_image = image;
    marker_image.field = companion_field(*in, image, p.markers, "watershed");
    codes = label_codes(marker_image, 0.0, {}, "watershed", context);
    for (size_t i = 0; i < n; ++i)
      if (codes.code[i] != 0 && key[i] != no_sample) label[i] = codes.code[i], shore.push_back(uint32_t(i));
    if (shore.empty())
      fail_usage(fmt::format("field '{}' marks no sample", p.markers.name), "watershed markers", "markers must be labels other than 0");
  } else {
    shore = deep_minima(key, neighbors, p.min_depth, context);
    for (const uint32_t i : shore) label[i] = int32_t(++basins);
  }
  flood(label, key, shore, neighbors, context);
  if (p.markers.empty()) context.info(fmt::format("watershed: {} basin{}", basins, basins == 1 ? "" : "s"));

  Field out{p.name, image.field.association, {}, "", Role::labels};
  if (codes.table.empty()) {
    int32_t* to = nullptr;
    out.array = Array::make<int32_t>(n, 1, &to);
    std::copy(label.begin(), label.end(), to);
  } else {
    int64_t* to = nullptr;
    out.array = Array::make<int64_t>(n, 1, &to);
    for (size_t i = 0; i < n; ++i) to[i] = label[i] == 0 ? 0 : codes.label(label[i]);
  }
  return with_result(in, std::move(out));
}

}  // namespace sg
