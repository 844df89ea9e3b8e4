// SPDX-License-Identifier: Apache-2.0
// Small HDF5 files made by the library, for tests.
#pragma once
#include <hdf5.h>

#include <string>
#include <vector>

#include "io/io_files.h"

namespace sg::test {

template <class T>
hid_t h5_type() {
  if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
  else if constexpr (std::is_same_v<T, float>) return H5T_NATIVE_FLOAT;
  else if constexpr (std::is_same_v<T, int64_t>) return H5T_NATIVE_INT64;
  else if constexpr (std::is_same_v<T, uint8_t>) return H5T_NATIVE_UINT8;
  else return H5T_NATIVE_INT32;
}

/// How numbers are laid out.
struct H5Layout {
  std::vector<hsize_t> chunk;  ///< empty = contiguous
  bool deflate = false, shuffle = false, fletcher = false;
  hid_t stored = -1;  ///< type in the file; the numbers' own by default
};

/// An HDF5 file in the temporary folder, closed by close() or at the end.
class H5Sample {
 public:
  explicit H5Sample(const std::string& name, hsize_t user_block = 0) : path(temp_folder() + name) {
    const hid_t make = H5Pcreate(H5P_FILE_CREATE);
    H5Pset_userblock(make, user_block);
    file_ = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, make, H5P_DEFAULT);
    H5Pclose(make);
  }
  ~H5Sample() { close(); }
  H5Sample(const H5Sample&) = delete;
  void close() {
    if (file_ >= 0) H5Fclose(file_);
    file_ = -1;
  }
  /// "/VTKHDF" with its two attributes, or a block of that kind.
  void vtkhdf(const std::string& at, const std::string& type, bool variable_length = false) {
    group(at);
    numbers<int64_t>(at, "Version", {2, 0});
    text(at, "Type", type, variable_length);
  }
  void group(const std::string& at) { H5Gclose(H5Gcreate2(file_, at.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)); }
  void text(const std::string& at, const char* name, const std::string& value, bool variable_length = false) {
    const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    H5Tset_size(type, variable_length ? H5T_VARIABLE : value.size());
    const hid_t a = H5Acreate_by_name(file_, at.c_str(), name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    const char* p = value.c_str();
    H5Awrite(a, type, variable_length ? static_cast<const void*>(&p) : p);
    H5Aclose(a), H5Sclose(space), H5Tclose(type);
  }
  template <class T>
  void numbers(const std::string& at, const char* name, const std::vector<T>& values) {
    const hsize_t n = values.size();
    const hid_t space = H5Screate_simple(1, &n, nullptr);
    const hid_t a = H5Acreate_by_name(file_, at.c_str(), name, h5_type<T>(), space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(a, h5_type<T>(), values.data());
    H5Aclose(a), H5Sclose(space);
  }
  template <class T>
  void data(const std::string& at, const std::vector<T>& values, std::vector<hsize_t> dims = {}, const H5Layout& layout = {}) {
    if (dims.empty()) dims = {values.size()};
    const hid_t space = H5Screate_simple(int(dims.size()), dims.data(), nullptr), make = H5Pcreate(H5P_DATASET_CREATE);
    if (!layout.chunk.empty()) H5Pset_chunk(make, int(layout.chunk.size()), layout.chunk.data());
    if (layout.shuffle) H5Pset_shuffle(make);
    if (layout.deflate) H5Pset_deflate(make, 6);
    if (layout.fletcher) H5Pset_fletcher32(make);
    const hid_t set =
        H5Dcreate2(file_, at.c_str(), layout.stored >= 0 ? layout.stored : h5_type<T>(), space, H5P_DEFAULT, make, H5P_DEFAULT);
    if (!values.empty()) H5Dwrite(set, h5_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(set), H5Pclose(make), H5Sclose(space);
  }
  hid_t id() const { return file_; }

  const std::string path;

 private:
  hid_t file_ = -1;
};

inline std::string bytes_of(const std::string& path) { return std::string(MappedFile(path).text()); }

}  // namespace sg::test
