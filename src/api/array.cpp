// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "api/held.h"

namespace sightglass {

static_assert(int(Type::u8) == int(sg::ElementType::u8) && int(Type::i32) == int(sg::ElementType::i32) &&
              int(Type::u64) == int(sg::ElementType::u64) && int(Type::f64) == int(sg::ElementType::f64));
static_assert(type_of<uint8_t>() == Type::u8 && type_of<int32_t>() == Type::i32 && type_of<long>() == Type::i64);

namespace {

std::shared_ptr<const Array::Held> no_numbers() {
  static const auto empty = std::make_shared<const Array::Held>();
  return empty;
}

}  // namespace

Array::Array() : held_(no_numbers()) {}
Array::Array(std::shared_ptr<const Held> held) : held_(held ? std::move(held) : no_numbers()) {}

Array Array::wrap_raw(const void* data, Type type, size_t bytes, size_t count, int components, size_t stride,
                      std::shared_ptr<const void> owner) {
  return guarded([&] {
    const auto element = sg::ElementType(int(type));
    const size_t size = sg::element_size(element);
    if (components < 1) sg::fail_usage(fmt::format("{} is not a number of components", components), "sightglass::Array", "1 or more");
    if (stride == 0 && bytes != count * size_t(components) * size)
      sg::fail_usage(fmt::format("{} numbers are no tuples of {}", bytes / size, components), "sightglass::Array",
                     "the numbers of a tuple lie one after the other");
    if (stride % size != 0 || (stride > 0 && stride < size_t(components) * size && count > 1))
      sg::fail_usage(fmt::format("a stride of {} bytes between tuples of {} {}", stride, components, sg::element_name(element)),
                     "sightglass::Array", fmt::format("a multiple of {} bytes, at least the size of a tuple", size));
    sg::Buffer buffer{std::move(owner), static_cast<const std::byte*>(data), bytes};
    const auto step = ptrdiff_t(stride ? stride : size_t(components) * size);
    return Array(std::make_shared<const Held>(Held{sg::Array(std::move(buffer), element, count, components, 0, step, ptrdiff_t(size))}));
  });
}

Type Array::type() const { return Type(int(held_->array.type())); }
size_t Array::count() const { return held_->array.count(); }
int Array::components() const { return held_->array.components(); }

double Array::get(size_t tuple, int component) const {
  return guarded([&] {
    if (tuple >= count() || component < 0 || component >= components())
      sg::fail_usage(fmt::format("there is no number {} of tuple {}", component, tuple), "sightglass::Array",
                     fmt::format("there are {} tuples of {}", count(), components()));
    return held_->array.get(tuple, component);
  });
}

const void* Array::raw(Type type) const {
  return guarded([&]() -> const void* {
    if (count() == 0) return nullptr;
    if (type != this->type())
      sg::fail_usage(
          fmt::format("the numbers are {}, not {}", sg::element_name(held_->array.type()), sg::element_name(sg::ElementType(int(type)))),
          "sightglass::Array", "type() says what they are; numbers() gives doubles");
    if (!held_->array.packed()) sg::fail_usage("the numbers lie apart", "sightglass::Array", "numbers() gives a copy, get() one of them");
    return held_->array.raw();
  });
}

std::vector<double> Array::numbers() const {
  return guarded([&] {
    if (count() == 0) return std::vector<double>();
    const sg::Array packed = held_->array.converted(sg::ElementType::f64);
    const auto* begin = reinterpret_cast<const double*>(packed.raw());
    return std::vector<double>(begin, begin + packed.count() * size_t(packed.components()));
  });
}

}  // namespace sightglass
