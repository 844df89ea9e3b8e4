// SPDX-License-Identifier: Apache-2.0
// Accessors: strided bytes, sparse replacements, normalized integers.
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/parallel.h"
#include "io/gltf/gltf_document.h"

namespace sg {

namespace {

// Zeros that no byte of the file backs are believed up to this many beyond its size.
constexpr uint64_t free_zeros = uint64_t(1) << 20;

struct Source {
  const char* data;
  uint64_t stride;
};

// Where `count` elements of `size` bytes lie; throws when they do not lie in the view.
Source find_bytes(const GltfDocument& d, int view, uint64_t offset, uint64_t count, uint64_t size, uint64_t stride, int accessor) {
  const GltfView& v = d.views[size_t(view)];
  if (stride == 0) stride = size;
  uint64_t need = 0;
  const bool fits = count == 0 || (multiply(count - 1, stride, need) && add(need, size, need) && add(need, offset, need));
  if (!fits || need > v.length)
    fail_data(fmt::format("accessor {}: {} elements of {} bytes do not fit into the {} bytes of bufferView {}", accessor, count, size,
                          v.length, view),
              d.path);
  return {d.buffers[size_t(v.buffer)].bytes.data() + v.offset + offset, stride};
}

void put_sparse(const GltfDocument& d, const GltfAccessor& a, int accessor, std::byte* out, size_t size) {
  const GltfSparse& s = *a.sparse;
  if (is_float(s.indices_type) || s.indices_type == ElementType::i8 || s.indices_type == ElementType::i16)
    fail_data(fmt::format("accessor {}: sparse indices are not unsigned integers", accessor), d.path);
  const size_t index_size = element_size(s.indices_type);
  const Source indices = find_bytes(d, s.indices_view, s.indices_offset, s.count, index_size, 0, accessor);
  const Source values = find_bytes(d, s.values_view, s.values_offset, s.count, size, 0, accessor);
  for (uint64_t k = 0; k < s.count; ++k) {
    uint32_t i = 0;
    std::memcpy(&i, indices.data + k * index_size, index_size);
    if (i >= a.count) fail_data(fmt::format("accessor {}: sparse value {} of {} does not exist", accessor, i, a.count), d.path);
    std::memcpy(out + i * size, values.data + k * size, size);
  }
}

Array as_fractions(const Array& a) {
  float* out = nullptr;
  Array r = Array::make<float>(a.count(), a.components(), &out);
  const size_t n = a.count() * size_t(a.components());
  dispatch(a, [&](auto v) {
    using T = std::remove_cvref_t<decltype(v[0])>;
    const T* in = v.data;
    parallel_for(n, 1 << 16, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) out[i] = std::max(float(double(in[i]) / double(std::numeric_limits<T>::max())), -1.f);
    });
  });
  return r;
}

}  // namespace

Array gltf_array(const GltfDocument& d, int accessor, bool keep_integers) {
  const GltfAccessor& a = d.accessors[size_t(accessor)];
  const size_t size = element_size(a.type) * size_t(a.components);
  if (a.components > 4 && element_size(a.type) < 4)
    fail_data(fmt::format("accessor {}: matrices of {} are not supported", accessor, element_name(a.type)), d.path);
  if (a.view < 0 && (!a.sparse || a.count > d.backed + free_zeros))
    fail_data(fmt::format("accessor {}: {} elements without a bufferView", accessor, a.count), d.path);
  Source from{};
  if (a.view >= 0) from = find_bytes(d, a.view, a.offset, a.count, size, d.views[size_t(a.view)].stride, accessor);
  std::byte* out = nullptr;
  Array r = Array::make_raw(a.type, size_t(a.count), a.components, &out);
  if (a.view < 0) {
    std::memset(out, 0, r.bytes());
  } else {
    parallel_for(size_t(a.count), 1 << 16, [&](size_t begin, size_t end) {
      if (from.stride == size) std::memcpy(out + begin * size, from.data + begin * size, (end - begin) * size);
      else
        for (size_t i = begin; i < end; ++i) std::memcpy(out + i * size, from.data + i * from.stride, size);
    });
  }
  if (a.sparse) put_sparse(d, a, accessor, out, size);
  return a.normalized && !is_float(a.type) && !keep_integers ? as_fractions(r) : r;
}

}  // namespace sg
