// SPDX-License-Identifier: Apache-2.0
// Readers that need a heavy library live in plug-ins, shared objects next to the program or the library, loaded when a file needs them. A
// missing plug-in, or one whose library is missing, gives an error that names the package to install.
//
// A plug-in is a folder src/io/plugins/NAME, built by sg_plugin(NAME ...). It exports one function:
//   SG_PLUGIN_FORMATS({"vtkhdf", read_vtkhdf, write_vtkhdf, times_of_vtkhdf}, ...)
// and formats.def names it:
//   {"VTKHDF", "vtkhdf hdf", sniff_hdf5, plugin_read<"hdf5", "vtkhdf">, plugin_write<"hdf5", "vtkhdf">, plugin_times<"hdf5", "vtkhdf">},
#pragma once
#include <algorithm>

#include "base/file/mapped_watch.h"
#include "base/parallel.h"
#include "data/memory/memory_budget.h"
#include "io/film/movie.h"
#include "io/io.h"
#include "io/steps/steps.h"

namespace sg {

/// One array in a file of arrays, or a block of it: count[a] indices from start[a] on, every stride[a]-th; all when these are empty.
struct PluginSelection {
  std::string dataset;  ///< its path in the file
  std::vector<size_t> start, count, stride;
};
struct PluginArray {
  Array values;              ///< one component, the last dimension fastest
  std::vector<size_t> dims;  ///< slowest first; empty for a single number
};

/// What a plug-in offers under one name; null = it cannot do that.
struct PluginFormat {
  std::string_view name;
  Data (*read)(const std::string& path, const ReadOptions&, Context&) = nullptr;
  void (*write)(const std::string& path, const Data&, const WriteOptions&, Context&) = nullptr;
  std::vector<double> (*times)(const std::string& path, const ReadOptions&, Context&) = nullptr;
  PluginArray (*array)(const std::string& path, const PluginSelection&, Context&) = nullptr;
  MovieEncoder (*movie)(const MovieSettings&) = nullptr;
  std::unique_ptr<StepsWriter> (*steps)(const std::string& path, StepsPlan plan, const WriteOptions&, Context&) = nullptr;
};

/// How plug-ins learn of set_memory_limit() when they are loaded.
void set_plugin_memory(size_t bytes);
/// Loads a plug-in (once) and finds a format in it. Throws Error(data) that names what to install.
const PluginFormat& plugin_format(std::string_view plugin, std::string_view format);

/// A name as a template argument.
template <size_t N>
struct PluginName {
  char text[N];
  constexpr PluginName(const char (&s)[N]) { std::copy_n(s, N, text); }
};

template <PluginName PLUGIN, PluginName FORMAT>
Data plugin_read(const std::string& path, const ReadOptions& options, Context& context) {
  return plugin_format(PLUGIN.text, FORMAT.text).read(path, options, context);
}
template <PluginName PLUGIN, PluginName FORMAT>
void plugin_write(const std::string& path, const Data& data, const WriteOptions& options, Context& context) {
  plugin_format(PLUGIN.text, FORMAT.text).write(path, data, options, context);
}
template <PluginName PLUGIN, PluginName FORMAT>
std::vector<double> plugin_times(const std::string& path, const ReadOptions& options, Context& context) {
  return plugin_format(PLUGIN.text, FORMAT.text).times(path, options, context);
}

template <PluginName PLUGIN, PluginName FORMAT>
std::unique_ptr<StepsWriter> plugin_steps(const std::string& path, StepsPlan plan, const WriteOptions& options, Context& context) {
  return plugin_format(PLUGIN.text, FORMAT.text).steps(path, std::move(plan), options, context);
}

}  // namespace sg

/// In one file of a plug-in: what it offers. It has its own copies of base and data, which take the host's cap on threads (0 = all) and
/// on the memory of arrays (0 = none), and its watch over mapped files.
#define SG_PLUGIN_FORMATS(...)                                                                                                             \
  extern "C" __attribute__((visibility("default"))) void sightglass_watch(sg::MappedWatch* watch) { sg::share_mapped_watch(watch); }       \
  extern "C" __attribute__((visibility("default"))) const sg::PluginFormat* sightglass_plugin(size_t* count, int threads, size_t memory) { \
    static const sg::PluginFormat table[] = {__VA_ARGS__};                                                                                 \
    sg::set_thread_count(threads);                                                                                                         \
    sg::set_memory_limit(memory);                                                                                                          \
    *count = sizeof table / sizeof *table;                                                                                                 \
    return table;                                                                                                                          \
  }
