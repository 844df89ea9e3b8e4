// SPDX-License-Identifier: Apache-2.0
#include "data/series.h"

namespace sg {

namespace {

void join(FieldStats& into, const FieldStats& s) {
  if (into.range.empty()) into.range.resize(s.range.size());
  if (into.range.size() != s.range.size()) return;
  for (size_t c = 0; c < s.range.size(); ++c) into.range[c].add(s.range[c]);
  into.magnitude.add(s.magnitude);
  into.nan += s.nan;
  into.infinite += s.infinite;
}

}  // namespace

const SeriesField* SeriesRange::find(std::string_view name, Association a) const {
  for (const SeriesField& f : fields)
    if (f.name == name && f.association == a) return &f;
  return nullptr;
}

void add_step(SeriesRange& range, const Data& step) {
  for_each_dataset(step, [&](const std::string&, const DatasetPtr& d) {
    range.bounds.add(d->bounds());
    for (const Field& f : d->fields()) {
      auto* known = const_cast<SeriesField*>(range.find(f.name, f.association));
      if (!known) {
        range.fields.push_back({f.name, f.association, {}, 0});
        known = &range.fields.back();
      }
      join(known->stats, d->stats(f));
    }
  });
  // A field of several parts counts once a step.
  for (SeriesField& known : range.fields) {
    bool here = false;
    for_each_dataset(step,
                     [&](const std::string&, const DatasetPtr& d) { here = here || d->fields().find(known.name, known.association); });
    known.steps += here;
  }
}

SeriesRange series_range(const Series& series, Context& context) {
  SeriesRange range;
  for (size_t i = 0; i < series.times.size(); ++i) {
    context.check();
    context.progress(double(i) / double(series.times.size()), "reading step by step");
    add_step(range, series.load(i));
  }
  return range;
}

}  // namespace sg
