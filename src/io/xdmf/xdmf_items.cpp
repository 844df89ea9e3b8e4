// SPDX-License-Identifier: Apache-2.0
// XDMF: the values of DataItems.
#include <fmt/core.h>

#include "base/bytes.h"
#include "base/file/file_fence.h"
#include "base/text/text.h"
#include "io/plugin.h"
#include "io/text/text_scan.h"
#include "io/xdmf/xdmf.h"

namespace sg::xdmf {

size_t product(const std::vector<size_t>& dims, const std::string& where) {
  uint64_t n = 1;
  for (const size_t d : dims)
    if (!multiply(n, d, n) || n > (uint64_t(1) << 60)) fail_data("has too many numbers to count", where);
  return n;
}

std::vector<size_t> dimensions(const Document& doc, pugi::xml_node node, const char* name) {
  std::vector<size_t> r;
  const std::string text = doc.with_entities(std::string(attribute(node, name)));
  for (const std::string_view w : words(text)) {
    const auto v = parse_int(w);
    if (!v || *v < 0 || r.size() >= 32) doc.fail(fmt::format("has {}=\"{}\"", name, text), node, "whole numbers");
    r.push_back(size_t(*v));
  }
  return r;
}

namespace {

// Version 1 names the type of the numbers and the kind of the item by the same attribute.
bool is_kind_of_item(std::string_view word) {
  for (const char* kind : {"uniform", "collection", "tree", "hyperslab", "coordinates", "function"})
    if (equal_ignoring_case(word, kind)) return true;
  return false;
}

}  // namespace

ElementType number_type(const Document& doc, pugi::xml_node node) {
  std::string type = to_lower(attribute(node, "NumberType", "DataType"));
  if (const std::string_view oldest = attribute(node, "Type"); type.empty() && !is_kind_of_item(oldest)) type = to_lower(oldest);
  const std::string_view precision_text = attribute(node, "Precision");
  int64_t size = type == "char" || type == "uchar" ? 1 : type == "short" || type == "ushort" ? 2 : 4;
  if (!precision_text.empty()) size = parse_int(precision_text).value_or(0);
  const bool is_unsigned = type.starts_with('u');
  if (type.empty() || type == "float") {
    if (size == 4) return ElementType::f32;
    if (size == 8) return ElementType::f64;
  } else if (type == "int" || type == "uint" || type == "char" || type == "uchar" || type == "short" || type == "ushort") {
    if (size == 1) return is_unsigned ? ElementType::u8 : ElementType::i8;
    if (size == 2) return is_unsigned ? ElementType::u16 : ElementType::i16;
    if (size == 4) return is_unsigned ? ElementType::u32 : ElementType::i32;
    if (size == 8) return is_unsigned ? ElementType::u64 : ElementType::i64;
  }
  doc.fail(fmt::format("has numbers of type '{}' and precision '{}'", type, precision_text), node,
           "use Float, Int, UInt, Char or UChar of 1, 2, 4 or 8 bytes");
}

Item Document::inline_item(pugi::xml_node n, const std::vector<size_t>& dims, std::optional<ElementType> type) const {
  std::string joined;
  std::string_view text;
  for (const pugi::xml_node& part : n.children()) {
    if (part.type() != pugi::node_pcdata && part.type() != pugi::node_cdata) continue;
    if (text.empty()) {
      text = part.value();
    } else {
      if (joined.empty()) joined = text;
      text = joined += part.value();
    }
  }
  const size_t count = product(dims, where(n));
  if (count > text.size() / 2 + 1) fail(fmt::format("has {} characters for {} numbers", text.size(), count), n, "the file is truncated");
  const auto at = size_t(std::max<ptrdiff_t>(n.offset_debug(), 0));
  const size_t line = line_number(file_.text(), std::min(at, file_.size()));
  return {parse_numbers(text, type ? *type : number_type(*this, n), count, 1, path_, line - 1), dims};
}

Item Document::binary_item(pugi::xml_node n, const std::vector<size_t>& dims) const {
  const std::string_view packing = attribute(n, "Compression");
  if (!packing.empty() && !equal_ignoring_case(packing, "Raw"))
    fail(fmt::format("is packed with '{}', which is not supported", packing), n, "Raw");
  const std::string name = with_entities(std::string(trim(n.child_value())));
  const ElementType type = number_type(*this, n);
  uint64_t bytes = 0, end = 0;
  const std::string_view seek_text = attribute(n, "Seek");
  const auto seek = seek_text.empty() ? std::optional<int64_t>(0) : parse_int(seek_text);
  if (!seek || *seek < 0) fail(fmt::format("has Seek=\"{}\"", seek_text), n, "it must be the byte at which the numbers begin");
  const MappedFile file(named_file(path_, name));
  if (!multiply(product(dims, where(n)), element_size(type), bytes) || !add(bytes, uint64_t(*seek), end) || end > file.size())
    fail(fmt::format("needs {} bytes from byte {} on, but '{}' has {}", bytes, *seek, name, file.size()), n, "the file is truncated");
  const std::byte* from = file.data() + *seek;
  const size_t count = bytes / element_size(type);
  if (equal_ignoring_case(attribute(n, "Endian"), "Big")) {
    std::byte* out = nullptr;
    Item item{Array::make_raw(type, count, 1, &out), dims};
    if (bytes > 0) swap_bytes_copy(out, from, count, element_size(type));
    return item;
  }
  if (reinterpret_cast<uintptr_t>(from) % element_size(type) == 0) return {Array(Buffer{file.owner(), from, bytes}, type, count), dims};
  std::byte* out = nullptr;
  Item item{Array::make_raw(type, count, 1, &out), dims};
  if (bytes > 0) file.copy_to(out, size_t(*seek), bytes);
  return item;
}

Item Document::hdf_item(pugi::xml_node n, const std::vector<size_t>& dims, const Item* slab) const {
  const std::string text = with_entities(std::string(trim(n.child_value())));
  if (text.find('|') != text.npos)
    fail("selects parts of several HDF5 datasets by '|', which is not supported", n, "ItemType=\"HyperSlab\"");
  size_t colon = text.find(":/", 1);
  if (colon == text.npos) colon = text.rfind(':');
  if (colon == text.npos || colon == 0 || colon + 1 >= text.size())
    fail(fmt::format("names '{}'", text.substr(0, 80)), n, "FILE.h5:/DATASET");
  PluginSelection wanted{text.substr(colon + 1), {}, {}, {}};
  if (slab) {
    if (slab->count() == 0 || slab->count() % 3)
      fail(fmt::format("has a selection of {} numbers", slab->count()), n, "expected start, stride and count");
    const size_t rank = slab->count() / 3;
    for (size_t a = 0; a < rank; ++a) {
      wanted.start.push_back(size_t(slab->values.get(a)));
      wanted.stride.push_back(size_t(slab->values.get(rank + a)));
      wanted.count.push_back(size_t(slab->values.get(2 * rank + a)));
    }
  }
  const auto array = plugin_format("hdf5", "array").array;
  const PluginArray a =
      with_context(fmt::format("reading {}", where(n)), [&] { return array(named_file(path_, text.substr(0, colon)), wanted, context_); });
  if (!slab && !dims.empty() && product(dims, where(n)) != a.values.count())
    fail(fmt::format("announces {} numbers, but '{}' has {}", product(dims, where(n)), text, a.values.count()), n);
  return {a.values, slab ? a.dims : dims.empty() ? a.dims : dims};
}

namespace {

// The block of `from` that start, stride and count say (three lists of equal length, one after the other).
Item slice(const Document& doc, pugi::xml_node n, const Item& from, const Item& slab) {
  const size_t rank = from.dims.size();
  if (slab.count() != 3 * rank) doc.fail(fmt::format("has {} numbers to select from {} dimensions", slab.count(), rank), n);
  std::vector<size_t> start(rank), stride(rank), count(rank), step(rank, 1);
  for (size_t a = rank; a-- > 1;) step[a - 1] = step[a] * from.dims[a];
  size_t total = 1;
  for (size_t a = 0; a < rank; ++a) {
    start[a] = size_t(slab.values.get(a)), stride[a] = size_t(slab.values.get(rank + a)), count[a] = size_t(slab.values.get(2 * rank + a));
    uint64_t last = 0;
    if (count[a] > from.dims[a] ||
        (count[a] > 0 && (!multiply(count[a] - 1, stride[a], last) || !add(last, start[a], last) || last >= from.dims[a])))
      doc.fail(fmt::format("selects up to index {} of {}", last, from.dims[a]), n);
    total *= count[a];
  }
  const size_t size = element_size(from.values.type());
  std::byte* out = nullptr;
  Item item{Array::make_raw(from.values.type(), total, 1, &out), count};
  const Array packed = from.values.made_packed();
  std::vector<size_t> i(rank, 0);
  for (size_t k = 0; k < total; ++k) {
    size_t at = 0;
    for (size_t a = 0; a < rank; ++a) at += (start[a] + i[a] * stride[a]) * step[a];
    std::memcpy(out + k * size, packed.raw() + at * size, size);
    for (size_t a = rank; a-- > 0;) {
      if (++i[a] < count[a]) break;
      i[a] = 0;
    }
  }
  return item;
}

}  // namespace

std::vector<pugi::xml_node> Document::parts_of(pugi::xml_node n, size_t count) const {
  auto parts = children(n, "DataItem");
  if (parts.size() != count) fail(fmt::format("has {} items", parts.size()), n, "expected the selection and the array");
  return parts;
}

// The numbers that select, as i64. They stand for places also where no type is given, which else means floats.
Item Document::selection(pugi::xml_node n, int depth) const {
  Item slab;
  const std::string_view format = attribute(n, "Format");
  const bool typed = !attribute(n, "NumberType", "DataType").empty() || !attribute(n, "Type", "ItemType").empty();
  if (!typed && (format.empty() || equal_ignoring_case(format, "XML")))
    slab = inline_item(n, dimensions(*this, n, "Dimensions"), ElementType::f64);
  else slab = item(n, depth);
  slab.values = slab.values.converted(ElementType::i64);
  for (size_t i = 0; i < slab.count(); ++i)
    if (slab.values.view<int64_t>()(i) < 0) fail("selects negative indices", n);
  return slab;
}

// An item's own dimensions leave out those of which one index is taken.
Item Document::with_dimensions(Item r, pugi::xml_node n) const {
  if (std::vector<size_t> dims = dimensions(*this, n, "Dimensions"); !dims.empty()) {
    if (product(dims, where(n)) != r.count())
      fail(fmt::format("announces {} numbers but selects {}", product(dims, where(n)), r.count()), n);
    r.dims = std::move(dims);
  }
  return r;
}

Item Document::hyperslab(pugi::xml_node n, int depth) const {
  const auto parts = parts_of(n, 2);
  const Item slab = selection(parts[0], depth + 1);
  const bool hdf = equal_ignoring_case(attribute(parts[1], "Format"), "HDF") && !is_kind_of_item(attribute(parts[1], "ItemType", "Type"));
  return with_dimensions(hdf ? hdf_item(parts[1], {}, &slab) : slice(*this, n, item(parts[1], depth + 1), slab), n);
}

// Single numbers of an array, by their indices along its dimensions.
Item Document::coordinates(pugi::xml_node n, int depth) const {
  const auto parts = parts_of(n, 2);
  const Item places = selection(parts[0], depth + 1), from = item(parts[1], depth + 1);
  const size_t rank = from.dims.size(), size = element_size(from.values.type());
  if (rank == 0 || places.count() % rank != 0) fail(fmt::format("has {} numbers to select from {} dimensions", places.count(), rank), n);
  const size_t count = places.count() / rank;
  const Array packed = from.values.made_packed();
  const auto at = places.values.view<int64_t>();
  std::byte* out = nullptr;
  Item r{Array::make_raw(packed.type(), count, 1, &out), {count}};
  for (size_t i = 0; i < count; ++i) {
    size_t place = 0;
    for (size_t a = 0; a < rank; ++a) {
      const auto k = size_t(at(i * rank + a));
      if (k >= from.dims[a]) fail(fmt::format("selects index {} of {}", k, from.dims[a]), n);
      place = place * from.dims[a] + k;
    }
    std::memcpy(out + i * size, packed.raw() + place * size, size);
  }
  return with_dimensions(std::move(r), n);
}

Item Document::function(pugi::xml_node n, int depth) const {
  std::vector<Item> arguments;
  for (const pugi::xml_node& part : children(n, "DataItem")) arguments.push_back(item(part, depth + 1));
  Item r = evaluate_function(attribute(n, "Function"), arguments, where(n));
  if (std::vector<size_t> dims = dimensions(*this, n, "Dimensions"); !dims.empty()) {
    if (product(dims, where(n)) != r.count()) fail(fmt::format("announces {} numbers but gives {}", product(dims, where(n)), r.count()), n);
    r.dims = std::move(dims);
  }
  return r;
}

Item Document::item(pugi::xml_node n, int depth) const {
  context_.check();
  if (depth > 8) fail("nests items too deeply", n);
  std::string kind = to_lower(attribute(n, "ItemType", "Type"));
  if (!is_kind_of_item(kind) && !find_attribute(n, "ItemType")) kind.clear();
  if (kind.empty() && (is_named(n, "DataTransform") || (is_named(n, "DataItem") && find_attribute(n, "Function")))) kind = "function";
  if (kind == "coordinates") return coordinates(n, depth);
  if (kind == "hyperslab") return hyperslab(n, depth);
  if (kind == "function") return function(n, depth);
  if (!kind.empty() && kind != "uniform")
    fail(fmt::format("is an item of type '{}', which is not supported", kind), n, "use Uniform, HyperSlab, Coordinates or Function");
  const std::vector<size_t> dims = dimensions(*this, n, "Dimensions");
  const std::string format = to_lower(attribute(n, "Format"));
  if (format == "hdf" || format == "hdf5" || format == "h5") return hdf_item(n, dims, nullptr);
  if (dims.empty()) fail("has no Dimensions", n);
  if (format.empty() || format == "xml") return inline_item(n, dims);
  if (format == "binary") return binary_item(n, dims);
  fail(fmt::format("has the format '{}'", format), n, "use XML, Binary or HDF");
}

}  // namespace sg::xdmf
