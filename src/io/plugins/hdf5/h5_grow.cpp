// SPDX-License-Identifier: Apache-2.0
#include "io/plugins/hdf5/h5_grow.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"

namespace sg::h5 {

void GrowingFile::declare(const std::string& path, ElementType type, const std::vector<hsize_t>& row, size_t rows) {
  std::vector<hsize_t> now{0}, most{H5S_UNLIMITED}, chunk{std::max<hsize_t>(rows, 1)};
  now.insert(now.end(), row.begin(), row.end()), most.insert(most.end(), row.begin(), row.end()),
      chunk.insert(chunk.end(), row.begin(), row.end());
  chunk = chunk_of(chunk, element_size(type));
  if (rows <= 1 && row.empty()) chunk[0] = 64;  // tables of the steps
  for (size_t a = 1; a < chunk.size(); ++a) chunk[a] = std::max<hsize_t>(chunk[a], 1);
  const Handle space(H5Screate_simple(int(now.size()), now.data(), most.data())), make(H5Pcreate(H5P_DATASET_CREATE));
  H5Pset_obj_track_times(make, false);
  H5Pset_chunk(make, int(chunk.size()), chunk.data());
  if (compresses()) H5Pset_shuffle(make), H5Pset_deflate(make, deflate_level);
  if (!Handle(H5Dcreate2(file(), path.c_str(), native_type(type), space, H5P_DEFAULT, make, H5P_DEFAULT)).good())
    fail(fmt::format("cannot hold '{}'", path));
  sets_[path] = {type, row, 0, {}};
}

void GrowingFile::declare_count(const std::string& object, const char* name) {
  number<int64_t>(object, name, 0);
  counts_[object + "/" + name] = {object, name, {}, {}};
}

void GrowingFile::start() {
  if (H5Fflush(file(), H5F_SCOPE_GLOBAL) < 0 || H5Fstart_swmr_write(file()) < 0) fail("cannot be written");
  for (auto& [path, set] : sets_) set.set = Handle(H5Dopen2(file(), path.c_str(), H5P_DEFAULT));
  for (auto& [path, count] : counts_) {
    count.of = Handle(H5Oopen(file(), count.object.c_str(), H5P_DEFAULT));
    count.attribute = Handle(H5Aopen(count.of, count.name.c_str(), H5P_DEFAULT));
  }
}

void GrowingFile::append(const std::string& path, const Array& values, size_t rows) {
  Set& set = sets_.at(path);
  const Array packed = (values.type() == set.type ? values : values.converted(set.type)).made_packed();
  hsize_t each = 1;
  for (const hsize_t n : set.row) each *= n;
  if (hsize_t(packed.count()) * hsize_t(packed.components()) != each * rows)
    fail_usage(fmt::format("'{}' has {} numbers in this step, where {} are expected", path, packed.count() * size_t(packed.components()),
                           each * rows),
               this->path(), "every step has the arrays of the first, of the same shape");
  if (rows == 0) return;
  std::vector<hsize_t> dims{set.rows + rows}, start{set.rows}, count{rows};
  for (const hsize_t n : set.row) dims.push_back(n), start.push_back(0), count.push_back(n);
  bool good = H5Dset_extent(set.set, dims.data()) >= 0;
  const Handle space(H5Dget_space(set.set)), memory(H5Screate_simple(int(count.size()), count.data(), nullptr));
  good = good && H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) >= 0;
  good = good && H5Dwrite(set.set, native_type(set.type), memory, space, H5P_DEFAULT, packed.raw()) >= 0;
  if (!good || H5Dflush(set.set) < 0) fail(fmt::format("cannot hold '{}'", path));
  set.rows += rows;
}

void GrowingFile::set_count(const std::string& object, const char* name, int64_t count) {
  const Count& c = counts_.at(object + "/" + name);
  if (!c.attribute.good() || H5Awrite(c.attribute, H5T_NATIVE_INT64, &count) < 0 || H5Fflush(file(), H5F_SCOPE_GLOBAL) < 0)
    fail(fmt::format("cannot hold the attribute '{}' of '{}'", name, object));
}

void GrowingFile::close() {
  for (auto& [path, set] : sets_)
    if (!set.set.close()) fail("cannot be written");
  counts_.clear();
  if (!Writer::close()) fail("cannot be written");
}

}  // namespace sg::h5
