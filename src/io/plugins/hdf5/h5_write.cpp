// SPDX-License-Identifier: Apache-2.0
#include "io/plugins/hdf5/h5_write.h"

#include <fmt/core.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/error.h"
#include "io/plugins/hdf5/h5_pack.h"

namespace sg::h5 {

// The slowest dimensions are cut first.
std::vector<hsize_t> chunk_of(std::vector<hsize_t> dims, size_t size) {
  for (size_t a = 0; a < dims.size(); ++a) {
    hsize_t row = size;
    for (size_t b = a + 1; b < dims.size(); ++b) row *= dims[b];
    dims[a] = std::clamp<hsize_t>((256 << 10) / std::max<hsize_t>(row, 1), 1, std::max<hsize_t>(dims[a], 1));
  }
  return dims;
}

Writer::Writer(const std::string& path, bool compress, Context& context) : Writer(path, compress, context, false) {}
Writer::Writer(const std::string& path, bool compress, Context& context, Latest) : Writer(path, compress, context, true) {}

Writer::Writer(const std::string& path, bool compress, Context& context, bool latest)
    : path_(path), partial_(path), compress_(compress), context_(context) {
  silence();
  errno = 0;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_file_locking(access, false, true);
  if (latest) {
    H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
    H5Pset_fclose_degree(access, H5F_CLOSE_SEMI);  // as readers in this process have it
  }
  file_ = Handle(H5Fcreate(partial_.name().c_str(), H5F_ACC_EXCL, H5P_DEFAULT, access));
  if (!file_.good()) fail("cannot be written");
}

void Writer::commit() {
  const bool flushed = H5Fflush(file_, H5F_SCOPE_GLOBAL) >= 0;
  const bool closed = file_.close();
  if (!flushed || !closed) fail("cannot be written");
  partial_.commit();
}

void Writer::group(const std::string& path) {
  if (!Handle(H5Gcreate2(file_, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)).good()) fail(fmt::format("cannot hold '{}'", path));
}

void Writer::text(const std::string& object, const char* name, const std::string& value) {
  const Handle type(H5Tcopy(H5T_C_S1)), space(H5Screate(H5S_SCALAR));
  H5Tset_size(type, std::max<size_t>(value.size(), 1));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  attribute(object, name, type, space, value.data());
}

void Writer::array(const std::string& path, const Array& values, std::vector<hsize_t> dims) {
  context_.check();
  const Array packed = values.made_packed();
  const Handle space(dims.empty() ? H5Screate(H5S_SCALAR) : H5Screate_simple(int(dims.size()), dims.data(), nullptr)),
      make(H5Pcreate(H5P_DATASET_CREATE));
  H5Pset_obj_track_times(make, false);  // the same data give the same bytes
  const bool pack = compress_ && packed.bytes() >= 4096;
  const size_t size = element_size(packed.type());
  const std::vector<hsize_t> chunk = chunk_of(dims, size);
  if (pack) {
    H5Pset_chunk(make, int(dims.size()), chunk.data());
    H5Pset_shuffle(make);
    H5Pset_deflate(make, deflate_level);
  }
  const hid_t type = native_type(packed.type());
  const Handle set(H5Dcreate2(file_, path.c_str(), type, space, H5P_DEFAULT, make, H5P_DEFAULT));
  const bool written = set.good() && (pack ? write_packed(set, packed.raw(), dims, chunk, size, deflate_level, context_)
                                           : packed.bytes() == 0 || H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, packed.raw()) >= 0);
  if (!written) fail(fmt::format("cannot hold '{}'", path));
}

void Writer::list(const std::string& path, const Array& values) {
  std::vector<hsize_t> dims{values.count()};
  if (values.components() > 1) dims.push_back(hsize_t(values.components()));
  array(path, values, dims);
}

void Writer::fail(const std::string& what) const {
  std::string why = library_message();
  if (errno) why += (why.empty() ? "" : ", ") + std::string(std::strerror(errno));
  fail_data(what + (why.empty() ? "" : " (" + why + ")"), path_, "check that the folder exists, is writable and has room");
}

void Writer::attribute(const std::string& object, const char* name, hid_t type, hid_t space, const void* value) {
  const Handle a(H5Acreate_by_name(file_, object.c_str(), name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  if (!a.good() || H5Awrite(a, type, value) < 0) fail(fmt::format("cannot hold the attribute '{}' of '{}'", name, object));
}

}  // namespace sg::h5
