// SPDX-License-Identifier: Apache-2.0
#include "filter/probe/field_sampler.h"

#include <algorithm>
#include <cstring>

namespace sg {

FieldSampler::FieldSampler(const Dataset& from, size_t count) {
  for (const Field& f : from.fields()) {
    if (f.association == Association::whole) {
      whole_.push_back(f);
      continue;
    }
    if (f.association == Association::cell && from.cell_count() == 0) continue;  // points are found in clouds, but they have no cells
    Target t{f.with({}, Association::point), f.array.made_packed(), {}, nullptr};
    ElementType type = f.array.type();
    if (f.association == Association::point) {
      type = element_size(type) == 8 ? ElementType::f64 : ElementType::f32;
    } else {
      t.field.association = Association::cell;  // of the source: controls write()
      if (from.fields().find(f.name, Association::point)) t.field.name += "_cell";
    }
    if (t.field.name == "valid") continue;
    t.to = Array::make_raw(type, count, f.array.components(), &t.out);
    targets_.push_back(std::move(t));
  }
  valid_ = Array::make<uint8_t>(count, 1, &valid_out_);
}

namespace {

// The sum as combine() makes it: points without weight do not count, whatever their value.
template <class T>
double careful_sum(const View<T>& v, int c, const int64_t* ids, const double* w, size_t n) {
  double sum = 0;
  for (size_t k = 0; k < n; ++k)
    if (w[k] != 0) sum += w[k] * double(v.data[size_t(ids[k]) * size_t(v.components) + size_t(c)]);
  return sum;
}

}  // namespace

template <class T>
void FieldSampler::combine_block(const Target& t, const View<T>& v, const SampleBlock& block) {
  using Out = std::conditional_t<sizeof(T) == 8, double, float>;
  Out* out = reinterpret_cast<Out*>(t.out);
  const size_t comps = size_t(v.components);
  for (size_t i = 0; i < block.count; ++i) {
    Out* to = out + block.to[i] * comps;
    if (block.cells[i] < 0) {
      for (size_t c = 0; c < comps; ++c) to[c] = Out(NAN);
      continue;
    }
    const size_t begin = block.begin[i], n = block.begin[i + 1] - begin;
    const int64_t* ids = &block.ids[begin];
    const double* w = &block.weights[begin];
    for (size_t c = 0; c < comps; ++c) {
      double sum = 0;
      if (n == 4)
        for (size_t k = 0; k < 4; ++k) sum += w[k] * double(v.data[size_t(ids[k]) * comps + c]);
      else
        for (size_t k = 0; k < n; ++k) sum += w[k] * double(v.data[size_t(ids[k]) * comps + c]);
      if (!std::isfinite(sum)) [[unlikely]]
        sum = careful_sum(v, int(c), ids, w, n);
      to[c] = Out(sum);
    }
  }
}

void FieldSampler::copy_block(const Target& t, const SampleBlock& block) {
  const ElementType type = t.to.type();
  const size_t bytes = element_size(type) * size_t(t.to.components());
  for (size_t i = 0; i < block.count; ++i) {
    std::byte* to = t.out + block.to[i] * bytes;
    if (block.cells[i] >= 0) std::memcpy(to, t.from.raw() + size_t(block.cells[i]) * bytes, bytes);
    else if (type == ElementType::f32) std::fill_n(reinterpret_cast<float*>(to), t.to.components(), NAN);
    else if (type == ElementType::f64) std::fill_n(reinterpret_cast<double*>(to), t.to.components(), double(NAN));
    else std::memset(to, 0, bytes);
  }
}

void FieldSampler::write(const SampleBlock& block) {
  for (size_t i = 0; i < block.count; ++i) valid_out_[block.to[i]] = block.cells[i] >= 0;
  for (const Target& t : targets_)
    if (t.field.association == Association::cell) copy_block(t, block);
    else dispatch(t.from, [&](auto v) { combine_block(t, v, block); });
}

FieldSet FieldSampler::take() {
  FieldSet fields;
  for (Target& t : targets_) {
    t.field.association = Association::point;
    t.field.array = t.to;
    fields.add(std::move(t.field));
  }
  fields.add({"valid", Association::point, valid_, "", Role::labels});
  for (Field& f : whole_) fields.add(std::move(f));
  targets_.clear(), whole_.clear();
  return fields;
}

}  // namespace sg
