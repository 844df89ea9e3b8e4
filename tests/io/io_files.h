// SPDX-License-Identifier: Apache-2.0
// Helpers of the file tests: texts written to a temporary file and read back, and damage done to them.
#pragma once
#include <algorithm>
#include <cstring>
#include <string>

#include "base/file/file.h"
#include "base/parallel.h"
#include "data/dataset.h"
#include "io/io.h"
#include "support/same_data.h"
#include "support/test.h"

namespace sg::test {

/// Writes `bytes` into the temporary folder under `name` and returns the path.
inline std::string temp_file(const std::string& name, std::string_view bytes) {
  const std::string path = temp_folder() + name;
  write_file(path, bytes);
  return path;
}

/// An empty folder in the temporary folder; without trailing '/'.
inline std::string empty_folder(const std::string& name) {
  std::string path = fresh_folder(name);
  path.pop_back();
  return path;
}

inline Data read_any(const std::string& path, const ReadOptions& options = {}) {
  Context context;
  return read_data(path, options, context);
}
/// Of bytes that are written into the temporary folder under `name` first.
inline Data read_bytes(const std::string& name, std::string_view bytes, const ReadOptions& options = {}) {
  return read_any(temp_file(name, bytes), options);
}
inline DatasetPtr read_file(const std::string& path, const ReadOptions& options = {}) {
  return std::get<DatasetPtr>(read_any(path, options));
}
inline DatasetPtr read_text(const std::string& name, std::string_view bytes, const ReadOptions& options = {}) {
  return read_file(temp_file(name, bytes), options);
}

inline const SurfaceMesh& surface_of(const DatasetPtr& d) { return std::get<SurfaceMesh>(d->mesh()); }

/// Reading with header_only gives the same meshes, and fields of the same names, types, sizes, units and roles as reading all. Returns
/// the number of fields.
inline size_t check_names_alone(const std::string& path, ReadOptions options = {}) {
  Context context;
  std::vector<DatasetPtr> full, quick;
  for_each_dataset(read_data(path, options, context), [&](const std::string&, const DatasetPtr& d) { full.push_back(d); });
  options.header_only = true;
  for_each_dataset(read_data(path, options, context), [&](const std::string&, const DatasetPtr& d) { quick.push_back(d); });
  REQUIRE(full.size() == quick.size());
  size_t fields = 0;
  for (size_t i = 0; i < full.size(); ++i) {
    CHECK(full[i]->point_count() == quick[i]->point_count());
    CHECK(full[i]->cell_count() == quick[i]->cell_count());
    REQUIRE(full[i]->fields().names() == quick[i]->fields().names());
    for (const Field& f : full[i]->fields()) {
      CAPTURE(f.name);
      const Field* g = quick[i]->fields().find(f.name, f.association);
      REQUIRE(g);
      CHECK(g->array.type() == f.array.type());
      CHECK(g->array.count() == f.array.count());
      CHECK(g->components() == f.components());
      CHECK(g->unit == f.unit);
      CHECK(g->role == f.role);
      ++fields;
    }
  }
  CHECK(fields > 0);
  return fields;
}

/// The message of the error that reading gives.
inline std::string refusal(const std::string& name, std::string_view bytes, const ReadOptions& options = {}) {
  return error_of([&] { read_text(name, bytes, options); });
}

/// Reads the first k/64 of the bytes for k = 1..63 and the file with each 1/64th byte changed: every time an Error or a valid
/// dataset. Returns how many of the 63 cut files were refused.
inline int cut_and_damage(const std::string& name, const std::string& bytes) {
  int refused = 0;
  Context context;
  for (size_t k = 1; k < 64; ++k) {
    const std::string path = temp_file(name, std::string_view(bytes).substr(0, bytes.size() * k / 64));
    try {
      read_data(path, {}, context);
    } catch (const Error& e) {
      CHECK(e.kind() == ErrorKind::data);
      ++refused;
    }
  }
  for (size_t k = 0; k < 64; ++k)
    for (const char with : {'\xff', '9', '\0'}) {
      std::string damaged = bytes;
      damaged[bytes.size() * k / 64] = with;
      const std::string path = temp_file(name, damaged);
      try {
        read_data(path, {}, context);
      } catch (const Error& e) {
        CHECK((e.kind() == ErrorKind::data || e.kind() == ErrorKind::usage));
      }
    }
  return refused;
}

/// Calls make() with 1 and with 4 threads.
template <class F>
auto with_threads(int n, F&& make) {
  set_thread_count(n);
  auto r = make();
  set_thread_count(0);
  return r;
}

/// Numbers as bytes in either order.
template <class T>
void put_bytes(std::string& s, T v, bool big_endian = false) {
  char b[sizeof(T)];
  std::memcpy(b, &v, sizeof(T));
  if (big_endian) std::reverse(b, b + sizeof(T));
  s.append(b, sizeof(T));
}

}  // namespace sg::test
