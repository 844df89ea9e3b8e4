// SPDX-License-Identifier: Apache-2.0
#include "data/array.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "base/huge_allocator.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "data/memory/memory_budget.h"

namespace sg {

Array::Array(const Array&) = default;
Array::Array(Array&&) noexcept = default;
Array& Array::operator=(const Array&) = default;
Array& Array::operator=(Array&&) noexcept = default;
Array::~Array() = default;

size_t element_size(ElementType t) {
  constexpr size_t sizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return sizes[size_t(t)];
}

std::string_view element_name(ElementType t) {
  constexpr std::string_view names[] = {"u8", "i8", "u16", "i16", "u32", "i32", "u64", "i64", "f32", "f64"};
  return names[size_t(t)];
}

bool parse_element_type(std::string_view name, ElementType& out) {
  struct Alias {
    ElementType type;
    std::string_view names;
  };
  static constexpr Alias aliases[] = {
      {ElementType::u8, "u8 uint8 uchar unsigned_char ubyte byte"},
      {ElementType::i8, "i8 int8 char schar signed_char"},
      {ElementType::u16, "u16 uint16 ushort unsigned_short"},
      {ElementType::i16, "i16 int16 short"},
      {ElementType::u32, "u32 uint32 uint unsigned_int"},
      {ElementType::i32, "i32 int32 int"},
      {ElementType::u64, "u64 uint64 ulong unsigned_long ulonglong"},
      {ElementType::i64, "i64 int64 long longlong vtktypeint64 vtkidtype"},
      {ElementType::f32, "f32 float32 float"},
      {ElementType::f64, "f64 float64 double"},
  };
  std::string key = to_lower(trim(name));
  for (char& c : key)
    if (c == ' ') c = '_';
  for (const Alias& a : aliases)
    for (std::string_view n : words(a.names))
      if (n == key) {
        out = a.type;
        return true;
      }
  return false;
}

Buffer Buffer::allocate(size_t bytes, std::byte** writable) {
  void* p = nullptr;
  detail::claim_memory(bytes);
  try {
    p = allocate_large(bytes);
  } catch (const std::bad_alloc&) {
    detail::return_memory(bytes);
    fail_data(fmt::format("not enough memory for {}", human_bytes(bytes)));
  }
  Buffer b;
  b.owner = std::shared_ptr<const void>(p, [bytes](const void* q) {
    free_large(const_cast<void*>(q), bytes);
    detail::return_memory(bytes);
  });
  b.data = static_cast<const std::byte*>(p);
  b.size = bytes;
  *writable = static_cast<std::byte*>(p);
  return b;
}

Array::Array(Buffer buffer, ElementType type, size_t count, int components)
    : Array(std::move(buffer), type, count, components, 0, ptrdiff_t(element_size(type)) * components, ptrdiff_t(element_size(type))) {}

Array::Array(Buffer buffer, ElementType type, size_t count, int components, size_t offset, ptrdiff_t stride, ptrdiff_t component_stride)
    : buffer_(std::move(buffer)),
      data_(buffer_.data + offset),
      count_(count),
      components_(components),
      type_(type),
      stride_(stride),
      component_stride_(component_stride) {
  if (components < 1) fail_internal("an array needs at least one component");
  if (count == 0) return;
  const auto size = ptrdiff_t(element_size(type));
  if (stride % size || component_stride % size) fail_internal("array strides must be multiples of the element size");
  // Every corner of the (tuple, component) rectangle must lie inside the buffer.
  using Wide = __int128;
  const Wide a = Wide(stride) * Wide(count - 1), b = Wide(component_stride) * (components - 1);
  const Wide lo = Wide(offset) + std::min<Wide>(a, 0) + std::min<Wide>(b, 0);
  const Wide hi = Wide(offset) + std::max<Wide>(a, 0) + std::max<Wide>(b, 0) + size;
  if (lo < 0 || hi > Wide(buffer_.size))
    fail_data(fmt::format("{} tuples of {} {} need more than the {} bytes available", count, components, element_name(type), buffer_.size));
}

Array Array::make_raw(ElementType type, size_t count, int components, std::byte** writable) {
  size_t n = 0;
  if (__builtin_mul_overflow(count, size_t(components), &n) || __builtin_mul_overflow(n, element_size(type), &n))
    fail_data(fmt::format("an array of {} tuples of {} exceeds any memory", count, components));
  return Array(Buffer::allocate(n, writable), type, count, components);
}

bool Array::packed() const {
  const auto size = ptrdiff_t(element_size(type_));
  return (components_ == 1 || component_stride_ == size) && stride_ == size * components_;  // of one there is no next component
}

double Array::get(size_t i, int c) const {
  return dispatch(*this, [&](auto v) { return double(v(i, c)); });
}

Array Array::component(int c) const {
  if (c < 0 || c >= components_) fail_internal(fmt::format("array has {} components; there is no component {}", components_, c));
  Array a = *this;
  if (a.data_) a.data_ += c * component_stride_;  // none of an empty array
  a.components_ = 1;
  return a;
}

Array Array::slice(size_t begin, size_t end) const {
  if (begin > end || end > count_) fail_internal(fmt::format("array has {} tuples; there are no tuples {} to {}", count_, begin, end));
  Array a = *this;
  if (a.data_) a.data_ += ptrdiff_t(begin) * stride_;
  a.count_ = end - begin;
  return a;
}

namespace {

template <class To, class From>
To convert(From v) {
  if constexpr (std::is_floating_point_v<To> || std::is_same_v<To, From>) {
    return To(v);
  } else if constexpr (std::is_floating_point_v<From>) {
    if (!(v == v)) return To(0);
    const From r = std::nearbyint(v);
    if (r <= From(std::numeric_limits<To>::min())) return std::numeric_limits<To>::min();
    if (r >= From(std::numeric_limits<To>::max())) return std::numeric_limits<To>::max();
    return To(r);
  } else {
    if (std::cmp_less(v, std::numeric_limits<To>::min())) return std::numeric_limits<To>::min();
    if (std::cmp_greater(v, std::numeric_limits<To>::max())) return std::numeric_limits<To>::max();
    return To(v);
  }
}

template <class To>
Array convert_to(const Array& a) {
  To* out = nullptr;
  Array r = Array::make<To>(a.count(), a.components(), &out);
  dispatch(a, [&](auto v) {
    const int n = v.components;
    parallel_for(v.count, 1 << 16, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        for (int c = 0; c < n; ++c) out[i * size_t(n) + size_t(c)] = convert<To>(v(i, c));
    });
  });
  return r;
}

}  // namespace

Array Array::converted(ElementType type) const {
  if (type == type_ && packed()) return *this;
  switch (type) {
    case ElementType::u8: return convert_to<uint8_t>(*this);
    case ElementType::i8: return convert_to<int8_t>(*this);
    case ElementType::u16: return convert_to<uint16_t>(*this);
    case ElementType::i16: return convert_to<int16_t>(*this);
    case ElementType::u32: return convert_to<uint32_t>(*this);
    case ElementType::i32: return convert_to<int32_t>(*this);
    case ElementType::u64: return convert_to<uint64_t>(*this);
    case ElementType::i64: return convert_to<int64_t>(*this);
    case ElementType::f32: return convert_to<float>(*this);
    case ElementType::f64: return convert_to<double>(*this);
  }
  fail_internal("converted: unknown element type");
}

void Array::wrong_type(ElementType asked) const {
  fail_internal(fmt::format("array of {} accessed as {}", element_name(type_), element_name(asked)));
}

}  // namespace sg
