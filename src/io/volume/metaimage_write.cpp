// SPDX-License-Identifier: Apache-2.0
// MetaImage: .mha with the numbers after the header, .mhd with a separate .raw or .zraw file.
#include <fmt/core.h>
#include <libdeflate.h>

#include "base/file/file.h"
#include "base/text/text.h"
#include "data/patient/patient_frame.h"
#include "io/atomic_files.h"
#include "io/formats.h"
#include "io/write_losses.h"

namespace sg {

namespace {

std::vector<std::byte> pack_zlib(std::span<const std::byte> in) {
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> c(libdeflate_alloc_compressor(6),
                                                                                   libdeflate_free_compressor);
  if (!c) fail_data("not enough memory to compress");
  std::vector<std::byte> out(libdeflate_zlib_compress_bound(c.get(), in.size()));
  out.resize(libdeflate_zlib_compress(c.get(), in.data(), in.size(), out.data(), out.size()));
  return out;
}

// MetaIO's letters name where an axis comes from: RAI for one that leads to the left, the back and the head.
std::string from_letters(const Mat3& direction) {
  Mat3 back;
  for (int r = 0; r < 3; ++r)
    for (int a = 0; a < 3; ++a) back.m[r][a] = -direction.m[r][a];
  return axis_letters(back);
}

std::string three(Vec3 v) { return fmt::format("{} {} {}", exact_number(v.x), exact_number(v.y), exact_number(v.z)); }

std::string header_text(const UniformGrid& g, const Field& f, size_t packed, const std::string& data_file, const Dataset& d) {
  constexpr std::string_view types[] = {"MET_UCHAR", "MET_CHAR",       "MET_USHORT",    "MET_SHORT", "MET_UINT",
                                        "MET_INT",   "MET_ULONG_LONG", "MET_LONG_LONG", "MET_FLOAT", "MET_DOUBLE"};
  std::string t = "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n";
  t += packed ? fmt::format("CompressedData = True\nCompressedDataSize = {}\n", packed) : "CompressedData = False\n";
  t +=
      fmt::format("TransformMatrix = {} {} {}\n", three(g.direction.column(0)), three(g.direction.column(1)), three(g.direction.column(2)));
  t += fmt::format("Offset = {}\nElementSpacing = {}\n", three(g.origin), three(g.spacing));
  t += fmt::format("DimSize = {} {} {}\n", g.dims[0], g.dims[1], g.dims[2]);
  if (in_patient_frame(d)) t += fmt::format("AnatomicalOrientation = {}\n", from_letters(g.direction));
  for (const auto& [key, value] : d.notes())
    for (const std::string_view known : {"Modality", "Comment", "Name"})
      if (key == known && value.find('\n') == std::string::npos) t += fmt::format("{} = {}\n", key, value);
  if (!f.name.empty() && f.name != "MetaImage" && f.name.find('\n') == std::string::npos) t += fmt::format("FieldName = {}\n", f.name);
  if (f.components() > 1) t += fmt::format("ElementNumberOfChannels = {}\n", f.components());
  return t + fmt::format("ElementType = {}\nElementDataFile = {}\n", types[size_t(f.array.type())], data_file);
}

}  // namespace

void write_metaimage(const std::string& path, const Data& data, const WriteOptions& options, Context& context) {
  const DatasetPtr d = single_dataset(data, "writing MetaImage");
  const UniformGrid* grid = d->as<UniformGrid>();
  if (!grid)
    fail_usage(fmt::format("a MetaImage file holds a uniform grid, not a {} mesh", d->kind()), path, "resample it first: -f 'resample'");
  const Compression compression = options.compression.value_or(Compression::none);
  if (compression != Compression::none && compression != Compression::zlib)
    fail_usage(fmt::format("MetaImage cannot be compressed with '{}'", word_of(compression)), path, "use none or zlib");
  WriteLosses losses(path, "MetaImage");
  const Field& f = losses.one_point_field(*d, false);
  losses.renames(f, f.name.empty() || f.name.find('\n') != std::string::npos ? "MetaImage" : trim(f.name));
  const Array a = f.array.made_packed();
  std::span<const std::byte> bytes(a.raw(), a.bytes());
  std::vector<std::byte> packed;
  if (compression == Compression::zlib) bytes = packed = pack_zlib(bytes);

  const bool apart = extension_of(path) == "mhd";
  const std::string data_path = path.substr(0, path.size() - 3) + (packed.empty() ? "raw" : "zraw");
  const std::string header = header_text(*grid, f, packed.size(), apart ? file_name_of(data_path) : "LOCAL", *d);
  if (apart) {
    AtomicFiles files({data_path, path});
    files.write(0, bytes.data(), bytes.size());
    files.write(1, header);
    files.commit();
  } else {
    AtomicFile file(path);
    file.write(header);
    file.write(bytes.data(), bytes.size());
    file.commit();
  }
  losses.tell(context);
}

}  // namespace sg
