// SPDX-License-Identifier: Apache-2.0
// Small CGNS files for the tests, written node by node through the CGNS library, which is looked for when the test runs.
#pragma once
#include <dlfcn.h>

#include <string>
#include <vector>

#include "support/test.h"

namespace sg::test {

/// The few functions of the library's node layer that are needed; `good` is false where it is not installed.
struct CgnsLibrary {
  int (*open)(const char*, int mode, int type, int* file) = nullptr;
  int (*close)(int file) = nullptr;
  int (*root)(int file, double* id) = nullptr;
  int (*create)(int file, double parent, const char* name, double* id) = nullptr;
  int (*label)(int file, double id, const char* label) = nullptr;
  int (*dimensions)(int file, double id, const char* type, int n, const int* dims) = nullptr;
  int (*write)(int file, double id, const void* data) = nullptr;
  int (*link)(int file, double parent, const char* name, const char* other, const char* there, double* id) = nullptr;
  bool good = false;

  static const CgnsLibrary& get() {
    static const CgnsLibrary library = [] {
      CgnsLibrary l;
      void* handle = nullptr;
      for (const char* name : {"libcgns.so.3.4", "libcgns.so"})
        if (!handle) handle = ::dlopen(name, RTLD_NOW | RTLD_LOCAL);
      if (!handle) return l;
      const auto find = [&](const char* name, auto& f) {
        f = reinterpret_cast<std::remove_reference_t<decltype(f)>>(::dlsym(handle, name));
      };
      find("cgio_open_file", l.open), find("cgio_close_file", l.close), find("cgio_get_root_id", l.root);
      find("cgio_create_node", l.create), find("cgio_set_label", l.label), find("cgio_set_dimensions", l.dimensions);
      find("cgio_write_all_data", l.write), find("cgio_create_link", l.link);
      l.good = l.open && l.close && l.root && l.create && l.label && l.dimensions && l.write && l.link;
      return l;
    }();
    return library;
  }
};
inline bool no_cgns() { return !CgnsLibrary::get().good; }

/// A file in the making. Ids of nodes are returned as parents of others.
class CgnsFile {
 public:
  CgnsFile(const std::string& path, bool hdf5) {
    REQUIRE(lib_.open(path.c_str(), 1, hdf5 ? 2 : 1, &file_) == 0);
    lib_.root(file_, &root_);
    add(root_, "CGNSLibraryVersion", "CGNSLibraryVersion_t", std::vector<float>{3.4f});
  }
  ~CgnsFile() { close(); }
  void close() {
    if (file_ >= 0) lib_.close(file_);
    file_ = -1;
  }
  double base(const std::string& name, int cell_dimension, int dimension) {
    return add(root_, name, "CGNSBase_t", std::vector<int>{cell_dimension, dimension});
  }
  double zone(double base, const std::string& name, const std::string& type, const std::vector<int>& size, int rank) {
    const double z = add(base, name, "Zone_t", size, {rank, 3});
    text(z, "ZoneType", "ZoneType_t", type);
    return z;
  }
  double node(double parent, const std::string& name, const std::string& label) {
    double id = 0;
    REQUIRE(lib_.create(file_, parent, name.c_str(), &id) == 0);
    std::string whole = label;
    whole.resize(33);  // the library takes so many bytes, whatever their length
    REQUIRE(lib_.label(file_, id, whole.c_str()) == 0);
    return id;
  }
  double text(double parent, const std::string& name, const std::string& label, const std::string& value, std::vector<int> dims = {}) {
    const double id = node(parent, name, label);
    if (dims.empty()) dims = {int(value.size())};
    REQUIRE(lib_.dimensions(file_, id, "C1", int(dims.size()), dims.data()) == 0);
    REQUIRE(lib_.write(file_, id, value.data()) == 0);
    return id;
  }
  template <class T>
  double add(double parent, const std::string& name, const std::string& label, const std::vector<T>& values, std::vector<int> dims = {}) {
    const double id = node(parent, name, label);
    if (dims.empty()) dims = {int(values.size())};
    const char* type = std::is_same_v<T, int> ? "I4" : std::is_same_v<T, float> ? "R4" : std::is_same_v<T, double> ? "R8" : "I8";
    REQUIRE(lib_.dimensions(file_, id, type, int(dims.size()), dims.data()) == 0);
    REQUIRE(lib_.write(file_, id, values.data()) == 0);
    return id;
  }
  void section(double zone, const std::string& name, int type, int first, int last, const std::vector<int>& ids,
               const std::vector<int>& starts = {}) {
    const double s = add(zone, name, "Elements_t", std::vector<int>{type, 0});
    add(s, "ElementRange", "IndexRange_t", std::vector<int>{first, last});
    add(s, "ElementConnectivity", "DataArray_t", ids);
    if (!starts.empty()) add(s, "ElementStartOffset", "DataArray_t", starts);
  }
  void link(double parent, const std::string& name, const std::string& file, const std::string& there) {
    double id = 0;
    REQUIRE(lib_.link(file_, parent, name.c_str(), file.c_str(), there.c_str(), &id) == 0);
  }
  /// Coordinates k, 10k, 100k of n vertices.
  void line_of_points(double zone, int n) {
    const double g = node(zone, "GridCoordinates", "GridCoordinates_t");
    const char* names[] = {"CoordinateX", "CoordinateY", "CoordinateZ"};
    double factor = 1;
    for (const char* name : names) {
      std::vector<double> v;
      for (int k = 0; k < n; ++k) v.push_back(factor * k);
      add(g, name, "DataArray_t", v);
      factor *= 10;
    }
  }

 private:
  const CgnsLibrary& lib_ = CgnsLibrary::get();
  int file_ = -1;
  double root_ = 0;
};

}  // namespace sg::test
