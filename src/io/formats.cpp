// SPDX-License-Identifier: Apache-2.0
// The table of formats and the choice among them.
#include "io/formats.h"

#include <fmt/core.h>

#include <set>

#include "base/file/file.h"
#include "base/file/file_fence.h"
#include "base/file/mapped_watch.h"
#include "base/text/text.h"
#include "data/fields/known_looks.h"
#include "data/lattice.h"
#include "data/lattice_crop.h"
#include "io/file_series.h"
#include "io/lent_series.h"
#include "io/options.h"
#include "io/plugin.h"
#include "io/reading_budget.h"
#include "io/stated_format.h"
#include "io/steps/steps.h"
#include "io/y_up.h"

namespace sg {

namespace {

// A row of the table with its options.
constexpr Format reads_with(void (*describe)(Schema&, ReadOptions&), Format f) {
  f.describe_read = describe;
  return f;
}
constexpr Format writes_with(void (*describe)(Schema&, WriteOptions&), Format f) {
  f.describe_write = describe;
  return f;
}

constexpr Format in_steps(std::unique_ptr<StepsWriter> (*write)(const std::string&, StepsPlan, const WriteOptions&, Context&), Format f) {
  f.write_steps = write;
  return f;
}

constexpr Format known_unnamed(bool (*recognize)(std::span<const std::byte>), Format f) {
  f.recognize = recognize;
  return f;
}

}  // namespace

std::span<const Format> formats() {
  static constexpr Format table[] = {
#include "io/formats.def"
  };
  return table;
}

namespace {

unsigned honours_of(std::string_view extension) {
  for (const Format& f : formats())
    for (const std::string_view e : words(f.extensions))
      if (e == extension) return f.honours;
  return 0;
}

}  // namespace

bool y_points_up(std::string_view extension) { return honours_of(extension) & y_is_up; }
bool states_up(std::string_view extension) { return honours_of(extension) & defines_up; }

namespace {

/// Whether the name ends in one of the format's extensions; these may have two parts ("nii.gz").
bool has_extension(const Format& f, const std::string& path) {
  const std::string name = to_lower(file_name_of(path));
  for (std::string_view e : words(f.extensions))
    if (name.size() > e.size() && name.ends_with(e) && name[name.size() - e.size() - 1] == '.') return true;
  return false;
}

std::string known_extensions(bool writable) {
  std::set<std::string_view> named;  // several formats share one
  std::string r;
  for (const Format& f : formats())
    if (writable ? f.write != nullptr : f.read != nullptr)
      for (std::string_view e : words(f.extensions))
        if (named.insert(e).second) r += (r.empty() ? "" : " ") + std::string(e);
  return r;
}

const Format* raw_format() {
  for (const Format& f : formats())
    if (f.read == read_raw) return &f;
  return nullptr;
}

const Format& format_of_folder(const std::string& path, const ReadOptions& options) {
  for (const Format& f : formats())
    if (f.sniff_folder && (options.format.empty() || is_called(f, options.format)) && f.sniff_folder(path)) return f;
  if (!options.format.empty()) fail_data(fmt::format("is stated to be {}, but is a folder of another kind", options.format), path);
  fail_data("is a folder of unknown kind", path,
            "supported folders: DICOM slices, OpenFOAM cases, AMReX plotfiles, Zarr images, stacks of pictures");
}

const Format& format_of_file(const std::string& path, const ReadOptions& options) {
  const MappedFile file(path);
  if (file.size() == 0)
    for (const Format& f : formats())
      if ((f.honours & may_be_empty) && has_extension(f, path)) return f;
  if (file.size() == 0) fail_data("is empty", path, "a data file has at least a header");
  if (!options.format.empty()) return stated_format(options.format, {file.data(), file.size()}, path);
  if (options.raw_dims[0] > 0) return *raw_format();
  const std::span<const std::byte> head(file.data(), std::min<size_t>(file.size(), 4096));
  const Format* found = nullptr;
  for (const Format& f : formats())
    if (f.read && f.sniff && f.sniff(head)) {
      if (has_extension(f, path)) return f;
      if (!found) found = &f;
    }
  if (found) return *found;
  for (const Format& f : formats())
    if (f.read && f.sniff_file && has_extension(f, path) && f.sniff_file({file.data(), file.size()})) return f;
  for (const Format& f : formats())
    if (f.read && !f.sniff && !f.sniff_file && has_extension(f, path)) return f;
  for (const Format& f : formats())
    if (f.read && has_extension(f, path))
      fail_data(fmt::format("is named like {}, but its content is not", f.name), path, recognized_hint({file.data(), file.size()}));
  if (const Format* f = recognized({file.data(), file.size()})) return *f;
  fail_data("has an unknown format", path,
            fmt::format("supported: {}; name it with format=EXTENSION (--input-format); for a raw brick give --dims and --type",
                        known_extensions(false)));
}

const Format& format_of(std::string& path, const ReadOptions& options) {
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  check_may_read(path);
  return is_folder(path) ? format_of_folder(path, options) : format_of_file(path, options);
}

/// Runs f(format, path); errors without a location get the path.
template <class F>
auto with_format(std::string path, const ReadOptions& options, F&& f) {
  trust_folder_of(path);
  try {
    return f(format_of(path, options), path);
  } catch (Error& e) {  // most have a location; those found when the dataset is made cannot
    if (e.where().find(path) == std::string::npos) e.add_context(fmt::format("reading '{}'", path));
    throw;
  }
}

// What was read of a file that was written meanwhile is neither its old nor its new state, whether it was understood or not.
Data read_unchanged(const Format& f, const std::string& path, const ReadOptions& options, Context& context) {
  const uint64_t begin = mapped_watch().now();
  ReadingBudget budget(path, f.sniff_folder || (f.honours & names_others));
  Data data;
  try {
    data = f.read(path, options, context);
  } catch (const Error& e) {
    if (e.kind() == ErrorKind::data) check_files_unchanged(begin);
    throw;
  }
  check_files_unchanged(begin);
  return data;
}

}  // namespace

namespace {

Data cropped(const Data& data, const LatticeRegion& region) {
  if (region.whole()) return data;
  return map_datasets(
      data, [&](const DatasetPtr& d) { return is_lattice(d->mesh()) ? crop_lattice(*d, region.lo, region.hi, region.stride) : d; });
}

}  // namespace

Data read_data(const std::string& path, const ReadOptions& options, Context& context) {
  if (is_lent(path)) return cropped(read_lent(path, options, context), options.region);
  if (names_series(path)) return read_of_series(path, options, context);
  return with_format(path, options, [&](const Format& f, const std::string& at) {
    ReadOptions inside = options;
    inside.format.clear();  // what the file names may be of others
    const Data data = map_datasets(read_unchanged(f, at, inside, context), with_known_looks);
    return f.honours & honours_region ? data : cropped(data, options.region);
  });
}

const Format& find_format(const std::string& path, const ReadOptions& options) {
  static constexpr Format lent{.name = "series of a program", .extensions = ""};
  if (is_lent(path)) return lent;
  std::string at = names_series(path) ? series_files(path).front() : path;
  return format_of(at, options);
}

std::vector<double> file_times(const std::string& path, const ReadOptions& options, Context& context) {
  if (is_lent(path)) return lent_times(path);
  if (names_series(path)) return times_of_series(path, options, context);
  return with_format(path, options, [&](const Format& f, const std::string& at) {
    return f.times ? f.times(at, options, context) : std::vector<double>();
  });
}

Series open_series(const std::string& path, const ReadOptions& options, Context& context) {
  Series series{file_times(path, options, context), nullptr};
  const bool timeless = series.times.empty();
  if (timeless) series.times = {0};
  series.load = [=, &context](size_t step) {
    ReadOptions one = options;
    one.time.reset();
    one.step = timeless ? -1 : int64_t(step);
    return read_data(path, one, context);
  };
  return series;
}

size_t chosen_step(const std::vector<double>& times, const ReadOptions& options, const std::string& path, size_t otherwise) {
  if (options.step >= 0) {
    if (size_t(options.step) >= times.size())
      fail_usage(fmt::format("there is no time step {}", options.step), path, fmt::format("it has {} steps, counted from 0", times.size()));
    return size_t(options.step);
  }
  if (!options.time) return otherwise;
  size_t best = 0;
  for (size_t i = 1; i < times.size(); ++i)
    if (std::fabs(times[i] - *options.time) < std::fabs(times[best] - *options.time)) best = i;
  return best;
}

const Format& format_to_write(const std::string& path) {
  const Format* known = nullptr;
  for (const Format& f : formats())
    if (has_extension(f, path) && (!known || !known->write)) known = &f;
  if (!known) fail_usage(fmt::format("unknown extension '{}'", extension_of(path)), path, "supported: " + known_extensions(true));
  if (!known->write)
    fail_usage(fmt::format("{} files can be read but not written", known->name), path, "supported: " + known_extensions(true));
  return *known;
}

void write_data(const std::string& given, const Data& data, const WriteOptions& options, Context& context) {
  std::string path = given;
  while (path.size() > 1 && path.back() == '/') path.pop_back();  // of a format that is a folder
  const Format& f = format_to_write(path);
  if (options.pieces > 1) {
    WriteOptions taken;
    Schema schema;
    if (f.describe_write) f.describe_write(schema, taken);
    if (!schema.find("pieces"))
      fail_usage(fmt::format("{} files cannot hold pieces", f.name), path, "write .pvti, .pvtr, .pvts, .pvtu, .pvtp or .vtm");
  }
  with_context(fmt::format("writing '{}'", path), [&] { f.write(path, data, options, context); });
}

}  // namespace sg
