// SPDX-License-Identifier: Apache-2.0
#include "io/plugin.h"

#include <dlfcn.h>
#include <fmt/core.h>
#include <sys/auxv.h>
#include <sys/stat.h>
#include <unistd.h>

#include <climits>
#include <cstdlib>
#include <mutex>

#include "base/error.h"
#include "base/file/file.h"
#include "base/parallel.h"

namespace sg {

namespace {

size_t plugin_memory = 0;

using EntryPoint = const PluginFormat* (*)(size_t* count, int threads, size_t memory);

struct Package {
  std::string_view plugin, what, packages;
};
constexpr Package packages[] = {
    {"hdf5", "HDF5", "libhdf5-103-1"}, {"netcdf", "netCDF", "libnetcdf19"},      {"cgns", "CGNS", "libcgns3.4"},
    {"gdcm", "DICOM", "libgdcm3.0"},   {"openvdb", "OpenVDB", "libopenvdb10.0"}, {"tiff", "TIFF", "libtiff6"},
    {"vpx", "films", "libvpx7"},
};

const Package& package_of(std::string_view plugin) {
  for (const Package& p : packages)
    if (p.plugin == plugin) return p;
  fail_internal(fmt::format("plug-in '{}' has no package", plugin));
}

// The file that this code runs from: the program, or the library loaded by another program.
struct OwnFile {
  std::string path;  // "" when it is not known
  bool library = false;
};
OwnFile own_file() {
  const auto module_of = [](const void* at) {
    Dl_info info{};
    return ::dladdr(at, &info) ? info : Dl_info{};
  };
  const Dl_info ours = module_of(reinterpret_cast<const void*>(&set_plugin_memory));
  const bool in_program = ours.dli_fbase == module_of(reinterpret_cast<const void*>(::getauxval(AT_ENTRY))).dli_fbase;
  char path[PATH_MAX];
  if (in_program || !ours.dli_fname) {  // its dli_fname is the first word of the command
    const ssize_t n = ::readlink("/proc/self/exe", path, sizeof path);
    return {n > 0 ? std::string(path, size_t(n)) : "", false};
  }
  return {::realpath(ours.dli_fname, path) ? path : "", true};
}

// Where plug-ins are looked for: only the environment's folder; else next to the program, in the installation's lib (from bin/), and next
// to the installed library (lib/, or one folder below: lib/x86_64-linux-gnu). A folder or file that anyone may write, or whose owner
// neither runs nor owns the program or library, is skipped with a note: what lies there would run as this user.
std::vector<std::string> plugin_folders(const OwnFile& own) {
  if (const char* set = std::getenv("SIGHTGLASS_PLUGINS")) return {std::string(set) + "/"};
  if (own.path.empty()) return {};
  const std::string here = folder_of(own.path);
  if (own.library) return {here + "plugins/", here + "sightglass/", here + "../sightglass/"};
  return {here + "plugins/", here + "../lib/sightglass/"};
}

bool may_be_trusted(const std::string& path, const std::string& own) {
  struct stat st {
  }, ours{};
  if (::stat(path.c_str(), &st) != 0) return false;
  const bool known = st.st_uid == 0 || st.st_uid == ::geteuid() || (::stat(own.c_str(), &ours) == 0 && st.st_uid == ours.st_uid);
  return known && !(st.st_mode & S_IWOTH);
}

struct Loaded {
  std::string name;
  const PluginFormat* formats = nullptr;
  size_t count = 0;
};

// Never unloaded: data that it made points into its code.
Loaded load(std::string_view name) {
  const Package& package = package_of(name);
  const std::string file = fmt::format("sightglass_{}.so", name);
  const OwnFile own = own_file();
  std::string tried;
  for (const std::string& folder : plugin_folders(own)) {
    tried += (tried.empty() ? "" : ", ") + folder;
    if (!file_exists(folder + file)) continue;
    if (!may_be_trusted(folder, own.path) || !may_be_trusted(folder + file, own.path)) {
      tried += " (skipped: other users may write there)";
      continue;
    }
    void* handle = ::dlopen((folder + file).c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle)
      fail_data(fmt::format("cannot load the reader for {}: {}", package.what, ::dlerror()), folder + file,
                fmt::format("install its library: apt-get install {}", package.packages));
    const auto entry = reinterpret_cast<EntryPoint>(::dlsym(handle, "sightglass_plugin"));
    if (!entry) fail_data("is not a Sightglass plug-in", folder + file, "remove or rebuild it");
    if (const auto watch = reinterpret_cast<void (*)(MappedWatch*)>(::dlsym(handle, "sightglass_watch"))) watch(&mapped_watch());
    Loaded l{std::string(name), nullptr, 0};
    l.formats = entry(&l.count, thread_count(), plugin_memory);
    return l;
  }
  fail_data(fmt::format("the reader for {} ({}) is not installed", package.what, file), "",
            fmt::format("install the library's development package before building ({}); looked in {}", package.packages, tried));
}

}  // namespace

void set_plugin_memory(size_t bytes) { plugin_memory = bytes; }

const PluginFormat& plugin_format(std::string_view plugin, std::string_view format) {
  static std::mutex mutex;
  static std::vector<std::unique_ptr<Loaded>> loaded;
  std::lock_guard lock(mutex);
  const Loaded* found = nullptr;
  for (const auto& l : loaded)
    if (l->name == plugin) found = l.get();
  if (!found) found = loaded.emplace_back(std::make_unique<Loaded>(load(plugin))).get();
  for (size_t i = 0; i < found->count; ++i)
    if (found->formats[i].name == format) return found->formats[i];
  fail_internal(fmt::format("plug-in '{}' has no format '{}'", plugin, format));
}

}  // namespace sg
