// SPDX-License-Identifier: Apache-2.0
// Files in and out. A format is chosen by content first, by extension second; one file per format.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/context.h"
#include "base/schema/enum_words.h"
#include "data/dataset.h"

namespace sg {

class Schema;
struct StepsPlan;
class StepsWriter;

/// Part of a lattice: points lo..hi (inclusive, counted from 0 in the file's lattice), every stride-th along each axis.
struct LatticeRegion {
  std::array<size_t, 3> lo{0, 0, 0}, hi{SIZE_MAX, SIZE_MAX, SIZE_MAX};  ///< hi is clamped to the lattice
  std::array<size_t, 3> stride{1, 1, 1};
  bool whole() const { return *this == LatticeRegion(); }
  friend bool operator==(const LatticeRegion&, const LatticeRegion&) = default;
};

/// Whether the first line of delimited text names the columns.
enum class HeaderLine {
  automatic,  ///< by its cells
  yes,
  no
};
constexpr auto enum_words(HeaderLine) {
  return std::array{Word{"auto", HeaderLine::automatic}, Word{"yes", HeaderLine::yes}, Word{"no", HeaderLine::no}};
}

/// What a reader may leave out. It may always return more than requested; read_data() then cuts what it can (see Format::honours).
struct ReadOptions {
  std::string format;                       ///< an extension or the name of a format; "" = by content, then by the file's name
  std::vector<std::string> fields;          ///< names to load; empty = all. Readers may skip the bytes of the others.
  bool header_only = false;                 ///< no field values needed: readers may leave fields out that cost reading
  std::optional<double> time;               ///< of a series: the step nearest to this time
  int64_t step = -1;                        ///< of a series: this step, 0 first; -1 = by time, else the format's default (the first)
  LatticeRegion region;                     ///< of a lattice: this part only
  int piece = 0, pieces = 1;                ///< part `piece` of `pieces`, when several processes share the work
  int ghost_levels = 0;                     ///< layers of cells of neighbouring pieces, marked ghost_duplicate
  std::array<size_t, 3> raw_dims{0, 0, 0};  ///< raw bricks: size, ...
  std::string raw_type;                     ///< ... element type ("u8", "f32", ...),
  bool raw_big_endian = false;              ///< ... byte order,
  size_t raw_header = 0;                    ///< ... bytes to skip,
  int raw_components = 1;                   ///< ... numbers per voxel,
  Vec3 raw_spacing{1, 1, 1};                ///< ... distance of voxels
  HeaderLine csv_header = HeaderLine::automatic;
  std::string times;  ///< several files as a series (io/file_series.h): START:STEP or a list; "" = those in the files
};

/// How VTK XML holds the bytes of arrays.
enum class VtkEncoding {
  ascii,
  base64,
  appended,  ///< as they are, behind the XML
};
constexpr auto enum_words(VtkEncoding) {
  using enum VtkEncoding;
  return std::array{Word{"ascii", ascii}, Word{"base64", base64}, Word{"appended", appended}};
}

enum class Compression { none, zlib, lz4, lzma, gzip, zstd };
constexpr auto enum_words(Compression) {
  using enum Compression;
  return std::array{Word{"none", none}, Word{"zlib", zlib}, Word{"lz4", lz4}, Word{"lzma", lzma}, Word{"gzip", gzip}, Word{"zstd", zstd}};
}

/// How files are written. Which of these a format takes: Format::describe_write; the others have no effect there.
struct WriteOptions {
  VtkEncoding encoding = VtkEncoding::appended;
  std::optional<Compression> compression;  ///< open: lz4 in Zarr, else none. Error(usage) for one that the format has not.
  bool binary = true;                      ///< STL, PLY
  int pieces = 1;  ///< parallel VTK XML and .vtm: cut each mesh into that many (see in_pieces in mesh/select/piece.h)
  int chunk = 64;  ///< Zarr: samples along each axis of a chunk
};

/// Reads any known file. Errors name the file, the byte or line, and what was expected.
Data read_data(const std::string& path, const ReadOptions& options, Context& context);
/// Writes by extension. Throws Error(usage) for an unknown extension or a mesh the format cannot hold.
void write_data(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

/// Time values of a series, ascending; empty for a file without time.
std::vector<double> file_times(const std::string& path, const ReadOptions& options, Context& context);
/// A series that reads a step on demand; a file without time is a series of one step at 0.
Series open_series(const std::string& path, const ReadOptions& options, Context& context);
/// The step among `times` (not empty) that `options` request: by number, else the nearest time, else `otherwise`. Throws
/// Error(usage) for a step that is not there.
size_t chosen_step(const std::vector<double>& times, const ReadOptions& options, const std::string& path, size_t otherwise = 0);

/// What a reader does itself; the rest is done behind it, on all that it read.
/// `writes_parts`: collections, too. `may_be_empty`: an empty file is right, because it only marks its folder. `names_others`: a file
/// refers to further files.
enum Honours : unsigned { honours_region = 1, honours_pieces = 2, may_be_empty = 4, names_others = 8, writes_parts = 32 };

/// One format: what it is called, how to know it, how to read and write it. The table is in formats.def.
struct Format {
  std::string_view name;
  std::string_view extensions;  ///< blank-separated, lower case; may hold two parts ("nii.gz")
  /// Content test on the first bytes (up to 4 KiB; fewer when the file is shorter); null = extension only.
  bool (*sniff)(std::span<const std::byte> head) = nullptr;
  Data (*read)(const std::string& path, const ReadOptions&, Context&) = nullptr;
  void (*write)(const std::string& path, const Data&, const WriteOptions&, Context&) = nullptr;
  /// Time values without reading the data; null = the format has no time.
  std::vector<double> (*times)(const std::string& path, const ReadOptions&, Context&) = nullptr;
  /// For formats that are a folder; `path` has no trailing slash.
  bool (*sniff_folder)(const std::string& path) = nullptr;
  unsigned honours = 0;
  /// For formats without a magic number, known by the length and all of the content; asked when no sniff accepts the content and the
  /// extension is one of the format's. `whole` is mapped: touch little of it.
  bool (*sniff_file)(std::span<const std::byte> whole) = nullptr;
  /// Declare the options of this format besides the common ones (io/options.h); null = none.
  void (*describe_read)(Schema& s, ReadOptions& options) = nullptr;
  void (*describe_write)(Schema& s, WriteOptions& options) = nullptr;
  /// Content test for files whose name says nothing (standard input); asked last, as what it looks for is no magic number. `whole` is
  /// mapped: touch little of it.
  bool (*recognize)(std::span<const std::byte> whole) = nullptr;
  /// Writes a series step by step (io/steps/steps.h); null = a file holds one step.
  std::unique_ptr<StepsWriter> (*write_steps)(const std::string& path, StepsPlan plan, const WriteOptions&, Context&) = nullptr;
};
std::span<const Format> formats();
/// The format of a file or folder: the stated one, else by content, then by extension. Throws Error(data) when none knows it.
const Format& find_format(const std::string& path, const ReadOptions& options);
/// The format that write_data() takes for a file of this name. Throws Error(usage) for an extension that no writer has.
const Format& format_to_write(const std::string& path);

}  // namespace sg
