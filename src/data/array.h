// SPDX-License-Identifier: Apache-2.0
// Buffer and Array: bytes with an owner, and numbers in them. The layout is data, not a template parameter.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/error.h"

namespace sg {

enum class ElementType : uint8_t { u8, i8, u16, i16, u32, i32, u64, i64, f32, f64 };
size_t element_size(ElementType t);
/// "u8" ... "f64".
std::string_view element_name(ElementType t);
inline bool is_float(ElementType t) { return t == ElementType::f32 || t == ElementType::f64; }
/// Accepts our names, NumPy's and VTK's ("f32", "float", "float32", "Float32", "unsigned_char", "uchar", ...).
bool parse_element_type(std::string_view name, ElementType& out);

template <class T>
constexpr ElementType element_type_of() {
  using U = std::remove_cv_t<T>;
  if constexpr (std::is_same_v<U, uint8_t>) return ElementType::u8;
  else if constexpr (std::is_same_v<U, int8_t>) return ElementType::i8;
  else if constexpr (std::is_same_v<U, uint16_t>) return ElementType::u16;
  else if constexpr (std::is_same_v<U, int16_t>) return ElementType::i16;
  else if constexpr (std::is_same_v<U, uint32_t>) return ElementType::u32;
  else if constexpr (std::is_same_v<U, int32_t>) return ElementType::i32;
  else if constexpr (std::is_integral_v<U> && sizeof(U) == 8 && std::is_unsigned_v<U>) return ElementType::u64;
  else if constexpr (std::is_integral_v<U> && sizeof(U) == 8) return ElementType::i64;
  else if constexpr (std::is_same_v<U, float>) return ElementType::f32;
  else {
    static_assert(std::is_same_v<U, double>, "not an element type");
    return ElementType::f64;
  }
}

/// Bytes with an owner: our memory, a mapped file, NumPy, a running simulation.
struct Buffer {
  std::shared_ptr<const void> owner;
  const std::byte* data = nullptr;
  size_t size = 0;

  /// Uninitialised memory, 64-byte aligned; above 4 MB on huge pages. Throws Error(data) when there is not enough.
  /// `writable` receives the address, for filling it.
  static Buffer allocate(size_t bytes, std::byte** writable);
};

/// What a kernel sees: v(i, c), strides in elements. Plain data, valid on the device too.
template <class T>
struct View {
  const T* data = nullptr;
  size_t count = 0;
  int components = 1;
  ptrdiff_t stride = 1;            ///< elements from one tuple to the next
  ptrdiff_t component_stride = 1;  ///< elements from one component to the next

  T operator()(size_t i, int c = 0) const { return data[ptrdiff_t(i) * stride + c * component_stride]; }
  T operator[](size_t i) const { return data[ptrdiff_t(i) * stride]; }
  /// Tuples lie one after the other without gaps.
  bool packed() const { return component_stride == 1 && stride == components; }
};

/// `count` tuples of `components` numbers of one type, anywhere in a buffer. Immutable once shared.
class Array {
 public:
  Array() = default;
  // Out of line, as in all that holds arrays: inlined in every file they cost time to compile and size.
  Array(const Array&);
  Array(Array&&) noexcept;
  Array& operator=(const Array&);
  Array& operator=(Array&&) noexcept;
  ~Array();
  /// Packed tuples at the start of `buffer`; throws Error(data) when the buffer is too small.
  Array(Buffer buffer, ElementType type, size_t count, int components = 1);
  /// Any layout: byte offset of the first number and byte strides (multiples of the element size).
  Array(Buffer buffer, ElementType type, size_t count, int components, size_t offset, ptrdiff_t stride, ptrdiff_t component_stride);

  /// Uninitialised packed array; `writable` receives its address.
  template <class T>
  static Array make(size_t count, int components, T** writable) {
    std::byte* p = nullptr;
    Array a = make_raw(element_type_of<T>(), count, components, &p);
    *writable = reinterpret_cast<T*>(p);
    return a;
  }
  static Array make_raw(ElementType type, size_t count, int components, std::byte** writable);
  /// Takes the vector over without a copy.
  template <class T>
  static Array from_vector(std::vector<T> values, int components = 1) {
    auto owner = std::make_shared<const std::vector<T>>(std::move(values));
    Buffer b{owner, reinterpret_cast<const std::byte*>(owner->data()), owner->size() * sizeof(T)};
    return Array(std::move(b), element_type_of<T>(), owner->size() / size_t(components), components);
  }

  ElementType type() const { return type_; }
  size_t count() const { return count_; }
  int components() const { return components_; }
  bool empty() const { return count_ == 0; }
  bool packed() const;
  /// Bytes of the numbers (not of the buffer).
  size_t bytes() const { return count_ * size_t(components_) * element_size(type_); }
  const Buffer& buffer() const { return buffer_; }
  const std::byte* raw() const { return data_; }
  ptrdiff_t stride_bytes() const { return stride_; }
  ptrdiff_t component_stride_bytes() const { return component_stride_; }

  /// Throws an internal Error when T is not the element type.
  template <class T>
  View<T> view() const {
    if (element_type_of<T>() != type_) wrong_type(element_type_of<T>());
    constexpr ptrdiff_t s = sizeof(T);
    return {reinterpret_cast<const T*>(data_), count_, components_, stride_ / s, component_stride_ / s};
  }
  /// One number as double (64-bit integers round). For tests, printing and small loops; kernels use view().
  double get(size_t i, int c = 0) const;
  /// One component as an array of its own, sharing the bytes.
  Array component(int c) const;
  /// Tuples [begin, end), sharing the bytes.
  Array slice(size_t begin, size_t end) const;
  /// Same bytes when already packed and of that type, else a converted copy. Float to integer rounds and clamps.
  Array converted(ElementType type) const;
  Array made_packed() const { return packed() ? *this : converted(type_); }

 private:
  [[noreturn]] void wrong_type(ElementType asked) const;
  Buffer buffer_;
  const std::byte* data_ = nullptr;
  size_t count_ = 0;
  int components_ = 1;
  ElementType type_ = ElementType::f32;
  ptrdiff_t stride_ = 4, component_stride_ = 4;  // bytes
};

/// Calls f(View<T>) with the array's own element type: the one template axis of a kernel.
template <class F>
decltype(auto) dispatch(const Array& a, F&& f) {
  switch (a.type()) {
    case ElementType::u8: return f(a.view<uint8_t>());
    case ElementType::i8: return f(a.view<int8_t>());
    case ElementType::u16: return f(a.view<uint16_t>());
    case ElementType::i16: return f(a.view<int16_t>());
    case ElementType::u32: return f(a.view<uint32_t>());
    case ElementType::i32: return f(a.view<int32_t>());
    case ElementType::u64: return f(a.view<uint64_t>());
    case ElementType::i64: return f(a.view<int64_t>());
    case ElementType::f32: return f(a.view<float>());
    case ElementType::f64: return f(a.view<double>());
  }
  fail_internal("dispatch: unknown element type");
}

/// A list of indices that is i32 or i64; the branch predicts well, so kernels need no template for it.
struct IndexView {
  const void* data = nullptr;
  bool wide = true;
  int64_t operator[](size_t i) const { return wide ? static_cast<const int64_t*>(data)[i] : static_cast<const int32_t*>(data)[i]; }
};

}  // namespace sg
