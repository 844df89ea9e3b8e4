// SPDX-License-Identifier: Apache-2.0
// The table of formats and the choice among them.
#include "io/formats.h"

#include "base/file.h"
#include "base/text.h"

namespace sg {

std::span<const Format> formats() {
  static constexpr Format table[] = {
      {"legacy VTK", "vtk", sniff_vtk_legacy, read_vtk_legacy, nullptr},
      {"VTK XML", "vti vtr vts vtu vtp", sniff_vtk_xml, read_vtk_xml, write_vtk_xml},
      {"NRRD", "nrrd nhdr", sniff_nrrd, read_nrrd, write_nrrd},
      {"MetaImage", "mhd mha", sniff_metaimage, read_metaimage, nullptr},
      {"PLY", "ply", sniff_ply, read_ply, write_ply},
      {"STL", "stl", nullptr, read_stl, write_stl},
      {"OBJ", "obj", nullptr, read_obj, write_obj},
      {"raw brick", "raw bin", nullptr, read_raw, nullptr},
  };
  return table;
}

namespace {

bool has_extension(const Format& f, const std::string& ext) {
  for (std::string_view e : words(f.extensions))
    if (e == ext) return true;
  return false;
}

std::string known_extensions(bool writable) {
  std::string r;
  for (const Format& f : formats())
    if (writable ? f.write != nullptr : f.read != nullptr)
      for (std::string_view e : words(f.extensions)) r += (r.empty() ? "" : " ") + std::string(e);
  return r;
}

}  // namespace

namespace {

Data read_known(const std::string& path, const ReadOptions& options, Context& context) {
  const MappedFile file(path);
  if (file.size() == 0) fail_data("is empty", path, "a data file has at least a header");
  if (options.raw_dims[0] > 0) return read_raw(path, options, context);
  const std::span<const std::byte> head(file.data(), std::min<size_t>(file.size(), 4096));
  for (const Format& f : formats())
    if (f.sniff && f.sniff(head)) return f.read(path, options, context);
  const std::string ext = extension_of(path);
  for (const Format& f : formats())
    if (!f.sniff && has_extension(f, ext)) return f.read(path, options, context);
  for (const Format& f : formats())
    if (has_extension(f, ext)) fail_data(fmt::format("is named .{} but its content is no {}", ext, f.name), path);
  fail_data("is in no known format", path, "known are: " + known_extensions(false) + "; for a raw brick give --dims and --type");
}

}  // namespace

Data read_data(const std::string& path, const ReadOptions& options, Context& context) {
  try {
    return read_known(path, options, context);
  } catch (Error& e) {  // most say where; those found when the dataset is made cannot
    if (e.where().find(path) == std::string::npos) e.add_context(fmt::format("reading '{}'", path));
    throw;
  }
}

void write_data(const std::string& path, const Data& data, const WriteOptions& options, Context& context) {
  const std::string ext = extension_of(path);
  for (const Format& f : formats())
    if (has_extension(f, ext)) {
      if (!f.write) fail_usage(fmt::format("{} files are read but not written", f.name), path, "can write: " + known_extensions(true));
      return with_context(fmt::format("writing '{}'", path), [&] { f.write(path, data, options, context); });
    }
  fail_usage(fmt::format("unknown extension '{}'", ext), path, "can write: " + known_extensions(true));
}

}  // namespace sg
