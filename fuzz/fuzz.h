// SPDX-License-Identifier: Apache-2.0
// What the fuzz target and the test of its seeds share.
#pragma once
#include <string>

#include "base/text/text.h"
#include "bundle.h"
#include "io/io.h"

namespace sg::fuzz {

/// "VTK XML" -> "vtk-xml": the name of the corpus folder.
inline std::string slug(std::string_view name) {
  std::string s = to_lower(name);
  for (char& c : s)
    if (!((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'))) c = '-';
  return s;
}

/// The name under which a seed of the format is read.
inline std::string file_name(const Format& f) {
  const auto extensions = words(f.extensions);
  return "seed." + std::string(extensions.empty() ? "bin" : extensions[0]);
}

/// A raw brick says nothing of itself: its first byte gives the type, its size the dimensions.
inline ReadOptions options_of(const Format& f, std::string_view bytes) {
  ReadOptions options;
  if (slug(f.name) != "raw-brick" || bytes.empty()) return options;
  static constexpr const char* types[] = {"u8", "i16", "u32", "i64", "f32", "f64", "none", "u16"};
  static constexpr size_t sizes[] = {1, 2, 4, 8, 4, 8, 1, 2};
  const auto first = static_cast<unsigned char>(bytes[0]);
  options.raw_type = types[first & 7];
  options.raw_header = 1;
  options.raw_big_endian = first & 8;
  options.raw_components = 1 + (first >> 6);
  const size_t count = (bytes.size() - 1) / sizes[first & 7] / size_t(options.raw_components);
  options.raw_dims = count % 2 ? std::array<size_t, 3>{count, 1, 1} : std::array<size_t, 3>{2, count / 2, 1};
  return options;
}

/// One of the rarer ways of reading, chosen by `which`: the header alone, a region, a step with few fields, a piece.
inline ReadOptions rarer_options_of(const Format& f, std::string_view bytes, size_t which) {
  ReadOptions options = options_of(f, bytes);
  switch (which % 4) {
    case 0: options.header_only = true; break;
    case 1: options.region.lo = {1, 0, 0}, options.region.hi = {2, 5, SIZE_MAX}, options.region.stride = {1, 2, 1}; break;
    case 2: options.step = 1, options.fields = {"T"}; break;
    default: options.piece = 1, options.pieces = 3, options.ghost_levels = 1;
  }
  return options;
}

/// Touches every number, so that a sanitizer sees an array that is longer than its bytes.
inline void look_at(const Data& data) {
  for_each_dataset(data, [](const std::string&, const DatasetPtr& d) {
    (void)d->bounds();
    (void)cell_type_counts(d->mesh());
    for (const Field& f : d->fields()) (void)d->stats(f);
  });
  if (auto* table = std::get_if<TablePtr>(&data))
    for (const Field& f : (*table)->columns) (void)field_stats(f.array);
}

}  // namespace sg::fuzz
