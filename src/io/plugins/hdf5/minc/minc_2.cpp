// SPDX-License-Identifier: Apache-2.0
#include "io/plugins/hdf5/minc/minc_2.h"

#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "base/text/text.h"
#include "io/minc/minc_volume.h"

namespace sg::minc {

namespace {

// The names of a dataset's dimensions. The list may be longer than there are dimensions.
std::vector<std::string> dimension_names(const h5::File& file, const h5::Dataset& set) {
  const std::string order = file.text_attribute(set.path(), "dimorder").value_or("");
  std::vector<std::string> names;
  for (const std::string_view w : split(order, ',')) names.emplace_back(trim(w));
  if (names.size() < set.dims().size())
    file.fail(fmt::format("names {} of its {} dimensions", order.empty() ? 0 : names.size(), set.dims().size()), set.path(),
              "expected an attribute 'dimorder' like 'zspace,yspace,xspace'");
  names.resize(set.dims().size());
  return names;
}

Dimension dimension_of(const h5::File& file, const std::string& name, size_t length) {
  Dimension d{name, length, {}, {}, {}, false};
  const std::string at = root + "/dimensions/" + name;
  if (!file.exists(at)) return d;
  const auto one = [&](const char* attribute) {
    const std::vector<double> v = file.number_attribute(at, attribute);
    return v.size() == 1 ? std::optional(v[0]) : std::nullopt;
  };
  d.start = one("start"), d.step = one("step");
  if (const auto c = file.number_attribute(at, "direction_cosines"); c.size() == 3) d.cosines = Vec3(c[0], c[1], c[2]);
  d.irregular = file.text_attribute(at, "spacing").value_or("").starts_with("irregular");
  return d;
}

// Real values of slices: numbers over the slowest dimensions of the image, or one for all.
void add_ranges(const h5::File& file, Volume& out) {
  if (const auto r = file.number_attribute(image_path, "valid_range"); r.size() == 2)
    out.valid_min = std::min(r[0], r[1]), out.valid_max = std::max(r[0], r[1]);
  const std::string low_path = image_path + "-min", high_path = image_path + "-max";
  if (is_float(out.type) || !file.is_dataset(low_path) || !file.is_dataset(high_path)) return;
  const h5::Dataset low(file, low_path), high(file, high_path);
  if (low.dims() != high.dims()) file.fail("has another shape than 'image-max'", low_path, "expected one number per slice");
  out.scaled_dims = low.count() == 1 ? 0 : low.dims().size();
  if (out.scaled_dims > 0) {
    const auto names = dimension_names(file, low);
    for (size_t k = 0; k < names.size(); ++k)
      if (k >= out.dims.size() || names[k] != out.dims[k].name || low.dims()[k] != out.dims[k].length)
        file.fail("must have the slowest dimensions of 'image'", low_path, "expected one number per slice");
  }
  const auto doubles = [](const h5::Dataset& set) {
    const Array a = set.read().converted(ElementType::f64);
    const auto v = a.view<double>();
    return std::vector<double>(v.data, v.data + v.count);
  };
  out.min = doubles(low), out.max = doubles(high);
}

Volume volume_of(const h5::File& file, bool with_ranges) {
  if (!is_minc_2(file)) fail_data("contains no MINC 2 volume", file.path(), "expected a group 'minc-2.0'");
  const auto image = std::make_shared<h5::Dataset>(file, image_path);
  if (!image->numeric())
    file.fail("holds no numbers of a supported type", image_path, "supported: integers and floats of 1, 2, 4 or 8 bytes");
  if (!image->backed()) file.fail("has more numbers than the file can hold", image_path, "the file is truncated or damaged");
  Volume v;
  v.path = file.path(), v.image = image_path;
  const auto names = dimension_names(file, *image);
  for (size_t k = 0; k < names.size(); ++k) v.dims.push_back(dimension_of(file, names[k], image->dims()[k]));
  for (const char* s : spaces)
    if (std::find(names.begin(), names.end(), s) == names.end()) v.others.push_back(dimension_of(file, s, 1));
  v.type = image->type();
  if (with_ranges) add_ranges(file, v);
  v.unit = file.text_attribute(image_path, "units").value_or("");
  v.modality = modality_word(file.text_attribute(root + "/info/study", "modality").value_or(""));
  for (const char* name : {"history", "title"})
    if (std::string text = file.text_attribute(root, name).value_or(""); !text.empty()) v.notes.emplace_back(name, std::move(text));
  v.read = [image](const std::vector<size_t>& start, const std::vector<size_t>& count) {
    return image->read_block({start.begin(), start.end()}, {count.begin(), count.end()}, std::vector<uint64_t>(start.size(), 1));
  };
  return v;
}

}  // namespace

bool is_minc_2(const h5::File& file) { return file.is_group(root); }

Data read_minc_2(const h5::File& file, const ReadOptions& options, Context& context) {
  return read_volume(volume_of(file, !options.header_only), options, context);
}

std::vector<double> minc_2_times(const h5::File& file) { return times_of(volume_of(file, false)); }

}  // namespace sg::minc
