// SPDX-License-Identifier: Apache-2.0
// DICOM: a folder of slices, or one file. Slices are grouped by series (and by size and orientation, so that scouts stay apart), ordered
// by position along their normal, and become uniform grids in the patient's space (left-posterior-superior, mm).
#include <fmt/core.h>

#include <tuple>

#include "base/bytes.h"
#include "base/error.h"
#include "base/file/file.h"
#include "base/file/file_fence.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "data/patient/patient_frame.h"
#include "io/mesh/unread.h"
#include "io/plugin.h"
#include "io/plugins/gdcm/dicom_picture.h"
#include "io/volume/lattice_part.h"

namespace sg {

namespace {

struct Slice {
  const DicomPicture* picture = nullptr;
  size_t frame = 0;
  bool placed = false;
  Vec3 position;
  double along = 0;  ///< position along the normal, or the number of the slice
};

struct Group {
  std::string name;
  std::vector<const DicomPicture*> pictures;
};

bool together(const DicomPicture& a, const DicomPicture& b) {
  return a.series == b.series && a.rows == b.rows && a.columns == b.columns && a.components() == b.components() &&
         a.bits_allocated == b.bits_allocated && a.is_signed == b.is_signed && length(a.x - b.x) < 1e-3 && length(a.y - b.y) < 1e-3 &&
         std::abs(a.spacing_x - b.spacing_x) < 1e-4 && std::abs(a.spacing_y - b.spacing_y) < 1e-4;
}

std::vector<Group> group(const std::vector<DicomPicture>& pictures) {
  std::vector<Group> groups;
  for (const DicomPicture& p : pictures) {
    Group* home = nullptr;
    for (Group& g : groups)
      if (together(*g.pictures[0], p)) home = &g;
    if (!home) home = &groups.emplace_back(Group{p.description.empty() ? "series" : p.description, {}});
    home->pictures.push_back(&p);
  }
  // Names are distinguished.
  for (size_t i = 0; i < groups.size(); ++i) {
    size_t same = 0;
    for (size_t j = 0; j < i; ++j) same += groups[j].pictures[0]->description == groups[i].pictures[0]->description;
    if (same) groups[i].name += fmt::format(" ({})", same + 1);
  }
  return groups;
}

// In order along the normal; slices without a position by their number.
std::vector<Slice> slices_of(const Group& g, bool& placed) {
  std::vector<Slice> slices;
  const Vec3 normal = cross(g.pictures[0]->x, g.pictures[0]->y);
  placed = true;
  for (const DicomPicture* p : g.pictures)
    for (size_t f = 0; f < p->frames; ++f) {
      Slice s{p, f, false, {}, 0};
      s.placed = p->positions.size() == p->frames;
      if (s.placed) s.position = p->positions[f];
      placed = placed && s.placed && p->has_orientation;
      slices.push_back(s);
    }
  for (Slice& s : slices) s.along = placed ? dot(s.position, normal) : s.picture->instance;
  std::stable_sort(slices.begin(), slices.end(), [](const Slice& a, const Slice& b) {
    return std::tie(a.along, a.picture->instance, a.frame) < std::tie(b.along, b.picture->instance, b.frame);
  });
  return slices;
}

// Several slices at one place (echoes, phases): the first of each place make the first volume, and so on.
std::vector<std::vector<Slice>> volumes_of(const std::vector<Slice>& slices, bool placed) {
  std::vector<std::vector<Slice>> volumes;
  size_t again = 0;
  for (size_t i = 0; i < slices.size(); ++i) {
    again = placed && i > 0 && slices[i].along - slices[i - 1].along < 1e-4 ? again + 1 : 0;
    if (again >= volumes.size()) volumes.emplace_back();
    volumes[again].push_back(slices[i]);
  }
  return volumes;
}

// The third axis: from the first slice to the last, with a word on gaps.
void place(UniformGrid& grid, const std::vector<Slice>& v, bool placed, DatasetParts& out, const Context& context,
           const std::string& where) {
  const DicomPicture& p = *v[0].picture;
  grid.dims = {p.columns, p.rows, v.size()};
  grid.spacing = {p.spacing_x, p.spacing_y, p.slice_distance > 0 ? p.slice_distance : 1};
  const Vec3 normal = cross(p.x, p.y);
  Vec3 z = normalize(normal);
  if (!p.positions.empty()) grid.origin = v[0].placed ? v[0].position : p.positions[0];
  if (placed && v.size() > 1) {
    const Vec3 way = v.back().position - v[0].position;
    const auto steps = double(v.size() - 1);
    grid.spacing.z = length(way) / steps;
    // A leaning gantry shifts slices sideways: the axis leans with them. Less than half a degree is rounding.
    if (length(cross(normalize(way), z)) > 0.009) {
      z = normalize(way);
      out.notes.emplace_back("shear", "slices are shifted: the third axis is not perpendicular to them");
    } else {
      grid.spacing.z = dot(way, z) / steps;
    }
    std::vector<double> gap;
    for (size_t i = 1; i < v.size(); ++i) gap.push_back(v[i].along - v[i - 1].along);
    std::vector<double> sorted = gap;
    std::sort(sorted.begin(), sorted.end());
    const double typical = sorted[sorted.size() / 2];
    if (sorted.back() - sorted.front() > 0.001 * typical) {
      const size_t missing = size_t(std::count_if(gap.begin(), gap.end(), [&](double d) { return d > 1.5 * typical; }));
      std::string text = fmt::format("uneven: {} to {} mm, drawn as {} mm", short_number(sorted.front()), short_number(sorted.back()),
                                     short_number(grid.spacing.z));
      if (missing) text += fmt::format("; slices seem to be missing at {} places", missing);
      out.notes.emplace_back("slice distance", text);
      context.warn(fmt::format("{}: slice distances are {}", where, text));
    }
  }
  for (int r = 0; r < 3; ++r) grid.direction.m[r][0] = p.x[r], grid.direction.m[r][1] = p.y[r], grid.direction.m[r][2] = z[r];
  if (p.has_orientation) note_patient_frame(out);
  if (p.has_spacing) out.notes.emplace_back("length unit", "mm");
}

DatasetPtr make_volume(const std::vector<Slice>& v, bool placed, const std::string& where, const ReadOptions& options, Context& context) {
  const DicomPicture& p = *v[0].picture;
  DatasetParts out;
  out.notes = p.notes;
  UniformGrid grid;
  place(grid, v, placed, out, context, where);
  const LatticePart part = cut_grid(grid, options.region);
  out.mesh = grid;
  const bool wanted =
      options.fields.empty() || std::find(options.fields.begin(), options.fields.end(), "DICOMImage") != options.fields.end();
  if (!wanted) return make_dataset(std::move(out));

  bool same_scale = true;
  int most_bits = p.bits_stored;
  for (const Slice& s : v) {
    same_scale = same_scale && s.picture->slope == p.slope && s.picture->intercept == p.intercept;
    most_bits = std::max(most_bits, s.picture->bits_stored);
  }
  DicomPicture widest = p;
  widest.bits_stored = most_bits;
  const ElementType type = dicom_type(widest, !same_scale);
  const size_t tuple = element_size(type) * size_t(p.components()), slice = p.rows * p.columns * tuple;
  auto add_field = [&](Array values) {
    const Role role = values.components() >= 3 && values.type() == ElementType::u8 ? Role::colors : Role::scalars;
    out.fields.add({"DICOMImage", Association::point, std::move(values), p.notes.empty() || p.notes[0].second != "CT" ? "" : "HU", role});
    return make_dataset(std::move(out));
  };
  if (options.header_only) return add_field(unread_values(type, part.points(), p.components()));
  uint64_t total = 0;
  if (!multiply(part.points(), tuple, total) || total > uint64_t(1) << 46) fail_data("the volume is too large", where);
  std::byte* to = nullptr;
  Array a = Array::make_raw(type, part.points(), p.components(), &to);
  const LatticePart in_slice{
      {part.dims[0], part.dims[1], 1}, {part.lo[0], part.lo[1], 0}, {part.count[0], part.count[1], 1}, {part.stride[0], part.stride[1], 1}};
  const size_t share = part.count[0] * part.count[1] * tuple;
  auto read = [&](size_t k, size_t count) {
    const Slice& s = v[part.lo[2] + k * part.stride[2]];
    std::byte* place = to + k * share;
    if (in_slice.whole()) return read_dicom_frames(*s.picture, s.frame, count, type, place);
    std::vector<std::byte> whole(slice * count);
    read_dicom_frames(*s.picture, s.frame, count, type, whole.data());
    for (size_t i = 0; i < count; ++i) copy_part(whole.data() + i * slice, tuple, in_slice, place + i * share);
  };
  // Frames that follow one another in a packed file are unpacked at once.
  std::vector<std::pair<size_t, size_t>> runs;
  for (size_t k = 0; k < part.count[2]; ++k) {
    const Slice& s = v[part.lo[2] + k * part.stride[2]];
    if (!runs.empty() && s.picture->decode && part.stride[2] == 1) {
      const Slice& last = v[part.lo[2] + k - 1];
      if (last.picture == s.picture && last.frame + 1 == s.frame) {
        ++runs.back().second;
        continue;
      }
    }
    runs.emplace_back(k, 1);
  }
  parallel_for(
      runs.size(), 1, [&](size_t i, size_t) { read(runs[i].first, runs[i].second); }, &context);
  return add_field(std::move(a));
}

bool is_dicom_name(const std::string& name) {
  const std::string e = extension_of(name);
  return e == "dcm" || e == "dicom" || e == "ima";
}

std::vector<DicomPicture> headers_of(const std::string& path, Context& context) {
  std::vector<DicomPicture> pictures;
  DicomPicture p;
  if (!is_folder(path)) {
    if (!read_dicom_header(path, p)) fail_data("contains no picture", path, "it may be a DICOM directory, report or plan");
    pictures.push_back(std::move(p));
    return pictures;
  }
  size_t others = 0;
  for (const std::string& name : folder_entries(path)) {
    const std::string file = path + "/" + name;
    if (!is_plain_file(file)) continue;
    {
      const MappedFile m(file);
      const bool magic = m.size() >= 132 && std::memcmp(m.data() + 128, "DICM", 4) == 0;
      if (m.size() == 0 || (!magic && !is_dicom_name(name))) continue;
    }
    context.check();
    p = {};
    if (read_dicom_header(file, p)) pictures.push_back(std::move(p));
    else ++others;
  }
  if (pictures.empty()) fail_data("contains no DICOM pictures", path);
  if (others) context.info(fmt::format("{}: {} DICOM files without a picture are left out", path, others));
  return pictures;
}

Data read_dicom(const std::string& path, const ReadOptions& options, Context& context) {
  const std::vector<DicomPicture> pictures = headers_of(path, context);
  Collection all;
  for (const Group& g : group(pictures)) {
    bool placed = false;
    const std::vector<Slice> slices = slices_of(g, placed);
    const auto volumes = volumes_of(slices, placed);
    for (size_t i = 0; i < volumes.size(); ++i) {
      const std::string name = volumes.size() == 1 ? g.name : fmt::format("{}, volume {}", g.name, i + 1);
      all.parts.push_back({name, make_volume(volumes[i], placed, path, options, context)});
    }
    if (!placed && g.pictures.size() > 1)
      context.warn(fmt::format("{}: slices of '{}' have no positions and are ordered by number", path, g.name));
  }
  if (all.parts.size() == 1) return all.parts[0].data;
  context.info(fmt::format("{}: {} volumes, one part each", path, all.parts.size()));
  return std::make_shared<const Collection>(std::move(all));
}

}  // namespace

}  // namespace sg

SG_PLUGIN_FORMATS({"dicom", sg::read_dicom, nullptr, nullptr})
