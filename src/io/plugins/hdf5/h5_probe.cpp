// SPDX-License-Identifier: Apache-2.0
#include "io/plugins/hdf5/h5_probe.h"

#include <hdf5.h>
#include <sys/stat.h>

#include <array>
#include <map>
#include <mutex>
#include <set>

#include "base/error.h"
#include "io/isolated/isolated.h"
#include "io/plugins/hdf5/h5.h"

namespace sg::h5 {

namespace {

constexpr size_t most_objects = 5000;
constexpr int deepest = 20;

// Does with every object what readers do, by the same functions, and goes on after an object that cannot be opened: others may be read.
struct Visitor {
  const File& file;
  std::set<std::pair<unsigned long, haddr_t>> seen;

  void attributes(const std::string& object) {
    std::vector<std::string> names;
    const auto add = [](hid_t, const char* name, const H5A_info_t*, void* out) -> herr_t {
      static_cast<std::vector<std::string>*>(out)->emplace_back(name);
      return 0;
    };
    hsize_t at = 0;
    H5Aiterate_by_name(file.id(), object.c_str(), H5_INDEX_NAME, H5_ITER_INC, &at, add, &names, H5P_DEFAULT);
    H5Aexists_by_name(file.id(), object.c_str(), "Type", H5P_DEFAULT);
    for (const std::string& name : names) {
      attempt([&] { (void)file.number_attribute(object, name); });
      const Handle a(H5Aopen_by_name(file.id(), object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT));
      const Handle type(a.good() ? H5Aget_type(a) : H5I_INVALID_HID);
      const bool variable = !type.good() || H5Tis_variable_str(type) != 0;  // read in a child of its own
      if (!variable) attempt([&] { (void)file.text_attribute(object, name); });
    }
  }

  void look(const std::string& object, int depth) {
    H5O_info_t info;
    if (seen.size() >= most_objects || depth > deepest || !file.exists(object) ||
        H5Oget_info_by_name2(file.id(), object.c_str(), &info, H5O_INFO_BASIC, H5P_DEFAULT) < 0 ||
        !seen.emplace(info.fileno, info.addr).second)
      return;
    attributes(object);
    if (info.type == H5O_TYPE_DATASET) attempt([&] { const Dataset d(file, object); });
    if (info.type != H5O_TYPE_GROUP) return;
    std::vector<std::string> names;
    attempt([&] { names = file.children(object); });
    for (const std::string& name : names) look(object == "/" ? "/" + name : object + "/" + name, depth + 1);
  }

  template <class F>
  void attempt(F&& f) {
    try {
      f();
    } catch (const Error&) {  // said again by the reader, if it gets there
    }
  }
};

}  // namespace

void probe(const std::string& path) {
  struct stat s {};
  if (::stat(path.c_str(), &s) != 0) return;
  using State = std::array<int64_t, 5>;
  const State state{int64_t(s.st_dev), int64_t(s.st_ino), int64_t(s.st_size), int64_t(s.st_mtim.tv_sec), int64_t(s.st_mtim.tv_nsec)};
  static std::mutex mutex;
  static std::map<std::string, State> good;
  const std::lock_guard lock(mutex);
  if (const auto at = good.find(path); at != good.end() && at->second == state) return;
  try_in_child(path, "HDF5", [&] {
    const File file(path, File::unprobed);
    Visitor{file, {}}.look("/", 0);
  });
  if (good.size() > 1000) good.clear();
  good[path] = state;
}

}  // namespace sg::h5
