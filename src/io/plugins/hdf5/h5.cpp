// SPDX-License-Identifier: Apache-2.0
#include "io/plugins/hdf5/h5.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/error.h"
#include "base/file/file_fence.h"
#include "base/text/text.h"
#include "io/plugins/hdf5/guarded.h"
#include "io/plugins/hdf5/h5_probe.h"

namespace sg::h5 {

void silence() {
  // At the end of the program the library would try once more to write what a full disk did not take, and fall over it. All files are
  // closed where they are opened; there is nothing left to do.
  static const bool first = H5dont_atexit() >= 0;
  (void)first;
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

std::recursive_mutex& Turn::mutex() {
  static std::recursive_mutex m;
  return m;
}

std::string library_message() {
  std::string text;
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned, const H5E_error2_t* e, void* out) -> herr_t {
        auto& t = *static_cast<std::string*>(out);
        if (t.empty() && e->desc) t = e->desc;
        return 0;
      },
      &text);
  H5Eclear2(H5E_DEFAULT);
  return text;
}

namespace {

// "" or the library's message, in brackets, without line ends.
std::string said() {
  std::string t = library_message();
  for (char& c : t)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return t.empty() ? t : fmt::format(" (HDF5: {})", std::string(trim(t)));
}

constexpr size_t most_children = 1000000;

}  // namespace

namespace {

// Of an external link: the file has to lie where files may name others, and to be one.
herr_t check_link(const char* parent, const char*, const char* child, const char*, unsigned*, hid_t, void*) {
  try {
    const std::string beside = named_file(parent, child);
    for (const std::string& path : {beside, std::string(child)})  // the library looks in the working folder too
      if (file_exists(path) && !is_plain_file(path)) return -1;
    return 0;
  } catch (const Error&) {
    return -1;
  }
}

// Every call of the library that is given no list of its own takes these.
void guard_links() {
  static const bool done = [] {
    for (const hid_t list : {H5P_LINK_ACCESS_DEFAULT, H5P_DATASET_ACCESS_DEFAULT, H5P_GROUP_ACCESS_DEFAULT})
      if (H5Pset_elink_cb(list, check_link, nullptr) < 0) fail_internal("HDF5 does not accept a callback for external links");
    return true;
  }();
  (void)done;
}

}  // namespace

static const std::string& probed(const std::string& path) {
  if (!is_plain_file(path)) MappedFile missing(path);  // explains why it cannot be read
  probe(path);
  return path;
}

File::File(const std::string& path) : File(probed(path), unprobed) {}

File::File(const std::string& path, Unprobed) : path_(path) {
  silence();
  guard_links();
  const Handle access(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_file_locking(access, false, true);  // reading needs no lock, and some shared folders have none
  H5Pset_fclose_degree(access, H5F_CLOSE_SEMI);
  file_ = Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access));
  // One that is being written, or whose writer was broken off.
  if (!file_.good()) file_ = Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, access));
  if (!file_.good()) fail_data("cannot be opened as HDF5" + said(), path, "the file is truncated, damaged or not HDF5");
  hsize_t size = 0;
  if (H5Fget_filesize(file_, &size) < 0) fail_data("cannot be measured" + said(), path);
  size_ = size;
}

void File::fail(std::string problem, const std::string& object, std::string hint) const {
  fail_data(problem + said(), object.empty() ? path_ : fmt::format("{}: '{}'", path_, object), std::move(hint));
}

const MappedFile& File::mapped() const {
  if (!mapped_) mapped_.emplace(path_);
  return *mapped_;
}

bool File::exists(const std::string& object) const {
  if (object == "/") return true;
  for (size_t end = object.find('/', 1);; end = object.find('/', end + 1)) {
    const std::string part = object.substr(0, end);
    const htri_t there = H5Lexists(file_, part.c_str(), H5P_DEFAULT);
    if (there <= 0) break;
    if (end == std::string::npos) {
      const bool leads_somewhere = H5Oexists_by_name(file_, part.c_str(), H5P_DEFAULT) > 0;
      H5Eclear2(H5E_DEFAULT);
      return leads_somewhere;
    }
  }
  H5Eclear2(H5E_DEFAULT);
  return false;
}

namespace {

bool is_kind(const File& f, const std::string& object, H5O_type_t kind) {
  if (!f.exists(object)) return false;
  H5O_info_t info;
  const bool good = H5Oget_info_by_name2(f.id(), object.c_str(), &info, H5O_INFO_BASIC, H5P_DEFAULT) >= 0;
  H5Eclear2(H5E_DEFAULT);
  return good && info.type == kind;
}

}  // namespace

bool File::is_group(const std::string& object) const { return is_kind(*this, object, H5O_TYPE_GROUP); }
bool File::is_dataset(const std::string& object) const { return is_kind(*this, object, H5O_TYPE_DATASET); }

std::vector<std::string> File::children(const std::string& group) const {
  std::vector<std::string> names;
  const Handle g(H5Gopen2(file_, group.c_str(), H5P_DEFAULT));
  if (!g.good()) fail("is not a group that can be opened", group);
  const Handle made(H5Gget_create_plist(g));
  unsigned order = 0;
  H5Pget_link_creation_order(made, &order);
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* out) -> herr_t {
    auto& n = *static_cast<std::vector<std::string>*>(out);
    n.emplace_back(name);
    return n.size() < most_children ? 0 : 1;
  };
  hsize_t at = 0;
  if (H5Literate(g, order & H5P_CRT_ORDER_TRACKED ? H5_INDEX_CRT_ORDER : H5_INDEX_NAME, H5_ITER_INC, &at, add, &names) < 0)
    fail("cannot be listed", group, "the file is truncated or damaged");
  return names;
}

std::optional<std::string> File::text_attribute(const std::string& object, const std::string& name) const {
  const Handle a(H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT));
  if (!a.good()) {
    H5Eclear2(H5E_DEFAULT);
    return {};
  }
  const Handle type(H5Aget_type(a)), space(H5Aget_space(a));
  if (H5Tget_class(type) != H5T_STRING || H5Sget_simple_extent_npoints(space) != 1) return {};
  std::string text;
  if (H5Tis_variable_str(type) > 0) {
    const auto read = guarded([&] {
      char* p = nullptr;
      const Handle memory(H5Tcopy(H5T_C_S1));
      H5Tset_size(memory, H5T_VARIABLE);
      H5Tset_cset(memory, H5Tget_cset(type));
      if (H5Aread(a, memory, &p) < 0) fail("", "");
      return std::string(p ? p : "");
    });
    if (!read) fail(fmt::format("has an attribute '{}' that cannot be read", name), object, "the file is damaged");
    text = *read;
  } else {
    const size_t n = H5Tget_size(type);
    if (n > 1 << 20) fail(fmt::format("has an attribute '{}' of {} bytes", name, n), object);
    text.resize(n);
    if (H5Aread(a, type, text.data()) < 0) fail(fmt::format("has an attribute '{}' that cannot be read", name), object);
    text.resize(std::min(text.find('\0'), text.size()));
  }
  return std::string(trim(text));
}

hid_t native_type(ElementType t) {
  switch (t) {
    case ElementType::u8: return H5T_NATIVE_UINT8;
    case ElementType::i8: return H5T_NATIVE_INT8;
    case ElementType::u16: return H5T_NATIVE_UINT16;
    case ElementType::i16: return H5T_NATIVE_INT16;
    case ElementType::u32: return H5T_NATIVE_UINT32;
    case ElementType::i32: return H5T_NATIVE_INT32;
    case ElementType::u64: return H5T_NATIVE_UINT64;
    case ElementType::i64: return H5T_NATIVE_INT64;
    case ElementType::f32: return H5T_NATIVE_FLOAT;
    case ElementType::f64: return H5T_NATIVE_DOUBLE;
  }
  fail_internal("native_type: unknown element type");
}

// Integers and IEEE floats of 1, 2, 4 or 8 bytes in one of the two byte orders, and enumerations of such. The library converts other types,
// but trusts the file's description of their bits.
bool plain_type(hid_t type, ElementType& out, bool& big_endian) {
  const Handle base(H5Tget_class(type) == H5T_ENUM ? H5Tget_super(type) : H5Tcopy(type));
  if (!base.good()) return false;
  for (const ElementType t : {ElementType::f32, ElementType::f64, ElementType::i32, ElementType::i64, ElementType::u8, ElementType::i8,
                              ElementType::u16, ElementType::i16, ElementType::u32, ElementType::u64}) {
    out = t;
    big_endian = false;
    if (H5Tequal(base, native_type(t)) > 0) return true;
    const Handle swapped(H5Tcopy(native_type(t)));
    big_endian = element_size(t) > 1;
    if (H5Tset_order(swapped, H5T_ORDER_BE) >= 0 && H5Tequal(base, swapped) > 0) return true;
  }
  return false;
}

std::vector<double> File::number_attribute(const std::string& object, const std::string& name) const {
  const Handle a(H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT));
  if (!a.good()) {
    H5Eclear2(H5E_DEFAULT);
    return {};
  }
  const Handle type(H5Aget_type(a)), space(H5Aget_space(a));
  const hssize_t n = H5Sget_simple_extent_npoints(space);
  ElementType element{};
  bool big_endian = false;
  if (n <= 0 || n > 4096 || !plain_type(type, element, big_endian)) return {};
  std::byte* out = nullptr;
  const Array raw = Array::make_raw(element, size_t(n), 1, &out);
  if (H5Aread(a, native_type(element), out) < 0) fail(fmt::format("has an attribute '{}' that cannot be read", name), object);
  std::vector<double> values(raw.count());
  for (size_t i = 0; i < values.size(); ++i) values[i] = raw.get(i);
  return values;
}

}  // namespace sg::h5
