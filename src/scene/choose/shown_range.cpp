// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/shown_range.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/all_ranks.h"
#include "base/text/text.h"
#include "data/ranks/over_all.h"

namespace sg {

namespace {

using Shows = FieldLook::Shows;

constexpr size_t most_samples = 400000;
constexpr double inside = 0.995, inside_tailed = 0.99;

// Evenly spread finite values of all the fields, in all pieces.
std::vector<double> samples_of(std::span<const FieldOf> fields, int component, const Context& context) {
  uint64_t all = 0;
  for (const FieldOf& f : fields) all += f.field->array.count();
  all = all_sum(all, context.communicator);
  const size_t step = std::max<size_t>(1, all / most_samples);
  std::vector<double> v;
  v.reserve(all / step + fields.size());
  for (const FieldOf& f : fields) {
    const Array& ghost = f.field->association == Association::point ? f.data->point_ghost() : f.data->cell_ghost();
    dispatch(f.field->array, [&](auto view) {
      const bool magnitude = component < 0 && view.components > 1;
      const int one = view.components > 1 ? std::max(component, 0) : 0;
      for (size_t i = 0; i < view.count; i += step) {
        if (context.communicator && !ghost.empty() && int(ghost.get(i)) & ghost_duplicate) continue;
        double x = double(view(i, one));
        if (magnitude) {
          x = 0;
          for (int c = 0; c < view.components; ++c) x += double(view(i, c)) * double(view(i, c));
          x = std::sqrt(x);
        }
        if (std::isfinite(x)) v.push_back(x);
      }
    });
  }
  return all_concatenated(std::span<const double>(v), context.communicator);
}

double quantile(std::vector<double>& v, double q) {
  const auto at = v.begin() + ptrdiff_t(q * double(v.size() - 1));
  std::nth_element(v.begin(), at, v.end());
  return *at;
}

// To three digits, outwards or inwards as it falls: numbers for people to read.
double rounded(double x) { return *parse_double(short_number(x, 3)); }

}  // namespace

ShownRange shown_range(std::span<const FieldOf> fields, int component, bool symmetric, const Context& context) {
  ShownRange s;
  bool may_cut = !fields.empty(), tailed = false;
  auto shows = Shows::any;
  for (const FieldOf& f : fields) {
    s.range.add(range_over_all(*f.data, *f.field, f.field->components() > 1 ? component : 0, context));
    may_cut = may_cut && is_float(f.field->array.type());
    tailed = tailed || f.field->look.tailed;
    if (symmetric) shows = f.field->look.shows;
  }
  if (s.range.empty()) return s;
  const Range whole = s.range;
  // Of fields with one side that matters, that side says how far: shear may be a thousand times as strong as vortices are.
  if (!(whole.lo < 0 && whole.hi > 0)) shows = Shows::any;
  const double reach = shows == Shows::high ? whole.hi : shows == Shows::low ? -whole.lo : std::max(-whole.lo, whole.hi);
  if (symmetric) s = {{-reach, reach}, whole.lo<-reach, whole.hi> reach};
  if (!may_cut || !(tailed || symmetric)) return s;
  std::vector<double> v = samples_of(fields, component, context);
  if (symmetric) {
    std::erase_if(v, [&](double x) {  // what is nowhere but in a few places has no tails
      return x == 0 || (shows == Shows::high && x < 0) || (shows == Shows::low && x > 0);
    });
    for (double& x : v) x = std::abs(x);
  }
  if (v.size() < 200) return s;
  const double most = tailed ? inside_tailed : inside, high = quantile(v, most);
  if (symmetric) {
    double far = high;
    if (tailed && shows == Shows::any)  // curvatures, whose tails are the noise of a surface, not the crests of a flow
      if (const double usual = quantile(v, 0.9); far > 3 * usual) far = usual;
    const double end = rounded(far);
    if (end > 0 && reach > (tailed ? 1.5 : 4) * end) s.range = {-end, end};
    s.cut_low = whole.lo<s.range.lo, s.cut_high = whole.hi> s.range.hi;
    return s;
  }
  const double low = quantile(v, 1 - most), width = high - low;
  if (!(width > 0)) return s;
  const double far = 0.5 * width;
  if (whole.hi - high > far && rounded(high) > low) s.range.hi = rounded(high), s.cut_high = true;
  if (low - whole.lo > far && rounded(low) < s.range.hi) s.range.lo = rounded(low), s.cut_low = true;
  return s;
}

void take_shown_range(const ShownRange& shown, const Range& whole, const std::string& name, ColorScale& s, Context& context) {
  s.lo = shown.range.lo, s.hi = shown.range.hi;
  if (!shown.cut_low && !shown.cut_high) return;
  if (shown.cut_low && !s.below) s.below = s.map.at(0);
  if (shown.cut_high && !s.above) s.above = s.map.at(1);
  context.info(fmt::format("'{}' reaches from {} to {}, but few values lie outside the colours; range={},{} has all", name,
                           short_number(whole.lo, 3), short_number(whole.hi, 3), short_number(whole.lo, 4), short_number(whole.hi, 4)));
}

bool spans_decades(std::span<const FieldOf> fields, const Context& context) {
  constexpr double few = 0.5, crowded = 0.9, decade = 10;
  for (const FieldOf& f : fields)
    if (!is_float(f.field->array.type()) || f.field->components() != 1 || (f.field->role != Role::scalars && f.field->role != Role::none) ||
        f.field->look.tailed || f.field->look.shows != Shows::any || f.field->look.one_sided || f.field->look.two_sided)
      return false;  // also where zero is a value like any other, or the middle
  std::vector<double> v = samples_of(fields, 0, context);
  const size_t all = v.size();
  if (std::any_of(v.begin(), v.end(), [](double x) { return x < 0; })) return false;
  std::erase(v, 0.0);
  if (v.size() < 200 || double(v.size()) < (1 - few) * double(all)) return false;
  const double most = *std::max_element(v.begin(), v.end()), high = quantile(v, crowded);
  return high < 0.1 * most && high > decade * quantile(v, 1 - crowded);
}

}  // namespace sg
